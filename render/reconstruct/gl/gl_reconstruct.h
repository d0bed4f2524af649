/**
 * @file
 * Reconstruction on the graphics device, for any plane: the lattice points, the compute passes that
 * fill what was not cast, and what these passes share with those that cast tiles. All calls need a
 * current context.
 */
#ifndef GZ_RENDER_RECONSTRUCT_GL_GL_RECONSTRUCT_H
#define GZ_RENDER_RECONSTRUCT_GL_GL_RECONSTRUCT_H

#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/opengl/gl_device.h"
#include "render/opengl/gl_program.h"
#include "render/picture/plane.h"
#include "render/plan/plan.h"
#include "render/reconstruct/gl/gl_plan.h"

/** The source parts that every pass over a plan begins with: constants, sizes, the plan's block. */
#define GZ_GL_PLAN_PARTS 3
extern const char *const gz_gl_plan_parts[GZ_GL_PLAN_PARTS];

/** Lines of #define about the device, for all compute shaders. Static. */
const char *gz_gl_device_defines(const struct gz_gl_device *device);

/** A range of items for gz_gl_dispatch(). */
struct gz_gl_items {
	size_t first, count;
	size_t a_group; /**< items of a work-group */
};

/** Run the program in use over items, in as many dispatches as the device needs. The program uses
 *  first_item and item_end of shaders/plan.glsl. */
void gz_gl_dispatch(const struct gz_gl_device *device, struct gz_gl_items items);

/** The lattice points of one plane, and the picture that they become. Zero-initialised is empty;
 * keep it from frame to frame. */
struct gz_gl_points {
	struct gz_gl_buffer points, staging;
	unsigned texels;  /**< buffer texture of the points; 0 if shaders need none */
	unsigned picture; /**< texture, RGBA8; 0 until it is asked for */
	int picture_width, picture_height;
};

/** Make room for @p count points. GZ_ERR_NO_MEM, GZ_ERR_NO_DEVICE: not
 *  logged. */
enum gz_result gz_gl_points_prepare(struct gz_gl_points *points, const struct gz_gl_device *device,
				    size_t count);

/** Bind the points for shaders. */
void gz_gl_points_bind(const struct gz_gl_points *points);

/** Copy @p count points from number @p first on into host memory; the picture's are the first.
 *  GZ_ERR_NO_MEM, GZ_ERR_NO_DEVICE: not logged. */
enum gz_result gz_gl_points_read(struct gz_gl_points *points, const struct gz_gl_device *device,
				 size_t first, size_t count, uint32_t *out_words);

/** Bring the picture into points->picture, on the device. Colours only. */
void gz_gl_points_to_texture(struct gz_gl_points *points, int width, int height);

/** Delete all of it and zero the struct. */
void gz_gl_points_free(struct gz_gl_points *points);

/** Programs, made when first needed; OpenGL's names, 0 = not yet. Zero-initialised has none. */
struct gz_gl_reconstruct {
	unsigned fill[GZ_PLANE_KIND_COUNT][2], quincunx[GZ_PLANE_KIND_COUNT][2]; /**< 1: bilinear */
	unsigned regions[GZ_PLANE_KIND_COUNT];
};

/** One plane of a frame. */
struct gz_gl_reconstruct_job {
	const struct gz_gl_device *device;
	struct gz_gl_plan *gl_plan;        /**< prepared and bound */
	const struct gz_plan *plan;        /**< the plan on the host */
	const struct gz_gl_points *points; /**< of the plane, filled by casting */
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
