/**
 * @file
 * INI files: reading them item by item ("[section]" and "name = value"), and changing single keys
 * while everything else stays as its author wrote it.
 *
 * The reader is for files whose sections form a list. A file that is one table of settings is read
 * by option.h, which is built on this.
 *
 * A line that begins with ';' or '#' is a comment; so is everything after a ';' that follows a
 * blank. Blanks around a line, a name or a value are ignored. A value ends with its line. Limits: a
 * line has at most 199 bytes (inih's INI_MAX_LINE), a section name 49 bytes, a file 1 MiB.
 */
#ifndef GZ_BASE_INI_H
#define GZ_BASE_INI_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "base/text.h"

/** Size of a buffer for the longest line, name or value, with the NUL, bytes. */
#define GZ_INI_LINE_SIZE 200

/** The beginning of a section, or one value. Its texts are valid during the call only. */
struct gz_ini_item {
	const char *section; /**< the section that begins here or that the value is in */
	const char *name;    /**< NULL: a section begins here */
	const char *value;   /**< "" if it is empty; NULL if name is NULL */
	int line;            /**< line number, from 1 */
};

/**
 * Receives one item.
 *
 * @return GZ_OK to go on; any other code ends the reading, and the callback has logged the reason
 */
typedef enum gz_result gz_ini_take(void *user, const struct gz_ini_item *item);

/**
 * Pass the items of @p size bytes at @p text to @p take, in order.
 *
 * @param name  the file's name in messages
 * @retval GZ_OK          all items were taken
 * @retval GZ_ERR_FORMAT  a line is refused; logged with file, line and remedy
 * @retval GZ_ERR_NO_MEM  out of memory
 * @return otherwise what @p take returned
 */
enum gz_result gz_ini_read_text(const char *name, const char *text, size_t size, gz_ini_take *take,
				void *user, const struct gz_log *log);

/**
 * Pass the items of the file @p path to @p take, in order.
 *
 * @retval GZ_OK             all items were taken
 * @retval GZ_ERR_NOT_FOUND  no such file; logged
 * @retval GZ_ERR_IO         the file cannot be read; logged
 * @retval GZ_ERR_FORMAT     a line is refused, or the file is longer than 1 MiB; logged
 * @retval GZ_ERR_NO_MEM     out of memory
 * @return otherwise what @p take returned
 */
enum gz_result gz_ini_read_file(const char *path, gz_ini_take *take, void *user,
				const struct gz_log *log);

/**
 * Set a key of an INI text. An existing value is replaced where it is; otherwise a line is added at
 * the end of the section; otherwise a section is added at the end of the text. Comments, blanks and
 * all other lines stay unchanged.
 *
 * @param text           one that gz_ini_read_text() accepts; its failed is set if memory runs out
 * @param section, name  of the key "section.name"
 * @param value          without a line break
 */
void gz_ini_text_set(struct gz_text *text, const char *section, const char *name,
		     const char *value);

/**
 * Remove the line that gives a key, with the comment on it.
 *
 * @return false if no line gives the key
 */
bool gz_ini_text_remove(struct gz_text *text, const char *section, const char *name);

/** Whether a line gives the key. */
bool gz_ini_text_has(const struct gz_text *text, const char *section, const char *name);

#endif
