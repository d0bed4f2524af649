#include "render/mesh/point_grid.h"

#include <stdlib.h>
#include <string.h>

/* Most lists. Chosen: 1 GiB of them. */
#define LISTS_MAX 0x1p28

enum gz_result gz_point_grid_reset(struct gz_point_grid *grid, double edge_mm, double cells)
{
	size_t lists = 1024;
	while ((double)lists < fmin(cells, LISTS_MAX))
		lists *= 2;
	free(grid->heads);
	grid->heads = malloc(lists * sizeof *grid->heads);
	if (!grid->heads)
		return GZ_ERR_NO_MEM;
	memset(grid->heads, 0xff, lists * sizeof *grid->heads); /* GZ_POINT_GRID_END */
	grid->mask = lists - 1;
	grid->cells_per_mm = 1 / edge_mm;
	return GZ_OK;
}

void gz_point_grid_free(struct gz_point_grid *grid)
{
	free(grid->heads);
	*grid = (struct gz_point_grid) { 0 };
}
