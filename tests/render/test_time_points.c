/* Series of volumes: each time point with the range of all; steps that are loaded ahead; the clock
 * of playing. */
#include "suite.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/captured_log.h"
#include "base/clock.h"
#include "dicom_files.h"
#include "render/data/time_steps.h"
#include "render/data/volume.h"
#include "render/scene/scene.h"
#include "volume_files.h"

enum { X = 5, Y = 4, Z = 3, POINTS = 4, COUNT = X * Y * Z };

/* The number of a voxel at a time point; the least is at the first, the greatest at the last. */
static int16_t number_of(int point, size_t voxel)
{
	return (int16_t)(point * 100 + (int)voxel - 70);
}

static const char *write_nrrd_series(const char *name)
{
	static int16_t numbers[POINTS * COUNT];
	for (size_t i = 0; i < POINTS * COUNT; i++)
		numbers[i] = number_of((int)(i / COUNT), i % COUNT);
	return files_write_text(name,
				"NRRD0005\ntype: short\ndimension: 4\nsizes: 5 4 3 4\n"
				"endian: little\nencoding: raw\nspacings: 1 1 1 0.04\n\n",
				numbers, sizeof numbers);
}

/* As gzip, floats of a magnitude that is stored scaled. */
static const char *write_nifti_series(const char *name)
{
	static uint8_t bytes[352 + POINTS * COUNT * sizeof(float)], packed[2 * sizeof bytes];
	struct nifti_sample sample = nifti_sample_make(X, Y, Z);
	sample.dim[0] = 4;
	sample.dim[4] = POINTS;
	sample.datatype = 16;
	sample.bitpix = 32;
	nifti_sample_bytes(&sample, bytes);
	for (size_t i = 0; i < POINTS * COUNT; i++) {
		const float value = 1e-36F * (float)number_of((int)(i / COUNT), i % COUNT);
		memcpy(bytes + 352 + i * sizeof value, &value, sizeof value);
	}
	const size_t size = files_deflate(bytes, sizeof bytes, 31, packed, sizeof packed);
	return files_write(name, packed, size);
}

static void check_time_point(const char *path, int point, double unit, const double *range)
{
	const struct gz_loading loading = { .time_point = point, .number_range = range };
	struct captured_log log;
	struct gz_volume v;
	captured_log_init(&log, "*:warn");
	if (gz_volume_load(path, NULL, &loading, &log.log, &v) != GZ_OK || log.messages != 0)
		fail_msg("%s: %d messages: %s", path, log.messages, log.last);
	assert_int_equal(v.time_points, POINTS);
	assert_int_equal(v.time_point, point);
	for (size_t i = 0; i < COUNT; i++) {
		const double value = v.slope * gz_voxel_stored(v.type, v.voxels, i) + v.intercept;
		const double wanted = unit * number_of(point, i);
		if (fabs(value - wanted) > 1e-6 * unit * 400)
			fail_msg("%s: point %d voxel %zu: %g, not %g", path, point, i, value,
				 wanted);
	}
	/* One range for all. */
	const double low = v.slope * v.stored_min + v.intercept;
	const double high = v.slope * v.stored_max + v.intercept;
	assert_true(fabs(low - unit * number_of(0, 0)) <= 1e-6 * unit * 400);
	assert_true(fabs(high - unit * number_of(POINTS - 1, COUNT - 1)) <= 1e-6 * unit * 400);
	gz_volume_free(&v);
}

static void check_all_time_points(const char *path, double unit)
{
	struct gz_volume first;
	assert_int_equal(gz_volume_load(path, NULL, NULL, NULL, &first), GZ_OK);
	const double range[2] = { first.number_range[0], first.number_range[1] };
	for (int point = 0; point < POINTS; point++) {
		check_time_point(path, point, unit, NULL);
		check_time_point(path, point, unit, range);
	}
	gz_volume_free(&first);
}

/* The voxels in the header's file, or in a file for each time point. */
static const char *write_metaimage_series(const char *name, const char *data_file)
{
	static int16_t numbers[POINTS * COUNT];
	char head[512], file[32];
	for (size_t i = 0; i < POINTS * COUNT; i++)
		numbers[i] = number_of((int)(i / COUNT), i % COUNT);
	for (int point = 0; point < POINTS; point++) {
		snprintf(file, sizeof file, "point%d.raw", point);
		files_write(file, numbers + (size_t)point * COUNT, COUNT * sizeof numbers[0]);
	}
	snprintf(head, sizeof head,
		 "ObjectType = Image\nNDims = 4\nBinaryData = True\n"
		 "BinaryDataByteOrderMSB = False\nCompressedData = False\n"
		 "TransformMatrix = -1 0 0 0 0 -1 0 0 0 0 1 0 0 0 0 1\n"
		 "ElementSpacing = 1 1 1 0.04\nDimSize = 5 4 3 4\nElementType = MET_SHORT\n"
		 "ElementDataFile = %s\n",
		 data_file);
	const bool local = strcmp(data_file, "LOCAL") == 0;
	return files_write_text(name, head, numbers, local ? sizeof numbers : 0);
}

/* An image for each slice and time point, in RAS+. Instance numbers count through time points. */
static const char *write_dicom_series(void)
{
	const char *path = NULL;
	for (int i = 0; i < POINTS * Z; i++) {
		int16_t pixels[X * Y];
		char name[32], position[32];
		for (size_t k = 0; k < X * Y; k++)
			pixels[k] = number_of(i / Z, (size_t)(i % Z) * X * Y + k);
		struct dicom_sample sample = dicom_sample_make("1.2.3.4.7", i, pixels);
		sample.columns = X;
		sample.rows = Y;
		sample.pixel_bytes = sizeof pixels;
		sample.orientation = "-1\\0\\0\\0\\-1\\0";
		snprintf(position, sizeof position, "0\\0\\%d", i % Z);
		sample.position = position;
		snprintf(name, sizeof name, "time%02d.dcm", i * 7 % (POINTS * Z));
		path = dicom_sample_write(&sample, name);
	}
	return path;
}

/* Big-endian, as MGH has it. */
static const char *write_mgh_series(const char *name)
{
	enum { HEADER = 284 };
	static uint8_t bytes[HEADER + POINTS * COUNT * 2], packed[2 * sizeof bytes];
	static const uint8_t one[4] = { 0x3f, 0x80 };
	memset(bytes, 0, HEADER);
	const int sizes[4] = { X, Y, Z, POINTS };
	bytes[3] = 1;
	for (int i = 0; i < 4; i++)
		bytes[7 + 4 * i] = (uint8_t)sizes[i];
	bytes[23] = 4; /* 16 signed bits */
	bytes[29] = 1;
	for (int i = 0; i < 3; i++) {
		memcpy(bytes + 30 + 4 * i, one, 4);
		memcpy(bytes + 42 + 16 * i, one, 4);
	}
	for (size_t i = 0; i < POINTS * COUNT; i++) {
		const uint16_t bits = (uint16_t)number_of((int)(i / COUNT), i % COUNT);
		bytes[HEADER + 2 * i] = (uint8_t)(bits >> 8);
		bytes[HEADER + 2 * i + 1] = (uint8_t)bits;
	}
	const size_t size = files_deflate(bytes, sizeof bytes, 31, packed, sizeof packed);
	return files_write(name, packed, size);
}

static void time_points_of_nrrd_have_their_voxels_and_one_range(void **state)
{
	(void)state;
	check_all_time_points(write_nrrd_series("series.nrrd"), 1);
}

static void time_points_of_compressed_nifti_floats_are_scaled_alike(void **state)
{
	(void)state;
	check_all_time_points(write_nifti_series("series.nii.gz"), 1e-36);
}

static void time_points_of_metaimage_have_their_voxels_and_one_range(void **state)
{
	(void)state;
	check_all_time_points(write_metaimage_series("series.mha", "LOCAL"), 1);
	check_all_time_points(write_metaimage_series("series.mhd", "point%d.raw 0 3 1"), 1);
}

static void time_points_of_mgz_have_their_voxels_and_one_range(void **state)
{
	(void)state;
	check_all_time_points(write_mgh_series("series.mgz"), 1);
}

static void time_points_of_dicom_have_their_voxels_and_one_range(void **state)
{
	(void)state;
	check_all_time_points(write_dicom_series(), 1);
}

static void check_refused_point(const char *path, int point, const char *words)
{
	const struct gz_loading loading = { .time_point = point };
	struct captured_log log;
	struct gz_volume v;
	captured_log_init(&log, NULL);
	assert_int_equal(gz_volume_load(path, NULL, &loading, &log.log, &v), GZ_ERR_INVAL);
	assert_non_null(strstr(log.last, words));
}

static void time_points_outside_a_series_are_refused(void **state)
{
	(void)state;
	const char *path = write_nrrd_series("refused.nrrd");
	check_refused_point(path, POINTS, "no time point 5: it has 4");
	check_refused_point(path, -1, "no time point 0");
	const uint8_t voxels[8] = { 1, 2, 3 };
	check_refused_point(files_write_text("single.nrrd",
					     "NRRD0005\ntype: uchar\ndimension: 3\n"
					     "sizes: 2 2 2\nencoding: raw\n\n",
					     voxels, sizeof voxels),
			    1, "it has 1");
}

/* The message names the time points that its bytes are of. */
static void time_point_beyond_the_end_is_told_with_its_bytes(void **state)
{
	(void)state;
	const uint8_t voxels[8] = { 1, 2, 3 };
	const struct gz_loading loading = { .time_point = 2 };
	struct captured_log log;
	struct gz_volume v;
	captured_log_init(&log, NULL);
	const char *path = files_write_text("beyond.nrrd",
					    "NRRD0005\ntype: uchar\ndimension: 4\n"
					    "sizes: 2 2 2 3\nencoding: raw\n\n",
					    voxels, sizeof voxels);
	assert_int_equal(gz_volume_load(path, NULL, &loading, &log.log, &v), GZ_ERR_FORMAT);
	assert_non_null(strstr(log.last,
			       "3 time points of 2 x 2 x 2 voxels of uint8 are 24 bytes, the file "
			       "can hold 8; the header claims more than the file holds"));
}

static enum gz_result open_scene(const char *keys, const struct gz_log *log,
				 struct gz_scene *out_scene)
{
	const char *path = files_write_text("time.scene", keys, "", 0);
	return gz_scene_load(path, NULL, log, out_scene);
}

static void scene_shows_the_time_point_that_it_names(void **state)
{
	(void)state;
	struct gz_scene scene;
	struct gz_volume other;
	(void)write_nrrd_series("scene.nrrd");
	assert_int_equal(open_scene("[volume]\nfile = scene.nrrd\ntime_point = 3\n", NULL, &scene),
			 GZ_OK);
	assert_int_equal(scene.volume.time_point, 2);
	const struct gz_scene_time_point which = { .name = files_path("time.scene"),
						   .settings = &scene.settings,
						   .time_point = 1,
						   .number_range = scene.volume.number_range };
	assert_int_equal(gz_scene_load_time_point(&which, NULL, NULL, &other), GZ_OK);
	assert_int_equal(other.time_point, 1);
	assert_true(other.stored_max == scene.volume.stored_max);
	gz_volume_free(&other);
	gz_scene_free(&scene);
}

static void scene_without_a_series_refuses_a_time_point(void **state)
{
	(void)state;
	struct captured_log log;
	struct gz_scene scene;
	captured_log_init(&log, NULL);
	assert_int_equal(
		open_scene("[volume]\nprocedural = shells\ntime_point = 2\n", &log.log, &scene),
		GZ_ERR_INVAL);
	assert_non_null(strstr(log.last, "volume.time_point is 2"));
}

/* A source whose steps are numbers, which can be told to wait or to fail. */
struct numbers {
	atomic_int begun, loaded, released, cancelled, fail_step;
	atomic_bool hold; /* do not finish until it is false or the step is not wanted */
};

static enum gz_result load_number(void *user, int step, const struct gz_loading *loading,
				  void **out_data)
{
	struct numbers *numbers = user;
	atomic_fetch_add(&numbers->begun, 1);
	while (atomic_load(&numbers->hold)) {
		if (!gz_loading_goes_on(loading, 0, "number")) {
			atomic_fetch_add(&numbers->cancelled, 1);
			return GZ_ERR_CANCELLED;
		}
		gz_clock_sleep_until_ns(gz_clock_now_ns() + GZ_NS_PER_MS);
	}
	if (atomic_load(&numbers->fail_step) == step)
		return GZ_ERR_IO;
	int *data = malloc(sizeof *data);
	assert_non_null(data);
	*data = step;
	atomic_fetch_add(&numbers->loaded, 1);
	*out_data = data;
	return GZ_OK;
}

static void release_number(void *user, void *data)
{
	struct numbers *numbers = user;
	atomic_fetch_add(&numbers->released, 1);
	free(data);
}

static void await(const atomic_int *number)
{
	const int64_t end_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (atomic_load(number) == 0 && gz_clock_now_ns() < end_ns)
		gz_clock_sleep_until_ns(gz_clock_now_ns() + GZ_NS_PER_MS);
	assert_true(atomic_load(number) > 0);
}

static struct gz_time_steps *steps_of(struct numbers *numbers, int count)
{
	const struct gz_time_step_source source = {
		.count = count, .user = numbers, .load = load_number, .release = release_number
	};
	struct gz_time_steps *steps = NULL;
	atomic_store(&numbers->fail_step, -1);
	assert_int_equal(gz_time_steps_create(&source, &steps), GZ_OK);
	return steps;
}

static void take_number(struct gz_time_steps *steps, struct numbers *numbers, int step)
{
	void *data = NULL;
	assert_int_equal(gz_time_steps_take(steps, step, true, &data), GZ_OK);
	assert_int_equal(*(int *)data, step);
	release_number(numbers, data);
}

static void steps_come_in_any_order_and_are_released_once(void **state)
{
	(void)state;
	struct numbers numbers = { 0 };
	struct gz_time_steps *steps = steps_of(&numbers, 7);
	static const int order[] = { 3, 4, 4, 0, 6, 5, 6 };
	for (size_t i = 0; i < sizeof order / sizeof order[0]; i++) {
		take_number(steps, &numbers, order[i]);
		gz_time_steps_expect(steps, (order[i] + 1) % 7);
	}
	gz_time_steps_expect(steps, 7);
	gz_time_steps_expect(steps, -1);
	void *data = NULL;
	assert_int_equal(gz_time_steps_take(steps, 7, true, &data), GZ_ERR_INVAL);
	gz_time_steps_destroy(&steps);
	assert_null(steps);
	assert_int_equal(atomic_load(&numbers.loaded), atomic_load(&numbers.released));
	gz_time_steps_destroy(&steps);
}

static void step_loaded_ahead_is_there_at_once(void **state)
{
	(void)state;
	struct numbers numbers = { 0 };
	struct gz_time_steps *steps = steps_of(&numbers, 3);
	gz_time_steps_expect(steps, 1);
	await(&numbers.loaded);
	take_number(steps, &numbers, 1);
	assert_int_equal(atomic_load(&numbers.loaded), 1);
	gz_time_steps_destroy(&steps);
}

static void step_not_wanted_any_more_is_cancelled(void **state)
{
	(void)state;
	struct numbers numbers = { .hold = true };
	struct gz_time_steps *steps = steps_of(&numbers, 3);
	void *data = NULL;
	assert_int_equal(gz_time_steps_take(steps, 1, false, &data), GZ_ERR_TIMEOUT);
	await(&numbers.begun);
	gz_time_steps_expect(steps, 2);
	await(&numbers.cancelled);
	atomic_store(&numbers.hold, false);
	take_number(steps, &numbers, 2);
	gz_time_steps_destroy(&steps);
	assert_int_equal(atomic_load(&numbers.loaded), atomic_load(&numbers.released));
}

static void destroying_while_a_step_is_loaded_cancels_it(void **state)
{
	(void)state;
	struct numbers numbers = { .hold = true };
	struct gz_time_steps *steps = steps_of(&numbers, 3);
	gz_time_steps_expect(steps, 1);
	gz_time_steps_destroy(&steps);
	assert_int_equal(atomic_load(&numbers.loaded), 0);
}

static void step_that_fails_is_told_once_and_can_be_tried_again(void **state)
{
	(void)state;
	struct numbers numbers = { 0 };
	struct gz_time_steps *steps = steps_of(&numbers, 3);
	void *data = NULL;
	atomic_store(&numbers.fail_step, 2);
	assert_int_equal(gz_time_steps_take(steps, 2, true, &data), GZ_ERR_IO);
	atomic_store(&numbers.fail_step, -1);
	take_number(steps, &numbers, 2);
	gz_time_steps_destroy(&steps);
}

static void steps_without_a_step_are_refused(void **state)
{
	(void)state;
	const struct gz_time_step_source none = { .count = 0 };
	struct gz_time_steps *steps = NULL;
	assert_int_equal(gz_time_steps_create(&none, &steps), GZ_ERR_INVAL);
	assert_null(steps);
}

static void clock_of_playing_keeps_its_rate_and_waits_for_late_steps(void **state)
{
	(void)state;
	struct gz_playback playback = { 0 };
	assert_false(gz_playback_due(&playback, INT64_MAX));
	gz_playback_shown(&playback, 5);
	assert_false(playback.playing);
	gz_playback_start(&playback, 10, 1000);
	assert_false(gz_playback_due(&playback, 1000 + 99 * GZ_NS_PER_MS));
	assert_true(gz_playback_due(&playback, 1000 + 100 * GZ_NS_PER_MS));
	/* A little late: the one after it is in time. */
	gz_playback_shown(&playback, 1000 + 130 * GZ_NS_PER_MS);
	assert_true(playback.due_ns == 1000 + 200 * GZ_NS_PER_MS);
	/* Very late: those after it are a period apart. */
	gz_playback_shown(&playback, 1000 + 900 * GZ_NS_PER_MS);
	assert_true(playback.due_ns == 1000 + 1000 * GZ_NS_PER_MS);
}

static void pictures_at_regular_times_show_steps_in_turn(void **state)
{
	(void)state;
	static const int wanted[] = { 2, 2, 3, 3, 0, 0, 1, 1, 2 };
	for (int frame = 0; frame < 9; frame++)
		assert_int_equal(gz_playback_step_of_frame(2, 4, 30, frame / 60.0), wanted[frame]);
	for (int frame = 0; frame < 1000; frame++)
		assert_int_equal(gz_playback_step_of_frame(0, 7, 10, frame / 10.0), frame % 7);
}

TEST_SUITE(time_points)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(time_points_of_nrrd_have_their_voxels_and_one_range),
		cmocka_unit_test(time_points_of_compressed_nifti_floats_are_scaled_alike),
		cmocka_unit_test(time_points_of_metaimage_have_their_voxels_and_one_range),
		cmocka_unit_test(time_points_of_mgz_have_their_voxels_and_one_range),
		cmocka_unit_test(time_points_of_dicom_have_their_voxels_and_one_range),
		cmocka_unit_test(time_points_outside_a_series_are_refused),
		cmocka_unit_test(time_point_beyond_the_end_is_told_with_its_bytes),
		cmocka_unit_test(scene_shows_the_time_point_that_it_names),
		cmocka_unit_test(scene_without_a_series_refuses_a_time_point),
		cmocka_unit_test(steps_come_in_any_order_and_are_released_once),
		cmocka_unit_test(step_loaded_ahead_is_there_at_once),
		cmocka_unit_test(step_not_wanted_any_more_is_cancelled),
		cmocka_unit_test(destroying_while_a_step_is_loaded_cancels_it),
		cmocka_unit_test(step_that_fails_is_told_once_and_can_be_tried_again),
		cmocka_unit_test(steps_without_a_step_are_refused),
		cmocka_unit_test(clock_of_playing_keeps_its_rate_and_waits_for_late_steps),
		cmocka_unit_test(pictures_at_regular_times_show_steps_in_turn),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
