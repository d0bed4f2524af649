/**
 * @file
 * Macrocells: blocks of voxels with their least and greatest value, so that empty space is found
 * from the transfer function without looking at voxels.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_MACROCELLS_H
#define GZ_RENDER_RAYCAST_SHARED_MACROCELLS_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "render/data/volume.h"
#include "render/raycast/shared/cast_constants.h"
#include "render/transfer/transfer_table.h"

/** Cell (i, j, k) covers voxels [8i - 1, 8i + 8] along x, and so on: every voxel that an
 * interpolation within the cell, or half a voxel around it, can touch. */
struct gz_macrocells {
	int dims[3];
	float *least, *greatest; /**< stored values */
	uint8_t *distance; /**< 0 = something shows; else the Chebyshev distance in cells, at most
			      255, to the nearest cell where something shows. 4 bytes of padding */
	uint8_t *reach; /**< how far a ray may go before it must ask again: GZ_REACH_BORDER + that
			   distance for an empty cell, GZ_REACH_BORDER - the distance to the nearest
			   empty cell for another, both at most GZ_REACH_MAX. 4 bytes of padding */
};

/** Make room for the cells of a volume of @p dims voxels, whose values are found elsewhere; @p
 * cells must be zeroed or hold an earlier result. GZ_ERR_NO_MEM. */
enum gz_result gz_macrocells_allocate(const int dims[3], struct gz_macrocells *cells);

/** Find the values of all cells; @p cells must be zeroed or hold an earlier result. GZ_ERR_NO_MEM.
 */
enum gz_result gz_macrocells_build(const struct gz_volume *volume, struct gz_macrocells *cells);

/** Find the distances for a transfer function: a pass over the cells, not the voxels. */
void gz_macrocells_classify(struct gz_macrocells *cells, const struct gz_transfer_table *table);

/** Free and zero. */
void gz_macrocells_free(struct gz_macrocells *cells);

#endif
