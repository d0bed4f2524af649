/* NRRD files that are written: what the loader reads of them is what was written. */
#include "check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "render/volume/nrrd_write.h"
#include "volume_files.h"

static struct gz_volume made(enum gz_voxel_type type)
{
	struct gz_volume volume = {
		.dims = { 7, 5, 3 }, .spacing = { 0.7, 1.25, 3 }, .type = type, .oriented = true
	};
	assert_int_equal(gz_volume_allocate(&volume), GZ_OK);
	uint8_t *bytes = volume.voxels;
	for (size_t i = 0; i < 105 * gz_voxel_size(type); i++)
		bytes[i] = (uint8_t)(37 * i + 11);
	if (type == GZ_VOXEL_F32)
		for (size_t i = 0; i < 105; i++)
			((float *)volume.voxels)[i] = (float)i - 50.5F;
	gz_volume_find_range(&volume);
	return volume;
}

static void what_is_written_is_loaded(void **state)
{
	(void)state;
	static const double intercepts[][2] = { { 0, -128 }, { 0, -32768 }, { 0, 0 } };
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++)
		for (int i = 0; i < 2; i++) {
			struct gz_volume volume = made((enum gz_voxel_type)type), read;
			volume.intercept = intercepts[type][i];
			volume.oriented = i == 0;
			const char *path = files_path("w.nrrd");
			assert_int_equal(gz_nrrd_write(&volume, path, NULL, NULL), GZ_OK);
			assert_int_equal(gz_volume_load(path, NULL, NULL, NULL, &read), GZ_OK);
			assert_memory_equal(read.dims, volume.dims, sizeof volume.dims);
			assert_memory_equal(read.spacing, volume.spacing, sizeof volume.spacing);
			assert_int_equal(read.type, volume.type);
			assert_true(read.intercept == volume.intercept && read.slope == 1);
			assert_int_equal(read.oriented, volume.oriented);
			assert_memory_equal(read.voxels, volume.voxels,
					    105 * gz_voxel_size(volume.type));
			gz_volume_free(&read);
			gz_volume_free(&volume);
		}
}

static bool stop(void *user, double share, const char *what)
{
	(void)user;
	(void)share;
	(void)what;
	return false;
}

static void refused_and_stopped_writing_leaves_nothing(void **state)
{
	(void)state;
	struct captured_log log;
	captured_log_init(&log, NULL);
	struct gz_volume volume = made(GZ_VOXEL_U8);
	const char *path = files_path("none.nrrd");
	const struct gz_loading loading = { .report = stop };
	assert_int_equal(gz_nrrd_write(&volume, path, &loading, &log.log), GZ_ERR_CANCELLED);
	assert_int_equal(log.messages, 0);
	volume.slope = 0.5;
	assert_int_equal(gz_nrrd_write(&volume, path, NULL, &log.log), GZ_ERR_UNSUPPORTED);
	assert_int_equal(log.messages, 1);
	assert_non_null(strstr(log.last, "scaled by 0.5"));
	volume.slope = 1;
	assert_int_equal(gz_nrrd_write(&volume, "/nowhere/at/all.nrrd", NULL, &log.log), GZ_ERR_IO);
	assert_int_equal(log.messages, 2);
	assert_int_not_equal(access(path, F_OK), 0);
	assert_int_not_equal(access(files_path("none.nrrd.part"), F_OK), 0);
	gz_volume_free(&volume);
	assert_int_equal(gz_nrrd_write(&volume, path, NULL, NULL), GZ_ERR_INVAL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_written_is_loaded),
		cmocka_unit_test(refused_and_stopped_writing_leaves_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
