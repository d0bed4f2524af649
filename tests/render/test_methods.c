/* Whole pictures by every method: complete, equal to `standard` where they must be. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/cpu/reconstruct.h"
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

static void every_pixel_of_every_method_is_written_for_any_gaze(void **state)
{
	(void)state;
	/* Nothing in the box: all is background, which changes from frame to frame, so that a
	 * pixel, or a lattice point, of an earlier frame shows. */
	static const int sizes[][2] = { { 1, 1 },    { 7, 3 },    { 97, 61 },  { 64, 64 },
					{ 2, 1031 }, { 1031, 2 }, { 640, 480 } };
	struct small_scene scene = small_scene_constant(8, 0);
	struct gz_renderer *renderer = small_scene_renderer(&scene, 2, NULL);
	struct gz_image image = { 0 };
	int round = 0;
	for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++)
		for (int method = 0; method < GZ_METHOD_COUNT; method++)
			for (size_t g = 0; g < sizeof gazes / sizeof gazes[0]; g++, round++) {
				const int width = sizes[s][0], height = sizes[s][1];
				const uint8_t grey = (uint8_t)(round % 255 + 1);
				for (int c = 0; c < 3; c++)
					scene.rays.background[c] = grey / 255.0;
				scene.foveation.method = method;
				scene.gaze = gazes[g];
				small_scene_render(renderer, &scene, width, height, &image, NULL);
				check_grey(&image, grey, gz_method_names[method], g);
			}
	gz_image_free(&image);
	gz_renderer_destroy(&renderer);
	small_scene_free(&scene);
}

/* Pixels whose centres lie on an ellipse to the last bit, 3/5 and 4/5 of its axes from the middle
 * of an odd picture, in turn at each place of the tiles that the rim crosses. */
static void pixels_on_the_very_rim_of_a_region_are_written(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_constant(8, 0);
	struct gz_renderer *renderer = small_scene_renderer(&scene, 2, NULL);
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
	gz_renderer_destroy(&renderer);
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
	switch ((enum gz_method)f->method) {
	case GZ_METHOD_MDC:
	case GZ_METHOD_MDC3:
		return fabs(dx) < f->mdc_square_px / 2 && fabs(dy) < f->mdc_square_px / 2;
	case GZ_METHOD_DDC:
		return hypot(dx / f->ddc_inner_px[0], dy / f->ddc_inner_px[1]) < 1;
	case GZ_METHOD_ACUITY:
		return gz_acuity_spacing_px(f, display, scene->gaze, at, width, height) < 2;
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
	struct gz_renderer *renderer = small_scene_renderer(&scene, 2, NULL);
	struct gz_image full = { 0 }, image = { 0 };
	scene.foveation.method = GZ_METHOD_STANDARD;
	small_scene_render(renderer, &scene, WIDTH, HEIGHT, &full, NULL);
	for (int method = GZ_METHOD_MDC; method < GZ_METHOD_COUNT; method++)
		for (int g = 0; g < 4 && method != GZ_METHOD_UNIFORM; g++) {
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
	gz_renderer_destroy(&renderer);
	small_scene_free(&scene);
}

static void constant_box_keeps_its_brightness_by_every_method_and_step_rule(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_constant(64, 0.02);
	/* The box fills the view, so that no outline is interpolated. */
	memcpy(scene.camera.eye, (double[3]) { 0.1, -0.1, 0.05 }, sizeof scene.camera.eye);
	memcpy(scene.camera.look_at, (double[3]) { -0.2, 0.3, -0.1 }, sizeof scene.camera.look_at);
	struct gz_renderer *renderer = small_scene_renderer(&scene, 2, NULL);
	struct gz_image reference = { 0 };
	scene.rays.ray_sampling_rate = 8;
	scene.foveation.method = GZ_METHOD_STANDARD;
	small_scene_render(renderer, &scene, 400, 300, &reference, NULL);
	scene.rays.ray_sampling_rate = 1.5;
	scene.gaze = (struct gz_point) { 0.1F, 0.2F };
	for (int method = 0; method < GZ_METHOD_COUNT; method++)
		for (int rule = 0; gz_step_rule_names[rule]; rule++) {
			struct gz_image image = { 0 };
			int x = 0, y = 0;
			scene.foveation.method = method;
			scene.foveation.step_rule = rule;
			small_scene_render(renderer, &scene, 400, 300, &image, NULL);
			/* the depth of the box has edges: interpolating across them is not the
			 * step's doing, so the mean is held tight and the worst pixel loosely */
			double sum = 0;
			for (int i = 0; i < 400 * 300 * 4; i++)
				sum += image.pixels[i] - reference.pixels[i];
			const int worst = image_difference(&reference, &image, &x, &y);
			if (fabs(sum / (400 * 300 * 3)) > 0.5 || worst > 3)
				fail_msg("%s, steps by %s: mean %g, worst %d at %d %d",
					 gz_method_names[method], gz_step_rule_names[rule],
					 sum / (400 * 300 * 3), worst, x, y);
			gz_image_free(&image);
		}
	gz_image_free(&reference);
	gz_renderer_destroy(&renderer);
	small_scene_free(&scene);
}

static void foveated_picture_stays_near_the_full_one_everywhere(void **state)
{
	(void)state;
	/* Guards against gross faults: shifted lattices, seams, wrong weights. */
	enum { WIDTH = 1000, HEIGHT = 800 };
	struct small_scene scene = small_scene_waves(32, 32, 32, GZ_VOXEL_U8);
	struct gz_renderer *renderer = small_scene_renderer(&scene, 2, NULL);
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
	gz_renderer_destroy(&renderer);
	small_scene_free(&scene);
}

static void span_of_a_plane_is_the_plane(void **state)
{
	(void)state;
	/* Bilinear interpolation reproduces a ramp exactly, up to rounding. */
	for (int spacing = 1; spacing <= GZ_SPACING_MAX; spacing++) {
		enum { COLUMNS = 9, ROWS = 5 };
		uint32_t points[COLUMNS * ROWS], row[COLUMNS * GZ_SPACING_MAX];
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
			gz_reconstruct_span(&lattice, y, 0, cut, row);
			if (cut < width)
				gz_reconstruct_span(&lattice, y, cut, width, row + cut);
			for (int x = 0; x < width; x++) {
				const double exact = (20.0 * x + 16.0 * y) / spacing;
				for (int c = 0; c < 3; c++)
					if (fabs((row[x] >> (8 * c) & 255) - exact) >
					    0.5001 + (1 + spacing) / 256.0)
						fail_msg("spacing %d at %d %d: %u, not %g", spacing,
							 x, y, row[x] >> (8 * c) & 255, exact);
				assert_int_equal(row[x] >> 24, 255);
			}
		}
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_pixel_of_every_method_is_written_for_any_gaze),
		cmocka_unit_test(pixels_on_the_very_rim_of_a_region_are_written),
		cmocka_unit_test(methods_equal_standard_in_their_inner_region),
		cmocka_unit_test(constant_box_keeps_its_brightness_by_every_method_and_step_rule),
		cmocka_unit_test(foveated_picture_stays_near_the_full_one_everywhere),
		cmocka_unit_test(span_of_a_plane_is_the_plane),
	};
	if (!small_scene_backend_runs())
		return 77;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
