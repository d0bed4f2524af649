/* Volumes of 3 x 2 x 2 voxels whose value tells where they come from: each format, type, byte order
 * and orientation. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zstd.h>

#include "base/captured_log.h"
#include "render/data/volume.h"
#include "volume_files.h"

#define X     3
#define Y     2
#define Z     2
#define COUNT 12

/* Voxel (x, y, z) of the file is 100 z + 10 y + x. */
static const uint8_t voxels[COUNT] = { 0, 1, 2, 10, 11, 12, 100, 101, 102, 110, 111, 112 };

static const struct gz_raw_layout raw_u8 = { .dims = { X, Y, Z }, .spacing = { 1, 2, 3 } };

static struct gz_volume loaded(const char *path, const struct gz_raw_layout *raw)
{
	struct gz_volume volume = { 0 };
	struct captured_log log;
	captured_log_init(&log, "*:warn");
	if (gz_volume_load(path, raw, NULL, &log.log, &volume) != GZ_OK)
		fail_msg("refused: %s", log.last);
	if (log.messages != 0)
		fail_msg("not silent: %s", log.last);
	return volume;
}

static double value_at(const struct gz_volume *v, int x, int y, int z)
{
	size_t i = ((size_t)z * (size_t)v->dims[1] + (size_t)y) * (size_t)v->dims[0] + (size_t)x;
	double stored = v->type == GZ_VOXEL_U8    ? ((uint8_t *)v->voxels)[i]
			: v->type == GZ_VOXEL_U16 ? ((uint16_t *)v->voxels)[i]
						  : (double)((float *)v->voxels)[i];
	return v->slope * stored + v->intercept;
}

/* Check each voxel of the volume against the one of the file that `axes` puts there: for each world
 * axis the file's axis, 1 to 3, negative if reversed. */
static void check_turned(struct gz_volume *v, const int axes[3])
{
	static const int dims[3] = { X, Y, Z };
	for (int i = 0; i < 3; i++)
		assert_int_equal(v->dims[i], dims[abs(axes[i]) - 1]);
	for (int z = 0; z < v->dims[2]; z++) {
		for (int y = 0; y < v->dims[1]; y++) {
			for (int x = 0; x < v->dims[0]; x++) {
				int world[3] = { x, y, z }, at[3];
				for (int i = 0; i < 3; i++)
					at[abs(axes[i]) - 1] =
						axes[i] > 0 ? world[i] : v->dims[i] - 1 - world[i];
				assert_int_equal((int)value_at(v, x, y, z),
						 100 * at[2] + 10 * at[1] + at[0]);
			}
		}
	}
	gz_volume_free(v);
}

static void check_straight(struct gz_volume *v)
{
	check_turned(v, (const int[3]) { 1, 2, 3 });
}

static void raw_plain_gzip_and_zstd_are_the_same(void **state)
{
	(void)state;
	uint8_t packed[256];
	size_t size = files_deflate(voxels, COUNT, 31, packed, sizeof packed);
	struct gz_volume v = loaded(files_write("a.raw.gz", packed, size), &raw_u8);
	assert_true(v.spacing[0] == 1 && v.spacing[1] == 2 && v.spacing[2] == 3);
	assert_false(v.oriented);
	assert_true(v.stored_min == 0 && v.stored_max == 112);
	check_straight(&v);
	size = ZSTD_compress(packed, sizeof packed, voxels, COUNT, 3);
	v = loaded(files_write("a.raw.zst", packed, size), &raw_u8);
	check_straight(&v);
	v = loaded(files_write("A.RAW", voxels, COUNT), &raw_u8);
	check_straight(&v);
}

static void gzip_members_and_zstd_frames_are_joined(void **state)
{
	(void)state;
	uint8_t packed[512];
	size_t size = files_deflate(voxels, 5, 31, packed, 256);
	size += files_deflate(voxels + 5, 7, 31, packed + size, 256);
	struct gz_volume v = loaded(files_write("m.raw.gz", packed, size), &raw_u8);
	check_straight(&v);
	size = ZSTD_compress(packed, 256, voxels, 5, 3);
	size += ZSTD_compress(packed + size, 256, voxels + 5, 7, 3);
	v = loaded(files_write("m.raw.zst", packed, size), &raw_u8);
	check_straight(&v);
}

/* Larger than every buffer between file and volume. */
static void large_compressed_volume_is_read_whole(void **state)
{
	(void)state;
	const size_t count = 200 * 100 * 60;
	const struct gz_raw_layout raw = { .dims = { 200, 100, 60 },
					   .type = GZ_RAW_UINT16,
					   .spacing = { 1, 1, 1 } };
	uint16_t *numbers = malloc(2 * count);
	uint8_t *packed = malloc(3 * count);
	for (size_t i = 0; i < count; i++)
		numbers[i] = (uint16_t)(i * i >> 3);
	for (int zstd = 0; zstd < 2; zstd++) {
		size_t size = zstd ? ZSTD_compress(packed, 3 * count, numbers, 2 * count, 1)
				   : files_deflate(numbers, 2 * count, 31, packed, 3 * count);
		const char *name = zstd ? "l.raw.zst" : "l.raw.gz";
		struct gz_volume v = loaded(files_write(name, packed, size), &raw);
		assert_memory_equal(v.voxels, numbers, 2 * count);
		gz_volume_free(&v);
	}
	free(numbers);
	free(packed);
}

static void put_number(uint8_t *out, double value, enum gz_raw_type type, bool big_endian)
{
	union {
		int8_t i8;
		uint16_t u16;
		int16_t i16;
		uint32_t u32;
		int32_t i32;
		float f32;
		double f64;
		uint8_t bytes[8];
	} u = { .f64 = 0 };
	static const size_t sizes[] = { 1, 1, 2, 2, 4, 4, 4, 8 };
	switch (type) {
	case GZ_RAW_UINT8:
		u.bytes[0] = (uint8_t)value;
		break;
	case GZ_RAW_INT8:
		u.i8 = (int8_t)value;
		break;
	case GZ_RAW_UINT16:
		u.u16 = (uint16_t)value;
		break;
	case GZ_RAW_INT16:
		u.i16 = (int16_t)value;
		break;
	case GZ_RAW_UINT32:
		u.u32 = (uint32_t)value;
		break;
	case GZ_RAW_INT32:
		u.i32 = (int32_t)value;
		break;
	case GZ_RAW_FLOAT32:
		u.f32 = (float)value;
		break;
	default:
		u.f64 = value;
		break;
	}
	for (size_t i = 0; i < sizes[type]; i++)
		out[i] = u.bytes[big_endian ? sizes[type] - 1 - i : i];
}

static void every_type_keeps_its_values_in_both_byte_orders(void **state)
{
	(void)state;
	static const struct {
		enum gz_raw_type type;
		enum gz_voxel_type stored;
		size_t size;
		double values[3];
	} cases[GZ_RAW_TYPE_COUNT] = {
		{ GZ_RAW_UINT8, GZ_VOXEL_U8, 1, { 0, 255, 17 } },
		{ GZ_RAW_INT8, GZ_VOXEL_U8, 1, { -128, 127, -1 } },
		{ GZ_RAW_UINT16, GZ_VOXEL_U16, 2, { 0, 65535, 258 } },
		{ GZ_RAW_INT16, GZ_VOXEL_U16, 2, { -32768, 32767, -2 } },
		{ GZ_RAW_UINT32, GZ_VOXEL_F32, 4, { 0, 16777216, 4294967296.0 - 256 } },
		{ GZ_RAW_INT32, GZ_VOXEL_F32, 4, { -2147483648.0, 16909060, -3 } },
		{ GZ_RAW_FLOAT32, GZ_VOXEL_F32, 4, { -1.5, 0x1p100, 0.125 } },
		{ GZ_RAW_FLOAT64, GZ_VOXEL_F32, 8, { -1.5, 1024.0625, 1e-3f } },
	};
	for (size_t i = 0; i < 2 * GZ_RAW_TYPE_COUNT; i++) {
		size_t k = i / 2;
		uint8_t bytes[24];
		struct gz_raw_layout raw = { .dims = { 3, 1, 1 },
					     .type = cases[k].type,
					     .big_endian = i % 2 == 1,
					     .spacing = { 1, 1, 1 } };
		for (size_t j = 0; j < 3; j++)
			put_number(bytes + j * cases[k].size, cases[k].values[j], raw.type,
				   raw.big_endian);
		struct gz_volume v = loaded(files_write("t.raw", bytes, 3 * cases[k].size), &raw);
		assert_int_equal(v.type, cases[k].stored);
		for (int j = 0; j < 3; j++)
			if (value_at(&v, j, 0, 0) != cases[k].values[j])
				fail_msg("%s: %g read as %g", gz_raw_type_names[raw.type],
					 cases[k].values[j], value_at(&v, j, 0, 0));
		gz_volume_free(&v);
	}
}

static void what_is_not_finite_becomes_the_least_with_one_warning(void **state)
{
	(void)state;
	const float bad[] = { 3, NAN, -2, INFINITY, -INFINITY, 7 };
	const double wide[] = { 3, -1e300, -2, 1e300, 5, 7 };
	struct gz_raw_layout raw = { .dims = { 6, 1, 1 },
				     .type = GZ_RAW_FLOAT32,
				     .spacing = { 1, 1, 1 } };
	struct captured_log log;
	struct gz_volume v;
	captured_log_init(&log, NULL);
	assert_int_equal(
		gz_volume_load(files_write("n.raw", bad, sizeof bad), &raw, NULL, &log.log, &v),
		GZ_OK);
	assert_int_equal(log.messages, 1);
	assert_non_null(strstr(log.last, "3 values are NaN or infinite"));
	static const double expected[] = { 3, -2, -2, -2, -2, 7 };
	for (int i = 0; i < 6; i++)
		assert_true(value_at(&v, i, 0, 0) == expected[i]);
	assert_true(v.stored_min == -2 && v.stored_max == 7);
	gz_volume_free(&v);
	raw.type = GZ_RAW_FLOAT64;
	assert_int_equal(
		gz_volume_load(files_write("w.raw", wide, sizeof wide), &raw, NULL, NULL, &v),
		GZ_OK);
	assert_true(value_at(&v, 1, 0, 0) == -2 && value_at(&v, 3, 0, 0) == -2);
	gz_volume_free(&v);
}

/* Integers of 32 bits as a series of two time points, 4 numbers each; `swapped` is big-endian. */
static const char *write_whole_numbers(const int64_t numbers[8], bool is_signed, bool swapped)
{
	uint8_t file[352 + 32];
	struct nifti_sample sample = nifti_sample_make(2, 2, 1);
	sample.dim[0] = 4;
	sample.dim[4] = 2;
	sample.datatype = is_signed ? 8 : 768;
	sample.bitpix = 32;
	sample.swapped = swapped;
	nifti_sample_bytes(&sample, file);
	for (int i = 0; i < 8; i++)
		for (int k = 0; k < 4; k++)
			file[352 + 4 * i + (swapped ? 3 - k : k)] =
				(uint8_t)((uint64_t)numbers[i] >> 8 * k);
	return files_write("whole.nii", file, sizeof file);
}

static void check_whole_numbers(const char *path, int point, const double *range,
				const int64_t numbers[8], double worst)
{
	const struct gz_loading loading = { .time_point = point, .number_range = range };
	struct captured_log log;
	struct gz_volume v;
	captured_log_init(&log, "*:warn");
	assert_int_equal(gz_volume_load(path, NULL, &loading, &log.log, &v), GZ_OK);
	for (int i = 0; i < 4; i++) {
		const double wanted = (double)numbers[4 * point + i];
		const double value =
			v.slope * gz_voxel_stored(v.type, v.voxels, (size_t)i) + v.intercept;
		if (fabs(value - wanted) > worst)
			fail_msg("point %d, voxel %d: %.0f, not %.0f", point, i, value, wanted);
		assert_true(value >= v.slope * v.stored_min + v.intercept);
		assert_true(value <= v.slope * v.stored_max + v.intercept);
	}
	assert_int_equal(log.messages, worst > 0 && !range ? 1 : 0);
	if (log.messages)
		assert_non_null(strstr(log.last, "they are rounded, by up to"));
	gz_volume_free(&v);
}

/* Beyond 2^24 a float skips integers. Time points share the offset, whether the range is known or
 * not. */
static void integers_of_32_bits_are_exact_or_told_to_be_rounded(void **state)
{
	(void)state;
	enum { P26 = 1 << 26, P30 = 1 << 30 };
	static const struct {
		int64_t numbers[8];
		bool is_unsigned;
		double worst; /* 0: exact */
	} rows[] = {
		{ { P26, P26 + 1, P26 + 2, P26 + 3, P26 + 999, P26 + 998, P26, P26 + 1 },
		  false,
		  0 },
		{ { P30 + 5, P30, P30 + 1, P30 + 189, P30 + 188, P30, P30 + 7, P30 + 3 },
		  false,
		  0 },
		{ { -P30 - 5, -P30 - 1, -P30, -P30, -P30 - 3, -P30 - 65535, -P30, -P30 },
		  false,
		  0 },
		/* more than 16 bits, far less than 1/1024 of them */
		{ { P26, P26 + 1, P26 + 70001, P26 + 3, P26 + 5, P26 + 4999999, P26, P26 },
		  false,
		  0 },
		{ { INT32_MIN, INT32_MIN + 1, INT32_MIN, INT32_MIN, INT32_MIN + (1 << 24),
		    INT32_MIN + 77777, INT32_MIN, INT32_MIN },
		  false,
		  0 },
		{ { UINT32_MAX, UINT32_MAX - 1, UINT32_MAX - 2, UINT32_MAX - 3, UINT32_MAX - 4,
		    UINT32_MAX - 70001, UINT32_MAX, UINT32_MAX },
		  true,
		  0 },
		{ { 7, 7, 7, 7, 7, 7, 7, 7 }, false, 0 },
		{ { P26 + 1, P26 + 1, P26 + 1, P26 + 1, P26 + 1, P26 + 1, P26 + 1, P26 + 1 },
		  false,
		  0 },
		{ { 0, 1, 2, P26 + 1, 0, 1, P26 + 3, P26 + 7 }, false, 4 },
		{ { 0, UINT32_MAX, 1, 2, 0, 1, 2, UINT32_MAX - 1 }, true, 128 },
	};
	for (size_t i = 0; i < 2 * sizeof rows / sizeof rows[0]; i++) {
		const int64_t *numbers = rows[i / 2].numbers;
		struct gz_volume first;
		const char *path =
			write_whole_numbers(numbers, !rows[i / 2].is_unsigned, i % 2 == 1);
		assert_int_equal(gz_volume_load(path, NULL, NULL, NULL, &first), GZ_OK);
		for (int point = 0; point < 2; point++) {
			check_whole_numbers(path, point, NULL, numbers, rows[i / 2].worst);
			check_whole_numbers(path, point, first.number_range, numbers,
					    rows[i / 2].worst);
		}
		gz_volume_free(&first);
	}
}

static void check_scaled(enum gz_voxel_type type, const struct gz_volume *v,
			 const double expected[4])
{
	assert_int_equal(v->type, type);
	for (int i = 0; i < 4; i++)
		if (fabs(value_at(v, i, 0, 0) - expected[i]) > 1e-6 * fabs(expected[i]))
			fail_msg("voxel %d is %g, expected %g", i, value_at(v, i, 0, 0),
				 expected[i]);
	assert_true(isfinite((float)(v->slope * v->stored_min + v->intercept)));
	assert_true(isfinite((float)(v->slope * v->stored_max + v->intercept)));
}

/* Values that the header scales beyond the range of float, of each type of voxels. */
static void values_that_scaling_overflows_become_the_least_with_one_warning(void **state)
{
	(void)state;
	static const uint8_t bytes[4] = { 3, 255, 1, 2 };
	static const uint16_t words[4] = { 3, 65535, 1, 2 };
	static const float reals[4] = { 3, 1e30f, 1, -1e30f };
	static const struct {
		const void *voxels;
		size_t size;
		int16_t datatype;
		enum gz_voxel_type type;
		float slope;
		double expected[4];
		const char *told;
	} cases[] = {
		{ bytes, 1, 2, GZ_VOXEL_U8, 1e38f, { 3e38, 1e38, 1e38, 2e38 }, "1 value is" },
		{ words, 2, 512, GZ_VOXEL_U16, 1e38f, { 3e38, 1e38, 1e38, 2e38 }, "1 value is" },
		{ reals, 4, 16, GZ_VOXEL_F32, 1e38f, { 3e38, 1e38, 1e38, 1e38 }, "2 values are" },
		/* the least value is of the greatest number */
		{ bytes, 1, 2, GZ_VOXEL_U8, -1e38f, { -3e38, -3e38, -1e38, -2e38 }, "1 value is" },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct nifti_sample sample = nifti_sample_make(4, 1, 1);
		struct captured_log log;
		struct gz_volume v;
		uint8_t file[352 + 16];
		sample.datatype = cases[i].datatype;
		sample.bitpix = (int16_t)(8 * cases[i].size);
		sample.slope = cases[i].slope;
		nifti_sample_bytes(&sample, file);
		memcpy(file + 352, cases[i].voxels, 4 * cases[i].size);
		captured_log_init(&log, "*:warn");
		assert_int_equal(gz_volume_load(files_write("i.nii", file, 352 + 4 * cases[i].size),
						NULL, NULL, &log.log, &v),
				 GZ_OK);
		assert_int_equal(log.messages, 1);
		assert_non_null(strstr(log.last, cases[i].told));
		check_scaled(cases[i].type, &v, cases[i].expected);
		gz_volume_free(&v);
	}
}

static void trailing_data_are_left_out_with_a_warning(void **state)
{
	(void)state;
	uint8_t longer[COUNT + 3] = { 0 };
	memcpy(longer, voxels, COUNT);
	struct captured_log log;
	struct gz_volume v;
	captured_log_init(&log, NULL);
	assert_int_equal(gz_volume_load(files_write("l.raw", longer, sizeof longer), &raw_u8, NULL,
					&log.log, &v),
			 GZ_OK);
	assert_int_equal(log.level, GZ_LOG_WARN);
	assert_non_null(strstr(log.last, "more data after the last voxel"));
	check_straight(&v);
}

static const char *nifti_write(const char *name, const struct nifti_sample *sample)
{
	uint8_t bytes[352 + COUNT], packed[1024];
	nifti_sample_bytes(sample, bytes);
	memcpy(bytes + 352, voxels, COUNT);
	if (!strstr(name, ".gz"))
		return files_write(name, bytes, sizeof bytes);
	size_t size = files_deflate(bytes, sizeof bytes, 31, packed, sizeof packed);
	return files_write(name, packed, size);
}

static void nifti_without_orientation_is_as_stored(void **state)
{
	(void)state;
	struct nifti_sample sample = nifti_sample_make(X, Y, Z);
	sample.pixdim[1] = 0.5f;
	for (int i = 0; i < 4; i++) {
		sample.swapped = i % 2 == 1;
		struct gz_volume v =
			loaded(nifti_write(i < 2 ? "a.nii" : "a.nii.gz", &sample), NULL);
		assert_true(v.spacing[0] == 0.5 && v.spacing[1] == 1);
		assert_false(v.oriented);
		check_straight(&v);
	}
}

static void nifti_scaling_is_kept_unless_its_slope_is_zero_or_nan(void **state)
{
	(void)state;
	static const float slopes[] = { 0.5f, -2, 0, NAN };
	for (int i = 0; i < 4; i++) {
		struct nifti_sample sample = nifti_sample_make(X, Y, Z);
		sample.slope = slopes[i];
		sample.intercept = 10;
		struct gz_volume v = loaded(nifti_write("s.nii", &sample), NULL);
		double expected = i < 2 ? (double)slopes[i] * 112 + 10 : 112;
		assert_true(value_at(&v, 2, 1, 1) == expected);
		gz_volume_free(&v);
	}
}

/* Rows of the matrix are right, anterior, superior; columns the axes of the file. */
static void nifti_sform_turns_to_right_anterior_superior(void **state)
{
	(void)state;
	static const struct {
		float rows[3][3];
		int axes[3];
		double spacing[3];
	} cases[] = {
		{ { { 2, 0, 0 }, { 0, 3, 0 }, { 0, 0, 4 } }, { 1, 2, 3 }, { 2, 3, 4 } },
		{ { { -2, 0, 0 }, { 0, 3, 0 }, { 0, 0, 4 } }, { -1, 2, 3 }, { 2, 3, 4 } },
		{ { { -2, 0, 0 }, { 0, -3, 0 }, { 0, 0, -4 } }, { -1, -2, -3 }, { 2, 3, 4 } },
		/* sagittal: anterior to posterior, superior to inferior, left to right */
		{ { { 0, 0, 4 }, { -2, 0, 0 }, { 0, -3, 0 } }, { 3, -1, -2 }, { 4, 2, 3 } },
		{ { { 0, 3, 0 }, { 0, 0, -4 }, { 2, 0, 0 } }, { 2, -3, 1 }, { 3, 4, 2 } },
		/* oblique by 20 degrees about z */
		{ { { 0.94f, -0.342f, 0 }, { 0.342f, 0.94f, 0 }, { 0, 0, 1 } },
		  { 1, 2, 3 },
		  { 1, 1, 1 } },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct nifti_sample sample = nifti_sample_make(X, Y, Z);
		sample.sform_code = 1;
		sample.qform_code = 1; /* sform goes first */
		for (int row = 0; row < 3; row++)
			memcpy(sample.srow[row], cases[i].rows[row], sizeof cases[i].rows[row]);
		struct gz_volume v = loaded(nifti_write("o.nii", &sample), NULL);
		assert_true(v.oriented);
		for (int axis = 0; axis < 3; axis++)
			assert_float_equal((float)v.spacing[axis], (float)cases[i].spacing[axis],
					   1e-3f);
		check_turned(&v, cases[i].axes);
	}
}

/* Quaternion (0, 0, 1): half a turn about z. qfac -1 reverses the third axis. */
static void nifti_qform_is_used_without_sform(void **state)
{
	(void)state;
	struct nifti_sample sample = nifti_sample_make(X, Y, Z);
	sample.qform_code = 1;
	sample.quatern[2] = 1;
	sample.pixdim[3] = 2.5f;
	struct gz_volume v = loaded(nifti_write("q.nii", &sample), NULL);
	assert_true(v.spacing[2] == 2.5);
	check_turned(&v, (const int[3]) { -1, -2, 3 });
	sample.pixdim[0] = -1;
	v = loaded(nifti_write("q.nii", &sample), NULL);
	check_turned(&v, (const int[3]) { -1, -2, -3 });
}

static void nifti_series_of_several_axes_gives_its_first_volume_and_says_so(void **state)
{
	(void)state;
	struct nifti_sample sample = nifti_sample_make(X, Y, 1);
	struct captured_log log;
	struct gz_volume v;
	sample.dim[0] = 5;
	sample.dim[4] = 1;
	sample.dim[5] = 2;
	captured_log_init(&log, NULL);
	assert_int_equal(gz_volume_load(nifti_write("4.nii", &sample), NULL, NULL, &log.log, &v),
			 GZ_OK);
	assert_int_equal(log.messages, 1);
	assert_non_null(strstr(log.last, "only its first part is shown"));
	assert_int_equal((int)value_at(&v, 2, 1, 0), 12);
	gz_volume_free(&v);
}

/* Also where a thread decodes ahead. */
static void damage_behind_the_first_volume_of_a_series_leaves_the_first(void **state)
{
	(void)state;
	enum { SIDE = 128, BYTES = SIDE * SIDE * SIDE };
	struct nifti_sample sample = nifti_sample_make(SIDE, SIDE, SIDE);
	sample.dim[0] = 4;
	sample.dim[4] = 2;
	uint8_t *plain = malloc(352 + 2 * BYTES), *packed = malloc(352 + 3 * BYTES);
	struct captured_log log;
	struct gz_volume v;
	nifti_sample_bytes(&sample, plain);
	for (size_t i = 0; i < 2 * BYTES; i++)
		plain[352 + i] = (uint8_t)(i * i >> 5);
	const size_t size =
		files_deflate(plain, 352 + 2 * BYTES, 31, packed, 352 + 3 * (size_t)BYTES);
	const char *path = files_write("series.nii.gz", packed, size - 20);
	captured_log_init(&log, NULL);
	assert_int_equal(gz_volume_load(path, NULL, NULL, &log.log, &v), GZ_OK);
	assert_int_equal(log.messages, 2);
	assert_non_null(strstr(log.last, "of its 2 time points only the first 1 can be read"));
	assert_true(v.time_points <= 1);
	assert_memory_equal(v.voxels, plain + 352, BYTES);
	gz_volume_free(&v);
	free(plain);
	free(packed);
}

#define NRRD_HEAD "NRRD0005\n# comment\ntype: uchar\ndimension: 3\nsizes: 3 2 2\n"

static void nrrd_attached_raw_and_gzip_are_read(void **state)
{
	(void)state;
	uint8_t packed[256];
	size_t size = files_deflate(voxels, COUNT, 31, packed, sizeof packed);
	struct gz_volume v =
		loaded(files_write_text("a.nrrd",
					NRRD_HEAD "spacings: 1 2 3\nkey:=value\ncontent: a: b\n"
						  "encoding: raw\n\n",
					voxels, COUNT),
		       NULL);
	assert_true(v.spacing[2] == 3);
	assert_false(v.oriented);
	check_straight(&v);
	v = loaded(files_write_text("g.nrrd", NRRD_HEAD "encoding: GZip\r\n\r\n", packed, size),
		   NULL);
	check_straight(&v);
}

static void nrrd_detached_skips_lines_and_bytes(void **state)
{
	(void)state;
	files_write_text("d.bin", "one\ntwo\n??", voxels, COUNT);
	struct gz_volume v = loaded(files_write_text("d.nhdr",
						     NRRD_HEAD "encoding: raw\nline skip: 2\n"
							       "byte skip: 2\ndata file: d.bin\n",
						     NULL, 0),
				    NULL);
	check_straight(&v);
	v = loaded(files_write_text("e.nhdr",
				    NRRD_HEAD "encoding: raw\nbyteskip: -1\ndatafile: d.bin\n\n",
				    NULL, 0),
		   NULL);
	check_straight(&v);
}

static void nrrd_spaces_turn_to_right_anterior_superior(void **state)
{
	(void)state;
	static const struct {
		const char *fields;
		int axes[3];
		bool oriented;
	} cases[] = {
		{ "space: RAS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n", { 1, 2, 3 }, true },
		{ "space: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n",
		  { -1, -2, 3 },
		  true },
		{ "space: LAS\nspace directions: (1, 0, 0) (0,1,0) (0,0,-1)\n",
		  { -1, 2, -3 },
		  true },
		{ "space: RAS\nspace directions: (0,0,1) (1,0,0) (0,-1,0)\n", { 2, -3, 1 }, true },
		{ "space dimension: 3\nspace directions: (-1,0,0) (0,1,0) (0,0,1)\n",
		  { -1, 2, 3 },
		  false },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		char head[512];
		snprintf(head, sizeof head, "%s%sencoding: raw\n\n", NRRD_HEAD, cases[i].fields);
		struct gz_volume v = loaded(files_write_text("s.nrrd", head, voxels, COUNT), NULL);
		assert_int_equal(v.oriented, cases[i].oriented);
		check_turned(&v, cases[i].axes);
	}
}

static void nrrd_spacing_is_the_length_of_its_directions(void **state)
{
	(void)state;
	struct gz_volume v = loaded(
		files_write_text("l.nrrd",
				 NRRD_HEAD "space: RAS\nspace directions: (2,0,0) (0,0,3) (0,4,0)\n"
					   "encoding: raw\n\n",
				 voxels, COUNT),
		NULL);
	assert_true(v.spacing[0] == 2 && v.spacing[1] == 4 && v.spacing[2] == 3);
	check_turned(&v, (const int[3]) { 1, 3, 2 });
}

static void nrrd_with_a_leading_axis_of_one_is_a_volume(void **state)
{
	(void)state;
	struct gz_volume v =
		loaded(files_write_text("k.nrrd",
					"NRRD0004\ntype: uint8\ndimension: 4\nsizes: 1 3 2 2\n"
					"spacings: nan 1 1 2\nkinds: list domain domain domain\n"
					"encoding: raw\n\n",
					voxels, COUNT),
		       NULL);
	assert_true(v.spacing[2] == 2);
	check_straight(&v);
}

#define META_HEAD "ObjectType = Image\nNDims = 3\nDimSize = 3 2 2\nElementType = MET_UCHAR\n"

/* ITK shows the first otherwise, so that it is said. */
static void metaimage_letters_that_itk_passes_over_are_told(void **state)
{
	(void)state;
	static const struct {
		const char *tags;
		int messages;
	} rows[] = {
		{ "AnatomicalOrientation = LPI\n", 1 },
		{ "AnatomicalOrientation = RAI\n", 0 },
		{ "AnatomicalOrientation = LPI\nTransformMatrix = 1 0 0 0 1 0 0 0 1\n", 0 },
	};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		char head[512];
		struct captured_log log;
		struct gz_volume v;
		snprintf(head, sizeof head, "%s%sElementDataFile = LOCAL\n", META_HEAD,
			 rows[i].tags);
		captured_log_init(&log, "*:info");
		assert_int_equal(gz_volume_load(files_write_text("l.mha", head, voxels, COUNT),
						NULL, NULL, &log.log, &v),
				 GZ_OK);
		assert_int_equal(log.messages, rows[i].messages);
		if (rows[i].messages)
			assert_non_null(strstr(log.last, "LPI, which ITK passes over"));
		gz_volume_free(&v);
	}
}

/* The file's axes run to left, posterior, superior. */
static const int lps[3] = { -1, -2, 3 };

static void metaimage_local_and_detached_are_read(void **state)
{
	(void)state;
	uint8_t packed[256];
	size_t size = files_deflate(voxels, COUNT, 15, packed, sizeof packed);
	struct gz_volume v = loaded(files_write_text("a.mha",
						     META_HEAD "ElementSpacing = 1 2 3\n"
							       "ElementDataFile = LOCAL\n",
						     voxels, COUNT),
				    NULL);
	assert_true(v.spacing[1] == 2);
	check_turned(&v, lps);
	files_write("a.zraw", packed, size);
	v = loaded(files_write_text("z.mhd",
				    META_HEAD "CompressedData = True\nElementDataFile = a.zraw\n",
				    NULL, 0),
		   NULL);
	check_turned(&v, lps);
	files_write_text("h.raw", "header", voxels, COUNT);
	v = loaded(files_write_text("h.mhd", META_HEAD "HeaderSize = 6\nElementDataFile = h.raw\n",
				    NULL, 0),
		   NULL);
	check_turned(&v, lps);
	v = loaded(files_write_text("m.mhd", META_HEAD "HeaderSize = -1\nElementDataFile = h.raw\n",
				    NULL, 0),
		   NULL);
	check_turned(&v, lps);
}

/* ITK's meaning: the identity in a frame that runs to left, posterior, superior. */
static void metaimage_without_orientation_is_the_identity_and_says_so(void **state)
{
	(void)state;
	static const char *const tags[] = { "", "AnatomicalOrientation = ???\n" };
	for (size_t i = 0; i < 2; i++) {
		char head[512];
		struct captured_log log;
		struct gz_volume v;
		snprintf(head, sizeof head, "%s%sElementDataFile = LOCAL\n", META_HEAD, tags[i]);
		captured_log_init(&log, "*:info");
		assert_int_equal(gz_volume_load(files_write_text("n.mha", head, voxels, COUNT),
						NULL, NULL, &log.log, &v),
				 GZ_OK);
		assert_int_equal(log.messages, 1);
		assert_int_equal(log.level, GZ_LOG_INFO);
		assert_non_null(strstr(log.last, "says nothing of its orientation"));
		assert_true(v.oriented);
		check_turned(&v, lps);
	}
}

static void metaimage_byte_order_is_honoured(void **state)
{
	(void)state;
	static const uint8_t big[4] = { 0x01, 0x02, 0xff, 0xfe };
	struct gz_volume v =
		loaded(files_write_text("b.mha",
					"NDims = 3\nDimSize = 2 1 1\nElementType = MET_SHORT\n"
					"BinaryDataByteOrderMSB = True\nElementDataFile = LOCAL\n",
					big, sizeof big),
		       NULL);
	assert_int_equal((int)value_at(&v, 1, 0, 0), 258);
	assert_int_equal((int)value_at(&v, 0, 0, 0), -2);
	gz_volume_free(&v);
}

static void metaimage_frame_is_left_posterior_superior(void **state)
{
	(void)state;
	static const struct {
		const char *tags;
		int axes[3];
	} cases[] = {
		{ "TransformMatrix = 1 0 0 0 1 0 0 0 1\n", { -1, -2, 3 } },
		{ "TransformMatrix = -1 0 0 0 -1 0 0 0 1\n", { 1, 2, 3 } },
		{ "TransformMatrix = 0 1 0 0 0 -1 1 0 0\n", { -3, -1, -2 } },
		{ "AnatomicalOrientation = RAI\n", { -1, -2, 3 } },
		{ "AnatomicalOrientation = LPI\n", { 1, 2, 3 } },
		{ "AnatomicalOrientation = PSR\n", { -3, 1, -2 } },
		{ "AnatomicalOrientation = LPI\nOrientation = 1 0 0 0 1 0 0 0 1\n", { -1, -2, 3 } },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		char head[512];
		snprintf(head, sizeof head, "%s%sElementDataFile = LOCAL\n", META_HEAD,
			 cases[i].tags);
		struct gz_volume v = loaded(files_write_text("o.mha", head, voxels, COUNT), NULL);
		assert_true(v.oriented);
		check_turned(&v, cases[i].axes);
	}
}

struct told {
	int times;
	double last;
	int stop_at;
};

static bool tell(void *user, double share, const char *what)
{
	struct told *told = user;
	assert_true(share >= told->last && share <= 1);
	assert_non_null(strstr(what, "told.raw"));
	told->last = share;
	return ++told->times != told->stop_at;
}

static void loading_is_told_and_stopped(void **state)
{
	(void)state;
	static uint8_t bytes[64 * 64 * 32];
	static const struct gz_raw_layout raw = { .dims = { 64, 64, 32 }, .spacing = { 1, 1, 1 } };
	const char *path = files_write("told.raw", bytes, sizeof bytes);
	struct told told = { 0 };
	struct gz_loading loading = { .report = tell, .user = &told };
	struct gz_volume v = { 0 };
	assert_int_equal(gz_volume_load(path, &raw, &loading, NULL, &v), GZ_OK);
	assert_true(told.times > 1);
	gz_volume_free(&v);
	told = (struct told) { .stop_at = 2 };
	assert_int_equal(gz_volume_load(path, &raw, &loading, NULL, &v), GZ_ERR_CANCELLED);
	assert_null(v.voxels);
	assert_int_equal(told.times, 2);
}

static void scratch_folder_holds_the_same_voxels(void **state)
{
	(void)state;
	uint8_t bytes[5 * 4 * 3];
	for (size_t i = 0; i < sizeof bytes; i++)
		bytes[i] = (uint8_t)(7 * i);
	static const struct gz_raw_layout raw = { .dims = { 5, 4, 3 }, .spacing = { 1, 1, 1 } };
	const char *path = files_write("s.raw", bytes, sizeof bytes);
	struct gz_loading loading = { .scratch = files_folder() };
	struct gz_volume v = { 0 };
	assert_int_equal(gz_volume_load(path, &raw, &loading, NULL, &v), GZ_OK);
	assert_true(v.mapped > 0);
	assert_memory_equal(v.voxels, bytes, sizeof bytes);
	gz_volume_free(&v);

	struct captured_log log;
	captured_log_init(&log, NULL);
	loading.scratch = "/nowhere/at/all";
	assert_int_equal(gz_volume_load(path, &raw, &loading, &log.log, &v), GZ_ERR_NOT_FOUND);
	assert_int_equal(log.messages, 1);
	assert_non_null(strstr(log.last, "/nowhere/at/all"));
}

TEST_SUITE(volume_load)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(loading_is_told_and_stopped),
		cmocka_unit_test(scratch_folder_holds_the_same_voxels),
		cmocka_unit_test(raw_plain_gzip_and_zstd_are_the_same),
		cmocka_unit_test(gzip_members_and_zstd_frames_are_joined),
		cmocka_unit_test(large_compressed_volume_is_read_whole),
		cmocka_unit_test(every_type_keeps_its_values_in_both_byte_orders),
		cmocka_unit_test(integers_of_32_bits_are_exact_or_told_to_be_rounded),
		cmocka_unit_test(what_is_not_finite_becomes_the_least_with_one_warning),
		cmocka_unit_test(values_that_scaling_overflows_become_the_least_with_one_warning),
		cmocka_unit_test(trailing_data_are_left_out_with_a_warning),
		cmocka_unit_test(nifti_without_orientation_is_as_stored),
		cmocka_unit_test(nifti_scaling_is_kept_unless_its_slope_is_zero_or_nan),
		cmocka_unit_test(nifti_sform_turns_to_right_anterior_superior),
		cmocka_unit_test(nifti_qform_is_used_without_sform),
		cmocka_unit_test(nifti_series_of_several_axes_gives_its_first_volume_and_says_so),
		cmocka_unit_test(damage_behind_the_first_volume_of_a_series_leaves_the_first),
		cmocka_unit_test(nrrd_attached_raw_and_gzip_are_read),
		cmocka_unit_test(nrrd_detached_skips_lines_and_bytes),
		cmocka_unit_test(nrrd_spaces_turn_to_right_anterior_superior),
		cmocka_unit_test(nrrd_spacing_is_the_length_of_its_directions),
		cmocka_unit_test(nrrd_with_a_leading_axis_of_one_is_a_volume),
		cmocka_unit_test(metaimage_local_and_detached_are_read),
		cmocka_unit_test(metaimage_without_orientation_is_the_identity_and_says_so),
		cmocka_unit_test(metaimage_letters_that_itk_passes_over_are_told),
		cmocka_unit_test(metaimage_byte_order_is_honoured),
		cmocka_unit_test(metaimage_frame_is_left_posterior_superior),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
