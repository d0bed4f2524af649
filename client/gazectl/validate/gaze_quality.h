/**
 * @file
 * Accuracy and precision of a tracker, from samples taken while a target was fixated. Degrees at
 * the eye, as laboratories report them:
 *
 * - accuracy: the mean angle between target and sample, 1/n sum(theta_i) (Holmqvist, Nystroem and
 *   Mulvey, "Eye tracker data quality: what it is and how to measure it", ETRA 2012)
 * - offset: from the target to the mean of the samples, to the right and down: the part of the
 *   error that a correction can remove
 * - RMS-S2S: the root mean square of the angles between successive samples,
 *   sqrt(1/n sum(theta_i^2)) (ibid.)
 * - SD: sqrt(var_x + var_y), the spread around the samples' mean (Niehorster, Zemblys, Beelders and
 *   Holmqvist, "Characterizing gaze position signals and synthesizing noise during fixations in
 *   eye-tracking data", Behavior Research Methods 52, 2020); the variances divide by n - 1
 * - BCEA: the area of the ellipse that contains 68 % of the samples, 2 k pi sd_x sd_y
 *   sqrt(1 - rho^2), k = -ln(1 - 0.68) (ibid.)
 * - loss: the share of the expected samples that did not come, or came without a point
 *
 * Accuracy and precision differ over the screen and between people, so each target is evaluated by
 * itself (Dalrymple, Manner, Harmelink, Teska and Elison, "An examination of recording accuracy
 * and precision from eye tracking data from toddlerhood to adulthood", Frontiers in Psychology 9,
 * 2018).
 */
#ifndef GZ_CLIENT_GAZECTL_VALIDATE_GAZE_QUALITY_H
#define GZ_CLIENT_GAZECTL_VALIDATE_GAZE_QUALITY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "protocol/display.h"
#include "protocol/gaze.h"

/** Which point of a sample: that of an eye (as enum gz_eye), or of both eyes together. */
enum gz_trace {
	GZ_TRACE_RIGHT = GZ_EYE_RIGHT,
	GZ_TRACE_LEFT = GZ_EYE_LEFT,
	GZ_TRACE_BOTH = GZ_EYE_COUNT,
	GZ_TRACE_COUNT,
};

/** "right", "left", "both". Static text. */
const char *gz_trace_name(enum gz_trace trace);

/** One sample, before smoothing. */
struct gz_quality_sample {
	int64_t host_ns;
	uint64_t seq;
	struct gz_point point[GZ_TRACE_COUNT]; /**< NaN: not measured */
	bool fixating;                         /**< by its final label, once that is known */
};

/** The quality of one trace at one target. Angles in degrees; NaN if there are too few samples. */
struct gz_quality {
	uint64_t expected;    /**< samples expected in the time at the usual rate */
	uint64_t measured;    /**< of these, samples with a point */
	uint64_t used;        /**< of these, samples of fixations: the numbers below are theirs */
	struct gz_point mean; /**< mean point of the samples used, on the display */
	double loss;          /**< 1 - measured / expected, [0, 1] */
	double accuracy_deg;
	double offset_deg[2]; /**< from the target, right and down */
	double rms_s2s_deg;
	double sd_deg;
	double sd_axis_deg[2]; /**< right, down */
	double bcea_deg2;      /**< square degrees */
};

/** The samples of one target. */
struct gz_quality_input {
	const struct gz_display *display; /**< valid */
	struct gz_point target;           /**< finite */
	const struct gz_quality_sample *samples;
	size_t count;
	int64_t begin_ns, end_ns; /**< when the samples were taken, host time */
	int64_t period_ns;        /**< usual time between two; 0: unknown, nothing counts as lost */
};

/** Measure the quality of a trace. Two samples are successive if they are at most 1.5 periods
 * apart.
 */
void gz_quality_measure(const struct gz_quality_input *input, enum gz_trace trace,
			struct gz_quality *out_quality);

/** The quality over several targets: means over the targets that have samples; NaN if none has. */
struct gz_quality_summary {
	size_t targets; /**< targets with samples */
	uint64_t expected, measured, used;
	double loss;
	double accuracy_deg;    /**< mean over the targets */
	double accuracy_sd_deg; /**< standard deviation between the targets, n - 1 */
	double worst_deg;       /**< maximum over the targets */
	double offset_deg[2];   /**< mean over the targets: right, down */
	double rms_s2s_deg;
	double sd_deg;
	double bcea_deg2;
};

/** Summarise @p count targets, 0 or more. */
void gz_quality_summarise(const struct gz_quality *targets, size_t count,
			  struct gz_quality_summary *out_summary);

/** The median time between successive samples, ns; 0 if there are fewer than two. Allocates 8 bytes
 * a sample. @return -1 without memory */
int64_t gz_quality_period_ns(const struct gz_quality_sample *samples, size_t count);

/** The direction of @p point from @p target as seen from the eye, degrees to the right and down:
 * the angle between the two, split by its direction across the line of sight. */
void gz_quality_offset_deg(const struct gz_display *display, struct gz_point target,
			   struct gz_point point, double out_deg[2]);

/*
 * A trace: the samples of some time, as the stream brings them. The final label of a sample comes a
 * few samples later, with another message.
 */

/** Most samples in a trace. Chosen: half an hour at 2000 Hz. */
#define GZ_GAZE_TRACE_MAX 3600000

/** A sample and its label. */
struct gz_gaze_trace_sample {
	struct gz_quality_sample sample;
	enum gz_event event; /**< the final label; until that is known, the preliminary one */
};

/** Samples in the order in which they came. Zero-initialised: empty. */
struct gz_gaze_trace {
	struct gz_gaze_trace_sample *items;
	size_t count;
	size_t room;
};

/**
 * Append a sample, and apply the final label that comes with it to the earlier samples that it
 * describes. A sample that is not newer than the last one is not appended.
 *
 * @retval GZ_ERR_NO_MEM  no memory; the trace is unchanged
 * @retval GZ_ERR_FULL    the trace has GZ_GAZE_TRACE_MAX samples
 */
enum gz_result gz_gaze_trace_add(struct gz_gaze_trace *trace, const struct gz_gaze *gaze);

/** Index of the first sample at @p host_ns or later; @p trace->count if there is none. */
size_t gz_gaze_trace_find(const struct gz_gaze_trace *trace, int64_t host_ns);

/** Free the samples and make the trace empty. */
void gz_gaze_trace_clear(struct gz_gaze_trace *trace);

#endif
