/**
 * @file
 * Importance by gaze: the object that is looked at becomes more important while the gaze rests on
 * it, as in Lu, Maciejewski and Ebert, "Volume composition using eye tracking data", EuroVis 2006.
 * One object at a time is raised, or of a volume one range of values; it fades in and out. Pure
 * steps over a state, as those of render/attention/attention.h.
 */
#ifndef GZ_RENDER_ATTENTION_INTEREST_H
#define GZ_RENDER_ATTENTION_INTEREST_H

#include <stdbool.h>
#include <stdint.h>

#include "render/attention/attention.h"

/** What somebody looks at. Zero-initialised: nothing. */
struct gz_looked_at {
	uint32_t id;            /**< number of the object; 0: none */
	double value;           /**< of a volume: what is seen of it */
	double least, greatest; /**< of a volume: the values that look alike, with value; equal: the
				   object is no volume */
};

/** What is raised in a picture. Zero-initialised: nothing. */
struct gz_raised {
	uint32_t id;            /**< number of the object; 0: none */
	double share;           /**< of the way from its importance to 1, [0, 1] */
	double least, greatest; /**< of a volume: the values that are raised; equal: all of it */
};

/** The state; plain data. Zero-initialised is the start: nothing has been looked at. */
struct gz_interest {
	struct gz_looked_at looked_at; /**< at the gaze */
	int64_t since_ns;              /**< since when */
	struct gz_looked_at raised;    /**< what is raised, or fades */
	double fade;                   /**< how far it has faded in, [0, 1] */
	int64_t now_ns;                /**< of the newest step */
	bool started;                  /**< there was a step */
};

/**
 * Advance by one frame. An object that is looked at for params->importance_dwell_ms becomes the one
 * to be raised; what was raised before fades out first. The same holds for what is no object. Of a
 * volume, a range of values stands in place of an object: it is looked at as long as the value that
 * is seen lies within the range that the look began with.
 *
 * @param now_ns     any origin; a time before the last one counts as the last
 */
struct gz_interest gz_interest_step(struct gz_interest interest,
				    const struct gz_attention_params *params,
				    const struct gz_looked_at *looked_at, int64_t now_ns);

/** What a picture raises: fades begin and end smoothly. */
struct gz_raised gz_interest_raised(const struct gz_interest *interest,
				    const struct gz_attention_params *params);

/** Whether the state stays as it is while the same object is looked at. */
bool gz_interest_at_rest(const struct gz_interest *interest);

/** Whether both give the same picture. */
bool gz_raised_same(const struct gz_raised *a, const struct gz_raised *b);

/** The importance of an object, of which a share is raised. */
double gz_raised_importance(double importance, double share);

#endif
