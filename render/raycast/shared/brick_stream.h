/**
 * @file
 * Which bricks a backend's pictures want, and how much the absence of each would be seen.
 *
 * A picture wants a brick if the transfer function shows something of it, it reaches into the clip
 * box, the camera sees it, and its level is the one that rays take there, or a coarser one that is
 * shown until the finer one is loaded. The weight of a brick is the size in pixels at which its
 * voxels would appear without it, that is the size of the next coarser voxels, over what the eye
 * resolves there: 1 + d / 90 pixels at d pixels from the gaze. So bricks near the gaze come first,
 * and coarse ones before fine ones.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_BRICK_STREAM_H
#define GZ_RENDER_RAYCAST_SHARED_BRICK_STREAM_H

#include "base/result.h"
#include "render/data/brick_pool.h"
#include "render/picture/camera.h"
#include "render/plan/plan.h"
#include "render/raycast/shared/detail.h"
#include "render/raycast/shared/ray_params.h"
#include "render/transfer/transfer_table.h"

/** Wanted bricks, the greatest weight first. */
struct gz_brick_wants {
	struct gz_brick_want *want;
	size_t count, capacity;
};

/** What wants depend on besides the volume and the transfer function. */
struct gz_brick_stream_key {
	struct gz_camera camera;
	struct gz_clip_region clip;
	double focus_px[2], pixel_lengths, ray_sampling_rate;
	const struct gz_plan *plan; /**< compared, not followed */
	uint64_t plan_serial;
	size_t tile_count;
	int width, height;
};

/** Zero-initialised is ready; keep it from picture to picture. */
struct gz_brick_stream {
	struct gz_brick_wants wants;
	struct gz_brick_stream_key key; /**< that the wants were found for */
	bool found;                     /**< the wants are valid */
	uint8_t *block_level; /**< the finest level that rays take, by block of the picture */
	size_t block_capacity;
};

/** A picture whose wants are to be found. */
struct gz_brick_stream_frame {
	const struct gz_detail *detail;
	const struct gz_brick_layout *layout; /**< of the bricks */
	const struct gz_brick_entry *entries; /**< by a brick's number */
	const struct gz_transfer_table *table;
	const struct gz_plan *plan;
	struct gz_brick_stream_key key;
	/** The level of detail that a tile takes; NULL: all take the finest. */
	int (*tile_level)(const void *user, const struct gz_tile *tile);
	const void *user;
};

/** The key of a picture. @p pixel_lengths comes from gz_levels_pixel_lengths(); 0 if all rays take
 * the finest level. */
struct gz_brick_stream_key gz_brick_stream_key_of(const struct gz_camera *camera,
						  const struct gz_ray_params *rays,
						  const struct gz_plan *plan, double pixel_lengths);

/** Find what a picture wants, into stream->wants, unless its key has not changed.
 *  GZ_ERR_NO_MEM: out of memory. GZ_ERR_INVAL: invalid camera. */
enum gz_result gz_brick_stream_find(struct gz_brick_stream *stream,
				    const struct gz_brick_stream_frame *frame);

/** The volume or the transfer function has changed: find the wants again. */
void gz_brick_stream_forget(struct gz_brick_stream *stream);

/** Free and zero. */
void gz_brick_stream_free(struct gz_brick_stream *stream);

#endif
