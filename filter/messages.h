/**
 * @file
 * Last step: fixation, blink and saccade messages out of the certain labels.
 */
#ifndef GZ_FILTER_MESSAGES_H
#define GZ_FILTER_MESSAGES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "filter/classify.h"
#include "protocol/display.h"
#include "protocol/gaze.h"

/** Most fixation messages of one step: the end of one and the onset of the next. */
#define GZ_FIXATION_MESSAGES_MAX 2

/** Most blink messages of one step: a gap in sample time is a whole blink. */
#define GZ_BLINK_MESSAGES_MAX 2

/** Shortest time between two messages of a lasting fixation, ns: 30 a second. */
#define GZ_FIXATION_INTERVAL_NS INT64_C(33333334)

/** Zero-initialised is the start state. */
struct gz_messages_state {
	bool running;                /**< a fixation runs */
	bool announced;              /**< and its onset was sent */
	struct gz_fixation fixation; /**< as it would be sent now */
	uint64_t samples;            /**< of it */
	double sum[2];               /**< of their points */
	double confidence_sum;
	struct gz_point box[2];   /**< smallest and greatest coordinates of it */
	int64_t last_ns;          /**< its newest sample */
	int64_t sent_ns;          /**< newest message about it, sample time */
	struct gz_point previous; /**< newest good certain sample */
	int64_t previous_ns;
	bool has_previous;
	bool in_saccade;
	struct gz_saccade saccade; /**< the running one so far */
	bool in_blink;             /**< an onset was sent, the offset not yet */
	int64_t valid_ns;          /**< newest good sample */
	bool any_valid;
};

/** Messages of one step, in order. */
struct gz_messages {
	size_t fixation_count;
	struct gz_fixation fixations[GZ_FIXATION_MESSAGES_MAX];
	size_t blink_count;
	struct gz_blink blinks[GZ_BLINK_MESSAGES_MAX];
	size_t saccade_count; /**< 0 or 1 */
	struct gz_saccade saccades[1];
};

/**
 * Take the labels of one sample.
 *
 * @param label       what gz_classify_step() answered
 * @param time_ns     of the newest sample
 * @param confidence  of the newest sample, [0, 1]
 * @param fixation_min_ns  shorter fixations are not announced
 * @param[out] out    always filled
 *
 * A fixation's id is the seq of its first sample. Its first message comes when it has lasted
 * fixation_min_ns, the next ones at most 30 a second, the last one, final, at its end. A blink's
 * onset is the newest good sample before it, its offset the first good one after; a blink that
 * turns out too long to be one ends with confidence 0. A saccade is told at its end.
 */
void gz_messages_step(struct gz_messages_state *state, const struct gz_display *display,
		      int64_t fixation_min_ns, const struct gz_classify_output *label,
		      int64_t time_ns, float confidence, struct gz_messages *out);

#endif
