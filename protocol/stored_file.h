/**
 * @file
 * Small INI files that a program stores and reads back whole: every key must be given. The tables
 * of their keys are those of base/option.h. Internal to protocol/.
 */
#ifndef GZ_PROTOCOL_STORED_FILE_H
#define GZ_PROTOCOL_STORED_FILE_H

#include <stddef.h>

#include "base/log.h"
#include "base/option.h"
#include "base/result.h"

/** Most keys of a form. */
#define GZ_STORED_KEYS_MAX 32

/** What a kind of file holds. */
struct gz_stored_form {
	const struct gz_option *keys; /**< "section.name", all in one section */
	size_t count;                 /**< at most GZ_STORED_KEYS_MAX */
	const char *comment;          /**< lines before the section, each "; …\n" */
	const char *section;          /**< without brackets */
	const char *remedy;           /**< what to do about a file that lacks a key */
};

/**
 * Read a file, which is untrusted.
 *
 * @param[in,out] target  the struct of the form's offsets; undefined unless GZ_OK is returned
 * @retval GZ_ERR_NOT_FOUND  no such file; not logged
 * @retval GZ_ERR_IO         the file cannot be read; logged
 * @retval GZ_ERR_FORMAT     a line is refused or a key is missing; logged
 * @retval GZ_ERR_NO_MEM     out of memory
 */
enum gz_result gz_stored_read(const struct gz_stored_form *form, const char *path,
			      const struct gz_log *log, void *target);

/** Parse the content of a file, @p size bytes at @p text, like gz_stored_read(); @p name is the
 * file's name in messages. */
enum gz_result gz_stored_parse(const struct gz_stored_form *form, const char *name,
			       const char *text, size_t size, const struct gz_log *log,
			       void *target);

/**
 * Write a file and make the directories that it needs (mode 0700; root's 0755). An existing file
 * stays until the new one is on the disk.
 *
 * @retval GZ_ERR_ACCESS  no permission; logged
 * @retval GZ_ERR_IO      any other error; logged
 */
enum gz_result gz_stored_write(const struct gz_stored_form *form, const char *path,
			       const void *target, const struct gz_log *log);

#endif
