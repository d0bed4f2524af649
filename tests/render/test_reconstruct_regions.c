/* Pictures of regions against the formulas of docs/foveation.md, pixel by pixel in double
 * precision, and all instruction sets against each other. */
#include "suite.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "render/picture/image.h"
#include "render/plan/method.h"
#include "render/raycast/cpu/cast.h"
#include "render/reconstruct/cpu/reconstruct.h"

static const char *const sets[] = { "portable", "avx2", "avx512" };

enum { SETS = sizeof sets / sizeof sets[0] };

/* A plan and what its rays saw. */
struct scene {
	struct gz_plan plan;
	struct gz_lattices lattices;
	struct gz_image image;
};

static uint32_t random_point(uint32_t *state)
{
	*state = *state * 1664525 + 1013904223;
	return *state ^ *state >> 15;
}

/* Colours at random in one half of each lattice, in the other a background with a few spots. */
static void cast_colours(struct scene *scene, uint32_t seed)
{
	for (int layer = 0; layer < scene->plan.layer_count; layer++) {
		const struct gz_lattice *lattice = &scene->lattices.layers[layer];
		for (int i = 0; i < lattice->columns * lattice->rows; i++) {
			const uint32_t colour = random_point(&seed);
			const bool background = i % lattice->columns > lattice->columns / 2 &&
						(colour >> 8) % 200 > 0;
			lattice->points[i] = background ? 0xFF302010 : colour;
		}
	}
}

static void make_scene(const struct gz_foveation *foveation, struct gz_point gaze, int width,
		       int height, uint32_t seed, struct scene *scene)
{
	const struct gz_display display = gz_display_default(width, height);
	memset(scene, 0, sizeof *scene);
	assert_int_equal(gz_plan_make(foveation, &display, gaze, width, height, &scene->plan),
			 GZ_OK);
	assert_int_equal(scene->plan.reconstruction, GZ_RECONSTRUCT_REGIONS);
	assert_int_equal(gz_image_resize(&scene->image, width, height), GZ_OK);
	assert_int_equal(
		gz_lattices_prepare(&scene->lattices, &scene->plan, gz_image_words(&scene->image)),
		GZ_OK);
	cast_colours(scene, seed);
}

static void free_scene(struct scene *scene)
{
	gz_plan_free(&scene->plan);
	gz_lattices_free(&scene->lattices);
	gz_image_free(&scene->image);
}

/* A channel between the four points around a pixel. */
static double bilinear(const struct gz_lattice *lattice, const uint32_t *points, int x, int y,
		       int c)
{
	const int s = lattice->spacing;
	double sum = 0;
	for (int corner = 0; corner < 4; corner++) {
		const int right = corner % 2, below = corner / 2;
		const double u = right ? x % s : s - x % s, v = below ? y % s : s - y % s;
		if (u * v == 0)
			continue;
		const int column = x / s + right, row = y / s + below;
		sum += u * v / (s * s) * (points[row * lattice->columns + column] >> (8 * c) & 255);
	}
	return sum;
}

/* A channel of a pixel from a layer on: its own share, and the rest from those behind. */
static double channel_of(const struct scene *scene, const uint32_t *cast, int layer, int x, int y,
			 int c)
{
	const struct gz_lattice *lattice = &scene->lattices.layers[layer];
	const double share = gz_region_weight(&scene->plan.layers[layer].region, x, y);
	const bool in_picture = lattice->points == (uint32_t *)(void *)scene->image.pixels;
	double value = 0;
	if (share > 0)
		value += share * bilinear(lattice, in_picture ? cast : lattice->points, x, y, c);
	if (share < 1)
		value += (1 - share) * channel_of(scene, cast, layer + 1, x, y, c);
	return value;
}

/* Rounded at each layer, and shares to 1/256. */
static void check_picture(const struct scene *scene, const uint32_t *cast)
{
	const struct gz_plan *plan = &scene->plan;
	for (int i = 0; i < plan->width * plan->height; i++) {
		const int x = i % plan->width, y = i / plan->width;
		for (int c = 0; c < 4; c++) {
			const double exact = channel_of(scene, cast, 0, x, y, c);
			const int is = scene->image.pixels[4 * i + c];
			if (fabs(is - exact) > 2)
				fail_msg("method %d, %dx%d, pixel %d %d, channel %d: %d, not %g",
					 plan->made_for.foveation.method, plan->width, plan->height,
					 x, y, c, is, exact);
		}
	}
}

static void check_scene(struct scene *scene, struct gz_workers *workers, bool by_formula)
{
	const size_t bytes = (size_t)scene->plan.width * (size_t)scene->plan.height * 4;
	uint32_t *cast = malloc(bytes), *first = malloc(bytes);
	assert_non_null(cast);
	assert_non_null(first);
	memcpy(cast, scene->image.pixels, bytes);
	for (int set = 0; set < SETS; set++) {
		if (!gz_cast_kernels_find(sets[set]))
			continue;
		memcpy(scene->image.pixels, cast, bytes);
		gz_reconstruct(&scene->plan, &scene->lattices, gz_row_filters_find(sets[set]),
			       workers, gz_image_words(&scene->image));
		if (set == 0) {
			memcpy(first, scene->image.pixels, bytes);
			if (by_formula)
				check_picture(scene, cast);
		} else if (memcmp(first, scene->image.pixels, bytes) != 0) {
			fail_msg("%s and %s differ, method %d, %dx%d", sets[0], sets[set],
				 scene->plan.made_for.foveation.method, scene->plan.width,
				 scene->plan.height);
		}
	}
	free(cast);
	free(first);
}

/* Regions as small as the pictures. */
static struct gz_foveation small_regions(int method, int variant)
{
	static const int ddc_spacings[][3] = {
		{ 1, 2, 7 }, { 2, 1, 5 }, { 1, 1, 16 }, { 3, 4, 9 }
	};
	static const double bands_px[] = { 0, 3.5, 24, 200 };
	struct gz_foveation f = gz_foveation_default();
	f.method = method;
	f.mdc_square_px = 60;
	f.mdc3_square_px = 110;
	f.mdc_spacing = 2 + variant % 2;
	f.mdc3_spacing = 4 + variant;
	memcpy(f.ddc_inner_px, (const double[]) { 41, 30 }, sizeof f.ddc_inner_px);
	memcpy(f.ddc_middle_px, (const double[]) { 90, 70.5 }, sizeof f.ddc_middle_px);
	memcpy(f.ddc_spacing, ddc_spacings[variant], sizeof f.ddc_spacing);
	f.uniform_spacing = 2 + 3 * variant;
	f.blend_px = bands_px[(variant + method) % 4];
	return f;
}

static void regions_of_any_size_and_gaze_follow_their_formulas(void **state)
{
	(void)state;
	static const int sizes[][2] = { { 1, 1 },  { 1, 190 },  { 210, 1 },
					{ 2, 60 }, { 131, 75 }, { 257, 190 } };
	static const struct gz_point gazes[] = { { 0.5F, 0.5F }, { 0, 0.1F }, { 1.3F, 0.4F } };
	static const int methods[] = { GZ_METHOD_MDC, GZ_METHOD_MDC3, GZ_METHOD_DDC,
				       GZ_METHOD_UNIFORM };
	struct gz_workers *workers;
	assert_int_equal(gz_workers_create(3, &workers), GZ_OK);
	for (size_t m = 0; m < 4; m++)
		for (int variant = 0; variant < 4; variant++)
			for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++)
				for (size_t g = 0; g < 3; g++) {
					const struct gz_foveation f =
						small_regions(methods[m], variant);
					struct scene scene;
					make_scene(&f, gazes[g], sizes[s][0], sizes[s][1],
						   (uint32_t)(s + g), &scene);
					check_scene(&scene, workers, true);
					free_scene(&scene);
				}
	gz_workers_destroy(&workers);
}

/* Wider than a piece of a row, and more than 4 MiB, which is written past the caches. */
static void large_pictures_of_regions_are_the_same_by_all_instruction_sets(void **state)
{
	(void)state;
	static const int sizes[][2] = { { 2111, 500 }, { 1088, 1000 } };
	struct gz_workers *workers;
	assert_int_equal(gz_workers_create(2, &workers), GZ_OK);
	for (int i = 0; i < 4; i++) {
		struct gz_foveation f = gz_foveation_default();
		f.method = i / 2 ? GZ_METHOD_MDC3 : GZ_METHOD_DDC;
		f.blend_px = i % 2 ? 32 : 0;
		struct scene scene;
		make_scene(&f, (struct gz_point) { 0.6F, 0.3F }, sizes[i % 2][0], sizes[i % 2][1],
			   (uint32_t)i, &scene);
		check_scene(&scene, workers, i == 1);
		free_scene(&scene);
	}
	gz_workers_destroy(&workers);
}

static void shares_of_a_band_are_the_plan_s(void **state)
{
	(void)state;
	const struct gz_region regions[] = {
		{ GZ_REGION_ELLIPSE, { 101.3, 60.8 }, { 90.7, 50.2 }, 12.5 },
		{ GZ_REGION_RECTANGLE, { 101.3, 60.8 }, { 90.7, 50.2 }, 50.2 },
		{ GZ_REGION_ELLIPSE, { 8000.25, 4000.5 }, { 7000, 3900 }, 0.01 },
	};
	for (int set = 0; set < SETS; set++) {
		if (!gz_cast_kernels_find(sets[set]))
			continue;
		for (size_t r = 0; r < sizeof regions / sizeof regions[0]; r++)
			for (int y = 0; y < 120; y++) {
				enum { COUNT = 203 };
				uint32_t shares[COUNT];
				gz_row_filters_find(sets[set])->weights(&regions[r], y, 3, COUNT,
									shares);
				for (int i = 0; i < COUNT; i++) {
					const double exact =
						gz_region_weight(&regions[r], 3 + i, y);
					if (fabs(shares[i] - 256 * exact) > 0.501 ||
					    (exact >= 1 && shares[i] != 256))
						fail_msg("%s: region %zu at %d %d: %u, not %g",
							 sets[set], r, 3 + i, y, shares[i],
							 256 * exact);
				}
			}
	}
}

TEST_SUITE(reconstruct_regions)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(regions_of_any_size_and_gaze_follow_their_formulas),
		cmocka_unit_test(large_pictures_of_regions_are_the_same_by_all_instruction_sets),
		cmocka_unit_test(shares_of_a_band_are_the_plan_s),
	};
	return cmocka_run_group_tests_name("reconstruct_regions", tests, NULL, NULL);
}
