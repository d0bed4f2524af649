/* Slices that do not lie evenly, and the grid that they are resampled onto: hand-computed values,
 * and a linear function, which linear interpolation gives back wherever slices lie. */
#include "suite.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "render/decode/dicom/slice_grid.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static struct gz_slice_gaps gaps_of(const double *along_mm, size_t count)
{
	struct gz_slice_gaps gaps;
	assert_int_equal(gz_slice_gaps_find(along_mm, count, &gaps), GZ_OK);
	return gaps;
}

static void check_near(double got, double expected)
{
	if (!(fabs(got - expected) < 1e-9))
		fail_msg("%g, not %g", got, expected);
}

static void positions_rounded_in_a_file_are_even(void **state)
{
	(void)state;
	const double along[] = { -5, -2.5, 0.01, 2.5, 4.99 };
	const struct gz_slice_gaps gaps = gaps_of(along, COUNT(along));
	assert_int_equal(gaps.fault, GZ_SLICES_EVEN);
	assert_int_equal(gaps.missing, 0);
}

static void multiples_of_the_usual_gap_are_missing_slices(void **state)
{
	(void)state;
	const double along[] = { 0, 2, 4, 8, 10, 16 };
	const struct gz_slice_gaps gaps = gaps_of(along, COUNT(along));
	assert_int_equal(gaps.fault, GZ_SLICES_MISSING);
	assert_int_equal(gaps.missing, 3);
	check_near(gaps.usual_mm, 2);
	check_near(gaps.greatest_mm, 6);
	assert_int_equal(gz_slice_gap_steps(&gaps, 6.2), 3);
	assert_int_equal(gz_slice_gap_steps(&gaps, 6.8), 0);
	assert_int_equal(gz_slice_gap_steps(&gaps, 1), 0);
	assert_int_equal(gz_slice_gap_steps(&gaps, 2e9), 0);
}

/* Of two gaps the smaller one is usual: one slice of four is missing, not an extra one there. */
static void smaller_of_two_gaps_is_usual(void **state)
{
	(void)state;
	const double along[] = { 0, 5, 7.5 };
	const struct gz_slice_gaps gaps = gaps_of(along, COUNT(along));
	assert_int_equal(gaps.fault, GZ_SLICES_MISSING);
	assert_int_equal(gaps.missing, 1);
	check_near(gaps.usual_mm, 2.5);
}

static void other_gaps_are_uneven(void **state)
{
	(void)state;
	const double along[] = { 0, 2, 3, 5 };
	const struct gz_slice_gaps gaps = gaps_of(along, COUNT(along));
	assert_int_equal(gaps.fault, GZ_SLICES_UNEVEN);
	assert_int_equal(gaps.missing, 0);
	check_near(gaps.least_mm, 1);
	check_near(gaps.greatest_mm, 2);
}

static struct gz_slice_grid grid_of(const struct gz_slice_stack *stack, enum gz_resampling how)
{
	const struct gz_slice_gaps gaps = gaps_of(stack->along_mm, stack->count);
	struct gz_slice_grid grid;
	assert_int_equal(gz_slice_grid_make(stack, &gaps, how, &grid), GZ_OK);
	return grid;
}

static void check_mix(const struct gz_slice_grid *grid, int index, size_t lower, double weight)
{
	const struct gz_slice_mix mix = gz_slice_grid_mix(grid, index);
	if (mix.lower != lower || fabs(mix.weight - weight) > 1e-9)
		fail_msg("slice %d: %g of %zu, not %g of %zu", index, mix.weight, mix.lower + 1,
			 weight, lower + 1);
}

static void missing_slices_are_mixed_and_others_kept(void **state)
{
	(void)state;
	const double along[] = { 0, 2, 4, 8.01, 10, 16 };
	const struct gz_slice_stack stack = { COUNT(along), along, NULL, 3, 2, { 1, 1 }, 1, 1 };
	struct gz_slice_grid grid = grid_of(&stack, GZ_RESAMPLING_LINEAR);
	assert_int_equal(grid.dims[2], 9);
	check_near(grid.spacing_mm, 2);
	assert_false(grid.shifted);
	check_mix(&grid, 0, 0, 0);
	check_mix(&grid, 2, 2, 0);
	check_mix(&grid, 3, 2, 0.5);
	check_mix(&grid, 4, 3, 0); /* not its neighbour's, though 0.01 mm away */
	check_mix(&grid, 6, 4, 1.0 / 3);
	check_mix(&grid, 8, 5, 0);
	gz_slice_grid_free(&grid);
	grid = grid_of(&stack, GZ_RESAMPLING_NEAREST);
	check_mix(&grid, 3, 2, 0); /* in the middle: the lower one */
	check_mix(&grid, 6, 4, 0);
	check_mix(&grid, 7, 5, 0);
	gz_slice_grid_free(&grid);
}

static void uneven_slices_get_the_smallest_gap(void **state)
{
	(void)state;
	const double along[] = { 0, 2, 3, 5 };
	const struct gz_slice_stack stack = { COUNT(along), along, NULL, 3, 2, { 1, 1 }, 1, 1 };
	struct gz_slice_grid grid = grid_of(&stack, GZ_RESAMPLING_LINEAR);
	assert_int_equal(grid.dims[2], 6);
	check_near(grid.spacing_mm, 1);
	check_mix(&grid, 1, 0, 0.5);
	check_mix(&grid, 2, 1, 0);
	check_mix(&grid, 4, 2, 0.5);
	check_mix(&grid, 5, 3, 0);
	gz_slice_grid_free(&grid);
}

/* 5.25 mm are no multiple of 1 mm: six gaps of 0.875 mm keep both ends. */
static void both_ends_of_an_uneven_stack_are_kept(void **state)
{
	(void)state;
	const double along[] = { 1, 2, 3.5, 6.25 };
	const struct gz_slice_stack stack = { COUNT(along), along, NULL, 3, 2, { 1, 1 }, 1, 1 };
	struct gz_slice_grid grid = grid_of(&stack, GZ_RESAMPLING_LINEAR);
	assert_int_equal(grid.dims[2], 7);
	check_near(grid.spacing_mm, 0.875);
	check_mix(&grid, 1, 0, 0.875);
	check_mix(&grid, 2, 1, (1.75 - 1) / 1.5);
	check_mix(&grid, 6, 3, 0);
	gz_slice_grid_free(&grid);
}

/* Two slices close to each other do not make thousands. */
static void grid_has_a_limited_number_of_slices(void **state)
{
	(void)state;
	const double close[] = { 0, 0.01, 10, 20 };
	const double far[] = { 0, 1, 2, 16000 };
	const double *const stacks[] = { close, far };
	for (size_t i = 0; i < COUNT(stacks); i++) {
		const struct gz_slice_stack stack = { 4, stacks[i], NULL, 3, 2, { 1, 1 }, 1, 1 };
		struct gz_slice_grid grid = grid_of(&stack, GZ_RESAMPLING_LINEAR);
		assert_int_equal(grid.dims[2], 4 * GZ_SLICE_GROWTH_MAX);
		check_near(grid.spacing_mm * (grid.dims[2] - 1), stacks[i][3]);
		check_mix(&grid, grid.dims[2] - 1, 3, 0);
		gz_slice_grid_free(&grid);
	}
}

static void check_plane(const double *got, const double *expected, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (isnan(got[i]) != isnan(expected[i]) || fabs(got[i] - expected[i]) > 1e-12)
			fail_msg("number %zu: %g, not %g", i, got[i], expected[i]);
}

/* 3 x 2 numbers, moved by a quarter of a column, by one column, and by half a row. */
static void shifted_slices_are_moved_within_the_plane(void **state)
{
	(void)state;
	const int16_t voxels[] = { 4, 8, -12, 20, 0, 40 };
	const double along[] = { 0, 1, 2 };
	const double right[][2] = { { 7, 0 }, { 7.5, 0 }, { 9, 0 } };
	const double down[][2] = { { 0, -1 }, { 0, -2.5 }, { 0, -4 } };
	const double kept[] = { 4, 8, -12, NAN, 20, 0, 40, NAN };
	const double quarter[] = { NAN, 7, -7, NAN, NAN, 5, 30, NAN };
	const double whole[] = { NAN, 4, 8, -12, NAN, 20, 0, 40 };
	const double half[] = { NAN, NAN, NAN, 12, 4, 14, NAN, NAN, NAN };
	struct gz_slice_stack stack = { 3, along, right, 3, 2, { 2, 3 }, 1, 1 };
	double plane[9];
	struct gz_slice_grid grid = grid_of(&stack, GZ_RESAMPLING_LINEAR);
	assert_true(grid.shifted && grid.dims[0] == 4 && grid.dims[1] == 2);
	gz_slice_grid_lay(&grid, 0, GZ_RAW_INT16, voxels, plane);
	check_plane(plane, kept, 8);
	gz_slice_grid_lay(&grid, 1, GZ_RAW_INT16, voxels, plane);
	check_plane(plane, quarter, 8);
	gz_slice_grid_lay(&grid, 2, GZ_RAW_INT16, voxels, plane);
	check_plane(plane, whole, 8);
	gz_slice_grid_free(&grid);
	stack.shift_mm = down;
	grid = grid_of(&stack, GZ_RESAMPLING_LINEAR);
	assert_true(grid.shifted && grid.dims[0] == 3 && grid.dims[1] == 3);
	gz_slice_grid_lay(&grid, 1, GZ_RAW_INT16, voxels, plane);
	check_plane(plane, half, 9);
	gz_slice_grid_free(&grid);
	grid = grid_of(&stack, GZ_RESAMPLING_NEAREST);
	gz_slice_grid_lay(&grid, 1, GZ_RAW_INT16, voxels, plane);
	for (int i = 0; i < 9; i++) /* half a row: no number that was not there */
		assert_true(isnan(plane[i]) || plane[i] == 4 || plane[i] == 8 || plane[i] == -12 ||
			    plane[i] == 20 || plane[i] == 0 || plane[i] == 40);
	gz_slice_grid_free(&grid);
}

/* Two time points of two slices with two numbers a voxel; the second is one column to the right. */
static void channels_and_time_points_move_together(void **state)
{
	(void)state;
	const uint32_t voxels[] = { 4000000001, 1, 4000000003, 3 };
	const double along[] = { 0, 1 };
	const double shift[][2] = { { 0, 0 }, { 0.5, 0 }, { 2, 0 }, { 2, 0 } };
	const double first[] = { 4000000001, 1, 4000000003, 3, NAN, NAN };
	const double quarter[] = { NAN, NAN, 4000000002.5, 2.5, NAN, NAN };
	const double later[] = { NAN, NAN, 4000000001, 1, 4000000003, 3 };
	const struct gz_slice_stack stack = { 2, along, shift, 2, 1, { 2, 1 }, 2, 2 };
	struct gz_slice_grid grid = grid_of(&stack, GZ_RESAMPLING_LINEAR);
	double plane[6];
	assert_true(grid.dims[0] == 3 && grid.dims[1] == 1 && grid.dims[2] == 2);
	gz_slice_grid_lay(&grid, 0, GZ_RAW_UINT32, voxels, plane);
	check_plane(plane, first, 6);
	gz_slice_grid_lay(&grid, 1, GZ_RAW_UINT32, voxels, plane);
	check_plane(plane, quarter, 6);
	for (size_t i = 2; i < 4; i++) {
		gz_slice_grid_lay(&grid, i, GZ_RAW_UINT32, voxels, plane);
		check_plane(plane, later, 6);
	}
	gz_slice_grid_free(&grid);
}

static void slices_far_from_each_other_are_refused(void **state)
{
	(void)state;
	const double along[] = { 0, 1 };
	const double shift[][2] = { { 0, 0 }, { 28, 0 } }, endless[][2] = { { 0, 0 }, { NAN, 0 } };
	struct gz_slice_stack stack = { 2, along, shift, 3, 2, { 3, 1 }, 1, 1 };
	const struct gz_slice_gaps gaps = gaps_of(along, 2);
	struct gz_slice_grid grid = { .count = 42 };
	assert_int_equal(gz_slice_grid_make(&stack, &gaps, GZ_RESAMPLING_LINEAR, &grid),
			 GZ_ERR_FORMAT);
	stack.shift_mm = endless;
	assert_int_equal(gz_slice_grid_make(&stack, &gaps, GZ_RESAMPLING_LINEAR, &grid),
			 GZ_ERR_FORMAT);
	assert_int_equal(grid.count, 42);
}

static void mixed_numbers_are_rounded_and_holes_filled(void **state)
{
	(void)state;
	const double lower[] = { 10, -3, NAN, 100, 5 }, upper[] = { 13, -4, 7, NAN, 6 };
	struct gz_slice_pair pair = { lower, upper, 0.5, -50 };
	int16_t words[5];
	float floats[5];
	const int16_t expected[] = { 12, -4, -50, -50, 6 };
	gz_slice_pair_mix(&pair, 5, GZ_RAW_INT16, words);
	assert_memory_equal(words, expected, sizeof words);
	gz_slice_pair_mix(&pair, 5, GZ_RAW_FLOAT32, floats);
	assert_true(floats[0] == 11.5F && floats[1] == -3.5F && floats[2] == -50);
	/* Without the upper one its holes do not matter. */
	pair.weight = 0;
	pair.upper = NULL;
	pair.fill = 0;
	uint8_t bytes[5];
	const double whole[] = { 0, 255, 17, NAN, 1 };
	pair.lower = whole;
	gz_slice_pair_mix(&pair, 5, GZ_RAW_UINT8, bytes);
	assert_true(bytes[0] == 0 && bytes[1] == 255 && bytes[2] == 17 && bytes[3] == 0);
	/* Not a float: it would be above the greatest number. */
	uint32_t wide[1];
	pair.lower = (const double[]) { UINT32_MAX };
	gz_slice_pair_mix(&pair, 1, GZ_RAW_UINT32, wide);
	assert_int_equal(wide[0], UINT32_MAX);
}

static void least_number_of_each_type_is_found(void **state)
{
	(void)state;
	const uint16_t words[] = { 65535, 3, 4 };
	const int8_t bytes[] = { 5, -128, 127 };
	const float floats[] = { NAN, 2, -1e30F };
	assert_true(gz_slice_least(GZ_RAW_UINT16, words, 3) == 3);
	assert_true(gz_slice_least(GZ_RAW_INT8, bytes, 3) == -128);
	assert_true(gz_slice_least(GZ_RAW_FLOAT32, floats, 3) == (double)-1e30F);
}

/* A linear function of the place in space, mm. */
static double linear_at(double x, double y, double along)
{
	return 40 + 3 * x - 2 * y + 5 * along;
}

/* A slice whose numbers are that function. */
static void fill_slice(const struct gz_slice_stack *stack, size_t slice, float *voxels)
{
	for (int y = 0; y < stack->rows; y++)
		for (int x = 0; x < stack->columns; x++)
			voxels[y * stack->columns + x] =
				(float)linear_at(x * stack->spacing[0] + stack->shift_mm[slice][0],
						 y * stack->spacing[1] + stack->shift_mm[slice][1],
						 stack->along_mm[slice]);
}

static void linear_function_comes_back_from_any_stack(void **state)
{
	(void)state;
	enum { COLUMNS = 9, ROWS = 7, SLICES = 5 };
	const double along[SLICES] = { -4, -1.5, -1, 3.25, 6 };
	double shift[SLICES][2];
	for (int i = 0; i < SLICES; i++) {
		shift[i][0] = 10 - 0.21 * along[i];
		shift[i][1] = 0.4 * along[i];
	}
	const struct gz_slice_stack stack = { SLICES,  along, (const double(*)[2])shift,
					      COLUMNS, ROWS,  { 0.5, 0.75 },
					      1,       1 };
	struct gz_slice_grid grid = grid_of(&stack, GZ_RESAMPLING_LINEAR);
	float voxels[COLUMNS * ROWS], mixed[32 * 32];
	double planes[2][32 * 32];
	int covered = 0;
	assert_true(grid.dims[0] < 32 && grid.dims[1] < 32);
	const size_t count = (size_t)grid.dims[0] * (size_t)grid.dims[1];
	for (int z = 0; z < grid.dims[2]; z++) {
		const struct gz_slice_mix mix = gz_slice_grid_mix(&grid, z);
		for (size_t i = 0; i < 2 && mix.lower + i < SLICES; i++) {
			fill_slice(&stack, mix.lower + i, voxels);
			gz_slice_grid_lay(&grid, mix.lower + i, GZ_RAW_FLOAT32, voxels, planes[i]);
		}
		const struct gz_slice_pair pair = { planes[0], planes[1], mix.weight, -1e6 };
		gz_slice_pair_mix(&pair, count, GZ_RAW_FLOAT32, mixed);
		for (size_t i = 0; i < count; i++) {
			const double x = (double)(i % (size_t)grid.dims[0]) * 0.5 + shift[4][0];
			const double y = (double)(i / (size_t)grid.dims[0]) * 0.75 + shift[0][1];
			const double expected = linear_at(x, y, along[0] + z * grid.spacing_mm);
			if (mixed[i] == -1e6F)
				continue;
			covered++;
			if (fabs((double)mixed[i] - expected) > 1e-3)
				fail_msg("slice %d, number %zu: %g, not %g", z, i, (double)mixed[i],
					 expected);
		}
	}
	assert_true(covered > grid.dims[2] * COLUMNS * ROWS / 3);
	gz_slice_grid_free(&grid);
}

TEST_SUITE(slice_grid)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(positions_rounded_in_a_file_are_even),
		cmocka_unit_test(multiples_of_the_usual_gap_are_missing_slices),
		cmocka_unit_test(smaller_of_two_gaps_is_usual),
		cmocka_unit_test(other_gaps_are_uneven),
		cmocka_unit_test(missing_slices_are_mixed_and_others_kept),
		cmocka_unit_test(uneven_slices_get_the_smallest_gap),
		cmocka_unit_test(both_ends_of_an_uneven_stack_are_kept),
		cmocka_unit_test(grid_has_a_limited_number_of_slices),
		cmocka_unit_test(shifted_slices_are_moved_within_the_plane),
		cmocka_unit_test(channels_and_time_points_move_together),
		cmocka_unit_test(slices_far_from_each_other_are_refused),
		cmocka_unit_test(mixed_numbers_are_rounded_and_holes_filled),
		cmocka_unit_test(least_number_of_each_type_is_found),
		cmocka_unit_test(linear_function_comes_back_from_any_stack),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
