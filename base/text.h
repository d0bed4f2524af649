/**
 * @file
 * Text that grows, and its way to a file and from one.
 */
#ifndef GZ_BASE_TEXT_H
#define GZ_BASE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"

/** Zero-initialised is empty. */
struct gz_text {
	char *bytes; /**< length of them and a NUL; NULL while empty */
	size_t length, room;
	bool failed; /**< no memory: what followed is missing */
};

/** Append as printf does. */
__attribute__((format(printf, 2, 3))) void gz_text_add(struct gz_text *text, const char *format,
						       ...);

/** Append @p size bytes as they are. */
void gz_text_add_bytes(struct gz_text *text, const char *bytes, size_t size);

/** Free what it holds and zero it. */
void gz_text_free(struct gz_text *text);

/**
 * Write it to a file under another name first, so that what is there is whole or as it was. Where
 * @p path is a link, the file that it leads to is replaced.
 *
 * @retval GZ_ERR_NO_MEM  the text is not whole; logged
 * @retval GZ_ERR_IO      logged
 */
enum gz_result gz_text_write(const struct gz_text *text, const char *path,
			     const struct gz_log *log);

/**
 * Append a file's bytes.
 *
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_IO  not logged: the caller knows what it is for
 * @retval GZ_ERR_NO_MEM
 */
enum gz_result gz_text_add_file(struct gz_text *text, const char *path);

#endif
