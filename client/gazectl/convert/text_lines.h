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

/** Longest line, bytes. Chosen: ten times the widest export seen. */
#define GZ_TEXT_LINE_SIZE 65536

/** Most fields of a line. Chosen: Tobii's exports have some hundred columns. */
#define GZ_TEXT_FIELDS_MAX 512

/** A file being read line by line. */
struct gz_text_lines;

/**
 * Open @p path, plain or gzip.
 *
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_ACCESS, GZ_ERR_IO, GZ_ERR_NO_MEM  not logged
 */
enum gz_result gz_text_lines_open(const char *path, struct gz_text_lines **out_lines);

/** As gz_text_lines_open() over memory, which must stay until the lines are closed; plain text. */
enum gz_result gz_text_lines_open_memory(const void *bytes, size_t size,
					 struct gz_text_lines **out_lines);

/**
 * The next line, without its end ("\n" or "\r\n"), a byte order mark cut off the first. Bytes of 0
 * in a line become blanks.
 *
 * @param[out] out_line  may be written to; valid until the next call
 * @retval GZ_ERR_END     there is none
 * @retval GZ_ERR_FULL    it is longer than GZ_TEXT_LINE_SIZE - 1; skipped, the next one may follow
 * @retval GZ_ERR_IO      reading or decompressing failed
 */
enum gz_result gz_text_lines_next(struct gz_text_lines *lines, char **out_line);

/** Give the newest line again, unchanged, at the next call. Call it before the line is written to.
 */
void gz_text_lines_again(struct gz_text_lines *lines);

/** Number of the newest line, from 1. */
uint64_t gz_text_lines_number(const struct gz_text_lines *lines);

/** Close and set to NULL. Accepts a pointer to NULL. */
void gz_text_lines_close(struct gz_text_lines **lines);

/** Fields of a line. */
struct gz_text_fields {
	size_t count;
	char *field[GZ_TEXT_FIELDS_MAX];
};

/**
 * Split @p line at each @p separator; quotes round a field are taken off. Fields beyond
 * GZ_TEXT_FIELDS_MAX are left out. A blank as @p separator stands for any run of blanks and tabs.
 */
void gz_text_split(char *line, char separator, struct gz_text_fields *out_fields);

/** The field's number, NaN where it is empty, no number or not there. A decimal comma counts as a
 * point. */
double gz_text_field_number(const struct gz_text_fields *fields, size_t index);

/**
 * Take a number off the front of @p *text, which is moved behind it and the blanks that follow.
 *
 * @param[out] out_value  written only on true
 */
bool gz_text_take_number(const char **text, double *out_value);

/** Whether @p text begins with @p word, case not counting. */
bool gz_text_begins(const char *text, const char *word);

/** Copy @p text to @p to, cut at a whole character where it is too long; bytes that are no UTF-8
 * become '?'. */
void gz_text_copy(char *to, size_t size, const char *text);

#endif
