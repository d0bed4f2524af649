/**
 * @file
 * UTF-8 (RFC 3629) of text that comes from outside: file names, headers, messages.
 */
#ifndef GZ_BASE_UTF8_H
#define GZ_BASE_UTF8_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Bytes of the character at the beginning of @p text, 1 to 4; 0 if it is not UTF-8.
 *
 * @param text  @p left bytes; a NUL counts as a character of one byte
 * @param left  bytes that may be read, at least 1
 */
size_t gz_utf8_length(const char *text, size_t left);

/**
 * Replace control characters and bytes that are not UTF-8 by '?', so that a terminal, a log and a
 * window can show the text on one line.
 *
 * @param[in,out] text  NUL-terminated; its length does not change
 */
void gz_utf8_clean(char *text);

#ifdef __cplusplus
}
#endif

#endif
