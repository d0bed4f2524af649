/**
 * @file
 * The tint over the picture that tells what its plan does. Needs a current OpenGL 3.3 context in
 * every call.
 */
#ifndef GZ_VIEW_DRAW_OVERLAY_H
#define GZ_VIEW_DRAW_OVERLAY_H

#include "base/log.h"
#include "base/result.h"
#include "view/draw/plan_cells.h"

/** Opaque by so much (chosen: the picture is still seen, and colours are told apart). */
#define GZ_OVERLAY_OPACITY 0.36F

/** Zero-initialised is none. */
struct gz_overlay {
	unsigned program, vertices, texture;          /**< names of OpenGL; 0: none */
	int cells_per_picture, cells_before, opacity; /**< places of the shader's uniforms */
	struct gz_plan_cells cells;
	uint64_t serial;   /**< of the plan in the texture */
	int shown;         /**< enum gz_view_overlay that it tells */
	int columns, rows; /**< of the texture */
};

/** Compile and make what is needed. GZ_ERR_UNSUPPORTED: the driver refuses the shader; logged. */
enum gz_result gz_overlay_init(struct gz_overlay *overlay, const struct gz_log *log);

/**
 * Draw it over the left @p share of a viewport of @p width times @p height px, which shows the
 * plan's picture.
 *
 * @param kind  not GZ_OVERLAY_NONE
 * @retval GZ_ERR_NO_MEM  no room for the cells; nothing is drawn
 */
enum gz_result gz_overlay_draw(struct gz_overlay *overlay, const struct gz_plan *plan,
			       enum gz_view_overlay kind, double share, int width, int height);

/** Delete all of it and zero the struct. Correct after a failed gz_overlay_init(). */
void gz_overlay_free(struct gz_overlay *overlay);

#endif
