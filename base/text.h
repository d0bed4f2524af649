/**
 * @file
 * Text: numbers that read and print the same in every locale, text that grows, and text files that
 * are read and written whole.
 */
#ifndef GZ_BASE_TEXT_H
#define GZ_BASE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"

/**
 * Read a decimal number. It must be all of @p word: no blanks, no "nan", "inf" or hexadecimal.
 *
 * @param[out] out_value  finite; written only on true
 */
bool gz_number_parse(const char *word, double *out_value);

/**
 * Read a whole number that fits into int64_t. It must be all of @p word: decimal digits and an
 * optional sign.
 *
 * @param[out] out_value  written only on true
 */
bool gz_number_parse_whole(const char *word, long long *out_value);

/**
 * Replace the decimal point of a number that printf() printed by "%g" with a full stop, whatever
 * decimal point the locale uses.
 *
 * @param[in,out] number  NUL-terminated; digits, sign, exponent and at most one point
 */
void gz_number_normalise_point(char *number);

/** Size of the buffer that gz_number_print() needs, with the NUL, bytes. */
#define GZ_NUMBER_SIZE 32

/** Print a finite number with the fewest digits that read back as the same double. */
void gz_number_print(double value, char text[GZ_NUMBER_SIZE]);

/**
 * The number with the fewest digits that equals @p value when converted to float: 0.1 for 0.1F,
 * whose nearest double is 0.100000001490116. For text that is read back as a float.
 */
double gz_number_of_float(float value);

/**
 * Cut the first word off @p *text and move @p *text past it.
 *
 * @param[in,out] text     NUL-terminated; the blank after the word is overwritten with a NUL
 * @param         blanks   the characters that separate words
 * @return the word, or NULL if only blanks are left
 */
char *gz_number_next_word(char **text, const char *blanks);

/**
 * Print into a buffer, formatted as by printf().
 *
 * @param[out] text     NUL-terminated if @p size is at least 1
 * @param size          bytes at @p text
 * @retval GZ_ERR_FULL  the text does not fit; @p text is an empty string
 */
__attribute__((format(printf, 3, 4))) enum gz_result gz_text_print(char *text, size_t size,
								   const char *format, ...);

/** A text that grows. Zero-initialised is empty. */
struct gz_text {
	char *bytes;         /**< length bytes and a NUL; NULL while empty */
	size_t length, room; /**< bytes used, and allocated */
	bool failed;         /**< out of memory: everything added since then is missing */
};

/** Append text, formatted as by printf(). Sets failed if memory runs out. */
__attribute__((format(printf, 2, 3))) void gz_text_add(struct gz_text *text, const char *format,
						       ...);

/** Append @p size bytes unchanged. Sets failed if memory runs out. */
void gz_text_add_bytes(struct gz_text *text, const char *bytes, size_t size);

/** Free the text's memory and zero it. */
void gz_text_free(struct gz_text *text);

/**
 * Write the text to the file @p path. The text goes to a new file that is then renamed, so that
 * @p path holds either its old content or all of the new. If @p path is a link, the file that it
 * points to is replaced.
 *
 * @retval GZ_ERR_NO_MEM  the text is incomplete (failed is set); logged
 * @retval GZ_ERR_IO      the file cannot be written; logged
 */
enum gz_result gz_text_write(const struct gz_text *text, const char *path,
			     const struct gz_log *log);

/**
 * Append the content of the file @p path.
 *
 * @retval GZ_ERR_NOT_FOUND  no such file; not logged, because only the caller knows what the file
 * is for
 * @retval GZ_ERR_IO         the file cannot be read; not logged
 * @retval GZ_ERR_NO_MEM     out of memory; not logged
 */
enum gz_result gz_text_add_file(struct gz_text *text, const char *path);

/** A small text file to read. */
struct gz_text_file {
	const char *path;
	const char *what; /**< the file's content in messages, such as "transfer function" */
	size_t size_max;  /**< bytes; a longer file is refused before it is read whole */
};

/**
 * Append the content of a small text file.
 *
 * @param[in,out] text  the caller frees it with gz_text_free(), on failure too
 * @retval GZ_ERR_NOT_FOUND  no such file; logged
 * @retval GZ_ERR_IO         the file cannot be read; logged
 * @retval GZ_ERR_FORMAT     the file is longer than size_max; logged
 * @retval GZ_ERR_NO_MEM     logged
 */
enum gz_result gz_text_load(struct gz_text *text, const struct gz_text_file *file,
			    const struct gz_log *log);

#endif
