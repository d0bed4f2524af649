/**
 * @file
 * The lines of a session's GZ_SESSION_FRAMES: pure formatters, and parsers of what anybody may have
 * written (docs/sessions.md has the layout). Numbers keep their bits.
 */
#ifndef GZ_VIEW_SESSION_TEXT_H
#define GZ_VIEW_SESSION_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "base/text.h"
#include "view/session/session.h"

/** Longest line with its newline, bytes; longer is malformed. Chosen: a transfer function of
 * GZ_TRANSFER_POINTS_MAX points with all their digits fits in. */
#define GZ_SESSION_LINE_SIZE 65536

/** The first line without its newline. */
#define GZ_SESSION_FIRST_LINE "#gazecast-session 1"

/** Words that begin the lines between frames. */
#define GZ_SESSION_SET_WORD      "!set"
#define GZ_SESSION_TRANSFER_WORD "!transfer"

/** Append the header's lines, the first one and that of the columns' names too. */
void gz_session_print_header(const struct gz_session_header *header, struct gz_text *text);

/** Append a frame's line with its newline. */
void gz_session_print_frame(const struct gz_session_frame *frame, struct gz_text *text);

/** Append the line that ends a session, with the CRC-32 (zlib) of all bytes before it. */
void gz_session_print_end(uint64_t frames, uint32_t crc, struct gz_text *text);

/**
 * Read a frame's line.
 *
 * @param[in,out] line  without its newline, NUL-terminated; its tabs become NULs
 * @param[out] out_what  on failure the column that is wrong; static text
 * @retval GZ_ERR_FORMAT  a field is missing, too many, or not what it must be
 */
enum gz_result gz_session_parse_frame(char *line, struct gz_session_frame *out_frame,
				      const char **out_what);

/**
 * Read a line of the header, which begins with '#', other than the first.
 *
 * @param[in,out] line    as above
 * @param[in,out] header  the field that the line is about is filled; words that are not known
 *                        change nothing, for a later version
 * @retval GZ_ERR_FORMAT  the word is known and what follows is wrong
 */
enum gz_result gz_session_parse_header_line(char *line, struct gz_session_header *header);

/** Read a line that gz_session_print_end() has written. @return whether it is one */
bool gz_session_parse_end(char *line, uint64_t *out_frames, uint32_t *out_crc);

#endif
