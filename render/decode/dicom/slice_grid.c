#include "render/decode/dicom/slice_grid.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/order.h"

/* How far a gap of several steps may be from a multiple, in steps (chosen: with a half any gap is
 * one). */
#define MULTIPLE_MOST 0.25

/* A weight, or a part of a pixel, below this counts as 0. Chosen: it changes a number of 12 bits by
 * less than a half, and positions in files are rounded to more. */
#define SNAP 1e-4

size_t gz_slice_gap_steps(const struct gz_slice_gaps *gaps, double gap_mm)
{
	const double steps = gap_mm / gaps->usual_mm, nearest = round(steps);
	const double allowed = fmin(GZ_SLICE_UNEVEN * nearest, MULTIPLE_MOST);
	return nearest >= 1 && nearest <= GZ_VOLUME_DIM_MAX && fabs(steps - nearest) <= allowed
		       ? (size_t)nearest
		       : 0;
}

/* Whether something is missing, once the usual gap is known. */
static void judge_gaps(const double *sorted, size_t count, struct gz_slice_gaps *gaps)
{
	for (size_t i = 0; i < count; i++) {
		const size_t steps = gz_slice_gap_steps(gaps, sorted[i]);
		if (steps == 0)
			gaps->fault = GZ_SLICES_UNEVEN;
		else
			gaps->missing += steps - 1;
	}
	if (gaps->fault == GZ_SLICES_UNEVEN)
		gaps->missing = 0;
	else if (gaps->missing > 0)
		gaps->fault = GZ_SLICES_MISSING;
}

enum gz_result gz_slice_gaps_find(const double *along_mm, size_t count,
				  struct gz_slice_gaps *out_gaps)
{
	double *sorted = malloc((count - 1) * sizeof *sorted);
	if (!sorted)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i + 1 < count; i++)
		sorted[i] = along_mm[i + 1] - along_mm[i];
	qsort(sorted, count - 1, sizeof *sorted, gz_compare_doubles);
	struct gz_slice_gaps gaps = { .usual_mm = sorted[(count - 2) / 2],
				      .least_mm = sorted[0],
				      .greatest_mm = sorted[count - 2] };
	judge_gaps(sorted, count - 1, &gaps);
	free(sorted);
	*out_gaps = gaps;
	return GZ_OK;
}

/* Gaps of the grid between the first and the last slice of the stack. */
static double count_steps(const struct gz_slice_stack *stack, const struct gz_slice_gaps *gaps)
{
	const double extent = stack->along_mm[stack->count - 1] - stack->along_mm[0];
	const double most =
		fmin(GZ_VOLUME_DIM_MAX - 1, GZ_SLICE_GROWTH_MAX * (double)stack->count - 1);
	const double wanted = gaps->fault == GZ_SLICES_UNEVEN
				      ? ceil(extent / gaps->least_mm - SNAP)
				      : (double)(stack->count - 1 + gaps->missing);
	return fmin(wanted, most);
}

static void place_slices(const struct gz_slice_stack *stack, const struct gz_slice_gaps *gaps,
			 struct gz_slice_grid *grid)
{
	const double steps = count_steps(stack, gaps), *along = stack->along_mm;
	const bool kept = gaps->fault != GZ_SLICES_UNEVEN &&
			  steps == (double)(stack->count - 1 + gaps->missing);
	grid->dims[2] = (int)steps + 1;
	grid->spacing_mm = (along[stack->count - 1] - along[0]) / steps;
	for (size_t i = 0; i < stack->count; i++)
		grid->at[i] = i == 0 ? 0
			      : kept ? grid->at[i - 1] + (double)gz_slice_gap_steps(
								 gaps, along[i] - along[i - 1])
				     : (along[i] - along[0]) / grid->spacing_mm;
}

/* Shifts in voxels of the grid from its first column or row. Returns the greatest; infinity if one
 * is no number. */
static double place_within(const struct gz_slice_stack *stack, int axis,
			   const struct gz_slice_grid *grid)
{
	double least = INFINITY, greatest = 0;
	const size_t count = stack->count * stack->time_points;
	for (size_t i = 0; i < count; i++)
		least = fmin(least, stack->shift_mm[i][axis]);
	for (size_t i = 0; i < count; i++) {
		double shift = (stack->shift_mm[i][axis] - least) / stack->spacing[axis];
		if (grid->how == GZ_RESAMPLING_NEAREST || fabs(shift - round(shift)) < SNAP)
			shift = round(shift);
		if (!isfinite(shift))
			return INFINITY;
		grid->shift[i][axis] = shift;
		greatest = fmax(greatest, shift);
	}
	return greatest;
}

enum gz_result gz_slice_grid_make(const struct gz_slice_stack *stack,
				  const struct gz_slice_gaps *gaps, enum gz_resampling how,
				  struct gz_slice_grid *out_grid)
{
	const int dims[2] = { stack->columns, stack->rows };
	struct gz_slice_grid grid = { .dims = { dims[0], dims[1] },
				      .how = how,
				      .columns = dims[0],
				      .rows = dims[1],
				      .channels = stack->channels,
				      .count = stack->count };
	grid.at = malloc(stack->count * sizeof *grid.at);
	grid.shift = calloc(stack->count * stack->time_points, sizeof *grid.shift);
	grid.row = malloc((size_t)dims[0] * (size_t)stack->channels * sizeof *grid.row);
	if (!grid.at || !grid.shift || !grid.row) {
		gz_slice_grid_free(&grid);
		return GZ_ERR_NO_MEM;
	}
	place_slices(stack, gaps, &grid);
	for (int axis = 0; axis < 2 && stack->shift_mm; axis++) {
		const double more = ceil(place_within(stack, axis, &grid));
		if (!(dims[axis] + more <=
		      fmin(GZ_VOLUME_DIM_MAX, (double)GZ_SLICE_SHIFT_MAX * dims[axis]))) {
			gz_slice_grid_free(&grid);
			return GZ_ERR_FORMAT;
		}
		grid.dims[axis] = dims[axis] + (int)more;
		grid.shifted = grid.shifted || more > 0;
	}
	*out_grid = grid;
	return GZ_OK;
}

void gz_slice_grid_free(struct gz_slice_grid *grid)
{
	free(grid->at);
	free(grid->shift);
	free(grid->row);
	*grid = (struct gz_slice_grid) { 0 };
}

/* The last slice of the stack at or below a place of the grid. */
static size_t find_lower(const struct gz_slice_grid *grid, double place)
{
	size_t low = 0, high = grid->count;
	while (high - low > 1) {
		const size_t middle = low + (high - low) / 2;
		if (grid->at[middle] <= place)
			low = middle;
		else
			high = middle;
	}
	return low;
}

struct gz_slice_mix gz_slice_grid_mix(const struct gz_slice_grid *grid, int index)
{
	const size_t lower = find_lower(grid, index);
	if (lower + 1 == grid->count)
		return (struct gz_slice_mix) { lower, 0 };
	const double gap = grid->at[lower + 1] - grid->at[lower];
	const double weight = (index - grid->at[lower]) / gap;
	if (weight > 1 - SNAP || (grid->how == GZ_RESAMPLING_NEAREST && weight > 0.5))
		return (struct gz_slice_mix) { lower + 1, 0 };
	if (weight < SNAP || grid->how == GZ_RESAMPLING_NEAREST)
		return (struct gz_slice_mix) { lower, 0 };
	return (struct gz_slice_mix) { lower, weight };
}

/* The case of each type that slices have, for `USE(its type)`. */
#define FOR_TYPE(type, USE)    \
	switch (type) {        \
	case GZ_RAW_UINT8:     \
		USE(uint8_t);  \
		break;         \
	case GZ_RAW_INT8:      \
		USE(int8_t);   \
		break;         \
	case GZ_RAW_UINT16:    \
		USE(uint16_t); \
		break;         \
	case GZ_RAW_INT16:     \
		USE(int16_t);  \
		break;         \
	case GZ_RAW_UINT32:    \
		USE(uint32_t); \
		break;         \
	case GZ_RAW_INT32:     \
		USE(int32_t);  \
		break;         \
	default:               \
		USE(float);    \
		break;         \
	}

/* Adds `count` numbers from `first` on, times `weight`, to `sums`. */
static void add_numbers(enum gz_raw_type type, const void *voxels, size_t first, double weight,
			size_t count, double *sums)
{
#define ADD(kind)                          \
	for (size_t i = 0; i < count; i++) \
	sums[i] += weight * (double)((const kind *)voxels)[first + i]
	FOR_TYPE(type, ADD)
#undef ADD
}

/* A row of the grid within one slice, before its columns are moved: what two of its rows make of
 * it. False if one of them is not there. */
static bool mix_rows(const struct gz_slice_grid *grid, double place, enum gz_raw_type type,
		     const void *voxels)
{
	const size_t numbers = (size_t)grid->columns * (size_t)grid->channels;
	const double lower = floor(place), weight = place - lower;
	if (lower < 0 || lower + (weight > 0) > grid->rows - 1)
		return false;
	memset(grid->row, 0, numbers * sizeof *grid->row);
	add_numbers(type, voxels, (size_t)lower * numbers, 1 - weight, numbers, grid->row);
	if (weight > 0)
		add_numbers(type, voxels, ((size_t)lower + 1) * numbers, weight, numbers,
			    grid->row);
	return true;
}

static void leave_open(double *numbers, size_t count)
{
	for (size_t i = 0; i < count; i++)
		numbers[i] = NAN;
}

/* Moves the mixed row to the right by `shift` columns. */
static void move_columns(const struct gz_slice_grid *grid, double shift, double *out)
{
	const size_t channels = (size_t)grid->channels;
	const size_t whole = (size_t)floor(shift), end = (size_t)grid->columns * channels;
	const double *row = grid->row;
	const double weight = shift - (double)whole; /* of the column to the left */
	leave_open(out, (size_t)grid->dims[0] * channels);
	out += whole * channels;
	if (!(weight > 0))
		memcpy(out, row, end * sizeof *out);
	for (size_t i = channels; i < end && weight > 0; i++)
		out[i] = weight * row[i - channels] + (1 - weight) * row[i];
}

void gz_slice_grid_lay(const struct gz_slice_grid *grid, size_t slice, enum gz_raw_type type,
		       const void *voxels, double *plane)
{
	const double *shift = grid->shift[slice];
	const size_t numbers = (size_t)grid->dims[0] * (size_t)grid->channels;
	for (int y = 0; y < grid->dims[1]; y++) {
		double *out = plane + (size_t)y * numbers;
		if (mix_rows(grid, y - shift[1], type, voxels))
			move_columns(grid, shift[0], out);
		else
			leave_open(out, numbers);
	}
}

/* A mixed number; `fill` where there is none. */
static double mixed_number(const struct gz_slice_pair *pair, size_t index)
{
	const double weight = pair->weight;
	const double value =
		weight > 0 ? (1 - weight) * pair->lower[index] + weight * pair->upper[index]
			   : pair->lower[index];
	return isnan(value) ? pair->fill : value;
}

void gz_slice_pair_mix(const struct gz_slice_pair *pair, size_t count, enum gz_raw_type type,
		       void *out_voxels)
{
	if (type == GZ_RAW_FLOAT32) {
		for (size_t i = 0; i < count; i++)
			((float *)out_voxels)[i] = (float)mixed_number(pair, i);
		return;
	}
#define ROUND(kind)                        \
	for (size_t i = 0; i < count; i++) \
	((kind *)out_voxels)[i] = (kind)llround(mixed_number(pair, i))
	FOR_TYPE(type, ROUND)
#undef ROUND
}

double gz_slice_least(enum gz_raw_type type, const void *voxels, size_t count)
{
	double least = INFINITY;
#define LEAST(kind)                        \
	for (size_t i = 0; i < count; i++) \
	least = fmin(least, (double)((const kind *)voxels)[i])
	FOR_TYPE(type, LEAST)
#undef LEAST
	return least;
}
