/**
 * @file
 * Where cast rays lie until the picture is made of them: one lattice of pixels a layer of the plan.
 */
#ifndef GZ_RENDER_CPU_LATTICE_H
#define GZ_RENDER_CPU_LATTICE_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "render/image.h"
#include "render/plan/plan.h"

/** The points of one layer. The first layer of spacing 1 lies in the
 *  picture itself. */
struct gz_lattice {
	uint32_t *points; /**< row by row */
	size_t stride;    /**< points from one row to the next */
	int spacing, columns, rows;
};

/** All layers of a frame. Zero-initialised is empty; keep it from frame to frame. */
struct gz_lattices {
	int count;
	struct gz_lattice layers[GZ_PLAN_LAYERS_MAX];
	uint32_t *memory; /**< of the layers outside the picture */
	size_t capacity;  /**< points */
};

/** Lay out the layers of @p plan, the first of spacing 1 in @p image, which has the plan's size.
 *  GZ_ERR_NO_MEM. Contents are undefined. */
enum gz_result gz_lattices_prepare(struct gz_lattices *lattices, const struct gz_plan *plan,
				   struct gz_image *image);

/** Free and zero. */
void gz_lattices_free(struct gz_lattices *lattices);

#endif
