/**
 * @file
 * A check of a tracker's calibration: the targets that were shown, the samples taken meanwhile,
 * their evaluation, and the report of it as a table, as JSON and as a picture.
 */
#ifndef GZ_CLIENT_GAZECTL_VALIDATE_VALIDATION_H
#define GZ_CLIENT_GAZECTL_VALIDATE_VALIDATION_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "base/log.h"
#include "base/result.h"
#include "client/gazectl/validate/correction.h"
#include "client/gazectl/validate/gaze_quality.h"
#include "protocol/display.h"
#include "protocol/gaze.h"

/** Samples count from this long after a target appears, ns, or from when the eye lands on it if
 * that is later. Chosen: a saccade begins after 200 ms, takes up to 80 ms, and a second one
 * corrects it. */
#define GZ_VALIDATION_SETTLE_NS INT64_C(800000000)

/** A saccade that begins earlier than this after a target appears, ns, is not a reaction to it: the
 * fastest, express saccades, begin after 80 to 120 ms (Fischer and Ramsperger, "Human express
 * saccades: extremely short reaction times of goal directed eye movements", Experimental Brain
 * Research 57, 1984). */
#define GZ_VALIDATION_REACTION_NS INT64_C(80000000)

/** One target, and the gaze while it was shown. */
struct gz_validation_target {
	struct gz_point point;       /**< on the display */
	int64_t shown_ns, hidden_ns; /**< when it appeared and vanished, host time */
	int64_t begin_ns;            /**< samples count from here to hidden_ns, host time */
	size_t first, count;         /**< these samples in the trace */
	struct gz_quality quality[GZ_TRACE_COUNT];
};

/** A whole check. */
struct gz_validation {
	struct gz_status status;         /**< of the daemon: tracker, rate, display, correction */
	char started[32];                /**< UTC, ISO 8601 */
	struct gz_monitor_place monitor; /**< that showed the targets; zeroed if unknown */
	size_t target_count;
	struct gz_validation_target target[GZ_FIT_TARGETS_MAX];
	struct gz_gaze_trace trace;
	struct gz_quality_summary summary[GZ_TRACE_COUNT];
	struct gz_fit fit; /**< from the means of both eyes together at the targets */
};

/**
 * Compute everything that follows from the display, the positions and times of the targets, and the
 * trace.
 *
 * @retval GZ_ERR_NO_MEM  no memory
 * @retval GZ_ERR_INVAL   the status' display is not valid
 */
enum gz_result gz_validation_evaluate(struct gz_validation *validation);

/** Print a table: a line for each target, for both eyes together and for each eye, and the effect
 * of a correction. The caller checks ferror(). */
void gz_validation_print(const struct gz_validation *validation, FILE *out);

/**
 * Write everything as one JSON object: angles in degrees, times in ns of the host's monotonic
 * clock, points on the normalised display area; null if there were too few samples. The caller
 * checks ferror().
 *
 * @retval GZ_ERR_NO_MEM  no memory; logged
 */
enum gz_result gz_validation_write_json(const struct gz_validation *validation, FILE *out,
					const struct gz_log *log);

/** Draw the display as SVG 1.1: the targets, the samples that count, and a line from each target to
 * the mean of its samples. The caller checks ferror(). */
void gz_validation_draw(const struct gz_validation *validation, FILE *out);

#endif
