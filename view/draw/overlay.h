/**
 * @file
 * The tint over the picture that shows its plan: a texel for each block of GZ_TILE_EDGE x
 * GZ_TILE_EDGE px of the plan, coloured by the tile that is shown there.
 */
#ifndef GZ_VIEW_DRAW_OVERLAY_H
#define GZ_VIEW_DRAW_OVERLAY_H

#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/plan/plan.h"
#include "render/scene/view_settings.h"
#include "view/draw/quad.h"

/** Opacity of the tint (chosen: the picture shows through, and colours are told apart). */
#define GZ_OVERLAY_OPACITY 0.36F

/** The smallest end of a scale. Scales are logarithmic and begin at 1 (chosen: a plan that is fine
 *  everywhere looks fine). */
#define GZ_PLAN_CELLS_SCALE_LEAST 4.0

/** Colours of a plan. Zero-initialised: empty. Keep it from plan to plan, so that its memory is
 *  used again. */
struct gz_plan_cells {
	int columns, rows;
	uint8_t *rgba; /**< opaque; row 0 on top; black where no tile is */
	size_t capacity;
	double least, most; /**< smallest and greatest value of the plan's tiles */
	double end;         /**< end of the scale: the next power of two from the most on */
};

/**
 * The value that colours a tile: the spacing of its rays, px of the plan (on a diagonal lattice
 * that of the diagonals), or the multiple of the scene's step.
 *
 * @param overlay  not GZ_OVERLAY_NONE
 */
double gz_plan_cells_value(const struct gz_plan *plan, const struct gz_tile *tile,
			   enum gz_view_overlay overlay);

/** Position of a value on the scale that ends at @p end, 0 to 1. */
double gz_plan_cells_share(double value, double end);

/**
 * Colour the cells.
 *
 * @param plan     made
 * @param overlay  not GZ_OVERLAY_NONE
 * @retval GZ_ERR_NO_MEM  the cells are unchanged
 */
enum gz_result gz_plan_cells_make(struct gz_plan_cells *cells, const struct gz_plan *plan,
				  enum gz_view_overlay overlay);

/** Free and zero. */
void gz_plan_cells_free(struct gz_plan_cells *cells);

/**
 * The colour at a share of a scale: dark blue over green to yellow, lighter as the number rises, so
 * that colour-blind viewers and grey prints show it too. "viridis" of Stéfan van der Walt and
 * Nathaniel Smith, "A Better Default Colormap for Matplotlib" (SciPy 2015), at ten points, linear
 * between them.
 *
 * @param share  beyond [0, 1] the ends' colours; NaN: the colour of 0
 */
void gz_viridis(double share, uint8_t out_rgb[3]);

/** The tint. Zero-initialised: not made yet. */
struct gz_overlay {
	struct gz_fill fill;                          /**< its texture holds the cells */
	int cells_per_picture, cells_before, opacity; /**< locations of the shader's uniforms */
	struct gz_plan_cells cells;
	uint64_t serial; /**< of the plan in the texture */
	int shown;       /**< enum gz_view_overlay in the texture */
};

/** Compile and make what is needed, in a current OpenGL 3.3 context. @return what gz_fill_init()
 *  returns */
enum gz_result gz_overlay_init(struct gz_overlay *overlay, const struct gz_log *log);

/**
 * Take over a plan if it is another one than before, or another kind: overlay->cells are of it
 * then. Needs the context current.
 *
 * @param kind  not GZ_OVERLAY_NONE
 * @retval GZ_ERR_NO_MEM  no memory for the cells, which stay as they are
 */
enum gz_result gz_overlay_follow(struct gz_overlay *overlay, const struct gz_plan *plan,
				 enum gz_view_overlay kind);

/**
 * Draw the tint over the left @p share of a viewport of @p width times @p height px, which shows
 * the plan's picture. Needs the context current.
 *
 * @param kind  not GZ_OVERLAY_NONE
 * @retval GZ_ERR_NO_MEM  no memory for the cells; nothing is drawn
 */
enum gz_result gz_overlay_draw(struct gz_overlay *overlay, const struct gz_plan *plan,
			       enum gz_view_overlay kind, double share, int width, int height);

/** Delete all of it and zero the struct. Correct after a failed gz_overlay_init(). Needs the
 * context current. */
void gz_overlay_free(struct gz_overlay *overlay);

#endif
