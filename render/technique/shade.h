/**
 * @file
 * How much of the light comes through what a technique shows: how techniques of one picture cast
 * shadows on each other.
 */
#ifndef GZ_RENDER_TECHNIQUE_SHADE_H
#define GZ_RENDER_TECHNIQUE_SHADE_H

#include <stdint.h>

/** Places that are asked for at a time. */
#define GZ_SHADE_PLACES 16

/** Most shades that fall on one technique. */
#define GZ_SHADES_MAX 8

/** Places that the light may reach. */
struct gz_shade_places {
	float at[3][GZ_SHADE_PLACES]; /**< in the world */
	uint32_t active;              /**< bit i: place i is asked for */
	float from; /**< what lies nearer to a place, world units, keeps no light from it */
	/** How many times longer than the scene's the steps towards the light may be, as those of
	 *  the plan's rays to these places are; up to 1: as long as the scene's. */
	float step;
};

/** What one technique keeps back of a picture's light. Zero-initialised it is nothing. */
struct gz_shade {
	/**
	 * Find which share of the light comes through to some places, [0, 1]: 1 where nothing lies
	 * between. NULL: everything comes through everywhere.
	 *
	 * @param user  of the shade
	 * @param[out] out_shares  of active places; others are undefined
	 *
	 * Threads: any number.
	 */
	void (*find)(const void *user, const struct gz_shade_places *places,
		     float out_shares[GZ_SHADE_PLACES]);
	const void *user; /**< borrowed from a drawer, until it draws the next picture */
	/** Another number, in this process, than that of any shade which differs but for the
	 * light's direction and the clip region. 0: not known. */
	uint64_t revision;
};

#endif
