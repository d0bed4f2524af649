/**
 * @file
 * A check of a tracker's calibration: targets that were shown, the samples that came meanwhile, and
 * what they say together.
 */
#ifndef GZ_CLIENT_GAZECTL_VALIDATE_VALIDATION_H
#define GZ_CLIENT_GAZECTL_VALIDATE_VALIDATION_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "client/gazectl/validate/correction_fit.h"
#include "client/gazectl/validate/gaze_quality.h"
#include "client/gazectl/validate/gaze_trace.h"
#include "protocol/display.h"
#include "protocol/gaze.h"

/** Samples count from so long after a target was shown, ns, and later where the eye landed later.
 * Chosen: a saccade begins 200 ms after, takes up to 80 ms, and a second one corrects it. */
#define GZ_VALIDATION_SETTLE_NS INT64_C(800000000)

/** A saccade that begins sooner after a target was shown was not made for it, ns: the fastest ones,
 * express saccades, take 80 to 120 ms (Fischer and Ramsperger, "Human express saccades: extremely
 * short reaction times of goal directed eye movements", Experimental Brain Research 57, 1984). */
#define GZ_VALIDATION_REACTION_NS INT64_C(80000000)

/** One target, and what was seen of it. */
struct gz_validation_target {
	struct gz_point point;       /**< on the display */
	int64_t shown_ns, hidden_ns; /**< when it appeared and vanished, host time */
	int64_t begin_ns;            /**< from here to hidden_ns samples count */
	size_t first, count;         /**< those samples, in the trace */
	struct gz_quality quality[GZ_TRACE_COUNT];
};

/** A whole check. */
struct gz_validation {
	struct gz_status status; /**< of the daemon: tracker, rate, display, correction */
	char started[32];        /**< UTC, ISO 8601 */
	size_t target_count;
	struct gz_validation_target target[GZ_FIT_TARGETS_MAX];
	struct gz_gaze_trace trace;
	struct gz_quality_summary summary[GZ_TRACE_COUNT];
	struct gz_fit fit; /**< over the targets' means of both eyes together */
};

/**
 * Fill all that follows from the display, the targets' places and times, and the trace.
 *
 * @retval GZ_ERR_NO_MEM  no memory
 * @retval GZ_ERR_INVAL   the status' display is not valid
 */
enum gz_result gz_validation_evaluate(struct gz_validation *validation);

#endif
