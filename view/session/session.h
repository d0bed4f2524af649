/**
 * @file
 * What a session is: everything that the pictures of a while were made of, in a folder NAME.session
 * (docs/sessions.md):
 *
 * - GZ_SESSION_SCENE, GZ_SESSION_TRANSFER: the scene as it was at the start;
 * - GZ_SESSION_FRAMES: a line for each frame, and before it one for each setting that has changed;
 * - GZ_SESSION_GAZE: a gaze log of the samples that the frames saw (protocol/gaze_log.h).
 */
#ifndef GZ_VIEW_SESSION_H
#define GZ_VIEW_SESSION_H

#include "base/text.h"
#include "view/session/session.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "protocol/gaze.h"
#include "render/attention/attention.h"
#include "render/data/volume_identity.h"
#include "view/gaze/gaze_source.h"

#define GZ_SESSION_ENDING   ".session"
#define GZ_SESSION_SCENE    "scene.scene"
#define GZ_SESSION_TRANSFER "transfer.tf"
#define GZ_SESSION_FRAMES   "frames.tsv"
#define GZ_SESSION_GAZE     "gaze.gzl"

/** What is the same for all frames. */
struct gz_session_header {
	char started[GZ_NAME_SIZE];  /**< UTC, ISO 8601 */
	char software[GZ_NAME_SIZE]; /**< "gazeview 1.0" */
	char backend[GZ_NAME_SIZE];  /**< what cast the first frame: "cpu", "gl" */
	int64_t host_ns;             /**< time 0 of the frames on the host's clock */
	struct gz_volume_identity volume;
};

/** A frame that was shown. */
struct gz_session_frame {
	int64_t time_ns;           /**< since the session's host_ns, 0 or more */
	int width, height;         /**< px, 1 to GZ_IMAGE_SIDE_MAX */
	struct gz_display display; /**< of the picture */
	struct gz_gaze_reading
		reading;       /**< but for connected and, where not known, point: not kept */
	struct gz_focus focus; /**< what the plan was made of */
	bool kept;             /**< what earlier frames saw is in it: temporal.accumulate */
	double took_ms;        /**< for statistics */
};

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
