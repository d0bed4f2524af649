/* DICOM series: order, orientation, scales and bits of the numbers, and what is refused. */
#include "suite.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "dicom_files.h"
#include "render/data/volume.h"
#include "render/data/voxel_colour.h"
#include "volume_files.h"

#define SERIES "1.2.3.4.5"

/* Each test has the folder for itself. */
static int empty_folder(void **state)
{
	(void)state;
	DIR *listing = opendir(files_folder());
	for (struct dirent *entry; listing && (entry = readdir(listing));)
		if (entry->d_name[0] != '.')
			unlink(files_path(entry->d_name));
	if (listing)
		closedir(listing);
	return 0;
}

static double value_at(const struct gz_volume *volume, int x, int y, int z)
{
	const size_t i =
		((size_t)z * (size_t)volume->dims[1] + (size_t)y) * (size_t)volume->dims[0] +
		(size_t)x;
	const double stored = gz_voxel_stored(volume->type, volume->voxels, i);
	return volume->slope * stored + volume->intercept;
}

static struct gz_volume load(const char *path)
{
	struct gz_volume volume = { 0 };
	struct captured_log log;
	captured_log_init(&log, NULL);
	const enum gz_result result = gz_volume_load(path, NULL, NULL, &log.log, &volume);
	if (result != GZ_OK)
		fail_msg("%s: result %d: %s", path, result, log.last);
	return volume;
}

/* Load with slices resampled, and one line that says so. */
static struct gz_volume load_resampled(const char *path, enum gz_resampling how, const char *words)
{
	const struct gz_loading loading = { .resampling = how };
	struct gz_volume volume = { 0 };
	struct captured_log log;
	captured_log_init(&log, "*:warn");
	const enum gz_result result = gz_volume_load(path, NULL, &loading, &log.log, &volume);
	if (result != GZ_OK || log.messages != 1 || !strstr(log.last, words))
		fail_msg("%s: result %d, %d lines, \"%s\" lacks \"%s\"", path, result, log.messages,
			 log.last, words);
	return volume;
}

static void check_refused(const char *path, enum gz_result result, const char *words)
{
	struct captured_log log;
	struct gz_volume volume = { .slope = 42 };
	captured_log_init(&log, "*:error");
	const enum gz_result got = gz_volume_load(path, NULL, NULL, &log.log, &volume);
	if (got != result || log.messages != 1 || !strstr(log.last, words))
		fail_msg("%s: result %d instead of %d, %d lines, \"%s\" lacks \"%s\"", path, got,
			 result, log.messages, log.last, words);
	assert_true(volume.slope == 42);
	assert_null(volume.voxels);
}

/* Slice k of a series whose numbers are 100 k + 10 row + column - 50. */
static struct dicom_sample slice_of(const char *series, int k, int16_t pixels[6], char position[64])
{
	for (int i = 0; i < 6; i++)
		pixels[i] = (int16_t)(100 * k + 10 * (i / 3) + i % 3 - 50);
	snprintf(position, 64, "-10\\-20\\%g", 2.5 * k);
	struct dicom_sample sample = dicom_sample_make(series, 9 - k, pixels);
	sample.position = position;
	sample.spacing = "0.75\\0.5";
	return sample;
}

static void write_series(const char *series, const char *prefix, int slices)
{
	static const int shuffled[] = { 2, 0, 3, 1 };
	for (int i = 0; i < slices; i++) {
		int16_t pixels[6];
		char position[64], name[64];
		struct dicom_sample sample = slice_of(series, shuffled[i], pixels, position);
		snprintf(name, sizeof name, "%s%d", prefix, i);
		dicom_sample_write(&sample, name);
	}
}

static void check_series(const struct gz_volume *volume)
{
	assert_int_equal(volume->dims[0], 3);
	assert_int_equal(volume->dims[1], 2);
	assert_int_equal(volume->dims[2], 4);
	assert_true(fabs(volume->spacing[0] - 0.5) < 1e-9);
	assert_true(fabs(volume->spacing[1] - 0.75) < 1e-9);
	assert_true(fabs(volume->spacing[2] - 2.5) < 1e-9);
	assert_true(volume->oriented);
	/* Columns go to the patient's left, rows to the back; ours go right and to the front. */
	for (int z = 0; z < 4; z++)
		for (int y = 0; y < 2; y++)
			for (int x = 0; x < 3; x++) {
				const double expected = 100 * z + 10 * (1 - y) + (2 - x) - 50;
				if (value_at(volume, x, y, z) != expected)
					fail_msg("(%d, %d, %d): %g, not %g", x, y, z,
						 value_at(volume, x, y, z), expected);
			}
}

static void folder_of_one_series_is_ordered_by_place_and_turned(void **state)
{
	(void)state;
	write_series(SERIES, "IM", 4);
	files_write("notes.txt", "no DICOM", 8);
	struct gz_volume volume = load(files_folder());
	check_series(&volume);
	gz_volume_free(&volume);
}

static void file_stands_for_its_series_among_others(void **state)
{
	(void)state;
	write_series(SERIES, "a", 4);
	write_series("1.2.3.4.6", "b.", 2);
	struct gz_volume volume = load(files_path("a2"));
	check_series(&volume);
	gz_volume_free(&volume);
	check_refused(files_folder(), GZ_ERR_FORMAT, "holds 2 series; name one file");
}

/* Two series, each in a folder two levels down. */
static void write_tree(void)
{
	char command[1024];
	write_series(SERIES, "a", 4);
	write_series("1.2.3.4.6", "b.", 2);
	snprintf(command, sizeof command,
		 "cd %s && mkdir -p t/one/x t/two && mv a? t/one/x && mv b.? t/two",
		 files_folder());
	assert_int_equal(system(command), 0);
}

static void remove_tree(void)
{
	char command[1024];
	snprintf(command, sizeof command, "rm -r %s/t", files_folder());
	assert_int_equal(system(command), 0);
}

static void sub_folders_are_looked_through(void **state)
{
	(void)state;
	write_tree();
	check_refused(files_path("t"), GZ_ERR_FORMAT, "holds 2 series");
	struct gz_volume volume = load(files_path("t/one"));
	check_series(&volume);
	gz_volume_free(&volume);
	files_write("t/two/DICOMDIR", "", 0);
	volume = load(files_path("t/two"));
	assert_int_equal(volume.dims[2], 2);
	gz_volume_free(&volume);
	remove_tree();
}

static void uid_chooses_one_of_several_series(void **state)
{
	(void)state;
	struct captured_log log;
	struct gz_volume volume = { 0 };
	struct gz_loading loading = { .series_uid = SERIES };
	write_tree();
	captured_log_init(&log, NULL);
	assert_int_equal(gz_volume_load(files_path("t"), NULL, &loading, &log.log, &volume), GZ_OK);
	check_series(&volume);
	gz_volume_free(&volume);
	loading.series_uid = "9.9";
	assert_int_equal(gz_volume_load(files_path("t"), NULL, &loading, &log.log, &volume),
			 GZ_ERR_NOT_FOUND);
	assert_non_null(strstr(log.last, "no series 9.9 here"));
	assert_int_equal(log.messages, 3); /* two series are listed */
	remove_tree();
}

static void dicomdir_stands_for_its_medium(void **state)
{
	(void)state;
	char command[1024];
	write_tree();
	snprintf(command, sizeof command,
		 "cd %s/t && rm -r two && head -c 128 /dev/zero >DICOMDIR && "
		 "printf DICM >>DICOMDIR",
		 files_folder());
	assert_int_equal(system(command), 0);
	struct gz_volume volume = load(files_path("t/DICOMDIR"));
	check_series(&volume);
	gz_volume_free(&volume);
	remove_tree();
}

static void rescale_is_kept_as_slope_and_intercept(void **state)
{
	(void)state;
	const int16_t pixels[6] = { 0, 1, 2, 3, -4, 1000 };
	struct dicom_sample sample = dicom_sample_make(SERIES, 1, pixels);
	sample.slope = "2";
	sample.intercept = "-1024";
	struct gz_volume volume = load(dicom_sample_write(&sample, "one.dcm"));
	assert_int_equal(volume.type, GZ_VOXEL_U16);
	assert_true(value_at(&volume, 2, 1, 0) == -1024);
	assert_true(value_at(&volume, 0, 0, 0) == 2 * 1000 - 1024);
	assert_true(value_at(&volume, 1, 0, 0) == 2 * -4 - 1024);
	gz_volume_free(&volume);
}

/* Two slices, each with a slope of its own; `intercept` NULL: that of dicom_sample_make(). */
static void write_scaled_slices(const int16_t pixels[6], const char *const slopes[2],
				const char *intercept)
{
	for (int k = 0; k < 2; k++) {
		struct dicom_sample sample = dicom_sample_make(SERIES, k, pixels);
		sample.position = k ? "0\\0\\1" : "0\\0\\0";
		sample.slope = slopes[k];
		if (intercept)
			sample.intercept = intercept;
		dicom_sample_write(&sample, k ? "b" : "a");
	}
}

static void slices_with_scales_of_their_own_become_float(void **state)
{
	(void)state;
	const int16_t pixels[6] = { 10, 10, 10, 10, 10, 10 };
	write_scaled_slices(pixels, (const char *[]) { "0.5", "3" }, "1");
	struct gz_volume volume = load(files_folder());
	assert_int_equal(volume.type, GZ_VOXEL_F32);
	assert_true(value_at(&volume, 0, 0, 0) == 6);
	assert_true(value_at(&volume, 0, 0, 1) == 31);
	gz_volume_free(&volume);
}

/* Floats too small to be drawn are stored scaled; the volume's slope takes that back. */
static void tiny_scales_of_their_own_keep_their_values(void **state)
{
	(void)state;
	const int16_t pixels[6] = { 1, 2, 3, 4, 5, 6 };
	write_scaled_slices(pixels, (const char *[]) { "1e-30", "3e-30" }, NULL);
	struct gz_volume volume = load(files_folder());
	assert_true(fabs(value_at(&volume, 2, 1, 0) - 1e-30) < 1e-36);
	assert_true(fabs(value_at(&volume, 0, 0, 1) - 18e-30) < 1e-35);
	gz_volume_free(&volume);
}

/* Floats this small have few bits, so that they are scaled before they are rounded. */
static void denormal_scales_keep_their_digits(void **state)
{
	(void)state;
	const int16_t pixels[6] = { 1, 2, 3, 4, 5, 6 };
	write_scaled_slices(pixels, (const char *[]) { "1.25e-43", "3.5e-43" }, NULL);
	struct gz_volume volume = load(files_folder());
	assert_true(fabs(value_at(&volume, 2, 1, 0) - 1.25e-43) < 1e-49);
	assert_true(fabs(value_at(&volume, 0, 0, 1) - 21e-43) < 1e-48);
	gz_volume_free(&volume);
}

/* Far from 0, single precision would round the differences away. */
static void scales_far_from_zero_keep_differences(void **state)
{
	(void)state;
	const int16_t pixels[6] = { 1, 2, 3, 4, 5, 6 };
	write_scaled_slices(pixels, (const char *[]) { "0.001", "0.002" }, "1e9");
	struct gz_volume volume = load(files_folder());
	for (int k = 0; k < 2; k++)
		if (fabs(value_at(&volume, 0, 0, k) - 1e9 - 0.006 * (k + 1)) > 1e-4)
			fail_msg("slice %d: %.9g", k, value_at(&volume, 0, 0, k) - 1e9);
	gz_volume_free(&volume);
}

static void twelve_bits_are_taken_from_among_others(void **state)
{
	(void)state;
	/* Sign in bit 11, an overlay of old in bit 15. */
	const uint16_t pixels[6] = { 0x8001, 0x0FFF, 0x8800, 0x07FF, 0, 1 };
	struct dicom_sample sample = dicom_sample_make(SERIES, 1, (const int16_t *)pixels);
	sample.bits_stored = 12;
	sample.high_bit = 11;
	struct gz_volume volume = load(dicom_sample_write(&sample, "one.dcm"));
	assert_true(value_at(&volume, 2, 1, 0) == 1);
	assert_true(value_at(&volume, 1, 1, 0) == -1);
	assert_true(value_at(&volume, 0, 1, 0) == -2048);
	assert_true(value_at(&volume, 2, 0, 0) == 2047);
	gz_volume_free(&volume);
}

static void frames_of_one_file_are_slices(void **state)
{
	(void)state;
	const uint8_t pixels[12] = { 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12 };
	struct dicom_sample sample = dicom_sample_make(SERIES, 1, NULL);
	sample.frames = 2;
	sample.bits_allocated = sample.bits_stored = 8;
	sample.high_bit = 7;
	sample.is_signed = 0;
	sample.position = NULL;
	sample.pixels = pixels;
	struct gz_volume volume = load(dicom_sample_write(&sample, "frames.dcm"));
	assert_int_equal(volume.type, GZ_VOXEL_U8);
	assert_int_equal(volume.dims[2], 2);
	assert_false(volume.oriented);
	assert_true(value_at(&volume, 0, 0, 0) == 1);
	assert_true(value_at(&volume, 2, 1, 1) == 12);
	gz_volume_free(&volume);
}

static void compressed_series_is_that_of_its_plain_one(void **state)
{
	(void)state;
	static const char *const programs[] = { "dcmcrle",     "dcmcjpls",    "dcmcjpeg",
						"dcmconv +ti", "dcmconv +tb", "dcmconv +td" };
	char command[2048];
	write_series(SERIES, "p", 4);
	for (size_t i = 0; i < sizeof programs / sizeof programs[0]; i++) {
		snprintf(command, sizeof command,
			 "cd %s && for f in p?; do %s $f c$f 2>err || exit 1; done; rm -rf c && "
			 "mkdir c && mv cp? c",
			 files_folder(), programs[i]);
		if (system(command) != 0) {
			print_message("%s is not there; install dcmtk\n", programs[i]);
			skip();
		}
		struct gz_volume volume = load(files_path("c"));
		check_series(&volume);
		gz_volume_free(&volume);
	}
	snprintf(command, sizeof command, "rm -r %s/c", files_folder());
	assert_int_equal(system(command), 0);
}

/* The 3 x 2 numbers of 16 bits as two segments of RLE, high bytes first (PS3.5, annex G). */
struct rle_frame {
	uint8_t bytes[80];
};

static struct rle_frame rle_frame_make(const int16_t pixels[6])
{
	struct rle_frame frame = { { 2, 0, 0, 0, 64, 0, 0, 0, 72 } };
	for (int segment = 0; segment < 2; segment++) {
		uint8_t *at = frame.bytes + 64 + 8 * segment;
		*at++ = 5; /* six bytes as they are */
		for (int i = 0; i < 6; i++)
			*at++ = (uint8_t)((uint16_t)pixels[i] >> (segment == 0 ? 8 : 0));
	}
	return frame;
}

static struct dicom_sample rle_sample(const struct rle_frame *frame)
{
	struct dicom_sample sample = dicom_sample_make(SERIES, 1, NULL);
	sample.transfer_syntax = "1.2.840.10008.1.2.5";
	sample.encapsulated = true;
	sample.pixels = frame->bytes;
	sample.pixel_bytes = sizeof frame->bytes;
	return sample;
}

static void run_lengths_are_decoded(void **state)
{
	(void)state;
	const int16_t pixels[6] = { 0, 1, -2, 300, -4000, 5 };
	const struct rle_frame frame = rle_frame_make(pixels);
	const struct dicom_sample sample = rle_sample(&frame);
	struct gz_volume volume = load(dicom_sample_write(&sample, "rle"));
	for (int i = 0; i < 6; i++)
		assert_true(value_at(&volume, 2 - i % 3, 1 - i / 3, 0) == pixels[i]);
	gz_volume_free(&volume);
}

/* Such an offset made a decoder read far beyond its memory. */
static void run_lengths_beyond_the_frame_are_refused(void **state)
{
	(void)state;
	const int16_t pixels[6] = { 0, 1, -2, 300, -4000, 5 };
	static const uint8_t offsets[][4] = {
		{ 0, 0, 0x80, 0x7f }, { 80, 0, 0, 0 }, { 64, 0, 0, 0 }, { 0xff, 0xff, 0xff, 0xff }
	};
	for (size_t i = 0; i < sizeof offsets / sizeof offsets[0]; i++) {
		struct rle_frame frame = rle_frame_make(pixels);
		memcpy(frame.bytes + 8, offsets[i], 4);
		const struct dicom_sample sample = rle_sample(&frame);
		check_refused(dicom_sample_write(&sample, "rle"), GZ_ERR_FORMAT, "are damaged");
	}
}

/* A 3 x 2 image of three bytes a pixel; pixel i is voxel 2 - i % 3, 1 - i / 3. */
static struct dicom_sample colour_sample(const uint8_t pixels[18])
{
	struct dicom_sample sample = dicom_sample_make(SERIES, 1, NULL);
	sample.samples_per_pixel = 3;
	sample.bits_allocated = sample.bits_stored = 8;
	sample.high_bit = 7;
	sample.is_signed = 0;
	sample.pixels = pixels;
	sample.pixel_bytes = 18;
	return sample;
}

static void check_colours(const char *path, const uint8_t rgb[18])
{
	struct gz_volume volume = load(path);
	assert_int_equal(volume.colour, GZ_COLOUR_LUMINANCE);
	assert_true(volume.dims[0] == 3 && volume.dims[1] == 2 && volume.dims[2] == 1);
	for (int i = 0; i < 6; i++) {
		const int at = (1 - i / 3) * 3 + 2 - i % 3;
		for (int c = 0; c < 3; c++)
			assert_int_equal(gz_colour_byte(volume.colours[at], c), rgb[3 * i + c]);
		assert_int_equal(((const uint8_t *)volume.voxels)[at],
				 gz_colour_luminance(rgb + 3 * i));
	}
	gz_volume_free(&volume);
	unlink(path);
}

static const uint8_t made_rgb[18] = { 255, 0, 0,  0,   255, 0,   0,   0, 255,
				      9,   8, 70, 255, 255, 255, 200, 1, 128 };

static void colours_are_read_pixel_by_pixel_and_in_planes(void **state)
{
	(void)state;
	uint8_t planes[18];
	for (int i = 0; i < 18; i++)
		planes[i % 3 * 6 + i / 3] = made_rgb[i];
	struct dicom_sample sample = colour_sample(made_rgb);
	sample.slope = "2"; /* which colours do not have */
	check_colours(dicom_sample_write(&sample, "rgb"), made_rgb);
	sample = colour_sample(planes);
	sample.planar = true;
	check_colours(dicom_sample_write(&sample, "planes"), made_rgb);
}

/* By the formula of PS3.3, C.7.6.3.1.2. */
static void colour_differences_become_colours(void **state)
{
	(void)state;
	static const uint8_t ybr[18] = { 76, 85, 255, 150, 44,  21,  29,  255, 107,
					 0,  0,  0,   255, 128, 128, 255, 255, 255 };
	static const uint8_t rgb[18] = { 254, 0,   0, 0,   255, 1,   0,   0,   254,
					 0,   135, 0, 255, 255, 255, 255, 121, 255 };
	struct dicom_sample sample = colour_sample(ybr);
	sample.photometric = "YBR_FULL";
	check_colours(dicom_sample_write(&sample, "ybr"), rgb);
}

static void table_of_colours_is_looked_up(void **state)
{
	(void)state;
	static const uint8_t stored[18] = { 0, 10, 11, 12, 13, 255 }; /* six of them */
	static const uint16_t wide[12] = { 0x1000, 0x2080, 0x30FF, 0xFF00, 0x0500, 0x0600,
					   0x0700, 0x0800, 0xA000, 0xB000, 0xC000, 0xD000 };
	static const uint16_t narrow[12] = { 0x10, 0x20, 0x30, 0xFF, 0x05, 0x06,
					     0x07, 0x08, 0xA0, 0xB0, 0xC0, 0xD0 };
	static const int entries[6] = { 0, 0, 1, 2, 3, 3 }; /* of stored, from 10 on */
	const struct {
		const uint16_t *palette;
		int bits;
	} tables[] = { { wide, 16 }, { narrow, 8 }, { narrow, 16 } };
	uint8_t rgb[18];
	for (int i = 0; i < 18; i++)
		rgb[i] = (uint8_t)narrow[i % 3 * 4 + entries[i / 3]];
	struct dicom_sample sample = colour_sample(stored);
	sample.samples_per_pixel = 1;
	sample.pixel_bytes = 6;
	sample.photometric = "PALETTE COLOR";
	sample.palette_count = 4;
	sample.palette_first = 10;
	for (size_t i = 0; i < 3; i++) {
		sample.palette = tables[i].palette;
		sample.palette_bits = tables[i].bits;
		check_colours(dicom_sample_write(&sample, "palette"), rgb);
	}
	sample.palette = NULL;
	check_refused(dicom_sample_write(&sample, "none"), GZ_ERR_UNSUPPORTED,
		      "table of colours is missing");
	sample.palette = wide;
	sample.palette_bits = 12;
	check_refused(dicom_sample_write(&sample, "none"), GZ_ERR_UNSUPPORTED,
		      "table of colours is missing, damaged");
}

static void colours_of_other_kinds_are_refused(void **state)
{
	(void)state;
	struct dicom_sample sample = colour_sample(made_rgb);
	sample.photometric = "YBR_FULL_422";
	check_refused(dicom_sample_write(&sample, "x"), GZ_ERR_UNSUPPORTED, "without compression");
	sample.photometric = "CMYK";
	check_refused(dicom_sample_write(&sample, "x"), GZ_ERR_UNSUPPORTED, "CMYK; read are");
	sample.photometric = "MONOCHROME2";
	check_refused(dicom_sample_write(&sample, "x"), GZ_ERR_UNSUPPORTED, "colour, 3 values");
	sample = colour_sample(made_rgb);
	sample.frames = 2;
	check_refused(dicom_sample_write(&sample, "x"), GZ_ERR_FORMAT, "truncated");
}

/* What DCMTK compresses, and what it makes of that again. */
static void compressed_colours_are_those_that_dcmtk_decodes(void **state)
{
	(void)state;
	enum { EDGE = 32 };
	static const struct {
		const char *pack, *unpack;
	} ways[] = {
		{ "dcmcrle", "dcmdrle" },
		{ "dcmcjpls", "dcmdjpls" },
		{ "dcmcjpeg +e1", "dcmdjpeg" },
		{ "dcmcjpeg +eb +s4", "dcmdjpeg +cn" },
		{ "dcmcjpeg +eb +s2", "dcmdjpeg +cn" },
		{ "dcmcjpeg +eb +cr", "dcmdjpeg" },
		{ "gdcmconv --j2k", "sh -c 'cp plain.dcm again'" }, /* lossless */
	};
	static uint8_t pixels[3 * EDGE * EDGE];
	char command[2048];
	for (int i = 0; i < EDGE * EDGE; i++) {
		pixels[3 * i] = (uint8_t)(8 * (i % EDGE));
		pixels[3 * i + 1] = (uint8_t)(8 * (i / EDGE));
		pixels[3 * i + 2] = (uint8_t)(i % EDGE * (i / EDGE) / 4);
	}
	struct dicom_sample sample = colour_sample(pixels);
	sample.columns = sample.rows = EDGE;
	sample.pixel_bytes = sizeof pixels;
	for (size_t i = 0; i < sizeof ways / sizeof ways[0]; i++) {
		(void)dicom_sample_write(&sample, "plain.dcm");
		snprintf(command, sizeof command,
			 "cd %s && %s plain.dcm packed 2>err && %s packed again 2>err && "
			 "rm plain.dcm err && mkdir -p a b && mv packed a && mv again b",
			 files_folder(), ways[i].pack, ways[i].unpack);
		if (system(command) != 0) {
			print_message("%s is not there; install dcmtk\n", ways[i].pack);
			skip();
		}
		struct gz_volume packed = load(files_path("a/packed"));
		struct gz_volume wanted = load(files_path("b/again"));
		assert_int_equal(packed.colour, GZ_COLOUR_LUMINANCE);
		for (int k = 0; k < EDGE * EDGE; k++)
			for (int c = 0; c < 3; c++) {
				const int got = gz_colour_byte(packed.colours[k], c);
				const int it_has = gz_colour_byte(wanted.colours[k], c);
				if (got != it_has)
					fail_msg("%s: pixel %d channel %d: %d, not %d",
						 ways[i].pack, k, c, got, it_has);
			}
		gz_volume_free(&packed);
		gz_volume_free(&wanted);
	}
	snprintf(command, sizeof command, "cd %s && rm -r a b", files_folder());
	assert_int_equal(system(command), 0);
}

static void file_without_preamble_is_read(void **state)
{
	(void)state;
	const int16_t pixels[6] = { 7, 8, 9, 10, 11, 12 };
	struct dicom_sample sample = dicom_sample_make(SERIES, 1, pixels);
	sample.bare = true;
	const char *path = dicom_sample_write(&sample, "bare.img");
	struct gz_volume volume = load(path);
	assert_true(value_at(&volume, 2, 1, 0) == 7 && value_at(&volume, 0, 0, 0) == 12);
	gz_volume_free(&volume);
	unlink(path);
	files_write("other.img", "\b\0\5\0 this begins only a little like DICOM", 40);
	check_refused(files_path("other.img"), GZ_ERR_UNSUPPORTED, "unknown format");
}

/* An element of Siemens' header as GDCM and others describe it: name, VM, VR, type, items, each of
 * them with four lengths. */
static size_t put_csa_element(uint8_t *out, const char *name, const char *const *values, int count)
{
	uint8_t *at = out;
	memset(at, 0, 64 + 20);
	strcpy((char *)at, name);
	at[64] = (uint8_t)count; /* VM */
	memcpy(at + 68, "FD", 2);
	at[72] = 4; /* what Siemens calls FD */
	at[76] = 6; /* items */
	at[80] = 77;
	at += 84;
	for (int i = 0; i < 6; i++) {
		const size_t size = i < count ? strlen(values[i]) + 1 : 0;
		memset(at, 0, 16);
		at[0] = at[4] = at[12] = (uint8_t)size;
		at[8] = 77;
		at += 16;
		memset(at, 0, (size + 3) & ~(size_t)3);
		memcpy(at, i < count ? values[i] : "", size);
		at += (size + 3) & ~(size_t)3;
	}
	return (size_t)(at - out);
}

/* Three slices of 2 x 2 as tiles of a 4 x 4 image; the normal goes against that of the planes. */
static void mosaic_is_split_into_its_slices(void **state)
{
	(void)state;
	static const char *const number[] = { "3" };
	static const char *const upward[] = { "0", "0", "1" }, *const downward[] = { "0", "0",
										     "-1" };
	int16_t pixels[16];
	uint8_t csa[2048];
	for (int y = 0; y < 4; y++)
		for (int x = 0; x < 4; x++)
			pixels[4 * y + x] =
				(int16_t)(100 * (2 * (y / 2) + x / 2) + 10 * (y % 2) + x % 2);
	for (int down = 0; down < 2; down++) {
		memcpy(csa, "SV10\4\3\2\1\2\0\0\0\x4d\0\0\0", 16);
		size_t size = 16;
		size += put_csa_element(csa + size, "NumberOfImagesInMosaic", number, 1);
		size += put_csa_element(csa + size, "SliceNormalVector", down ? downward : upward,
					3);
		struct dicom_sample sample = dicom_sample_make(SERIES, 1, pixels);
		sample.columns = sample.rows = 4;
		sample.pixel_bytes = sizeof pixels;
		sample.image_type = "ORIGINAL\\PRIMARY\\M\\MOSAIC";
		sample.thickness = "2.5";
		sample.csa = csa;
		sample.csa_bytes = size;
		struct gz_volume volume = load(dicom_sample_write(&sample, "mosaic"));
		assert_int_equal(volume.dims[0], 2);
		assert_int_equal(volume.dims[1], 2);
		assert_int_equal(volume.dims[2], 3);
		assert_true(fabs(volume.spacing[2] - 2.5) < 1e-9);
		for (int z = 0; z < 3; z++)
			for (int y = 0; y < 2; y++)
				for (int x = 0; x < 2; x++)
					assert_true(value_at(&volume, x, y, z) ==
						    100 * (down ? 2 - z : z) + 10 * (1 - y) + 1 -
							    x);
		gz_volume_free(&volume);
	}
}

static void missing_slice_is_refused(void **state)
{
	(void)state;
	write_series(SERIES, "s", 4);
	unlink(files_path("s3"));
	check_refused(files_folder(), GZ_ERR_FORMAT,
		      "1 of 4 slices, 2.5 mm apart, is missing: 1 between 0 and 5 mm; add what is "
		      "missing, or open it with --resample (scene key volume.resample)");
}

static void missing_slice_is_interpolated_on_request(void **state)
{
	(void)state;
	write_series(SERIES, "s", 4);
	unlink(files_path("s3"));
	struct gz_volume volume =
		load_resampled(files_folder(), GZ_RESAMPLING_LINEAR,
			       "resampled (linear) from 3 slices to 4, 2.5 mm apart");
	assert_int_equal(volume.type, GZ_VOXEL_U16);
	assert_true(volume.slope == 1);
	check_series(&volume); /* its numbers grow evenly along the stack */
	gz_volume_free(&volume);
	volume = load_resampled(files_folder(), GZ_RESAMPLING_NEAREST, "resampled (nearest)");
	assert_int_equal(volume.dims[2], 4);
	assert_true(value_at(&volume, 2, 1, 1) == value_at(&volume, 2, 1, 0));
	gz_volume_free(&volume);
}

/* Slice k of those at 0, 2.5, 5 and 6 mm holds 100 k - 50 and on. */
static void uneven_slices_are_refused_or_interpolated(void **state)
{
	(void)state;
	for (int k = 0; k < 4; k++) {
		int16_t pixels[6];
		char position[64], name[16];
		struct dicom_sample sample = slice_of(SERIES, k, pixels, position);
		if (k == 3)
			sample.position = "-10\\-20\\6";
		sample.slope = "3";
		snprintf(name, sizeof name, "u%d", k);
		dicom_sample_write(&sample, name);
	}
	check_refused(
		files_folder(), GZ_ERR_FORMAT,
		"its slices lie 1 to 2.5 mm apart, most 2.5: 1 mm between 5 and 6 mm; open it "
		"with --resample (scene key volume.resample)");
	struct gz_volume volume = load_resampled(files_folder(), GZ_RESAMPLING_LINEAR,
						 "from 4 slices to 7, 1 mm apart");
	static const double whole[7] = { -50, -10, 30, 70, 110, 150, 250 };
	for (int z = 0; z < 7; z++)
		if (fabs(value_at(&volume, 2, 1, z) - 3 * whole[z]) > 1e-9)
			fail_msg("slice %d: %g, not %g", z, value_at(&volume, 2, 1, z),
				 3 * whole[z]);
	gz_volume_free(&volume);
}

/* Each slice lies 1.5 mm, two rows, further down than the one 2.5 mm below it: atan(1.5 / 2.5). */
static void write_tilted(void)
{
	for (int k = 0; k < 4; k++) {
		int16_t pixels[6];
		char position[64], name[16];
		struct dicom_sample sample = slice_of(SERIES, k, pixels, position);
		snprintf(position, sizeof position, "-10\\%g\\%g", 1.5 * k, 2.5 * k);
		snprintf(name, sizeof name, "t%d", k);
		dicom_sample_write(&sample, name);
	}
}

static void tilted_gantry_is_said_and_straightened_on_request(void **state)
{
	(void)state;
	struct captured_log log;
	struct gz_volume volume = { 0 };
	write_tilted();
	captured_log_init(&log, "*:warn");
	assert_int_equal(gz_volume_load(files_folder(), NULL, NULL, &log.log, &volume), GZ_OK);
	check_series(&volume);
	gz_volume_free(&volume);
	if (log.messages != 1 || !strstr(log.last, "tilted by 31.0 degrees") ||
	    !strstr(log.last, "--resample (scene key volume.resample)"))
		fail_msg("%d lines, %s", log.messages, log.last);
	volume = load_resampled(files_folder(), GZ_RESAMPLING_LINEAR, "tilted by 31.0 degrees");
	assert_int_equal(volume.dims[1], 8);
	assert_int_equal(volume.dims[2], 4);
	for (int z = 0; z < 4; z++)
		for (int y = 0; y < 8; y++) {
			const int row = 7 - y - 2 * z; /* of the slice, from its front */
			const double expected = row < 0 || row > 1 ? -50 : 100 * z + 10 * row - 50;
			if (value_at(&volume, 2, y, z) != expected)
				fail_msg("slice %d, row %d: %g, not %g", z, y,
					 value_at(&volume, 2, y, z), expected);
		}
	gz_volume_free(&volume);
}

/* An even stack stays as it is, without a word. */
static void even_slices_are_not_resampled(void **state)
{
	(void)state;
	const struct gz_loading loading = { .resampling = GZ_RESAMPLING_LINEAR };
	struct captured_log log;
	struct gz_volume volume = { 0 };
	write_series(SERIES, "e", 4);
	captured_log_init(&log, "*:info");
	assert_int_equal(gz_volume_load(files_folder(), NULL, &loading, &log.log, &volume), GZ_OK);
	assert_int_equal(log.messages, 0);
	check_series(&volume);
	gz_volume_free(&volume);
}

static void slices_that_wander_are_said_and_moved_on_request(void **state)
{
	(void)state;
	struct captured_log log;
	struct gz_volume volume = { 0 };
	write_series(SERIES, "w", 4);
	int16_t pixels[6];
	char position[64];
	struct dicom_sample sample = slice_of(SERIES, 1, pixels, position);
	sample.position = "-11.5\\-20\\2.5"; /* three columns to the left */
	dicom_sample_write(&sample, "w3");
	captured_log_init(&log, "*:warn");
	assert_int_equal(gz_volume_load(files_folder(), NULL, NULL, &log.log, &volume), GZ_OK);
	gz_volume_free(&volume);
	if (!strstr(log.last, "shifted by up to 1.5 mm off one line"))
		fail_msg("%s", log.last);
	volume = load_resampled(files_folder(), GZ_RESAMPLING_LINEAR, "off one line");
	assert_int_equal(volume.dims[0], 6);
	assert_true(value_at(&volume, 5, 1, 1) == 50 && value_at(&volume, 2, 1, 1) == -50);
	assert_true(value_at(&volume, 5, 1, 0) == -50 && value_at(&volume, 2, 1, 0) == -50);
	gz_volume_free(&volume);
}

/* Without the last slice the others lie evenly: only a line tells that one is missing. */
static void damaged_file_of_a_series_is_named(void **state)
{
	(void)state;
	write_series(SERIES, "s", 4);
	assert_int_equal(truncate(files_path("s2"), 300), 0);
	struct captured_log log;
	struct gz_volume volume = { 0 };
	captured_log_init(&log, NULL);
	const enum gz_result result = gz_volume_load(files_folder(), NULL, NULL, &log.log, &volume);
	if (result != GZ_OK || log.messages != 1 || !strstr(log.last, "s2: damaged or cut off"))
		fail_msg("result %d, %d messages: %s", result, (int)log.messages, log.last);
	gz_volume_free(&volume);
}

static void what_is_no_grey_stack_is_refused(void **state)
{
	(void)state;
	const int16_t pixels[6] = { 0 };
	struct dicom_sample sample = dicom_sample_make(SERIES, 1, pixels);
	sample.samples_per_pixel = 3;
	check_refused(dicom_sample_write(&sample, "colour.dcm"), GZ_ERR_UNSUPPORTED, "colour");
	empty_folder(NULL);

	sample = dicom_sample_make(SERIES, 1, pixels);
	dicom_sample_write(&sample, "a");
	sample = dicom_sample_make(SERIES, 2, pixels);
	sample.position = "0\\0\\1";
	sample.orientation = "0\\1\\0\\0\\0\\1";
	dicom_sample_write(&sample, "b");
	check_refused(files_folder(), GZ_ERR_FORMAT, "another plane");
	sample.orientation = "1\\0\\0\\0\\1\\0";
	sample.bits_stored = 12;
	sample.high_bit = 11;
	dicom_sample_write(&sample, "b");
	check_refused(files_folder(), GZ_ERR_FORMAT, "not as those of");
	empty_folder(NULL);

	files_write("junk.dcm", "junk", 4);
	check_refused(files_path("junk.dcm"), GZ_ERR_FORMAT, "no DICOM image");
	check_refused(files_folder(), GZ_ERR_FORMAT, "no DICOM image in this folder");
	check_refused(files_path("none.dcm"), GZ_ERR_NOT_FOUND, "No such file");
}

static void file_that_lies_is_refused(void **state)
{
	(void)state;
	const int16_t pixels[6] = { 5, 6, 7, 8, 9, 10 };
	struct dicom_sample sample = dicom_sample_make(SERIES, 1, pixels);
	check_refused(files_write("cut.dcm", "", 0), GZ_ERR_FORMAT, "no DICOM image");
	sample.columns = 16000;
	sample.rows = 16000;
	check_refused(dicom_sample_write(&sample, "cut.dcm"), GZ_ERR_FORMAT, "truncated");
	sample = dicom_sample_make(SERIES, 1, pixels);
	sample.frames = 2000000000;
	check_refused(dicom_sample_write(&sample, "cut.dcm"), GZ_ERR_FORMAT, "truncated");
	sample.frames = 0;
	sample.claimed_bytes = 0x7FFFFFFE;
	check_refused(dicom_sample_write(&sample, "cut.dcm"), GZ_ERR_FORMAT, "");
	sample.claimed_bytes = 0;
	sample.spacing = "0\\1";
	check_refused(dicom_sample_write(&sample, "cut.dcm"), GZ_ERR_FORMAT, "mm apart");
}

TEST_SUITE(volume_dicom)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(folder_of_one_series_is_ordered_by_place_and_turned,
				       empty_folder),
		cmocka_unit_test_setup(file_stands_for_its_series_among_others, empty_folder),
		cmocka_unit_test_setup(sub_folders_are_looked_through, empty_folder),
		cmocka_unit_test_setup(uid_chooses_one_of_several_series, empty_folder),
		cmocka_unit_test_setup(dicomdir_stands_for_its_medium, empty_folder),
		cmocka_unit_test_setup(rescale_is_kept_as_slope_and_intercept, empty_folder),
		cmocka_unit_test_setup(slices_with_scales_of_their_own_become_float, empty_folder),
		cmocka_unit_test_setup(tiny_scales_of_their_own_keep_their_values, empty_folder),
		cmocka_unit_test_setup(denormal_scales_keep_their_digits, empty_folder),
		cmocka_unit_test_setup(scales_far_from_zero_keep_differences, empty_folder),
		cmocka_unit_test_setup(twelve_bits_are_taken_from_among_others, empty_folder),
		cmocka_unit_test_setup(frames_of_one_file_are_slices, empty_folder),
		cmocka_unit_test_setup(compressed_series_is_that_of_its_plain_one, empty_folder),
		cmocka_unit_test_setup(run_lengths_are_decoded, empty_folder),
		cmocka_unit_test_setup(run_lengths_beyond_the_frame_are_refused, empty_folder),
		cmocka_unit_test_setup(colours_are_read_pixel_by_pixel_and_in_planes, empty_folder),
		cmocka_unit_test_setup(colour_differences_become_colours, empty_folder),
		cmocka_unit_test_setup(table_of_colours_is_looked_up, empty_folder),
		cmocka_unit_test_setup(colours_of_other_kinds_are_refused, empty_folder),
		cmocka_unit_test_setup(compressed_colours_are_those_that_dcmtk_decodes,
				       empty_folder),
		cmocka_unit_test_setup(file_without_preamble_is_read, empty_folder),
		cmocka_unit_test_setup(mosaic_is_split_into_its_slices, empty_folder),
		cmocka_unit_test_setup(missing_slice_is_refused, empty_folder),
		cmocka_unit_test_setup(missing_slice_is_interpolated_on_request, empty_folder),
		cmocka_unit_test_setup(uneven_slices_are_refused_or_interpolated, empty_folder),
		cmocka_unit_test_setup(tilted_gantry_is_said_and_straightened_on_request,
				       empty_folder),
		cmocka_unit_test_setup(even_slices_are_not_resampled, empty_folder),
		cmocka_unit_test_setup(slices_that_wander_are_said_and_moved_on_request,
				       empty_folder),
		cmocka_unit_test_setup(damaged_file_of_a_series_is_named, empty_folder),
		cmocka_unit_test_setup(what_is_no_grey_stack_is_refused, empty_folder),
		cmocka_unit_test_setup(file_that_lies_is_refused, empty_folder),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
