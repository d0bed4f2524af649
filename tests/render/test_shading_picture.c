/* Whole pictures of planes: two objects, one behind the other, by any number of threads. */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "render/illustration/plane_kernels.h"
#include "render/illustration/shading_picture.h"
#include "render/illustration/shading_tile.h"
#include "render/illustration/tone_curve.h"

enum { WIDE = 96, HIGH = 70, PIXELS = WIDE * HIGH };

static float tone[PIXELS], depth[PIXELS], far_mm[PIXELS];
static uint32_t ids[PIXELS];
static const float importances[2] = { 1, 0.25F };

/* A near square of tones 0.2 to 0.4 in front of a far one of 0.6; everywhere else nothing. */
static struct gz_shading_frame make_frame(void)
{
	for (int i = 0; i < PIXELS; i++) {
		const int x = i % WIDE, y = i / WIDE;
		const int near = x >= 20 && x < 50 && y >= 20 && y < 50;
		const int far = x >= 40 && x < 80 && y >= 10 && y < 60;
		ids[i] = near ? 1 : far ? 2 : 0;
		depth[i] = near ? 12 : far ? 18 : INFINITY;
		tone[i] = near ? (x < 30 ? 0.2F : 0.4F) : far ? 0.6F : NAN;
		far_mm[i] = near ? 0 : 5;
	}
	return (struct gz_shading_frame) { .width = WIDE,
					   .height = HIGH,
					   .tone = tone,
					   .depth = depth,
					   .ids = ids,
					   .near = 10,
					   .far = 20,
					   .importances = importances,
					   .objects = 2 };
}

/* Settings that do nothing. */
static struct gz_shading_settings plain_settings(void)
{
	struct gz_shading_settings settings = { 0 };
	const struct gz_option_binding binding = { gz_shading_options, gz_shading_option_count,
						   &settings, NULL };
	assert_int_equal(gz_options_preset(&binding), GZ_OK);
	settings.edge_light = settings.overlap_shadow = settings.haze = settings.lines = 0;
	return settings;
}

static float at(const float *map, int x, int y)
{
	return map[y * WIDE + x];
}

/* Draw by some threads and copy the map. */
static void compose(const struct gz_shading_frame *frame,
		    const struct gz_shading_settings *settings, int threads, float *out_map)
{
	struct gz_shading_picture *picture = NULL;
	struct gz_workers *workers = NULL;
	const float *map = NULL;
	static uint32_t pixels[PIXELS], grey[PIXELS];
	assert_int_equal(gz_shading_picture_create(&picture), GZ_OK);
	assert_int_equal(gz_workers_create(threads, &workers), GZ_OK);
	assert_int_equal(
		gz_shading_picture_compose(picture, frame, settings, workers, pixels, &map), GZ_OK);
	memcpy(out_map, map, PIXELS * sizeof *map);
	gz_shading_grey(map, PIXELS, grey);
	assert_memory_equal(pixels, grey, sizeof grey);
	/* The same pixels without the map. */
	memset(pixels, 0, sizeof pixels);
	assert_int_equal(
		gz_shading_picture_compose(picture, frame, settings, workers, pixels, NULL), GZ_OK);
	assert_memory_equal(pixels, grey, sizeof grey);
	gz_workers_destroy(&workers);
	gz_shading_picture_destroy(&picture);
}

/* What equalisation makes of a tone: 300 of 2600 object pixels have 0.2, 600 have 0.4, the others
 * 0.6. */
static double equalised(float tone_of_pixel)
{
	static struct gz_tone_histogram histogram;
	static struct gz_tone_curve curve;
	float tones[26];
	uint32_t objects[26];
	for (int i = 0; i < 26; i++) {
		tones[i] = i < 3 ? 0.2F : i < 9 ? 0.4F : 0.6F;
		objects[i] = 1;
	}
	memset(&histogram, 0, sizeof histogram);
	gz_tone_count(tones, objects, 26, 1, &histogram);
	gz_tone_curve_make(&histogram, 1, &curve);
	gz_tone_curve_steady(&curve);
	gz_tone_apply(&curve, objects, 1, &tone_of_pixel);
	return (double)tone_of_pixel;
}

static void tone_is_equalised_over_objects(void **state)
{
	(void)state;
	static float map[PIXELS];
	const struct gz_shading_frame frame = make_frame();
	const struct gz_shading_settings settings = plain_settings();
	compose(&frame, &settings, 1, map);
	/* 30 x 30 near ones, and 40 x 50 less the 10 x 30 that they hide. */
	assert_float_equal(at(map, 25, 30), equalised(0.2F), 1e-5);
	assert_float_equal(at(map, 45, 30), equalised(0.4F), 1e-5);
	assert_float_equal(at(map, 70, 30), equalised(0.6F), 1e-5);
	assert_float_equal(at(map, 5, 5), 1, 0);
}

static void each_setting_changes_what_it_names(void **state)
{
	(void)state;
	static float map[PIXELS];
	struct gz_shading_frame frame = make_frame();
	struct gz_shading_settings settings = plain_settings();
	const double near = equalised(0.4F);
	settings.importance = 0.5;
	compose(&frame, &settings, 1, map);
	assert_float_equal(at(map, 45, 30), near, 1e-5);
	settings = plain_settings();
	settings.viewer_distance = 1; /* (12 - 10) / (20 - 10) */
	compose(&frame, &settings, 1, map);
	assert_float_equal(at(map, 45, 30), 0.8 * near + 0.2, 1e-5);
	settings.viewer_distance = 0;
	settings.object_distance = 1;
	settings.object_distance_mm = 10;
	compose(&frame, &settings, 1, map); /* none is chosen */
	assert_float_equal(at(map, 45, 30), near, 1e-5);
	frame.object_distance_mm = far_mm;
	for (int i = 0; i < PIXELS; i++)
		far_mm[i] = 4;
	compose(&frame, &settings, 1, map);
	assert_float_equal(at(map, 45, 30), 0.6 * near + 0.4, 1e-5);
	settings = plain_settings();
	settings.haze = 0.5;
	settings.haze_near = 0;
	settings.haze_far = 0.8;
	settings.haze_background = 0;
	compose(&frame, &settings, 1, map); /* depth 0.2 of 0.8 */
	assert_float_equal(at(map, 45, 30), (1 - 0.5 * 0.25) * near, 1e-5);
}

/* Along the border of the near square: light and a line on it, shadow behind it. */
static void borders_have_light_line_and_shadow(void **state)
{
	(void)state;
	static float plain[PIXELS], map[PIXELS];
	const struct gz_shading_frame frame = make_frame();
	struct gz_shading_settings settings = plain_settings();
	compose(&frame, &settings, 1, plain);
	settings.edge_light = settings.overlap_shadow = 1;
	settings.edge_light_width = settings.overlap_shadow_width = 0.02;
	compose(&frame, &settings, 1, map);
	assert_true(at(map, 49, 35) > at(plain, 49, 35) + 0.1F);
	assert_true(at(map, 50, 35) < at(plain, 50, 35) - 0.1F);
	assert_float_equal(at(map, 35, 35), at(plain, 35, 35), 1e-6);
	assert_float_equal(at(map, 65, 35), at(plain, 65, 35), 1e-6);
	settings = plain_settings();
	settings.lines = 0.8;
	settings.line_width = 4;
	compose(&frame, &settings, 1, map);
	assert_float_equal(at(map, 49, 35), 0.2, 1e-6);
	assert_float_equal(at(map, 48, 35), 0.2, 1e-6);
	assert_float_equal(at(map, 47, 35), at(plain, 47, 35), 1e-6);
	assert_float_equal(at(map, 50, 35), at(plain, 50, 35), 1e-6);
	/* The unimportant square keeps a thin silhouette: 0.25 0.2 + 0.75 1 outside it. */
	settings.importance = 1;
	compose(&frame, &settings, 1, map);
	assert_float_equal(at(map, 79, 35), 0.2, 1e-6);
	assert_float_equal(at(map, 78, 35), 0.8, 1e-6);
}

static void threads_and_sizes_before_change_nothing(void **state)
{
	(void)state;
	static float alone[PIXELS], shared[PIXELS];
	const struct gz_shading_frame frame = make_frame();
	struct gz_shading_frame small = frame;
	struct gz_shading_settings settings = plain_settings();
	struct gz_shading_picture *picture = NULL;
	struct gz_workers *workers = NULL;
	const float *map = NULL;
	settings.edge_light = settings.overlap_shadow = settings.haze = settings.lines = 0.5;
	settings.importance = settings.viewer_distance = 0.5;
	compose(&frame, &settings, 1, alone);
	compose(&frame, &settings, 3, shared);
	assert_memory_equal(alone, shared, sizeof alone);
	assert_int_equal(gz_shading_picture_create(&picture), GZ_OK);
	assert_int_equal(gz_workers_create(2, &workers), GZ_OK);
	small.width = 33;
	small.height = 1;
	assert_int_equal(
		gz_shading_picture_compose(picture, &small, &settings, workers, NULL, &map), GZ_OK);
	assert_int_equal(
		gz_shading_picture_compose(picture, &frame, &settings, workers, NULL, &map), GZ_OK);
	assert_memory_equal(alone, map, sizeof alone);
	small.far = small.near;
	assert_int_equal(
		gz_shading_picture_compose(picture, &small, &settings, workers, NULL, &map),
		GZ_ERR_INVAL);
	settings.line_width = 5;
	assert_int_equal(
		gz_shading_picture_compose(picture, &frame, &settings, workers, NULL, &map),
		GZ_ERR_INVAL);
	gz_workers_destroy(&workers);
	gz_shading_picture_destroy(&picture);
}

/* All tiles of a frame by some kernels. */
static void compose_tiles(const struct gz_plane_kernels *kernels,
			  const struct gz_shading_shared *shared)
{
	static struct gz_shading_tile room;
	static uint8_t filled[PIXELS];
	struct gz_shading_shared own = *shared;
	own.tile_columns = gz_shading_tiles(WIDE, GZ_SHADING_TILE_COLUMNS);
	own.filled = filled;
	memset(filled, 0, sizeof filled);
	for (int y = 0; y < HIGH; y++)
		kernels->survey_row(
			shared->frame, y, &shared->range,
			filled + (ptrdiff_t)(y / GZ_SHADING_TILE_ROWS) * own.tile_columns, NULL);
	for (int y = 0; y < HIGH; y += GZ_SHADING_TILE_ROWS)
		for (int x = 0; x < WIDE; x += GZ_SHADING_TILE_COLUMNS)
			kernels->compose_tile(&own, x, y, &room);
}

/* The same bits by each instruction set, and tiles that show nothing are white. */
static void instruction_sets_compose_alike(void **state)
{
	(void)state;
	static struct gz_haze_table haze;
	static struct gz_tone_curve curve;
	static struct gz_tone_histogram histogram;
	static float map[PIXELS], portable[PIXELS], cells[PIXELS];
	static uint32_t pixels[PIXELS], portable_pixels[PIXELS];
	struct gz_shading_frame frame = make_frame();
	struct gz_shading_settings settings = plain_settings();
	settings.importance = settings.viewer_distance = settings.object_distance = 0.3;
	settings.object_distance_mm = 10;
	settings.lines = settings.haze = 0.7;
	frame.object_distance_mm = far_mm;
	gz_tone_count(tone, ids, PIXELS, 1, &histogram);
	gz_tone_curve_make(&histogram, 1, &curve);
	gz_haze_table_make(0.1, 0.9, 0.8, &haze);
	for (int i = 0; i < PIXELS; i++)
		cells[i] = (float)(i % 17) / 17;
	struct gz_shading_shared shared = {
		.frame = &frame,
		.settings = &settings,
		.range = { 10, 20 },
		.edge = { 0, WIDE, HIGH, cells },
		.shadow = { 1, WIDE / 2, HIGH / 2, cells },
		.curve = &curve,
		.haze = &haze,
		.weights = { 1, 0.5F, 0.4F, 0.7F, 0.7F, 0.9F },
		.map = portable,
		.out_pixels = portable_pixels,
	};
	compose_tiles(&gz_plane_kernels_portable, &shared);
	assert_float_equal(at(portable, 90, 68), 1, 0);
	assert_true(at(portable, 49, 35) < 0.6F);
	shared.map = map;
	shared.out_pixels = pixels;
	compose_tiles(gz_plane_kernels_find(), &shared);
	assert_memory_equal(map, portable, sizeof map);
	assert_memory_equal(pixels, portable_pixels, sizeof pixels);
#ifdef GZ_ILLUSTRATION_X86
	memset(map, 0, sizeof map);
	if (!__builtin_cpu_supports("avx2"))
		return;
	compose_tiles(&gz_plane_kernels_avx2, &shared);
	assert_memory_equal(map, portable, sizeof map);
#endif
}

static void grey_is_rounded_and_opaque(void **state)
{
	(void)state;
	const float map[5] = { 0, 0.5F, 1, -1, NAN };
	uint32_t pixels[5];
	gz_shading_grey(map, 5, pixels);
	assert_int_equal(pixels[0], 0xFF000000);
	assert_int_equal(pixels[1], 0xFF808080);
	assert_int_equal(pixels[2], 0xFFFFFFFF);
	assert_int_equal(pixels[3], 0xFF000000);
	assert_int_equal(pixels[4], 0xFF000000);
}

TEST_SUITE(shading_picture)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(tone_is_equalised_over_objects),
		cmocka_unit_test(each_setting_changes_what_it_names),
		cmocka_unit_test(borders_have_light_line_and_shadow),
		cmocka_unit_test(threads_and_sizes_before_change_nothing),
		cmocka_unit_test(instruction_sets_compose_alike),
		cmocka_unit_test(grey_is_rounded_and_opaque),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
