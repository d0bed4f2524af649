#include "render/raycast/shared/brick_stream.h"
#include "base/vector.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Edge of the blocks of the picture whose levels are known, px. Chosen: far smaller than what is
 * worth fetching alone. */
#define WANTS_BLOCK 64

/* What is to be shown. */
struct brick_scene {
	const struct gz_volume *volume;
	const struct gz_brick_layout *layout;
	const struct gz_brick_entry *entries; /* by a brick's number; only their ranges are read */
	const struct gz_transfer_table *table;
	const struct gz_camera *camera;
	const struct gz_clip_region *clip;
	int width, height;          /* of the picture, px */
	const double *focus_px;     /* x, y of the gaze */
	const uint8_t *block_level; /* the finest level that rays of each block take, row by row;
				       NULL: level 0 everywhere */
};

/* Distance from the gaze, px, over which the spacing that the eye resolves grows by one pixel:
 * 2 / m, for small angles and m = 0.022 (docs/foveation.md). */
#define RESOLVED_PX 90

/* How much less a brick weighs at the far end of the volume, where others may hide it, than at the
 * near end. Chosen: decides only between bricks that otherwise weigh the same. */
#define FAR_SHARE 0.5

/* Voxels outside the clip region that samples within it read, for interpolation and gradients. */
#define CLIP_MARGIN_VOXELS 2

struct want_search {
	const struct brick_scene *scene;
	struct gz_brick_wants *wants;
	double to_picture[3][3]; /* from world less origin to (x, y, 1) * depth */
	double origin[3];
	double forward[3];      /* unit vector into the picture */
	double pixel_per_world; /* at depth 1; orthographic: at every depth */
	bool perspective;
	double half[3], longest; /* half extent of the volume; its longest edge, mm */
	struct gz_clip_bounds shown;
	double near; /* depth at which the volume begins */
	enum gz_result result;
};

/* Where a ball appears. */
struct appearance {
	double x, y, radius; /* px */
	double scale;        /* px per world unit, at its nearest */
	double depth;        /* world units, of its centre */
};

/* The inverse of the matrix whose columns are one pixel right, one down, and the first ray. */
static bool invert_matrix(const double right[3], const double down[3], const double first[3],
			  double out[3][3])
{
	gz_cross3(down, first, out[0]);
	gz_cross3(first, right, out[1]);
	gz_cross3(right, down, out[2]);
	const double determinant = gz_dot3(right, out[0]);
	for (int row = 0; row < 3; row++)
		for (int i = 0; i < 3; i++)
			out[row][i] /= determinant;
	return isfinite(1 / determinant);
}

static enum gz_result begin_search(struct want_search *search)
{
	const struct brick_scene *scene = search->scene;
	struct gz_ray_frame rays;
	const enum gz_result result =
		gz_camera_rays(scene->camera, scene->width, scene->height, &rays);
	if (result != GZ_OK)
		return result;
	search->perspective = scene->camera->projection == GZ_PROJECTION_PERSPECTIVE;
	const double *right = search->perspective ? rays.direction_dx : rays.origin_dx;
	const double *down = search->perspective ? rays.direction_dy : rays.origin_dy;
	if (!invert_matrix(right, down, rays.direction00, search->to_picture))
		return GZ_ERR_INVAL;
	gz_cross3(down, right, search->forward);
	const double length = gz_length3(search->forward);
	const double sign = gz_dot3(search->forward, rays.direction00) < 0 ? -1 : 1;
	for (int i = 0; i < 3; i++) {
		search->origin[i] = rays.origin00[i];
		search->forward[i] *= sign / length;
	}
	/* At depth 1 along forward, a pixel's ray has gone 1 / (direction00 . forward). */
	const double along = gz_dot3(rays.direction00, search->forward);
	search->pixel_per_world = (search->perspective ? along : 1) / gz_length3(right);
	gz_volume_half_extent(scene->volume, search->half);
	search->longest = 0;
	double edges[3], corner[3];
	for (int axis = 0; axis < 3; axis++) {
		search->longest = fmax(search->longest,
				       scene->volume->dims[axis] * scene->volume->spacing[axis]);
		corner[axis] = -search->half[axis];
		edges[axis] = 2 * search->half[axis];
	}
	gz_clip_region_place(scene->clip, scene->volume, edges, corner, &search->shown);
	const double centre[3] = { -search->origin[0], -search->origin[1], -search->origin[2] };
	search->near = fmax(0, gz_dot3(centre, search->forward) - gz_length3(search->half));
	return GZ_OK;
}

/* Find where a ball appears. False if no ray can meet it. */
static bool find_appearance(const struct want_search *search, const double centre[3], double radius,
			    struct appearance *out)
{
	double from[3], at[3];
	for (int i = 0; i < 3; i++)
		from[i] = centre[i] - search->origin[i];
	for (int i = 0; i < 3; i++)
		at[i] = gz_dot3(search->to_picture[i], from);
	const double depth = gz_dot3(from, search->forward);
	*out = (struct appearance) { .depth = depth };
	if (depth < -radius)
		return false;
	const double nearest = fmax(depth - radius, 1e-3 * radius);
	out->scale = search->pixel_per_world / (search->perspective ? nearest : 1);
	if (search->perspective && depth <= 2 * radius) {
		/* The eye is in the ball or close to it: it may appear anywhere. */
		out->radius = 1e9;
		return true;
	}
	out->x = search->perspective ? at[0] / at[2] : at[0];
	out->y = search->perspective ? at[1] / at[2] : at[1];
	/* Towards the picture's edge a ball is stretched by up to 1 / cos of the angle there. */
	const double stretch = search->perspective ? gz_length3(from) / depth : 1;
	out->radius = out->scale * radius * stretch + 1;
	return out->x + out->radius > 0 && out->y + out->radius > 0 &&
	       out->x - out->radius < search->scene->width &&
	       out->y - out->radius < search->scene->height;
}

static int block_at_px(double px, int count)
{
	const double block = floor(px / WANTS_BLOCK);
	return block < 0 ? 0 : block > count - 1 ? count - 1 : (int)block;
}

/* The finest level that any ray through a ball takes. */
static int level_taken(const struct want_search *search, const struct appearance *seen)
{
	const struct brick_scene *scene = search->scene;
	if (!scene->block_level)
		return 0;
	const int columns = (scene->width + WANTS_BLOCK - 1) / WANTS_BLOCK;
	const int rows = (scene->height + WANTS_BLOCK - 1) / WANTS_BLOCK;
	const int left = block_at_px(seen->x - seen->radius, columns);
	const int right = block_at_px(seen->x + seen->radius, columns);
	const int top = block_at_px(seen->y - seen->radius, rows);
	const int bottom = block_at_px(seen->y + seen->radius, rows);
	int level = GZ_BRICK_LEVELS_MAX;
	for (int row = top; row <= bottom && level > 0; row++)
		for (int column = left; column <= right; column++) {
			const int here = scene->block_level[row * columns + column];
			level = here < level ? here : level;
		}
	return level;
}

static void add_want(struct want_search *search, size_t brick, double weight)
{
	struct gz_brick_wants *wants = search->wants;
	if (wants->count == wants->capacity) {
		const size_t capacity = wants->capacity ? 2 * wants->capacity : 1024;
		struct gz_brick_want *want = realloc(wants->want, capacity * sizeof *want);
		if (!want) {
			search->result = GZ_ERR_NO_MEM;
			return;
		}
		wants->want = want;
		wants->capacity = capacity;
	}
	wants->want[wants->count++] =
		(struct gz_brick_want) { .brick = (uint32_t)brick, .weight = (float)weight };
}

static double weigh_brick(const struct want_search *search, int level,
			  const struct appearance *seen)
{
	const struct gz_brick_layout *layout = search->scene->layout;
	const struct gz_volume *volume = search->scene->volume;
	const struct gz_brick_level *l =
		&layout->levels[level + 1 < layout->level_count ? level + 1 : level];
	double voxel = DBL_MAX; /* of the next coarser level, world units */
	for (int axis = 0; axis < 3; axis++)
		voxel = fmin(voxel,
			     ldexp(volume->spacing[axis] / search->longest, l->halvings[axis]));
	const double *focus = search->scene->focus_px;
	const double off = fmax(0, hypot(seen->x - focus[0], seen->y - focus[1]) - seen->radius);
	const double deep = (seen->depth - search->near) / (2 * gz_length3(search->half));
	return fmin(voxel * seen->scale, 1e6) / (1 + off / RESOLVED_PX) /
	       (1 + FAR_SHARE * fmin(fmax(deep, 0), 1));
}

/* The ball around the part of a brick within the clip region; false if there is no such part. */
static bool ball_of(const struct want_search *search, int level, const int brick[3],
		    double out_centre[3], double *out_radius)
{
	const struct gz_brick_level *l = &search->scene->layout->levels[level];
	const double *plane = search->shown.plane;
	double radius2 = 0, deepest[3];
	for (int axis = 0; axis < 3; axis++) {
		const double half = search->half[axis];
		const double voxel =
			ldexp(2 * half / search->scene->volume->dims[axis], l->halvings[axis]);
		const double begin = voxel * GZ_BRICK_EDGE * brick[axis] - half;
		const double margin = CLIP_MARGIN_VOXELS * voxel;
		const double low = fmax(begin, search->shown.least[axis] - margin);
		const double high = fmin(fmin(begin + voxel * GZ_BRICK_EDGE, half),
					 search->shown.greatest[axis] + margin);
		if (low >= high)
			return false;
		out_centre[axis] = (low + high) / 2;
		radius2 += (high - low) * (high - low) / 4;
		/* The corner that lies the deepest on the side that the clip plane keeps. */
		deepest[axis] = plane[axis] > 0 ? low - margin : high + margin;
	}
	if (gz_clip_beyond(&search->shown, deepest) > 0)
		return false;
	*out_radius = sqrt(radius2);
	return true;
}

static void visit_brick(struct want_search *search, int level, const int brick[3])
{
	const struct gz_brick_layout *layout = search->scene->layout;
	const size_t number = gz_brick_number(layout, level, brick);
	const struct gz_brick_entry *entry = &search->scene->entries[number];
	if (search->result != GZ_OK ||
	    !gz_transfer_table_shows(search->scene->table, (double)entry->least,
				     (double)entry->greatest))
		return;
	double centre[3], radius;
	struct appearance seen;
	if (!ball_of(search, level, brick, centre, &radius) ||
	    !find_appearance(search, centre, radius, &seen))
		return;
	const int taken = level_taken(search, &seen);
	if (level < taken)
		return;
	add_want(search, number, weigh_brick(search, level, &seen));
	if (level == taken)
		return;
	int first[3], end[3];
	gz_brick_children(layout, level, brick, first, end);
	for (int z = first[2]; z < end[2]; z++)
		for (int y = first[1]; y < end[1]; y++)
			for (int x = first[0]; x < end[0]; x++)
				visit_brick(search, level - 1, (const int[3]) { x, y, z });
}

/* Search from the coarsest level: one brick, or several if the halvings of a long volume ended
 * before. */
static void visit_coarsest(struct want_search *search)
{
	const struct gz_brick_layout *layout = search->scene->layout;
	const int level = layout->level_count - 1;
	const int *bricks = layout->levels[level].bricks;
	for (int z = 0; z < bricks[2]; z++)
		for (int y = 0; y < bricks[1]; y++)
			for (int x = 0; x < bricks[0]; x++)
				visit_brick(search, level, (const int[3]) { x, y, z });
}

static int heavier_first(const void *a, const void *b)
{
	const struct gz_brick_want *left = a, *right = b;
	if (left->weight != right->weight)
		return left->weight > right->weight ? -1 : 1;
	return left->brick < right->brick ? -1 : left->brick > right->brick;
}

static enum gz_result find_brick_wants(const struct brick_scene *scene,
				       struct gz_brick_wants *wants)
{
	struct want_search search = {
		.scene = scene,
		.wants = wants,
		.result = GZ_OK,
	};
	wants->count = 0;
	const enum gz_result result = begin_search(&search);
	if (result != GZ_OK)
		return result;
	visit_coarsest(&search);
	if (wants->count > 0)
		qsort(wants->want, wants->count, sizeof *wants->want, heavier_first);
	return search.result;
}

static void free_wants(struct gz_brick_wants *wants)
{
	free(wants->want);
	*wants = (struct gz_brick_wants) { 0 };
}

static int blocks_along(int px)
{
	return (px + WANTS_BLOCK - 1) / WANTS_BLOCK;
}

static int block_of_pixel(int px, int count)
{
	const int block = px / WANTS_BLOCK;
	return block < count - 1 ? block : count - 1;
}

/* Lower the level of the blocks that a tile reaches into to the tile's level. */
static void mark_tile_level(const struct gz_plan *plan, const struct gz_tile *tile, uint8_t level,
			    uint8_t *blocks)
{
	const int columns = blocks_along(plan->width), rows = blocks_along(plan->height);
	const int spacing = plan->layers[tile->layer].spacing;
	/* A tile's points lie up to this far from its first. */
	const int across = 2 * GZ_TILE_EDGE * spacing, down = GZ_TILE_EDGE * spacing;
	for (int y = block_of_pixel(tile->y, rows); y <= block_of_pixel(tile->y + down, rows); y++)
		for (int x = block_of_pixel(tile->x, columns);
		     x <= block_of_pixel(tile->x + across, columns); x++) {
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
		mark_tile_level(plan, tile, (uint8_t)frame->detail->brick_level[level],
				stream->block_level);
	}
	return GZ_OK;
}

static enum gz_result find_frame_wants(struct gz_brick_stream *stream,
				       const struct gz_brick_stream_frame *frame)
{
	stream->found = false;
	enum gz_result result = frame->tile_level ? find_block_levels(stream, frame) : GZ_OK;
	const struct brick_scene scene = {
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
		result = find_brick_wants(&scene, &stream->wants);
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

static bool is_same_key(const struct gz_brick_stream_key *a, const struct gz_brick_stream_key *b)
{
	return gz_camera_same(&a->camera, &b->camera) && gz_clip_region_same(&a->clip, &b->clip) &&
	       a->focus_px[0] == b->focus_px[0] && a->focus_px[1] == b->focus_px[1] &&
	       a->pixel_lengths == b->pixel_lengths &&
	       a->ray_sampling_rate == b->ray_sampling_rate && a->plan == b->plan &&
	       a->plan_serial == b->plan_serial && a->tile_count == b->tile_count &&
	       a->width == b->width && a->height == b->height;
}

enum gz_result gz_brick_stream_find(struct gz_brick_stream *stream,
				    const struct gz_brick_stream_frame *frame)
{
	if (stream->found && is_same_key(&stream->key, &frame->key))
		return GZ_OK;
	return find_frame_wants(stream, frame);
}

void gz_brick_stream_forget(struct gz_brick_stream *stream)
{
	stream->found = false;
}

void gz_brick_stream_free(struct gz_brick_stream *stream)
{
	free_wants(&stream->wants);
	free(stream->block_level);
	*stream = (struct gz_brick_stream) { 0 };
}
