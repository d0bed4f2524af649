/**
 * @file
 * What the rays of a plan meet among opaque things: how techniques share one picture. Opaque ones
 * put in what lies nearest, and another one ends its rays there.
 */
#ifndef GZ_RENDER_TECHNIQUE_RAY_HITS_H
#define GZ_RENDER_TECHNIQUE_RAY_HITS_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "render/plan/plan.h"

/** Rays of a tile. */
#define GZ_HITS_A_TILE (GZ_TILE_EDGE * GZ_TILE_EDGE)

/** One hit for each ray: those of plan->tiles[0] first, GZ_HITS_A_TILE each, in the order of
 *  gz_tile_columns. Zero-initialised is empty; keep it from frame to frame. */
struct gz_ray_hits {
	float *depth;     /**< along the ray from where it begins, world units; INFINITY: nothing */
	uint32_t *pixels; /**< R, G, B, 255 in memory order; undefined where there is nothing */
	size_t capacity;  /**< rays */
};

/** Make room for the rays of @p plan, none of which meets anything. GZ_ERR_NO_MEM: out of memory;
 *  the struct is unchanged. */
enum gz_result gz_ray_hits_clear(struct gz_ray_hits *hits, const struct gz_plan *plan);

/** Free the arrays and zero the struct. */
void gz_ray_hits_free(struct gz_ray_hits *hits);

#endif
