/**
 * @file
 * INI files, item by item: "[section]" and "name = value". For files whose sections are a list;
 * what is one table of settings is read by option.h, which stands on this.
 *
 * A line that begins with ';' or '#' is a comment, and so is what follows a ';' after a blank.
 * Blanks around a line, a name or a value do not count; a value ends with its line. Lines hold at
 * most 199 bytes (inih's INI_MAX_LINE), section names 49, files 1 MiB.
 */
#ifndef GZ_BASE_INI_H
#define GZ_BASE_INI_H

#include <stddef.h>

#include "base/log.h"
#include "base/result.h"

/** Most bytes of a line, a name or a value, with the final NUL. */
#define GZ_INI_LINE_SIZE 200

/** One line that says something. Its texts are valid during the call only. */
struct gz_ini_item {
	const char *section; /**< that the line is in, or begins */
	const char *name;    /**< NULL: the section begins here */
	const char *value;   /**< "" where there is none; NULL with name */
	int line;            /**< from 1 */
};

/** Takes one item. What it returns but GZ_OK ends the reading; it has logged why. */
typedef enum gz_result gz_ini_take(void *user, const struct gz_ini_item *item);

/**
 * Hand the items of @p size bytes at @p text to @p take, in order.
 *
 * @param name  stands for the file in messages
 * @retval GZ_OK          all were taken
 * @retval GZ_ERR_FORMAT  a line is refused; logged with file, line and remedy
 * @retval GZ_ERR_NO_MEM  no room
 * @return else what @p take returned
 */
enum gz_result gz_ini_read_text(const char *name, const char *text, size_t size, gz_ini_take *take,
				void *user, const struct gz_log *log);

/**
 * As gz_ini_read_text() over the file @p path.
 *
 * @retval GZ_ERR_NOT_FOUND  no such file; logged
 * @retval GZ_ERR_IO         cannot be read; logged
 * @retval GZ_ERR_FORMAT     also where it is longer than 1 MiB; logged
 */
enum gz_result gz_ini_read_file(const char *path, gz_ini_take *take, void *user,
				const struct gz_log *log);

#endif
