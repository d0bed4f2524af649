/* The table of formats: endings, and that each format is recognised by its content alone. */
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>
#include <zstd.h>

#include "base/captured_log.h"
#include "dicom_files.h"
#include "render/data/format.h"
#include "volume_files.h"

static const uint8_t eight[8] = { 1, 2, 3, 4, 5, 6, 7, 8 };

static void every_ending_is_of_one_format(void **state)
{
	(void)state;
	const char *seen[256];
	size_t count = 0;
	for (size_t i = 0; i < gz_volume_format_count; i++) {
		const char *const *endings = gz_volume_formats[i]->endings;
		for (size_t k = 0; k < GZ_FORMAT_ENDINGS_MAX && endings[k]; k++) {
			assert_int_equal(endings[k][0], '.');
			for (size_t j = 0; j < count; j++)
				if (strcasecmp(seen[j], endings[k]) == 0)
					fail_msg("%s is of two formats", endings[k]);
			seen[count++] = endings[k];
		}
	}
	assert_true(count > 10);
}

/* ".nii.gz" is no ".gz". */
static void longest_ending_names_the_format(void **state)
{
	(void)state;
	for (size_t i = 0; i < gz_volume_format_count; i++) {
		const struct gz_volume_format *format = gz_volume_formats[i];
		for (size_t k = 0; k < GZ_FORMAT_ENDINGS_MAX && format->endings[k]; k++) {
			char name[64];
			snprintf(name, sizeof name, "a%s", format->endings[k]);
			if (gz_volume_format_by_name(name) != format)
				fail_msg("%s is not %s", name, format->name);
		}
	}
}

static void list_for_people_names_every_format_and_its_limits(void **state)
{
	(void)state;
	char *text = NULL;
	size_t size = 0;
	FILE *out = open_memstream(&text, &size);
	gz_volume_formats_print(out);
	assert_int_equal(fclose(out), 0);
	for (size_t i = 0; i < gz_volume_format_count; i++) {
		assert_non_null(gz_volume_formats[i]->limits);
		assert_non_null(strstr(text, gz_volume_formats[i]->name));
		assert_non_null(strstr(text, gz_volume_formats[i]->limits));
	}
	free(text);
}

static void load_refused(const char *path, const char *words)
{
	struct captured_log log;
	struct gz_volume v = { 0 };
	captured_log_init(&log, "*:error");
	const enum gz_result result = gz_volume_load(path, NULL, NULL, &log.log, &v);
	if (result == GZ_OK || log.messages != 1 || !strstr(log.last, words))
		fail_msg("%s: result %d, %d messages, \"%s\" lacks \"%s\"", path, result,
			 log.messages, log.last, words);
}

/* ---- a small file of each format, under a name that says nothing ---- */

static const char *write_nifti_packed(const char *name, int version, int coding)
{
	uint8_t bytes[544 + 8], packed[2048];
	const struct nifti_sample sample = nifti_sample_make(2, 2, 2);
	const size_t head = version == 1 ? 352 : 544;
	if (version == 1)
		nifti_sample_bytes(&sample, bytes);
	else
		nifti2_sample_bytes(&sample, false, bytes);
	memcpy(bytes + head, eight, sizeof eight);
	size_t size = head + sizeof eight;
	if (coding == GZ_CODING_PLAIN)
		return files_write(name, bytes, size);
	size = coding == GZ_CODING_ZLIB ? files_deflate(bytes, size, 31, packed, sizeof packed)
					: ZSTD_compress(packed, sizeof packed, bytes, size, 3);
	return files_write(name, packed, size);
}

static const char *write_nifti1(const char *name)
{
	return write_nifti_packed(name, 1, GZ_CODING_PLAIN);
}

static const char *write_nifti1_gzip(const char *name)
{
	return write_nifti_packed(name, 1, GZ_CODING_ZLIB);
}

static const char *write_nifti1_zstd(const char *name)
{
	return write_nifti_packed(name, 1, GZ_CODING_ZSTD);
}

static const char *write_nifti2(const char *name)
{
	return write_nifti_packed(name, 2, GZ_CODING_PLAIN);
}

static const char *write_mgh(const char *name)
{
	uint8_t bytes[284 + 8] = { 0 };
	bytes[3] = 1;                         /* version */
	bytes[7] = bytes[11] = bytes[15] = 2; /* voxels */
	bytes[19] = 1;                        /* frames */
	memcpy(bytes + 284, eight, sizeof eight);
	return files_write(name, bytes, sizeof bytes);
}

static const char *write_nrrd(const char *name)
{
	return files_write_text(
		name, "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n\n", eight,
		sizeof eight);
}

static const char *write_metaimage(const char *name)
{
	return files_write_text(name,
				"ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\n"
				"ElementType = MET_UCHAR\nElementDataFile = LOCAL\n",
				eight, sizeof eight);
}

static const char *write_bricks(const char *name)
{
	struct gz_volume v = { .dims = { 2, 2, 2 }, .spacing = { 1, 1, 1 }, .type = GZ_VOXEL_U8 };
	assert_int_equal(gz_volume_allocate(&v), GZ_OK);
	memcpy(v.voxels, eight, sizeof eight);
	gz_volume_find_range(&v);
	assert_int_equal(gz_bricks_write(&v, files_path(name), NULL, NULL), GZ_OK);
	gz_volume_free(&v);
	return files_path(name);
}

static const char *write_dicom(const char *name)
{
	static const int16_t pixels[6] = { 1, 2, 3, 4, 5, 6 };
	const struct dicom_sample sample = dicom_sample_make("1.2.3.4", 1, pixels);
	return dicom_sample_write(&sample, name);
}

static const char *write_hdf5(const char *name)
{
	return files_write(name, "\211HDF\r\n\032\n\0\0\0\0", 12);
}

static const char *write_netcdf(const char *name)
{
	return files_write(name, "CDF\001\0\0\0\0", 8);
}

static const char *write_inv3(const char *name)
{
	static uint8_t bytes[1024];
	const char start[] = "tmp1/main.plist";
	unsigned sum = 0;
	memset(bytes, 0, sizeof bytes);
	memcpy(bytes, start, sizeof start);
	memcpy(bytes + 124, "00000000001", 12);
	memcpy(bytes + 148, "        0", 9);
	memcpy(bytes + 257, "ustar", 6);
	for (size_t i = 0; i < 512; i++)
		sum += bytes[i];
	snprintf((char *)bytes + 148, 8, "%06o", sum);
	return files_write(name, bytes, sizeof bytes);
}

struct sample_file {
	const struct gz_volume_format *format;
	const char *(*write)(const char *name);
};

static const struct sample_file sample_files[] = {
	{ &gz_format_nifti, write_nifti1 },      { &gz_format_nifti, write_nifti1_gzip },
	{ &gz_format_nifti, write_nifti1_zstd }, { &gz_format_nifti, write_nifti2 },
	{ &gz_format_nrrd, write_nrrd },         { &gz_format_metaimage, write_metaimage },
	{ &gz_format_bricks, write_bricks },     { &gz_format_dicom, write_dicom },
	{ &gz_format_minc, write_hdf5 },         { &gz_format_mgh, write_mgh },
	{ &gz_format_foreign, write_netcdf },    { &gz_format_inv3, write_inv3 },
};
enum { SAMPLE_FILES = sizeof sample_files / sizeof sample_files[0] };

static void every_format_is_recognised_by_its_own_small_file(void **state)
{
	(void)state;
	for (size_t i = 0; i < gz_volume_format_count; i++) {
		const struct gz_volume_format *format = gz_volume_formats[i];
		int tried = 0;
		for (size_t k = 0; k < SAMPLE_FILES; k++) {
			if (sample_files[k].format != format)
				continue;
			const char *path = sample_files[k].write("unnamed");
			if (gz_volume_format_by_content(path) != format)
				fail_msg("%s, file %zu: not recognised", format->name, k);
			tried++;
			unlink(path);
		}
		/* Raw data look like anything. */
		if (!tried && format->layout == GZ_LAYOUT_IN_FILE)
			fail_msg("%s: no file to recognise", format->name);
	}
}

static void unnamed_and_misnamed_files_are_opened_by_their_content(void **state)
{
	(void)state;
	for (size_t k = 0; k < SAMPLE_FILES; k++) {
		const struct gz_volume_format *format = sample_files[k].format;
		if (format == &gz_format_foreign || format == &gz_format_minc ||
		    format == &gz_format_inv3)
			continue; /* tests/view/minc.py opens MINC, test_inv3.c a project */
		const char *const names[] = { "unnamed", "wrong.raw",
					      format == &gz_format_nrrd ? "wrong.nii"
									: "wrong.nrrd" };
		for (size_t n = 0; n < sizeof names / sizeof names[0]; n++) {
			struct captured_log log;
			struct gz_volume v = { 0 };
			captured_log_init(&log, "*:info");
			const char *path = sample_files[k].write(names[n]);
			if (gz_volume_load(path, NULL, NULL, &log.log, &v) != GZ_OK)
				fail_msg("%s as %s: %s", format->name, names[n], log.last);
			gz_volume_free(&v);
			unlink(path);
		}
	}
}

static void content_that_is_not_as_named_is_told_in_one_line(void **state)
{
	(void)state;
	struct captured_log log;
	struct gz_volume v = { 0 };
	captured_log_init(&log, "*:info");
	assert_int_equal(gz_volume_load(write_nrrd("n.mha"), NULL, NULL, &log.log, &v), GZ_OK);
	assert_int_equal(log.messages, 1);
	assert_int_equal(log.level, GZ_LOG_INFO);
	assert_non_null(strstr(log.last, "its name says MetaImage, its content is NRRD"));
	gz_volume_free(&v);
	captured_log_init(&log, "*:info");
	assert_int_equal(gz_volume_load(write_nrrd("n.nrrd"), NULL, NULL, &log.log, &v), GZ_OK);
	assert_int_equal(log.messages, 0);
	gz_volume_free(&v);
}

/* A sink that keeps the first line. */
static void keep_first(void *user, enum gz_log_level level, const char *module, const char *message)
{
	const struct captured_log *log = user;
	if (log->messages == 0)
		capture(user, level, module, message);
}

static void one_format_of_several_is_told(void **state)
{
	(void)state;
	static const struct {
		const char *name, *bytes;
		size_t size;
		const char *words;
	} rows[] = {
		{ "c.mnc", "CDF\001\0\0", 6,
		  "its name says MINC 2, its content is MINC 1 (netCDF)" },
		{ "c.mgz", "II*\0\010\0\0\0", 8, "its name says MGH, its content is TIFF" },
		{ "c.hdr", "<VTKFile type", 13, "its name says NIfTI, its content is VTK XML" },
	};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		struct captured_log log;
		struct gz_volume v;
		captured_log_init(&log, "*:info");
		log.log.sink = keep_first; /* the refusal comes after it */
		const char *path = files_write(rows[i].name, rows[i].bytes, rows[i].size);
		assert_int_equal(gz_volume_load(path, NULL, NULL, &log.log, &v),
				 GZ_ERR_UNSUPPORTED);
		if (!strstr(log.last, rows[i].words))
			fail_msg("%s lacks %s", log.last, rows[i].words);
	}
}

static void layout_that_is_given_beats_the_content(void **state)
{
	(void)state;
	const struct gz_raw_layout raw = { .dims = { 4, 2, 1 }, .spacing = { 1, 1, 1 } };
	struct gz_volume v = { 0 };
	struct captured_log log;
	captured_log_init(&log, "*:warn");
	const char *path = files_write("given.raw", "NRRD0004", 8);
	assert_int_equal(gz_volume_load(path, &raw, NULL, &log.log, &v), GZ_OK);
	assert_int_equal(log.messages, 1);
	assert_non_null(strstr(log.last, "its content is NRRD; taken as raw"));
	assert_memory_equal(v.voxels, "NRRD0004", 8);
	gz_volume_free(&v);
}

static void formats_that_are_not_read_are_named_with_a_remedy(void **state)
{
	(void)state;
	static const struct {
		const char *bytes;
		size_t size;
		const char *words;
	} rows[] = {
		{ "CDF\001\0\0", 6,
		  "MINC 1 (netCDF) is not read; convert it with: mincconvert -2" },
		{ "CDF\002\0\0", 6, "mincconvert" },
		{ "# vtk DataFile Version 3.0\n", 27, "VTK is not read" },
		{ "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\">", 48, "ParaView" },
		{ "II*\0\010\0\0\0", 8, "TIFF is not read" },
		{ "MM\0*\0\0\0\010", 8, "3D Slicer" },
	};
	static const char *const names[] = { "f.mnc", "f", "f.nii" };
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
		for (size_t k = 0; k < 3; k++)
			load_refused(files_write(names[k], rows[i].bytes, rows[i].size),
				     rows[i].words);
}

/* A slide scanner writes files that are both, with a TIFF header for a preamble. */
static void dicom_with_a_preamble_of_tiff_is_dicom(void **state)
{
	(void)state;
	char bytes[132] = "II*";
	memcpy(bytes + 128, "DICM", 4);
	const char *path = files_write("both", bytes, sizeof bytes);
	assert_ptr_equal(gz_volume_format_by_content(path), &gz_format_dicom);
}

static void content_of_no_format_is_refused(void **state)
{
	(void)state;
	load_refused(files_write("unknown", "\0\1\2\3", 4),
		     "unknown format; gazeview --formats lists what is read");
	load_refused(files_write("e", NULL, 0), "unknown format");
	/* compressed, of nothing known, and cut off */
	uint8_t packed[256];
	const size_t size = files_deflate("text", 4, 31, packed, sizeof packed);
	load_refused(files_write("unknown", packed, size), "unknown format");
	load_refused(files_write("unknown", packed, size - 9), "unknown format");
}

static void compressed_dicom_is_to_be_unpacked(void **state)
{
	(void)state;
	char bytes[160] = { 0 };
	uint8_t packed[1024];
	memcpy(bytes + 128, "DICM", 4);
	const size_t size = files_deflate(bytes, sizeof bytes, 31, packed, sizeof packed);
	load_refused(files_write("one.dcm.gz", packed, size),
		     "a compressed DICOM file is not read; unpack it");
	load_refused(files_write("one", packed, size),
		     "a compressed DICOM file is not read; unpack it");
}

/* Beginnings of magic words, and each file cut anywhere: nothing is recognised that is not there.
 */
static void start_that_is_cut_is_no_harm(void **state)
{
	(void)state;
	for (size_t k = 0; k < SAMPLE_FILES; k++) {
		uint8_t bytes[8192];
		const char *path = sample_files[k].write("whole");
		FILE *in = fopen(path, "rb");
		const size_t size = fread(bytes, 1, sizeof bytes, in);
		fclose(in);
		unlink(path);
		for (size_t cut = 0; cut < size && cut < 700; cut++) {
			const char *part = files_write("part", bytes, cut);
			const struct gz_volume_format *found = gz_volume_format_by_content(part);
			if (found && found != sample_files[k].format)
				fail_msg("%s cut at %zu is %s", sample_files[k].format->name, cut,
					 found->name);
		}
	}
}

/* What a file does not state, the volume says, and so do files that are written of it. */
static void spacing_that_is_not_stated_is_assumed(void **state)
{
	(void)state;
	static const struct {
		const char *name, *head;
		bool assumed;
	} rows[] = {
		{ "plain.nrrd",
		  "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\n"
		  "encoding: raw\n\n",
		  true },
		{ "spaced.nrrd",
		  "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\n"
		  "spacings: 1 1 1\nencoding: raw\n\n",
		  false },
		{ "plain.mha",
		  "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\n"
		  "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n",
		  true },
		{ "spaced.mha",
		  "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\n"
		  "ElementSpacing = 1 1 1\nElementType = MET_UCHAR\n"
		  "ElementDataFile = LOCAL\n",
		  false },
		{ "sized.mha",
		  "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\n"
		  "ElementSize = 2 2 2\nElementType = MET_UCHAR\n"
		  "ElementDataFile = LOCAL\n",
		  false },
	};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		struct gz_volume volume, again;
		const char *path =
			files_write_text(rows[i].name, rows[i].head, eight, sizeof eight);
		assert_int_equal(gz_volume_load(path, NULL, NULL, NULL, &volume), GZ_OK);
		assert_int_equal(volume.spacing_assumed, rows[i].assumed);
		const char *written = files_path("written.gzb");
		assert_int_equal(gz_bricks_write(&volume, written, NULL, NULL), GZ_OK);
		assert_int_equal(gz_volume_load(written, NULL, NULL, NULL, &again), GZ_OK);
		assert_int_equal(again.spacing_assumed, rows[i].assumed);
		gz_volume_free(&again);
		written = files_path("written.nrrd");
		assert_int_equal(gz_nrrd_write(&volume, written, NULL, NULL), GZ_OK);
		assert_int_equal(gz_volume_load(written, NULL, NULL, NULL, &again), GZ_OK);
		assert_int_equal(again.spacing_assumed, rows[i].assumed);
		assert_int_equal(again.oriented, volume.oriented);
		gz_volume_free(&again);
		gz_volume_free(&volume);
	}
}

/* Raw files state what their reader is told. */
static void spacing_of_raw_files_is_known_or_not(void **state)
{
	(void)state;
	const char *path = files_write("some.raw", eight, sizeof eight);
	struct gz_raw_layout raw = { .dims = { 2, 2, 2 }, .spacing = { 2, 2, 0 } };
	struct gz_volume volume;
	assert_int_equal(gz_volume_load(path, &raw, NULL, NULL, &volume), GZ_OK);
	assert_true(volume.spacing_assumed && volume.spacing[0] == 2 && volume.spacing[2] == 1);
	gz_volume_free(&volume);
	raw.spacing[2] = 3;
	assert_int_equal(gz_volume_load(path, &raw, NULL, NULL, &volume), GZ_OK);
	assert_true(!volume.spacing_assumed && volume.spacing[2] == 3);
	gz_volume_free(&volume);
}

TEST_SUITE(formats)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_ending_is_of_one_format),
		cmocka_unit_test(longest_ending_names_the_format),
		cmocka_unit_test(list_for_people_names_every_format_and_its_limits),
		cmocka_unit_test(every_format_is_recognised_by_its_own_small_file),
		cmocka_unit_test(unnamed_and_misnamed_files_are_opened_by_their_content),
		cmocka_unit_test(content_that_is_not_as_named_is_told_in_one_line),
		cmocka_unit_test(layout_that_is_given_beats_the_content),
		cmocka_unit_test(formats_that_are_not_read_are_named_with_a_remedy),
		cmocka_unit_test(compressed_dicom_is_to_be_unpacked),
		cmocka_unit_test(one_format_of_several_is_told),
		cmocka_unit_test(dicom_with_a_preamble_of_tiff_is_dicom),
		cmocka_unit_test(content_of_no_format_is_refused),
		cmocka_unit_test(start_that_is_cut_is_no_harm),
		cmocka_unit_test(spacing_that_is_not_stated_is_assumed),
		cmocka_unit_test(spacing_of_raw_files_is_known_or_not),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
