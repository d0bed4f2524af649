#include "suite.h"

#include <stdio.h>
#include <string.h>
#include <zstd.h>

#include "render/data/raw_guess.h"
#include "volume_files.h"

struct named {
	const char *name;
	uint64_t bytes;
	int dims[3];
	enum gz_raw_type type;
	bool big;
	double spacing[3]; /* 0: not known */
};

#define CUBE(n)         \
	{               \
		n, n, n \
	}

/* Names as people give them, and what is best. */
static const struct named names[] = {
	{ "bonsai_256x256x256_uint8.raw", 16777216, CUBE(256), GZ_RAW_UINT8, false, { 0 } },
	{ "/data/a.b/head-64x64x93-uint16le.raw.zst",
	  64 * 64 * 93 * 2,
	  { 64, 64, 93 },
	  GZ_RAW_UINT16,
	  false,
	  { 0 } },
	{ "256_256_128_u8", 256 * 256 * 128, { 256, 256, 128 }, GZ_RAW_UINT8, false, { 0 } },
	{ "foot_256_256_128_u8.raw",
	  256 * 256 * 128,
	  { 256, 256, 128 },
	  GZ_RAW_UINT8,
	  false,
	  { 0 } },
	{ "ct_512x512x361_int16be.raw",
	  512 * 512 * 361 * 2,
	  { 512, 512, 361 },
	  GZ_RAW_INT16,
	  true,
	  { 0 } },
	{ "ct_512x512x361_int16_be.raw.gz",
	  512 * 512 * 361 * 2,
	  { 512, 512, 361 },
	  GZ_RAW_INT16,
	  true,
	  { 0 } },
	{ "skull_512x512x361_0.5x0.5x1_int16.raw",
	  512 * 512 * 361 * 2,
	  { 512, 512, 361 },
	  GZ_RAW_INT16,
	  false,
	  { 0.5, 0.5, 1 } },
	{ "stent_0.8398x0.8398x3.2_512x512x174_uint16.raw",
	  512 * 512 * 174 * 2,
	  { 512, 512, 174 },
	  GZ_RAW_UINT16,
	  false,
	  { 0.8398, 0.8398, 3.2 } },
	{ "statue_leg_341x341x93_1x1x4_uint8.raw",
	  341 * 341 * 93,
	  { 341, 341, 93 },
	  GZ_RAW_UINT8,
	  false,
	  { 1, 1, 4 } },
	{ "boston_teapot_256x256x178_uint8.raw",
	  256 * 256 * 178,
	  { 256, 256, 178 },
	  GZ_RAW_UINT8,
	  false,
	  { 0 } },
	{ "magnetic_reconnection_512x512x512_float32.raw",
	  512UL * 512 * 512 * 4,
	  CUBE(512),
	  GZ_RAW_FLOAT32,
	  false,
	  { 0 } },
	{ "miranda_1024x1024x1024_float32.raw",
	  1024UL * 1024 * 1024 * 4,
	  CUBE(1024),
	  GZ_RAW_FLOAT32,
	  false,
	  { 0 } },
	{ "tacc_turbulence_256x256x256_float64.raw",
	  256UL * 256 * 256 * 8,
	  CUBE(256),
	  GZ_RAW_FLOAT64,
	  false,
	  { 0 } },
	{ "Aneurism.256x256x256.uint8.raw", 16777216, CUBE(256), GZ_RAW_UINT8, false, { 0 } },
	{ "engine.256.256.128.raw",
	  256 * 256 * 128,
	  { 256, 256, 128 },
	  GZ_RAW_UINT8,
	  false,
	  { 0 } },
	{ "marschner_lobb_41x41x41_uint8.raw", 41 * 41 * 41, CUBE(41), GZ_RAW_UINT8, false, { 0 } },
	{ "head256x256x109.raw",
	  256 * 256 * 109 * 2,
	  { 256, 256, 109 },
	  GZ_RAW_UINT16,
	  false,
	  { 0 } },
	{ "head256x256x109_MSB_short.raw",
	  256 * 256 * 109 * 2,
	  { 256, 256, 109 },
	  GZ_RAW_INT16,
	  true,
	  { 0 } },
	{ "lobster 301x324x56 8bit.raw",
	  301 * 324 * 56,
	  { 301, 324, 56 },
	  GZ_RAW_UINT8,
	  false,
	  { 0 } },
	{ "lobster_301x324x56_8bits.bin",
	  301 * 324 * 56,
	  { 301, 324, 56 },
	  GZ_RAW_UINT8,
	  false,
	  { 0 } },
	{ "VisMale_128x256x256_16bit.dat",
	  128 * 256 * 256 * 2,
	  { 128, 256, 256 },
	  GZ_RAW_UINT16,
	  false,
	  { 0 } },
	{ "mri_ventricles-256-256-124-ushort.raw",
	  256 * 256 * 124 * 2,
	  { 256, 256, 124 },
	  GZ_RAW_UINT16,
	  false,
	  { 0 } },
	{ "scan_2021_03_17_128_128_64_u16.raw",
	  128 * 128 * 64 * 2,
	  { 128, 128, 64 },
	  GZ_RAW_UINT16,
	  false,
	  { 0 } },
	{ "backpack8bit_512_512_373.raw",
	  512 * 512 * 373,
	  { 512, 512, 373 },
	  GZ_RAW_UINT8,
	  false,
	  { 0 } },
	{ "backpack_512x512x373x16.raw",
	  512 * 512 * 373 * 2,
	  { 512, 512, 373 },
	  GZ_RAW_UINT16,
	  false,
	  { 0 } },
	{ "volume_100x100x100_f32.raw", 4000000, CUBE(100), GZ_RAW_FLOAT32, false, { 0 } },
	{ "volume_100x100x100_i32.raw", 4000000, CUBE(100), GZ_RAW_INT32, false, { 0 } },
	{ "volume_100x100x100_uint32be.raw", 4000000, CUBE(100), GZ_RAW_UINT32, true, { 0 } },
	{ "volume_100x100x100_32f.raw", 4000000, CUBE(100), GZ_RAW_FLOAT32, false, { 0 } },
	{ "volume_100x100x100_double.raw", 8000000, CUBE(100), GZ_RAW_FLOAT64, false, { 0 } },
	{ "volume-100x100x100-int8.raw", 1000000, CUBE(100), GZ_RAW_INT8, false, { 0 } },
	{ "volume_100x100x100u8.raw", 1000000, CUBE(100), GZ_RAW_UINT8, false, { 0 } },
	{ "volume_100x100x100_unsigned_short.raw",
	  2000000,
	  CUBE(100),
	  GZ_RAW_UINT16,
	  false,
	  { 0 } },
	{ "volume_100\xc3\x97"
	  "90\xc3\x97"
	  "80.raw",
	  720000,
	  { 100, 90, 80 },
	  GZ_RAW_UINT8,
	  false,
	  { 0 } },
	{ "VOLUME_100X90X80_UINT8.RAW", 720000, { 100, 90, 80 }, GZ_RAW_UINT8, false, { 0 } },
	{ "mouse_0.05mm_100x90x80.raw",
	  720000,
	  { 100, 90, 80 },
	  GZ_RAW_UINT8,
	  false,
	  { 0.05, 0.05, 0.05 } },
	{ "slices512x512_uint16.raw",
	  512 * 512 * 77 * 2,
	  { 512, 512, 77 },
	  GZ_RAW_UINT16,
	  false,
	  { 0 } },
	{ "bonsai256.raw", 16777216, CUBE(256), GZ_RAW_UINT8, false, { 0 } },
	{ "bonsai256_short.raw", 33554432, CUBE(256), GZ_RAW_INT16, false, { 0 } },
	{ "engine256.raw", 256 * 256 * 110, { 256, 256, 110 }, GZ_RAW_UINT8, false, { 0 } },
	{ "unknown.raw", 128 * 128 * 128, CUBE(128), GZ_RAW_UINT8, false, { 0 } },
	{ "unknown.raw", 100 * 100 * 100 * 2, CUBE(100), GZ_RAW_UINT16, false, { 0 } },
	{ "unknown_float.raw", 100 * 100 * 100 * 4, CUBE(100), GZ_RAW_FLOAT32, false, { 0 } },
	{ "unknown.raw", 512 * 512 * 113, { 512, 512, 113 }, GZ_RAW_UINT8, false, { 0 } },
	/* The name is wrong about the type: the size is not. */
	{ "wrong_64x64x64_uint8.raw", 64 * 64 * 64 * 2, CUBE(64), GZ_RAW_UINT16, false, { 0 } },
	/* The name is wrong about the slices. */
	{ "part_64x64x64_uint8.raw", 64 * 64 * 8, { 64, 64, 8 }, GZ_RAW_UINT8, false, { 0 } },
};

static void name_and_size_tell_the_layout(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
		struct gz_raw_guess guesses[GZ_RAW_GUESSES_MAX];
		const struct named *row = &names[i];
		const size_t count =
			gz_raw_guess(row->name, row->bytes, guesses, GZ_RAW_GUESSES_MAX);
		if (count == 0)
			fail_msg("%s: nothing is guessed", row->name);
		const struct gz_raw_layout *best = &guesses[0].layout;
		bool right = memcmp(best->dims, row->dims, sizeof best->dims) == 0 &&
			     best->type == row->type && best->big_endian == row->big;
		for (int axis = 0; axis < 3; axis++)
			right = right && best->spacing[axis] == row->spacing[axis];
		if (!right)
			fail_msg("%s: %d %d %d %s %s spacing %g %g %g (%s)", row->name,
				 best->dims[0], best->dims[1], best->dims[2],
				 gz_raw_type_names[best->type], best->big_endian ? "big" : "little",
				 best->spacing[0], best->spacing[1], best->spacing[2],
				 guesses[0].reason);
	}
}

static void nothing_is_offered_that_does_not_fit_or_twice(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
		struct gz_raw_guess guesses[GZ_RAW_GUESSES_MAX];
		const size_t count =
			gz_raw_guess(names[i].name, names[i].bytes, guesses, GZ_RAW_GUESSES_MAX);
		for (size_t k = 0; k < count; k++) {
			assert_int_equal(gz_raw_layout_bytes(&guesses[k].layout), names[i].bytes);
			assert_true(guesses[k].reason[0] != '\0');
			for (size_t m = 0; m < k; m++)
				assert_false(memcmp(&guesses[k].layout, &guesses[m].layout,
						    sizeof guesses[k].layout) == 0);
		}
	}
}

static void layout_of_colours_has_bytes_for_each_channel(void **state)
{
	(void)state;
	struct gz_raw_layout layout = { .dims = { 5, 4, 3 }, .type = GZ_RAW_UINT16 };
	static const struct {
		int channels;
		uint64_t bytes;
	} cases[] = {
		{ 0, 120 }, { 1, 120 }, { 2, 0 }, { 3, 360 }, { 4, 480 }, { 5, 0 }, { -1, 0 }
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		layout.channels = cases[i].channels;
		assert_int_equal(gz_raw_layout_bytes(&layout), cases[i].bytes);
	}
}

static void what_no_layout_fits_is_left_to_the_user(void **state)
{
	(void)state;
	struct gz_raw_guess guesses[GZ_RAW_GUESSES_MAX];
	assert_int_equal(gz_raw_guess("scan.raw", 7919, guesses, GZ_RAW_GUESSES_MAX), 0);
	assert_int_equal(gz_raw_guess("64x64x64_uint8.raw", 7919, guesses, GZ_RAW_GUESSES_MAX), 0);
	assert_int_equal(gz_raw_guess("", 7919, guesses, GZ_RAW_GUESSES_MAX), 0);
	assert_int_equal(gz_raw_guess("99999x99999x99999_u8.raw", 0, guesses, 1), 0);
	assert_int_equal(gz_raw_guess("9999999999999999999999x1x1.raw", 1, guesses, 1), 0);
}

static void of_unknown_size_only_a_name_that_says_all_is_understood(void **state)
{
	(void)state;
	struct gz_raw_guess guesses[GZ_RAW_GUESSES_MAX];
	assert_int_equal(gz_raw_guess("64x64x93_u16.raw.zst", 0, guesses, GZ_RAW_GUESSES_MAX), 1);
	assert_false(guesses[0].certain);
	assert_int_equal(guesses[0].layout.dims[2], 93);
	assert_int_equal(gz_raw_guess("64x64x93.raw.zst", 0, guesses, GZ_RAW_GUESSES_MAX), 0);
	assert_int_equal(gz_raw_guess("bonsai256_u8.raw.zst", 0, guesses, GZ_RAW_GUESSES_MAX), 0);
}

static void certain_is_only_what_the_name_says_in_full(void **state)
{
	(void)state;
	static const struct {
		const char *name;
		uint64_t bytes;
		bool certain;
	} rows[] = {
		{ "a_64x64x64_uint8.raw", 64 * 64 * 64, true },
		{ "a_64x64x64.raw", 64 * 64 * 64, true },
		{ "a_64x64x64_u16.raw", 64 * 64 * 64 * 2, true },
		{ "a_64x64x64.raw", 64 * 64 * 64 * 2, false },
		{ "a_64x64x64_uint8.raw", 64 * 64 * 64 * 2, false },
		{ "a_64x64_uint8.raw", 64 * 64 * 64, false },
		{ "a64.raw", 64 * 64 * 64, false },
		{ "a.raw", 64 * 64 * 64, false },
	};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		struct gz_raw_guess guess;
		assert_int_equal(gz_raw_guess(rows[i].name, rows[i].bytes, &guess, 1), 1);
		if (guess.certain != rows[i].certain)
			fail_msg("%s: certain is %d", rows[i].name, guess.certain);
	}
}

static void bytes_of_a_file_are_those_that_come_out_of_it(void **state)
{
	(void)state;
	static unsigned char plain[10000], packed[20000];
	assert_int_equal(gz_raw_file_bytes(files_write("a.raw", plain, 123)), 123);
	size_t size = ZSTD_compress(packed, sizeof packed, plain, sizeof plain, 1);
	assert_int_equal(gz_raw_file_bytes(files_write("a.raw.zst", packed, size)), sizeof plain);
	size = files_deflate(plain, sizeof plain, 31, packed, sizeof packed);
	assert_int_equal(gz_raw_file_bytes(files_write("a.raw.gz", packed, size)), sizeof plain);
	assert_int_equal(gz_raw_file_bytes(files_write("b.raw.gz", packed, 10)), 0);
	assert_int_equal(gz_raw_file_bytes(files_write("b.raw.zst", plain, 10)), 0);
	assert_int_equal(gz_raw_file_bytes(files_path("none.raw")), 0);
	assert_int_equal(gz_raw_file_bytes(files_folder()), 0);
}

/* A name that claims 2048 voxels along each edge, and a file of a kilobyte. */
static void name_and_size_that_disagree_are_told(void **state)
{
	(void)state;
	struct gz_raw_layout layout = { 0 };
	assert_true(gz_raw_name_contradicts("big_2048x2048x2048_uint8.raw", 1000, &layout));
	assert_int_equal(layout.dims[2], 2048);
	assert_false(gz_raw_name_contradicts("big_10x10x10_uint8.raw", 1000, &layout));
	assert_false(gz_raw_name_contradicts("big_2048x2048x2048_uint8.raw", 0, &layout));
	assert_false(gz_raw_name_contradicts("mystery.raw", 1000, &layout));
}

TEST_SUITE(raw_guess)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(name_and_size_tell_the_layout),
		cmocka_unit_test(nothing_is_offered_that_does_not_fit_or_twice),
		cmocka_unit_test(layout_of_colours_has_bytes_for_each_channel),
		cmocka_unit_test(what_no_layout_fits_is_left_to_the_user),
		cmocka_unit_test(of_unknown_size_only_a_name_that_says_all_is_understood),
		cmocka_unit_test(certain_is_only_what_the_name_says_in_full),
		cmocka_unit_test(name_and_size_that_disagree_are_told),
		cmocka_unit_test(bytes_of_a_file_are_those_that_come_out_of_it),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
