/* NIfTI-2, pairs of header and voxels, ANALYZE 7.5, and what is compressed by whatever name. */
#include "suite.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zstd.h>

#include "base/captured_log.h"
#include "render/data/volume.h"
#include "volume_files.h"

#define COUNT 12

/* Voxel (x, y, z) of 3 x 2 x 2 is 100 z + 10 y + x. */
static const uint8_t voxels[COUNT] = { 0, 1, 2, 10, 11, 12, 100, 101, 102, 110, 111, 112 };

static void open_quietly(const char *path, struct gz_volume *out)
{
	struct captured_log log;
	captured_log_init(&log, "*:info");
	if (gz_volume_load(path, NULL, NULL, &log.log, out) != GZ_OK || log.messages != 0)
		fail_msg("%s: %s", path, log.last);
}

static void check_refusal(const char *path, enum gz_result expected, const char *words)
{
	struct captured_log log;
	struct gz_volume v = { 0 };
	captured_log_init(&log, "*:error");
	const enum gz_result result = gz_volume_load(path, NULL, NULL, &log.log, &v);
	if (result != expected || log.messages != 1 || !strstr(log.last, words))
		fail_msg("%s: result %d, %d messages, \"%s\" lacks \"%s\"", path, result,
			 log.messages, log.last, words);
	assert_null(v.voxels);
}

static double first_voxel(const struct gz_volume *v)
{
	return v->slope * gz_voxel_stored(v->type, v->voxels, 0) + v->intercept;
}

/* Sagittal: anterior to posterior, superior to inferior, left to right; 2 x 3 x 4 mm, values
 * halved, plus 10. */
static struct nifti_sample sagittal_sample(void)
{
	struct nifti_sample sample = nifti_sample_make(3, 2, 2);
	sample.sform_code = 1;
	sample.srow[0][2] = 4;
	sample.srow[1][0] = -2;
	sample.srow[2][1] = -3;
	sample.slope = 0.5f;
	sample.intercept = 10;
	return sample;
}

static void check_sagittal(struct gz_volume *v)
{
	assert_true(v->oriented);
	assert_true(v->dims[0] == 2 && v->dims[1] == 3 && v->dims[2] == 2);
	assert_true(v->spacing[0] == 4 && v->spacing[1] == 2 && v->spacing[2] == 3);
	/* left, back, below: file voxel (2, 1, 0) */
	assert_true(first_voxel(v) == 0.5 * 12 + 10);
	gz_volume_free(v);
}

static void nifti_2_is_read_in_both_byte_orders(void **state)
{
	(void)state;
	for (int swapped = 0; swapped < 2; swapped++) {
		uint8_t bytes[544 + COUNT];
		struct nifti_sample sample = sagittal_sample();
		struct gz_volume v;
		sample.swapped = swapped == 1;
		nifti2_sample_bytes(&sample, false, bytes);
		memcpy(bytes + 544, voxels, COUNT);
		open_quietly(files_write("two.nii", bytes, sizeof bytes), &v);
		check_sagittal(&v);
	}
}

static void nifti_2_qform_is_used_without_sform(void **state)
{
	(void)state;
	uint8_t bytes[544 + COUNT];
	struct nifti_sample sample = nifti_sample_make(3, 2, 2);
	struct gz_volume v;
	sample.qform_code = 1;
	sample.quatern[2] = 1; /* half a turn about z */
	nifti2_sample_bytes(&sample, false, bytes);
	memcpy(bytes + 544, voxels, COUNT);
	open_quietly(files_write("q2.nii", bytes, sizeof bytes), &v);
	assert_true(v.oriented && first_voxel(&v) == 12);
	gz_volume_free(&v);
}

static void nifti_2_that_is_wrong_is_refused(void **state)
{
	(void)state;
	uint8_t bytes[544 + COUNT] = { 0 };
	struct nifti_sample sample = nifti_sample_make(3, 2, 2);
	nifti2_sample_bytes(&sample, false, bytes);
	bytes[16 + 8 + 5] = 1; /* 2^40 voxels along x */
	check_refusal(files_write("w.nii", bytes, sizeof bytes), GZ_ERR_FORMAT, "along axis 1");
	nifti2_sample_bytes(&sample, false, bytes);
	bytes[16 + 24 + 1] = 8; /* 2050 slices */
	check_refusal(files_write("w.nii", bytes, sizeof bytes), GZ_ERR_FORMAT, "truncated");
	nifti2_sample_bytes(&sample, false, bytes);
	bytes[168] = 0; /* voxels at byte 512, within the header */
	check_refusal(files_write("w.nii", bytes, sizeof bytes), GZ_ERR_FORMAT, "voxels at byte");
	nifti2_sample_bytes(&sample, false, bytes);
	bytes[168 + 7] = 0x80; /* negative */
	check_refusal(files_write("w.nii", bytes, sizeof bytes), GZ_ERR_FORMAT, "voxels at byte");
	nifti2_sample_bytes(&sample, false, bytes);
	bytes[9] = '\r'; /* a transfer as text */
	check_refusal(files_write("w.nii", bytes, sizeof bytes), GZ_ERR_FORMAT, "no NIfTI header");
}

/* Names of a pair, how each is compressed, and which of both is opened. */
static void pairs_are_read_by_either_name(void **state)
{
	(void)state;
	static const struct {
		const char *header, *image;
		int version;
	} pairs[] = {
		{ "p.hdr", "p.img", 1 },         { "p.hdr", "p.img", 2 },
		{ "P.HDR", "P.IMG", 1 },         { "p.hdr.gz", "p.img.gz", 1 },
		{ "p.hdr", "p.img.gz", 1 },      { "p.hdr.gz", "p.img", 1 },
		{ "p.hdr.zst", "p.img.zst", 2 },
	};
	for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
		uint8_t head[544], packed[1024];
		struct nifti_sample sample = sagittal_sample();
		const size_t size = pairs[i].version == 1 ? 348 : 540;
		sample.magic = "ni1";
		sample.vox_offset = 0;
		if (pairs[i].version == 1)
			nifti_sample_bytes(&sample, head);
		else
			nifti2_sample_bytes(&sample, true, head);
		const void *parts[2] = { head, voxels };
		const size_t sizes[2] = { size, COUNT };
		const char *const names[2] = { pairs[i].header, pairs[i].image };
		for (int part = 0; part < 2; part++) {
			size_t length = sizes[part];
			const void *bytes = packed;
			if (strstr(names[part], ".gz"))
				length = files_deflate(parts[part], length, 31, packed,
						       sizeof packed);
			else if (strstr(names[part], ".zst"))
				length = ZSTD_compress(packed, sizeof packed, parts[part], length,
						       3);
			else
				bytes = parts[part];
			files_write(names[part], bytes, length);
		}
		for (int part = 0; part < 2; part++) {
			struct gz_volume v;
			struct captured_log log;
			captured_log_init(&log, "*:warn");
			if (gz_volume_load(files_path(names[part]), NULL, NULL, &log.log, &v) !=
			    GZ_OK)
				fail_msg("%s", log.last);
			check_sagittal(&v);
		}
		unlink(files_path(pairs[i].header));
		unlink(files_path(pairs[i].image));
	}
}

/* "UNITS OF SPATIAL AND TEMPORAL DIMENSIONS" of nifti1.h; 8 is seconds. */
static void lengths_are_converted_to_mm(void **state)
{
	(void)state;
	static const struct {
		int code;
		double mm;
		const char *words; /* NULL: nothing is said */
	} rows[] = {
		{ 0, 1, NULL },
		{ 2 + 8, 1, NULL },
		{ 1 + 8, 1000, "its lengths are in m; converted to mm" },
		{ 3 + 8, 1e-3, "its lengths are in um; converted to mm" },
		{ 5, 1, "its unit of length \"code 5\" is unknown; taken as mm" },
	};
	for (size_t i = 0; i < 4 * sizeof rows / sizeof rows[0]; i++) {
		const bool second = i % 2 == 1, sform = i / 2 % 2 == 1;
		struct nifti_sample sample = nifti_sample_make(3, 2, 2);
		uint8_t bytes[544 + COUNT] = { 0 };
		struct captured_log log;
		struct gz_volume v;
		sample.pixdim[1] = 500;
		if (sform) {
			sample.sform_code = 1;
			sample.srow[0][0] = 500;
			sample.srow[1][1] = sample.srow[2][2] = 1;
		}
		if (second)
			nifti2_sample_bytes(&sample, false, bytes);
		else
			nifti_sample_bytes(&sample, bytes);
		bytes[second ? 500 : 123] = (uint8_t)rows[i / 4].code;
		memcpy(bytes + (second ? 544 : 352), voxels, COUNT);
		captured_log_init(&log, "*:info");
		assert_int_equal(
			gz_volume_load(files_write("u.nii", bytes, (second ? 544 : 352) + COUNT),
				       NULL, NULL, &log.log, &v),
			GZ_OK);
		assert_int_equal(log.messages, rows[i / 4].words ? 1 : 0);
		if (rows[i / 4].words && !strstr(log.last, rows[i / 4].words))
			fail_msg("\"%s\" lacks \"%s\"", log.last, rows[i / 4].words);
		assert_true(v.spacing[0] == 500 * rows[i / 4].mm);
		assert_true(v.spacing[1] == rows[i / 4].mm);
		gz_volume_free(&v);
	}
}

/* y leans by 31 degrees towards x. */
static void shear_is_told_and_not_called_oblique(void **state)
{
	(void)state;
	struct nifti_sample sample = nifti_sample_make(3, 2, 2);
	uint8_t bytes[352 + COUNT];
	struct captured_log log;
	struct gz_volume v;
	sample.sform_code = 1;
	sample.srow[0][0] = sample.srow[1][1] = sample.srow[2][2] = 1;
	sample.srow[0][1] = 0.6f;
	nifti_sample_bytes(&sample, bytes);
	memcpy(bytes + 352, voxels, COUNT);
	captured_log_init(&log, "*:info");
	assert_int_equal(
		gz_volume_load(files_write("s.nii", bytes, sizeof bytes), NULL, NULL, &log.log, &v),
		GZ_OK);
	assert_int_equal(log.messages, 1);
	assert_int_equal(log.level, GZ_LOG_WARN);
	assert_non_null(strstr(log.last, "sheared by 31.0 degrees"));
	assert_non_null(strstr(log.last, "drawn without the shear"));
	gz_volume_free(&v);
}

static void pair_without_its_other_half_is_refused(void **state)
{
	(void)state;
	uint8_t head[352];
	struct nifti_sample sample = nifti_sample_make(3, 2, 2);
	sample.magic = "ni1";
	sample.vox_offset = 0;
	nifti_sample_bytes(&sample, head);
	check_refusal(files_write("alone.hdr", head, 348), GZ_ERR_NOT_FOUND, "alone.img");
	files_write("alone.img", voxels, COUNT - 1);
	check_refusal(files_path("alone.hdr"), GZ_ERR_FORMAT, "alone.img: truncated");
	unlink(files_path("alone.hdr"));
	check_refusal(files_path("alone.img"), GZ_ERR_UNSUPPORTED, "unknown format");
	check_refusal(files_write("odd.hdr", "ENVI\nsamples = 3\n", 17), GZ_ERR_FORMAT,
		      "truncated");
}

static void analyze_is_taken_as_left_last_with_a_warning(void **state)
{
	(void)state;
	uint8_t head[352];
	struct nifti_sample sample = nifti_sample_make(3, 2, 2);
	struct captured_log log;
	struct gz_volume v;
	for (int swapped = 0; swapped < 2; swapped++) {
		sample.magic = "\0\0\0";
		sample.vox_offset = 0;
		sample.dim[0] = 4;
		sample.dim[4] = 0;
		sample.pixdim[1] = -2; /* as some writers mark a flip */
		sample.slope = 3;      /* SPM's scale */
		sample.intercept = 77; /* something else in ANALYZE */
		sample.swapped = swapped == 1;
		nifti_sample_bytes(&sample, head);
		files_write("old.img", voxels, COUNT);
		captured_log_init(&log, NULL);
		assert_int_equal(
			gz_volume_load(files_write("old.hdr", head, 348), NULL, NULL, &log.log, &v),
			GZ_OK);
		assert_int_equal(log.messages, 1);
		assert_int_equal(log.level, GZ_LOG_WARN);
		assert_non_null(strstr(log.last, "does not say where left is"));
		assert_false(v.oriented);
		assert_true(v.spacing[0] == 2 && v.spacing[1] == 1);
		assert_true(first_voxel(&v) == 3 * 2); /* file voxel (2, 0, 0) */
		gz_volume_free(&v);
	}
}

static void file_that_is_not_compressed_as_named_is_read(void **state)
{
	(void)state;
	uint8_t bytes[352 + COUNT], packed[1024];
	struct nifti_sample sample = sagittal_sample();
	struct gz_volume v;
	nifti_sample_bytes(&sample, bytes);
	memcpy(bytes + 352, voxels, COUNT);
	open_quietly(files_write("plain.nii.gz", bytes, sizeof bytes), &v);
	check_sagittal(&v);
	size_t size = files_deflate(bytes, sizeof bytes, 31, packed, sizeof packed);
	open_quietly(files_write("packed.nii", packed, size), &v);
	check_sagittal(&v);
	size = ZSTD_compress(packed, sizeof packed, bytes, sizeof bytes, 3);
	open_quietly(files_write("packed.nii.zst", packed, size), &v);
	check_sagittal(&v);
}

/* Each byte of a header changed: loading ends, and what is loaded keeps its promises. */
static void header_with_any_byte_changed_is_read_or_refused(void **state)
{
	(void)state;
	uint8_t bytes[544 + COUNT];
	struct nifti_sample sample = sagittal_sample();
	for (int version = 1; version <= 2; version++) {
		const size_t head = version == 1 ? 352 : 544;
		for (size_t at = 0; at < head; at++) {
			static const uint8_t changes[] = { 0x01, 0x80, 0xff };
			for (size_t c = 0; c < sizeof changes; c++) {
				struct gz_volume v = { 0 };
				if (version == 1)
					nifti_sample_bytes(&sample, bytes);
				else
					nifti2_sample_bytes(&sample, false, bytes);
				memcpy(bytes + head, voxels, COUNT);
				bytes[at] ^= changes[c];
				if (gz_volume_load(files_write("m.nii", bytes, head + COUNT), NULL,
						   NULL, NULL, &v) != GZ_OK)
					continue;
				assert_true(isfinite(v.slope) && isfinite(v.intercept));
				assert_true(gz_volume_voxel_count(&v) <= COUNT);
				gz_volume_free(&v);
			}
		}
	}
}

TEST_SUITE(nifti)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(nifti_2_is_read_in_both_byte_orders),
		cmocka_unit_test(nifti_2_qform_is_used_without_sform),
		cmocka_unit_test(nifti_2_that_is_wrong_is_refused),
		cmocka_unit_test(pairs_are_read_by_either_name),
		cmocka_unit_test(lengths_are_converted_to_mm),
		cmocka_unit_test(shear_is_told_and_not_called_oblique),
		cmocka_unit_test(pair_without_its_other_half_is_refused),
		cmocka_unit_test(analyze_is_taken_as_left_last_with_a_warning),
		cmocka_unit_test(file_that_is_not_compressed_as_named_is_read),
		cmocka_unit_test(header_with_any_byte_changed_is_read_or_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
