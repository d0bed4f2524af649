/**
 * @file
 * What the files that implement classify.h share; nobody else includes it.
 */
#ifndef GZ_FILTER_CLASSIFY_INTERNAL_H
#define GZ_FILTER_CLASSIFY_INTERNAL_H

#include "filter/classify.h"

/** Sample @p index of the ring; the last RING ones may be asked for. */
static inline struct gz_classify_entry *gz_classify_at(struct gz_classify_state *state,
						       uint64_t index)
{
	return &state->ring[index % GZ_CLASSIFY_RING];
}

/** Longest time since the last good sample, for one without, that is not a blink, ns. From good
 *  sample to good sample one period more. */
double gz_classify_dropout_ns(const struct gz_classify_state *state,
			      const struct gz_classify_params *params);

/** How many newer samples a label waits for at the measured rate. */
uint64_t gz_classify_delay(const struct gz_classify_state *state,
			   const struct gz_classify_params *params);

/** A stretch of time round a sample, ns. */
struct gz_classify_window {
	double before_ns, after_ns;
};

/**
 * Velocity at sample @p index: slope of the least-squares line through the good samples of the
 * window, at least to the neighbours, not across a loss. 0 where there is no neighbour.
 */
void gz_classify_velocity(struct gz_classify_state *state, uint64_t index,
			  struct gz_classify_window window, double out_deg_s[3]);

/** Measure the speed of all samples up to @p end whose window is complete, or all if @p force. */
void gz_classify_measure(struct gz_classify_state *state, const struct gz_classify_params *params,
			 uint64_t end, bool force);

/** The certain label of sample @p index, the next one in order. */
enum gz_event gz_classify_decide(struct gz_classify_state *state,
				 const struct gz_classify_params *params, uint64_t index);

/**
 * A stretch between saccades begins: take what the last one was into the odds, and say what this
 * one is on these alone.
 *
 * @param forget  the last one says nothing, nor those before
 */
void gz_classify_begin_interval(struct gz_classify_state *state,
				const struct gz_classify_params *params, bool forget);

/** Fixation or pursuit, now that the slow movement was measured anew? */
void gz_classify_weigh(struct gz_classify_state *state, const struct gz_classify_params *params);

/** Forget the slow movement's bins, at a saccade or loss. */
void gz_classify_slow_restart(struct gz_classify_slow *slow);

/**
 * Take a sample between saccades.
 *
 * @return whether the slope was measured anew
 */
bool gz_classify_slow_step(struct gz_classify_slow *slow, const struct gz_classify_params *params,
			   const struct gz_classify_entry *entry);

#endif
