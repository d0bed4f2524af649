/* NRRD files that are written: what the loader reads of them is what was written. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "render/data/format.h"
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

static double stored_at(const struct gz_volume *volume, size_t i)
{
	return volume->type == GZ_VOXEL_U8    ? ((uint8_t *)volume->voxels)[i]
	       : volume->type == GZ_VOXEL_U16 ? ((uint16_t *)volume->voxels)[i]
					      : (double)((float *)volume->voxels)[i];
}

static bool names_type(const char *path, const char *type)
{
	char head[64] = "", wanted[32];
	FILE *file = fopen(path, "rb");
	assert_non_null(file);
	assert_true(fread(head, 1, sizeof head - 1, file) > 0);
	fclose(file);
	snprintf(wanted, sizeof wanted, "\ntype: %s\n", type);
	return strstr(head, wanted) != NULL;
}

/* A CT's intercept is -1024, over that which makes signed numbers unsigned. */
static void scaled_values_are_written_as_they_are_in_the_least_type_that_holds_them(void **state)
{
	(void)state;
	static const struct {
		enum gz_voxel_type type;
		double slope, intercept, least, greatest; /* of what is stored */
		const char *name;
	} cases[] = {
		{ GZ_VOXEL_U16, 1, -32768 - 1024, 31000, 36000, "int16" },
		{ GZ_VOXEL_U16, 1, -1024, 0, 4095, "int16" },
		{ GZ_VOXEL_U16, 1, -32768 - 1024, 0, 36000, "float" },
		{ GZ_VOXEL_U16, 1, 1000, 0, 64000, "uint16" },
		{ GZ_VOXEL_U16, 1, 1000, 0, 65000, "float" },
		{ GZ_VOXEL_U8, 1, -1024, 0, 255, "int16" },
		{ GZ_VOXEL_U8, 1, 5, 0, 250, "uint8" },
		{ GZ_VOXEL_U8, 1, 5, 0, 255, "uint16" },
		{ GZ_VOXEL_U8, 0.5, 0, 0, 255, "float" },
		{ GZ_VOXEL_U16, 1, 0.5, 0, 255, "float" },
		{ GZ_VOXEL_F32, 2, -3, -50, 50, "float" },
		{ GZ_VOXEL_F32, 1, 0x1p26, 0, 104000, "uint32" },
		{ GZ_VOXEL_F32, 1, -0x1p31, 0, 104, "int32" },
		{ GZ_VOXEL_U16, 1, 0x1p31, 0, 65535, "uint32" },
		{ GZ_VOXEL_F32, 1, -3, 0, 104, "float" },
	};
	for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
		struct gz_volume volume = made(cases[k].type), read;
		for (size_t i = 0; i < 105; i++) {
			const double value =
				rint(cases[k].least +
				     (cases[k].greatest - cases[k].least) * (double)i / 104);
			if (volume.type == GZ_VOXEL_U8)
				((uint8_t *)volume.voxels)[i] = (uint8_t)value;
			else if (volume.type == GZ_VOXEL_U16)
				((uint16_t *)volume.voxels)[i] = (uint16_t)value;
			else
				((float *)volume.voxels)[i] = (float)value;
		}
		gz_volume_find_range(&volume);
		volume.slope = cases[k].slope;
		volume.intercept = cases[k].intercept;
		const char *path = files_path("scaled.nrrd");
		assert_int_equal(gz_nrrd_write(&volume, path, NULL, NULL), GZ_OK);
		if (!names_type(path, cases[k].name))
			fail_msg("case %zu is not written as %s", k, cases[k].name);
		assert_int_equal(gz_volume_load(path, NULL, NULL, NULL, &read), GZ_OK);
		for (size_t i = 0; i < 105; i++) {
			const double wrote =
				volume.slope * stored_at(&volume, i) + volume.intercept;
			const double got = read.slope * stored_at(&read, i) + read.intercept;
			if (wrote != got)
				fail_msg("case %zu voxel %zu: %g, not %g", k, i, got, wrote);
		}
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
	assert_int_equal(gz_nrrd_write(&volume, "/nowhere/at/all.nrrd", NULL, &log.log), GZ_ERR_IO);
	assert_int_equal(log.messages, 1);
	assert_int_not_equal(access(path, F_OK), 0);
	assert_int_not_equal(access(files_path("none.nrrd.part"), F_OK), 0);
	gz_volume_free(&volume);
	assert_int_equal(gz_nrrd_write(&volume, path, NULL, NULL), GZ_ERR_INVAL);
}

TEST_SUITE(nrrd_write)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_written_is_loaded),
		cmocka_unit_test(
			scaled_values_are_written_as_they_are_in_the_least_type_that_holds_them),
		cmocka_unit_test(refused_and_stopped_writing_leaves_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
