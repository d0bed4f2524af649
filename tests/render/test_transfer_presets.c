/* Presets fit every volume: what they make is a transfer function that a file may hold. */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "render/transfer/transfer_presets.h"

static const int small[3] = { 40, 30, 20 };
static const double cubes[3] = { 1, 1, 1 };

static struct gz_volume shells(enum gz_voxel_type type)
{
	struct gz_volume volume;
	assert_int_equal(gz_volume_generate(&(struct gz_procedural_request) { GZ_PROCEDURAL_SHELLS,
									      small, cubes, type },
					    NULL, NULL, &volume),
			 GZ_OK);
	return volume;
}

static struct gz_transfer made(enum gz_transfer_preset which, const struct gz_volume *volume)
{
	struct gz_histogram histogram;
	struct gz_transfer transfer;
	assert_int_equal(gz_histogram_count(volume, 256, 1, NULL, NULL, &histogram), GZ_OK);
	gz_transfer_preset_make(which, &histogram, volume, &transfer);
	return transfer;
}

static void assert_valid(const struct gz_transfer *transfer)
{
	assert_true(transfer->count >= 1 && transfer->count <= GZ_TRANSFER_POINTS_MAX);
	for (size_t i = 0; i < transfer->count; i++) {
		const struct gz_transfer_point *p = &transfer->points[i];
		const double numbers[5] = { p->value, p->rgb[0], p->rgb[1], p->rgb[2], p->opacity };
		for (int k = 0; k < 5; k++)
			if (!(numbers[k] >= 0 && numbers[k] <= 1))
				fail_msg("point %zu, number %d: %g", i, k, numbers[k]);
		assert_true(i < 1 || p->value >= p[-1].value);
		assert_true(i < 2 || p->value > p[-2].value);
	}
	if (transfer->has_range)
		assert_true(transfer->range[0] < transfer->range[1]);
}

static double greatest_opacity(const struct gz_transfer *transfer)
{
	double greatest = 0;
	for (size_t i = 0; i < transfer->count; i++)
		greatest = fmax(greatest, transfer->points[i].opacity);
	return greatest;
}

static void each_is_valid_for_each_type_and_hides_the_background(void **state)
{
	(void)state;
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++) {
		struct gz_volume volume = shells((enum gz_voxel_type)type);
		for (int i = 0; i < GZ_PRESET_COUNT; i++) {
			const struct gz_transfer transfer =
				made((enum gz_transfer_preset)i, &volume);
			double background[4], top[4];
			assert_valid(&transfer);
			assert_true(greatest_opacity(&transfer) > 0);
			gz_transfer_evaluate(&transfer, 0, background);
			gz_transfer_evaluate(&transfer, 1, top);
			assert_true(i == GZ_PRESET_INVERSE ? top[3] == 0 : background[3] == 0);
		}
		gz_volume_free(&volume);
	}
}

static void volume_of_one_value_gets_valid_ones(void **state)
{
	(void)state;
	struct gz_volume volume = { .dims = { 1, 1, 1 }, .spacing = { 1, 1, 1 } };
	assert_int_equal(gz_volume_allocate(&volume), GZ_OK);
	((uint8_t *)volume.voxels)[0] = 9;
	gz_volume_find_range(&volume);
	for (int i = 0; i < GZ_PRESET_COUNT; i++) {
		const struct gz_transfer transfer = made((enum gz_transfer_preset)i, &volume);
		assert_valid(&transfer);
		assert_false(transfer.has_range);
	}
	gz_volume_free(&volume);
}

static void large_volume_is_as_see_through_as_a_small_one(void **state)
{
	(void)state;
	struct gz_volume volume = shells(GZ_VOXEL_U8);
	struct gz_histogram histogram;
	assert_int_equal(gz_histogram_count(&volume, 256, 1, NULL, NULL, &histogram), GZ_OK);
	struct gz_transfer near, far;
	volume.dims[0] = 1000;
	gz_transfer_preset_make(GZ_PRESET_XRAY, &histogram, &volume, &near);
	volume.dims[0] = 4000;
	gz_transfer_preset_make(GZ_PRESET_XRAY, &histogram, &volume, &far);
	volume.dims[0] = small[0];
	assert_float_equal(gz_transfer_opacity_over(greatest_opacity(&near), 1000),
			   gz_transfer_opacity_over(greatest_opacity(&far), 4000), 1e-9);
	gz_volume_free(&volume);
}

static void far_tail_of_few_voxels_is_left_out_of_the_range(void **state)
{
	(void)state;
	const int dims[3] = { 100, 100, 10 };
	struct gz_volume volume;
	assert_int_equal(
		gz_volume_generate(&(struct gz_procedural_request) { GZ_PROCEDURAL_SHELLS, dims,
								     cubes, GZ_VOXEL_U16 },
				   NULL, NULL, &volume),
		GZ_OK);
	uint16_t *voxels = volume.voxels;
	for (size_t i = 0; i < gz_volume_voxel_count(&volume); i++)
		voxels[i] /= 40;
	gz_volume_find_range(&volume);
	const struct gz_transfer before = made(GZ_PRESET_GREY, &volume);
	voxels[77] = 65000;
	gz_volume_find_range(&volume);
	const struct gz_transfer after = made(GZ_PRESET_GREY, &volume);
	assert_true(after.has_range);
	const double data_max = volume.slope * volume.stored_max + volume.intercept;
	assert_true(after.range[1] < data_max / 2);
	assert_float_equal(after.range[1], before.range[1], before.range[1] * 0.2);
	gz_volume_free(&volume);
}

static void each_has_a_name_a_title_and_a_line(void **state)
{
	(void)state;
	for (int i = 0; i < GZ_PRESET_COUNT; i++) {
		const struct gz_transfer_preset_text *text =
			gz_transfer_preset_text((enum gz_transfer_preset)i);
		assert_non_null(gz_transfer_preset_names[i]);
		assert_true(strlen(text->title) > 0 && strlen(text->about) > 0);
		assert_null(strchr(text->about, '\n'));
	}
	assert_null(gz_transfer_preset_names[GZ_PRESET_COUNT]);
}

TEST_SUITE(transfer_presets)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(each_is_valid_for_each_type_and_hides_the_background),
		cmocka_unit_test(volume_of_one_value_gets_valid_ones),
		cmocka_unit_test(large_volume_is_as_see_through_as_a_small_one),
		cmocka_unit_test(far_tail_of_few_voxels_is_left_out_of_the_range),
		cmocka_unit_test(each_has_a_name_a_title_and_a_line),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
