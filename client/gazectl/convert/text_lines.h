/**
 * @file
 * Lines of a text file, plain or gzip, and the fields of a line.
 */
#ifndef GZ_CLIENT_GAZECTL_CONVERT_TEXT_LINES_H
#define GZ_CLIENT_GAZECTL_CONVERT_TEXT_LINES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"

/** Room for a line with its NUL, bytes. Chosen: ten times the widest export seen. */
#define GZ_TEXT_LINE_SIZE 65536

/** Most fields of a line. Chosen: Tobii's exports have some hundred columns. */
#define GZ_TEXT_FIELDS_MAX 512

/** A file being read line by line. */
struct gz_text_lines;

/**
 * Open the file @p path, plain or gzip.
 *
 * @param[out] out_lines  owned by the caller: gz_text_lines_close()
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_ACCESS, GZ_ERR_IO, GZ_ERR_NO_MEM  not logged
 */
enum gz_result gz_text_lines_open(const char *path, struct gz_text_lines **out_lines);

/** Open @p size bytes of plain text in memory, which must stay until the lines are closed.
 * Otherwise like gz_text_lines_open(). */
enum gz_result gz_text_lines_open_memory(const void *bytes, size_t size,
					 struct gz_text_lines **out_lines);

/**
 * Read the next line, without its end ("\n" or "\r\n") and, for the first line, without a byte
 * order mark. Bytes of 0 in a line become blanks.
 *
 * @param[out] out_line  may be written to; valid until the next call
 * @retval GZ_ERR_END     there are no more lines
 * @retval GZ_ERR_FULL    the line is longer than GZ_TEXT_LINE_SIZE - 1 bytes; it is skipped, and
 * the next call goes on after it
 * @retval GZ_ERR_IO      reading or decompressing failed
 */
enum gz_result gz_text_lines_next(struct gz_text_lines *lines, char **out_line);

/** Make the next call of gz_text_lines_next() return the newest line again. Call this before the
 * line is written to. */
void gz_text_lines_again(struct gz_text_lines *lines);

/** Number of the newest line, from 1. */
uint64_t gz_text_lines_number(const struct gz_text_lines *lines);

/** Close the file, free and set *lines to NULL. Accepts a pointer to NULL. */
void gz_text_lines_close(struct gz_text_lines **lines);

/** Fields of a line. */
struct gz_text_fields {
	size_t count;
	char *field[GZ_TEXT_FIELDS_MAX];
};

/**
 * Split @p line at each @p separator and remove quotes around fields. Fields beyond
 * GZ_TEXT_FIELDS_MAX are left out. A blank as @p separator stands for any run of blanks and tabs.
 *
 * @param line             written to; the fields point into it
 * @param[out] out_fields  filled
 */
void gz_text_split(char *line, char separator, struct gz_text_fields *out_fields);

/** The number in a field; NaN if the field is empty, missing or not a number. A decimal comma
 * counts as a point. */
double gz_text_field_number(const struct gz_text_fields *fields, size_t index);

/**
 * Read a number at the beginning of *text, and move *text past it and the blanks that follow.
 *
 * @param[out] out_value  written on true only
 * @return whether there is a number
 */
bool gz_text_take_number(const char **text, double *out_value);

/** Whether @p text begins with @p word, ignoring case. */
bool gz_text_begins(const char *text, const char *word);

/** Copy @p text into @p to of @p size bytes, cut between characters if it is too long; bytes that
 * are not UTF-8 become '?'. */
void gz_text_copy(char *to, size_t size, const char *text);

#endif
