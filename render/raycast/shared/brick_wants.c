#include "render/raycast/shared/brick_wants.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "render/picture/vector.h"

/* Pixels from the gaze in which the spacing that the eye resolves grows by one pixel: m / 2 of
 * docs/foveation.md, small angles, m = 0.022. */
#define RESOLVED_PX 90

/* How much less a brick counts at the far end of the volume than at the near one, which may hide
 * it. Chosen: decides only between bricks that count alike. */
#define FAR_SHARE 0.5

/* How far outside the clip box voxels count: those that samples in it lie between, and those that
 * their gradients ask for. */
#define CLIP_MARGIN_VOXELS 2

struct search {
	const struct gz_brick_scene *scene;
	struct gz_brick_wants *wants;
	double to_picture[3][3]; /* world, less origin, to (x, y, 1) * depth */
	double origin[3];
	double forward[3];      /* unit vector into the picture */
	double pixel_per_world; /* at depth 1; orthographic at every depth */
	bool perspective;
	double half[3], longest, near; /* of the box; the depth it begins at */
	enum gz_result result;
};

/* Where a ball appears. */
struct appearance {
	double x, y, radius; /* px */
	double scale;        /* px per world unit, at its nearest */
	double depth;        /* world units, of its centre */
};

/* The inverse of the matrix whose columns are one pixel right, one down, and the first ray. */
static bool invert(const double right[3], const double down[3], const double first[3],
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

static enum gz_result begin(struct search *search)
{
	const struct gz_brick_scene *scene = search->scene;
	struct gz_ray_frame rays;
	const enum gz_result result =
		gz_camera_rays(scene->camera, scene->width, scene->height, &rays);
	if (result != GZ_OK)
		return result;
	search->perspective = scene->camera->projection == GZ_PROJECTION_PERSPECTIVE;
	const double *right = search->perspective ? rays.direction_dx : rays.origin_dx;
	const double *down = search->perspective ? rays.direction_dy : rays.origin_dy;
	if (!invert(right, down, rays.direction00, search->to_picture))
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
	for (int axis = 0; axis < 3; axis++)
		search->longest = fmax(search->longest,
				       scene->volume->dims[axis] * scene->volume->spacing[axis]);
	const double centre[3] = { -search->origin[0], -search->origin[1], -search->origin[2] };
	search->near = fmax(0, gz_dot3(centre, search->forward) - gz_length3(search->half));
	return GZ_OK;
}

/* False where no ray can meet it. */
static bool appears(const struct search *search, const double centre[3], double radius,
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
		/* The eye is in it or close to: it may be anywhere. */
		out->radius = 1e9;
		return true;
	}
	out->x = search->perspective ? at[0] / at[2] : at[0];
	out->y = search->perspective ? at[1] / at[2] : at[1];
	/* Towards the picture's edge a ball is drawn out by up to 1 / cos of the angle there. */
	const double stretch = search->perspective ? gz_length3(from) / depth : 1;
	out->radius = out->scale * radius * stretch + 1;
	return out->x + out->radius > 0 && out->y + out->radius > 0 &&
	       out->x - out->radius < search->scene->width &&
	       out->y - out->radius < search->scene->height;
}

static int block_of(double px, int count)
{
	const double block = floor(px / GZ_WANTS_BLOCK);
	return block < 0 ? 0 : block > count - 1 ? count - 1 : (int)block;
}

/* The finest level that any ray through it takes. */
static int level_taken(const struct search *search, const struct appearance *seen)
{
	const struct gz_brick_scene *scene = search->scene;
	if (!scene->block_level)
		return 0;
	const int columns = (scene->width + GZ_WANTS_BLOCK - 1) / GZ_WANTS_BLOCK;
	const int rows = (scene->height + GZ_WANTS_BLOCK - 1) / GZ_WANTS_BLOCK;
	const int left = block_of(seen->x - seen->radius, columns);
	const int right = block_of(seen->x + seen->radius, columns);
	const int top = block_of(seen->y - seen->radius, rows);
	const int bottom = block_of(seen->y + seen->radius, rows);
	int level = GZ_BRICK_LEVELS_MAX;
	for (int row = top; row <= bottom && level > 0; row++)
		for (int column = left; column <= right; column++) {
			const int here = scene->block_level[row * columns + column];
			level = here < level ? here : level;
		}
	return level;
}

static void add(struct search *search, size_t brick, double weight)
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

static double weigh(const struct search *search, int level, const struct appearance *seen)
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

/* The ball round what a brick shows of the clip box; false where it shows nothing. */
static bool ball_of(const struct search *search, int level, const int brick[3],
		    double out_centre[3], double *out_radius)
{
	const struct gz_brick_level *l = &search->scene->layout->levels[level];
	const struct gz_clip_box *clip = search->scene->clip;
	double radius2 = 0;
	for (int axis = 0; axis < 3; axis++) {
		const double half = search->half[axis];
		const double voxel =
			ldexp(2 * half / search->scene->volume->dims[axis], l->halvings[axis]);
		const double begin = voxel * GZ_BRICK_EDGE * brick[axis] - half;
		const double margin = CLIP_MARGIN_VOXELS * voxel;
		const double low = fmax(begin, (2 * clip->least[axis] - 1) * half - margin);
		const double high = fmin(fmin(begin + voxel * GZ_BRICK_EDGE, half),
					 (2 * clip->greatest[axis] - 1) * half + margin);
		if (low >= high)
			return false;
		out_centre[axis] = (low + high) / 2;
		radius2 += (high - low) * (high - low) / 4;
	}
	*out_radius = sqrt(radius2);
	return true;
}

static void visit(struct search *search, int level, const int brick[3])
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
	    !appears(search, centre, radius, &seen))
		return;
	const int taken = level_taken(search, &seen);
	if (level < taken)
		return;
	add(search, number, weigh(search, level, &seen));
	if (level == taken)
		return;
	int first[3], end[3];
	gz_brick_children(layout, level, brick, first, end);
	for (int z = first[2]; z < end[2]; z++)
		for (int y = first[1]; y < end[1]; y++)
			for (int x = first[0]; x < end[0]; x++)
				visit(search, level - 1, (const int[3]) { x, y, z });
}

/* One brick, or several of a volume longer than all halvings make one of. */
static void visit_coarsest(struct search *search)
{
	const struct gz_brick_layout *layout = search->scene->layout;
	const int level = layout->level_count - 1;
	const int *bricks = layout->levels[level].bricks;
	for (int z = 0; z < bricks[2]; z++)
		for (int y = 0; y < bricks[1]; y++)
			for (int x = 0; x < bricks[0]; x++)
				visit(search, level, (const int[3]) { x, y, z });
}

static int heavier_first(const void *a, const void *b)
{
	const struct gz_brick_want *left = a, *right = b;
	if (left->weight != right->weight)
		return left->weight > right->weight ? -1 : 1;
	return left->brick < right->brick ? -1 : left->brick > right->brick;
}

enum gz_result gz_brick_wants_find(const struct gz_brick_scene *scene, struct gz_brick_wants *wants)
{
	struct search search = {
		.scene = scene,
		.wants = wants,
		.result = GZ_OK,
	};
	wants->count = 0;
	const enum gz_result result = begin(&search);
	if (result != GZ_OK)
		return result;
	visit_coarsest(&search);
	if (wants->count > 0)
		qsort(wants->want, wants->count, sizeof *wants->want, heavier_first);
	return search.result;
}

void gz_brick_wants_free(struct gz_brick_wants *wants)
{
	free(wants->want);
	*wants = (struct gz_brick_wants) { 0 };
}
