/**
 * @file
 * A hashed grid that finds points near a place: cells, each with a list of points. Cells may share
 * a list, so a list may hold points that are far away: only distances tell.
 */
#ifndef GZ_RENDER_MESH_POINT_GRID_H
#define GZ_RENDER_MESH_POINT_GRID_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"

/** The end of a list. */
#define GZ_POINT_GRID_END (-1)

/** Rows of cells along x around a cell: by y and z. The middle one is the first. */
#define GZ_POINT_GRID_ROWS 9

/** A grid. Zero-initialised is empty. */
struct gz_point_grid {
	double origin[3];    /**< a corner below all points, mm */
	double cells_per_mm; /**< 1 / edge of a cell */
	int32_t *heads;      /**< the first point of each list */
	size_t mask;         /**< lists less 1; their number is a power of two */
};

/**
 * Empty a grid, for other cells.
 *
 * @param edge_mm  of a cell, above 0: points up to so far away are in the cells around
 * @param cells    about how many cells will hold a point, at least 0
 * @retval GZ_ERR_NO_MEM  not logged; the grid has no lists
 */
enum gz_result gz_point_grid_reset(struct gz_point_grid *grid, double edge_mm, double cells);

/** Free the lists and zero the grid. */
void gz_point_grid_free(struct gz_point_grid *grid);

/** The finaliser of SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number
 *  generators", OOPSLA 2014): a random number for each place in a sequence. */
static inline uint64_t gz_mixed_bits(uint64_t seed, uint64_t place)
{
	uint64_t z = seed + (place + 1) * UINT64_C(0x9e3779b97f4a7c15);
	z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
	z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
	return z ^ (z >> 31);
}

/** The cell of a place. */
static inline void gz_point_grid_cell(const struct gz_point_grid *grid, const float at[3],
				      int64_t out_cell[3])
{
	const double limit = 0x1p40; /* then the lists of far away cells are long */
	for (int axis = 0; axis < 3; axis++)
		out_cell[axis] = (int64_t)fmin(
			floor(((double)at[axis] - grid->origin[axis]) * grid->cells_per_mm), limit);
}

/** The list of a cell, as an index of heads, in row @p row around it. Those of the cells before and
 *  after it along x are the index less 1 and plus 1, each & mask. */
static inline size_t gz_point_grid_list(const struct gz_point_grid *grid, const int64_t cell[3],
					int row)
{
	static const int8_t rows[GZ_POINT_GRID_ROWS][2] = { { 0, 0 },  { 0, 1 },   { 1, 0 },
							    { 0, -1 }, { -1, 0 },  { 1, 1 },
							    { 1, -1 }, { -1, -1 }, { -1, 1 } };
	const uint64_t y = (uint64_t)(cell[1] + rows[row][0]);
	const uint64_t z = (uint64_t)(cell[2] + rows[row][1]);
	return ((size_t)gz_mixed_bits(y, z) + (size_t)cell[0]) & grid->mask;
}

/** Put a point in front of its list. @param out_next  receives the number after it */
static inline void gz_point_grid_add(struct gz_point_grid *grid, const float at[3], int32_t number,
				     int32_t *out_next)
{
	int64_t cell[3];
	gz_point_grid_cell(grid, at, cell);
	int32_t *head = &grid->heads[gz_point_grid_list(grid, cell, 0)];
	*out_next = *head;
	*head = number;
}

#endif
