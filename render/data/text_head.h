/**
 * @file
 * Text headers of files, read line by line: NRRD and MetaImage.
 */
#ifndef GZ_RENDER_DATA_TEXT_HEAD_H
#define GZ_RENDER_DATA_TEXT_HEAD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"

/** Longest header that is read, bytes. Chosen: real ones have a few thousand, with comments. */
#define GZ_TEXT_HEAD_MAX ((size_t)256 << 10)

/** A header that is being read. Zero-initialised may be freed. */
struct gz_text_head {
	const char *path; /**< borrowed */
	const struct gz_log *log;
	char *bytes;     /**< owned */
	size_t size, at; /**< bytes read from the file; bytes given as lines */
	int line;        /**< number of the last line given, from 1 */
};

/** Read the first GZ_TEXT_HEAD_MAX bytes of a file, or the whole file if it is shorter. Errors of
 *  gz_byte_stream_open() and gz_byte_stream_read(), all logged. */
enum gz_result gz_text_head_open(struct gz_text_head *head, const char *path,
				 const struct gz_log *log);

/**
 * The next line, without its end (LF or CR LF), NUL-terminated in place.
 *
 * @return NULL at the end of the file, or if the rest of the header has no end of line
 */
char *gz_text_head_line(struct gz_text_head *head);

/** Log "path:line: key: what" and return GZ_ERR_FORMAT. */
enum gz_result gz_text_head_refuse(const struct gz_text_head *head, const char *key,
				   const char *what);

/** Remove the blanks at both ends, in place; returns the new beginning. */
char *gz_text_trim(char *text);

/** Read @p text as exactly @p count numbers, separated by blanks. Changes @p text. Returns false if
 *  it is anything else. */
bool gz_text_numbers(char *text, double *out_numbers, int count);

/** As gz_text_numbers(), for whole numbers within the range of int. */
bool gz_text_wholes(char *text, int *out_numbers, int count);

/** Free the header's bytes and zero it. */
void gz_text_head_free(struct gz_text_head *head);

#endif
