/**
 * @file
 * How the slices of a stack lie against each other, and the even grid that they are resampled onto.
 *
 * The grid stands upright on the plane of the slices. Its slices are evenly spaced along the
 * normal, so that slices at uneven distances and missing ones are interpolated between their
 * neighbours. Slices that are shifted within their planes, as a tilted gantry makes them, are moved
 * back to where they were (a shear) by interpolation within the plane. Time points lie at the same
 * places along the normal, and have one grid.
 */
#ifndef GZ_RENDER_DECODE_DICOM_SLICE_GRID_H
#define GZ_RENDER_DECODE_DICOM_SLICE_GRID_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#include "base/result.h"
#include "render/data/volume.h"

/** How far a gap between two slices may be from the usual one, as a share. Chosen: positions are
 *  rounded to less, and a missing slice doubles the gap. */
#define GZ_SLICE_UNEVEN 0.05

/** Most slices of a grid for each slice of the stack. Chosen: two slices may lie that much closer
 *  than the average before the grid is coarser than their gap. */
#define GZ_SLICE_GROWTH_MAX 16

/** Most columns and rows of a grid for each of a slice. Chosen: slices of one stack overlap, and
 * the steepest gantry of 30 degrees moves the last of 400 mm by about one width. */
#define GZ_SLICE_SHIFT_MAX 4

/** What is wrong with the gaps of a stack. */
enum gz_slice_fault {
	GZ_SLICES_EVEN,    /**< nothing */
	GZ_SLICES_MISSING, /**< each gap is a multiple of the usual one */
	GZ_SLICES_UNEVEN,  /**< some gaps are no multiples of it */
};

/** The gaps of a stack. */
struct gz_slice_gaps {
	enum gz_slice_fault fault;
	double usual_mm; /**< the median; of two in the middle the smaller one */
	double least_mm, greatest_mm;
	size_t missing; /**< slices; 0 unless the fault is GZ_SLICES_MISSING */
};

/**
 * Measure the gaps of a stack.
 *
 * @param along_mm  where each slice lies along the normal, ascending, no two alike
 * @param count     slices, 2 or more
 * @param[out] out_gaps  written on GZ_OK
 * @retval GZ_ERR_NO_MEM  not logged
 */
enum gz_result gz_slice_gaps_find(const double *along_mm, size_t count,
				  struct gz_slice_gaps *out_gaps);

/** How many usual gaps a gap has: 1 for the usual one, 3 where two slices are missing; 0 if it is
 *  no multiple, or one of more than GZ_VOLUME_DIM_MAX. A multiple may differ by GZ_SLICE_UNEVEN for
 * each step, a quarter of a step at most. */
size_t gz_slice_gap_steps(const struct gz_slice_gaps *gaps, double gap_mm);

/** A stack of slices of one size. All is borrowed. */
struct gz_slice_stack {
	size_t count;           /**< slices, 2 or more */
	const double *along_mm; /**< see gz_slice_gaps_find() */
	/** Where the first voxel of each slice lies within the plane, along its rows and columns,
	 * mm from any origin; of all time points, one behind the other. NULL: all above each other
	 */
	const double (*shift_mm)[2];
	int columns, rows;  /**< of a slice */
	double spacing[2];  /**< between columns, between rows, mm */
	int channels;       /**< numbers of a voxel, 1 or more */
	size_t time_points; /**< stacks of count slices, 1 or more */
};

/** An even grid for a stack. Zero-initialised: none. */
struct gz_slice_grid {
	int dims[3];       /**< columns, rows, slices */
	double spacing_mm; /**< between slices */
	bool shifted;      /**< slices are moved within their planes: some voxels lie in none */
	enum gz_resampling how;
	int columns, rows; /**< of a slice of the stack */
	int channels;      /**< numbers of a voxel */
	size_t count;      /**< slices of the stack */
	double *at;        /**< where each of them lies, in slices of the grid; the first at 0 */
	/** Columns and rows of the grid before the first voxel of each slice of each time point;
	 * not below 0 */
	double (*shift)[2];
	double *row; /**< room for one row of a slice */
};

/**
 * Make the grid of a stack. Slices of an even stack and of one with missing slices lie in slices of
 * the grid and are kept. Other stacks get the smallest gap as spacing, because a coarser grid would
 * lose what the closest slices show (dcm2niix does the same in nii_saveNII3Deq(),
 * https://github.com/rordenlab/dcm2niix), made a little smaller so that the first and last slice
 * are kept. A grid has at most GZ_SLICE_GROWTH_MAX slices for each of the stack, and
 * GZ_VOLUME_DIM_MAX; beyond that its spacing is wider. It is as large as all slices together need.
 *
 * @param gaps  of the stack
 * @param how   not GZ_RESAMPLING_OFF
 * @param[out] out_grid  written on GZ_OK; the caller frees it with gz_slice_grid_free()
 * @retval GZ_ERR_FORMAT  slices are shifted too far: more than GZ_VOLUME_DIM_MAX columns or rows,
 * or more than GZ_SLICE_SHIFT_MAX times those of a slice; not logged
 * @retval GZ_ERR_NO_MEM  not logged
 */
enum gz_result gz_slice_grid_make(const struct gz_slice_stack *stack,
				  const struct gz_slice_gaps *gaps, enum gz_resampling how,
				  struct gz_slice_grid *out_grid);

/** Free what the grid has and zero it. Accepts a zero-initialised one. */
void gz_slice_grid_free(struct gz_slice_grid *grid);

/** What a slice of a grid is made of: (1 - weight) of a slice of the stack, weight of the next. */
struct gz_slice_mix {
	size_t lower;  /**< slice of the stack */
	double weight; /**< of slice lower + 1, 0 to below 1; 0: that slice is not needed */
};

/** What slice @p index of the grid is made of: 0 to dims[2] - 1. */
struct gz_slice_mix gz_slice_grid_mix(const struct gz_slice_grid *grid, int index);

/**
 * Lay a slice of the stack on the plane of the grid.
 *
 * @param slice   its number among those of all time points
 * @param type    of its numbers: integers of 8, 16 or 32 bits, or float, in host byte order
 * @param voxels  columns * rows * channels numbers
 * @param[out] plane  dims[0] * dims[1] * channels numbers; NaN where the slice does not reach
 *
 * Threads: one at a time for each grid.
 */
void gz_slice_grid_lay(const struct gz_slice_grid *grid, size_t slice, enum gz_raw_type type,
		       const void *voxels, double *plane);

/** Two planes that are mixed. */
struct gz_slice_pair {
	const double *lower, *upper; /**< upper is not read if weight is 0 */
	double weight;               /**< of upper */
	double fill;                 /**< where one of them is NaN */
};

/** Mix two planes of @p count numbers into numbers of @p type, integers rounded to the nearest. The
 *  numbers of the planes and fill must be in the type's range. */
void gz_slice_pair_mix(const struct gz_slice_pair *pair, size_t count, enum gz_raw_type type,
		       void *out_voxels);

/** The least of @p count numbers, 1 or more, of @p type (see gz_slice_grid_lay()); NaN is left out.
 */
double gz_slice_least(enum gz_raw_type type, const void *voxels, size_t count);

#ifdef __cplusplus
}
#endif

#endif
