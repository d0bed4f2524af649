/**
 * @file
 * How well a tracker's samples tell where somebody looks, from samples taken while a target was
 * fixated. In degrees at the eye, as laboratories report them:
 *
 * - accuracy: the mean angle between target and sample, 1/n sum(theta_i) (Holmqvist, Nystroem and
 *   Mulvey, "Eye tracker data quality: what it is and how to measure it", ETRA 2012)
 * - offset: from the target to the mean of the samples, to the right and down: the part of the
 *   accuracy that a correction can remove
 * - RMS-S2S: the root mean square of the angles between successive samples,
 *   sqrt(1/n sum(theta_i^2)) (ibid.)
 * - SD: sqrt(var_x + var_y), the spread round the samples' mean (Niehorster, Zemblys, Beelders and
 *   Holmqvist, "Characterizing gaze position signals and synthesizing noise during fixations in
 *   eye-tracking data", Behavior Research Methods 52, 2020); the variances divide by n - 1
 * - BCEA: the area of the ellipse that holds 68 % of the samples, 2 k pi sd_x sd_y sqrt(1 - rho^2),
 *   k = -ln(1 - 0.68) (ibid.)
 * - loss: the share of the samples that should have come and did not, or came without a place
 *
 * Accuracy and precision differ over the screen and between people, so each target has its own
 * numbers (Dalrymple, Manner, Harmelink, Teska and Elison, "An examination of recording accuracy
 * and precision from eye tracking data from toddlerhood to adulthood", Frontiers in Psychology 9,
 * 2018).
 */
#ifndef GZ_CLIENT_GAZECTL_VALIDATE_GAZE_QUALITY_H
#define GZ_CLIENT_GAZECTL_VALIDATE_GAZE_QUALITY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "protocol/display.h"
#include "protocol/gaze.h"

/** Whose place: an eye's (as enum gz_eye), or that of both together. */
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
	struct gz_point point[GZ_TRACE_COUNT]; /**< NaN where it was not measured */
	bool fixating;                         /**< by its certain label */
};

/** What the samples of one target say of one trace. Angles in degrees; NaN where there are too few
 *  samples to tell. */
struct gz_quality {
	uint64_t expected;    /**< samples that the time had room for */
	uint64_t measured;    /**< of these, with a place */
	uint64_t used;        /**< of these, while fixating: what the rest is made of */
	struct gz_point mean; /**< of the samples used, on the display */
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
	int64_t begin_ns, end_ns; /**< the time that the samples were taken in */
	int64_t period_ns;        /**< usual time between two; 0: unknown, nothing counts as lost */
};

/** Measure. Two samples are successive where no more than 1.5 periods lie between them. */
void gz_quality_measure(const struct gz_quality_input *input, enum gz_trace trace,
			struct gz_quality *out_quality);

/** Over several targets. Means over the targets that have samples; NaN if none has. */
struct gz_quality_summary {
	size_t targets; /**< that had samples */
	uint64_t expected, measured, used;
	double loss;
	double accuracy_deg;    /**< mean of the targets' */
	double accuracy_sd_deg; /**< their standard deviation, n - 1 */
	double worst_deg;       /**< their maximum */
	double offset_deg[2];   /**< mean of the targets': right, down */
	double rms_s2s_deg;
	double sd_deg;
	double bcea_deg2;
};

/** Summarise @p count targets, 0 or more. */
void gz_quality_summarise(const struct gz_quality *targets, size_t count,
			  struct gz_quality_summary *out_summary);

/** The median time between successive samples, ns; 0 where there are fewer than two. Changes
 *  nothing but allocates 8 bytes a sample. @return -1 where there is no memory */
int64_t gz_quality_period_ns(const struct gz_quality_sample *samples, size_t count);

/** Where @p point lies as seen from the eye, from @p target, degrees to the right and down: the
 *  angle between the two, split by its direction across the line of sight. */
void gz_quality_offset_deg(const struct gz_display *display, struct gz_point target,
			   struct gz_point point, double out_deg[2]);

#endif
