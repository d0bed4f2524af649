/**
 * @file
 * From lattice points to the picture, for any plane.
 */
#ifndef GZ_RENDER_RECONSTRUCT_CPU_RECONSTRUCT_H
#define GZ_RENDER_RECONSTRUCT_CPU_RECONSTRUCT_H

#include <stdbool.h>

#include "base/workers.h"
#include "render/picture/plane.h"
#include "render/reconstruct/cpu/lattice.h"

/** The most points that the row filters take at a time: what they read beyond the last point they
 * need is less than twice that. They write what they are asked for and nothing else. */
#define GZ_ROW_POINTS 16

/** The longest row that is streamed, points: chosen, a square of the picture's. */
#define GZ_ROW_STREAMED 256

/**
 * The filters of pyramids and regions, row by row, for one kind of plane and instruction set; those
 * of colours give the same bits for every set. docs/foveation.md has the formulas.
 *
 * `stream` writes past the caches where addresses allow it: for what is larger than they are and
 * not read soon. Other threads see it after settle().
 */
struct gz_row_filters {
	const char *name; /**< as of gz_cast_kernels */
	/** Two rows of @p count points, Catmull-Rom: @p even from @p row of the coarser lattice,
	 * whose first point it begins with, @p odd from halfway to the row behind. Of the coarser
	 * lattice's rows one before and two behind are read, of its columns too. */
	void (*double_cubic)(const uint32_t *row, ptrdiff_t stride, uint32_t *even, uint32_t *odd,
			     int count, bool stream);
	/** The same by means of neighbours: one row and one column behind are read. */
	void (*double_mean)(const uint32_t *row, ptrdiff_t stride, uint32_t *even, uint32_t *odd,
			    int count, bool stream);
	/** Of @p count points of an even @p row those number @p first (0 or 1), @p first + 2... are
	 * made anew from those 1 and 3 points away along both axes, and with two @p rows the others
	 * of the odd row behind: the mean of Catmull-Rom along each, rounded down in even rows and
	 * up in odd ones. Rows as far as those of two rows are read with one too. */
	void (*quincunx_cubic)(uint32_t *row, ptrdiff_t stride, int first, int rows, int count);
	/** The same by the mean of the four neighbours. */
	void (*quincunx_mean)(uint32_t *row, ptrdiff_t stride, int first, int rows, int count);
	/** Whether all points of a rectangle are @p colour. */
	bool (*all_are)(const uint32_t *points, ptrdiff_t stride, int columns, int rows,
			uint32_t colour);
	/** @p count points of one colour. */
	void (*fill)(uint32_t colour, uint32_t *out, int count, bool stream);
	/** @p count points to another place. */
	void (*copy)(const uint32_t *points, uint32_t *out, int count, bool stream);
	/** Pixels from @p x0 up to, not including, @p x1 of row @p y, bilinearly from one lattice,
	 * within whose span they are; @p out is the first one's place. */
	void (*span)(const struct gz_lattice *lattice, int y, int x0, int x1, uint32_t *out);
	/** gz_region_weight() of @p count pixels of row @p y from @p x0 on, in 1/256, rounded, of a
	 * region with a band. */
	void (*weights)(const struct gz_region *region, int y, int x0, int count, uint32_t *out);
	/** Each of @p count @p points is mixed with the one @p behind it; @p shares are its own, in
	 * 1/256. */
	void (*blend)(const uint32_t *behind, const uint32_t *shares, uint32_t *points, int count);
	/** After the last of what was streamed, before another thread may read it. */
	void (*settle)(void);
};

extern const struct gz_row_filters gz_row_filters_portable;
#ifdef GZ_CAST_X86
extern const struct gz_row_filters gz_row_filters_avx2;
extern const struct gz_row_filters gz_row_filters_avx512;
#endif

/** The filters for the instruction set of @p name, one of gz_cast_kernels; the portable ones if
 * there are none of that name. */
const struct gz_row_filters *gz_row_filters_find(const char *name);

/** The filters of a kind of plane, for the instruction set of @p colours, which are those of
 * colours. */
struct gz_row_filters gz_row_filters_of_plane(enum gz_plane_kind kind,
					      const struct gz_row_filters *colours);

/**
 * Fill every pixel that was not cast. The same bits for any number of threads.
 *
 * @param lattices  prepared with @p picture, and cast
 * @param filters   for the kind of plane that the points are
 * @param picture   the plane's words: plan->width * plan->height
 */
void gz_reconstruct(const struct gz_plan *plan, const struct gz_lattices *lattices,
		    const struct gz_row_filters *filters, struct gz_workers *workers,
		    uint32_t *picture);

/** The squares that the picture of a pyramid is made in: columns and rows. */
void gz_reconstruct_squares(const struct gz_plan *plan, int *out_columns, int *out_rows);

/** Whether a plan's picture is written past the caches. */
bool gz_reconstruct_streams(const struct gz_plan *plan);

/** Fill one of them. Threads: any number, each with squares of its own. */
void gz_reconstruct_square(const struct gz_plan *plan, const struct gz_lattices *lattices,
			   const struct gz_row_filters *filters, int column, int row);

/** Fill a row of a picture of regions. Threads: any number, each with rows of its own. */
void gz_reconstruct_row(const struct gz_plan *plan, const struct gz_lattices *lattices,
			const struct gz_row_filters *filters, uint32_t *picture, int y);

#endif
