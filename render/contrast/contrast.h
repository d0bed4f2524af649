/**
 * @file
 * How much neighbouring rays of a plan differ: what a further round of rays is decided by.
 */
#ifndef GZ_RENDER_CONTRAST_CONTRAST_H
#define GZ_RENDER_CONTRAST_CONTRAST_H

#include <stddef.h>

#include "base/result.h"
#include "base/workers.h"
#include "render/plan/plan.h"
#include "render/reconstruct/cpu/lattice.h"

/** Contrasts of a round's tiles. Zero-initialised is empty; keep it from frame to frame. */
struct gz_contrasts {
	struct gz_node_contrast *of; /**< by tile, from the first one measured */
	size_t capacity;
};

/**
 * Measure the contrast of tiles: at each point of a node (gz_plan_node_of()), and at those of its
 * right and lower rim, how far the luminance is from the mean of the two neighbours along x, along
 * y and, in a pair of quincunx tiles, along both diagonals, in relation to the sum of that mean and
 * the point. For a grating whose half cycles are as wide as rays lie apart that is Michelson's
 * contrast, and for an edge half of it: about what an octave of the edge's frequencies has.
 *
 * Colours are compared in the same way, in two opponent channels, red against green and blue
 * against yellow, in relation to the same luminances; the greater of the two counts.
 *
 * A method that refines edges alone (gz_method.refines_edges) needs no colours, which are 0 then,
 * nor contrasts below foveation.edge_contrast, which may be 0.
 *
 * Luminance is relative to white and counts from that of a display in a dim room (1/200 of white).
 *
 * @param plan      a pyramid that refines
 * @param from      first tile to measure; all tiles before have been cast, too
 * @param lattices  where the plan's rays were stored
 * @param[out] out_contrasts  plan->tile_count - from of them; undefined for tiles that
 *                            gz_plan_refine() does not look at
 * @retval GZ_ERR_NO_MEM
 *
 * The same points give the same contrasts, for any number of threads.
 */
enum gz_result gz_contrasts_measure(const struct gz_plan *plan, size_t from,
				    const struct gz_lattices *lattices, struct gz_workers *workers,
				    struct gz_contrasts *out_contrasts);

/**
 * Plan the next round of rays: measure the tiles of the last one, and refine the plan.
 *
 * @param first  of the last round's tiles; on success the first of the next round's, or
 *               plan->tile_count if the plan stays as it is
 * @param lattices, workers, contrasts  see gz_contrasts_measure()
 * @return the failures of gz_contrasts_measure() and gz_plan_refine()
 */
enum gz_result gz_contrasts_plan_round(struct gz_plan *plan, size_t *first,
				       const struct gz_lattices *lattices,
				       struct gz_workers *workers, struct gz_contrasts *contrasts);

/** Free and zero. */
void gz_contrasts_free(struct gz_contrasts *contrasts);

#endif
