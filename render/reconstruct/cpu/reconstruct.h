/**
 * @file
 * From lattice points to the picture, for any plane, on the processor.
 */
#ifndef GZ_RENDER_RECONSTRUCT_CPU_RECONSTRUCT_H
#define GZ_RENDER_RECONSTRUCT_CPU_RECONSTRUCT_H

#include <stdbool.h>

#include "base/workers.h"
#include "render/picture/plane.h"
#include "render/reconstruct/cpu/lattice.h"

/** Most points that a row filter takes at a time. It may read less than twice as many points beyond
 *  the last one that it needs. It writes only what it is asked for. */
#define GZ_ROW_POINTS 16

/** Longest row that double_cubic and double_mean stream, points: the width of a square. */
#define GZ_ROW_STREAMED 256

/**
 * The filters of pyramids and regions, row by row, for one kind of plane and one instruction set.
 * Filters of colours give the same bits for every set. docs/foveation.md has the formulas.
 *
 * With `stream` a filter writes past the caches where addresses allow it, for pictures that are
 * larger than the caches and not read soon. Other threads see these points after settle().
 */
struct gz_row_filters {
	const char *name; /**< of the instruction set, as in struct gz_cast_kernels */
	/** Make two rows of @p count points by Catmull-Rom: @p even lies on @p row of the coarser
	 *  lattice and begins with its first point, @p odd lies halfway to the next row. Reads one
	 *  row and column before and two after those of @p row. */
	void (*double_cubic)(const uint32_t *row, ptrdiff_t stride, uint32_t *even, uint32_t *odd,
			     int count, bool stream);
	/** Make the two rows of double_cubic by means of neighbours. Reads one row and one column
	 *  after those of @p row. */
	void (*double_mean)(const uint32_t *row, ptrdiff_t stride, uint32_t *even, uint32_t *odd,
			    int count, bool stream);
	/** Make the missing points of quincunx tiles: @p first (0 or 1), @p first + 2, ... below
	 *  @p count of @p row, which is even, and with @p rows 2 the others of the row after it.
	 *  Each is the mean of Catmull-Rom along x and along y, from points 1 and 3 away, rounded
	 *  down in even rows and up in odd ones. With @p rows 1 the reads are those of 2. */
	void (*quincunx_cubic)(uint32_t *row, ptrdiff_t stride, int first, int rows, int count);
	/** Make the missing points by the mean of the four neighbours. */
	void (*quincunx_mean)(uint32_t *row, ptrdiff_t stride, int first, int rows, int count);
	/** Whether all points of a rectangle are @p colour. */
	bool (*all_are)(const uint32_t *points, ptrdiff_t stride, int columns, int rows,
			uint32_t colour);
	/** Write @p count points of one colour. */
	void (*fill)(uint32_t colour, uint32_t *out, int count, bool stream);
	/** Copy @p count points. */
	void (*copy)(const uint32_t *points, uint32_t *out, int count, bool stream);
	/** Interpolate pixels [@p x0, @p x1) of row @p y bilinearly from one lattice, which spans
	 *  them; @p out is the place of pixel @p x0. */
	void (*span)(const struct gz_lattice *lattice, int y, int x0, int x1, uint32_t *out);
	/** Find gz_region_weight() of @p count pixels of row @p y from @p x0 on, for a region with
	 *  a band; rounded, 256 = 1. */
	void (*weights)(const struct gz_region *region, int y, int x0, int count, uint32_t *out);
	/** Mix each of @p count @p points with the one @p behind it. @p shares are the weights of
	 *  @p points, 256 = 1. */
	void (*blend)(const uint32_t *behind, const uint32_t *shares, uint32_t *points, int count);
	/** Make streamed points visible to other threads. Called after the last streamed store. */
	void (*settle)(void);
};

extern const struct gz_row_filters gz_row_filters_portable;
#ifdef GZ_CAST_X86
extern const struct gz_row_filters gz_row_filters_avx2;
extern const struct gz_row_filters gz_row_filters_avx512;
#endif

/** The filters of colours for instruction set @p name, as in struct gz_cast_kernels; the portable
 *  ones if there are none of that name. Static. */
const struct gz_row_filters *gz_row_filters_find(const char *name);

/** The filters of planes other than colours for one instruction set. Those of @p values and
 *  @p ids that are the same for all planes are NULL. All sets give the same bits. */
struct gz_plane_filters {
	const char *name; /**< as in struct gz_row_filters */
	const struct gz_row_filters *values, *ids;
};

extern const struct gz_plane_filters gz_plane_filters_portable;
#ifdef GZ_CAST_X86
extern const struct gz_plane_filters gz_plane_filters_avx2;
extern const struct gz_plane_filters gz_plane_filters_avx512;
#endif

/** The filters of a kind of plane, for the instruction set of the filters @p colours. */
struct gz_row_filters gz_row_filters_of_plane(enum gz_plane_kind kind,
					      const struct gz_row_filters *colours);

/**
 * Fill every pixel that was not cast. The result does not depend on the number of threads.
 *
 * @param lattices  prepared with @p picture, and filled by casting
 * @param filters   for the plane's kind
 * @param picture   the plane: plan->width * plan->height words
 */
void gz_reconstruct(const struct gz_plan *plan, const struct gz_lattices *lattices,
		    const struct gz_row_filters *filters, struct gz_workers *workers,
		    uint32_t *picture);

/** One of several planes that are reconstructed together. All pointers are borrowed. */
struct gz_reconstructed {
	const struct gz_lattices *lattices; /**< prepared with @p picture, and filled by casting */
	const struct gz_row_filters *filters; /**< for the plane's kind */
	uint32_t *picture;                    /**< the plane */
	/** Of a plane of values: where a wide area has none, INFINITY need not be written. What is
	 *  there stays undefined; ids tell where. */
	bool leaves_empty;
};

/** gz_reconstruct() of planes of one plan: threads wait for each other once, and what a part of the
 *  picture needs is in the caches for all planes. */
void gz_reconstruct_planes(const struct gz_plan *plan, const struct gz_reconstructed planes[],
			   int count, struct gz_workers *workers);

/* Within this room: */

/** Whether a plan's picture is written past the caches. */
bool gz_reconstruct_streams(const struct gz_plan *plan);

/** Number of squares that a pyramid's picture is made in, along x and y. */
void gz_reconstruct_squares(const struct gz_plan *plan, int *out_columns, int *out_rows);

/** Fill one square of a pyramid's picture. Threads: any number, each with squares of its own. */
void gz_reconstruct_square(const struct gz_plan *plan, const struct gz_reconstructed *plane,
			   int column, int row);

/** Whether quincunx tiles lie on the lattice of spacing 1, so that gz_reconstruct_finest() must
 *  follow the squares. */
bool gz_reconstruct_has_finest(const struct gz_lattices *lattices);

/** Fill the pixels that quincunx tiles of spacing 1 lack in one row of blocks, after all squares.
 *  Threads: any number, each with rows of its own. */
void gz_reconstruct_finest(const struct gz_plan *plan, const struct gz_reconstructed *plane,
			   int block_row);

/** The lesser of two numbers. */
static inline int gz_least(int a, int b)
{
	return a < b ? a : b;
}

#endif
