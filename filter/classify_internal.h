/**
 * @file
 * What classify.c and classify_decide.c share; no other file includes it.
 */
#ifndef GZ_FILTER_CLASSIFY_INTERNAL_H
#define GZ_FILTER_CLASSIFY_INTERNAL_H

#include "filter/classify.h"

/** Sample @p index of the ring; it must be one of the last GZ_CLASSIFY_RING. */
static inline struct gz_classify_entry *gz_classify_at(struct gz_classify_state *state,
						       uint64_t index)
{
	return &state->ring[index % GZ_CLASSIFY_RING];
}

/** Whether a sample was measured and shows the eye. */
static inline bool gz_classify_is_good(const struct gz_classify_params *params,
				       const struct gz_classify_entry *entry)
{
	return entry->valid && !entry->lid &&
	       !(params->source == GZ_CLASSIFY_LEARNED && entry->learned == GZ_FOREST_NOISE);
}

/** The event of a class other than noise. */
static inline enum gz_event gz_classify_event_of(enum gz_forest_class learned)
{
	return learned == GZ_FOREST_SACCADE   ? GZ_EVENT_SACCADE
	       : learned == GZ_FOREST_PURSUIT ? GZ_EVENT_PURSUIT
	       : learned == GZ_FOREST_RINGING ? GZ_EVENT_OSCILLATION
					      : GZ_EVENT_FIXATION;
}

/** Longest time without a good sample that is not a blink, from the last good sample to one without
 * a measurement, ns. From good sample to good sample it is one period longer. */
double gz_classify_dropout_ns(const struct gz_classify_state *state,
			      const struct gz_classify_params *params);

/** How many newer samples a certain label waits for, at the measured rate. */
uint64_t gz_classify_delay(const struct gz_classify_state *state,
			   const struct gz_classify_params *params);

/** Decide the certain label of sample @p index, the next one in order: state->machine.event. */
void gz_classify_decide(struct gz_classify_state *state, const struct gz_classify_params *params,
			uint64_t index);

/** Forget the bins of the slow movement, at a saccade or loss. */
void gz_classify_slow_restart(struct gz_classify_slow *slow);

/**
 * Take a sample between saccades into the slow movement.
 *
 * @return whether its velocity was measured again
 */
bool gz_classify_slow_step(struct gz_classify_slow *slow, const struct gz_classify_params *params,
			   const struct gz_classify_entry *entry);

#endif
