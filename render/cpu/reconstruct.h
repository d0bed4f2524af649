/**
 * @file
 * From lattice points to the picture.
 */
#ifndef GZ_RENDER_CPU_RECONSTRUCT_H
#define GZ_RENDER_CPU_RECONSTRUCT_H

#include <stdbool.h>

#include "render/cpu/lattice.h"
#include "render/workers.h"

/** Points that the row filters make at a time: they write, and read, up to the next multiple. */
#define GZ_ROW_CHUNK 8

/**
 * The filters of the pyramid, row by row, for one instruction set. All give the same bits. Points
 * are 4 channels of 8 bits; docs/foveation.md has the formulas.
 */
struct gz_row_filters {
	const char *name; /**< as of gz_cast_kernels */
	/** @p count points halfway between @p rows[1] and @p rows[2], Catmull-Rom. */
	void (*cubic_between)(const uint32_t *const rows[4], uint32_t *out, int count);
	/** @p count points of @p row, each followed by the one halfway to the next, Catmull-Rom:
	 * one point before and two behind are read. */
	void (*cubic_double)(const uint32_t *row, uint32_t *out, int count);
	/** @p count points of @p row, each followed by the mean with the next, rounded down: one
	 * point behind is read. */
	void (*mean_double_row)(const uint32_t *row, uint32_t *out, int count);
	/** @p count points halfway between two rows, rounded up, each followed by the mean of the
	 * four around: one point behind is read. */
	void (*mean_double)(const uint32_t *above, const uint32_t *below, uint32_t *out, int count);
	/** @p count points of @p row, of which those number @p first, @p first + 2... are made anew
	 *  from those 1 and 3 points away along both axes: the mean of Catmull-Rom along each,
	 * rounded
	 *  @p up or down. */
	void (*cubic_quincunx)(const uint32_t *row, ptrdiff_t stride, int first, bool up,
			       uint32_t *out, int count);
	/** The same by the mean of the four neighbours. */
	void (*mean_quincunx)(const uint32_t *row, ptrdiff_t stride, int first, uint32_t *out,
			      int count);
};

extern const struct gz_row_filters gz_row_filters_portable;
#ifdef GZ_CAST_X86
extern const struct gz_row_filters gz_row_filters_avx2;
extern const struct gz_row_filters gz_row_filters_avx512;
#endif

/** The filters for the instruction set of @p name, one of gz_cast_kernels; the portable ones if
 * there are none of that name. */
const struct gz_row_filters *gz_row_filters_find(const char *name);

/** Fill every pixel of @p image that was not cast. The same bits for any number of threads. */
void gz_reconstruct(const struct gz_plan *plan, const struct gz_lattices *lattices,
		    const struct gz_row_filters *filters, struct gz_workers *workers,
		    struct gz_image *image);

/** The squares that the picture of a pyramid is made in: columns and rows. */
void gz_reconstruct_squares(const struct gz_plan *plan, int *out_columns, int *out_rows);

/** Fill one of them. Threads: any number, each with squares of its own. */
void gz_reconstruct_square(const struct gz_plan *plan, const struct gz_lattices *lattices,
			   const struct gz_row_filters *filters, int column, int row);

/** Pixels from @p x0 up to, not including, @p x1 of row @p y, bilinearly from one lattice.
 *
 *  @param x0, x1    within the lattice's span; x0 < x1
 *  @param[out] out  the first pixel's place
 */
void gz_reconstruct_span(const struct gz_lattice *lattice, int y, int x0, int x1, uint32_t *out);

#endif
