/**
 * @file
 * The bricks of the cpu backend's pictures: what each wants is sent for, what has come is shown.
 */
#ifndef GZ_RENDER_CPU_BRICK_STREAM_H
#define GZ_RENDER_CPU_BRICK_STREAM_H

#include "render/brick_wants.h"
#include "render/cpu/cast.h"
#include "render/detail.h"

/** What wants depend on beside the volume and the transfer function. Compared byte by byte. */
struct gz_brick_stream_key {
	struct gz_camera camera;
	double focus_px[2], pixel_lengths, ray_sampling_rate;
	size_t tile_count;
	uint64_t plan_serial;
	int width, height;
};

/** Zero-initialised is ready; keep it from picture to picture. */
struct gz_brick_stream {
	struct gz_brick_wants wants;
	struct gz_brick_stream_key key; /**< of the wants */
	bool found;                     /**< there are any */
	uint8_t *block_level;           /**< see struct gz_brick_scene */
	size_t block_capacity;
	struct gz_brick_view view;
};

/** What a picture is of. */
struct gz_brick_stream_frame {
	const struct gz_detail *detail;
	const struct gz_transfer_table *table;
	const struct gz_plan *plan;
	struct gz_brick_stream_key key;
	/** The level of detail that a tile takes; NULL: the finest for all. */
	int (*tile_level)(const void *user, const struct gz_tile *tile);
	const void *user;
	bool wait; /**< until all is there that has room */
};

/** Send for what the picture wants and take what is there. GZ_ERR_NO_MEM. */
enum gz_result gz_brick_stream_turn(struct gz_brick_stream *stream,
				    const struct gz_brick_stream_frame *frame);

/** Lead a cast of level of detail @p index to the bricks of the last turn. */
void gz_brick_stream_lead(const struct gz_brick_stream *stream, const struct gz_detail *detail,
			  int index, struct gz_cast *cast);

/** What is wanted has changed for a reason that the key does not have. */
void gz_brick_stream_forget(struct gz_brick_stream *stream);

/** Free and zero. */
void gz_brick_stream_free(struct gz_brick_stream *stream);

#endif
