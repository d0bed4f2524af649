/* DICOM series: order, orientation, scales and bits of the numbers, and what is refused. */
#include "suite.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "dicom_files.h"
#include "render/data/volume.h"
#include "volume_files.h"

#define SERIES "1.2.3.4.5"

/* Each test has the folder for itself. */
static int empty_folder(void **state)
{
	(void)state;
	DIR *listing = opendir(files_folder());
	for (struct dirent *entry; listing && (entry = readdir(listing));)
		if (entry->d_name[0] != '.')
			unlink(files_path(entry->d_name));
	if (listing)
		closedir(listing);
	return 0;
}

static double value_at(const struct gz_volume *volume, int x, int y, int z)
{
	const size_t i =
		((size_t)z * (size_t)volume->dims[1] + (size_t)y) * (size_t)volume->dims[0] +
		(size_t)x;
	const double stored = gz_voxel_stored(volume->type, volume->voxels, i);
	return volume->slope * stored + volume->intercept;
}

static struct gz_volume load(const char *path)
{
	struct gz_volume volume = { 0 };
	struct captured_log log;
	captured_log_init(&log, NULL);
	const enum gz_result result = gz_volume_load(path, NULL, NULL, &log.log, &volume);
	if (result != GZ_OK)
		fail_msg("%s: result %d: %s", path, result, log.last);
	return volume;
}

static void check_refused(const char *path, enum gz_result result, const char *words)
{
	struct captured_log log;
	struct gz_volume volume = { .slope = 42 };
	captured_log_init(&log, "*:error");
	const enum gz_result got = gz_volume_load(path, NULL, NULL, &log.log, &volume);
	if (got != result || log.messages != 1 || !strstr(log.last, words))
		fail_msg("%s: result %d instead of %d, %d lines, \"%s\" lacks \"%s\"", path, got,
			 result, log.messages, log.last, words);
	assert_true(volume.slope == 42);
	assert_null(volume.voxels);
}

/* Slice k of a series whose numbers are 100 k + 10 row + column - 50. */
static struct dicom_sample slice_of(const char *series, int k, int16_t pixels[6], char position[64])
{
	for (int i = 0; i < 6; i++)
		pixels[i] = (int16_t)(100 * k + 10 * (i / 3) + i % 3 - 50);
	snprintf(position, 64, "-10\\-20\\%g", 2.5 * k);
	struct dicom_sample sample = dicom_sample_make(series, 9 - k, pixels);
	sample.position = position;
	sample.spacing = "0.75\\0.5";
	return sample;
}

static void write_series(const char *series, const char *prefix, int slices)
{
	static const int shuffled[] = { 2, 0, 3, 1 };
	for (int i = 0; i < slices; i++) {
		int16_t pixels[6];
		char position[64], name[64];
		struct dicom_sample sample = slice_of(series, shuffled[i], pixels, position);
		snprintf(name, sizeof name, "%s%d", prefix, i);
		dicom_sample_write(&sample, name);
	}
}

static void check_series(const struct gz_volume *volume)
{
	assert_int_equal(volume->dims[0], 3);
	assert_int_equal(volume->dims[1], 2);
	assert_int_equal(volume->dims[2], 4);
	assert_true(fabs(volume->spacing[0] - 0.5) < 1e-9);
	assert_true(fabs(volume->spacing[1] - 0.75) < 1e-9);
	assert_true(fabs(volume->spacing[2] - 2.5) < 1e-9);
	assert_true(volume->oriented);
	/* Columns go to the patient's left, rows to the back; ours go right and to the front. */
	for (int z = 0; z < 4; z++)
		for (int y = 0; y < 2; y++)
			for (int x = 0; x < 3; x++) {
				const double expected = 100 * z + 10 * (1 - y) + (2 - x) - 50;
				if (value_at(volume, x, y, z) != expected)
					fail_msg("(%d, %d, %d): %g, not %g", x, y, z,
						 value_at(volume, x, y, z), expected);
			}
}

static void folder_of_one_series_is_ordered_by_place_and_turned(void **state)
{
	(void)state;
	write_series(SERIES, "IM", 4);
	files_write("notes.txt", "no DICOM", 8);
	struct gz_volume volume = load(files_folder());
	check_series(&volume);
	gz_volume_free(&volume);
}

static void file_stands_for_its_series_among_others(void **state)
{
	(void)state;
	write_series(SERIES, "a", 4);
	write_series("1.2.3.4.6", "b.", 2);
	struct gz_volume volume = load(files_path("a2"));
	check_series(&volume);
	gz_volume_free(&volume);
	check_refused(files_folder(), GZ_ERR_FORMAT, "holds 2 series; name one file");
}

static void rescale_is_kept_as_slope_and_intercept(void **state)
{
	(void)state;
	const int16_t pixels[6] = { 0, 1, 2, 3, -4, 1000 };
	struct dicom_sample sample = dicom_sample_make(SERIES, 1, pixels);
	sample.slope = "2";
	sample.intercept = "-1024";
	struct gz_volume volume = load(dicom_sample_write(&sample, "one.dcm"));
	assert_int_equal(volume.type, GZ_VOXEL_U16);
	assert_true(value_at(&volume, 2, 1, 0) == -1024);
	assert_true(value_at(&volume, 0, 0, 0) == 2 * 1000 - 1024);
	assert_true(value_at(&volume, 1, 0, 0) == 2 * -4 - 1024);
	gz_volume_free(&volume);
}

static void slices_with_scales_of_their_own_become_float(void **state)
{
	(void)state;
	const int16_t pixels[6] = { 10, 10, 10, 10, 10, 10 };
	const char *const slopes[2] = { "0.5", "3" };
	for (int k = 0; k < 2; k++) {
		struct dicom_sample sample = dicom_sample_make(SERIES, k, pixels);
		sample.position = k ? "0\\0\\1" : "0\\0\\0";
		sample.slope = slopes[k];
		sample.intercept = "1";
		dicom_sample_write(&sample, k ? "b" : "a");
	}
	struct gz_volume volume = load(files_folder());
	assert_int_equal(volume.type, GZ_VOXEL_F32);
	assert_true(value_at(&volume, 0, 0, 0) == 6);
	assert_true(value_at(&volume, 0, 0, 1) == 31);
	gz_volume_free(&volume);
}

static void twelve_bits_are_taken_from_among_others(void **state)
{
	(void)state;
	/* Sign in bit 11, an overlay of old in bit 15. */
	const uint16_t pixels[6] = { 0x8001, 0x0FFF, 0x8800, 0x07FF, 0, 1 };
	struct dicom_sample sample = dicom_sample_make(SERIES, 1, (const int16_t *)pixels);
	sample.bits_stored = 12;
	sample.high_bit = 11;
	struct gz_volume volume = load(dicom_sample_write(&sample, "one.dcm"));
	assert_true(value_at(&volume, 2, 1, 0) == 1);
	assert_true(value_at(&volume, 1, 1, 0) == -1);
	assert_true(value_at(&volume, 0, 1, 0) == -2048);
	assert_true(value_at(&volume, 2, 0, 0) == 2047);
	gz_volume_free(&volume);
}

static void frames_of_one_file_are_slices(void **state)
{
	(void)state;
	const uint8_t pixels[12] = { 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12 };
	struct dicom_sample sample = dicom_sample_make(SERIES, 1, NULL);
	sample.frames = 2;
	sample.bits_allocated = sample.bits_stored = 8;
	sample.high_bit = 7;
	sample.is_signed = 0;
	sample.position = NULL;
	sample.pixels = pixels;
	struct gz_volume volume = load(dicom_sample_write(&sample, "frames.dcm"));
	assert_int_equal(volume.type, GZ_VOXEL_U8);
	assert_int_equal(volume.dims[2], 2);
	assert_false(volume.oriented);
	assert_true(value_at(&volume, 0, 0, 0) == 1);
	assert_true(value_at(&volume, 2, 1, 1) == 12);
	gz_volume_free(&volume);
}

static void compressed_series_is_that_of_its_plain_one(void **state)
{
	(void)state;
	static const char *const programs[] = { "dcmcrle", "dcmcjpls", "dcmcjpeg" };
	char command[2048];
	write_series(SERIES, "p", 4);
	for (size_t i = 0; i < sizeof programs / sizeof programs[0]; i++) {
		snprintf(command, sizeof command,
			 "cd %s && for f in p?; do %s $f c$f 2>err || exit 1; done; rm -rf c && "
			 "mkdir c && mv cp? c",
			 files_folder(), programs[i]);
		if (system(command) != 0) {
			print_message("%s is not there; install dcmtk\n", programs[i]);
			skip();
		}
		struct gz_volume volume = load(files_path("c"));
		check_series(&volume);
		gz_volume_free(&volume);
	}
	snprintf(command, sizeof command, "rm -r %s/c", files_folder());
	assert_int_equal(system(command), 0);
}

static void missing_slice_is_refused(void **state)
{
	(void)state;
	write_series(SERIES, "s", 4);
	unlink(files_path("s3"));
	check_refused(files_folder(), GZ_ERR_FORMAT, "is a file missing?");
}

/* Without the last slice the others lie evenly: only a line tells that one is missing. */
static void damaged_file_of_a_series_is_named(void **state)
{
	(void)state;
	write_series(SERIES, "s", 4);
	assert_int_equal(truncate(files_path("s2"), 300), 0);
	struct captured_log log;
	struct gz_volume volume = { 0 };
	captured_log_init(&log, NULL);
	const enum gz_result result = gz_volume_load(files_folder(), NULL, NULL, &log.log, &volume);
	if (result != GZ_OK || log.messages != 1 || !strstr(log.last, "s2: damaged or cut off"))
		fail_msg("result %d, %d messages: %s", result, (int)log.messages, log.last);
	gz_volume_free(&volume);
}

static void what_is_no_grey_stack_is_refused(void **state)
{
	(void)state;
	const int16_t pixels[6] = { 0 };
	struct dicom_sample sample = dicom_sample_make(SERIES, 1, pixels);
	sample.samples_per_pixel = 3;
	check_refused(dicom_sample_write(&sample, "colour.dcm"), GZ_ERR_UNSUPPORTED, "colour");
	empty_folder(NULL);

	sample = dicom_sample_make(SERIES, 1, pixels);
	dicom_sample_write(&sample, "a");
	sample = dicom_sample_make(SERIES, 2, pixels);
	sample.position = "0\\0\\1";
	sample.orientation = "0\\1\\0\\0\\0\\1";
	dicom_sample_write(&sample, "b");
	check_refused(files_folder(), GZ_ERR_FORMAT, "another plane");
	sample.orientation = "1\\0\\0\\0\\1\\0";
	sample.bits_stored = 12;
	sample.high_bit = 11;
	dicom_sample_write(&sample, "b");
	check_refused(files_folder(), GZ_ERR_FORMAT, "not as those of");
	empty_folder(NULL);

	files_write("junk.dcm", "junk", 4);
	check_refused(files_path("junk.dcm"), GZ_ERR_FORMAT, "no DICOM image");
	check_refused(files_folder(), GZ_ERR_FORMAT, "no DICOM image in this folder");
	check_refused(files_path("none.dcm"), GZ_ERR_NOT_FOUND, "No such file");
}

static void file_cut_anywhere_or_lying_is_refused_or_whole(void **state)
{
	(void)state;
	const int16_t pixels[6] = { 5, 6, 7, 8, 9, 10 };
	struct dicom_sample sample = dicom_sample_make(SERIES, 1, pixels);
	const char *path = dicom_sample_write(&sample, "whole.dcm");
	uint8_t bytes[4096];
	FILE *in = fopen(path, "rb");
	const size_t size = fread(bytes, 1, sizeof bytes, in);
	fclose(in);
	unlink(path);
	for (size_t cut = 0; cut < size; cut++) {
		struct gz_volume volume = { 0 };
		path = files_write("cut.dcm", bytes, cut);
		if (gz_volume_load(path, NULL, NULL, NULL, &volume) == GZ_OK)
			fail_msg("%zu of %zu bytes made a volume", cut, size);
	}
	sample.columns = 16000;
	sample.rows = 16000;
	check_refused(dicom_sample_write(&sample, "cut.dcm"), GZ_ERR_FORMAT, "truncated");
	sample = dicom_sample_make(SERIES, 1, pixels);
	sample.frames = 2000000000;
	check_refused(dicom_sample_write(&sample, "cut.dcm"), GZ_ERR_FORMAT, "truncated");
	sample.frames = 0;
	sample.claimed_bytes = 0x7FFFFFFE;
	check_refused(dicom_sample_write(&sample, "cut.dcm"), GZ_ERR_FORMAT, "");
	sample.claimed_bytes = 0;
	sample.spacing = "0\\1";
	check_refused(dicom_sample_write(&sample, "cut.dcm"), GZ_ERR_FORMAT, "mm apart");
}

TEST_SUITE(volume_dicom)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(folder_of_one_series_is_ordered_by_place_and_turned,
				       empty_folder),
		cmocka_unit_test_setup(file_stands_for_its_series_among_others, empty_folder),
		cmocka_unit_test_setup(rescale_is_kept_as_slope_and_intercept, empty_folder),
		cmocka_unit_test_setup(slices_with_scales_of_their_own_become_float, empty_folder),
		cmocka_unit_test_setup(twelve_bits_are_taken_from_among_others, empty_folder),
		cmocka_unit_test_setup(frames_of_one_file_are_slices, empty_folder),
		cmocka_unit_test_setup(compressed_series_is_that_of_its_plain_one, empty_folder),
		cmocka_unit_test_setup(missing_slice_is_refused, empty_folder),
		cmocka_unit_test_setup(damaged_file_of_a_series_is_named, empty_folder),
		cmocka_unit_test_setup(what_is_no_grey_stack_is_refused, empty_folder),
		cmocka_unit_test_setup(file_cut_anywhere_or_lying_is_refused_or_whole,
				       empty_folder),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
