/**
 * @file
 * One tile of rays at meshes: the weighted mean of the surface parameters where each ray ends.
 * Within this room.
 */
#ifndef GZ_RENDER_ILLUSTRATION_CPU_ILLUSTRATE_CAST_H
#define GZ_RENDER_ILLUSTRATION_CPU_ILLUSTRATE_CAST_H

#include <stdbool.h>
#include <stdint.h>

#include "render/illustration/shared/illustrate_frame.h"
#include "render/illustration/shared/illustrate_scene.h"
#include "render/surface/cpu/embree.h"

/** Rays of a tile, which are one packet of Embree. */
#define GZ_ILLUSTRATE_RAYS 16

/** What all rays of a frame share. Lengths are in mm, in the frame of struct gz_mesh. */
struct gz_illustrate_cast {
	RTCScene tree;
	const struct gz_illustrate_mesh *meshes; /**< by the tree's numbers of geometries */
	unsigned mesh_count;
	/** The ray of pixel (x, y), as in struct gz_ray_frame. */
	float origin00[3], origin_dx[3], origin_dy[3];
	float direction00[3], direction_dx[3], direction_dy[3];
	const struct gz_illustrate_frame *frame;
	int layers; /**< 1 to GZ_ILLUSTRATE_LAYERS_MAX; 1: no mesh is transparent */
};

/** The rays of a tile: ray i is that of pixel x + columns[i] * spacing, y + rows[i] * spacing. */
struct gz_illustrate_tile {
	float x, y, spacing;           /**< px */
	const uint8_t *columns, *rows; /**< GZ_ILLUSTRATE_RAYS of each */
	uint32_t active;               /**< bit i: cast ray i */
};

/** What the rays found. Where there is nothing, ids are 0 and all else is INFINITY. */
struct gz_illustrate_hits {
	float tone[GZ_ILLUSTRATE_RAYS];        /**< weighted mean of the parameters, [0, 1] */
	float depth_mm[GZ_ILLUSTRATE_RAYS];    /**< along the ray */
	float distance_mm[GZ_ILLUSTRATE_RAYS]; /**< to the chosen object */
	uint32_t ids[GZ_ILLUSTRATE_RAYS];
};

/** The caster of tiles for one instruction set. All of them give the same bits for the same hits;
 *  Embree finds places that differ in their last bits. */
struct gz_illustrate_kernel {
	const char *name; /**< as in struct gz_cast_kernels */
	const char *isa;  /**< as Embree names it */
	/**
	 * Cast a tile. What a ray finds depends on its pixel alone. A surface that is seen from
	 * behind is shaded as if it faced the viewer. Threads: any number. Does not allocate.
	 *
	 * @param[out] out_hits  of each layer: the first surface, then, as long as those before it
	 *                       are transparent, the next ones. The last layer is the next opaque
	 *                       surface: transparent ones in between are left out
	 */
	void (*cast)(const struct gz_illustrate_cast *cast, const struct gz_illustrate_tile *tile,
		     struct gz_illustrate_hits out_hits[GZ_ILLUSTRATE_LAYERS_MAX]);
};

extern const struct gz_illustrate_kernel gz_illustrate_portable;
#ifdef GZ_CAST_X86
extern const struct gz_illustrate_kernel gz_illustrate_avx2;
extern const struct gz_illustrate_kernel gz_illustrate_avx512;
#endif

#endif
