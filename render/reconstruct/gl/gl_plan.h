/**
 * @file
 * A plan on the graphics device: its tiles, where its lattices lie, and the block that shaders
 * read. It is kept from frame to frame and grows where needed. All calls need the context current.
 */
#ifndef GZ_RENDER_RECONSTRUCT_GL_GL_PLAN_H
#define GZ_RENDER_RECONSTRUCT_GL_GL_PLAN_H

#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/opengl/gl_device.h"
#include "render/plan/plan.h"
#include "render/reconstruct/gl/plan_block.h"

/** Levels of detail that tiles can have. */
#define GZ_GL_TILE_LEVELS_MAX 8

/** Tiles of one kind, one after the other in the buffer of tiles. */
struct gz_gl_tile_range {
	size_t first, count;
};

/** The level of detail of a technique that tiles take, by layer, pattern and step. */
struct gz_gl_tile_levels {
	uint8_t of[GZ_PLAN_LAYERS_MAX][GZ_TILE_PATTERN_COUNT][GZ_PLAN_STEPS_MAX];
};

/** Zero-initialised is empty. */
struct gz_gl_plan {
	struct gz_gl_buffer block, tiles, spans;
	size_t point_count; /**< of all lattices of a plane, its picture included */
	/** The plan whose tiles the device has (its pointers are not followed) and their levels. A
	 *  plan that stays is not packed again. */
	struct {
		struct gz_plan plan;
		struct gz_gl_tile_levels levels;
		bool valid, spans_valid;
	} packed;
	/** Tiles of a layer and pattern: sorted by layer, then by pattern. */
	struct gz_gl_tile_range ranges[GZ_PLAN_LAYERS_MAX][GZ_TILE_PATTERN_COUNT];
	/** From the first tile of a level of detail to the last; others lie between. */
	struct gz_gl_tile_range level_ranges[GZ_GL_TILE_LEVELS_MAX];
};

/**
 * Give the device a plan, unless it has it.
 *
 * @retval GZ_ERR_UNSUPPORTED  more lattice points than a storage buffer holds; logged with the
 * limit
 * @retval GZ_ERR_NO_MEM       the device has no room; logged
 */
enum gz_result gz_gl_plan_prepare(struct gz_gl_plan *gl_plan, const struct gz_gl_device *device,
				  const struct gz_plan *plan,
				  const struct gz_gl_tile_levels *levels, const struct gz_log *log);

/** Bind block and tiles, for casting and reconstruction. */
void gz_gl_plan_bind(const struct gz_gl_plan *gl_plan);

/** Give the device the columns of each row that each region of the plan has (gz_region_columns()),
 * unless it has them, and bind them. GZ_ERR_NO_MEM: logged. */
enum gz_result gz_gl_plan_bind_spans(struct gz_gl_plan *gl_plan, const struct gz_plan *plan,
				     const struct gz_log *log);

/** Delete all of it and zero the struct. */
void gz_gl_plan_free(struct gz_gl_plan *gl_plan);

#endif
