/* Real volumes, found under $GAZECAST_DATA/volumes: size, range, sum and three voxels of each. The
 * numbers were computed from the files by numpy, without this code. Where a header's frame is LPS,
 * numpy flipped x and y. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "render/data/volume.h"

/* Voxels at (x/2, y/2, z/2), (x/3, y/2, 2z/3), (2x/3, y/4, z/2). */
struct expectation {
	const char *file;
	int dims[3];
	double spacing[3];
	double low, high, sum;
	double voxels[3];
	enum gz_raw_type type; /* headerless files */
	bool headerless;
};

static const struct expectation expectations[] = {
	{ .file = "abdomen_half_256x256x275_int16le.raw.zst",
	  .dims = { 256, 256, 275 },
	  .spacing = { 1.5625, 1.5625, 1.0 },
	  .low = -1000,
	  .high = 1876,
	  .sum = -11171363685,
	  .voxels = { 51, -799, -888 },
	  .type = GZ_RAW_INT16,
	  .headerless = true },
	{ .file = "aneurism_256x256x256_uint8.raw.zst",
	  .dims = { 256, 256, 256 },
	  .spacing = { 1, 1, 1 },
	  .high = 255,
	  .sum = 17938365,
	  .headerless = true },
	{ .file = "bonsai_256x256x256_uint8.raw.zst",
	  .dims = { 256, 256, 256 },
	  .spacing = { 1, 1, 1 },
	  .high = 255,
	  .sum = 230038784,
	  .voxels = { 13, 0, 11 },
	  .headerless = true },
	{ .file = "cranium_256x256x108_int16le.raw.zst",
	  .dims = { 256, 256, 108 },
	  .spacing = { 0.9570312, 0.9570312, 1.5 },
	  .low = -1024,
	  .high = 2986,
	  .sum = -4147325847,
	  .voxels = { 3, 26, 20 },
	  .type = GZ_RAW_INT16,
	  .headerless = true },
	{ .file = "engine_256x256x128_uint8.raw.zst",
	  .dims = { 256, 256, 128 },
	  .spacing = { 1, 1, 1 },
	  .high = 255,
	  .sum = 187475057,
	  .voxels = { 133, 10, 4 },
	  .headerless = true },
	{ .file = "headsq_quarter_64x64x93_uint16le.raw.zst",
	  .dims = { 64, 64, 93 },
	  .spacing = { 3.2, 3.2, 1.5 },
	  .high = 3926,
	  .sum = 193392317,
	  .voxels = { 122, 1084, 940 },
	  .type = GZ_RAW_UINT16,
	  .headerless = true },
	{ .file = "heptane_148x148x148_uint8.raw.zst",
	  .dims = { 148, 148, 148 },
	  .spacing = { 1, 1, 1 },
	  .high = 249,
	  .sum = 26387634,
	  .voxels = { 237, 0, 0 },
	  .headerless = true },
	{ .file = "hydrogen_atom_128x128x128_uint8.raw.zst",
	  .dims = { 128, 128, 128 },
	  .spacing = { 1, 1, 1 },
	  .high = 250,
	  .sum = 5990975,
	  .voxels = { 62, 3, 1 },
	  .headerless = true },
	{ .file = "neghip_64x64x64_uint8.raw.zst",
	  .dims = { 64, 64, 64 },
	  .spacing = { 1, 1, 1 },
	  .high = 255,
	  .sum = 4824177,
	  .voxels = { 0, 73, 16 },
	  .headerless = true },
	{ .file = "ch2.nii.gz",
	  .dims = { 181, 217, 181 },
	  .spacing = { 1, 1, 1 },
	  .high = 254,
	  .sum = 317151210,
	  .voxels = { 33, 112, 92 } },
	{ .file = "CT_AVM.nii.gz",
	  .dims = { 256, 242, 154 },
	  .spacing = { 0.719942569732666, 0.7209135890007019, 1 },
	  .high = 563.2000029,
	  .sum = 49383836.666 },
	{ .file = "tooth.nrrd",
	  .dims = { 103, 94, 161 },
	  .spacing = { 1, 1, 1 },
	  .high = 255,
	  .sum = 160814065,
	  .voxels = { 153, 110, 142 } },
	{ .file = "stent.nrrd",
	  .dims = { 128, 128, 256 },
	  .spacing = { 1, 1, 1 },
	  .high = 1,
	  .sum = 74235.4530545 },
	{ .file = "frogtissue.mhd",
	  .dims = { 500, 470, 136 },
	  .spacing = { 1, 1, 1.5 },
	  .high = 29,
	  .sum = 12279472,
	  .voxels = { 6, 0, 0 } },
	{ .file = "HeadMRVolume.mhd",
	  .dims = { 48, 62, 42 },
	  .spacing = { 4, 4, 4 },
	  .high = 255,
	  .sum = 3058332,
	  .voxels = { 91, 62, 62 } },
};

static double sum_of(const struct gz_volume *v)
{
	size_t count = gz_volume_voxel_count(v);
	double sum = 0;
	for (size_t i = 0; i < count; i++)
		sum += v->slope * gz_voxel_stored(v->type, v->voxels, i) + v->intercept;
	return sum;
}

static double voxel_of(const struct gz_volume *v, int which)
{
	const int *d = v->dims;
	const int at[3][3] = { { d[0] / 2, d[1] / 2, d[2] / 2 },
			       { d[0] / 3, d[1] / 2, 2 * d[2] / 3 },
			       { 2 * d[0] / 3, d[1] / 4, d[2] / 2 } };
	const int *p = at[which];
	size_t i = ((size_t)p[2] * (size_t)d[1] + (size_t)p[1]) * (size_t)d[0] + (size_t)p[0];
	return v->slope * gz_voxel_stored(v->type, v->voxels, i) + v->intercept;
}

static bool near(double a, double b)
{
	return fabs(a - b) <= 1e-8 * fmax(1, fabs(b));
}

static void check_near(const char *file, const char *what, double got, double expected)
{
	if (!near(got, expected))
		fail_msg("%s: %s is %.12g, expected %.12g", file, what, got, expected);
}

static void check_volume(const struct expectation *e, const struct gz_volume *v)
{
	for (int i = 0; i < 3; i++) {
		assert_int_equal(v->dims[i], e->dims[i]);
		check_near(e->file, "spacing", v->spacing[i], e->spacing[i]);
		check_near(e->file, "a voxel", voxel_of(v, i), e->voxels[i]);
	}
	check_near(e->file, "the least", v->slope * v->stored_min + v->intercept, e->low);
	check_near(e->file, "the greatest", v->slope * v->stored_max + v->intercept, e->high);
	check_near(e->file, "the sum", sum_of(v), e->sum);
}

static void every_volume_has_the_values_of_its_file(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof expectations / sizeof expectations[0]; i++) {
		const struct expectation *e = &expectations[i];
		struct gz_raw_layout raw = { .type = e->type };
		struct captured_log log;
		struct gz_volume v;
		char path[2048];
		for (int axis = 0; axis < 3; axis++) {
			raw.dims[axis] = e->dims[axis];
			raw.spacing[axis] = e->spacing[axis];
		}
		captured_log_init(&log, "*:warn");
		snprintf(path, sizeof path, "%s/volumes/%s", getenv("GAZECAST_DATA"), e->file);
		if (access(path, F_OK) != 0) {
			print_message("not there: %s\n", path);
			continue;
		}
		if (gz_volume_load(path, e->headerless ? &raw : NULL, NULL, &log.log, &v) !=
			    GZ_OK ||
		    log.messages)
			fail_msg("%s", log.last);
		check_volume(e, &v);
		gz_volume_free(&v);
	}
}

TEST_SUITE(volume_data)
{
	if (!getenv("GAZECAST_DATA")) {
		printf("GAZECAST_DATA is not set: nothing to load\n");
		return 77;
	}
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_volume_has_the_values_of_its_file),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
