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

/** Directions in which a fixation's outermost samples are kept: dispersion is then at most 8 %
 *  short (cos 22.5 degrees) of the greatest distance. */
#define GZ_FIXATION_DIRECTIONS 8

/** The running fixation. */
struct gz_messages_fixation {
	bool running;
	bool announced; /**< its onset was sent */
	uint64_t id;
	int64_t onset_ns, last_ns; /**< first and newest sample */
	int64_t sent_ns;           /**< newest message about it, sample time */
	uint64_t count;            /**< samples */
	double sum[2];             /**< of their points */
	double confidence_sum;
	struct gz_point outermost[GZ_FIXATION_DIRECTIONS];
};

/** The running saccade. */
struct gz_messages_saccade {
	bool running;
	int64_t start_ns;
	struct gz_point start;
};

/** Zero-initialised is the start state. */
struct gz_messages_state {
	struct gz_messages_fixation fixation;
	struct gz_messages_saccade saccade;
	bool in_blink; /**< an onset was sent, the offset not yet */
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
 * A fixation's id is the seq of its first sample. Its first message comes when it has lasted
 * fixation_min_ms, the next ones at most 30 a second, the last one, final, at its end; a shorter
 * one is never told. A blink's onset is the newest good sample before it, its offset the first good
 * one after; one that grows too long to be a blink ends, with confidence 0, where that is seen. A
 * saccade is told at its end; one that a blink cuts off is not.
 *
 * @param label       what gz_classify_step() answered
 * @param time_ns     of the newest sample
 * @param[out] out    always filled
 */
void gz_messages_step(struct gz_messages_state *state, const struct gz_classify_params *params,
		      const struct gz_display *display, const struct gz_classify_output *label,
		      int64_t time_ns, struct gz_messages *out);

#endif
