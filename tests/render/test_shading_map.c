/* The composition of a shading map: blurred depth, tone curves, lines and each equation, by numbers
 * worked out by hand. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mesh_fields.h"
#include "render/illustration/depth_blur.h"
#include "render/illustration/feature_lines.h"
#include "render/illustration/plane_kernels.h"
#include "render/illustration/shading_map.h"
#include "render/illustration/tone_curve.h"

static void check_map(const float *found, const double *right, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		if (fabs((double)found[i] - right[i]) > 1e-6)
			print_message("pixel %zu: %.7f instead of %.7f\n", i, (double)found[i],
				      right[i]);
		assert_true(fabs((double)found[i] - right[i]) <= 1e-6);
	}
}

/* ---- blurred depth ---- */

static void gaussian_adds_up_to_one_and_ends_at_three_deviations(void **state)
{
	(void)state;
	struct gz_gaussian gaussian;
	for (double deviation = 0; deviation < 60; deviation += 1.7) {
		double sum = 0, variance = 0;
		gz_gaussian_make(deviation, &gaussian);
		for (int i = -gaussian.radius; i <= gaussian.radius; i++) {
			sum += (double)gaussian.weights[abs(i)];
			variance += (double)gaussian.weights[abs(i)] * i * i;
		}
		assert_true(fabs(sum - 1) < 1e-6);
		assert_true(deviation > 43 ||
			    fabs(sqrt(variance) - deviation) <= 0.02 * deviation + 1e-9);
	}
	gz_gaussian_make(0, &gaussian);
	assert_int_equal(gaussian.radius, 0);
	gz_gaussian_make(1e9, &gaussian);
	assert_int_equal(gaussian.radius, GZ_GAUSSIAN_RADIUS_MAX);
}

/* Weights 1/4, 1/2, 1/4; a step in a row of four, and the border repeats. */
static void blur_is_a_weighted_mean_along_rows_and_columns(void **state)
{
	(void)state;
	const struct gz_gaussian gaussian = { .radius = 1, .weights = { 0.5F, 0.25F } };
	const float row[4] = { 0, 0, 1, 1 };
	float found[4];
	gz_blur_along_rows(&gaussian, &(struct gz_plane_band) { 4, 1, 0, 1 }, row, found);
	check_map(found, (const double[]) { 0, 0.25, 0.75, 1 }, 4);
	gz_blur_along_columns(&gaussian, &(struct gz_plane_band) { 1, 4, 0, 4 }, row, found);
	check_map(found, (const double[]) { 0, 0.25, 0.75, 1 }, 4);
	/* A kernel that is wider than the picture. */
	const struct gz_gaussian wide = { .radius = 3, .weights = { 0.4F, 0.1F, 0.1F, 0.1F } };
	gz_blur_along_rows(&wide, &(struct gz_plane_band) { 2, 1, 0, 1 }, row + 1, found);
	check_map(found, (const double[]) { 0.3, 0.7 }, 2);
}

/* Bands of rows give what the whole gives, and wide rows what a plain sum over both sides gives. */
static void bands_and_blocks_change_nothing(void **state)
{
	(void)state;
	enum { WIDE = 150, HIGH = 23 };
	static float in[HIGH * WIDE], once[HIGH * WIDE], whole[HIGH * WIDE], parts[HIGH * WIDE];
	struct gz_gaussian gaussian;
	uint32_t seed = 11;
	for (size_t i = 0; i < HIGH * WIDE; i++)
		in[i] = (float)field_random(&seed);
	gz_gaussian_make(4, &gaussian);
	const struct gz_plane_band all = { WIDE, HIGH, 0, HIGH };
	gz_blur_along_rows(&gaussian, &all, in, once);
	gz_blur_along_columns(&gaussian, &all, once, whole);
	for (int first = 0; first < HIGH; first += 5) {
		const struct gz_plane_band band = { WIDE, HIGH, first,
						    first + 5 < HIGH ? first + 5 : HIGH };
		gz_blur_along_columns(&gaussian, &band, once, parts);
	}
	assert_memory_equal(whole, parts, sizeof whole);
	for (int i = 0; i < HIGH * WIDE; i++) {
		double sum = 0;
		for (int dy = -gaussian.radius; dy <= gaussian.radius; dy++)
			for (int dx = -gaussian.radius; dx <= gaussian.radius; dx++) {
				const int x = (int)fmin(fmax(i % WIDE + dx, 0), WIDE - 1);
				const int y = (int)fmin(fmax(i / WIDE + dy, 0), HIGH - 1);
				sum += (double)gaussian.weights[abs(dx)] *
				       (double)gaussian.weights[abs(dy)] * (double)in[y * WIDE + x];
			}
		assert_true(fabs(sum - (double)whole[i]) < 1e-5);
	}
}

static void depth_is_a_share_of_the_scene(void **state)
{
	(void)state;
	const float depth[6] = { 5, 10, 15, 25, NAN, 15 };
	const uint32_t ids[6] = { 1, 1, 1, 1, 1, 0 };
	float found[6];
	gz_depth_share(depth, ids, 6, &(struct gz_depth_range) { 10, 20 }, found);
	check_map(found, (const double[]) { 0, 0, 0.5, 1, 1, 1 }, 6);
}

static void cells_are_means_and_pixels_lie_between_them(void **state)
{
	(void)state;
	const float upper[5] = { 0, 0.2F, 0.4F, 0.8F, 0.5F }, lower[5] = { 0.2F, 0.4F, 0, 0, 0.7F };
	float cells[3], pixels[GZ_BLUR_COLUMNS];
	gz_depth_halve(upper, lower, 5, cells);
	check_map(cells, (const double[]) { 0.2, 0.3, 0.6 }, 3);
	/* Two rows of three cells of 4 by 4 pixels; row 5 is 7/8 of the way to the second one. */
	const float plane[6] = { 0, 0, 0, 0.8F, 0.8F, 0 };
	gz_depth_enlarge(plane, 3, 2, 2, 0, 5, pixels);
	const double low = 0.875 * 0.8;
	check_map(pixels,
		  (const double[]) { low, low, low, low, low, low, 0.875 * low, 0.625 * low,
				     0.375 * low, 0.125 * low, 0, 0, 0, 0 },
		  14);
}

/* A blur of cells against the Gaussian of the pixels, on a disc, a bar and a ramp before a
 * background; for widths that take each level up to the third. Within a cell of the border,
 * where nothing lies beyond to be interpolated with, errors are told apart. */
static double error_of_cells(double deviation, int *out_level, double *out_border)
{
	enum { WIDE = 190, HIGH = 131, CELLS = WIDE * HIGH };
	static float planes[4][CELLS], rows[CELLS], blurred[CELLS], exact[CELLS];
	struct gz_depth_blur blur;
	struct gz_gaussian gaussian;
	double inside = 0, border = 0;
	for (int i = 0; i < CELLS; i++) {
		const int x = i % WIDE, y = i / WIDE;
		const bool near = hypot(x - 60.3, y - 60.7) < 40 || (x > 150 && x < 157);
		const float ramp = (float)fmin(fmax((x - 30) / 130.0, 0), 1);
		planes[0][i] = near ? 0 : y > 110 ? ramp : 1;
	}
	gz_depth_blur_make(deviation, &blur);
	for (int level = 1; level <= blur.level; level++) {
		const int wide = gz_blur_cells(WIDE, level - 1),
			  high = gz_blur_cells(HIGH, level - 1);
		for (int y = 0; y < gz_blur_cells(HIGH, level); y++) {
			const float *upper = planes[level - 1] + (ptrdiff_t)2 * y * wide;
			gz_depth_halve(upper, 2 * y + 1 < high ? upper + wide : upper, wide,
				       planes[level] + (ptrdiff_t)y * gz_blur_cells(WIDE, level));
		}
	}
	const int wide = gz_blur_cells(WIDE, blur.level), high = gz_blur_cells(HIGH, blur.level);
	const struct gz_plane_band cells = { wide, high, 0, high }, all = { WIDE, HIGH, 0, HIGH };
	gz_blur_along_rows(&blur.gaussian, &cells, planes[blur.level], rows);
	gz_blur_along_columns(&blur.gaussian, &cells, rows, blurred);
	gz_gaussian_make(deviation, &gaussian);
	gz_blur_along_rows(&gaussian, &all, planes[0], rows);
	gz_blur_along_columns(&gaussian, &all, rows, exact);
	for (int y = 0; y < HIGH; y++)
		for (int x = 0; x < WIDE; x += GZ_BLUR_COLUMNS) {
			float pixels[GZ_BLUR_COLUMNS];
			gz_depth_enlarge(blurred, wide, high, blur.level, x, y, pixels);
			for (int k = x; k < x + GZ_BLUR_COLUMNS && k < WIDE; k++) {
				const int least =
					(int)fmin(fmin(k, WIDE - 1 - k), fmin(y, HIGH - 1 - y));
				double *worst = least < 1 << blur.level ? &border : &inside;
				const double right = (double)exact[y * WIDE + k];
				*worst = fmax(*worst, fabs((double)pixels[k - x] - right));
			}
		}
	*out_border = border;
	*out_level = blur.level;
	return inside;
}

static void blur_of_cells_is_that_of_pixels(void **state)
{
	(void)state;
	const double deviations[6] = { 1.3, 4.9, 5.0, 9.9, 10, 21 };
	const int levels[6] = { 0, 0, 1, 1, 2, 3 };
	for (int i = 0; i < 6; i++) {
		int level = -1;
		double border = 1;
		const double error = error_of_cells(deviations[i], &level, &border);
		if (getenv("GZ_TEST_PRINT"))
			print_message("deviation %g: level %d, error %.5f, border %.5f\n",
				      deviations[i], level, error, border);
		assert_int_equal(level, levels[i]);
		assert_true(error <= (level == 0 ? 1e-6 : 0.01));
		assert_true(border <= (level == 0 ? 1e-6 : 0.04));
	}
}

/* ---- tone ---- */

/* Five object pixels of four brightnesses; two pixels of background do not count. */
static void tone_becomes_the_share_of_pixels_no_brighter(void **state)
{
	(void)state;
	static struct gz_tone_histogram histograms[2];
	static struct gz_tone_curve curve;
	float map[7] = { 0.3F, 0.1F, 0.5F, 0.3F, 0.9F, 0.31F, 0 };
	const uint32_t ids[7] = { 1, 2, 0, 1, 7, 1, 0 };
	memset(histograms, 0, sizeof histograms);
	gz_tone_count(map, ids, 3, 1, &histograms[0]);
	gz_tone_count(map + 3, ids + 3, 4, 1, &histograms[1]);
	gz_tone_curve_make(histograms, 2, &curve);
	gz_tone_apply(&curve, ids, 7, map);
	check_map(map, (const double[]) { 0.6, 0.2, 0.5, 0.6, 1, 0.8, 0 }, 7);
}

static void tone_without_objects_stays(void **state)
{
	(void)state;
	static struct gz_tone_histogram empty;
	static struct gz_tone_curve curve;
	float map[3] = { 0, 0.5F, 1 };
	const uint32_t ids[3] = { 1, 1, 1 };
	gz_tone_curve_make(&empty, 1, &curve);
	gz_tone_apply(&curve, ids, 3, map);
	assert_true(map[0] == 0 && fabs((double)map[1] - 0.5) < 1e-3 && map[2] == 1);
	float odd[3] = { -1, 2, NAN };
	gz_tone_count(odd, ids, 3, 1, &empty);
	assert_int_equal(empty.counts[0], 1);
	assert_int_equal(empty.counts[GZ_TONE_BINS - 1], 2);
	gz_tone_count(odd, ids, 3, 2, &empty); /* the first and the third */
	assert_int_equal(empty.counts[0], 2);
	assert_int_equal(empty.counts[GZ_TONE_BINS - 1], 3);
}

/* Two tones that are hardly apart stay so, in whatever share of pixels; a picture with many tones
 * is equalised as it would be. */
static void steadied_tones_rise_evenly(void **state)
{
	(void)state;
	static struct gz_tone_histogram narrow, wide;
	static struct gz_tone_curve curve, exact;
	memset(&narrow, 0, sizeof narrow);
	memset(&wide, 0, sizeof wide);
	narrow.counts[2000] = narrow.counts[2001] = 1000;
	gz_tone_curve_make(&narrow, 1, &curve);
	gz_tone_curve_steady(&curve);
	assert_true(curve.values[0] >= 0 && curve.values[GZ_TONE_BINS - 1] == 1);
	for (int bin = 1; bin < GZ_TONE_BINS; bin++) {
		const double rise = (double)(curve.values[bin] - curve.values[bin - 1]);
		assert_true(rise >= 0 && rise * GZ_TONE_BINS <= GZ_TONE_RISE_MOST + 0.01);
	}
	for (int bin = 400; bin < 3600; bin++)
		wide.counts[bin] = 20 + (uint32_t)(bin % 7);
	gz_tone_curve_make(&wide, 1, &exact);
	curve = exact;
	gz_tone_curve_steady(&curve);
	for (int bin = 0; bin < GZ_TONE_BINS; bin++)
		assert_float_equal(curve.values[bin], exact.values[bin], 0.006);
}

/* ---- lines ---- */

/* Planes that lines are found in. */
struct line_planes {
	const uint32_t *ids;
	const float *depth;
};

static int within(int index, int count)
{
	return index < 0 ? 0 : index < count ? index : count - 1;
}

/* The window of some rows of a picture that is at most as wide as a tile. */
static void fill_window(const struct line_planes *planes, const int size[2], int first, int rows,
			struct gz_line_window *window)
{
	for (int row = 0; row < rows + 2 * GZ_LINE_REACH; row++)
		for (int i = 0; i < GZ_LINE_COLUMNS + 2 * GZ_LINE_REACH; i++) {
			const int y = within(first + row - GZ_LINE_REACH, size[1]);
			const int pixel = y * size[0] + within(i - GZ_LINE_REACH, size[0]);
			window->ids[row][i] = planes->ids[pixel];
			window->depth[row][i] = planes->depth[pixel];
		}
}

/* Draw "# silhouette", "- inner line" and ". none" of a picture of 7 columns, in two tiles. */
static void check_lines(const struct line_planes *planes, int height, enum gz_line_filter filter,
			const char *right)
{
	static float lines[7 * GZ_LINE_COLUMNS];
	static struct gz_line_window window;
	const int size[2] = { 7, height };
	char found[7 * 7 + 1] = { 0 };
	fill_window(planes, size, 0, 2, &window);
	gz_feature_lines(&window, 2, filter, 0.05F, lines);
	fill_window(planes, size, 2, height - 2, &window);
	gz_feature_lines(&window, height - 2, filter, 0.05F, lines + (size_t)2 * GZ_LINE_COLUMNS);
	for (int i = 0; i < 7 * height; i++) {
		const float line = lines[i / 7 * GZ_LINE_COLUMNS + i % 7];
		found[i] = line == GZ_LINE_SILHOUETTE ? '#' : '.';
		found[i] = line == GZ_LINE_INNER ? '-' : found[i];
	}
	assert_string_equal(found, right);
}

/* An object on the background, and each filter. */
static void silhouettes_lie_on_the_nearer_object(void **state)
{
	(void)state;
	uint32_t ids[7 * 7] = { 0 };
	float depth[7 * 7];
	for (int i = 0; i < 49; i++) {
		const int inside = i % 7 >= 1 && i % 7 <= 6 && i / 7 >= 1;
		ids[i] = inside ? 4 : 0;
		depth[i] = inside ? 0.5F : 1;
	}
	const struct line_planes planes = { ids, depth };
	check_lines(&planes, 7, GZ_LINES_4,
		    "......."
		    ".######"
		    ".#....."
		    ".#....."
		    ".#....."
		    ".#....."
		    ".#.....");
	check_lines(&planes, 7, GZ_LINES_8,
		    "......."
		    ".######"
		    ".#....."
		    ".#....."
		    ".#....."
		    ".#....."
		    ".#.....");
	check_lines(&planes, 7, GZ_LINES_12,
		    "......."
		    ".######"
		    ".######"
		    ".##...."
		    ".##...."
		    ".##...."
		    ".##....");
	check_lines(&planes, 7, GZ_LINES_24,
		    "......."
		    ".######"
		    ".######"
		    ".##...."
		    ".##...."
		    ".##...."
		    ".##....");
}

/* Figure 4.4 of the thesis: the object in front has a lower id than one beside it and a higher one
 * than the other. Where as much is nearer as is farther there is no line. At one depth the lower id
 * has it. */
static void order_of_ids_does_not_matter(void **state)
{
	(void)state;
	static const char rows[] = "1122233"
				   "1122233"
				   "6665555"
				   "6665555";
	uint32_t ids[4 * 7];
	float depth[4 * 7];
	for (int i = 0; i < 28; i++) {
		ids[i] = (uint32_t)(rows[i] - '0');
		depth[i] = i >= 14 ? 0.4F : 0.22F;
		depth[i] = ids[i] == 2 ? 0.2F : depth[i];
	}
	const struct line_planes planes = { ids, depth };
	check_lines(&planes, 4, GZ_LINES_4,
		    "..#.#.."
		    "#.###.#"
		    "......."
		    "...#...");
}

/* One object with a step of 0.3 and a slope: the step is an inner line on the nearer side. */
static void steps_within_an_object_are_inner_lines(void **state)
{
	(void)state;
	uint32_t ids[3 * 7];
	float depth[3 * 7];
	for (int i = 0; i < 21; i++) {
		ids[i] = 9;
		depth[i] = 0.02F * (float)(i % 7) + (i % 7 >= 4 ? 0.3F : 0);
	}
	const struct line_planes planes = { ids, depth };
	check_lines(&planes, 3, GZ_LINES_4,
		    "...-..."
		    "...-..."
		    "...-...");
}

/* The kernels that this processor runs, the best first. @return how many */
static size_t list_kernels(const struct gz_plane_kernels *all[3])
{
	size_t count = 0;
	all[count++] = gz_plane_kernels_find();
#ifdef GZ_ILLUSTRATION_X86
	if (__builtin_cpu_supports("avx2"))
		all[count++] = &gz_plane_kernels_avx2;
#endif
	all[count++] = &gz_plane_kernels_portable;
	return count;
}

/* The loops of each instruction set and the portable ones find the same lines: of one object that
 * is even, that bends, and of several. */
static void check_lines_of(const struct gz_plane_kernels *kernels)
{
	static struct gz_line_window windows[3];
	static float found[GZ_LINE_ROWS * GZ_LINE_COLUMNS],
		portable[GZ_LINE_ROWS * GZ_LINE_COLUMNS];
	uint32_t seed = 21;
	for (int kind = 0; kind < 3; kind++)
		for (int row = 0; row < GZ_LINE_ROWS + 2 * GZ_LINE_REACH; row++)
			for (int i = 0; i < GZ_LINE_COLUMNS + 2 * GZ_LINE_REACH; i++) {
				const double random = field_random(&seed);
				windows[kind].depth[row][i] = kind > 0 ? (float)random : 0.5F;
				windows[kind].ids[row][i] =
					kind > 1 ? (uint32_t)(4 * field_random(&seed)) : 7;
			}
	for (int kind = 0; kind < 3; kind++)
		for (enum gz_line_filter k = GZ_LINES_4; k < GZ_LINE_FILTER_COUNT; k++) {
			const bool any =
				kernels->find_lines(&windows[kind], GZ_LINE_ROWS, k, 0.1F, found);
			assert_int_equal(gz_plane_kernels_portable.find_lines(
						 &windows[kind], GZ_LINE_ROWS, k, 0.1F, portable),
					 any);
			assert_memory_equal(found, portable, sizeof found);
			size_t lines = 0;
			for (size_t i = 0; i < sizeof found / sizeof *found; i++)
				lines += found[i] != GZ_LINE_NONE;
			assert_true((kind == 0) == (lines == 0));
			assert_true((kind == 0) == !any);
		}
}

static void check_blur_of(const struct gz_plane_kernels *best)
{
	enum { WIDE = 203, HIGH = 31 };
	static uint32_t ids[HIGH * WIDE];
	static float depth[HIGH * WIDE], found[HIGH * WIDE], portable[HIGH * WIDE];
	const struct gz_plane_band all = { WIDE, HIGH, 0, HIGH };
	const struct gz_plane_kernels *plain = &gz_plane_kernels_portable;
	const struct gz_depth_range range = { 0.25F, 0.75F };
	struct gz_gaussian gaussian;
	uint32_t seed = 22;
	for (size_t i = 0; i < HIGH * WIDE; i++) {
		depth[i] = i % 7 == 0 ? INFINITY : (float)field_random(&seed);
		ids[i] = i % 5 != 0;
	}
	best->share_depth(depth, ids, HIGH * WIDE, &range, found);
	plain->share_depth(depth, ids, HIGH * WIDE, &range, portable);
	assert_memory_equal(found, portable, sizeof found);
	memcpy(depth, found, sizeof depth);
	gz_gaussian_make(3, &gaussian);
	best->blur_rows(&gaussian, &all, depth, found);
	plain->blur_rows(&gaussian, &all, depth, portable);
	assert_memory_equal(found, portable, sizeof found);
	best->blur_columns(&gaussian, &all, depth, found);
	plain->blur_columns(&gaussian, &all, depth, portable);
	assert_memory_equal(found, portable, sizeof found);
	best->halve_rows(depth, depth + WIDE, WIDE, found);
	plain->halve_rows(depth, depth + WIDE, WIDE, portable);
	assert_memory_equal(found, portable, sizeof found);
	for (int level = 0; level <= GZ_BLUR_LEVELS_MAX; level++) {
		best->enlarge_cells(depth, WIDE, HIGH, level, 64, 1, found);
		plain->enlarge_cells(depth, WIDE, HIGH, level, 64, 1, portable);
		assert_memory_equal(found, portable, GZ_BLUR_COLUMNS * sizeof *found);
	}
}

static void instruction_sets_make_the_same_planes(void **state)
{
	(void)state;
	const struct gz_plane_kernels *all[3];
	const size_t count = list_kernels(all);
	for (size_t i = 0; i < count; i++) {
		check_lines_of(all[i]);
		check_blur_of(all[i]);
	}
}

/* Blocks of many columns, and what is left beside them, are weighted means: by the formula. */
static void blur_is_the_weighted_mean_of_wide_planes(void **state)
{
	(void)state;
	enum { WIDE = 150, HIGH = 9 };
	static float plane[HIGH * WIDE], found[HIGH * WIDE];
	const struct gz_plane_band all = { WIDE, HIGH, 0, HIGH };
	struct gz_gaussian gaussian;
	uint32_t seed = 23;
	for (size_t i = 0; i < HIGH * WIDE; i++)
		plane[i] = (float)field_random(&seed);
	gz_gaussian_make(2, &gaussian);
	for (int along_rows = 0; along_rows < 2; along_rows++) {
		if (along_rows)
			gz_blur_along_rows(&gaussian, &all, plane, found);
		else
			gz_blur_along_columns(&gaussian, &all, plane, found);
		for (int y = 0; y < HIGH; y++)
			for (int x = 0; x < WIDE; x++) {
				double sum = 0;
				for (int k = -gaussian.radius; k <= gaussian.radius; k++) {
					const int column = along_rows ? x + k : x;
					const int row = along_rows ? y : y + k;
					const int in_x = column < 0      ? 0
							 : column < WIDE ? column
									 : WIDE - 1;
					const int in_y = row < 0 ? 0 : row < HIGH ? row : HIGH - 1;
					sum += (double)gaussian.weights[abs(k)] *
					       (double)plane[in_y * WIDE + in_x];
				}
				assert_float_equal(found[y * WIDE + x], sum, 1e-6);
			}
	}
}

/* ---- the equations ---- */

static void fading_moves_towards_white(void **state)
{
	(void)state;
	float map[3] = { 0.2F, 0.2F, 0.2F };
	const float values[3] = { 0, 0.5F, 1 };
	gz_shading_fade(map, values, 3, 0.5F);
	check_map(map, (const double[]) { 0.2, 0.4, 0.6 }, 3);
}

static void edge_light_and_shadow_are_both_parts_of_one_mask(void **state)
{
	(void)state;
	const float depth[4] = { 0.2F, 0.2F, 0.8F, 0.8F };
	const float blurred[4] = { 0.2F, 0.4F, 0.6F, 0.8F };
	float light[4] = { 0.5F, 0.5F, 0.5F, 0.5F }, shadow[4] = { 0.5F, 0.5F, 0.5F, 0.5F };
	float bright[4] = { 0.95F, 0.95F, 0.95F, 0.95F };
	gz_shading_add_edge_light(light, blurred, depth, 4, 0.5F);
	check_map(light, (const double[]) { 0.5, 0.6, 0.5, 0.5 }, 4);
	gz_shading_add_edge_light(bright, blurred, depth, 4, 1);
	check_map(bright, (const double[]) { 0.95, 1, 0.95, 0.95 }, 4);
	gz_shading_add_overlap_shadow(shadow, blurred, depth, 4, 0.5F);
	check_map(shadow, (const double[]) { 0.5, 0.5, 0.45, 0.5 }, 4);
}

static void haze_moves_towards_its_background(void **state)
{
	(void)state;
	float map[3] = { 0.2F, 0.2F, 0.2F };
	const float haze[3] = { 0, 0.5F, 1 };
	gz_shading_add_haze(map, haze, 3, 0.5F, 0.6F);
	check_map(map, (const double[]) { 0.2, 0.3, 0.4 }, 3);
}

static void lines_darken_and_never_brighten(void **state)
{
	(void)state;
	const float strong[5] = { GZ_LINE_NONE, GZ_LINE_INNER, GZ_LINE_SILHOUETTE,
				  GZ_LINE_SILHOUETTE, GZ_LINE_INNER };
	const float thin[5] = { GZ_LINE_NONE, GZ_LINE_NONE, GZ_LINE_SILHOUETTE, GZ_LINE_SILHOUETTE,
				GZ_LINE_INNER };
	const float fade[5] = { 0.5F, 0.25F, 0.5F, 0.5F, 0.5F };
	const float tone[5] = { 0.9F, 0.9F, 0.9F, 0.1F, 0.9F };
	struct gz_shading_lines lines = { strong, NULL, NULL, false };
	float map[5];
	memcpy(map, tone, sizeof map);
	gz_shading_draw_lines(map, &lines, 5, 0.8F);
	check_map(map, (const double[]) { 0.9, 0.2, 0.2, 0.1, 0.2 }, 5);
	/* (1 - 1/4) 0.2 + 1/4 1 = 0.4 */
	lines = (struct gz_shading_lines) { strong, thin, fade, false };
	memcpy(map, tone, sizeof map);
	gz_shading_draw_lines(map, &lines, 5, 0.8F);
	check_map(map, (const double[]) { 0.9, 0.4, 0.2, 0.1, 0.2 }, 5);
	/* The last pixel's thin line is an inner one: half of it goes. */
	lines.thin_silhouettes = true;
	memcpy(map, tone, sizeof map);
	gz_shading_draw_lines(map, &lines, 5, 0.8F);
	check_map(map, (const double[]) { 0.9, 0.4, 0.2, 0.1, 0.6 }, 5);
}

/* All steps on three pixels: background, and two objects with weights of their own. */
static void steps_come_in_the_order_of_the_thesis(void **state)
{
	(void)state;
	const uint32_t ids[4] = { 0, 1, 2, 3 };
	const float depth[4] = { 1, 0.2F, 0.6F, 0.6F }, scene[4] = { 1, 0.5F, 0.5F, 0.5F };
	const float edge[4] = { 1, 0.4F, 0.6F, 0.6F }, shadow[4] = { 1, 0.2F, 0.4F, 0.4F };
	const float haze[4] = { 1, 0, 0.5F, 0.5F };
	const float strong[4] = { 0, 0, GZ_LINE_INNER, GZ_LINE_INNER }, thin[4] = { 0 };
	const struct gz_shading_layers layers = { ids,  depth,  scene, edge, shadow,
						  haze, strong, thin,  NULL };
	const struct gz_shading_weights weights[2] = {
		{ .scene = 1, .edge_light = 1 },
		{ .overlap_shadow = 1, .haze = 0.5F, .lines = 0.8F, .background = 1 },
	};
	float map[4] = { 0.3F, 0.4F, 0.5F, 0.5F };
	gz_shading_map_compose(&layers, &(struct gz_plane_band) { 4, 1, 0, 1 }, weights, 2, map);
	/* Object 1: 0.4 -> 0.5 0.4 + 0.5 = 0.7 -> + (0.4 - 0.2) = 0.9. Object 2 and those after it:
	 * 0.5 -> (1 - 0.2) 0.5 = 0.4 -> 0.75 0.4 + 0.25 = 0.55, and a line of which a quarter
	 * fades: 0.75 0.2 + 0.25 = 0.4. */
	check_map(map, (const double[]) { 1, 0.9, 0.4, 0.4 }, 4);
}

/* Steps without planes are left out, over spans longer than those that are composed at once. */
static void absent_planes_leave_their_step_out(void **state)
{
	(void)state;
	enum { WIDE = 700 };
	static uint32_t ids[WIDE];
	static float depth[WIDE], map[WIDE], haze[WIDE];
	for (size_t i = 0; i < WIDE; i++) {
		ids[i] = i < 650;
		map[i] = 0.5F;
		haze[i] = 0.5F;
	}
	struct gz_shading_layers layers = { .ids = ids, .depth = depth };
	const struct gz_shading_weights weights = { 1, 1, 1, 1, 1, 0 };
	const struct gz_plane_band band = { WIDE, 1, 0, 1 };
	gz_shading_map_compose(&layers, &band, &weights, 1, map);
	for (size_t i = 0; i < WIDE; i++)
		assert_true(map[i] == (i < 650 ? 0.5F : 1.0F));
	layers.haze = haze;
	gz_shading_map_compose(&layers, &band, &weights, 1, map);
	for (size_t i = 0; i < WIDE; i++)
		assert_true(map[i] == (i < 650 ? 0.25F : 1.0F));
}

TEST_SUITE(shading_map)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gaussian_adds_up_to_one_and_ends_at_three_deviations),
		cmocka_unit_test(blur_is_a_weighted_mean_along_rows_and_columns),
		cmocka_unit_test(bands_and_blocks_change_nothing),
		cmocka_unit_test(depth_is_a_share_of_the_scene),
		cmocka_unit_test(cells_are_means_and_pixels_lie_between_them),
		cmocka_unit_test(blur_of_cells_is_that_of_pixels),
		cmocka_unit_test(tone_becomes_the_share_of_pixels_no_brighter),
		cmocka_unit_test(tone_without_objects_stays),
		cmocka_unit_test(steadied_tones_rise_evenly),
		cmocka_unit_test(silhouettes_lie_on_the_nearer_object),
		cmocka_unit_test(order_of_ids_does_not_matter),
		cmocka_unit_test(steps_within_an_object_are_inner_lines),
		cmocka_unit_test(instruction_sets_make_the_same_planes),
		cmocka_unit_test(blur_is_the_weighted_mean_of_wide_planes),
		cmocka_unit_test(fading_moves_towards_white),
		cmocka_unit_test(edge_light_and_shadow_are_both_parts_of_one_mask),
		cmocka_unit_test(haze_moves_towards_its_background),
		cmocka_unit_test(lines_darken_and_never_brighten),
		cmocka_unit_test(steps_come_in_the_order_of_the_thesis),
		cmocka_unit_test(absent_planes_leave_their_step_out),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
