#include "render/illustration/stipple_tiles.h"

#include <stdlib.h>

/* Rounding of single precision over a few sums, as a share. */
#define ROUNDING 1e-4F

/* Tiles [left, right) by [top, bottom). */
struct tile_range {
	int left, top, right, bottom;
};

/* The least and the greatest quotient of two ranges, the divisors above 0. */
static void divide_range(const float numbers[2], const float divisors[2], float out[2])
{
	out[0] = numbers[0] / divisors[numbers[0] < 0 ? 0 : 1];
	out[1] = numbers[1] / divisors[numbers[1] < 0 ? 1 : 0];
}

/* Tiles between two places of an axis with a margin of a pixel, cut to the picture. */
static void tiles_between(const float places[2], int pixels, int *out_first, int *out_end)
{
	const float last = (float)(pixels - 1);
	const float low = places[0] - 1 > 0 ? places[0] - 1 : 0;
	const float high = places[1] + 1 < last ? places[1] + 1 : last;
	*out_first = *out_end = 0;
	if (!(low <= high))
		return;
	*out_first = (int)low / GZ_STIPPLE_TILE_PX;
	*out_end = (int)high / GZ_STIPPLE_TILE_PX + 1;
}

/* The tiles that a ball may cover; none if it lies behind the eye. */
static struct tile_range range_of_ball(const struct gz_stipple_projector *projector,
				       const struct gz_stipple_ball *ball)
{
	const struct gz_plane *tone = projector->view->tone;
	float ends[3][2], divisors[2] = { 1, 1 }, x[2], y[2];
	for (int row = 0; row < 3; row++) {
		const float *axis = projector->rows[row];
		const float middle = gz_stipple_dot(axis, ball->from);
		const float margin =
			(1 + ROUNDING) * ball->reach * sqrtf(gz_stipple_dot(axis, axis));
		ends[row][0] = middle - margin;
		ends[row][1] = middle + margin;
	}
	if (!projector->orthographic) {
		if (ends[2][1] <= 0)
			return (struct tile_range) { 0 };
		divisors[0] = fmaxf(ends[2][0], 0); /* around the eye: quotients are infinite */
		divisors[1] = ends[2][1];
	}
	struct tile_range range;
	divide_range(ends[0], divisors, x);
	divide_range(ends[1], divisors, y);
	tiles_between(x, tone->width, &range.left, &range.right);
	tiles_between(y, tone->height, &range.top, &range.bottom);
	return range;
}

/* The darkest pixel and the farthest one of the object, of a tile's part of a row. */
static void bound_row(const struct gz_stipple_view *view, size_t from, int count,
		      struct gz_stipple_bound *bound)
{
	float lightest_ink = 1, farthest = -INFINITY;
	for (int i = 0; i < count; i++) {
		float tone, depth;
		memcpy(&tone, &view->tone->words[from + (size_t)i], sizeof tone);
		memcpy(&depth, &view->depth->words[from + (size_t)i], sizeof depth);
		const bool seen = !view->ids || view->ids->words[from + (size_t)i] == view->id;
		const float reached = seen ? depth : -INFINITY;
		lightest_ink = tone < lightest_ink ? tone : lightest_ink;
		farthest = reached > farthest ? reached : farthest;
	}
	const float ink = lightest_ink < 0 ? 1 : 1 - lightest_ink;
	bound->ink = ink > bound->ink ? ink : bound->ink;
	bound->farthest = farthest > bound->farthest ? farthest : bound->farthest;
}

static struct gz_stipple_bound bound_tile(const struct gz_stipple_view *view, int column, int row)
{
	const struct gz_plane *tone = view->tone;
	const int x = column * GZ_STIPPLE_TILE_PX, y = row * GZ_STIPPLE_TILE_PX;
	const int right = x + GZ_STIPPLE_TILE_PX, below = y + GZ_STIPPLE_TILE_PX;
	const int columns = right < tone->width ? GZ_STIPPLE_TILE_PX : tone->width - x;
	struct gz_stipple_bound bound = { .farthest = -INFINITY };
	for (int line = y; line < below && line < tone->height; line++)
		bound_row(view, (size_t)line * (size_t)tone->width + (size_t)x, columns, &bound);
	/* between the lattice's points, scales are mixed */
	const float corners[4] = {
		gz_stipple_scale_at(view->scale, (float)x, (float)y),
		gz_stipple_scale_at(view->scale, (float)right, (float)y),
		gz_stipple_scale_at(view->scale, (float)x, (float)below),
		gz_stipple_scale_at(view->scale, (float)right, (float)below),
	};
	bound.scale = fminf(fminf(corners[0], corners[1]), fminf(corners[2], corners[3]));
	return bound;
}

static void bound_tile_row(void *user, size_t row, int worker)
{
	const struct gz_stipple_tiles *tiles = user;
	(void)worker;
	for (int column = 0; column < tiles->columns; column++)
		tiles->bounds[row * (size_t)tiles->columns + (size_t)column] = bound_tile(
			tiles->projector->view, tiles->left + column, tiles->top + (int)row);
}

enum gz_result gz_stipple_tiles_make(const struct gz_stipple_projector *projector,
				     const struct gz_stipple_ball *ball, struct gz_workers *workers,
				     struct gz_stipple_tiles *out_tiles)
{
	const struct tile_range range = range_of_ball(projector, ball);
	struct gz_stipple_tiles tiles = { .left = range.left,
					  .top = range.top,
					  .columns = range.right - range.left,
					  .rows = range.bottom - range.top,
					  .projector = projector };
	if (tiles.columns == 0 || tiles.rows == 0) {
		*out_tiles = (struct gz_stipple_tiles) { .projector = projector };
		return GZ_OK;
	}
	tiles.bounds = malloc((size_t)tiles.columns * (size_t)tiles.rows * sizeof *tiles.bounds);
	if (!tiles.bounds)
		return GZ_ERR_NO_MEM;
	if (workers)
		gz_workers_run(workers, bound_tile_row, &tiles, (size_t)tiles.rows);
	else
		for (size_t row = 0; row < (size_t)tiles.rows; row++)
			bound_tile_row(&tiles, row, 0);
	*out_tiles = tiles;
	return GZ_OK;
}

/* How much farther than what is seen a mark may lie at most, world units; see
 * gz_stipple_spot_seen(). */
static float greatest_margin(const struct gz_stipple_projector *projector,
			     const struct gz_stipple_ball *ball)
{
	const float *row = projector->rows[2];
	const float depth =
		gz_stipple_dot(row, ball->from) + ball->reach * sqrtf(gz_stipple_dot(row, row));
	const float edge =
		projector->pixel * (projector->orthographic ? 1 : depth) * projector->world_per_mm;
	return edge * projector->tolerance_most;
}

/* The least distance along rays of what is in a ball, world units. */
static float nearest_in_ball(const struct gz_stipple_projector *projector,
			     const struct gz_stipple_ball *ball)
{
	const float distance = projector->orthographic
				       ? gz_stipple_dot(projector->rows[2], ball->from) *
						 projector->direction_scale
				       : sqrtf(gz_stipple_dot(ball->from, ball->from));
	return ((1 - ROUNDING) * distance - (1 + ROUNDING) * ball->reach) * projector->world_per_mm;
}

bool gz_stipple_tiles_bound(const struct gz_stipple_tiles *tiles,
			    const struct gz_stipple_ball *ball, struct gz_stipple_bound *out_bound)
{
	const struct gz_stipple_projector *projector = tiles->projector;
	const struct tile_range range = range_of_ball(projector, ball);
	struct gz_stipple_bound all = { 0, -INFINITY, INFINITY };
	for (int row = range.top - tiles->top; row < range.bottom - tiles->top; row++)
		for (int column = range.left - tiles->left; column < range.right - tiles->left;
		     column++) {
			if (row < 0 || column < 0 || row >= tiles->rows || column >= tiles->columns)
				continue; /* rounding: the ball of all has no place there */
			const struct gz_stipple_bound *bound =
				&tiles->bounds[(ptrdiff_t)row * tiles->columns + column];
			all.ink = fmaxf(all.ink, bound->ink);
			all.farthest = fmaxf(all.farthest, bound->farthest);
			all.scale = fminf(all.scale, bound->scale);
		}
	*out_bound = all;
	return nearest_in_ball(projector, ball) <= all.farthest + greatest_margin(projector, ball);
}

void gz_stipple_tiles_free(struct gz_stipple_tiles *tiles)
{
	free(tiles->bounds);
	*tiles = (struct gz_stipple_tiles) { 0 };
}
