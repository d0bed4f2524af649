/**
 * @file
 * A plan as a small picture: a texel for each block of GZ_TILE_EDGE x GZ_TILE_EDGE pixels of the
 * plan, which no tile divides, coloured by what the tile that shows there does.
 */
#ifndef GZ_VIEW_DRAW_PLAN_CELLS_H
#define GZ_VIEW_DRAW_PLAN_CELLS_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "render/plan/plan.h"
#include "render/scene/view_settings.h"

/** The least end of the scales, which are logarithmic and begin at 1 (chosen: a plan that is fine
 * everywhere is seen to be so). */
#define GZ_PLAN_CELLS_SCALE_LEAST 4.0

/** Zero-initialised is empty; keep it from plan to plan, so that its room is used again. */
struct gz_plan_cells {
	int columns, rows;
	uint8_t *rgba; /**< opaque; row 0 on top; black where no tile is */
	size_t capacity;
	double least, most; /**< values of the plan's tiles */
	double end;         /**< of the scale: the power of two from the most on */
};

/** What a tile is coloured by: spacing in pixels of the plan, on a diagonal lattice that of its
 * diagonals, or the multiple of the scene's step. @p overlay  not GZ_OVERLAY_NONE */
double gz_plan_cells_value(const struct gz_plan *plan, const struct gz_tile *tile,
			   enum gz_view_overlay overlay);

/** Where a value is on the scale that ends at @p end, 0 to 1. */
double gz_plan_cells_share(double value, double end);

/**
 * Colour the cells.
 *
 * @param plan     made
 * @param overlay  not GZ_OVERLAY_NONE
 * @retval GZ_ERR_NO_MEM  no room; the cells are as they were
 */
enum gz_result gz_plan_cells_make(struct gz_plan_cells *cells, const struct gz_plan *plan,
				  enum gz_view_overlay overlay);

/** Free and zero. */
void gz_plan_cells_free(struct gz_plan_cells *cells);

#endif
