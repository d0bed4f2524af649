/**
 * @file
 * The compute passes that cast tiles of rays, their uniform blocks and binding points, and the
 * count of samples. All calls need a current context.
 */
#ifndef GZ_RENDER_RAYCAST_GL_GL_CAST_H
#define GZ_RENDER_RAYCAST_GL_GL_CAST_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/data/volume.h"
#include "render/light/gl/gl_surroundings.h"
#include "render/opengl/gl_device.h"
#include "render/opengl/gl_program.h"
#include "render/raycast/gl/gl_textures.h"
#include "render/reconstruct/gl/gl_plan.h"
#include "render/technique/ray_hits.h"

/* Literal numbers, since they are pasted into the shaders' text. */

/** Counters of samples. Work-groups take them in turn, so that few wait for each other; they are
 * summed when read. A power of two. */
#define GZ_GL_COUNT_SLOTS 1024

/** The constants of render/data/brick_file.h and brick_pool.h, and the bits of a room's place
 * along each axis in a table's entry, above those of the level. */
#define GZ_GL_BRICK_EDGE        32
#define GZ_GL_BRICK_STORED_EDGE 34
#define GZ_GL_BRICK_LEVELS      16
#define GZ_GL_BRICK_LEVEL_BITS  4
#define GZ_GL_BRICK_PLACE_BITS  9

/** GZ_COLOUR_WEIGHT_SHARE of render/data/voxel_colour.h. */
#define GZ_GL_COLOUR_WEIGHT_SHARE 64

/** Texture and image units. */
enum gz_gl_texture_unit {
	GZ_GL_UNIT_VOXELS,
	GZ_GL_UNIT_REACH,
	GZ_GL_UNIT_TRANSFER,
	GZ_GL_UNIT_SEGMENTS,
	GZ_GL_UNIT_OCCLUSION,
	GZ_GL_UNIT_COLOURS,
	GZ_GL_UNIT_CUBE,
	GZ_GL_UNIT_ARRIVING,
};

/** Storage buffers, besides those of the plan. */
enum gz_gl_cast_storage {
	GZ_GL_STORAGE_COUNTS = GZ_GL_STORAGE_TECHNIQUE,
	GZ_GL_STORAGE_BRICKS,
	GZ_GL_STORAGE_HITS,
};

/** What the casting shaders know of a frame: the uniform block of shaders/cast_block.glsl, byte for
 * byte by the rules of std140. The fourth component of a vector of three is unused. */
struct gz_gl_cast_block {
	float origin00[4], origin_dx[4], origin_dy[4];          /**< voxel coordinates */
	float direction00[4], direction_dx[4], direction_dy[4]; /**< of rays of pixels */
	float world_per_voxel[4]; /**< world units along each axis; depth at which rays begin */
	float dims[4];            /**< voxels */
	float box[4];             /**< far corner: dims, or less for a coarser level of odd size */
	float clip_least[4], clip_greatest[4]; /**< voxel coordinates */
	float clip_plane[4];                   /**< struct gz_clip_bounds */
	float cell_counts[4];                  /**< macrocells */
	float transfer[4];       /**< scale and bias from stored value to share of the table; the
				    share of light with which a ray ends; the last entry's number */
	float light_towards[4];  /**< world directions; share of the ambient light that can be kept
				    away */
	float light_terms[4];    /**< ambient, diffuse, specular, shininess */
	float gradient_scale[4]; /**< see gz_light_gradient_scale(), of the level of detail;
				    light.reflection */
	float occlusion_scale[4], occlusion_bias[4]; /**< from places counted from the first datum
							to those counted from the first cell's */
	float occlusion_last[4];                     /**< greatest index of a cell */
	float arriving_scale[4], arriving_bias[4];   /**< the same for the grid of shadows */
	float arriving_last[4];
	uint32_t jitter[4];                /**< seed of gz_ray_jitter(); the plan's shift, px */
	float steps[GZ_PLAN_STEPS_MAX][4]; /**< world units, voxel lengths, steps a phase */
	float depths[4]; /**< scale and bias from world units to a share of the shot's depths */
	uint32_t brick_table[4]; /**< number of the level's first brick; of bricks from one to the
				    next along y, z */
	float brick_last[4];     /**< greatest number of a brick along each axis */
	float brick_scales[GZ_GL_BRICK_LEVELS][4]; /**< see struct gz_brick_lookup */
	struct gz_gl_surroundings around;          /**< world units */
};

/** Kinds of cast; each has its own program. */
struct gz_gl_cast_kind {
	enum gz_gl_texels texels;
	enum gz_voxel_type type;
	bool nearest;
	bool segments; /**< pre-integrated */
	bool shaded;   /**< surfaces are lit */
	bool shadowed; /**< by the grid of shadows */
	bool fine;     /**< the transfer table has more than GZ_TRANSFER_TABLE_SIZE entries */
	bool coloured; /**< voxels have colours of their own */
	bool hits;     /**< rays end at hits: gz_gl_cast_set_hits() */
	bool deep;     /**< pixels have depths in their fourth byte */
};

/** Programs, made when first needed, and buffers. Zero-initialised has none. */
struct gz_gl_cast {
	/** OpenGL's names, by the members of struct gz_gl_cast_kind; 0 = not yet made. */
	unsigned programs[GZ_GL_TEXELS_COUNT][GZ_VOXEL_TYPE_COUNT][2][2][2][2][2][2][2][2];
	struct gz_gl_buffer blocks; /**< one for each level of detail */
	struct gz_gl_buffer counts, staging;
	struct gz_gl_buffer hits; /**< depth and pixel of each ray, by the place of its tile */
};

/** Room for the text of gz_gl_cast_defines(). */
#define GZ_GL_CAST_DEFINES_SIZE 300

/** The source parts that give a shader samples of the volume, their colours and their light:
 *  constants, the uniform block, fetches and shading. They follow the constants of the plan
 *  (gz_gl_plan_parts[0]) and need gz_gl_cast_defines(). */
#define GZ_GL_SAMPLE_PARTS     10
#define GZ_GL_SAMPLE_CONSTANTS 2 /**< the part that is cast_constants.h */
extern const char *const gz_gl_sample_parts[GZ_GL_SAMPLE_PARTS];

/** Lines of #define for a kind of cast on a device. */
void gz_gl_cast_defines(struct gz_gl_cast_kind kind, const struct gz_gl_device *device,
			char out_defines[GZ_GL_CAST_DEFINES_SIZE]);

/** The shader of a kind of cast. @p defines is filled and borrowed by the shader. */
struct gz_gl_shader gz_gl_cast_shader(struct gz_gl_cast_kind kind,
				      const struct gz_gl_device *device,
				      char defines[GZ_GL_CAST_DEFINES_SIZE]);

/** Make room for a frame, and clear the counts. GZ_ERR_NO_MEM, GZ_ERR_NO_DEVICE: not logged. */
enum gz_result gz_gl_cast_prepare(struct gz_gl_cast *cast, const struct gz_gl_device *device);

/** Upload the block of a level of detail. */
void gz_gl_cast_set_block(struct gz_gl_cast *cast, int level, const struct gz_gl_cast_block *block);

/** Upload and bind where the rays of a plan end. After gz_gl_plan_prepare(). GZ_ERR_NO_MEM: not
 *  logged. */
enum gz_result gz_gl_cast_set_hits(struct gz_gl_cast *cast, const struct gz_gl_plan *gl_plan,
				   const struct gz_plan *plan, const struct gz_ray_hits *hits);

/** What one pass of gz_gl_cast_tiles() casts. */
struct gz_gl_cast_job {
	const struct gz_gl_device *device;
	const struct gz_gl_plan *gl_plan; /**< bound, with the points to write bound too */
	int level;                        /**< of detail; its block and textures are set */
	struct gz_gl_cast_kind kind;
	const struct gz_log *log;
};

/**
 * Cast the tiles that take a level of detail.
 *
 * @retval GZ_ERR_UNSUPPORTED  the driver refuses the shader; logged
 */
enum gz_result gz_gl_cast_tiles(struct gz_gl_cast *cast, const struct gz_gl_cast_job *job);

/** Samples taken since gz_gl_cast_prepare(). Waits for the device. */
uint64_t gz_gl_cast_samples(struct gz_gl_cast *cast, const struct gz_gl_device *device);

/** Delete all of it and zero the struct. */
void gz_gl_cast_free(struct gz_gl_cast *cast);

#endif
