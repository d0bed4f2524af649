/**
 * @file
 * The buffers of a frame: tiles, lattice points, counts, and what brings the picture back. They are
 * kept from frame to frame and grow where needed. All calls need the context current.
 */
#ifndef GZ_RENDER_GL_GL_FRAME_H
#define GZ_RENDER_GL_GL_FRAME_H

#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/gl/frame_block.h"
#include "render/gl/gl_device.h"
#include "render/image.h"
#include "render/plan/plan.h"
#include "render/volume/levels.h"

/** A buffer of the device; zero-initialised is none. */
struct gz_gl_buffer {
	unsigned name;
	size_t size; /**< bytes */
};

/** Tiles of one kind, one after the other in the buffer of tiles. */
struct gz_gl_tile_range {
	size_t first, count;
};

/** Which level of detail tiles take, by layer, pattern and step. */
struct gz_gl_tile_levels {
	uint8_t of[GZ_PLAN_LAYERS_MAX][GZ_TILE_PATTERN_COUNT][GZ_PLAN_STEPS_MAX];
};

/** Zero-initialised is empty. */
struct gz_gl_frame {
	struct gz_gl_buffer block, tiles, points, counts, spans, staging;
	/** What the device has the tiles of: the plan, whose pointers are not followed, and the
	 *  levels. A plan that stays is not packed again. */
	struct {
		struct gz_plan plan;
		struct gz_gl_tile_levels levels;
		bool valid, spans_valid;
	} packed;
	/** Where tiles of a layer and pattern lie: sorted by layer, then by pattern. */
	struct gz_gl_tile_range ranges[GZ_PLAN_LAYERS_MAX][GZ_TILE_PATTERN_COUNT];
	/** From the first to behind the last tile of each level of detail; others lie between. */
	struct gz_gl_tile_range level_ranges[GZ_LEVELS_MAX];
	unsigned point_texels; /**< buffer texture of points; 0 where shaders need none */
	unsigned picture;      /**< texture, RGBA8; 0 until one was asked for */
	int picture_width, picture_height;
};

/**
 * Make room for a plan's frame and give the device its tiles; lays out the lattices in @p block.
 *
 * @retval GZ_ERR_UNSUPPORTED  more lattice points than a storage buffer holds; logged with the
 * limit
 * @retval GZ_ERR_NO_MEM       the device has no room; logged
 */
enum gz_result gz_gl_frame_prepare(struct gz_gl_frame *frame, const struct gz_gl_device *device,
				   const struct gz_plan *plan,
				   const struct gz_gl_tile_levels *levels,
				   struct gz_gl_frame_block *block, const struct gz_log *log);

/** Give the device the columns of each row that each region of the plan that was prepared has
 * (gz_region_columns()), unless it has them, and bind them. GZ_ERR_NO_MEM: logged. */
enum gz_result gz_gl_frame_spans(struct gz_gl_frame *frame, const struct gz_gl_device *device,
				 const struct gz_plan *plan, const struct gz_log *log);

/** Give the device the finished block of a level of detail. */
void gz_gl_frame_set_block(struct gz_gl_frame *frame, int level,
			   const struct gz_gl_frame_block *block);

/** Let shaders see that block. */
void gz_gl_frame_use_block(const struct gz_gl_frame *frame, int level);

/** Clear the counts, and bind all buffers but the block. */
void gz_gl_frame_begin(struct gz_gl_frame *frame);

/** Bring the picture into @p image, which has its size. GZ_ERR_NO_MEM, GZ_ERR_NO_DEVICE. */
enum gz_result gz_gl_frame_read(struct gz_gl_frame *frame, const struct gz_gl_device *device,
				struct gz_image *image);

/** Bring the picture into the texture, on the device. */
void gz_gl_frame_to_texture(struct gz_gl_frame *frame, int width, int height);

/** Sum of all counts: waits for the frame. */
uint64_t gz_gl_frame_samples(struct gz_gl_frame *frame, const struct gz_gl_device *device);

/** Delete all of it and zero the struct. */
void gz_gl_frame_free(struct gz_gl_frame *frame);

#endif
