/* Whole pictures by every method: equal to `standard` where they must be. What must hold for every
 * method by every step rule is in tests/bench/test_stability.c. */
#include "suite.h"

#include <stddef.h>
#include <stdint.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/plan/method.h"
#include "render/raycast/cpu/cast.h"
#include "render/reconstruct/cpu/reconstruct.h"
#include "small_scene.h"

static const struct gz_point gazes[] = {
	{ 0.5F, 0.5F }, { 0, 0 },      { 1, 1 },           { 0.98F, 0.02F },  { -0.4F, 0.5F },
	{ 0.5F, 3 },    { NAN, 0.5F }, { 0.2F, INFINITY }, { 1e30F, -1e30F },
};

static void check_grey(const struct gz_image *image, uint8_t grey, const char *what, size_t gaze)
{
	for (int i = 0; i < image->width * image->height; i++) {
		const uint8_t *p = image->pixels + 4 * i;
		if (p[0] != grey || p[1] != grey || p[2] != grey || p[3] != 255)
			fail_msg("%s %dx%d gaze %zu: pixel %d %d is %d, not %d", what, image->width,
				 image->height, gaze, i % image->width, i / image->width, p[0],
				 grey);
	}
}

/* Pixels whose centres lie on an ellipse to the last bit, 3/5 and 4/5 of its axes from the middle
 * of an odd picture, in turn at each place of the tiles that the rim crosses. */
static void pixels_on_the_very_rim_of_a_region_are_written(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_constant(8, 0);
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, NULL);
	struct gz_image image = { 0 };
	scene.foveation.method = GZ_METHOD_DDC;
	for (int axis = 0; axis < 2; axis++)
		scene.foveation.ddc_inner_px[axis] = axis ? 40 : 50;
	scene.foveation.ddc_middle_px[0] = scene.foveation.ddc_middle_px[1] = 90;
	for (int round = 0; round < 64; round++) {
		const int width = 61 + 2 * (round % 8), height = 201 + 2 * (round / 8);
		const uint8_t grey = (uint8_t)(round + 1);
		for (int c = 0; c < 3; c++)
			scene.rays.background[c] = grey / 255.0;
		small_scene_render(renderer, &scene, width, height, &image, NULL);
		check_grey(&image, grey, "rim", 0);
	}
	gz_image_free(&image);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

/* Whether a pixel lies where a method must equal `standard`. */
static bool must_be_equal(const struct small_scene *scene, const struct gz_display *display, int x,
			  int y, int width, int height)
{
	const double dx = x + 0.5 - (double)scene->gaze.x * width;
	const double dy = y + 0.5 - (double)scene->gaze.y * height;
	const struct gz_foveation *f = &scene->foveation;
	const struct gz_point at = { (float)((x + 0.5) / width), (float)((y + 0.5) / height) };
	switch ((enum gz_method_index)f->method) {
	case GZ_METHOD_MDC:
	case GZ_METHOD_MDC3:
		return fabs(dx) < f->mdc_square_px / 2 && fabs(dy) < f->mdc_square_px / 2;
	case GZ_METHOD_DDC:
		return hypot(dx / f->ddc_inner_px[0], dy / f->ddc_inner_px[1]) < 1;
	case GZ_METHOD_ACUITY:
		return gz_acuity_spacing_px(f, display, scene->gaze, at, width, height) < M_SQRT2;
	case GZ_METHOD_CONTRAST: /* floats know the angle to a hundredth */
		return gz_display_angle_deg(display, scene->gaze, at) < f->acuity_full_deg - 0.01;
	case GZ_METHOD_TABLE: /* the small scene's table begins with .01 to .05 degrees and step 1
			       */
		return gz_display_angle_deg(display, scene->gaze, at) < 3;
	default:
		return f->method == GZ_METHOD_STANDARD;
	}
}

static void methods_equal_standard_in_their_inner_region(void **state)
{
	(void)state;
	enum { WIDTH = 900, HEIGHT = 700 };
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	struct small_scene scene = small_scene_waves(48, 48, 48, GZ_VOXEL_U8);
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, NULL);
	struct gz_image full = { 0 }, image = { 0 };
	scene.foveation.method = GZ_METHOD_STANDARD;
	small_scene_render(renderer, &scene, WIDTH, HEIGHT, &full, NULL);
	for (int method = GZ_METHOD_MDC; method < GZ_METHOD_COUNT; method++)
		for (int g = 0; g < 4 && gz_methods[method].sharp_at_gaze; g++) {
			int inside = 0, outside_different = 0;
			scene.foveation.method = method;
			scene.gaze = gazes[g];
			small_scene_render(renderer, &scene, WIDTH, HEIGHT, &image, NULL);
			for (int y = 0; y < HEIGHT; y++)
				for (int x = 0; x < WIDTH; x++) {
					const size_t at = 4 * ((size_t)y * WIDTH + (size_t)x);
					const bool same =
						memcmp(full.pixels + at, image.pixels + at, 4) == 0;
					if (!must_be_equal(&scene, &display, x, y, WIDTH, HEIGHT)) {
						outside_different += !same;
						continue;
					}
					inside++;
					if (!same)
						fail_msg("%s gaze %d: pixel %d %d",
							 gz_method_names[method], g, x, y);
				}
			assert_true(inside > 1000);
			assert_true(outside_different > 1000);
		}
	gz_image_free(&full);
	gz_image_free(&image);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

static void foveated_picture_stays_near_the_full_one_everywhere(void **state)
{
	(void)state;
	/* Guards against gross faults: shifted lattices, seams, wrong weights. */
	enum { WIDTH = 1000, HEIGHT = 800 };
	struct small_scene scene = small_scene_waves(32, 32, 32, GZ_VOXEL_U8);
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, NULL);
	struct gz_image full = { 0 }, image = { 0 };
	scene.foveation.method = GZ_METHOD_STANDARD;
	small_scene_render(renderer, &scene, WIDTH, HEIGHT, &full, NULL);
	scene.gaze = (struct gz_point) { 0.3F, 0.6F };
	for (int method = GZ_METHOD_MDC; method < GZ_METHOD_COUNT; method++) {
		scene.foveation.method = method;
		small_scene_render(renderer, &scene, WIDTH, HEIGHT, &image, NULL);
		double squares = 0;
		for (int i = 0; i < WIDTH * HEIGHT * 4; i++)
			squares += pow(image.pixels[i] - full.pixels[i], 2);
		const double psnr = 10 * log10(255.0 * 255 / (squares / (WIDTH * HEIGHT * 3)));
		if (psnr < 32)
			fail_msg("%s: %g dB", gz_method_names[method], psnr);
	}
	gz_image_free(&full);
	gz_image_free(&image);
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

/* Share of a region in a pixel, by the words of plan.h. */
static double share_of(const struct gz_region *region, int x, int y)
{
	if (region->shape == GZ_REGION_ALL)
		return 1;
	const double u = (x - region->centre_px[0]) / region->half_px[0];
	const double v = (y - region->centre_px[1]) / region->half_px[1];
	const double r = region->shape == GZ_REGION_ELLIPSE ? hypot(u, v) : fmax(fabs(u), fabs(v));
	const double px = (1 - r) * fmin(region->half_px[0], region->half_px[1]);
	return fmin(fmax(px / region->blend_px, 0), 1);
}

/* Each lattice over the whole picture by the method uniform, mixed in double precision. */
static void check_bands(struct gz_raycaster *renderer, struct small_scene *scene,
			const struct gz_plan *plan)
{
	struct gz_image image = { 0 }, layers[3] = { 0 };
	int mixed = 0;
	small_scene_render(renderer, scene, plan->width, plan->height, &image, NULL);
	const int method = scene->foveation.method;
	scene->foveation.method = GZ_METHOD_UNIFORM;
	for (int i = 0; i < plan->layer_count; i++) {
		scene->foveation.uniform_spacing = plan->layers[i].spacing;
		small_scene_render(renderer, scene, plan->width, plan->height, &layers[i], NULL);
	}
	for (int i = 0; i < plan->width * plan->height * 4; i++) {
		const int x = i / 4 % plan->width, y = i / 4 / plan->width;
		double expected = 0, left = 1;
		for (int k = 0; k < plan->layer_count; k++) {
			const double share = left * share_of(&plan->layers[k].region, x, y);
			expected += share * layers[k].pixels[i];
			left -= share;
			mixed += share > 0.1 && left > 0.1;
		}
		/* weights of 1/256 and a rounding a band */
		if (fabs(image.pixels[i] - expected) > 2)
			fail_msg("%s: pixel %d %d is %d, not %g", gz_method_names[method], x, y,
				 image.pixels[i], expected);
	}
	assert_true(mixed > 1000);
	scene->foveation.method = method;
	for (int i = 0; i < 3; i++)
		gz_image_free(&layers[i]);
	gz_image_free(&image);
}

static void bands_mix_regions_by_their_weight(void **state)
{
	(void)state;
	enum { WIDTH = 420, HEIGHT = 330 };
	static const int methods[] = { GZ_METHOD_MDC, GZ_METHOD_MDC3, GZ_METHOD_DDC };
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	struct small_scene scene = small_scene_waves(32, 32, 32, GZ_VOXEL_U8);
	struct gz_raycaster *renderer = small_scene_renderer(&scene, 2, NULL);
	struct gz_foveation *f = &scene.foveation;
	scene.gaze = (struct gz_point) { 0.45F, 0.55F };
	f->blend_px = 24;
	f->mdc_square_px = 110;
	f->mdc_spacing = 3;
	f->mdc3_square_px = 230;
	f->mdc3_spacing = 5;
	memcpy(f->ddc_inner_px, (double[2]) { 70, 50 }, sizeof f->ddc_inner_px);
	memcpy(f->ddc_middle_px, (double[2]) { 150, 110 }, sizeof f->ddc_middle_px);
	for (size_t m = 0; m < sizeof methods / sizeof methods[0]; m++) {
		struct gz_plan plan = { 0 };
		f->method = methods[m];
		assert_int_equal(gz_plan_make(f, &display, scene.gaze, WIDTH, HEIGHT, &plan),
				 GZ_OK);
		check_bands(renderer, &scene, &plan);
		gz_plan_free(&plan);
	}
	gz_raycaster_destroy(&renderer);
	small_scene_free(&scene);
}

static void check_spans_of_a_plane(const struct gz_row_filters *filters)
{
	/* Bilinear interpolation reproduces a ramp exactly, up to rounding. */
	for (int spacing = 1; spacing <= GZ_SPACING_MAX; spacing++) {
		enum { COLUMNS = 9, ROWS = 5 };
		uint32_t points[COLUMNS * ROWS + 32] = { 0 };
		uint32_t row[COLUMNS * GZ_SPACING_MAX];
		for (int i = 0; i < COLUMNS * ROWS; i++) {
			const uint32_t grey = (uint32_t)(i % COLUMNS * 20 + i / COLUMNS * 16);
			points[i] = 0xFF000000U | grey << 16 | grey << 8 | grey;
		}
		const struct gz_lattice lattice = {
			.points = points,
			.stride = COLUMNS,
			.spacing = spacing,
			.columns = COLUMNS,
			.rows = ROWS,
		};
		const int width = (COLUMNS - 1) * spacing + 1;
		for (int y = 0; y <= (ROWS - 1) * spacing; y++) {
			/* from two sides, so that spans begin and end within cells */
			const int cut = 1 + y % (width > 2 ? width - 1 : 1);
			filters->span(&lattice, y, 0, cut, row);
			if (cut < width)
				filters->span(&lattice, y, cut, width, row + cut);
			for (int x = 0; x < width; x++) {
				const double exact = (20.0 * x + 16.0 * y) / spacing;
				for (int c = 0; c < 3; c++)
					if (fabs((row[x] >> (8 * c) & 255) - exact) >
					    0.5001 + (1 + spacing) / 256.0)
						fail_msg("%s, spacing %d at %d %d: %u, not %g",
							 filters->name, spacing, x, y,
							 row[x] >> (8 * c) & 255, exact);
				assert_int_equal(row[x] >> 24, 255);
			}
		}
	}
}

static void span_of_a_plane_is_the_plane(void **state)
{
	(void)state;
	static const char *const sets[] = { "portable", "avx2", "avx512" };
	for (size_t i = 0; i < sizeof sets / sizeof sets[0]; i++)
		if (gz_cast_kernels_find(sets[i]))
			check_spans_of_a_plane(gz_row_filters_find(sets[i]));
}

TEST_SUITE(methods)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(pixels_on_the_very_rim_of_a_region_are_written),
		cmocka_unit_test(methods_equal_standard_in_their_inner_region),
		cmocka_unit_test(foveated_picture_stays_near_the_full_one_everywhere),
		cmocka_unit_test(bands_mix_regions_by_their_weight),
		cmocka_unit_test(span_of_a_plane_is_the_plane),
	};
	if (!small_scene_backend_runs())
		return 77;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
