/**
 * @file
 * The compute passes of a frame: casting the tiles, and reconstruction. All calls need the context
 * current and the frame begun (gl_frame.h).
 */
#ifndef GZ_RENDER_GL_GL_PASSES_H
#define GZ_RENDER_GL_GL_PASSES_H

#include <stdbool.h>

#include "base/log.h"
#include "base/result.h"
#include "render/gl/gl_device.h"
#include "render/gl/gl_frame.h"
#include "render/gl/gl_texels.h"
#include "render/plan/plan.h"
#include "render/volume/volume.h"

/** What a cast does; each has a program of its own. */
struct gz_gl_cast_kind {
	enum gz_gl_texels texels;
	enum gz_voxel_type type;
	bool nearest;
	bool segments; /**< pre-integrated */
	bool shaded;
};

/** Programs, made when they are first needed; names of OpenGL, 0: none yet. */
struct gz_gl_passes {
	/** By the members of struct gz_gl_cast_kind. */
	unsigned cast[GZ_GL_TEXELS_COUNT][GZ_VOXEL_TYPE_COUNT][2][2][2];
	unsigned fill[2], quincunx[2]; /**< 1: bilinear */
	unsigned regions;
};

/**
 * Cast the tiles that take a level of detail, whose block and textures are bound.
 *
 * @retval GZ_ERR_UNSUPPORTED  the driver refuses the shader; logged
 */
enum gz_result gz_gl_cast(struct gz_gl_passes *passes, const struct gz_gl_device *device,
			  const struct gz_gl_frame *frame, int level, struct gz_gl_cast_kind kind,
			  const struct gz_log *log);

/**
 * Fill what was not cast.
 *
 * @retval GZ_ERR_UNSUPPORTED  the driver refuses a shader; logged
 * @retval GZ_ERR_NO_MEM       the device has no room; logged
 */
enum gz_result gz_gl_reconstruct(struct gz_gl_passes *passes, const struct gz_gl_device *device,
				 struct gz_gl_frame *frame, const struct gz_plan *plan,
				 const struct gz_log *log);

/** Delete the programs and zero the struct. */
void gz_gl_passes_free(struct gz_gl_passes *passes);

#endif
