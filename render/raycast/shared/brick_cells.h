/**
 * @file
 * Macrocells of a volume that is a file of bricks: from the ranges that stand in it.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_BRICK_CELLS_H
#define GZ_RENDER_RAYCAST_SHARED_BRICK_CELLS_H

#include "render/data/brick_file.h"
#include "render/raycast/shared/macrocells.h"

/** Take the values of all cells of level 0, as gz_macrocells_build() would find them; @p cells must
 * be zeroed or hold an earlier result. GZ_ERR_NO_MEM. */
enum gz_result gz_brick_cells_finest(const struct gz_brick_file *file, struct gz_macrocells *cells);

/**
 * Take the values of the cells of level @p level, above 0, from those of the next finer one: a
 * range that holds what gz_macrocells_build() would find, and may be wider.
 *
 * @param finer  those of level - 1
 * @retval GZ_ERR_NO_MEM  no room
 */
enum gz_result gz_brick_cells_coarser(const struct gz_brick_file *file, int level,
				      const struct gz_macrocells *finer,
				      struct gz_macrocells *cells);

#endif
