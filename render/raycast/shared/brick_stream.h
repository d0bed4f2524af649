/**
 * @file
 * The bricks of a backend's pictures: what each wants, found anew only when something has changed.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_BRICK_STREAM_H
#define GZ_RENDER_RAYCAST_SHARED_BRICK_STREAM_H

#include "render/picture/camera.h"
#include "render/plan/plan.h"
#include "render/raycast/shared/brick_wants.h"
#include "render/raycast/shared/detail.h"
#include "render/raycast/shared/ray_params.h"

/** What wants depend on beside the volume and the transfer function. */
struct gz_brick_stream_key {
	struct gz_camera camera;
	struct gz_clip_box clip;
	double focus_px[2], pixel_lengths, ray_sampling_rate;
	const struct gz_plan *plan; /**< whose serial it is; not followed */
	uint64_t plan_serial;
	size_t tile_count;
	int width, height;
};

/** Zero-initialised is ready; keep it from picture to picture. */
struct gz_brick_stream {
	struct gz_brick_wants wants;
	struct gz_brick_stream_key key; /**< of the wants */
	bool found;                     /**< there are any */
	uint8_t *block_level;           /**< see struct gz_brick_scene */
	size_t block_capacity;
};

/** What a picture is of. */
struct gz_brick_stream_frame {
	const struct gz_detail *detail;
	const struct gz_brick_layout *layout; /**< of the bricks */
	const struct gz_brick_entry *entries; /**< by a brick's number */
	const struct gz_transfer_table *table;
	const struct gz_plan *plan;
	struct gz_brick_stream_key key;
	/** The level of detail that a tile takes; NULL: the finest for all. */
	int (*tile_level)(const void *user, const struct gz_tile *tile);
	const void *user;
};

/** The key of a frame. @param pixel_lengths  of gz_levels_pixel_lengths(); 0 where all rays take
 *  the finest level */
struct gz_brick_stream_key gz_brick_stream_key_of(const struct gz_camera *camera,
						  const struct gz_ray_params *rays,
						  const struct gz_plan *plan, double pixel_lengths);

/** Find what the picture wants, into stream->wants. GZ_ERR_NO_MEM; GZ_ERR_INVAL: no valid camera.
 */
enum gz_result gz_brick_stream_find(struct gz_brick_stream *stream,
				    const struct gz_brick_stream_frame *frame);

/** What is wanted has changed for a reason that the key does not have. */
void gz_brick_stream_forget(struct gz_brick_stream *stream);

/** Free and zero. */
void gz_brick_stream_free(struct gz_brick_stream *stream);

#endif
