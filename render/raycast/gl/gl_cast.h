/**
 * @file
 * The compute passes that cast tiles of rays, their uniform blocks, and the samples they count. All
 * calls need the context current.
 */
#ifndef GZ_RENDER_RAYCAST_GL_GL_CAST_H
#define GZ_RENDER_RAYCAST_GL_GL_CAST_H

#include <stdbool.h>

#include "base/log.h"
#include "base/result.h"
#include "render/data/volume.h"
#include "render/opengl/gl_device.h"
#include "render/opengl/gl_program.h"
#include "render/raycast/gl/cast_block.h"
#include "render/raycast/gl/gl_texels.h"
#include "render/reconstruct/gl/gl_plan.h"

/** What a cast does; each kind has a program of its own. */
struct gz_gl_cast_kind {
	enum gz_gl_texels texels;
	enum gz_voxel_type type;
	bool nearest;
	bool segments; /**< pre-integrated */
	bool shaded;
};

/** Programs, made when they are first needed, and buffers. Zero-initialised has none. */
struct gz_gl_cast {
	/** Names of OpenGL by the members of struct gz_gl_cast_kind; 0: none yet. */
	unsigned programs[GZ_GL_TEXELS_COUNT][GZ_VOXEL_TYPE_COUNT][2][2][2];
	struct gz_gl_buffer blocks; /**< one for each level of detail */
	struct gz_gl_buffer counts, staging;
};

/** Room for the text of gz_gl_cast_shader()'s defines. */
#define GZ_GL_CAST_DEFINES_SIZE 200

/** The shader of a kind of cast. @p defines is filled and borrowed by the shader. */
struct gz_gl_shader gz_gl_cast_shader(struct gz_gl_cast_kind kind,
				      const struct gz_gl_device *device,
				      char defines[GZ_GL_CAST_DEFINES_SIZE]);

/** Make room for a frame, and clear the counts. GZ_ERR_NO_MEM, GZ_ERR_NO_DEVICE: not logged. */
enum gz_result gz_gl_cast_prepare(struct gz_gl_cast *cast, const struct gz_gl_device *device);

/** Give the device the block of a level of detail. */
void gz_gl_cast_set_block(struct gz_gl_cast *cast, int level, const struct gz_gl_cast_block *block);

/** What one pass of gz_gl_cast_tiles() casts. */
struct gz_gl_cast_job {
	const struct gz_gl_device *device;
	const struct gz_gl_plan *gl_plan; /**< bound, with the points to write bound too */
	int level;                        /**< of detail, whose block and textures are set */
	struct gz_gl_cast_kind kind;
	const struct gz_log *log;
};

/**
 * Cast the tiles that take a level of detail.
 *
 * @retval GZ_ERR_UNSUPPORTED  the driver refuses the shader; logged
 */
enum gz_result gz_gl_cast_tiles(struct gz_gl_cast *cast, const struct gz_gl_cast_job *job);

/** Samples that were taken since gz_gl_cast_prepare(). Waits for the device. */
uint64_t gz_gl_cast_samples(struct gz_gl_cast *cast, const struct gz_gl_device *device);

/** Delete all of it and zero the struct. */
void gz_gl_cast_free(struct gz_gl_cast *cast);

#endif
