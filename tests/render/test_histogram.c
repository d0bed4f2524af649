/* Histograms against a count of every voxel by itself. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "render/data/brick_file.h"
#include "render/data/format.h"
#include "render/transfer/histogram.h"
#include "volume_files.h"

static struct gz_volume volume_of(int x, int y, int z, enum gz_voxel_type type)
{
	struct gz_volume volume = { .dims = { x, y, z }, .spacing = { 1, 1, 1 }, .type = type };
	assert_int_equal(gz_volume_allocate(&volume), GZ_OK);
	return volume;
}

static void put(struct gz_volume *volume, size_t i, double value)
{
	if (volume->type == GZ_VOXEL_U8)
		((uint8_t *)volume->voxels)[i] = (uint8_t)value;
	else if (volume->type == GZ_VOXEL_U16)
		((uint16_t *)volume->voxels)[i] = (uint16_t)value;
	else
		((float *)volume->voxels)[i] = (float)value;
}

/* Values from a generator of its own (Marsaglia's xorshift, 2003), from least to greatest. */
static struct gz_volume noise(int x, int y, int z, enum gz_voxel_type type, double least,
			      double greatest)
{
	struct gz_volume volume = volume_of(x, y, z, type);
	uint32_t state = 2463534242u;
	for (size_t i = 0; i < gz_volume_voxel_count(&volume); i++) {
		state ^= state << 13;
		state ^= state >> 17;
		state ^= state << 5;
		const double share = state / 4294967296.0;
		put(&volume, i, floor(least + share * share * (greatest - least + 1)));
	}
	gz_volume_find_range(&volume);
	return volume;
}

static struct gz_histogram counted(const struct gz_volume *volume, int bins, int threads)
{
	struct gz_histogram histogram;
	assert_int_equal(gz_histogram_count(volume, bins, threads, NULL, NULL, &histogram), GZ_OK);
	return histogram;
}

/* Each voxel by itself, by what the header says of bins. */
static void assert_as_counted_one_by_one(const struct gz_volume *volume,
					 const struct gz_histogram *histogram)
{
	uint64_t *counts = calloc((size_t)histogram->bins, sizeof *counts);
	uint64_t most = 0;
	assert_non_null(counts);
	const size_t voxels = gz_volume_voxel_count(volume);
	for (size_t i = 0; i < voxels; i++) {
		const double value =
			volume->slope * gz_voxel_stored(volume->type, volume->voxels, i) +
			volume->intercept;
		const int bin = histogram->width > 0
					? (int)((value - histogram->low) / histogram->width)
					: 0;
		counts[bin < histogram->bins ? bin : histogram->bins - 1]++;
	}
	for (int i = 0; i < histogram->bins; i++) {
		if (histogram->counts[i] != counts[i])
			fail_msg("bin %d: %llu, not %llu", i,
				 (unsigned long long)histogram->counts[i],
				 (unsigned long long)counts[i]);
		most = counts[i] > most ? counts[i] : most;
	}
	assert_int_equal(histogram->total, voxels);
	assert_int_equal(histogram->most, most);
	assert_false(histogram->approximate);
	free(counts);
}

static void every_type_is_counted_as_one_by_one(void **state)
{
	(void)state;
	static const struct {
		enum gz_voxel_type type;
		double least, greatest;
		int bins, bins_made;
	} cases[] = {
		{ GZ_VOXEL_U8, 0, 255, 256, 256 },    { GZ_VOXEL_U8, 17, 200, 1024, 184 },
		{ GZ_VOXEL_U16, 0, 65535, 512, 512 }, { GZ_VOXEL_U16, 100, 1599, 1024, 750 },
		{ GZ_VOXEL_U16, 3, 5, 256, 3 },       { GZ_VOXEL_F32, -1000, 3096, 1000, 1000 },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct gz_volume volume =
			noise(131, 127, 71, cases[i].type, cases[i].least, cases[i].greatest);
		const struct gz_histogram one = counted(&volume, cases[i].bins, 1);
		assert_int_equal(one.bins, cases[i].bins_made);
		if (cases[i].type != GZ_VOXEL_F32)
			assert_as_counted_one_by_one(&volume, &one);
		else
			assert_int_equal(one.total, gz_volume_voxel_count(&volume));
		const struct gz_histogram three = counted(&volume, cases[i].bins, 3);
		assert_memory_equal(&one, &three, sizeof one);
		gz_volume_free(&volume);
	}
}

static void floats_fall_into_equal_bins(void **state)
{
	(void)state;
	/* 0.5 to 511.5: the middle of each of 512 bins but for the ends, which the range ends at.
	 */
	struct gz_volume volume = volume_of(512, 3, 2, GZ_VOXEL_F32);
	for (size_t i = 0; i < gz_volume_voxel_count(&volume); i++)
		put(&volume, i, (double)(i % 512) + (i % 512 == 511 ? 1 : i % 512 == 0 ? 0 : 0.5));
	gz_volume_find_range(&volume);
	const struct gz_histogram histogram = counted(&volume, 512, 2);
	assert_int_equal(histogram.bins, 512);
	assert_true(histogram.low == 0 && histogram.width == 1);
	for (int i = 0; i < 512; i++)
		assert_int_equal(histogram.counts[i], 6);
	gz_volume_free(&volume);
}

static void one_value_makes_one_bin(void **state)
{
	(void)state;
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++) {
		struct gz_volume volume = volume_of(1, 1, 1, (enum gz_voxel_type)type);
		put(&volume, 0, 7);
		gz_volume_find_range(&volume);
		const struct gz_histogram histogram = counted(&volume, 256, 0);
		assert_int_equal(histogram.bins, 1);
		assert_int_equal(histogram.counts[0], 1);
		assert_true(histogram.data_min == 7 && histogram.data_max == 7);
		assert_true(gz_histogram_percentile(&histogram, 0.5) == 7);
		assert_true(gz_histogram_threshold(&histogram) == 7);
		double two[2];
		gz_histogram_two_thresholds(&histogram, two);
		assert_true(two[0] == 7 && two[1] == 7);
		assert_int_equal(gz_histogram_bin_of(&histogram, 100), 0);
		gz_volume_free(&volume);
	}
}

static void data_values_rise_though_the_slope_falls(void **state)
{
	(void)state;
	struct gz_volume volume = volume_of(4, 1, 1, GZ_VOXEL_U8);
	for (size_t i = 0; i < 4; i++)
		put(&volume, i, i == 3 ? 12 : 10);
	gz_volume_find_range(&volume);
	volume.slope = -2;
	volume.intercept = 100;
	const struct gz_histogram histogram = counted(&volume, 256, 1);
	assert_int_equal(histogram.bins, 3);
	assert_true(histogram.data_min == 76 && histogram.data_max == 80);
	assert_true(histogram.low == 75 && histogram.width == 2);
	assert_int_equal(histogram.counts[0], 1); /* 12 is 76 */
	assert_int_equal(histogram.counts[1], 0);
	assert_int_equal(histogram.counts[2], 3);
	assert_true(gz_histogram_bin_value(&histogram, 2) == 80);
	assert_int_equal(gz_histogram_bin_of(&histogram, 79.5), 2);
	gz_volume_free(&volume);
}

static void percentiles_part_the_voxels_by_share(void **state)
{
	(void)state;
	struct gz_volume volume = volume_of(100, 10, 1, GZ_VOXEL_U8);
	for (size_t i = 0; i < 1000; i++)
		put(&volume, i, (double)(i / 10)); /* 0 to 99, ten each */
	gz_volume_find_range(&volume);
	const struct gz_histogram histogram = counted(&volume, 256, 1);
	for (int i = 1; i < 100; i++)
		assert_float_equal(gz_histogram_percentile(&histogram, i / 100.0), i - 0.5, 1e-9);
	assert_true(gz_histogram_percentile(&histogram, 0) == 0);
	assert_true(gz_histogram_percentile(&histogram, 1) == 99);
	assert_true(gz_histogram_percentile(&histogram, 2) == 99);
	gz_volume_free(&volume);
}

static void thresholds_lie_between_the_parts(void **state)
{
	(void)state;
	struct gz_volume volume = volume_of(1000, 1, 1, GZ_VOXEL_U16);
	for (size_t i = 0; i < 1000; i++)
		put(&volume, i, i < 700 ? 10 + (double)(i % 11) : 80 + (double)(i % 7));
	gz_volume_find_range(&volume);
	struct gz_histogram histogram = counted(&volume, 256, 1);
	/* 20 ends the lower part and 80 begins the upper: the middle. */
	assert_float_equal(gz_histogram_threshold(&histogram), 50, 0.6);
	for (size_t i = 900; i < 1000; i++)
		put(&volume, i, 200);
	gz_volume_find_range(&volume);
	histogram = counted(&volume, 256, 1);
	double two[2];
	gz_histogram_two_thresholds(&histogram, two);
	assert_float_equal(two[0], 50, 0.6);
	assert_float_equal(two[1], (86 + 200) / 2.0, 0.6);
	gz_volume_free(&volume);
}

static struct gz_volume as_bricks(const struct gz_volume *volume, const char *path)
{
	struct gz_volume bricks;
	assert_int_equal(gz_bricks_write(volume, path, NULL, NULL), GZ_OK);
	assert_int_equal(gz_volume_load(path, NULL, NULL, NULL, &bricks), GZ_OK);
	assert_non_null(bricks.bricks);
	return bricks;
}

static void few_bricks_are_counted_as_the_volume_is(void **state)
{
	(void)state;
	for (int type = 0; type < GZ_VOXEL_TYPE_COUNT; type++) {
		struct gz_volume volume =
			noise(70, 33, 65, (enum gz_voxel_type)type, 3, type ? 1000 : 250);
		struct gz_volume bricks = as_bricks(&volume, files_path("few.gzb"));
		const struct gz_histogram whole = counted(&volume, 256, 2);
		const struct gz_histogram by_bricks = counted(&bricks, 256, 2);
		assert_memory_equal(&whole, &by_bricks, sizeof whole);
		gz_volume_free(&bricks);
		gz_volume_free(&volume);
	}
}

static void many_bricks_are_counted_roughly_and_told_so(void **state)
{
	(void)state;
	/* 20 x 20 x 2 bricks; a ramp, whose coarser levels are spread alike. */
	struct gz_volume volume = volume_of(640, 640, 33, GZ_VOXEL_U8);
	for (size_t i = 0; i < gz_volume_voxel_count(&volume); i++)
		put(&volume, i, (double)(i % 640 * 256 / 640));
	gz_volume_find_range(&volume);
	struct gz_volume bricks = as_bricks(&volume, files_path("many.gzb"));
	const struct gz_histogram whole = counted(&volume, 256, 2);
	const struct gz_histogram rough = counted(&bricks, 256, 2);
	assert_true(rough.approximate);
	assert_int_equal(rough.bins, whole.bins);
	assert_true(rough.low == whole.low && rough.width == whole.width);
	assert_true(rough.total >= whole.total / 16 && rough.total <= whole.total / 4);
	for (int i = 1; i < 10; i++)
		assert_float_equal(gz_histogram_percentile(&rough, i / 10.0),
				   gz_histogram_percentile(&whole, i / 10.0), 2);
	gz_volume_free(&bricks);
	gz_volume_free(&volume);
}

static void bricks_cut_off_under_the_reader_are_refused_or_left_out(void **state)
{
	(void)state;
	struct gz_volume volume = noise(70, 33, 65, GZ_VOXEL_U8, 3, 250);
	const char *path = files_path("cut.gzb");
	struct gz_volume bricks = as_bricks(&volume, path);
	/* The bricks of level 0 come first; half a brick before their end is missing now. */
	const off_t behind = (off_t)gz_brick_data_offset(13, 12, GZ_VOXEL_U8);
	assert_int_equal(truncate(path, behind + 5 * GZ_BRICK_VOXELS), 0);
	struct gz_histogram histogram;
	assert_int_equal(gz_histogram_count(&bricks, 256, 1, NULL, NULL, &histogram), GZ_OK);
	assert_true(histogram.approximate);
	assert_true(histogram.total > 0);
	assert_true(histogram.total < gz_volume_voxel_count(&volume));
	assert_int_equal(truncate(path, 0), 0);
	struct captured_log log;
	captured_log_init(&log, NULL);
	assert_int_not_equal(gz_histogram_count(&bricks, 256, 1, NULL, &log.log, &histogram),
			     GZ_OK);
	assert_int_equal(log.messages, 1);
	assert_non_null(strstr(log.last, "cut.gzb: no histogram: no brick can be read"));
	gz_volume_free(&bricks);
	gz_volume_free(&volume);
}

static void counting_is_cancelled_and_wrong_arguments_refused(void **state)
{
	(void)state;
	struct gz_volume volume = noise(64, 64, 64, GZ_VOXEL_U8, 0, 255);
	struct gz_histogram histogram = { .bins = -1 };
	const atomic_bool cancelled = true;
	assert_int_equal(gz_histogram_count(&volume, 256, 2, &cancelled, NULL, &histogram),
			 GZ_ERR_CANCELLED);
	assert_int_equal(gz_histogram_count(&volume, 255, 2, NULL, NULL, &histogram), GZ_ERR_INVAL);
	assert_int_equal(gz_histogram_count(&volume, 1025, 2, NULL, NULL, &histogram),
			 GZ_ERR_INVAL);
	assert_int_equal(gz_histogram_count(&volume, 256, -1, NULL, NULL, &histogram),
			 GZ_ERR_INVAL);
	assert_int_equal(histogram.bins, -1);
	gz_volume_free(&volume);
}

TEST_SUITE(histogram)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_type_is_counted_as_one_by_one),
		cmocka_unit_test(floats_fall_into_equal_bins),
		cmocka_unit_test(one_value_makes_one_bin),
		cmocka_unit_test(data_values_rise_though_the_slope_falls),
		cmocka_unit_test(percentiles_part_the_voxels_by_share),
		cmocka_unit_test(thresholds_lie_between_the_parts),
		cmocka_unit_test(few_bricks_are_counted_as_the_volume_is),
		cmocka_unit_test(many_bricks_are_counted_roughly_and_told_so),
		cmocka_unit_test(bricks_cut_off_under_the_reader_are_refused_or_left_out),
		cmocka_unit_test(counting_is_cancelled_and_wrong_arguments_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
