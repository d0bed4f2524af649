/**
 * @file
 * How much of the light from all around a place is kept away by what lies near it: on a grid much
 * coarser than the volume, made for a transfer function, a radius and a clip box.
 *
 * The measure is volumetric obscurance (Loos and Sloan, Volumetric Obscurance, I3D 2010): the share
 * of the neighbourhood that is filled. A plane fills half of it, whatever its direction, so no
 * normal is needed; that half is taken off, and a flat surface keeps its light, an edge between two
 * walls loses half of it, a corner three quarters, a narrow hole all. In detail, with R the radius:
 *
 * - a voxel of opacity a (per voxel length) fills 1 - (1 - a)^(R/2): what a path half across the
 *   radius would find. Outside the box and the clip box nothing is filled.
 * - a cell is a block of `edge` voxels along each axis; it is filled by the mean of its voxels,
 *   those beyond the box counted as empty; its datum sits in its middle.
 * - B is the mean over cells, weighted along each axis by max(0, 1 - distance / R) (voxel lengths),
 *   the three weights multiplied, cells beyond the grid counted as empty
 * - o = clamp(2 B - 1, 0, 1) at a sample, with B trilinear between the middles of cells.
 */
#ifndef GZ_RENDER_LIGHT_OCCLUSION_H
#define GZ_RENDER_LIGHT_OCCLUSION_H

#include <stdint.h>

#include "base/result.h"
#include "base/workers.h"
#include "render/data/clip_box.h"
#include "render/data/volume.h"
#include "render/transfer/transfer_table.h"

/** The grid. Zero-initialised is empty; keep it from frame to frame. */
struct gz_occlusion {
	int dims[3];     /**< cells */
	int edge[3];     /**< voxels of a cell along each axis: a power of two */
	uint16_t *cells; /**< B, 65535 for 1; x fastest; GZ_VOLUME_PADDING bytes behind it */
	size_t capacity;
};

/**
 * The edges of cells for a radius: along the axis of the finest spacing the greatest power of two
 * of at most R / 2, but at least 2; along the others the greatest that is no longer, but at
 * least 1.
 */
void gz_occlusion_edges(const struct gz_volume *volume, double radius, int out_edge[3]);

/**
 * Make the grid. The same bits for any number of threads.
 *
 * @param table   baked for the volume
 * @param radius  voxel lengths, within the limits of light.occlusion_radius
 * @param workers who make it; NULL for the calling thread alone
 * @retval GZ_ERR_NO_MEM  the grid is empty
 */
enum gz_result gz_occlusion_make(const struct gz_volume *volume,
				 const struct gz_transfer_table *table, double radius,
				 const struct gz_clip_box *clip, struct gz_workers *workers,
				 struct gz_occlusion *occlusion);

/** Free and zero. */
void gz_occlusion_free(struct gz_occlusion *occlusion);

#endif
