/* Volumes with colours of their own: what is read of each format, and what their values are. */
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "render/data/format.h"
#include "render/data/levels.h"
#include "render/data/voxel_colour.h"
#include "volume_files.h"

enum { X = 3, Y = 2, Z = 4, COUNT = X * Y * Z };

#define SIZES    "3 2 4"
#define RGB_HEAD "NRRD0005\ntype: uchar\ndimension: 4\nsizes: 3 " SIZES "\n"

/* Bytes of all magnitudes; voxel i has four of them. */
static uint8_t made_byte(int voxel, int channel)
{
	return (uint8_t)(71 * voxel + 97 * channel * channel + 13);
}

static void make_bytes(int channels, uint8_t *out)
{
	for (int i = 0; i < COUNT; i++)
		for (int channel = 0; channel < channels; channel++)
			*out++ = made_byte(i, channel);
}

/* By the definition, in floating point. */
static int wanted_luminance(int voxel)
{
	return (int)(0.2126 * made_byte(voxel, 0) + 0.7152 * made_byte(voxel, 1) +
		     0.0722 * made_byte(voxel, 2) + 0.5);
}

/* Voxel `at` of the volume must be voxel `from` of the file. */
static void check_voxel(const struct gz_volume *v, int at, int from)
{
	const bool by_alpha = v->colour == GZ_COLOUR_ALPHA;
	const int alpha = made_byte(from, 3);
	const int value = ((const uint8_t *)v->voxels)[at];
	assert_int_equal(value, by_alpha ? alpha : wanted_luminance(from));
	for (int channel = 0; channel < 3; channel++)
		assert_int_equal(gz_colour_byte(v->colours[at], channel), made_byte(from, channel));
	assert_int_equal(gz_colour_byte(v->colours[at], 3), by_alpha ? alpha : 255);
}

static void check_made(const struct gz_volume *v, enum gz_volume_colour colour)
{
	assert_true(v->dims[0] == X && v->dims[1] == Y && v->dims[2] == Z);
	assert_int_equal(v->type, GZ_VOXEL_U8);
	assert_int_equal(v->colour, colour);
	assert_true(v->slope == 1 && v->intercept == 0);
	for (int i = 0; i < COUNT; i++)
		check_voxel(v, i, i);
	struct gz_volume copy = *v;
	gz_volume_find_range(&copy);
	assert_true(copy.stored_min == v->stored_min && copy.stored_max == v->stored_max);
}

static struct gz_volume loaded(const char *path, enum gz_opacity_source opacity)
{
	const struct gz_loading loading = { .opacity = opacity };
	struct captured_log log;
	struct gz_volume v;
	captured_log_init(&log, "*:warn");
	if (gz_volume_load(path, NULL, &loading, &log.log, &v) != GZ_OK || log.messages != 0)
		fail_msg("%s: %s", path, log.last);
	return v;
}

static void check_file(const char *path, enum gz_volume_colour colour)
{
	struct gz_volume v = loaded(path, GZ_OPACITY_AUTO);
	check_made(&v, colour);
	gz_volume_free(&v);
}

static const char *write_nrrd_with(const char *head, int channels)
{
	uint8_t bytes[4 * COUNT];
	make_bytes(channels, bytes);
	return files_write_text("c.nrrd", head, bytes, (size_t)channels * COUNT);
}

static void nrrd_of_each_kind_of_colours_is_read(void **state)
{
	(void)state;
	static const char *const three[] = {
		"kinds: RGB-color domain domain domain\n",
		"kinds: 3-color space space space\nspacings: nan 1 1 1\n",
		"kinds: rgb-color domain domain domain\nspace: RAS\n"
		"space directions: none (1,0,0) (0,1,0) (0,0,1)\n",
		"space dimension: 3\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\n",
		"spacings: nan 1 1 1\n",
	};
	char head[512];
	for (size_t i = 0; i < sizeof three / sizeof three[0]; i++) {
		snprintf(head, sizeof head, "%s%sencoding: raw\n\n", RGB_HEAD, three[i]);
		check_file(write_nrrd_with(head, 3), GZ_COLOUR_LUMINANCE);
	}
	static const char *const four[] = { "RGBA-color", "4-color" };
	for (size_t i = 0; i < 2; i++) {
		snprintf(head, sizeof head,
			 "NRRD0005\ntype: uchar\ndimension: 4\nsizes: 4 " SIZES
			 "\nkinds: %s domain domain domain\nencoding: raw\n\n",
			 four[i]);
		check_file(write_nrrd_with(head, 4), GZ_COLOUR_ALPHA);
	}
}

static void nrrd_of_several_files_of_colours_is_read(void **state)
{
	(void)state;
	uint8_t bytes[3 * COUNT];
	make_bytes(3, bytes);
	for (int z = 0; z < Z; z++) {
		char name[32];
		snprintf(name, sizeof name, "c%d.raw", z);
		(void)files_write(name, bytes + z * 3 * X * Y, (size_t)3 * X * Y);
	}
	check_file(files_write_text("m.nhdr",
				    RGB_HEAD "kinds: RGB-color domain domain domain\n"
					     "encoding: raw\ndata file: c%d.raw 0 3 1 3\n",
				    NULL, 0),
		   GZ_COLOUR_LUMINANCE);
}

/* Its fastest axis goes up, its slowest to the left. */
static void colours_are_turned_with_their_values(void **state)
{
	(void)state;
	struct gz_volume v = loaded(
		write_nrrd_with(RGB_HEAD
				"kinds: RGB-color domain domain domain\nspace: RAS\nspace "
				"directions: none (0,0,1) (0,1,0) (-1,0,0)\nencoding: raw\n\n",
				3),
		GZ_OPACITY_AUTO);
	assert_true(v.dims[0] == Z && v.dims[1] == Y && v.dims[2] == X);
	for (int k = 0; k < Z; k++)
		for (int j = 0; j < Y; j++)
			for (int i = 0; i < X; i++)
				check_voxel(&v, (i * Y + j) * Z + (Z - 1 - k), (k * Y + j) * X + i);
	gz_volume_free(&v);
}

/* More voxels than are read and placed at once, each way. */
static void large_volume_of_colours_is_turned_whole(void **state)
{
	(void)state;
	enum { SIDE = 90 };
	static const char *const directions[] = { "(1,0,0) (0,1,0) (0,0,1)",
						  "(-1,0,0) (0,0,-1) (0,1,0)",
						  "(0,-1,0) (1,0,0) (0,0,1)",
						  "(0,0,1) (0,1,0) (-1,0,0)" };
	const size_t count = (size_t)SIDE * SIDE * SIDE;
	uint8_t *bytes = malloc(4 * count);
	for (size_t i = 0; i < count; i++) {
		const uint8_t rgba[4] = { (uint8_t)i, (uint8_t)(i >> 8), (uint8_t)(i >> 16),
					  (uint8_t)(i % 250) };
		memcpy(bytes + 4 * i, rgba, 4);
	}
	for (size_t k = 0; k < 4; k++) {
		char head[512];
		snprintf(
			head, sizeof head,
			"NRRD0005\ntype: uchar\ndimension: 4\nsizes: 4 90 90 90\nkinds: RGBA-color "
			"domain domain domain\nspace: RAS\nspace directions: none %s\n"
			"encoding: raw\n\n",
			directions[k]);
		struct gz_volume v =
			loaded(files_write_text("l.nrrd", head, bytes, 4 * count), GZ_OPACITY_AUTO);
		uint8_t *seen = calloc(1, count);
		for (size_t at = 0; at < count; at++) {
			const size_t i = v.colours[at] & 0xFFFFFF;
			assert_true(i < count && !seen[i]);
			seen[i] = 1;
			assert_int_equal(((uint8_t *)v.voxels)[at], i % 250);
			assert_int_equal(v.colours[at] >> 24, i % 250);
		}
		free(seen);
		gz_volume_free(&v);
	}
	free(bytes);
}

static void nifti_of_colours_is_read(void **state)
{
	(void)state;
	static const struct {
		int16_t datatype;
		int channels;
		enum gz_volume_colour colour;
	} kinds[] = { { 128, 3, GZ_COLOUR_LUMINANCE }, { 2304, 4, GZ_COLOUR_ALPHA } };
	for (size_t i = 0; i < 2; i++) {
		struct nifti_sample sample = nifti_sample_make(X, Y, Z);
		uint8_t bytes[352 + 4 * COUNT];
		sample.datatype = kinds[i].datatype;
		sample.bitpix = (int16_t)(8 * kinds[i].channels);
		sample.slope = 3; /* which colours do not have */
		nifti_sample_bytes(&sample, bytes);
		make_bytes(kinds[i].channels, bytes + 352);
		check_file(files_write("c.nii", bytes, 352 + (size_t)kinds[i].channels * COUNT),
			   kinds[i].colour);
	}
}

#define META "NDims = 3\nDimSize = " SIZES "\nTransformMatrix = -1 0 0 0 -1 0 0 0 1\n"

static void metaimage_of_colours_is_read(void **state)
{
	(void)state;
	uint8_t bytes[4 * COUNT];
	for (int channels = 3; channels <= 4; channels++) {
		char head[256];
		const enum gz_volume_colour colour =
			channels == 4 ? GZ_COLOUR_ALPHA : GZ_COLOUR_LUMINANCE;
		make_bytes(channels, bytes);
		snprintf(head, sizeof head,
			 META "ElementNumberOfChannels = %d\nElementType = MET_UCHAR\n"
			      "ElementDataFile = LOCAL\n",
			 channels);
		check_file(files_write_text("c.mha", head, bytes, (size_t)channels * COUNT),
			   colour);
		(void)files_write("h0.raw", bytes, (size_t)channels * COUNT / 2);
		(void)files_write("h1.raw", bytes + channels * COUNT / 2,
				  (size_t)channels * COUNT / 2);
		snprintf(head, sizeof head,
			 META "ElementNumberOfChannels = %d\nElementType = MET_UCHAR\n"
			      "ElementDataFile = LIST 3\nh0.raw\nh1.raw\n",
			 channels);
		check_file(files_write_text("c.mhd", head, NULL, 0), colour);
	}
}

/* 257 times a byte is the byte again; between, the nearest. */
static void colours_of_16_bits_are_narrowed(void **state)
{
	(void)state;
	static const struct {
		uint16_t wide;
		int narrow;
	} numbers[] = { { 0, 0 },       { 128, 0 },     { 129, 1 },     { 257, 1 },
			{ 32639, 127 }, { 32767, 127 }, { 32768, 128 }, { 65535, 255 },
			{ 65406, 254 }, { 65407, 255 }, { 2570, 10 },   { 12850, 50 } };
	for (int big = 0; big < 2; big++) {
		char head[256];
		uint8_t bytes[24];
		struct captured_log log;
		struct gz_volume v;
		for (size_t i = 0; i < 12; i++) {
			bytes[2 * i + (size_t)big] = (uint8_t)numbers[i].wide;
			bytes[2 * i + (size_t)!big] = (uint8_t)(numbers[i].wide >> 8);
		}
		snprintf(head, sizeof head,
			 "NRRD0005\ntype: uint16\ndimension: 4\nsizes: 3 4 1 1\nendian: %s\nkinds: "
			 "RGB-color domain domain domain\nencoding: raw\n\n",
			 big ? "big" : "little");
		captured_log_init(&log, "*:info");
		assert_int_equal(gz_volume_load(files_write_text("w.nrrd", head, bytes, 24), NULL,
						NULL, &log.log, &v),
				 GZ_OK);
		assert_int_equal(log.messages, 2); /* that, and what the values are */
		for (int i = 0; i < 12; i++)
			assert_int_equal(gz_colour_byte(v.colours[i / 3], i % 3),
					 numbers[i].narrow);
		gz_volume_free(&v);
	}
}

static void raw_file_of_colours_is_read_by_its_channels(void **state)
{
	(void)state;
	struct gz_raw_layout raw = { .dims = { X, Y, Z }, .spacing = { 1, 1, 1 } };
	for (raw.channels = 3; raw.channels <= 4; raw.channels++) {
		uint8_t bytes[4 * COUNT];
		struct gz_volume v;
		make_bytes(raw.channels, bytes);
		const char *path = files_write("c.raw", bytes, (size_t)raw.channels * COUNT);
		assert_int_equal(gz_volume_load(path, &raw, NULL, NULL, &v), GZ_OK);
		check_made(&v, raw.channels == 4 ? GZ_COLOUR_ALPHA : GZ_COLOUR_LUMINANCE);
		gz_volume_free(&v);
	}
}

#define RGBA_HEAD                                                                     \
	"NRRD0005\ntype: uchar\ndimension: 4\nsizes: 4 " SIZES "\nkinds: RGBA-color " \
	"domain domain domain\nencoding: raw\n\n"

static void opacity_chooses_between_luminance_and_alpha(void **state)
{
	(void)state;
	const char *path = write_nrrd_with(RGBA_HEAD, 4);
	struct gz_volume v = loaded(path, GZ_OPACITY_LUMINANCE);
	check_made(&v, GZ_COLOUR_LUMINANCE);
	const struct gz_volume_identity by_luminance = gz_volume_identify(&v);
	gz_volume_free(&v);
	v = loaded(path, GZ_OPACITY_ALPHA);
	check_made(&v, GZ_COLOUR_ALPHA);
	const struct gz_volume_identity by_alpha = gz_volume_identify(&v);
	gz_volume_free(&v);
	assert_false(gz_volume_identity_same(&by_luminance, &by_alpha));
}

static void alpha_that_is_the_same_everywhere_is_passed_over_unless_asked_for(void **state)
{
	(void)state;
	uint8_t bytes[4 * COUNT];
	make_bytes(4, bytes);
	for (int i = 0; i < COUNT; i++)
		bytes[4 * i + 3] = 255;
	const char *path = files_write_text("o.nrrd", RGBA_HEAD, bytes, sizeof bytes);
	struct gz_volume v = loaded(path, GZ_OPACITY_AUTO);
	check_made(&v, GZ_COLOUR_LUMINANCE);
	gz_volume_free(&v);
	v = loaded(path, GZ_OPACITY_ALPHA);
	assert_int_equal(v.colour, GZ_COLOUR_ALPHA);
	assert_true(v.stored_min == 255 && v.stored_max == 255);
	gz_volume_free(&v);
}

static void luminance_of_grey_is_the_grey(void **state)
{
	(void)state;
	for (int grey = 0; grey < 256; grey++) {
		const uint8_t rgb[3] = { (uint8_t)grey, (uint8_t)grey, (uint8_t)grey };
		assert_int_equal(gz_colour_luminance(rgb), grey);
	}
}

static void volume_of_colours_is_read_into_scratch(void **state)
{
	(void)state;
	const struct gz_loading loading = { .scratch = files_folder() };
	struct gz_volume v;
	assert_int_equal(gz_volume_load(write_nrrd_with(RGBA_HEAD, 4), NULL, &loading, NULL, &v),
			 GZ_OK);
	assert_int_equal(v.mapped, gz_volume_bytes(&v) + GZ_VOLUME_PADDING);
	check_made(&v, GZ_COLOUR_ALPHA);
	gz_volume_free(&v);
}

static void series_of_colours_has_one_range(void **state)
{
	(void)state;
	uint8_t bytes[2 * 4 * COUNT];
	make_bytes(4, bytes);
	for (size_t i = 4 * COUNT; i < sizeof bytes; i++)
		bytes[i] = i % 4 == 3 ? 200 : 17;
	const char *path = files_write_text("s.nrrd",
					    "NRRD0005\ntype: uchar\ndimension: 5\nsizes: 4 " SIZES
					    " 2\nkinds: RGBA-color domain domain domain list\n"
					    "encoding: raw\n\n",
					    bytes, sizeof bytes);
	struct gz_volume first = loaded(path, GZ_OPACITY_AUTO), second;
	struct captured_log log;
	const struct gz_loading loading = { .time_point = 1, .number_range = first.number_range };
	captured_log_init(&log, "*:warn");
	assert_int_equal(first.time_points, 2);
	assert_int_equal(gz_volume_load(path, NULL, &loading, &log.log, &second), GZ_OK);
	assert_non_null(strstr(log.last, "alpha is 200 in all of this time point"));
	assert_int_equal(second.colour, GZ_COLOUR_ALPHA);
	assert_true(second.stored_min == first.stored_min);
	assert_int_equal(second.colours[0], 0xC8111111);
	gz_volume_free(&first);
	gz_volume_free(&second);
}

static void check_refused(const char *path, enum gz_opacity_source opacity, enum gz_result result,
			  const char *words)
{
	const struct gz_loading loading = { .opacity = opacity };
	struct captured_log log;
	struct gz_volume v;
	captured_log_init(&log, "*:warn");
	assert_int_equal(gz_volume_load(path, NULL, &loading, &log.log, &v), result);
	if (!strstr(log.last, words))
		fail_msg("%s: \"%s\", not \"%s\"", path, log.last, words);
}

static void colours_that_are_not_read_are_refused(void **state)
{
	(void)state;
	static const struct {
		const char *text, *words;
	} nrrds[] = {
		{ "NRRD0005\ntype: float\ndimension: 4\nsizes: 3 1 1 1\nendian: little\nkinds: "
		  "RGB-color domain domain domain\nencoding: raw\n\n",
		  "colours of type float32 are not read" },
		{ "NRRD0005\ntype: int8\ndimension: 4\nsizes: 3 1 1 1\nkinds: "
		  "RGB-color domain domain domain\nencoding: raw\n\n",
		  "colours of type int8 are not read" },
		{ "NRRD0005\ntype: uchar\ndimension: 4\nsizes: 1 1 1 3\nkinds: "
		  "domain domain domain RGB-color\nencoding: raw\n\n",
		  "colours must be the first axis" },
		{ "NRRD0005\ntype: uchar\ndimension: 4\nsizes: 3 1 1 1\nkinds: RGB-color domain "
		  "domain domain\nspace: RAS\nspace directions: (1,0,0) (0,1,0) (0,0,1) none\n"
		  "encoding: raw\n\n",
		  "colours must be the first axis" },
		{ "NRRD0005\ntype: uchar\ndimension: 4\nsizes: 3 1 1 1\nkinds: 3-vector domain "
		  "domain domain\nencoding: raw\n\n",
		  "several numbers a voxel" },
		{ "NRRD0005\ntype: uchar\ndimension: 4\nsizes: 3 1 1 1\nkinds: HSV-color domain "
		  "domain domain\nencoding: raw\n\n",
		  "several numbers a voxel" },
		{ "NRRD0005\ntype: uchar\ndimension: 4\nsizes: 4 1 1 1\nkinds: RGB-color domain "
		  "domain domain\nencoding: raw\n\n",
		  "several numbers a voxel" },
		{ "NRRD0005\ntype: short\ndimension: 4\nsizes: 3 1 1 1\nendian: little\nspace: "
		  "RAS\n"
		  "space directions: none (1,0,0) (0,1,0) (0,0,1)\nencoding: raw\n\n",
		  "several numbers a voxel" },
	};
	for (size_t i = 0; i < sizeof nrrds / sizeof nrrds[0]; i++)
		check_refused(files_write_text("r.nrrd", nrrds[i].text, "123456789012", 12),
			      GZ_OPACITY_AUTO, GZ_ERR_UNSUPPORTED, nrrds[i].words);
	check_refused(files_write_text("r.mha",
				       "NDims = 3\nDimSize = 1 1 1\nElementNumberOfChannels = 2\n"
				       "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n",
				       "12", 2),
		      GZ_OPACITY_AUTO, GZ_ERR_UNSUPPORTED, ":3: ElementNumberOfChannels");
	check_refused(write_nrrd_with(RGB_HEAD "kinds: RGB-color domain domain domain\n"
					       "encoding: raw\n\n",
				      3),
		      GZ_OPACITY_ALPHA, GZ_ERR_INVAL, "have no alpha");
	check_refused(write_nrrd_with(RGB_HEAD "kinds: RGB-color domain domain domain\n"
					       "encoding: raw\n\n",
				      2),
		      GZ_OPACITY_AUTO, GZ_ERR_FORMAT, "voxels of 3 x uint8 are 72 bytes");
}

static void colours_are_written_as_nrrd_and_not_as_bricks(void **state)
{
	(void)state;
	for (int source = GZ_OPACITY_LUMINANCE; source <= GZ_OPACITY_ALPHA; source++) {
		struct gz_volume v =
			loaded(write_nrrd_with(RGBA_HEAD, 4), (enum gz_opacity_source)source);
		struct captured_log log;
		const char *path = files_path("written.nrrd");
		assert_int_equal(gz_nrrd_write(&v, path, NULL, NULL), GZ_OK);
		check_file(path, v.colour);
		captured_log_init(&log, NULL);
		assert_int_equal(gz_bricks_write(&v, files_path("c.gzb"), NULL, &log.log),
				 GZ_ERR_UNSUPPORTED);
		assert_non_null(strstr(log.last, "bricks hold no colours"));
		assert_int_not_equal(access(files_path("c.gzb"), F_OK), 0);
		gz_volume_free(&v);
	}
}

/* Two voxels along each axis become one; the last of three stands alone. */
static void half_has_the_means_of_colours_by_weight(void **state)
{
	(void)state;
	struct gz_volume v = loaded(write_nrrd_with(RGBA_HEAD, 4), GZ_OPACITY_ALPHA), half;
	assert_int_equal(gz_volume_halve(&v, NULL, &half), GZ_OK);
	assert_true(half.dims[0] == 2 && half.dims[1] == 1 && half.dims[2] == 2);
	for (int z = 0; z < 2; z++)
		for (int x = 0; x < 2; x++) {
			double sums[3] = { 0 }, weights = 0, alphas = 0;
			for (int i = 0; i < 8; i++) {
				const int column = 2 * x + (i & 1) < X ? 2 * x + (i & 1) : X - 1;
				const int from =
					((2 * z + (i >> 2)) * Y + (i >> 1 & 1)) * X + column;
				const double alpha = gz_colour_byte(v.colours[from], 3);
				const double weight = alpha + 1.0 / 64;
				alphas += alpha;
				weights += weight;
				for (int c = 0; c < 3; c++)
					sums[c] += weight * made_byte(from, c);
			}
			const uint32_t got = half.colours[2 * z + x];
			for (int c = 0; c < 3; c++)
				assert_true(abs((int)(sums[c] / weights + 0.5) -
						gz_colour_byte(got, c)) <= 1);
			assert_int_equal(gz_colour_byte(got, 3), (int)(alphas / 8 + 0.5));
		}
	gz_volume_free(&half);
	gz_volume_free(&v);
}

TEST_SUITE(colour_load)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(nrrd_of_each_kind_of_colours_is_read),
		cmocka_unit_test(nrrd_of_several_files_of_colours_is_read),
		cmocka_unit_test(colours_are_turned_with_their_values),
		cmocka_unit_test(large_volume_of_colours_is_turned_whole),
		cmocka_unit_test(nifti_of_colours_is_read),
		cmocka_unit_test(metaimage_of_colours_is_read),
		cmocka_unit_test(colours_of_16_bits_are_narrowed),
		cmocka_unit_test(raw_file_of_colours_is_read_by_its_channels),
		cmocka_unit_test(opacity_chooses_between_luminance_and_alpha),
		cmocka_unit_test(alpha_that_is_the_same_everywhere_is_passed_over_unless_asked_for),
		cmocka_unit_test(luminance_of_grey_is_the_grey),
		cmocka_unit_test(volume_of_colours_is_read_into_scratch),
		cmocka_unit_test(series_of_colours_has_one_range),
		cmocka_unit_test(colours_that_are_not_read_are_refused),
		cmocka_unit_test(colours_are_written_as_nrrd_and_not_as_bricks),
		cmocka_unit_test(half_has_the_means_of_colours_by_weight),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
