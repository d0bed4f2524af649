/* A volume at half its resolution: means where they belong. */
#include "suite.h"

#include <stddef.h>
#include <stdint.h>

#include <float.h>
#include <math.h>
#include <string.h>

#include "render/data/levels.h"
#include "small_scene.h"

static double voxel(const struct gz_volume *volume, int x, int y, int z)
{
	const size_t index =
		((size_t)z * (size_t)volume->dims[1] + (size_t)y) * (size_t)volume->dims[0] +
		(size_t)x;
	return gz_voxel_stored(volume->type, volume->voxels, index);
}

/* Mean of the voxels of the full volume that a voxel of the half stands for. */
static double mean_of_block(const struct gz_volume *full, const struct gz_volume *half,
			    const int at[3])
{
	int from[3], to[3];
	for (int axis = 0; axis < 3; axis++) {
		const int factor = half->dims[axis] == full->dims[axis] ? 1 : 2;
		from[axis] = at[axis] * factor;
		to[axis] = from[axis] + factor < full->dims[axis] ? from[axis] + factor
								  : full->dims[axis];
	}
	double sum = 0;
	int count = 0;
	for (int z = from[2]; z < to[2]; z++)
		for (int y = from[1]; y < to[1]; y++)
			for (int x = from[0]; x < to[0]; x++, count++)
				sum += voxel(full, x, y, z);
	return sum / count;
}

static void check_half(const int dims[3], const double spacing[3], enum gz_voxel_type type)
{
	struct small_scene scene = small_scene_waves(dims[0], dims[1], dims[2], type);
	memcpy(scene.volume.spacing, spacing, sizeof scene.volume.spacing);
	scene.volume.slope = 2;
	scene.volume.intercept = -7;
	struct gz_volume half = { 0 };
	assert_int_equal(gz_volume_halve(&scene.volume, NULL, &half), GZ_OK);
	assert_true(half.slope == 2 && half.intercept == -7);
	assert_true(half.stored_min == scene.volume.stored_min);
	assert_true(half.stored_max == scene.volume.stored_max);
	const double rounding = type == GZ_VOXEL_F32 ? 1e-6 : 0.5;
	for (int z = 0; z < half.dims[2]; z++)
		for (int y = 0; y < half.dims[1]; y++)
			for (int x = 0; x < half.dims[0]; x++) {
				const int at[3] = { x, y, z };
				const double expected = mean_of_block(&scene.volume, &half, at);
				const double got = voxel(&half, x, y, z);
				if (!(fabs(got - expected) <= rounding))
					fail_msg("%dx%dx%d, voxel %d %d %d: %g, not %g", dims[0],
						 dims[1], dims[2], x, y, z, got, expected);
			}
	gz_volume_free(&half);
	small_scene_free(&scene);
}

static void half_is_the_mean_of_blocks_for_every_type_and_odd_sizes(void **state)
{
	(void)state;
	static const int dims[][3] = { { 16, 8, 4 }, { 17, 9, 5 },  { 1, 20, 7 },
				       { 33, 1, 1 }, { 40, 31, 1 }, { 2, 2, 2 } };
	static const double spacings[][3] = { { 1, 1, 1 }, { 1, 1, 3 }, { 0.5, 0.7, 0.6 } };
	for (size_t d = 0; d < sizeof dims / sizeof dims[0]; d++)
		for (size_t s = 0; s < sizeof spacings / sizeof spacings[0]; s++)
			for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++)
				check_half(dims[d], spacings[s], (enum gz_voxel_type)type);
}

static void axes_are_halved_so_that_voxels_tend_to_cubes(void **state)
{
	(void)state;
	static const struct {
		int dims[3];
		double spacing[3];
		bool axes[3];
	} cases[] = {
		{ { 64, 64, 64 }, { 1, 1, 1 }, { true, true, true } },
		{ { 64, 64, 64 }, { 1, 1, 3 }, { true, true, false } },
		{ { 64, 64, 64 }, { 1, 1.4, 1.42 }, { true, true, false } },
		{ { 64, 1, 64 }, { 2, 0.1, 2 }, { true, false, true } },
		{ { 1, 1, 1 }, { 1, 1, 1 }, { false, false, false } },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		bool axes[3];
		gz_halve_axes(cases[i].dims, cases[i].spacing, axes);
		for (int axis = 0; axis < 3; axis++)
			if (axes[axis] != cases[i].axes[axis])
				fail_msg("case %zu, axis %d: %d", i, axis, axes[axis]);
	}
}

static void half_of_a_ramp_has_its_data_where_the_header_says(void **state)
{
	(void)state;
	/* value = 10 * voxel coordinate of the datum: the half's datum i sits at 2i + 1 */
	struct gz_volume ramp = { .dims = { 12, 1, 1 }, .spacing = { 1, 1, 1 } };
	ramp.type = GZ_VOXEL_U16;
	assert_int_equal(gz_volume_allocate(&ramp), GZ_OK);
	for (int i = 0; i < 12; i++)
		((uint16_t *)ramp.voxels)[i] = (uint16_t)(10 * i + 5);
	struct gz_volume half = { 0 };
	assert_int_equal(gz_volume_halve(&ramp, NULL, &half), GZ_OK);
	assert_int_equal(half.dims[0], 6);
	assert_true(half.spacing[0] == 2 && half.spacing[1] == 1);
	for (int i = 0; i < 6; i++)
		assert_int_equal(((uint16_t *)half.voxels)[i], 10 * (2 * i + 1));
	gz_volume_free(&half);
	gz_volume_free(&ramp);
}

static void half_of_the_greatest_floats_is_finite(void **state)
{
	(void)state;
	struct gz_volume volume = { .dims = { 4, 4, 4 }, .spacing = { 1, 1, 1 } };
	volume.type = GZ_VOXEL_F32;
	assert_int_equal(gz_volume_allocate(&volume), GZ_OK);
	for (int i = 0; i < 64; i++)
		((float *)volume.voxels)[i] = -FLT_MAX;
	struct gz_volume half = { 0 };
	assert_int_equal(gz_volume_halve(&volume, NULL, &half), GZ_OK);
	for (int i = 0; i < 8; i++)
		assert_true(((float *)half.voxels)[i] == -FLT_MAX);
	gz_volume_free(&half);
	gz_volume_free(&volume);
}

static void single_voxel_and_no_axis_are_refused(void **state)
{
	(void)state;
	struct small_scene scene = small_scene_waves(1, 1, 1, GZ_VOXEL_U8);
	struct gz_volume half = { 0 };
	assert_int_equal(gz_volume_halve(&scene.volume, NULL, &half), GZ_ERR_INVAL);
	small_scene_free(&scene);
	scene = small_scene_waves(8, 8, 8, GZ_VOXEL_U8);
	const bool none[3] = { false, false, false };
	assert_int_equal(gz_volume_halve(&scene.volume, none, &half), GZ_ERR_INVAL);
	assert_null(half.voxels);
	small_scene_free(&scene);
}

TEST_SUITE(halve)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(half_is_the_mean_of_blocks_for_every_type_and_odd_sizes),
		cmocka_unit_test(axes_are_halved_so_that_voxels_tend_to_cubes),
		cmocka_unit_test(half_of_a_ramp_has_its_data_where_the_header_says),
		cmocka_unit_test(half_of_the_greatest_floats_is_finite),
		cmocka_unit_test(single_voxel_and_no_axis_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
