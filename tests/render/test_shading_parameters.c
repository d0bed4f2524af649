/* Shading parameters of single points, each by numbers worked out by hand. */
#include "suite.h"

#include <math.h>

#include "render/illustration/shading_parameters.h"

/* Four normals: up, to the right, down, and between up and the viewer. */
enum { POINTS = 4 };
static const float normal_x[POINTS] = { 0, 1, 0, 0 };
static const float normal_y[POINTS] = { 1, 0, -1, 0.6F };
static const float normal_z[POINTS] = { 0, 0, 0, 0.8F };
static const struct gz_shading_vectors normals = { normal_x, normal_y, normal_z };

static void check_values(const float *found, const double *right, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		if (fabs((double)found[i] - right[i]) > 1e-5)
			print_message("point %zu: %.6f instead of %.6f\n", i, (double)found[i],
				      right[i]);
		assert_true(fabs((double)found[i] - right[i]) <= 1e-5);
	}
}

static void main_light_goes_on_behind_the_edge(void **state)
{
	(void)state;
	const float light[3] = { 0, 0.8F, 0.6F };
	float found[POINTS];
	gz_shading_main_light(&normals, POINTS, light, found);
	check_values(found, (const double[]) { 0.9, 0.5, 0.1, 0.98 }, POINTS);
}

static void plateau_light_ends_at_the_edge(void **state)
{
	(void)state;
	const float x[POINTS] = { 0, 0, 0, 0 }, y[POINTS] = { 0.6F, 0, 0.6F, 0 };
	const float z[POINTS] = { 0.8F, 1, 0.8F, 1 };
	const struct gz_shading_vectors viewer = { x, y, z };
	float found[POINTS];
	gz_shading_plateau_light(&normals, &viewer, POINTS, found);
	check_values(found, (const double[]) { 0.6, 0, 0, 0.8 }, POINTS);
}

/* Light from the right along a floor that faces up. A slope of 0.6 that faces the light has l'.n =
 * 0.6, one that faces away -0.6, the floor 0. */
static void grazing_light_shows_slopes_whatever_the_main_direction(void **state)
{
	(void)state;
	const float x[3] = { 0.6F, -0.6F, 0 }, y[3] = { 0.8F, 0.8F, 1 }, z[3] = { 0, 0, 0 };
	const float flat_x[3] = { 0, 0, 0 }, flat_y[3] = { 1, 1, 1 };
	const struct gz_shading_vectors levels[2] = { { x, y, z }, { flat_x, flat_y, z } };
	struct gz_grazing_light grazing = {
		.light = { 1, 0, 0 }, .exaggeration = 1, .levels = 2, .weights = { 1 }
	};
	float found[3];
	gz_shading_grazing_light(levels, 3, &grazing, found);
	check_values(found, (const double[]) { 0.8, 0.2, 0.5 }, 3);
	/* Light from obliquely above is projected into the floor and normalised: the same. */
	grazing.light[0] = 0.6F;
	grazing.light[1] = 0.8F;
	gz_shading_grazing_light(levels, 3, &grazing, found);
	check_values(found, (const double[]) { 0.8, 0.2, 0.5 }, 3);
	/* 1.5 times 0.6 is 0.9; 2 times 0.6 is cut off at 1. */
	grazing.exaggeration = 1.5F;
	gz_shading_grazing_light(levels, 3, &grazing, found);
	check_values(found, (const double[]) { 0.95, 0.05, 0.5 }, 3);
	grazing.exaggeration = 2;
	gz_shading_grazing_light(levels, 3, &grazing, found);
	check_values(found, (const double[]) { 1, 0, 0.5 }, 3);
	/* Light along the smooth normal has no direction in its plane. */
	grazing.light[0] = 0;
	grazing.light[1] = 1;
	gz_shading_grazing_light(levels, 3, &grazing, found);
	check_values(found, (const double[]) { 0.5, 0.5, 0.5 }, 3);
}

/* Three levels: the weights choose between the step from 0 to 1 and that from 1 to 2. */
static void weights_choose_the_level_of_detail(void **state)
{
	(void)state;
	const float x[1] = { 0.6F }, y[1] = { 0.8F }, z[1] = { 0 };
	const float flat_x[1] = { 0 }, flat_y[1] = { 1 };
	const struct gz_shading_vectors levels[3] = { { x, y, z },
						      { flat_x, flat_y, z },
						      { flat_x, flat_y, z } };
	struct gz_grazing_light grazing = {
		.light = { 1, 0, 0 }, .exaggeration = 1, .levels = 3, .weights = { 0.25F, 0.75F }
	};
	float found[1];
	gz_shading_grazing_light(levels, 1, &grazing, found);
	check_values(found, (const double[]) { 0.25 * 0.8 + 0.75 * 0.5 }, 1);
}

static void weights_by_frequency_add_up_to_one(void **state)
{
	(void)state;
	float weights[4];
	gz_grazing_weights(4, 0.5, weights);
	check_values(weights, (const double[]) { 1 / 3.0, 1 / 3.0, 1 / 3.0 }, 3);
	gz_grazing_weights(4, 1, weights);
	check_values(weights, (const double[]) { 16 / 21.0, 4 / 21.0, 1 / 21.0 }, 3);
	gz_grazing_weights(4, 0, weights);
	check_values(weights, (const double[]) { 1 / 21.0, 4 / 21.0, 16 / 21.0 }, 3);
	gz_grazing_weights(2, 0.9, weights);
	check_values(weights, (const double[]) { 1 }, 1);
}

/* Plane, ball, hollow ball, ridge, saddle; k0 = 0.1. */
static const float bend_greatest[5] = { 0, 0.1F, -0.1F, 0.3F, 0.2F };
static const float bend_least[5] = { 0, 0.1F, -0.1F, 0, -0.2F };

static void shape_is_bright_where_convex(void **state)
{
	(void)state;
	float found[5];
	gz_shading_surface_shape(bend_greatest, bend_least, 5, 0.1F, found);
	check_values(found,
		     (const double[]) { 0.5, 0.5 + 0.5 * 2 / 3, 0.5 - 0.5 * 2 / 3,
					0.5 + 0.5 * 3 / 4, 0.5 },
		     5);
}

static void curvature_is_dark_where_strong(void **state)
{
	(void)state;
	float found[5];
	gz_shading_curvature_magnitude(bend_greatest, bend_least, 5, 0.1F, found);
	check_values(found, (const double[]) { 1, 0.5, 0.5, 0.1 / (0.1 + 0.3 / sqrt(2)), 1 / 3.0 },
		     5);
}

static void mean_is_weighted(void **state)
{
	(void)state;
	const float a[2] = { 0.2F, 1 }, b[2] = { 0.8F, 0 }, c[2] = { NAN, NAN };
	const struct gz_weighted_parameter both[3] = { { a, 3 }, { b, 1 }, { c, 0 } };
	float found[2];
	gz_shading_mean(both, 3, 2, found);
	check_values(found, (const double[]) { 0.35, 0.75 }, 2);
	gz_shading_mean(&both[2], 1, 2, found);
	check_values(found, (const double[]) { 1, 1 }, 2);
}

static void scene_information_is_what_fades(void **state)
{
	(void)state;
	const uint32_t ids[4] = { 0, 1, 2, 3 };
	const float importances[2] = { 1, 0.25F }, depth[4] = { 10, 15, INFINITY, NAN };
	const float far[4] = { 0, 20, 90, INFINITY };
	float found[4];
	gz_shading_unimportance(ids, 4, importances, 2, found);
	check_values(found, (const double[]) { 1, 0, 0.75, 1 }, 4);
	gz_shading_viewer_distance(depth, 4, 10, 30, found);
	check_values(found, (const double[]) { 0, 0.25, 1, 1 }, 4);
	gz_shading_object_distance(far, 4, 80, found);
	check_values(found, (const double[]) { 0, 0.25, 1, 1 }, 4);
}

static void haze_follows_its_formula(void **state)
{
	(void)state;
	static struct gz_haze_table table;
	const float depth[6] = { 0, 0.2F, 0.35F, 0.5F, 0.9F, 1 };
	float found[6];
	gz_haze_table_make(0.2, 0.8, 2, &table);
	gz_shading_haze(depth, 6, &table, found);
	check_values(found, (const double[]) { 0, 0, 0.0625, 0.25, 1, 1 }, 6);
	gz_haze_table_make(0.2, 0.8, 0.5, &table);
	gz_shading_haze(depth, 6, &table, found);
	assert_true(fabs((double)found[2] - 0.5) < 1e-4 && found[0] == 0 && found[5] == 1);
	/* Where it ends before it begins there is a step. */
	gz_haze_table_make(0.5, 0.3, 1, &table);
	gz_shading_haze(depth, 6, &table, found);
	check_values(found, (const double[]) { 0, 0, 0, 0, 1, 1 }, 6);
}

TEST_SUITE(shading_parameters)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(main_light_goes_on_behind_the_edge),
		cmocka_unit_test(plateau_light_ends_at_the_edge),
		cmocka_unit_test(grazing_light_shows_slopes_whatever_the_main_direction),
		cmocka_unit_test(weights_choose_the_level_of_detail),
		cmocka_unit_test(weights_by_frequency_add_up_to_one),
		cmocka_unit_test(shape_is_bright_where_convex),
		cmocka_unit_test(curvature_is_dark_where_strong),
		cmocka_unit_test(mean_is_weighted),
		cmocka_unit_test(scene_information_is_what_fades),
		cmocka_unit_test(haze_follows_its_formula),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
