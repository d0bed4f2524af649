/* Peak memory of loading 256 MiB of voxels, by every way in: at most 1.3 times the volume above a
 * process that loads almost nothing; of showing them with all levels of detail at most 1.25. The
 * files hold zeros, so that they take no disk. */
#include "suite.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zstd.h>

#include "base/captured_log.h"
#include "render/data/format.h"
#include "render/data/volume.h"
#include "render/plan/method.h"
#include "render/raycast/shared/raycaster.h"
#include "volume_files.h"

#define MIB        (1024 * 1024)
#define VOLUME_MIB 256
#define MOST_RATIO 1.3

enum { WIDTH = 640, HEIGHT = 480 };

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SANITIZED 1
#endif
#endif

struct way_in {
	const char *name;
	const struct gz_raw_layout *raw;
};

static const struct gz_raw_layout bytes = { .dims = { 512, 512, 1024 }, .spacing = { 1, 1, 1 } };
static const struct gz_raw_layout doubles = { .dims = { 512, 512, 256 },
					      .type = GZ_RAW_FLOAT64,
					      .spacing = { 1, 1, 1 } };
static const struct gz_raw_layout tiny = { .dims = { 2, 2, 2 }, .spacing = { 1, 1, 1 } };

static const struct gz_raw_layout words = { .dims = { 512, 512, 512 },
					    .type = GZ_RAW_UINT16,
					    .spacing = { 1, 1, 1 } };

static const struct way_in ways_in[] = {
	{ "bytes.raw", &bytes },     { "doubles.raw", &doubles }, { "bytes.raw.gz", &bytes },
	{ "bytes.raw.zst", &bytes }, { "sagittal.nii", NULL },    { "lps.nrrd", NULL },
	{ "lps.mha", NULL },
};

static void append_zeros(const char *path, off_t size)
{
	int fd = open(path, O_WRONLY);
	off_t end = lseek(fd, 0, SEEK_END);
	assert_true(fd >= 0 && end >= 0);
	assert_int_equal(ftruncate(fd, end + size), 0);
	close(fd);
}

/* VOLUME_MIB members or frames of 1 MiB. */
static void write_compressed(const char *name, const void *member, size_t size)
{
	FILE *file = fopen(files_path(name), "wb");
	assert_non_null(file);
	for (int i = 0; i < VOLUME_MIB; i++)
		assert_int_equal(fwrite(member, 1, size, file), size);
	assert_int_equal(fclose(file), 0);
}

static int write_files(void **state)
{
	(void)state;
	static uint8_t zeros[MIB], packed[MIB + 1024], header[352];
	const off_t size = (off_t)VOLUME_MIB * MIB;
	append_zeros(files_write("tiny.raw", NULL, 0), 8);
	append_zeros(files_write("bytes.raw", NULL, 0), size);
	append_zeros(files_write("words.raw", NULL, 0), size);
	append_zeros(files_write("doubles.raw", NULL, 0), 2 * size);
	write_compressed("bytes.raw.gz", packed,
			 files_deflate(zeros, MIB, 31, packed, sizeof packed));
	write_compressed("bytes.raw.zst", packed,
			 ZSTD_compress(packed, sizeof packed, zeros, MIB, 3));
	/* 16 bits a voxel; columns: anterior to posterior, superior to inferior, left to right */
	struct nifti_sample sample = nifti_sample_make(512, 512, 512);
	sample.datatype = 4;
	sample.sform_code = 1;
	sample.srow[0][2] = 1;
	sample.srow[1][0] = sample.srow[2][1] = -1;
	nifti_sample_bytes(&sample, header);
	append_zeros(files_write("sagittal.nii", header, sizeof header), size);
	append_zeros(files_write_text("lps.nrrd",
				      "NRRD0005\ntype: float\nendian: little\ndimension: 3\n"
				      "sizes: 256 512 512\nspace: LPS\nencoding: raw\n"
				      "space directions: (1,0,0) (0,1,0) (0,0,1)\n\n",
				      NULL, 0),
		     size);
	append_zeros(files_write_text("lps.mha",
				      "NDims = 3\nDimSize = 512 512 1024\nElementType = MET_UCHAR\n"
				      "TransformMatrix = 1 0 0 0 1 0 0 0 1\n"
				      "ElementDataFile = LOCAL\n",
				      NULL, 0),
		     size);
	return 0;
}

/* Peak memory of a process of its own that loads it, KiB. */
static long peak_of(const char *name, const struct gz_raw_layout *raw)
{
	const char *path = files_path(name);
	fflush(NULL);
	pid_t child = fork();
	assert_true(child >= 0);
	if (child == 0) {
		struct gz_volume volume;
		struct gz_log log;
		gz_log_init(&log, NULL, NULL, "*:warn");
		_exit(gz_volume_load(path, raw, NULL, &log, &volume) == GZ_OK ? 0 : 1);
	}
	struct rusage usage;
	int status = -1;
	assert_int_equal(wait4(child, &status, 0, &usage), child);
	assert_int_equal(status, 0);
	return usage.ru_maxrss;
}

static void peak_is_at_most_1_3_volumes_by_every_way_in(void **state)
{
	(void)state;
	long without = peak_of("tiny.raw", &tiny);
	for (size_t i = 0; i < sizeof ways_in / sizeof ways_in[0]; i++) {
		long peak = peak_of(ways_in[i].name, ways_in[i].raw);
		double ratio = (double)(peak - without) / (VOLUME_MIB * 1024.0);
		print_message("%-14s %.3f volumes\n", ways_in[i].name, ratio);
		if (!(ratio >= 0.99 && ratio <= MOST_RATIO))
			fail_msg("%s: %ld KiB, of which %ld without it: %.3f volumes, allowed %.1f",
				 ways_in[i].name, peak, without, ratio, MOST_RATIO);
	}
}

/* Fog in the whole box, from where all levels of detail are taken. */
static int show(const char *path, const struct gz_raw_layout *raw, const struct gz_loading *loading)
{
	static const struct gz_transfer fog = { .count = 1,
						.points = { { 0, { 1, 1, 1 }, 0.01 } } };
	const struct gz_camera camera = { .eye = { 1, 2, 1 }, .up = { 0, 0, 1 }, .fov_deg = 40 };
	const struct gz_backend_params params = { .wait_for_bricks = true };
	const struct gz_display display = gz_display_default(WIDTH, HEIGHT);
	struct gz_foveation foveation = gz_foveation_default();
	struct gz_ray_params rays = gz_ray_params_default();
	struct gz_raycaster *renderer = NULL;
	struct gz_volume volume;
	struct gz_plan plan = { 0 };
	struct gz_image image = { 0 };
	foveation.method = GZ_METHOD_ACUITY;
	rays.levels = true;
	return gz_volume_load(path, raw, loading, NULL, &volume) == GZ_OK &&
	       gz_raycaster_create("cpu", &params, NULL, &renderer) == GZ_OK &&
	       gz_raycaster_set_volume(renderer, &volume) == GZ_OK &&
	       gz_raycaster_set_transfer(renderer, &fog) == GZ_OK &&
	       gz_plan_make(&foveation, &display, (struct gz_point) { 0.5F, 0.5F }, WIDTH, HEIGHT,
			    &plan) == GZ_OK &&
	       gz_raycaster_render(renderer, &camera, &rays, &plan, &image, NULL) == GZ_OK;
}

static long peak_of_showing(const char *name, const struct gz_raw_layout *raw, size_t brick_bytes)
{
	const struct gz_loading loading = { .brick_bytes = brick_bytes };
	const char *path = files_path(name);
	fflush(NULL);
	pid_t child = fork();
	assert_true(child >= 0);
	if (child == 0)
		_exit(show(path, raw, &loading) ? 0 : 1);
	struct rusage usage;
	int status = -1;
	assert_int_equal(wait4(child, &status, 0, &usage), child);
	assert_int_equal(status, 0);
	return usage.ru_maxrss;
}

static void showing_all_levels_takes_at_most_1_25_volumes(void **state)
{
	(void)state;
	const long without = peak_of_showing("tiny.raw", &tiny, 0);
	const long peak = peak_of_showing("words.raw", &words, 0);
	const double ratio = (double)(peak - without) / (VOLUME_MIB * 1024.0);
	print_message("shown from memory %.3f volumes\n", ratio);
	assert_true(ratio >= 0.99 && ratio <= 1.25);
}

static void bricks_take_the_memory_they_are_given(void **state)
{
	(void)state;
	struct gz_volume volume;
	assert_int_equal(gz_volume_load(files_path("words.raw"), &words, NULL, NULL, &volume),
			 GZ_OK);
	/* Not all one value, or there would be no bricks. */
	for (size_t i = 0; i < gz_volume_voxel_count(&volume); i += 999)
		((uint16_t *)volume.voxels)[i] = (uint16_t)i;
	gz_volume_find_range(&volume);
	assert_int_equal(gz_bricks_write(&volume, files_path("words.gzb"), NULL, NULL), GZ_OK);
	gz_volume_free(&volume);
	const long without = peak_of_showing("tiny.raw", &tiny, 0);
	const long peak = peak_of_showing("words.gzb", NULL, (size_t)64 * MIB);
	const double mib = (double)(peak - without) / 1024;
	print_message("shown from bricks with room for 64 MiB of 256: %.1f MiB\n", mib);
	assert_true(mib >= 32 && mib <= 80);
}

TEST_SUITE(volume_memory)
{
#ifdef SANITIZED
	printf("a sanitizer's own memory would be measured\n");
	return 77;
#endif
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(showing_all_levels_takes_at_most_1_25_volumes, write_files),
		cmocka_unit_test_setup(bricks_take_the_memory_they_are_given, write_files),
		cmocka_unit_test_setup(peak_is_at_most_1_3_volumes_by_every_way_in, write_files),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
