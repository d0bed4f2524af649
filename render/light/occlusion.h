/**
 * @file
 * Ambient occlusion: how much of the light from all directions the surroundings of a point block.
 * It is computed on a grid much coarser than the volume, for a transfer function, a radius and a
 * clip region.
 *
 * The measure is volumetric obscurance (Loos and Sloan, Volumetric Obscurance, I3D 2010): the share
 * of the neighbourhood that is filled. A plane fills half of it in any direction, so no normal
 * is needed; that half is subtracted. A flat surface then keeps its light, an edge between two
 * walls loses half of it, a corner three quarters, a narrow hole all. With R the radius:
 *
 * - a voxel of opacity a (per voxel length) is filled by 1 - (1 - a)^(R/2), the opacity of a path
 * of length R/2. Voxels outside the box or the clip region are empty.
 * - a cell is a block of `edge` voxels along each axis; it is filled by the mean of its voxels,
 * those outside the box counted as empty; its datum sits at its centre.
 * - B is the weighted mean over cells; the weight is the product over the axes of max(0, 1 -
 * distance / R), distances in voxel lengths; cells outside the grid count as empty.
 * - o = clamp(2 B - 1, 0, 1) at a sample, with B interpolated trilinearly between centres of cells.
 */
#ifndef GZ_RENDER_LIGHT_OCCLUSION_H
#define GZ_RENDER_LIGHT_OCCLUSION_H

#include <stdint.h>

#include "base/result.h"
#include "base/workers.h"
#include "render/data/clip_region.h"
#include "render/data/volume.h"
#include "render/transfer/transfer_table.h"

/** The grid. Zero-initialised is empty; its memory is reused when it is made again. */
struct gz_occlusion {
	int dims[3];     /**< cells */
	int edge[3];     /**< voxels of a cell along each axis: a power of two */
	uint16_t *cells; /**< B, 65535 for 1; x fastest; GZ_VOLUME_PADDING bytes follow */
	size_t capacity; /**< cells allocated */
};

/**
 * The edges of cells, voxels, for a radius R in voxel lengths: along the axis of the finest spacing
 * the greatest power of two up to R / 2, at least 2; along the others the greatest power of two
 * that is no longer in space, at least 1.
 */
void gz_occlusion_edges(const struct gz_volume *volume, double radius, int out_edge[3]);

/**
 * Make the grid. The result has the same bits for any number of threads.
 *
 * @param table   baked for the volume
 * @param radius  voxel lengths, within the limits of light.occlusion_radius
 * @param clip    cells outside it are empty
 * @param workers share the work; NULL for the calling thread alone
 * @retval GZ_ERR_NO_MEM  the grid is empty; not logged
 */
enum gz_result gz_occlusion_make(const struct gz_volume *volume,
				 const struct gz_transfer_table *table, double radius,
				 const struct gz_clip_region *clip, struct gz_workers *workers,
				 struct gz_occlusion *occlusion);

/** Free and zero. */
void gz_occlusion_free(struct gz_occlusion *occlusion);

#endif
