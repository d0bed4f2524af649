/**
 * @file
 * The compute passes that fill what was not cast, for any plane; and what they share with the
 * passes of techniques that cast tiles. All calls need the context current.
 */
#ifndef GZ_RENDER_RECONSTRUCT_GL_GL_RECONSTRUCT_H
#define GZ_RENDER_RECONSTRUCT_GL_GL_RECONSTRUCT_H

#include "base/log.h"
#include "base/result.h"
#include "render/opengl/gl_device.h"
#include "render/opengl/gl_program.h"
#include "render/picture/plane.h"
#include "render/plan/plan.h"
#include "render/reconstruct/gl/gl_plan.h"
#include "render/reconstruct/gl/gl_points.h"

/** The files that every pass over a plan begins with: constants, sizes, the plan's block. */
#define GZ_GL_PLAN_PARTS 3
extern const char *const gz_gl_plan_parts[GZ_GL_PLAN_PARTS];

/** What all compute shaders are told of the device, as lines of #define; static text. */
const char *gz_gl_device_defines(const struct gz_gl_device *device);

/** A range of items for gz_gl_dispatch(). */
struct gz_gl_items {
	size_t first, count;
	size_t a_group; /**< to a work-group */
};

/** Run the program in use over items, in as many dispatches as the device needs. The program has
 *  first_item and item_end of shaders/plan.glsl. */
void gz_gl_dispatch(const struct gz_gl_device *device, struct gz_gl_items items);

/** Programs, made when they are first needed; names of OpenGL, 0: none yet. Zero-initialised has
 *  none. */
struct gz_gl_reconstruct {
	unsigned fill[GZ_PLANE_KIND_COUNT][2], quincunx[GZ_PLANE_KIND_COUNT][2]; /**< 1: bilinear */
	unsigned regions[GZ_PLANE_KIND_COUNT];
};

/** One plane of a frame. */
struct gz_gl_reconstruct_job {
	const struct gz_gl_device *device;
	struct gz_gl_plan *gl_plan;        /**< prepared and bound */
	const struct gz_plan *plan;        /**< the same on the host */
	const struct gz_gl_points *points; /**< the plane's, cast */
	enum gz_plane_kind kind;
	const struct gz_log *log;
};

/**
 * Fill the pixels of a plane that were not cast.
 *
 * @retval GZ_ERR_UNSUPPORTED  the driver refuses a shader; logged
 * @retval GZ_ERR_NO_MEM       the device has no room; logged
 */
enum gz_result gz_gl_reconstruct(struct gz_gl_reconstruct *programs,
				 const struct gz_gl_reconstruct_job *job);

/** Delete the programs and zero the struct. */
void gz_gl_reconstruct_free(struct gz_gl_reconstruct *programs);

#endif
