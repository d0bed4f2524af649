/**
 * @file
 * What the casting shaders are told of a frame: the uniform block of shaders/cast_block.glsl, byte
 * for byte by the rules of std140, and the numbers of OpenGL's binding points.
 */
#ifndef GZ_RENDER_RAYCAST_GL_CAST_BLOCK_H
#define GZ_RENDER_RAYCAST_GL_CAST_BLOCK_H

#include <stdint.h>

#include "render/reconstruct/gl/gl_plan.h"

/* Plain numbers: they are pasted into the shaders' text. */

/** Counters that work-groups add their samples to, each to its own in turn, so that few wait for
 *  each other; summed when they are read. A power of two. */
#define GZ_GL_COUNT_SLOTS 1024

/** As render/data/brick_file.h and brick_pool.h have it, and bits of a room's place along each
 *  axis, above those of the level. */
#define GZ_GL_BRICK_EDGE        32
#define GZ_GL_BRICK_STORED_EDGE 34
#define GZ_GL_BRICK_LEVELS      16
#define GZ_GL_BRICK_LEVEL_BITS  4
#define GZ_GL_BRICK_PLACE_BITS  9

/** Texture and image units. */
enum gz_gl_texture_unit {
	GZ_GL_UNIT_VOXELS,
	GZ_GL_UNIT_REACH,
	GZ_GL_UNIT_TRANSFER,
	GZ_GL_UNIT_SEGMENTS,
	GZ_GL_UNIT_OCCLUSION
};
/** Storage buffers, beside those of the plan. */
enum gz_gl_cast_storage {
	GZ_GL_STORAGE_COUNTS = GZ_GL_STORAGE_TECHNIQUE,
	GZ_GL_STORAGE_BRICKS,
};

/** The block. Vectors of three have a fourth component that nobody reads. */
struct gz_gl_cast_block {
	float origin00[4], origin_dx[4], origin_dy[4];          /**< voxel coordinates */
	float direction00[4], direction_dx[4], direction_dy[4]; /**< of rays of pixels */
	float world_per_voxel[4];
	float dims[4]; /**< voxels */
	float box[4];  /**< far corner: dims but for a coarser level of odd size */
	float clip_least[4], clip_greatest[4]; /**< voxel coordinates */
	float cell_counts[4];                  /**< macrocells */
	float background[4];                   /**< [0, 1] */
	float transfer[4];       /**< scale and bias from stored value to share of the table; the
				    share of light with which a ray ends */
	float light_towards[4];  /**< world directions; share of the ambient light that can be kept
				    away */
	float light_terms[4];    /**< ambient, diffuse, specular, shininess */
	float gradient_scale[4]; /**< see gz_light_gradient_scale(); of the level of detail */
	float occlusion_scale[4], occlusion_bias[4]; /**< from places counted from the first datum
							to those counted from the first cell's */
	float occlusion_last[4];                     /**< greatest index of a cell */
	uint32_t jitter[4];                /**< seed of gz_ray_jitter(); the plan's shift, px */
	float steps[GZ_PLAN_STEPS_MAX][4]; /**< world units, voxel lengths */
	uint32_t brick_table[4]; /**< number of the level's first brick; of bricks from one to the
				    next along y, z */
	float brick_last[4];     /**< greatest number of a brick along each axis */
	float brick_scales[GZ_GL_BRICK_LEVELS][4]; /**< see struct gz_brick_lookup */
};

#endif
