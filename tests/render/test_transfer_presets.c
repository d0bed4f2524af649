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
			if (i >= GZ_PRESET_CT_TISSUE) /* not for these values */
				continue;
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

/* A body in air: `lung` of its voxels are lung, and the rest is as in a head or a trunk. */
static struct gz_volume body(double offset, double lung)
{
	struct gz_volume volume = { .dims = { 100, 100, 10 },
				    .spacing = { 1, 1, 1 },
				    .type = GZ_VOXEL_U16,
				    .slope = 1,
				    .intercept = offset };
	assert_int_equal(gz_volume_allocate(&volume), GZ_OK);
	volume.slope = 1;
	volume.intercept = offset;
	uint16_t *voxels = volume.voxels;
	for (size_t i = 0; i < gz_volume_voxel_count(&volume); i++) {
		const double share = (double)((i * 7919) % 100000) / 100000;
		const unsigned noise = (unsigned)(i * 31 % 21);
		const double hu = share < 0.4              ? -1000
				  : share < 0.4 + lung     ? -850 + 400 * (share - 0.4) / lung
				  : share < 0.6 + lung / 2 ? -100
				  : share < 0.95           ? 40
							   : 200 + 20000 * (share - 0.95);
		voxels[i] = (uint16_t)(hu + 1024 - 10 + noise);
	}
	gz_volume_find_range(&volume);
	return volume;
}

static bool is_hounsfield(const struct gz_volume *volume)
{
	struct gz_histogram histogram;
	assert_int_equal(gz_histogram_count(volume, 256, 1, NULL, NULL, &histogram), GZ_OK);
	assert_true(gz_transfer_preset_fits(GZ_PRESET_TISSUE, &histogram, GZ_MODALITY_UNKNOWN));
	assert_int_equal(gz_transfer_preset_for(&histogram, GZ_MODALITY_UNKNOWN),
			 gz_transfer_preset_fits(GZ_PRESET_CT_BONE, &histogram, GZ_MODALITY_UNKNOWN)
				 ? GZ_PRESET_CT_TISSUE
				 : GZ_PRESET_TISSUE);
	return gz_histogram_is_hounsfield(&histogram);
}

static void hounsfield_units_are_known_by_air_and_water(void **state)
{
	(void)state;
	struct gz_volume head = body(-1024, 0), trunk = body(-1024, 0.15);
	struct gz_volume counts = body(0, 0), smooth = body(-1024, 0);
	assert_true(is_hounsfield(&head));
	assert_true(is_hounsfield(&trunk));
	assert_false(is_hounsfield(&counts)); /* a scanner's numbers before they are rescaled */
	uint16_t *voxels = smooth.voxels;
	for (size_t i = 0; i < gz_volume_voxel_count(&smooth); i++)
		voxels[i] = (uint16_t)(i * 7919 % 2500);
	gz_volume_find_range(&smooth);
	assert_false(is_hounsfield(&smooth)); /* a field with all values alike */
	struct gz_volume *all[] = { &head, &trunk, &counts, &smooth };
	for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
		gz_volume_free(all[i]);
}

static double opacity_at(const struct gz_transfer *transfer, double value)
{
	double rgba[4];
	gz_transfer_evaluate(
		transfer, (value - transfer->range[0]) / (transfer->range[1] - transfer->range[0]),
		rgba);
	return rgba[3];
}

/* A tenth of the voxels are spread over all values, the others have one value and some noise. */
static enum gz_transfer_preset preset_around(double value, enum gz_modality modality)
{
	struct gz_volume volume = { .dims = { 50, 50, 10 },
				    .spacing = { 1, 1, 1 },
				    .type = GZ_VOXEL_U8 };
	struct gz_histogram histogram;
	assert_int_equal(gz_volume_allocate(&volume), GZ_OK);
	uint8_t *voxels = volume.voxels;
	for (size_t i = 0; i < gz_volume_voxel_count(&volume); i++)
		voxels[i] = i % 10 == 0 ? (uint8_t)(i / 10 % 256)
					: (uint8_t)(value * 248 + (double)(i % 7));
	gz_volume_find_range(&volume);
	assert_int_equal(gz_histogram_count(&volume, 256, 1, NULL, NULL, &histogram), GZ_OK);
	gz_volume_free(&volume);
	return gz_transfer_preset_for(&histogram, modality);
}

static void ground_decides_which_preset_a_volume_gets(void **state)
{
	(void)state;
	static const struct {
		double ground;
		enum gz_transfer_preset preset, of_mr;
	} rows[] = {
		{ 0, GZ_PRESET_TISSUE, GZ_PRESET_MRI },
		{ 0.2, GZ_PRESET_TISSUE, GZ_PRESET_MRI },
		{ 0.5, GZ_PRESET_FIELD, GZ_PRESET_FIELD },
		{ 1, GZ_PRESET_INVERSE, GZ_PRESET_INVERSE },
	};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		const double ground = rows[i].ground;
		assert_int_equal(preset_around(ground, GZ_MODALITY_UNKNOWN), rows[i].preset);
		assert_int_equal(preset_around(ground, GZ_MODALITY_CT), rows[i].preset);
		assert_int_equal(preset_around(ground, GZ_MODALITY_OTHER), rows[i].preset);
		assert_int_equal(preset_around(ground, GZ_MODALITY_MR), rows[i].of_mr);
	}
}

/* A body whose air was cut off is known as CT by its file alone; what looks like Hounsfield units
 * is none if the file says otherwise. */
static void modality_decides_which_presets_fit(void **state)
{
	(void)state;
	struct gz_volume head = body(-1024, 0), cropped = body(-1024, 0), counts = body(0, 0);
	uint16_t *voxels = cropped.voxels;
	for (size_t i = 0; i < gz_volume_voxel_count(&cropped); i++)
		voxels[i] = voxels[i] < 900 ? 900 : voxels[i];
	gz_volume_find_range(&cropped);
	const struct {
		const struct gz_volume *volume;
		enum gz_modality modality;
		bool bone, mri;
		enum gz_transfer_preset preset;
	} rows[] = {
		{ &head, GZ_MODALITY_UNKNOWN, true, false, GZ_PRESET_CT_TISSUE },
		{ &head, GZ_MODALITY_CT, true, false, GZ_PRESET_CT_TISSUE },
		{ &head, GZ_MODALITY_MR, false, true, GZ_PRESET_MRI },
		{ &head, GZ_MODALITY_OTHER, false, false, GZ_PRESET_TISSUE },
		{ &cropped, GZ_MODALITY_UNKNOWN, false, true, GZ_PRESET_TISSUE },
		{ &cropped, GZ_MODALITY_CT, true, false, GZ_PRESET_CT_TISSUE },
		{ &counts, GZ_MODALITY_CT, false, false, GZ_PRESET_TISSUE }, /* not rescaled */
		{ &counts, GZ_MODALITY_MR, false, true, GZ_PRESET_MRI },
	};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		struct gz_histogram histogram;
		assert_int_equal(gz_histogram_count(rows[i].volume, 256, 1, NULL, NULL, &histogram),
				 GZ_OK);
		const enum gz_modality modality = rows[i].modality;
		if (gz_transfer_preset_fits(GZ_PRESET_CT_BONE, &histogram, modality) !=
			    rows[i].bone ||
		    gz_transfer_preset_fits(GZ_PRESET_MRI, &histogram, modality) != rows[i].mri ||
		    !gz_transfer_preset_fits(GZ_PRESET_GREY, &histogram, modality) ||
		    gz_transfer_preset_for(&histogram, modality) != rows[i].preset)
			fail_msg("row %zu: %d", i, gz_transfer_preset_for(&histogram, modality));
	}
	gz_volume_free(&head);
	gz_volume_free(&cropped);
	gz_volume_free(&counts);
}

static void presets_for_ct_show_their_tissue(void **state)
{
	(void)state;
	struct gz_volume volume = body(-1024, 0.15);
	static const struct {
		enum gz_transfer_preset preset;
		double hidden, shown; /* HU */
	} rows[] = {
		{ GZ_PRESET_CT_TISSUE, -600, 45 },  { GZ_PRESET_CT_TISSUE, -1000, 600 },
		{ GZ_PRESET_CT_BONE, 70, 400 },     { GZ_PRESET_CT_VESSELS, 70, 300 },
		{ GZ_PRESET_CT_SKIN, -800, -90 },   { GZ_PRESET_CT_LUNG, 40, -750 },
		{ GZ_PRESET_CT_LUNG, -1000, -600 },
	};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		const struct gz_transfer transfer = made(rows[i].preset, &volume);
		assert_valid(&transfer);
		if (opacity_at(&transfer, rows[i].hidden) != 0 ||
		    opacity_at(&transfer, rows[i].shown) <= 0)
			fail_msg("row %zu: %g at %g, %g at %g", i,
				 opacity_at(&transfer, rows[i].hidden), rows[i].hidden,
				 opacity_at(&transfer, rows[i].shown), rows[i].shown);
	}
	gz_volume_free(&volume);
}

static void each_has_a_name_a_title_and_a_line(void **state)
{
	(void)state;
	for (int i = 0; i < GZ_PRESET_COUNT; i++) {
		const struct gz_transfer_preset_text *text =
			gz_transfer_preset_text((enum gz_transfer_preset)i);
		assert_non_null(gz_transfer_preset_choices[1 + i]);
		assert_true(strlen(text->title) > 0 && strlen(text->about) > 0);
		assert_null(strchr(text->about, '\n'));
	}
	assert_null(gz_transfer_preset_choices[1 + GZ_PRESET_COUNT]);
}

TEST_SUITE(transfer_presets)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(each_is_valid_for_each_type_and_hides_the_background),
		cmocka_unit_test(volume_of_one_value_gets_valid_ones),
		cmocka_unit_test(large_volume_is_as_see_through_as_a_small_one),
		cmocka_unit_test(far_tail_of_few_voxels_is_left_out_of_the_range),
		cmocka_unit_test(hounsfield_units_are_known_by_air_and_water),
		cmocka_unit_test(ground_decides_which_preset_a_volume_gets),
		cmocka_unit_test(modality_decides_which_presets_fit),
		cmocka_unit_test(presets_for_ct_show_their_tissue),
		cmocka_unit_test(each_has_a_name_a_title_and_a_line),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
