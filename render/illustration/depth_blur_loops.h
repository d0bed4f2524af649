/*
 * The loops of depth_blur.h, compiled once for each instruction set (plane_kernels.h). Nothing in
 * them is fused, so the bits are the same.
 */
#ifndef GZ_RENDER_ILLUSTRATION_DEPTH_BLUR_LOOPS_H
#define GZ_RENDER_ILLUSTRATION_DEPTH_BLUR_LOOPS_H

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "render/illustration/depth_blur.h"

/* Columns that are summed up at once, in vectors of BLUR_LANES. Chosen: the sums stay in registers.
 */
enum { BLUR_COLUMNS = 64, BLUR_LANES = 16, BLUR_VECTORS = BLUR_COLUMNS / BLUR_LANES };

/* Columns that are summed up together. */
typedef float blur_lanes __attribute__((vector_size(BLUR_LANES * sizeof(float))));

/* An index of a plane whose border repeats. */
static inline int clamp_index(int index, int count)
{
	if (index < 0)
		return 0;
	return index < count ? index : count - 1;
}

/* Add both rows at equal distance, times their weight. */
static inline void add_row_pair(blur_lanes sums[BLUR_VECTORS], const float *before,
				const float *after, float weight)
{
	for (int i = 0; i < BLUR_VECTORS; i++) {
		blur_lanes a, b;
		memcpy(&a, before + (ptrdiff_t)i * BLUR_LANES, sizeof a);
		memcpy(&b, after + (ptrdiff_t)i * BLUR_LANES, sizeof b);
		sums[i] += weight * (a + b);
	}
}

/* Begin sums with the row itself. */
static inline void begin_sums(blur_lanes sums[BLUR_VECTORS], const float *row, float weight)
{
	for (int i = 0; i < BLUR_VECTORS; i++) {
		memcpy(&sums[i], row + (ptrdiff_t)i * BLUR_LANES, sizeof sums[i]);
		sums[i] *= weight;
	}
}

/* BLUR_COLUMNS columns, all at least a radius from both borders. */
static inline void blur_whole_columns(const struct gz_gaussian *gaussian, const float *in,
				      float *out)
{
	blur_lanes sums[BLUR_VECTORS];
	begin_sums(sums, in, gaussian->weights[0]);
	for (int k = 1; k <= gaussian->radius; k++)
		add_row_pair(sums, in - k, in + k, gaussian->weights[k]);
	memcpy(out, sums, sizeof sums);
}

/* Columns that are nearer to a border. */
static inline void blur_border_columns(const struct gz_gaussian *gaussian, const float *in,
				       float *out, int begin, int end, int width)
{
	for (int x = begin; x < end; x++) {
		float sum = gaussian->weights[0] * in[x];
		for (int k = 1; k <= gaussian->radius; k++)
			sum += gaussian->weights[k] *
			       (in[clamp_index(x - k, width)] + in[clamp_index(x + k, width)]);
		out[x] = sum;
	}
}

/* Columns from begin to before end, all at least a radius from both borders. The last block begins
 * earlier where it would end later: it makes some columns again, alike. */
static inline void blur_inner_columns(const struct gz_gaussian *gaussian, const float *in,
				      float *out, int begin, int end, int width)
{
	if (end - begin < BLUR_COLUMNS) {
		blur_border_columns(gaussian, in, out, begin, end, width);
		return;
	}
	for (int x = begin; x < end; x += BLUR_COLUMNS) {
		const int from = x + BLUR_COLUMNS <= end ? x : end - BLUR_COLUMNS;
		blur_whole_columns(gaussian, in + from, out + from);
	}
}

/* gz_blur_along_rows() */
static void blur_rows(const struct gz_gaussian *gaussian, const struct gz_plane_band *band,
		      const float *in, float *out)
{
	const int width = band->width, radius = gaussian->radius;
	const int left = radius < width ? radius : width;
	const int right = width - radius > left ? width - radius : left;
	for (int y = band->first; y < band->end; y++) {
		const float *from = in + (ptrdiff_t)y * width;
		float *to = out + (ptrdiff_t)y * width;
		blur_border_columns(gaussian, from, to, 0, left, width);
		blur_inner_columns(gaussian, from, to, left, right, width);
		blur_border_columns(gaussian, from, to, right, width, width);
	}
}

/* BLUR_COLUMNS columns of one row from column @p x on. */
static inline void blur_column_block(const struct gz_gaussian *gaussian,
				     const struct gz_plane_band *band, const float *in, float *out,
				     int y, int x)
{
	const ptrdiff_t width = band->width;
	blur_lanes sums[BLUR_VECTORS];
	begin_sums(sums, in + y * width + x, gaussian->weights[0]);
	for (int k = 1; k <= gaussian->radius; k++)
		add_row_pair(sums, in + clamp_index(y - k, band->height) * width + x,
			     in + clamp_index(y + k, band->height) * width + x,
			     gaussian->weights[k]);
	memcpy(out + y * width + x, sums, sizeof sums);
}

/* Fewer columns of one row. */
static inline void blur_column_rest(const struct gz_gaussian *gaussian,
				    const struct gz_plane_band *band, const float *in, float *out,
				    int y)
{
	const ptrdiff_t width = band->width;
	for (int x = 0; x < band->width; x++) {
		float sum = gaussian->weights[0] * in[y * width + x];
		for (int k = 1; k <= gaussian->radius; k++)
			sum += gaussian->weights[k] *
			       (in[clamp_index(y - k, band->height) * width + x] +
				in[clamp_index(y + k, band->height) * width + x]);
		out[y * width + x] = sum;
	}
}

/* gz_blur_along_columns(). The last block may make some columns again, alike. */
static void blur_columns(const struct gz_gaussian *gaussian, const struct gz_plane_band *band,
			 const float *in, float *out)
{
	const int last = band->width - BLUR_COLUMNS;
	for (int y = band->first; y < band->end && last < 0; y++)
		blur_column_rest(gaussian, band, in, out, y);
	for (int x = 0; x < band->width && last >= 0; x += BLUR_COLUMNS)
		for (int y = band->first; y < band->end; y++)
			blur_column_block(gaussian, band, in, out, y, x < last ? x : last);
}

/* gz_depth_share() */
static inline void share_depth(const void *depth, const uint32_t *ids, int count,
			       const struct gz_depth_range *range, float *restrict out_shares)
{
	const char *bytes = depth;
	const float near = range->near, scale = 1 / (range->far - range->near);
	for (int i = 0; i < count; i++) {
		float value;
		memcpy(&value, bytes + (size_t)i * sizeof value, sizeof value);
		const float share = (value - near) * scale;
		const float low = share < 0 ? 0 : share;
		const float within = low < 1 ? low : 1; /* NaN becomes 1 */
		out_shares[i] = ids[i] != 0 ? within : 1;
	}
}

/* gz_depth_halve() */
static void halve_rows(const float *upper, const float *lower, int width, float *restrict out_cells)
{
	const int whole = width / 2;
	for (int i = 0; i < whole; i++)
		out_cells[i] = 0.25F * ((upper[2 * i] + upper[2 * i + 1]) +
					(lower[2 * i] + lower[2 * i + 1]));
	if (width % 2)
		out_cells[whole] = 0.5F * (upper[width - 1] + lower[width - 1]);
}

/* Enlarges cells by a factor, linearly; before the first and after the last one there is another.
 * Inlined with the factor as a constant, it becomes SIMD. */
static inline void enlarge_by(const float *restrict cells, int factor, float *restrict out_pixels)
{
	for (int i = 0; i < GZ_BLUR_COLUMNS / factor; i++) {
		const float own = cells[i + 1];
		for (int k = 0; k < factor; k++) {
			const float at = ((float)k + 0.5F) / (float)factor - 0.5F;
			const float other = at < 0 ? own - cells[i] : cells[i + 2] - own;
			out_pixels[i * factor + k] = own + at * other;
		}
	}
}

/* Enlarges cells of a level; before the first and after the last one there is another. */
static inline void enlarge_level(const float *cells, int level, float *out_pixels)
{
	switch (level) {
	case 1:
		enlarge_by(cells, 2, out_pixels);
		break;
	case 2:
		enlarge_by(cells, 4, out_pixels);
		break;
	case 3:
		enlarge_by(cells, 8, out_pixels);
		break;
	case 4:
		enlarge_by(cells, 16, out_pixels);
		break;
	case 5:
		enlarge_by(cells, 32, out_pixels);
		break;
	default:
		memcpy(out_pixels, cells + 1, GZ_BLUR_COLUMNS * sizeof *out_pixels);
		break;
	}
}

/* Enlarges cells between two rows of them. */
static inline void enlarge_row(const float *above, const float *below, float share, int width,
			       int level, int x, float *out_pixels)
{
	float cells[GZ_BLUR_COLUMNS + 2];
	const int first = (x >> level) - 1, count = (GZ_BLUR_COLUMNS >> level) + 2;
	if (first >= 0 && first + count <= width)
		for (int i = 0; i < count; i++)
			cells[i] = above[first + i] + share * (below[first + i] - above[first + i]);
	else
		for (int i = 0; i < count; i++) {
			const int cell = clamp_index(first + i, width);
			cells[i] = above[cell] + share * (below[cell] - above[cell]);
		}
	enlarge_level(cells, level, out_pixels);
}

/* gz_depth_enlarge() */
static void enlarge_cells(const float *cells, int width, int height, int level, int x, int y,
			  float *out_pixels)
{
	const float at = ((float)y + 0.5F) / (float)(1 << level) - 0.5F;
	const int above = (int)floorf(at), below = above + 1;
	const int first = above > 0 ? above : 0, last = below < height ? below : height - 1;
	enlarge_row(cells + (ptrdiff_t)first * width, cells + (ptrdiff_t)last * width,
		    at - (float)above, width, level, x, out_pixels);
}

#endif
