/* Float volumes whose values lie far from 1, or close together far from 0: they look as the same
 * values around 1 do. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/captured_log.h"
#include "render/data/float_scaling.h"
#include "render/data/format.h"
#include "render/plan/method.h"
#include "small_scene.h"
#include "volume_files.h"

enum { NX = 40, NY = 33, NZ = 27, VOXELS = NX * NY * NZ };

/* How the values of the waves, -1 to 2, are changed before they are written. */
struct change {
	double factor, offset;
};

static const struct change changes[] = {
	{ 1e-36, 0 },     { 1e-40, 0 },  { 1e-40, 2e-36 },     { 1e38, 0 },
	{ 1.7e38, 0 },    { -1e-38, 0 }, { 1e37, 0 },          { 1e-30, 0 },
	{ 0.25, 100000 }, { 16, -1e6 },  { 1e-2, 2.5 * 1024 }, { 3e-36, 1e-33 },
};
enum { CHANGES = sizeof changes / sizeof changes[0] };

static float changed(double value, const struct change *change)
{
	return (float)(value * change->factor + change->offset);
}

/* The waves' values as a file of floats. */
static const char *write_changed(const struct gz_volume *waves, const struct change *change)
{
	static float values[VOXELS];
	for (size_t i = 0; i < VOXELS; i++)
		values[i] = changed((double)((const float *)waves->voxels)[i], change);
	return files_write("values.raw", values, sizeof values);
}

static struct gz_volume load_floats(const char *path)
{
	const struct gz_raw_layout layout = { .dims = { NX, NY, NZ },
					      .type = GZ_RAW_FLOAT32,
					      .big_endian = gz_host_big_endian(),
					      .spacing = { 1, 1, 1 } };
	struct gz_volume volume;
	assert_int_equal(gz_volume_load(path, &layout, NULL, NULL, &volume), GZ_OK);
	return volume;
}

/* The function over the changed values: turned round by a negative factor. */
static struct gz_transfer changed_transfer(const struct gz_transfer *transfer,
					   const struct change *change)
{
	struct gz_transfer turned = *transfer;
	if (change->factor > 0)
		return turned;
	for (size_t i = 0; i < turned.count; i++) {
		turned.points[i] = transfer->points[transfer->count - 1 - i];
		turned.points[i].value = 1 - turned.points[i].value;
	}
	return turned;
}

/* What the values keep of the waves, as a share of their range. */
static double resolution(const struct change *change)
{
	const double most = fabs(change->offset) + 2 * fabs(change->factor);
	return (most * 0x1p-24 + 0x1p-149) / (3 * fabs(change->factor));
}

static void render_by(const struct small_scene *scene, const char *set, struct gz_image *image)
{
	const struct raycaster_params params = {
		.backend = { .threads = 2, .simd = set, .wait_for_bricks = true },
	};
	struct gz_raycaster *renderer = NULL;
	assert_int_equal(raycaster_with(small_scene_backend(), &params, NULL, &renderer), GZ_OK);
	assert_int_equal(gz_raycaster_set_volume(renderer, &scene->volume), GZ_OK);
	assert_int_equal(gz_raycaster_set_transfer(renderer, &scene->transfer), GZ_OK);
	small_scene_render(renderer, scene, 61, 47, image, NULL);
	gz_raycaster_destroy(&renderer);
}

/* The picture of a change beside that of the waves themselves. */
static void check_picture(const struct small_scene *waves, const struct small_scene *scene,
			  const char *set, int most_off, const char *what)
{
	struct gz_image wanted = { 0 }, got = { 0 };
	render_by(waves, set, &wanted);
	render_by(scene, set, &got);
	int x = 0, y = 0;
	const int worst = image_difference(&wanted, &got, &x, &y);
	if (worst > most_off)
		fail_msg("%s, %s: pixel %d %d is %d levels off", what, set, x, y, worst);
	gz_image_free(&wanted);
	gz_image_free(&got);
}

static void check_change(const struct small_scene *waves, const struct change *change,
			 const char *what)
{
	struct small_scene scene = *waves;
	scene.volume = load_floats(write_changed(&waves->volume, change));
	scene.transfer = changed_transfer(&waves->transfer, change);
	char name[120];
	snprintf(name, sizeof name, "%s, values times %g plus %g", what, change->factor,
		 change->offset);
	/* Values that the file rounds more coarsely than a table's entry look a little different.
	 */
	const int most_off = resolution(change) < 1e-6 ? 1 : resolution(change) < 1e-4 ? 3 : 24;
	for (const char *const *set = small_scene_simd_sets(); *set; set++)
		check_picture(waves, &scene, *set, most_off, name);
	gz_volume_free(&scene.volume);
}

static struct small_scene standard_waves(void)
{
	struct small_scene waves = small_scene_waves(NX, NY, NZ, GZ_VOXEL_F32);
	waves.foveation.method = GZ_METHOD_STANDARD;
	return waves;
}

static void values_of_any_magnitude_look_alike(void **state)
{
	(void)state;
	struct small_scene waves = standard_waves();
	for (size_t i = 0; i < CHANGES; i++)
		check_change(&waves, &changes[i], "sampled");
	small_scene_free(&waves);
}

static void values_of_any_magnitude_look_alike_by_nearest_voxel(void **state)
{
	(void)state;
	struct small_scene waves = standard_waves();
	waves.rays.interpolation = GZ_INTERPOLATION_NEAREST;
	for (size_t i = 0; i < 4; i++)
		check_change(&waves, &changes[i], "nearest");
	small_scene_free(&waves);
}

static void values_of_any_magnitude_look_alike_lit_and_pre_integrated(void **state)
{
	(void)state;
	struct small_scene waves = standard_waves();
	waves.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
	waves.rays.shading = GZ_SHADING_GRADIENT;
	waves.rays.light.occlusion = 0.5;
	for (size_t i = 0; i < CHANGES; i++)
		if (resolution(&changes[i]) < 1e-6)
			check_change(&waves, &changes[i], "lit");
	small_scene_free(&waves);
}

static void bricks_of_values_of_any_magnitude_look_alike(void **state)
{
	(void)state;
	struct small_scene waves = standard_waves();
	for (size_t i = 0; i < 4; i++) {
		const struct change *change = &changes[i];
		/* As another program may write them, not as the loader scales them. */
		struct gz_volume plain = { .dims = { NX, NY, NZ },
					   .spacing = { 1, 1, 1 },
					   .type = GZ_VOXEL_F32 };
		assert_int_equal(gz_volume_allocate(&plain), GZ_OK);
		for (size_t k = 0; k < VOXELS; k++)
			((float *)plain.voxels)[k] =
				changed((double)((const float *)waves.volume.voxels)[k], change);
		gz_volume_find_range(&plain);
		const char *path = files_path("values.gzb");
		assert_int_equal(gz_bricks_write(&plain, path, NULL, NULL), GZ_OK);
		gz_volume_free(&plain);
		struct small_scene scene = waves;
		assert_int_equal(gz_volume_load(path, NULL, NULL, NULL, &scene.volume), GZ_OK);
		const int most_off = resolution(change) < 1e-6 ? 1 : 24;
		for (const char *const *set = small_scene_simd_sets(); *set; set++)
			check_picture(&waves, &scene, *set, most_off, "bricks");
		gz_volume_free(&scene.volume);
	}
	small_scene_free(&waves);
}

static void scaled_volume_has_the_data_values_of_its_file(void **state)
{
	(void)state;
	struct small_scene waves = standard_waves();
	for (size_t i = 0; i < CHANGES; i++) {
		struct gz_volume volume = load_floats(write_changed(&waves.volume, &changes[i]));
		for (size_t k = 0; k < VOXELS; k++) {
			const float wanted = changed(
				(double)((const float *)waves.volume.voxels)[k], &changes[i]);
			const double stored = gz_voxel_stored(volume.type, volume.voxels, k);
			const float got = (float)(volume.slope * stored + volume.intercept);
			if (got != wanted)
				fail_msg("values times %g plus %g: %g, not %g", changes[i].factor,
					 changes[i].offset, (double)got, (double)wanted);
		}
		gz_volume_free(&volume);
	}
	small_scene_free(&waves);
}

static void ordinary_values_stay_as_they_are(void **state)
{
	(void)state;
	static const double ranges[][2] = { { 0, 1 },       { -1000, 3000 }, { 1e-20, 2e-20 },
					    { -1e30, 5 },   { 7, 7 },        { 1e-40, 1e-40 },
					    { 1000, 1001 }, { 0, 1e30 },     { -1e-20, 0 } };
	struct gz_float_scaling scaling = { 0, 0 };
	for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++)
		if (gz_float_scaling_find(ranges[i][0], ranges[i][1], &scaling))
			fail_msg("%g to %g is scaled", ranges[i][0], ranges[i][1]);
	assert_true(scaling.scale == 0);
}

static void range_too_narrow_for_single_precision_is_a_step_with_a_warning(void **state)
{
	(void)state;
	static const double ranges[][2] = { { 0.5, 0.5 + 1e-12 },
					    { 0, 1e-38 },
					    { -1e-300, 1e-300 } };
	struct small_scene scene = standard_waves();
	const struct gz_volume *volume = &scene.volume;
	struct gz_transfer *transfer = &scene.transfer;
	transfer->has_range = true;
	for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++) {
		static struct gz_transfer_table table;
		memcpy(transfer->range, ranges[i], sizeof transfer->range);
		assert_false(gz_transfer_range_divides(transfer, volume));
		gz_transfer_table_bake(transfer, volume, &table);
		assert_true(isfinite((float)table.scale) && isfinite((float)table.bias));
		/* Below the range the first entry, above it the last. */
		const double below = 0.499 * table.scale + table.bias;
		const double above = 0.501 * table.scale + table.bias;
		assert_true(i > 0 || below < 0);
		assert_true(above > GZ_TRANSFER_TABLE_SIZE - 1);
		assert_true(-0.001 * table.scale + table.bias < 0);
	}
	transfer->range[0] = 0.5;
	transfer->range[1] = 0.51;
	assert_true(gz_transfer_range_divides(transfer, volume));
	/* Beyond the data there is nothing to divide. */
	transfer->range[0] = 5;
	transfer->range[1] = 5 + 1e-12;
	assert_true(gz_transfer_range_divides(transfer, volume));
	small_scene_free(&scene);
}

static void doubles_that_single_precision_does_not_tell_apart_are_reported(void **state)
{
	(void)state;
	static double values[VOXELS];
	for (size_t i = 0; i < VOXELS; i++)
		values[i] = 1e-60 * (double)i;
	const char *path = files_write("doubles.raw", values, sizeof values);
	const struct gz_raw_layout layout = { .dims = { NX, NY, NZ },
					      .type = GZ_RAW_FLOAT64,
					      .big_endian = gz_host_big_endian(),
					      .spacing = { 1, 1, 1 } };
	struct captured_log log;
	captured_log_init(&log, NULL);
	struct gz_volume volume;
	assert_int_equal(gz_volume_load(path, &layout, NULL, &log.log, &volume), GZ_OK);
	assert_non_null(strstr(log.last, "all values are 0 in single precision"));
	gz_volume_free(&volume);
}

TEST_SUITE(float_values)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(values_of_any_magnitude_look_alike),
		cmocka_unit_test(values_of_any_magnitude_look_alike_by_nearest_voxel),
		cmocka_unit_test(values_of_any_magnitude_look_alike_lit_and_pre_integrated),
		cmocka_unit_test(bricks_of_values_of_any_magnitude_look_alike),
		cmocka_unit_test(scaled_volume_has_the_data_values_of_its_file),
		cmocka_unit_test(ordinary_values_stay_as_they_are),
		cmocka_unit_test(range_too_narrow_for_single_precision_is_a_step_with_a_warning),
		cmocka_unit_test(doubles_that_single_precision_does_not_tell_apart_are_reported),
	};
	if (!small_scene_backend_runs())
		return 77;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
