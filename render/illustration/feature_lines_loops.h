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
	REACH = GZ_LINE_REACH,
	WINDOW_COLUMNS = GZ_LINE_COLUMNS + 2 * GZ_LINE_REACH,
	NEIGHBOURS_MAX = 24,
};

/* Where the neighbours of a filter are: columns, rows. */
struct line_stencil {
	int count;
	signed char offsets[NEIGHBOURS_MAX][2];
};

static const struct line_stencil line_stencils[GZ_LINE_FILTER_COUNT] = {
	[GZ_LINES_4] = { 4, { { 0, -1 }, { -1, 0 }, { 1, 0 }, { 0, 1 } } },
	[GZ_LINES_8] = { 8,
			 { { -1, -1 },
			   { 0, -1 },
			   { 1, -1 },
			   { -1, 0 },
			   { 1, 0 },
			   { -1, 1 },
			   { 0, 1 },
			   { 1, 1 } } },
	[GZ_LINES_12] = { 12,
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
	[GZ_LINES_24] = { 24,
			  { { -2, -2 }, { -1, -2 }, { 0, -2 }, { 1, -2 }, { 2, -2 }, { -2, -1 },
			    { -1, -1 }, { 0, -1 },  { 1, -1 }, { 2, -1 }, { -2, 0 }, { -1, 0 },
			    { 1, 0 },   { 2, 0 },   { -2, 1 }, { -1, 1 }, { 0, 1 },  { 1, 1 },
			    { 2, 1 },   { -2, 2 },  { -1, 2 }, { 0, 2 },  { 1, 2 },  { 2, 2 } } },
};

/* What a window is like. */
struct window_look {
	bool one_object; /* all of it, with what surrounds it */
	bool even;       /* nothing is farther than anything else by a threshold */
};

/* Looks at the rows of a window and those around them. */
static struct window_look look_at_window(const struct gz_line_window *window, int rows,
					 float threshold)
{
	const uint32_t own = window->ids[0][0];
	uint32_t others = 0;
	float nearest[WINDOW_COLUMNS], farthest[WINDOW_COLUMNS]; /* of each column: SIMD */
	memcpy(nearest, window->depth[0], sizeof nearest);
	memcpy(farthest, window->depth[0], sizeof farthest);
	for (int row = 0; row < rows + 2 * REACH; row++)
		for (int i = 0; i < WINDOW_COLUMNS; i++) {
			const float depth = window->depth[row][i];
			others |= window->ids[row][i] ^ own;
			nearest[i] = depth < nearest[i] ? depth : nearest[i];
			farthest[i] = depth > farthest[i] ? depth : farthest[i];
		}
	for (int i = 1; i < WINDOW_COLUMNS; i++) {
		nearest[0] = nearest[i] < nearest[0] ? nearest[i] : nearest[0];
		farthest[0] = farthest[i] > farthest[0] ? farthest[i] : farthest[0];
	}
	/* a little less than the threshold: sums are rounded */
	return (struct window_look) { others == 0, farthest[0] - nearest[0] < 0.999F * threshold };
}

/* Pixels that are filtered at once: sums of them stay in registers. */
enum { LINE_BLOCK = 16 };

/* Add what one neighbour of each pixel contributes to the filter of ids, in halves: 1 farther, -1
 * nearer. Choices that are not nested become SIMD. */
static inline void add_id_neighbour(const uint32_t *own, const float *own_depth, ptrdiff_t offset,
				    int32_t *restrict halves)
{
	const uint32_t *ids = own + offset;
	const float *depth = own_depth + offset;
	for (int i = 0; i < LINE_BLOCK; i++) {
		const int32_t farther = depth[i] > own_depth[i] ? 1 : 0;
		const int32_t alike = depth[i] == own_depth[i] ? 1 : 0;
		const int32_t later = ids[i] > own[i] ? 1 : 0;
		const int32_t other = ids[i] != own[i] ? -1 : 0;
		halves[i] += other & (2 * (farther | (alike & later)) - 1);
	}
}

/* Filter some pixels of a row of a window. */
static inline void filter_block(const uint32_t *own, const float *own_depth,
				const struct line_stencil *stencil, bool one_object,
				float threshold, float *restrict out_lines)
{
	int32_t id_halves[LINE_BLOCK] = { 0 };
	float depth_sums[LINE_BLOCK] = { 0 };
	const float neighbours = (float)stencil->count;
	for (int k = 0; k < stencil->count; k++) {
		const ptrdiff_t offset =
			stencil->offsets[k][1] * WINDOW_COLUMNS + stencil->offsets[k][0];
		for (int i = 0; i < LINE_BLOCK; i++)
			depth_sums[i] += own_depth[offset + i];
		if (!one_object)
			add_id_neighbour(own, own_depth, offset, id_halves);
	}
	for (int i = 0; i < LINE_BLOCK; i++) {
		const float beyond = depth_sums[i] - neighbours * (own_depth[i] + threshold);
		const float inner = beyond > 0 ? GZ_LINE_INNER : GZ_LINE_NONE;
		const float line = id_halves[i] > 0 ? GZ_LINE_SILHOUETTE : inner;
		out_lines[i] = own[i] != 0 ? line : GZ_LINE_NONE;
	}
}

/* Filter a row of a window. */
static inline void filter_lines(const struct gz_line_window *window, int row,
				const struct line_stencil *stencil, bool one_object,
				float threshold, float *out_lines)
{
	for (int i = 0; i < GZ_LINE_COLUMNS; i += LINE_BLOCK)
		filter_block(&window->ids[REACH + row][REACH + i],
			     &window->depth[REACH + row][REACH + i], stencil, one_object, threshold,
			     out_lines + i);
}

/* gz_feature_lines() */
static bool find_lines(const struct gz_line_window *window, int rows, enum gz_line_filter filter,
		       float threshold, float *out_lines)
{
	const struct window_look look = look_at_window(window, rows, threshold);
	if (look.one_object && (look.even || window->ids[0][0] == 0)) {
		memset(out_lines, 0, /* GZ_LINE_NONE */
		       (size_t)rows * GZ_LINE_COLUMNS * sizeof *out_lines);
		return false;
	}
	for (int row = 0; row < rows; row++)
		filter_lines(window, row, &line_stencils[filter], look.one_object, threshold,
			     out_lines + (size_t)row * GZ_LINE_COLUMNS);
	return true;
}

#endif
