#include "render/raycast/shared/brick_stream.h"

#include <stdlib.h>
#include <string.h>

static int blocks_along(int px)
{
	return (px + GZ_WANTS_BLOCK - 1) / GZ_WANTS_BLOCK;
}

static int block_of(int px, int count)
{
	const int block = px / GZ_WANTS_BLOCK;
	return block < count - 1 ? block : count - 1;
}

/* Blocks take the finest level of the tiles that reach into them; a tile's points lie up to this
 * far from its first. */
static void take_level(const struct gz_plan *plan, const struct gz_tile *tile, uint8_t level,
		       uint8_t *blocks)
{
	const int columns = blocks_along(plan->width), rows = blocks_along(plan->height);
	const int spacing = plan->layers[tile->layer].spacing;
	const int across = 2 * GZ_TILE_EDGE * spacing, down = GZ_TILE_EDGE * spacing;
	for (int y = block_of(tile->y, rows); y <= block_of(tile->y + down, rows); y++)
		for (int x = block_of(tile->x, columns); x <= block_of(tile->x + across, columns);
		     x++) {
			uint8_t *block = &blocks[y * columns + x];
			*block = level < *block ? level : *block;
		}
}

static enum gz_result find_block_levels(struct gz_brick_stream *stream,
					const struct gz_brick_stream_frame *frame)
{
	const struct gz_plan *plan = frame->plan;
	const size_t count = (size_t)blocks_along(plan->width) * (size_t)blocks_along(plan->height);
	if (count > stream->block_capacity) {
		uint8_t *grown = realloc(stream->block_level, count);
		if (!grown)
			return GZ_ERR_NO_MEM;
		stream->block_level = grown;
		stream->block_capacity = count;
	}
	memset(stream->block_level, GZ_BRICK_LEVELS_MAX, count);
	for (size_t i = 0; i < plan->tile_count; i++) {
		const struct gz_tile *tile = &plan->tiles[i];
		const int level = frame->tile_level(frame->user, tile);
		take_level(plan, tile, (uint8_t)frame->detail->brick_level[level],
			   stream->block_level);
	}
	return GZ_OK;
}

static enum gz_result find_wants(struct gz_brick_stream *stream,
				 const struct gz_brick_stream_frame *frame)
{
	stream->found = false;
	enum gz_result result = frame->tile_level ? find_block_levels(stream, frame) : GZ_OK;
	const struct gz_brick_scene scene = {
		.volume = &frame->detail->levels.level[0].volume,
		.layout = frame->layout,
		.entries = frame->entries,
		.table = frame->table,
		.camera = &frame->key.camera,
		.clip = &frame->key.clip,
		.width = frame->plan->width,
		.height = frame->plan->height,
		.focus_px = frame->plan->focus_px,
		.block_level = frame->tile_level ? stream->block_level : NULL,
	};
	if (result == GZ_OK)
		result = gz_brick_wants_find(&scene, &stream->wants);
	stream->found = result == GZ_OK;
	stream->key = frame->key;
	return result;
}

struct gz_brick_stream_key gz_brick_stream_key_of(const struct gz_camera *camera,
						  const struct gz_ray_params *rays,
						  const struct gz_plan *plan, double pixel_lengths)
{
	struct gz_brick_stream_key key = { .camera = *camera };
	key.clip = rays->clip;
	key.focus_px[0] = plan->focus_px[0];
	key.focus_px[1] = plan->focus_px[1];
	key.pixel_lengths = pixel_lengths;
	key.ray_sampling_rate = rays->ray_sampling_rate;
	key.plan = plan;
	key.plan_serial = plan->serial;
	key.tile_count = plan->tile_count;
	key.width = plan->width;
	key.height = plan->height;
	return key;
}

static bool same_key(const struct gz_brick_stream_key *a, const struct gz_brick_stream_key *b)
{
	return gz_camera_same(&a->camera, &b->camera) && gz_clip_box_same(&a->clip, &b->clip) &&
	       a->focus_px[0] == b->focus_px[0] && a->focus_px[1] == b->focus_px[1] &&
	       a->pixel_lengths == b->pixel_lengths &&
	       a->ray_sampling_rate == b->ray_sampling_rate && a->plan == b->plan &&
	       a->plan_serial == b->plan_serial && a->tile_count == b->tile_count &&
	       a->width == b->width && a->height == b->height;
}

enum gz_result gz_brick_stream_find(struct gz_brick_stream *stream,
				    const struct gz_brick_stream_frame *frame)
{
	if (stream->found && same_key(&stream->key, &frame->key))
		return GZ_OK;
	return find_wants(stream, frame);
}

void gz_brick_stream_forget(struct gz_brick_stream *stream)
{
	stream->found = false;
}

void gz_brick_stream_free(struct gz_brick_stream *stream)
{
	gz_brick_wants_free(&stream->wants);
	free(stream->block_level);
	*stream = (struct gz_brick_stream) { 0 };
}
