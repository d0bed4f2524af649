/* Files of bricks: what is written is read, and nothing else is. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "base/captured_log.h"
#include "render/data/brick_file.h"
#include "render/data/format.h"
#include "render/data/levels.h"
#include "volume_files.h"

static struct gz_volume made(int nx, int ny, int nz, enum gz_voxel_type type)
{
	struct gz_volume volume;
	assert_int_equal(gz_volume_generate(
				 &(struct gz_procedural_request) { GZ_PROCEDURAL_SHELLS,
								   (int[3]) { nx, ny, nz },
								   (double[3]) { 1, 1, 1 }, type },
				 NULL, NULL, &volume),
			 GZ_OK);
	return volume;
}

static const char *written(const struct gz_volume *volume, const char *name)
{
	const char *path = files_path(name);
	assert_int_equal(gz_bricks_write(volume, path, NULL, NULL), GZ_OK);
	return path;
}

static struct gz_brick_file *opened(const char *path)
{
	struct gz_brick_file *file = NULL;
	assert_int_equal(gz_brick_file_open(path, NULL, &file), GZ_OK);
	return file;
}

static double voxel_at(const struct gz_volume *volume, const int at[3])
{
	size_t index = 0;
	for (int axis = 2; axis >= 0; axis--) {
		const int last = volume->dims[axis] - 1;
		const int i = at[axis] < 0 ? 0 : at[axis] > last ? last : at[axis];
		index = index * (size_t)volume->dims[axis] + (size_t)i;
	}
	return gz_voxel_stored(volume->type, volume->voxels, index);
}

/* Every stored voxel of every brick of one level, against the volume that the level is. */
static void check_level(const struct gz_brick_file *file, int level, const struct gz_volume *volume)
{
	static float voxels[GZ_BRICK_VOXELS];
	const struct gz_brick_level *l = &file->layout.levels[level];
	assert_memory_equal(l->dims, volume->dims, sizeof l->dims);
	for (int b = 0; b < l->bricks[0] * l->bricks[1] * l->bricks[2]; b++) {
		int found, brick[3];
		const size_t number = l->first + (size_t)b;
		gz_brick_place(&file->layout, number, &found, brick);
		assert_int_equal(found, level);
		assert_int_equal(gz_brick_number(&file->layout, level, brick), number);
		assert_int_equal(gz_brick_file_read(file, number, voxels), GZ_OK);
		for (int i = 0; i < GZ_BRICK_VOXELS; i++) {
			const int e = GZ_BRICK_STORED_EDGE;
			const int at[3] = { brick[0] * 32 + i % e - 1,
					    brick[1] * 32 + i / e % e - 1,
					    brick[2] * 32 + i / e / e - 1 };
			const double got = gz_voxel_stored(volume->type, voxels, (size_t)i);
			const double wanted = voxel_at(volume, at);
			if (got != wanted)
				fail_msg("level %d brick %zu voxel %d: %g instead of %g", level,
					 number, i, got, wanted);
			assert_true(got >= (double)file->entries[number].least);
			assert_true(got <= (double)file->entries[number].greatest);
		}
	}
}

static void check_levels(const struct gz_brick_file *file, const struct gz_volume *volume)
{
	struct gz_volume at = *volume;
	for (int level = 0; level < file->layout.level_count; level++) {
		struct gz_volume half;
		check_level(file, level, &at);
		if (level + 1 == file->layout.level_count)
			break;
		assert_int_equal(gz_volume_halve(&at, NULL, &half), GZ_OK);
		if (level > 0)
			gz_volume_free(&at);
		at = half;
	}
	if (at.voxels != volume->voxels)
		gz_volume_free(&at);
}

static void what_is_written_is_read_level_by_level(void **state)
{
	(void)state;
	static const struct {
		int dims[3];
		enum gz_voxel_type type;
		int levels;
	} cases[] = {
		{ { 70, 65, 33 }, GZ_VOXEL_U16, 3 }, { { 64, 32, 96 }, GZ_VOXEL_U8, 3 },
		{ { 33, 1, 47 }, GZ_VOXEL_F32, 2 },  { { 1, 1, 1 }, GZ_VOXEL_U8, 1 },
		{ { 129, 3, 2 }, GZ_VOXEL_U16, 4 },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		const int *d = cases[i].dims;
		struct gz_volume volume = made(d[0], d[1], d[2], cases[i].type);
		volume.spacing[0] = 1.2;
		volume.intercept = -3;
		struct gz_brick_file *file = opened(written(&volume, "round.gzb"));
		assert_int_equal(file->layout.level_count, cases[i].levels);
		assert_memory_equal(file->header.spacing, volume.spacing, sizeof volume.spacing);
		assert_true(file->header.slope == volume.slope);
		assert_true(file->header.intercept == -3);
		assert_true(file->header.stored_max == volume.stored_max);
		assert_int_equal(file->header.type, volume.type);
		assert_true(file->header.oriented);
		check_levels(file, &volume);
		gz_brick_file_close(&file);
		gz_volume_free(&volume);
	}
}

static void same_volume_makes_the_same_file(void **state)
{
	(void)state;
	struct gz_volume volume = made(40, 40, 40, GZ_VOXEL_U8);
	static uint8_t bytes[2][1 << 20];
	size_t size[2];
	for (int i = 0; i < 2; i++) {
		FILE *file = fopen(written(&volume, "same.gzb"), "rb");
		assert_non_null(file);
		size[i] = fread(bytes[i], 1, sizeof bytes[i], file);
		fclose(file);
	}
	assert_true(size[0] > GZ_BRICK_VOXELS);
	assert_int_equal(size[0], size[1]);
	assert_memory_equal(bytes[0], bytes[1], size[0]);
	gz_volume_free(&volume);
}

static void one_value_takes_no_bricks_on_disk(void **state)
{
	(void)state;
	struct gz_volume volume = { .dims = { 100, 90, 80 },
				    .spacing = { 1, 1, 1 },
				    .type = GZ_VOXEL_U16 };
	assert_int_equal(gz_volume_allocate(&volume), GZ_OK);
	for (size_t i = 0; i < gz_volume_voxel_count(&volume); i++)
		((uint16_t *)volume.voxels)[i] = 777;
	gz_volume_find_range(&volume);
	struct gz_brick_file *file = opened(written(&volume, "one.gzb"));
	assert_true(file->header.file_size < 64 * 1024);
	check_levels(file, &volume);
	gz_brick_file_close(&file);
	gz_volume_free(&volume);
}

static bool stop(void *user, double share, const char *what)
{
	(void)what;
	return share < *(const double *)user;
}

static void stopped_and_failed_writing_leaves_nothing(void **state)
{
	(void)state;
	struct gz_volume volume = made(70, 70, 70, GZ_VOXEL_U8);
	double end = 0.5;
	const struct gz_loading loading = { .report = stop, .user = &end };
	const char *path = files_path("stopped.gzb");
	assert_int_equal(gz_bricks_write(&volume, path, &loading, NULL), GZ_ERR_CANCELLED);
	assert_int_not_equal(access(path, F_OK), 0);
	assert_int_not_equal(access(files_path("stopped.gzb.part"), F_OK), 0);
	struct captured_log log;
	captured_log_init(&log, NULL);
	assert_int_equal(gz_bricks_write(&volume, "/nowhere/at/all.gzb", NULL, &log.log),
			 GZ_ERR_IO);
	assert_int_equal(log.messages, 1);
	assert_non_null(strstr(log.last, "/nowhere/at/all.gzb"));
	gz_volume_free(&volume);
	assert_int_equal(gz_bricks_write(&volume, path, NULL, NULL), GZ_ERR_INVAL);
}

/* The bytes of a good file, to be spoilt. */
struct bytes {
	uint8_t at[1 << 20];
	size_t size;
};

static void read_all(const char *path, struct bytes *out)
{
	FILE *file = fopen(path, "rb");
	assert_non_null(file);
	out->size = fread(out->at, 1, sizeof out->at, file);
	fclose(file);
}

static void put32(uint8_t *at, uint32_t value)
{
	for (int i = 0; i < 4; i++)
		at[i] = (uint8_t)(value >> (8 * i));
}

/* Checksums made right again, so that what is behind them is what refuses. */
static void sign(struct bytes *bytes, size_t index_bytes)
{
	put32(bytes->at + 36,
	      (uint32_t)crc32(0, bytes->at + GZ_BRICK_HEADER_BYTES, (uInt)index_bytes));
	put32(bytes->at + 124, (uint32_t)crc32(0, bytes->at, 124));
}

static void refused(const struct bytes *bytes, size_t size, const char *why)
{
	struct captured_log log;
	struct gz_brick_file *file = NULL;
	captured_log_init(&log, NULL);
	const char *path = files_write("bad.gzb", bytes->at, size);
	const enum gz_result got = gz_brick_file_open(path, &log.log, &file);
	if (got != GZ_ERR_FORMAT || log.messages != 1 || !strstr(log.last, why))
		fail_msg("%s: result %d, %d messages, \"%s\"", why, got, log.messages, log.last);
	assert_null(file);
}

static void damaged_files_are_refused_with_a_line(void **state)
{
	(void)state;
	static struct bytes good, bad;
	struct gz_volume volume = made(60, 20, 20, GZ_VOXEL_U8);
	read_all(written(&volume, "good.gzb"), &good);
	gz_volume_free(&volume);
	const size_t index = 3 * GZ_BRICK_ENTRY_BYTES; /* two bricks, and one of the next level */

	refused(&good, 0, "truncated: it ends at byte 0 of 128");
	refused(&good, 127, "truncated: it ends at byte 127 of 128");
	refused(&good, good.size - 1, "truncated: it ends at byte");

	static const struct {
		size_t at;
		uint32_t value;
		bool sign;
		const char *why;
	} spoils[] = {
		{ 0, 0x4e4f4e4f, true, "not a file of bricks" },
		{ 8, 2, true, "a version of the format that is not read" },
		{ 24, 61, false, "damaged header" },
		{ 12, 3, true, "an unknown type, edge or flag" },
		{ 16, 64, true, "an unknown type, edge or flag" },
		{ 20, 2, true, "an unknown type, edge or flag" },
		{ 44, 2, true, "an unknown type, edge or flag" },
		{ 120, 4, true, "an unknown type, edge or flag" },
		{ 24, 0, true, "dims or spacing out of range" },
		{ 24, 0x80000001, true, "dims or spacing out of range" },
		{ 28, 16385, true, "dims or spacing out of range" },
		{ 52, 0x7ff80000, true, "dims or spacing out of range" },
		{ 52, 0xbff00000, true, "dims or spacing out of range" },
		{ 76, 0, true, "values out of range" },           /* slope */
		{ 84, 0x7ff00000, true, "values out of range" },  /* intercept */
		{ 92, 0xbff00000, true, "values out of range" },  /* least */
		{ 100, 0x41f00000, true, "values out of range" }, /* greatest */
		{ 24, 30, true, "its number of bricks does not fit its dims" },
		{ 104, 4, true, "its number of bricks does not fit its dims" },
		{ 108, 1, true, "its number of bricks does not fit its dims" },
		{ 112, 4096, true, "truncated" },
		{ 112, 200, true, "the size in its header" },
		{ 116, 1, true, "truncated" },
		{ 128, 4096 + 100, true, "a brick is outside the file" },
		{ 128, 128, true, "a brick is outside the file" },
		{ 132, 0x80000000, true, "a brick is outside the file" },
		{ 128, 0, true, "a brick has no voxels" },
		{ 140, 0x7fc00000, true, "a brick has an invalid range of values" },
		{ 140, 0xc2000000, true, "a brick has an invalid range of values" },
		{ 144, 0x7f800000, true, "a brick has an invalid range of values" },
		{ 136, 0, false, "damaged index" },
		{ 204, 0x00010203, false, "damaged ranges of cells" },
	};
	for (size_t i = 0; i < sizeof spoils / sizeof spoils[0]; i++) {
		bad = good;
		put32(bad.at + spoils[i].at, spoils[i].value);
		if (spoils[i].at == 112 && spoils[i].value == 4096)
			put32(bad.at + 112, (uint32_t)good.size + 4096);
		if (spoils[i].sign)
			sign(&bad, index);
		refused(&bad, bad.size, spoils[i].why);
	}
}

static void what_is_no_file_is_refused(void **state)
{
	(void)state;
	struct captured_log log;
	struct gz_brick_file *file = NULL;
	captured_log_init(&log, NULL);
	assert_int_equal(gz_brick_file_open(files_path("none.gzb"), &log.log, &file),
			 GZ_ERR_NOT_FOUND);
	assert_int_equal(gz_brick_file_open(files_folder(), &log.log, &file), GZ_ERR_FORMAT);
	assert_int_equal(log.messages, 2);
	gz_brick_file_close(&file);
}

static void damaged_brick_is_told_from_a_good_one(void **state)
{
	(void)state;
	static struct bytes bytes;
	static float voxels[GZ_BRICK_VOXELS];
	struct gz_volume volume = made(60, 20, 20, GZ_VOXEL_F32);
	read_all(written(&volume, "brick.gzb"), &bytes);
	gz_volume_free(&volume);
	struct gz_brick_file *file = opened(files_path("brick.gzb"));
	const size_t at = (size_t)file->entries[1].offset;
	gz_brick_file_close(&file);

	bytes.at[at + 1000] ^= 1;
	file = opened(files_write("flipped.gzb", bytes.at, bytes.size));
	assert_int_equal(gz_brick_file_read(file, 0, voxels), GZ_OK);
	assert_int_equal(gz_brick_file_read(file, 1, voxels), GZ_ERR_FORMAT);
	/* The file becomes shorter while it is open. */
	assert_int_equal(truncate(files_path("flipped.gzb"), 8192), 0);
	assert_int_equal(gz_brick_file_read(file, 2, voxels), GZ_ERR_IO);
	gz_brick_file_close(&file);

	/* A voxel that is not finite, under a right checksum. */
	put32(bytes.at + at, 0x7f800000);
	put32(bytes.at + GZ_BRICK_HEADER_BYTES + GZ_BRICK_ENTRY_BYTES + 8,
	      (uint32_t)crc32(0, bytes.at + at, GZ_BRICK_VOXELS * 4));
	sign(&bytes, 3 * GZ_BRICK_ENTRY_BYTES);
	file = opened(files_write("infinite.gzb", bytes.at, bytes.size));
	assert_int_equal(gz_brick_file_read(file, 1, voxels), GZ_ERR_FORMAT);
	gz_brick_file_close(&file);
}

static void parents_and_children_agree(void **state)
{
	(void)state;
	struct gz_brick_layout layout;
	/* y is halved only once x and z are as coarse */
	gz_brick_layout_make((int[3]) { 300, 200, 170 }, (double[3]) { 1, 2, 1 }, &layout);
	assert_true(layout.level_count > 2);
	assert_int_equal(layout.levels[1].halvings[1], 0);
	for (size_t i = 0; i < layout.brick_count; i++) {
		int level, brick[3], parent[3], first[3], end[3];
		gz_brick_place(&layout, i, &level, brick);
		if (level + 1 == layout.level_count)
			break;
		gz_brick_parent(&layout, level, brick, parent);
		gz_brick_children(&layout, level + 1, parent, first, end);
		for (int axis = 0; axis < 3; axis++) {
			assert_in_range(brick[axis], first[axis], end[axis] - 1);
			assert_in_range(parent[axis], 0, layout.levels[level + 1].bricks[axis] - 1);
		}
	}
}

static void largest_volume_fits_the_levels(void **state)
{
	(void)state;
	static const struct {
		int dims[3];
		double spacing[3];
	} cases[] = {
		{ { 16384, 16384, 16384 }, { 1, 1, 1 } },
		{ { 16384, 1, 16384 }, { 4, 1e-3, 1 } },
		{ { 65, 16384, 1 }, { 1000, 1, 1 } },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct gz_brick_layout layout;
		gz_brick_layout_make(cases[i].dims, cases[i].spacing, &layout);
		const struct gz_brick_level *last = &layout.levels[layout.level_count - 1];
		assert_int_equal(last->bricks[0] * last->bricks[1] * last->bricks[2], 1);
		assert_int_equal(last->first + 1, layout.brick_count);
	}
}

TEST_SUITE(brick_file)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_written_is_read_level_by_level),
		cmocka_unit_test(same_volume_makes_the_same_file),
		cmocka_unit_test(one_value_takes_no_bricks_on_disk),
		cmocka_unit_test(stopped_and_failed_writing_leaves_nothing),
		cmocka_unit_test(damaged_files_are_refused_with_a_line),
		cmocka_unit_test(what_is_no_file_is_refused),
		cmocka_unit_test(damaged_brick_is_told_from_a_good_one),
		cmocka_unit_test(parents_and_children_agree),
		cmocka_unit_test(largest_volume_fits_the_levels),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
