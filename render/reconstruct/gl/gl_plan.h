/**
 * @file
 * A plan on the graphics device: its tiles, the layout of its lattices, the uniform block that
 * shaders read, and the numbers of OpenGL's binding points. It is kept from frame to frame and
 * grows when needed. All calls need a current context.
 */
#ifndef GZ_RENDER_RECONSTRUCT_GL_GL_PLAN_H
#define GZ_RENDER_RECONSTRUCT_GL_GL_PLAN_H

#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/opengl/gl_device.h"
#include "render/plan/plan.h"
#include "render/plan/plan_constants.h"

/* Literal numbers, since they are pasted into the shaders' text. */

/** Invocations of a work-group of rays: four tiles. Chosen: fills a warp of 32 or a wave of 64, and
 *  rays of neighbouring tiles take similar paths. */
#define GZ_GL_GROUP_SIZE 64
/** Rays of all tile patterns together. */
#define GZ_GL_TILE_POINTS 32

/** Image unit of the lattice points: the last that every OpenGL has. Techniques use lower ones. */
#define GZ_GL_IMAGE_POINTS 7

/** Binding points of uniform blocks: one for the plan, one for the technique's own. */
enum gz_gl_block { GZ_GL_BLOCK_PLAN, GZ_GL_BLOCK_TECHNIQUE };

/** Binding points of storage buffers: GZ_GL_STORAGE_TECHNIQUE and above are the technique's own. */
enum gz_gl_storage {
	GZ_GL_STORAGE_TILES,
	GZ_GL_STORAGE_POINTS,
	GZ_GL_STORAGE_SPANS,
	GZ_GL_STORAGE_TECHNIQUE,
};

/** What shaders know of a plan: the uniform block of shaders/plan.glsl, byte for byte by the rules
 * of std140. */
struct gz_gl_plan_block {
	uint32_t plan[4];                       /**< layers; 1 for a pyramid; width, height, px */
	uint32_t layers[GZ_PLAN_LAYERS_MAX][4]; /**< first point, columns, rows, spacing */
	float region_places[GZ_PLAN_LAYERS_MAX][4]; /**< centre, half size, px */
	/** Rise of a layer's share per radius inside the rim, 0 = no band; 1 for an ellipse. */
	float region_fades[GZ_PLAN_LAYERS_MAX][4];
	uint32_t tile_points[GZ_GL_TILE_POINTS][4]; /**< column and row of a tile's rays */
};

/** Most levels of detail of a technique. */
#define GZ_GL_TILE_LEVELS_MAX 8

/** Consecutive tiles in the buffer of tiles. */
struct gz_gl_tile_range {
	size_t first, count;
};

/** The level of detail that a tile takes, by layer, pattern and step. */
struct gz_gl_tile_levels {
	uint8_t of[GZ_PLAN_LAYERS_MAX][GZ_TILE_PATTERN_COUNT][GZ_PLAN_STEPS_MAX];
};

/** Zero-initialised is empty. */
struct gz_gl_plan {
	struct gz_gl_buffer block, tiles, spans;
	size_t layer_first[GZ_PLAN_LAYERS_MAX]; /**< number of each lattice's first point */
	size_t point_count; /**< points of all lattices of a plane, its picture included */
	/** The plan and levels whose tiles the device has, so that an unchanged plan is not packed
	 *  again. The plan's pointers are not followed. */
	struct {
		struct gz_plan plan;
		struct gz_gl_tile_levels levels;
		bool valid, spans_valid;
	} packed;
	/** Tiles of each layer and pattern; the buffer is sorted by layer, then by pattern. */
	struct gz_gl_tile_range ranges[GZ_PLAN_LAYERS_MAX][GZ_TILE_PATTERN_COUNT];
	/** From the first tile of each level of detail to its last; tiles of others lie between. */
	struct gz_gl_tile_range level_ranges[GZ_GL_TILE_LEVELS_MAX];
};

/**
 * Upload a plan, unless the device has it.
 *
 * @retval GZ_ERR_UNSUPPORTED  more lattice points than a storage buffer holds; logged with the
 *                             limit
 * @retval GZ_ERR_NO_MEM       the device has no room; logged
 */
enum gz_result gz_gl_plan_prepare(struct gz_gl_plan *gl_plan, const struct gz_gl_device *device,
				  const struct gz_plan *plan,
				  const struct gz_gl_tile_levels *levels, const struct gz_log *log);

/** Bind the block and the tiles, for casting and reconstruction. */
void gz_gl_plan_bind(const struct gz_gl_plan *gl_plan);

/** How many tiles of each layer and pattern have been placed. Zero-initialised: none. */
struct gz_gl_tiles_placed {
	size_t count[GZ_PLAN_LAYERS_MAX][GZ_TILE_PATTERN_COUNT];
};

/** The place of a tile in the buffer of tiles. Call it for each tile of the plan, in its order. */
size_t gz_gl_plan_place(const struct gz_gl_plan *gl_plan, const struct gz_tile *tile,
			struct gz_gl_tiles_placed *placed);

/** Upload each region's columns in each row (gz_region_columns()), unless the device has them, and
 *  bind them. GZ_ERR_NO_MEM: logged. */
enum gz_result gz_gl_plan_bind_spans(struct gz_gl_plan *gl_plan, const struct gz_plan *plan,
				     const struct gz_log *log);

/** Delete the buffers and zero the struct. */
void gz_gl_plan_free(struct gz_gl_plan *gl_plan);

#endif
