/*
 * The loops of feature_lines.h, compiled once for each instruction set (plane_kernels.h).
 */
#ifndef GZ_RENDER_ILLUSTRATION_FEATURE_LINES_LOOPS_H
#define GZ_RENDER_ILLUSTRATION_FEATURE_LINES_LOOPS_H

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "render/illustration/feature_lines.h"

enum {
	LINE_COLUMNS =
		64, /* that are filtered at once; chosen: they stay in the first-level cache */
	REACH = 2,  /* of the widest filter */
	NEIGHBOURS_MAX = 24,
};

/* Where the neighbours of a filter are: columns, rows. */
struct line_stencil {
	int reach; /* steps to the farthest neighbour, along x and y */
	int count;
	signed char offsets[NEIGHBOURS_MAX][2];
};

static const struct line_stencil line_stencils[GZ_LINE_FILTER_COUNT] = {
	[GZ_LINES_4] = { 1, 4, { { 0, -1 }, { -1, 0 }, { 1, 0 }, { 0, 1 } } },
	[GZ_LINES_8] = { 1,
			 8,
			 { { -1, -1 },
			   { 0, -1 },
			   { 1, -1 },
			   { -1, 0 },
			   { 1, 0 },
			   { -1, 1 },
			   { 0, 1 },
			   { 1, 1 } } },
	[GZ_LINES_12] = { 2,
			  12,
			  { { 0, -2 },
			    { -1, -1 },
			    { 0, -1 },
			    { 1, -1 },
			    { -2, 0 },
			    { -1, 0 },
			    { 1, 0 },
			    { 2, 0 },
			    { -1, 1 },
			    { 0, 1 },
			    { 1, 1 },
			    { 0, 2 } } },
	[GZ_LINES_24] = { 2, 24, { { -2, -2 }, { -1, -2 }, { 0, -2 }, { 1, -2 }, { 2, -2 },
				   { -2, -1 }, { -1, -1 }, { 0, -1 }, { 1, -1 }, { 2, -1 },
				   { -2, 0 },  { -1, 0 },  { 1, 0 },  { 2, 0 },  { -2, 1 },
				   { -1, 1 },  { 0, 1 },   { 1, 1 },  { 2, 1 },  { -2, 2 },
				   { -1, 2 },  { 0, 2 },   { 1, 2 },  { 2, 2 } } },
};

/* Pixels of a row with what surrounds them, so that no index leaves the picture. */
struct line_window {
	uint32_t ids[2 * REACH + 1][LINE_COLUMNS + 2 * REACH];
	float depth[2 * REACH + 1][LINE_COLUMNS + 2 * REACH];
};

/* An index of a plane whose border repeats. */
static int within(int index, int count)
{
	if (index < 0)
		return 0;
	return index < count ? index : count - 1;
}

/* Some pixels of a row, and how far around them a filter looks. */
struct line_place {
	int x, y, count, reach;
};

/* Copy what surrounds some pixels: of the window, the rows that the filter reaches. */
static void take_window(const struct gz_line_planes *planes, const struct gz_plane_band *band,
			const struct line_place *place, struct line_window *window)
{
	const int x = place->x, y = place->y, count = place->count;
	const bool inside = x >= REACH && x + count + REACH <= band->width;
	for (int row = REACH - place->reach; row <= REACH + place->reach; row++) {
		const ptrdiff_t start =
			(ptrdiff_t)within(y + row - REACH, band->height) * band->width;
		const uint32_t *ids = planes->ids + start;
		const float *depth = planes->depth + start;
		const int wide = count + 2 * REACH;
		if (inside) {
			memcpy(window->ids[row], ids + x - REACH, (size_t)wide * sizeof *ids);
			memcpy(window->depth[row], depth + x - REACH, (size_t)wide * sizeof *depth);
		}
		for (int i = 0; !inside && i < wide; i++) {
			window->ids[row][i] = ids[within(x + i - REACH, band->width)];
			window->depth[row][i] = depth[within(x + i - REACH, band->width)];
		}
	}
}

/* Whether all pixels of a window are of one object. */
static bool is_one_object(const struct line_window *window, const struct line_place *place)
{
	const uint32_t own = window->ids[REACH][REACH];
	uint32_t others = 0;
	for (int row = REACH - place->reach; row <= REACH + place->reach; row++)
		for (int i = 0; i < place->count + 2 * REACH; i++)
			others |= window->ids[row][i] ^ own;
	return others == 0;
}

/* Add what one neighbour of each pixel contributes to the filter of ids. */
static void add_id_neighbour(const struct line_window *window, const signed char offset[2],
			     int count, float *restrict sums)
{
	const uint32_t *own = &window->ids[REACH][REACH];
	const float *own_depth = &window->depth[REACH][REACH];
	const uint32_t *ids = &window->ids[REACH + offset[1]][REACH + offset[0]];
	const float *depth = &window->depth[REACH + offset[1]][REACH + offset[0]];
	for (int i = 0; i < count; i++) {
		const float farther = depth[i] > own_depth[i] ? 1 : 0;
		const float later = ids[i] > own[i] ? 1 : 0;
		const float renamed = depth[i] == own_depth[i] ? later : farther;
		sums[i] += (ids[i] == own[i] ? 0.5F : renamed) - 0.5F;
	}
}

/* Add the depth of one neighbour of each pixel. */
static void add_depth_neighbour(const struct line_window *window, const signed char offset[2],
				int count, float *restrict sums)
{
	const float *depth = &window->depth[REACH + offset[1]][REACH + offset[0]];
	for (int i = 0; i < count; i++)
		sums[i] += depth[i];
}

/* Filter some pixels of a row. */
static void filter_lines(const struct line_window *window, const struct line_stencil *stencil,
			 const struct line_place *place, float threshold, float *restrict out_lines)
{
	const int count = place->count;
	float id_sums[LINE_COLUMNS] = { 0 }, depth_sums[LINE_COLUMNS] = { 0 };
	const uint32_t *own = &window->ids[REACH][REACH];
	const float *own_depth = &window->depth[REACH][REACH];
	const float neighbours = (float)stencil->count;
	const bool one_object = is_one_object(window, place);
	if (one_object && own[0] == 0) {
		memset(out_lines, 0, (size_t)count * sizeof *out_lines); /* GZ_LINE_NONE */
		return;
	}
	for (int k = 0; k < stencil->count; k++)
		add_depth_neighbour(window, stencil->offsets[k], count, depth_sums);
	for (int k = 0; !one_object && k < stencil->count; k++)
		add_id_neighbour(window, stencil->offsets[k], count, id_sums);
	for (int i = 0; i < count; i++) {
		const float beyond = depth_sums[i] - neighbours * (own_depth[i] + threshold);
		const float inner = beyond > 0 ? GZ_LINE_INNER : GZ_LINE_NONE;
		const float line = id_sums[i] > 0 ? GZ_LINE_SILHOUETTE : inner;
		out_lines[i] = own[i] != 0 ? line : GZ_LINE_NONE;
	}
}

/* gz_feature_lines() */
static void find_lines(const struct gz_line_planes *planes, const struct gz_plane_band *band,
		       enum gz_line_filter filter, float threshold, float *out_lines)
{
	const struct line_stencil *stencil = &line_stencils[filter];
	struct line_window window;
	for (int y = band->first; y < band->end; y++)
		for (int x = 0; x < band->width; x += LINE_COLUMNS) {
			const int rest = band->width - x;
			const struct line_place place = { x, y,
							  rest < LINE_COLUMNS ? rest : LINE_COLUMNS,
							  stencil->reach };
			float *lines = out_lines + (ptrdiff_t)y * band->width + x;
			take_window(planes, band, &place, &window);
			filter_lines(&window, stencil, &place, threshold, lines);
		}
}

#endif
