/**
 * @file
 * A session: everything that the pictures of a run were made of, in a folder NAME.session
 * (docs/sessions.md):
 *
 * - GZ_SESSION_SCENE, GZ_SESSION_TRANSFER: the scene at the start;
 * - GZ_SESSION_FRAMES: a line for each frame, preceded by one for each setting that changed;
 * - GZ_SESSION_GAZE: a gaze log of the samples that the frames used (protocol/gaze_log.h).
 *
 * The functions here print and parse the lines of GZ_SESSION_FRAMES. They are pure. The parsers
 * check everything, as a file may come from anywhere. Numbers read back to the same bits.
 */
#ifndef GZ_VIEW_SESSION_SESSION_H
#define GZ_VIEW_SESSION_SESSION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "base/text.h"
#include "protocol/gaze.h"
#include "render/attention/interest.h"
#include "render/data/volume.h"
#include "render/illustration/illustration_automatic.h"
#include "view/gaze/gaze_source.h"

#define GZ_SESSION_ENDING   ".session"
#define GZ_SESSION_SCENE    "scene.scene"
#define GZ_SESSION_TRANSFER "transfer.tf"
#define GZ_SESSION_FRAMES   "frames.tsv"
#define GZ_SESSION_GAZE     "gaze.gzl"

/** Longest line with its newline, bytes; a longer one is malformed. Chosen: holds a transfer
 * function of GZ_TRANSFER_POINTS_MAX points with all digits. */
#define GZ_SESSION_LINE_SIZE 65536

/** The first line without its newline. */
#define GZ_SESSION_FIRST_LINE "#gazecast-session 1"

/** First words of the lines between frames. */
#define GZ_SESSION_SET_WORD      "!set"
#define GZ_SESSION_TRANSFER_WORD "!transfer"
#define GZ_SESSION_RAISE_WORD    "!raise"
#define GZ_SESSION_ADAPT_WORD    "!adapt"
#define GZ_SESSION_FINER_WORD    "!finer"

/** What all frames of a session share. */
struct gz_session_header {
	char started[GZ_NAME_SIZE];  /**< UTC, ISO 8601 */
	char software[GZ_NAME_SIZE]; /**< "gazeview 1.0" */
	char backend[GZ_NAME_SIZE];  /**< backend of the first frame: "cpu", "gl" */
	int64_t host_ns;             /**< time 0 of the frames on the host's clock */
	struct gz_volume_identity volume;
};

/** One frame. */
struct gz_session_frame {
	int64_t time_ns;           /**< since the session's host_ns, 0 or more */
	int width, height;         /**< px, 1 to GZ_IMAGE_SIDE_MAX */
	struct gz_display display; /**< the picture fills it */
	/** The gaze. Not stored: connected, seq and sample_ns, and the point of an unknown gaze. */
	struct gz_gaze_reading reading;
	struct gz_focus focus; /**< the plan was made for it; finer is in a line of its own */
	/** What was raised in importance, which is stored in a line of its own. */
	struct gz_raised raised;
	/** How an illustration's settings followed what was seen; in a line of its own, too. */
	struct gz_illustration_change change;
	bool kept;      /**< earlier frames contributed: temporal.accumulate */
	double took_ms; /**< for statistics */
};

/** Append the lines of the header, from GZ_SESSION_FIRST_LINE to the names of the columns. */
void gz_session_print_header(const struct gz_session_header *header, struct gz_text *text);

/** Append the line that says what is raised in importance from the next frame on. */
void gz_session_print_raised(const struct gz_raised *raised, struct gz_text *text);

/**
 * Parse that line.
 *
 * @param[in,out] line  without its newline, NUL-terminated; it is changed
 * @retval GZ_ERR_FORMAT  not a number of an object and a share
 */
enum gz_result gz_session_parse_raised(char *line, struct gz_raised *out_raised);

/** Append the line that says how much finer plans are than the method's from the next frame on. */
void gz_session_print_finer(double finer, struct gz_text *text);

/**
 * Parse that line.
 *
 * @param[in,out] line  without its newline, NUL-terminated; it is changed
 * @retval GZ_ERR_FORMAT  not a number from 1 to GZ_PLAN_FINER_MAX
 */
enum gz_result gz_session_parse_finer(char *line, double *out_finer);

/** Append the line that says how settings of an illustration are changed from the next frame on. */
void gz_session_print_change(const struct gz_illustration_change *change, struct gz_text *text);

/**
 * Parse that line.
 *
 * @param[in,out] line  without its newline, NUL-terminated; it is changed
 * @retval GZ_ERR_FORMAT  not five numbers within their limits
 */
enum gz_result gz_session_parse_change(char *line, struct gz_illustration_change *out_change);

/** Append the line of a frame with its newline. */
void gz_session_print_frame(const struct gz_session_frame *frame, struct gz_text *text);

/** Append the last line. @p crc is the CRC-32 (zlib) of all bytes before it. */
void gz_session_print_end(uint64_t frames, uint32_t crc, struct gz_text *text);

/**
 * Parse the line of a frame.
 *
 * @param[in,out] line  without its newline, NUL-terminated; its tabs become NULs
 * @param[out] out_what  on failure: what is wrong, usually the name of the column; static text
 * @retval GZ_ERR_FORMAT  too few or too many fields, or an invalid one
 */
enum gz_result gz_session_parse_frame(char *line, struct gz_session_frame *out_frame,
				      const char **out_what);

/**
 * Parse a line of the header other than the first. It begins with '#'.
 *
 * @param[in,out] line    without its newline, NUL-terminated; it is changed
 * @param[in,out] header  the line's field is set; unknown words, of later versions, are ignored
 * @retval GZ_ERR_FORMAT  the word is known and its value is invalid
 */
enum gz_result gz_session_parse_header_line(char *line, struct gz_session_header *header);

/** Parse a line of gz_session_print_end(). @return false if it is not one */
bool gz_session_parse_end(char *line, uint64_t *out_frames, uint32_t *out_crc);

#endif
