#include "render/raycast/shared/brick_cells.h"

#include <math.h>

_Static_assert(GZ_MACROCELL_EDGE == GZ_BRICK_CELL_EDGE, "the file has the ranges of macrocells");

enum { ALONG = GZ_BRICK_EDGE / GZ_BRICK_CELL_EDGE };

static size_t cell_index(const struct gz_macrocells *cells, int x, int y, int z)
{
	return ((size_t)z * (size_t)cells->dims[1] + (size_t)y) * (size_t)cells->dims[0] +
	       (size_t)x;
}

enum gz_result gz_brick_cells_finest(const struct gz_brick_file *file, struct gz_macrocells *cells)
{
	const enum gz_result result = gz_macrocells_allocate(file->layout.levels[0].dims, cells);
	if (result != GZ_OK)
		return result;
	for (int z = 0; z < cells->dims[2]; z++)
		for (int y = 0; y < cells->dims[1]; y++)
			for (int x = 0; x < cells->dims[0]; x++) {
				const int brick[3] = { x / ALONG, y / ALONG, z / ALONG };
				const int cell =
					(z % ALONG * ALONG + y % ALONG) * ALONG + x % ALONG;
				const size_t index = cell_index(cells, x, y, z);
				gz_brick_file_cell(file, gz_brick_number(&file->layout, 0, brick),
						   cell, &cells->least[index],
						   &cells->greatest[index]);
			}
	return GZ_OK;
}

/* The finer cells that hold a cell's voxels: its own, and of a halved axis one to each side, since
 * a voxel of the neighbour's is two of the finer level. */
static void finer_span(int cell, bool halved, int count, int *out_first, int *out_last)
{
	const int first = halved ? 2 * cell - 1 : cell, last = halved ? 2 * cell + 2 : cell;
	*out_first = first < 0 ? 0 : first;
	*out_last = last > count - 1 ? count - 1 : last;
}

static void widen(const struct gz_macrocells *finer, const int first[3], const int last[3],
		  float *out_least, float *out_greatest)
{
	float least = INFINITY, greatest = -INFINITY;
	for (int z = first[2]; z <= last[2]; z++)
		for (int y = first[1]; y <= last[1]; y++)
			for (int x = first[0]; x <= last[0]; x++) {
				const size_t index = cell_index(finer, x, y, z);
				least = fminf(least, finer->least[index]);
				greatest = fmaxf(greatest, finer->greatest[index]);
			}
	*out_least = least;
	*out_greatest = greatest;
}

enum gz_result gz_brick_cells_coarser(const struct gz_brick_file *file, int level,
				      const struct gz_macrocells *finer,
				      struct gz_macrocells *cells)
{
	const struct gz_brick_level *l = &file->layout.levels[level];
	const enum gz_result result = gz_macrocells_allocate(l->dims, cells);
	if (result != GZ_OK)
		return result;
	for (int z = 0; z < cells->dims[2]; z++)
		for (int y = 0; y < cells->dims[1]; y++)
			for (int x = 0; x < cells->dims[0]; x++) {
				const int cell[3] = { x, y, z };
				int first[3], last[3];
				for (int axis = 0; axis < 3; axis++)
					finer_span(cell[axis],
						   l->halvings[axis] > l[-1].halvings[axis],
						   finer->dims[axis], &first[axis], &last[axis]);
				const size_t index = cell_index(cells, x, y, z);
				widen(finer, first, last, &cells->least[index],
				      &cells->greatest[index]);
			}
	return GZ_OK;
}
