/**
 * @file
 * Whether the lid moves in front of the pupil, where the tracker measures what tells of it: the
 * size of the pupil, or its confidence. A guard beside the labels, which know points only: when the
 * lid covers the pupil, the middle of what is left of it moves, mostly down, and that looks like a
 * saccade.
 *
 * A pupil cannot change so fast by itself. In response to a bright light it becomes smaller by 5.5
 * mm per second at most (Gradle and Ackerman, "The reaction time of the normal pupil", Journal of
 * the American Medical Association 99, 1932), and larger more slowly. That is 4 % of a pupil of 3.5
 * mm within the 24 ms of the window. A turned eye shows its pupil narrower by the cosine of the
 * angle, less than 4 % up to 15 degrees. A closing lid covers a pupil within 30 to 50 ms.
 *
 * The lid moves the point up and down. So a pupil that seems to change while the eye moves across
 * is not covered; trackers measure pupils less exactly while the eye moves fast.
 */
#ifndef GZ_FILTER_LID_H
#define GZ_FILTER_LID_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "filter/median.h"
#include "protocol/display.h"
#include "protocol/gaze.h"

/** Settings. pipeline_options.c has the presets. */
struct gz_lid_params {
	double change; /**< least change of the pupil within the window, as a part of its usual
			  size; 0 switches the guard off */
};

/** Samples that are kept: the window at 2000 Hz. A power of two. */
#define GZ_LID_RING 64

/** What is measured: the pupil of each eye, and the confidence. */
#define GZ_LID_MEASURES (GZ_EYE_COUNT + 1)

/** One sample in the ring. */
struct gz_lid_entry {
	int64_t time_ns;
	struct gz_point point;
	double size[GZ_LID_MEASURES]; /**< NaN: not measured */
};

/** State of this step. Zero-initialised is the start state: the lid is open. Plain data. */
struct gz_lid_state {
	struct gz_lid_entry ring[GZ_LID_RING];
	uint64_t count;  /**< samples taken */
	uint64_t oldest; /**< of them, the oldest one within the window of the newest */
	struct gz_median usual[GZ_LID_MEASURES];
	struct gz_median noise[GZ_LID_MEASURES]; /**< usual change within the window, of usual */
	int64_t measured_ns;                     /**< when something was measured last */
	int64_t moved_ns;                        /**< when the lid was last seen to move */
	bool covers;
};

/** What the step says about a sample. */
struct gz_lid_output {
	bool covers;      /**< whether the lid covers the pupil, or a part of it */
	int64_t since_ns; /**< if it covers: since when, host time; at most the window ago */
};

/**
 * Take a sample.
 *
 * @param point  of the sample; the eye is where the last one was if it is not finite
 * @param confidence  of the point; NaN: unknown
 *
 * Does not allocate. Samples without pupil and confidence change nothing.
 */
struct gz_lid_output gz_lid_step(struct gz_lid_state *state, const struct gz_lid_params *params,
				 const struct gz_display *display, const struct gz_sample *sample,
				 struct gz_point point, float confidence);

#endif
