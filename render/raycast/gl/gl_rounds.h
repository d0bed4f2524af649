/**
 * @file
 * Plans that are refined while they are drawn (gz_plan_refine()): the device casts, the processor
 * looks where there is contrast. All calls need a current context.
 */
#ifndef GZ_RENDER_RAYCAST_GL_GL_ROUNDS_H
#define GZ_RENDER_RAYCAST_GL_GL_ROUNDS_H

#include <stddef.h>

#include "base/result.h"
#include "base/workers.h"
#include "render/contrast/contrast.h"
#include "render/opengl/gl_device.h"
#include "render/plan/plan.h"
#include "render/reconstruct/cpu/lattice.h"
#include "render/reconstruct/gl/gl_plan.h"
#include "render/reconstruct/gl/gl_reconstruct.h"

/** Zero-initialised is empty. */
struct gz_gl_rounds {
	struct gz_lattices lattices; /**< the device's, but for layer 0, which has no points */
	struct gz_contrasts contrasts;
	struct gz_tile *shown; /**< the tiles that none replaces */
	size_t shown_capacity;
};

/** What is needed to refine a plan by the points on the device. All pointers are borrowed. */
struct gz_gl_rounds_job {
	const struct gz_gl_device *device;
	const struct gz_gl_plan *gl_plan;
	struct gz_gl_points *points; /**< those of the tiles before and in the last round */
	struct gz_workers *workers;
	struct gz_plan *plan;
	size_t first; /**< tile of the last round; 0: it is the first round of a frame */
};

/**
 * Refine a plan by the points that its last round has left on the device.
 *
 * @retval GZ_ERR_NO_MEM     not logged
 * @retval GZ_ERR_NO_DEVICE  the context is lost; not logged
 */
enum gz_result gz_gl_rounds_refine(struct gz_gl_rounds *rounds, const struct gz_gl_rounds_job *job);

/** A plan with the tiles from @p first on alone; it borrows them. */
struct gz_plan gz_gl_rounds_part(const struct gz_plan *plan, size_t first);

/** Make a plan of those tiles that none replaces, in their order. It borrows them from @p rounds
 *  until the next call. GZ_ERR_NO_MEM: not logged. */
enum gz_result gz_gl_rounds_show(struct gz_gl_rounds *rounds, const struct gz_plan *plan,
				 struct gz_plan *out_shown);

/** Free and zero. */
void gz_gl_rounds_free(struct gz_gl_rounds *rounds);

#endif
