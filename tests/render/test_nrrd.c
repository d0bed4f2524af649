/* NRRD and MetaImage whose voxels are text, hexadecimal, bzip2, or in several files. */
#include "suite.h"

#include <bzlib.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "render/data/volume.h"
#include "volume_files.h"

#define COUNT 12
#define HEAD  "NRRD0005\ntype: uchar\ndimension: 3\nsizes: 3 2 2\n"

/* Voxel (x, y, z) of 3 x 2 x 2 is 100 z + 10 y + x. */
static const uint8_t voxels[COUNT] = { 0, 1, 2, 10, 11, 12, 100, 101, 102, 110, 111, 112 };
static const char digits[] = "0 1 2\n10,11, 12\r\n\t100 101 102 110 111 112";

static void load_quietly(const char *path, struct gz_volume *out)
{
	struct captured_log log;
	captured_log_init(&log, "*:warn");
	if (gz_volume_load(path, NULL, NULL, &log.log, out) != GZ_OK || log.messages != 0)
		fail_msg("%s: %s", path, log.last);
}

static void check_stored(const char *path)
{
	struct gz_volume v;
	load_quietly(path, &v);
	assert_true(v.dims[0] == 3 && v.dims[1] == 2 && v.dims[2] == 2);
	assert_int_equal(v.type, GZ_VOXEL_U8);
	assert_memory_equal(v.voxels, voxels, COUNT);
	gz_volume_free(&v);
}

static const char *write_nrrd_with(const char *name, const char *fields, const void *data,
				   size_t size)
{
	char head[1024];
	snprintf(head, sizeof head, "%s%s", HEAD, fields);
	return files_write_text(name, head, data, size);
}

/* Units of axes count for spacings, those of space for directions; a unit is told once. */
static void units_of_length_are_converted_to_mm(void **state)
{
	(void)state;
	static const struct {
		const char *fields, *words; /* NULL: nothing is said */
		double spacing[3];
	} rows[] = {
		{ "spacings: 2 3 4\nunits: \"mm\" \"mm\" \"mm\"\n", NULL, { 2, 3, 4 } },
		{ "spacings: 2 3 4\nunits: \"um\" \"um\" \"um\"\n",
		  "are in um",
		  { 2e-3, 3e-3, 4e-3 } },
		{ "spacings: 2 3 4\nunits: \"\" \"\" cm\n", "are in cm", { 2, 3, 40 } },
		{ "spacings: 2 3 4\nunits: \"ell\" \"ell\" \"ell\"\n",
		  "unit of length \"ell\" is unknown; taken as mm",
		  { 2, 3, 4 } },
		{ "space: LPS\nspace units: \"\xc2\xb5m\" \"Micron\" \"mm\"\n"
		  "space directions: (0,2,0) (0,0,3) (4,0,0)\n",
		  "are in Micron;",
		  { 4e-3, 2e-3, 3 } },
		{ "space: RAS\nspace units: \"um\" \"um\" \"um\"\n"
		  "space directions: (2,0,0) (0,3,0) (0,0,4)\nunits: \"m\" \"m\" \"m\"\n",
		  "are in um",
		  { 2e-3, 3e-3, 4e-3 } },
		/* cut off */
		{ "spacings: 2 3 4\nunits: \"mm\" \"um\n", "are in um", { 2, 3e-3, 4 } },
	};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		char fields[512];
		struct captured_log log;
		struct gz_volume v;
		snprintf(fields, sizeof fields, "%sencoding: raw\n\n", rows[i].fields);
		captured_log_init(&log, "*:info");
		if (gz_volume_load(write_nrrd_with("u.nrrd", fields, voxels, COUNT), NULL, NULL,
				   &log.log, &v) != GZ_OK)
			fail_msg("%s: %s", rows[i].fields, log.last);
		if ((rows[i].words == NULL) != (log.messages == 0) ||
		    (rows[i].words && !strstr(log.last, rows[i].words)))
			fail_msg("%s: %d messages: %s", rows[i].fields, log.messages, log.last);
		for (int k = 0; k < 3; k++)
			if (fabs(v.spacing[k] - rows[i].spacing[k]) > 1e-9 * rows[i].spacing[k])
				fail_msg("%s: spacing %g", rows[i].fields, v.spacing[k]);
		gz_volume_free(&v);
	}
}

static void text_is_read_by_each_of_its_names(void **state)
{
	(void)state;
	static const char *const fields[] = { "encoding: txt\n\n", "encoding: text\n\n",
					      "encoding: ASCII\n\n" };
	for (size_t i = 0; i < 3; i++)
		check_stored(write_nrrd_with("t.nrrd", fields[i], digits, strlen(digits)));
	/* no end of the last line, and one */
	check_stored(write_nrrd_with("t.nrrd", "encoding: txt\nline skip: 1\n\n",
				     "# x\n0 1 2 10 11 12 100 101 102 110 111 112\n", 43));
}

static void text_keeps_the_values_of_every_type(void **state)
{
	(void)state;
	static const struct {
		const char *type, *text;
		double values[3];
	} rows[] = {
		{ "int8", "-128 127 -1", { -128, 127, -1 } },
		{ "uint16", "0 65535 +258", { 0, 65535, 258 } },
		{ "int16", "-32768 32767 0", { -32768, 32767, 0 } },
		{ "uint32", "0 4294967040 1e3", { 0, 4294967040.0, 1000 } },
		{ "int32", "-2147483648 16909060 -3", { -2147483648.0, 16909060, -3 } },
		{ "float", "-1.5 1.25e2 .125", { -1.5, 125, 0.125 } },
		{ "double",
		  "-1.5 1024.0625 12345678901234567890",
		  { -1.5, 1024.0625, 0x1.56a95p+63 } },
	};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		char head[256];
		struct gz_volume v;
		snprintf(head, sizeof head,
			 "NRRD0004\ntype: %s\ndimension: 3\nsizes: 3 1 1\nencoding: txt\n\n",
			 rows[i].type);
		load_quietly(files_write_text("v.nrrd", head, rows[i].text, strlen(rows[i].text)),
			     &v);
		for (size_t k = 0; k < 3; k++) {
			const double got =
				v.slope * gz_voxel_stored(v.type, v.voxels, k) + v.intercept;
			if (fabs(got - rows[i].values[k]) > 1e-6 * fabs(rows[i].values[k]))
				fail_msg("%s: %g instead of %g", rows[i].type, got,
					 rows[i].values[k]);
		}
		gz_volume_free(&v);
	}
}

static void text_that_is_not_finite_becomes_the_least(void **state)
{
	(void)state;
	struct captured_log log;
	struct gz_volume v;
	captured_log_init(&log, "*:warn");
	const char *path = files_write_text("n.nrrd",
					    "NRRD0004\ntype: float\ndimension: 3\nsizes: 5 1 1\n"
					    "encoding: txt\n\nnan -Inf 2 infinity 1",
					    NULL, 0);
	assert_int_equal(gz_volume_load(path, NULL, NULL, &log.log, &v), GZ_OK);
	assert_int_equal(log.messages, 1);
	assert_non_null(strstr(log.last, "3 values are NaN or infinite"));
	assert_true(((float *)v.voxels)[0] == 1 && ((float *)v.voxels)[2] == 2);
	gz_volume_free(&v);
	path = files_write_text("n.nrrd",
				"NRRD0004\ntype: float\ndimension: 3\nsizes: 2 1 1\n"
				"encoding: txt\n\nnan 2",
				NULL, 0);
	assert_int_equal(gz_volume_load(path, NULL, NULL, &log.log, &v), GZ_OK);
	assert_non_null(strstr(log.last, "1 value is NaN or infinite"));
	gz_volume_free(&v);
}

/* More characters than are read at once, numbers across the border. */
static void long_text_is_read_whole(void **state)
{
	(void)state;
	enum { SIDE = 40, NUMBERS = SIDE * SIDE * SIDE };
	char *text = malloc(8 * NUMBERS + 256);
	struct gz_volume v;
	int used = sprintf(text,
			   "NRRD0004\ntype: ushort\ndimension: 3\nsizes: %d %d %d\n"
			   "encoding: ascii\n\n",
			   SIDE, SIDE, SIDE);
	for (int i = 0; i < NUMBERS; i++)
		used += sprintf(text + used, "%d%s", (i * 31) & 0xFFFF, i % 7 ? " " : "\n");
	load_quietly(files_write("l.nrrd", text, (size_t)used), &v);
	for (int i = 0; i < NUMBERS; i++)
		assert_int_equal(((uint16_t *)v.voxels)[i], (i * 31) & 0xFFFF);
	gz_volume_free(&v);
	free(text);
}

static void hexadecimal_digits_are_bytes(void **state)
{
	(void)state;
	static const char hex[] = "0001 02\n0A0b0c 64\t6566\n6E6f70\n";
	check_stored(write_nrrd_with("h.nrrd", "encoding: hex\n\n", hex, strlen(hex)));
	struct gz_volume v;
	load_quietly(files_write_text("e.nrrd",
				      "NRRD0004\ntype: ushort\ndimension: 3\nsizes: 1 1 1\n"
				      "endian: big\nencoding: hex\n\n0102",
				      NULL, 0),
		     &v);
	assert_int_equal(((uint16_t *)v.voxels)[0], 258);
	gz_volume_free(&v);
}

static size_t pack_bzip2(const void *bytes, size_t size, void *out, size_t room)
{
	unsigned packed = (unsigned)room;
	if (BZ2_bzBuffToBuffCompress(out, &packed, (char *)(uintptr_t)bytes, (unsigned)size, 9, 0,
				     0) != BZ_OK)
		abort();
	return packed;
}

static void bzip2_streams_are_joined(void **state)
{
	(void)state;
	uint8_t packed[1024];
	size_t size = pack_bzip2(voxels, COUNT, packed, sizeof packed);
	check_stored(write_nrrd_with("b.nrrd", "encoding: bzip2\n\n", packed, size));
	size = pack_bzip2(voxels, 5, packed, 512);
	size += pack_bzip2(voxels + 5, 7, packed + size, 512);
	check_stored(write_nrrd_with("b.nrrd", "encoding: bz2\n\n", packed, size));
}

static void bzip2_cut_or_damaged_is_refused(void **state)
{
	(void)state;
	uint8_t packed[1024];
	const size_t size = pack_bzip2(voxels, COUNT, packed, sizeof packed);
	struct gz_volume v;
	for (size_t cut = 0; cut < size; cut++) {
		const char *path = write_nrrd_with("c.nrrd", "encoding: bz2\n\n", packed, cut);
		if (gz_volume_load(path, NULL, NULL, NULL, &v) != GZ_ERR_FORMAT)
			fail_msg("cut at %zu of %zu", cut, size);
	}
	for (size_t at = 0; at < size; at++) {
		packed[at] ^= 0x20;
		const char *path = write_nrrd_with("c.nrrd", "encoding: bz2\n\n", packed, size);
		/* Some bits are padding, or of a table that no symbol uses. */
		if (gz_volume_load(path, NULL, NULL, NULL, &v) == GZ_OK) {
			assert_memory_equal(v.voxels, voxels, COUNT);
			gz_volume_free(&v);
		}
		packed[at] ^= 0x20;
	}
}

static void check_short(const char *fields, const char *data)
{
	struct captured_log log;
	struct gz_volume v;
	captured_log_init(&log, "*:error");
	const char *path = write_nrrd_with("short.nrrd", fields, data, strlen(data));
	if (gz_volume_load(path, NULL, NULL, &log.log, &v) != GZ_ERR_FORMAT || log.messages != 1 ||
	    !strstr(log.last, "truncated"))
		fail_msg("%s: %s", data, log.last);
}

static void spelled_numbers_that_are_too_few_are_refused(void **state)
{
	(void)state;
	check_short("encoding: txt\n\n", "1 2 3");
	check_short("encoding: txt\n\n", "1 2 3 4 5 6 7 8 9 10 11");
	check_short("encoding: txt\n\n", "1                                   2");
	check_short("encoding: hex\n\n", "0102030405060708090a0b");
	check_short("encoding: hex\n\n", "0102030405060708090a0b0");
	check_short("encoding: hex\n\n", "01 02 03 04 05 06 07 08 09 0a  \n\n\n\n\n");
}

/* Larger than every buffer between file and volume, decoded ahead by a thread. */
static void large_bzip2_is_read_whole(void **state)
{
	(void)state;
	const size_t count = 128 * 128 * 128;
	uint8_t *plain = malloc(count), *packed = malloc(2 * count);
	struct gz_volume v;
	for (size_t i = 0; i < count; i++)
		plain[i] = (uint8_t)(i * i >> 9);
	const size_t size = pack_bzip2(plain, count, packed, 2 * count);
	load_quietly(files_write_text("l.nrrd",
				      "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 128 128 128\n"
				      "encoding: bzip2\n\n",
				      packed, size),
		     &v);
	assert_memory_equal(v.voxels, plain, count);
	gz_volume_free(&v);
	free(plain);
	free(packed);
}

/* Two slices in two files, the second first by name. */
static void write_slices(const char *first, const char *second)
{
	files_write(first, voxels, COUNT / 2);
	files_write(second, voxels + COUNT / 2, COUNT / 2);
}

static void several_files_are_read_by_list_and_pattern(void **state)
{
	(void)state;
	static const char *const fields[] = {
		"encoding: raw\ndata file: LIST\ns07.raw\ns08.raw\n",
		"encoding: raw\ndata file: LIST 2\n\n  s07.raw  \ns08.raw",
		"encoding: raw\ndata file: LIST 3\r\ns07.raw\r\ns08.raw\r\n",
		"encoding: raw\ndata file: s%02d.raw 7 8 1\n",
		"encoding: raw\ndatafile: s%02i.raw 7 8 1 2\n",
		"encoding: raw\ndata file: s%.2u.raw 7 8 1 3\n\n",
	};
	write_slices("s07.raw", "s08.raw");
	for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++)
		check_stored(write_nrrd_with("s.nhdr", fields[i], NULL, 0));
	write_slices("b13.raw", "b3.raw");
	check_stored(
		write_nrrd_with("s.nhdr", "encoding: raw\ndata file: b%d.raw 13 3 -10\n", NULL, 0));
	/* a file a row */
	for (int row = 0; row < 4; row++) {
		char name[16];
		snprintf(name, sizeof name, "r%d", row);
		files_write(name, voxels + 3 * row, 3);
	}
	check_stored(write_nrrd_with("s.nhdr", "encoding: raw\ndata file: r%d 0 3 1 1\n", NULL, 0));
}

static void each_of_several_files_is_skipped_and_decoded(void **state)
{
	(void)state;
	uint8_t packed[256];
	for (int i = 0; i < 2; i++) {
		const char *names[] = { "k0", "k1" }, *zipped[] = { "z0", "z1" };
		const char *texts[] = { "x0", "x1" };
		files_write_text(names[i], "one\ntwo\n??", voxels + 6 * i, 6);
		const size_t size = files_deflate(voxels + 6 * i, 6, 31, packed, sizeof packed);
		files_write(zipped[i], packed, size);
		files_write_text(texts[i], i ? "100 101 102 110 111 112" : "0 1 2 10 11 12", NULL,
				 0);
	}
	check_stored(write_nrrd_with("k.nhdr",
				     "encoding: raw\nline skip: 2\nbyte skip: 2\n"
				     "data file: k%d 0 1 1\n",
				     NULL, 0));
	check_stored(write_nrrd_with(
		"k.nhdr", "encoding: raw\nbyte skip: -1\ndata file: k%d 0 1 1\n", NULL, 0));
	check_stored(write_nrrd_with("k.nhdr", "encoding: gzip\ndata file: z%d 0 1 1\n", NULL, 0));
	check_stored(write_nrrd_with("k.nhdr", "encoding: txt\ndata file: x%d 0 1 1\n", NULL, 0));
}

static void one_of_several_files_that_is_short_is_named(void **state)
{
	(void)state;
	struct captured_log log;
	struct gz_volume v;
	files_write("q0", voxels, 6);
	files_write("q1", voxels + 6, 5);
	captured_log_init(&log, "*:error");
	const char *path =
		write_nrrd_with("q.nhdr", "encoding: raw\ndata file: q%d 0 1 1\n", NULL, 0);
	assert_int_equal(gz_volume_load(path, NULL, NULL, &log.log, &v), GZ_ERR_FORMAT);
	assert_int_equal(log.messages, 1);
	assert_non_null(strstr(log.last, "truncated"));
	files_write("q1", voxels + 6, 6);
	files_write("q0", voxels, 7);
	captured_log_init(&log, "*:warn");
	assert_int_equal(gz_volume_load(path, NULL, NULL, &log.log, &v), GZ_OK);
	assert_int_equal(log.messages, 1);
	assert_non_null(strstr(log.last, "q0: there are more data after its voxels"));
	assert_memory_equal(v.voxels, voxels, COUNT);
	gz_volume_free(&v);
}

static void first_volume_of_a_series_needs_its_files_alone(void **state)
{
	(void)state;
	struct captured_log log;
	struct gz_volume v;
	files_write("f0", voxels, COUNT);
	captured_log_init(&log, "*:warn");
	const char *path = files_write_text(
		"f.nhdr",
		"NRRD0005\ntype: uchar\ndimension: 4\nsizes: 3 2 2 9\nencoding: raw\n"
		"data file: f%d 0 8 1\n",
		NULL, 0);
	assert_int_equal(gz_volume_load(path, NULL, NULL, &log.log, &v), GZ_OK);
	assert_int_equal(log.messages, 2);
	assert_non_null(strstr(log.last, "of its 9 time points only the first 1 can be read"));
	assert_memory_equal(v.voxels, voxels, COUNT);
	gz_volume_free(&v);
	/* Each time point in a file of its own. */
	uint8_t other[COUNT];
	for (size_t i = 0; i < COUNT; i++)
		other[i] = (uint8_t)(100 + i);
	for (int i = 1; i < 9; i++) {
		char name[8];
		snprintf(name, sizeof name, "f%d", i);
		files_write(name, i == 5 ? other : voxels, COUNT);
	}
	const struct gz_loading loading = { .time_point = 5 };
	path = files_path("f.nhdr"); /* the names above took its place */
	assert_int_equal(gz_volume_load(path, NULL, &loading, &log.log, &v), GZ_OK);
	assert_int_equal(log.messages, 2);
	assert_int_equal(v.time_points, 9);
	assert_memory_equal(v.voxels, other, COUNT);
	gz_volume_free(&v);
}

/* Straight in LPS, so turned by half about z. */
static void check_metaimage(const char *path)
{
	struct gz_volume v;
	load_quietly(path, &v);
	assert_true(v.dims[0] == 3 && v.dims[1] == 2 && v.dims[2] == 2);
	assert_int_equal(((uint8_t *)v.voxels)[0], 12);
	assert_int_equal(((uint8_t *)v.voxels)[11], 100);
	gz_volume_free(&v);
}

static void metaimage_text_and_several_files_are_read(void **state)
{
	(void)state;
	static const char *const ends[] = {
		("BinaryData = False\nElementDataFile = LOCAL\n"
		 "0 1 2 10 11 12 100 101 102 110 111 112\n"),
		"ElementDataFile = LIST\nm1.raw\nm2.raw\n",
		"ElementDataFile = LIST 2D\nm1.raw\nm2.raw\n",
		"ElementDataFile = m%d.raw 1 2 1\n",
		"HeaderSize = -1\nElementDataFile = m%01d.raw 1 2 1\n",
	};
	write_slices("m1.raw", "m2.raw");
	for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++)
		check_metaimage(files_write_text("m.mhd",
						 "NDims = 3\nDimSize = 3 2 2\n"
						 "ElementType = MET_UCHAR\n",
						 ends[i], strlen(ends[i])));
}

TEST_SUITE(nrrd)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(units_of_length_are_converted_to_mm),
		cmocka_unit_test(text_is_read_by_each_of_its_names),
		cmocka_unit_test(text_keeps_the_values_of_every_type),
		cmocka_unit_test(text_that_is_not_finite_becomes_the_least),
		cmocka_unit_test(long_text_is_read_whole),
		cmocka_unit_test(hexadecimal_digits_are_bytes),
		cmocka_unit_test(bzip2_streams_are_joined),
		cmocka_unit_test(bzip2_cut_or_damaged_is_refused),
		cmocka_unit_test(spelled_numbers_that_are_too_few_are_refused),
		cmocka_unit_test(large_bzip2_is_read_whole),
		cmocka_unit_test(several_files_are_read_by_list_and_pattern),
		cmocka_unit_test(each_of_several_files_is_skipped_and_decoded),
		cmocka_unit_test(one_of_several_files_that_is_short_is_named),
		cmocka_unit_test(first_volume_of_a_series_needs_its_files_alone),
		cmocka_unit_test(metaimage_text_and_several_files_are_read),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
