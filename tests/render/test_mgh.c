/* MGH and MGZ: header, types, orientation, and what is refused. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/captured_log.h"
#include "render/data/format.h"
#include "volume_files.h"

enum { HEADER = 284, COUNT = 12 };

/* What a test's header says. */
struct mgh_sample {
	int32_t dims[4];
	int32_t type;
	int16_t good_ras;
	float spacing[3];
	float directions[9];
};

/* 3 x 2 x 2 unsigned bytes of 1 mm, straight in RAS. */
static struct mgh_sample mgh_sample_make(void)
{
	return (struct mgh_sample) {
		.dims = { 3, 2, 2, 1 },
		.good_ras = 1,
		.spacing = { 1, 1, 1 },
		.directions = { 1, 0, 0, 0, 1, 0, 0, 0, 1 },
	};
}

/* Most significant byte first. */
static void put_big(uint8_t *out, uint32_t bits, size_t size)
{
	for (size_t i = 0; i < size; i++)
		out[i] = (uint8_t)(bits >> 8 * (size - 1 - i));
}

static void put_real(uint8_t *out, float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof bits);
	put_big(out, bits, 4);
}

static void mgh_sample_bytes(const struct mgh_sample *sample, uint8_t out[HEADER])
{
	memset(out, 0, HEADER);
	put_big(out, 1, 4);
	for (size_t i = 0; i < 4; i++)
		put_big(out + 4 + 4 * i, (uint32_t)sample->dims[i], 4);
	put_big(out + 20, (uint32_t)sample->type, 4);
	put_big(out + 28, (uint16_t)sample->good_ras, 2);
	for (size_t i = 0; i < 3; i++)
		put_real(out + 30 + 4 * i, sample->spacing[i]);
	for (size_t i = 0; i < 9; i++)
		put_real(out + 42 + 4 * i, sample->directions[i]);
}

/* Voxel (x, y, z) is 100 z + 10 y + x. */
static const uint8_t voxels[COUNT] = { 0, 1, 2, 10, 11, 12, 100, 101, 102, 110, 111, 112 };

static const char *write_mgh(const char *name, const struct mgh_sample *sample, const void *data,
			     size_t size)
{
	uint8_t bytes[HEADER + 128], packed[1024];
	mgh_sample_bytes(sample, bytes);
	memcpy(bytes + HEADER, data, size);
	if (!strstr(name, ".mgz") && !strstr(name, ".gz"))
		return files_write(name, bytes, HEADER + size);
	return files_write(name, packed,
			   files_deflate(bytes, HEADER + size, 31, packed, sizeof packed));
}

static struct gz_volume load_mgh_file(const char *path, int messages)
{
	struct captured_log log;
	struct gz_volume v = { 0 };
	captured_log_init(&log, "*:info");
	if (gz_volume_load(path, NULL, NULL, &log.log, &v) != GZ_OK || log.messages != messages)
		fail_msg("%s: %d messages, %s", path, log.messages, log.last);
	return v;
}

static double mgh_value(const struct gz_volume *v, size_t index)
{
	return v->slope * gz_voxel_stored(v->type, v->voxels, index) + v->intercept;
}

static void plain_and_compressed_are_the_same(void **state)
{
	(void)state;
	static const char *const names[] = { "a.mgh", "a.mgz", "a.mgh.gz", "a" };
	const struct mgh_sample sample = mgh_sample_make();
	for (size_t i = 0; i < 4; i++) {
		struct gz_volume v = load_mgh_file(write_mgh(names[i], &sample, voxels, COUNT), 0);
		assert_true(v.oriented);
		assert_memory_equal(v.voxels, voxels, COUNT);
		gz_volume_free(&v);
	}
}

static void every_type_keeps_its_values(void **state)
{
	(void)state;
	static const struct {
		int32_t type;
		size_t size;
		enum gz_voxel_type stored;
		uint32_t bits[2];
		double values[2];
	} rows[] = {
		{ 0, 1, GZ_VOXEL_U8, { 7, 255 }, { 7, 255 } },
		{ 1, 4, GZ_VOXEL_F32, { 0xFFFFFFFE, 70000 }, { -2, 70000 } },
		{ 3, 4, GZ_VOXEL_F32, { 0x3FC00000, 0xC0000000 }, { 1.5, -2 } },
		{ 4, 2, GZ_VOXEL_U16, { 0x8000, 0x0102 }, { -32768, 258 } },
		{ 10, 2, GZ_VOXEL_U16, { 0xFFFF, 0x0102 }, { 65535, 258 } },
	};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		uint8_t data[8];
		struct mgh_sample sample = mgh_sample_make();
		sample.dims[0] = 2;
		sample.dims[1] = sample.dims[2] = 1;
		sample.type = rows[i].type;
		for (size_t k = 0; k < 2; k++)
			put_big(data + k * rows[i].size, rows[i].bits[k], rows[i].size);
		struct gz_volume v =
			load_mgh_file(write_mgh("t.mgh", &sample, data, 2 * rows[i].size), 0);
		assert_int_equal(v.type, rows[i].stored);
		for (size_t k = 0; k < 2; k++)
			if (mgh_value(&v, k) != rows[i].values[k])
				fail_msg("type %d: %g", rows[i].type, mgh_value(&v, k));
		gz_volume_free(&v);
	}
}

/* Coronal as FreeSurfer conforms its volumes: to the left, down, to the front. */
static void directions_turn_to_right_anterior_superior(void **state)
{
	(void)state;
	static const float coronal[9] = { -1, 0, 0, 0, 0, -1, 0, 1, 0 };
	struct mgh_sample sample = mgh_sample_make();
	memcpy(sample.directions, coronal, sizeof coronal);
	sample.spacing[0] = 2;
	sample.spacing[1] = 3;
	sample.spacing[2] = 4;
	struct gz_volume v = load_mgh_file(write_mgh("c.mgh", &sample, voxels, COUNT), 0);
	assert_true(v.dims[0] == 3 && v.dims[1] == 2 && v.dims[2] == 2);
	assert_true(v.spacing[0] == 2 && v.spacing[1] == 4 && v.spacing[2] == 3);
	assert_true(mgh_value(&v, 0) == 12); /* right, lower, back: (2, 1, 0) */
	assert_true(mgh_value(&v, 3) == 112);
	gz_volume_free(&v);
}

static void header_without_orientation_is_coronal_and_says_so(void **state)
{
	(void)state;
	struct mgh_sample sample = mgh_sample_make();
	sample.good_ras = 0;
	sample.spacing[0] = -7; /* not looked at */
	struct gz_volume v = load_mgh_file(write_mgh("n.mgh", &sample, voxels, COUNT), 1);
	assert_true(v.oriented && v.spacing[0] == 1);
	assert_true(mgh_value(&v, 0) == 12);
	gz_volume_free(&v);
}

static void frames_are_time_points(void **state)
{
	(void)state;
	uint8_t twice[2 * COUNT];
	struct mgh_sample sample = mgh_sample_make();
	memcpy(twice, voxels, COUNT);
	memset(twice + COUNT, 99, COUNT);
	sample.dims[3] = 2;
	const char *path = write_mgh("f.mgz", &sample, twice, sizeof twice);
	struct gz_volume v = load_mgh_file(path, 0);
	assert_memory_equal(v.voxels, voxels, COUNT);
	assert_int_equal(v.time_points, 2);
	assert_true(v.stored_max == 112);
	gz_volume_free(&v);
	const struct gz_loading second = { .time_point = 1 };
	assert_int_equal(gz_volume_load(path, NULL, &second, NULL, &v), GZ_OK);
	assert_memory_equal(v.voxels, twice + COUNT, COUNT);
	assert_true(v.stored_min == 0 && v.stored_max == 112);
	gz_volume_free(&v);
}

static void tags_behind_the_voxels_are_passed_over(void **state)
{
	(void)state;
	uint8_t longer[COUNT + 40] = { 0 };
	const struct mgh_sample sample = mgh_sample_make();
	memcpy(longer, voxels, COUNT);
	struct gz_volume v = load_mgh_file(write_mgh("g.mgh", &sample, longer, sizeof longer), 0);
	assert_memory_equal(v.voxels, voxels, COUNT);
	gz_volume_free(&v);
}

static void check_refused_mgh(const struct mgh_sample *sample, enum gz_result expected,
			      const char *words)
{
	struct captured_log log;
	struct gz_volume v = { 0 };
	captured_log_init(&log, "*:error");
	const char *path = write_mgh("r.mgh", sample, voxels, COUNT);
	const enum gz_result result = gz_volume_load(path, NULL, NULL, &log.log, &v);
	if (result != expected || log.messages != 1 || !strstr(log.last, words))
		fail_msg("result %d, \"%s\" lacks \"%s\"", result, log.last, words);
}

static void headers_that_are_wrong_are_refused(void **state)
{
	(void)state;
	const struct mgh_sample good = mgh_sample_make();
	struct mgh_sample s = good;
	s.dims[0] = 0;
	check_refused_mgh(&s, GZ_ERR_FORMAT, "0 voxels along axis 1");
	s = good;
	s.dims[2] = 20000;
	check_refused_mgh(&s, GZ_ERR_FORMAT, "20000 voxels along axis 3");
	s = good;
	s.dims[2] = 16384;
	check_refused_mgh(&s, GZ_ERR_FORMAT, "truncated");
	s = good;
	s.dims[3] = 0;
	check_refused_mgh(&s, GZ_ERR_FORMAT, "0 frames");
	s = good;
	s.type = 5;
	check_refused_mgh(&s, GZ_ERR_UNSUPPORTED, "voxels of type 5 are not read");
	s = good;
	s.spacing[1] = 0;
	check_refused_mgh(&s, GZ_ERR_FORMAT, "spacing 0 along axis 2");
	s.spacing[1] = NAN;
	check_refused_mgh(&s, GZ_ERR_FORMAT, "along axis 2; it must be above 0");
	s = good;
	s.directions[0] = 0;
	check_refused_mgh(&s, GZ_ERR_FORMAT, "do not span space");
	struct captured_log log;
	struct gz_volume v = { 0 };
	captured_log_init(&log, "*:error");
	assert_int_equal(
		gz_volume_load(files_write("s.mgh", "\0\0\0\1", 4), NULL, NULL, &log.log, &v),
		GZ_ERR_FORMAT);
	assert_non_null(strstr(log.last, "shorter than an MGH header"));
	uint8_t zeros[HEADER] = { 0 };
	assert_int_equal(
		gz_volume_load(files_write("z.mgh", zeros, HEADER), NULL, NULL, &log.log, &v),
		GZ_ERR_FORMAT);
	assert_non_null(strstr(log.last, "no MGH header of version 1"));
}

static void header_with_any_byte_changed_is_read_or_refused(void **state)
{
	(void)state;
	const struct mgh_sample sample = mgh_sample_make();
	static const uint8_t changes[] = { 0x01, 0x80, 0xff };
	for (size_t at = 0; at < 90; at++) {
		for (size_t c = 0; c < sizeof changes; c++) {
			uint8_t bytes[HEADER + COUNT];
			struct gz_volume v = { 0 };
			mgh_sample_bytes(&sample, bytes);
			memcpy(bytes + HEADER, voxels, COUNT);
			bytes[at] ^= changes[c];
			if (gz_volume_load(files_write("m.mgh", bytes, sizeof bytes), NULL, NULL,
					   NULL, &v) != GZ_OK)
				continue;
			assert_true(gz_volume_voxel_count(&v) <= COUNT);
			assert_true(v.spacing[0] > 0 && v.spacing[1] > 0 && v.spacing[2] > 0);
			gz_volume_free(&v);
		}
	}
}

TEST_SUITE(mgh)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(plain_and_compressed_are_the_same),
		cmocka_unit_test(every_type_keeps_its_values),
		cmocka_unit_test(directions_turn_to_right_anterior_superior),
		cmocka_unit_test(header_without_orientation_is_coronal_and_says_so),
		cmocka_unit_test(frames_are_time_points),
		cmocka_unit_test(tags_behind_the_voxels_are_passed_over),
		cmocka_unit_test(headers_that_are_wrong_are_refused),
		cmocka_unit_test(header_with_any_byte_changed_is_read_or_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
