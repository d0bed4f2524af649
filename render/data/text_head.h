/**
 * @file
 * The text at the beginning of a file, line by line: the headers of NRRD and MetaImage.
 */
#ifndef GZ_RENDER_DATA_TEXT_HEAD_H
#define GZ_RENDER_DATA_TEXT_HEAD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"

/** Longest header read, bytes. Chosen: comments and all, real ones have a few thousand. */
#define GZ_TEXT_HEAD_MAX ((size_t)256 << 10)

/** A header in reading. Zero-initialised may be freed. */
struct gz_text_head {
	const char *path; /**< borrowed */
	const struct gz_log *log;
	char *bytes; /**< owned */
	size_t size, at;
	int line; /**< number of the line last given, from 1 */
};

/** Read the first GZ_TEXT_HEAD_MAX bytes of a file, or all it has. Errors as gz_byte_stream_open()
 * and gz_byte_stream_read(), all logged. */
enum gz_result gz_text_head_open(struct gz_text_head *head, const char *path,
				 const struct gz_log *log);

/**
 * The next line, NUL-terminated in place, without its end (LF or CR LF).
 *
 * @return NULL at the end, or where the rest holds no end of line and is not the end of the file
 */
char *gz_text_head_line(struct gz_text_head *head);

/** Log "path:line: key: what" and return GZ_ERR_FORMAT. */
enum gz_result gz_text_head_refuse(const struct gz_text_head *head, const char *key,
				   const char *what);

/** Cut the blanks off both ends, in place; returns the new beginning. */
char *gz_text_trim(char *text);

/** Read @p text as exactly @p count numbers, separated by blanks. Changes @p text. */
bool gz_text_numbers(char *text, double *out_numbers, int count);

/** As gz_text_numbers(), for whole numbers within int. */
bool gz_text_wholes(char *text, int *out_numbers, int count);

/** Free what it holds and zero it. */
void gz_text_head_free(struct gz_text_head *head);

#endif
