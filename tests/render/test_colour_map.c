/* Perceptually uniform maps, and transfer functions that take their colours. */
#include "suite.h"

#include <math.h>

#include "render/transfer/colour_map.h"

/* Lightness L* of sRGB (CIE 15; IEC 61966-2-1), 0 to 100. */
static double lightness_of(const double rgb[3])
{
	static const double weights[3] = { 0.2126, 0.7152, 0.0722 };
	double luminance = 0;
	for (int i = 0; i < 3; i++)
		luminance += weights[i] * (rgb[i] <= 0.04045 ? rgb[i] / 12.92
							     : pow((rgb[i] + 0.055) / 1.055, 2.4));
	return luminance > 0.008856 ? 116 * cbrt(luminance) - 16 : 903.3 * luminance;
}

/* The authors' tables of 256 colours, at entries that are no knots of ours. */
static void maps_are_their_authors(void **state)
{
	(void)state;
	static const struct {
		enum gz_colour_map map;
		int entry;
		int rgb[3];
	} known[] = {
		{ GZ_COLOUR_MAP_VIRIDIS, 0, { 68, 1, 84 } },
		{ GZ_COLOUR_MAP_VIRIDIS, 56, { 62, 73, 137 } },
		{ GZ_COLOUR_MAP_VIRIDIS, 103, { 41, 121, 142 } },
		{ GZ_COLOUR_MAP_VIRIDIS, 167, { 49, 181, 123 } },
		{ GZ_COLOUR_MAP_VIRIDIS, 231, { 192, 223, 37 } },
		{ GZ_COLOUR_MAP_VIRIDIS, 255, { 253, 231, 37 } },
		{ GZ_COLOUR_MAP_MAGMA, 0, { 0, 0, 4 } },
		{ GZ_COLOUR_MAP_MAGMA, 56, { 68, 15, 118 } },
		{ GZ_COLOUR_MAP_MAGMA, 103, { 142, 42, 129 } },
		{ GZ_COLOUR_MAP_MAGMA, 167, { 238, 91, 94 } },
		{ GZ_COLOUR_MAP_MAGMA, 231, { 254, 209, 148 } },
		{ GZ_COLOUR_MAP_MAGMA, 255, { 252, 253, 191 } },
		{ GZ_COLOUR_MAP_INFERNO, 0, { 0, 0, 4 } },
		{ GZ_COLOUR_MAP_INFERNO, 56, { 74, 12, 107 } },
		{ GZ_COLOUR_MAP_INFERNO, 103, { 149, 38, 103 } },
		{ GZ_COLOUR_MAP_INFERNO, 167, { 235, 100, 41 } },
		{ GZ_COLOUR_MAP_INFERNO, 231, { 245, 217, 73 } },
		{ GZ_COLOUR_MAP_INFERNO, 255, { 252, 255, 164 } },
		{ GZ_COLOUR_MAP_PLASMA, 0, { 13, 8, 135 } },
		{ GZ_COLOUR_MAP_PLASMA, 56, { 114, 1, 168 } },
		{ GZ_COLOUR_MAP_PLASMA, 103, { 178, 43, 143 } },
		{ GZ_COLOUR_MAP_PLASMA, 167, { 235, 117, 86 } },
		{ GZ_COLOUR_MAP_PLASMA, 231, { 252, 208, 37 } },
		{ GZ_COLOUR_MAP_PLASMA, 255, { 240, 249, 33 } },
		{ GZ_COLOUR_MAP_CIVIDIS, 0, { 0, 32, 77 } },
		{ GZ_COLOUR_MAP_CIVIDIS, 56, { 56, 72, 107 } },
		{ GZ_COLOUR_MAP_CIVIDIS, 103, { 103, 105, 112 } },
		{ GZ_COLOUR_MAP_CIVIDIS, 167, { 163, 154, 118 } },
		{ GZ_COLOUR_MAP_CIVIDIS, 231, { 233, 211, 88 } },
		{ GZ_COLOUR_MAP_CIVIDIS, 255, { 255, 234, 70 } },
	};
	for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
		double rgb[3];
		gz_colour_map_at(known[i].map, known[i].entry / 255.0, rgb);
		for (int k = 0; k < 3; k++)
			if (!(fabs(255 * rgb[k] - known[i].rgb[k]) <= 7))
				fail_msg("%s, entry %d, part %d: %g, not %d",
					 gz_colour_map_names[known[i].map], known[i].entry, k,
					 255 * rgb[k], known[i].rgb[k]);
	}
}

static void each_map_has_a_name_and_becomes_brighter_all_the_way(void **state)
{
	(void)state;
	for (int map = 0; map < GZ_COLOUR_MAP_COUNT; map++) {
		double before = -1;
		assert_non_null(gz_colour_map_names[map]);
		for (int i = 0; i <= 64; i++) {
			double rgb[3];
			gz_colour_map_at((enum gz_colour_map)map, i / 64.0, rgb);
			const double lightness = lightness_of(rgb);
			if (!(lightness > before && (i == 0 || lightness < before + 4)))
				fail_msg("%s at %d of 64: lightness %g after %g",
					 gz_colour_map_names[map], i, lightness, before);
			before = lightness;
		}
	}
	assert_null(gz_colour_map_names[GZ_COLOUR_MAP_COUNT]);
}

/* A ramp, a jump and a peak, which begin and end inside the range. */
static struct gz_transfer shapes(enum gz_transfer_interpolation interpolation)
{
	static const double points[][2] = { { 0.1, 0 },    { 0.3, 0.2 }, { 0.3, 0.8 }, { 0.5, 0 },
					    { 0.51, 0.9 }, { 0.52, 0 },  { 0.93, 0.4 } };
	struct gz_transfer transfer = { .interpolation = interpolation,
					.has_range = true,
					.range = { -5, 20 } };
	for (size_t i = 0; i < sizeof points / sizeof points[0]; i++)
		transfer.points[transfer.count++] = (struct gz_transfer_point) {
			.value = points[i][0], .opacity = points[i][1], .rgb = { 1, 0, 1 }
		};
	return transfer;
}

static void assert_coloured(enum gz_transfer_interpolation interpolation, double most_off)
{
	const struct gz_transfer before = shapes(interpolation);
	struct gz_transfer after = before;
	gz_transfer_colour(&after, GZ_COLOUR_MAP_VIRIDIS);
	assert_true(after.has_range && after.range[0] == -5 && after.range[1] == 20);
	for (size_t i = 1; i < after.count; i++)
		assert_true(after.points[i].value >= after.points[i - 1].value);
	for (int i = 0; i <= 1000; i++) {
		double was[4], is[4], map[3];
		gz_transfer_evaluate(&before, i / 1000.0, was);
		gz_transfer_evaluate(&after, i / 1000.0, is);
		gz_colour_map_at(GZ_COLOUR_MAP_VIRIDIS, i / 1000.0, map);
		if (!(fabs(is[3] - was[3]) <= most_off))
			fail_msg("at %g: opacity %g, before %g", i / 1000.0, is[3], was[3]);
		for (int k = 0; k < 3; k++)
			assert_float_equal(is[k], map[k], 1e-9);
	}
}

static void function_keeps_its_opacity_and_takes_the_colours(void **state)
{
	(void)state;
	assert_coloured(GZ_TRANSFER_LINEAR, 1e-9);
	assert_coloured(GZ_TRANSFER_QUADRATIC, 0.012 * 0.9);
}

static void function_of_one_or_of_most_points_stays_valid(void **state)
{
	(void)state;
	struct gz_transfer one = { .count = 1, .points = { { .value = 0.5, .opacity = 0.3 } } };
	struct gz_transfer most = { .count = GZ_TRANSFER_POINTS_MAX };
	double rgba[4];
	gz_transfer_colour(&one, GZ_COLOUR_MAP_MAGMA);
	gz_transfer_evaluate(&one, 0.9, rgba);
	assert_true(rgba[3] == 0.3 && rgba[0] > 0.9);
	for (size_t i = 0; i < most.count; i++)
		most.points[i].value = (double)i / GZ_TRANSFER_POINTS_MAX;
	gz_transfer_colour(&most, GZ_COLOUR_MAP_MAGMA);
	assert_true(most.count == GZ_TRANSFER_POINTS_MAX);
}

TEST_SUITE(colour_map)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(maps_are_their_authors),
		cmocka_unit_test(each_map_has_a_name_and_becomes_brighter_all_the_way),
		cmocka_unit_test(function_keeps_its_opacity_and_takes_the_colours),
		cmocka_unit_test(function_of_one_or_of_most_points_stays_valid),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
