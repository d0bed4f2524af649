/**
 * @file
 * Casting one tile of rays on a processor: what the kernels are given, and the kernels there are.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_H
#define GZ_RENDER_RAYCAST_CPU_CAST_H

#include <stdbool.h>
#include <stdint.h>

#include "render/data/brick_pool.h"
#include "render/data/volume.h"
#include "render/plan/plan.h"
#include "render/raycast/cpu/fine_cells.h"
#include "render/raycast/shared/cast_constants.h"
#include "render/raycast/shared/lighting.h"
#include "render/transfer/transfer_table.h"

#define GZ_TILE_RAYS (GZ_TILE_EDGE * GZ_TILE_EDGE)

/** Where the voxels of a volume of bricks are. Its level is the one that a cast is for. */
struct gz_cast_bricks {
	/** By brick of the level: room << GZ_BRICK_LEVEL_BITS | the level of the brick there, which
	 *  is this one or a coarser one. NULL for a volume in memory. */
	const int32_t *table;
	float last[3]; /**< greatest number of a brick */
	int32_t stride[3];
	/** Voxels of another level along an edge of one of this level, 1 or less. */
	float scale[3][1 << GZ_BRICK_LEVEL_BITS];
};

/** Fine cells of one edge (fine_cells.h), by the lower neighbours of a sample. */
struct gz_cast_grid {
	const uint8_t *flags;
	float cells_per_voxel;
	float last[3]; /**< greatest cell index */
	int32_t stride[3];
};

/** Everything that all tiles of a frame share; read-only while they are cast. Rays are in voxel
 *  coordinates: voxel i along an axis spans [i, i + 1), its datum sits at i + 1/2. */
struct gz_cast {
	/* volume */
	const void *voxels;
	float box[3]; /**< far corner of the volume's box; dims but for a coarser level of odd size
		       */
	float dims[3];
	int32_t last[3];   /**< greatest index of the lower of two neighbours: max(dims - 2, 0) */
	int32_t stride[3]; /**< in voxels; 0 along an axis of one voxel, x excepted */
	struct gz_cast_bricks bricks; /**< voxels is where their rooms begin */
	/* macrocells */
	const uint8_t *reach;
	float cell_last[3]; /**< greatest cell index */
	int32_t cell_stride[3];
	struct gz_cast_grid fine[GZ_FINE_GRIDS]; /* flags are NULL where there are none */
	/* transfer function */
	float entry_scale, entry_bias;
	const struct gz_transfer_entry *extinction; /**< per voxel length */
	const struct gz_transfer_entry
		*step_table[GZ_PLAN_STEPS_MAX]; /**< one for each step of the plan */
	/** with pre-integration: a table for each step of the plan, and that of any length
	 *  (render/transfer/transfer_preintegrated.h); else NULL */
	const struct gz_transfer_entry *preintegrated[GZ_PLAN_STEPS_MAX];
	const struct gz_transfer_entry *preintegrated_extinction;
	/* rays of pixel (x, y): see struct gz_ray_frame */
	float origin00[3], origin_dx[3], origin_dy[3];
	float direction00[3], direction_dx[3], direction_dy[3];
	float clip_least[3], clip_greatest[3];  /**< voxel coordinates */
	float world_per_voxel[3];               /**< to measure lengths in world units */
	float step[GZ_PLAN_STEPS_MAX];          /**< world units */
	float voxel_lengths[GZ_PLAN_STEPS_MAX]; /**< the same in voxel lengths */
	float background[3];
	float end_transmittance; /**< a ray ends when less light than this comes through */
	struct gz_cast_light light;
};

/** One tile as the kernels take it. */
struct gz_cast_tile {
	float x[GZ_TILE_RAYS], y[GZ_TILE_RAYS]; /**< pixels of its rays */
	float jitter[GZ_TILE_RAYS];             /**< see gz_ray_jitter() */
	int step;
	uint32_t active; /**< bit i: cast ray i */
};

/**
 * Cast a tile.
 *
 * @param[out] out_pixels  R, G, B, 255 in memory order; written for all rays, meaningful for active
 * ones
 * @return voxel interpolations done
 *
 * A ray's colour depends on its pixel, spacing aside, and on its step alone: not on the tile.
 */
typedef uint32_t gz_cast_tile_function(const struct gz_cast *cast, const struct gz_cast_tile *tile,
				       uint32_t out_pixels[GZ_TILE_RAYS]);

/** What a kernel can do: the plain path stays free of what it seldom needs. */
enum gz_cast_variant {
	GZ_CAST_PLAIN,
	GZ_CAST_RICH, /**< light, pre-integration */
	GZ_CAST_VARIANT_COUNT,
};

/** One instruction set's kernels, by variant, voxel type and interpolation. */
struct gz_cast_kernels {
	const char *name;
	gz_cast_tile_function *tile[GZ_CAST_VARIANT_COUNT][GZ_VOXEL_TYPE_COUNT][2];
};

extern const struct gz_cast_kernels gz_cast_portable;
#ifdef GZ_CAST_X86
extern const struct gz_cast_kernels gz_cast_avx2;
extern const struct gz_cast_kernels gz_cast_avx512;
#endif

/** Kernels by name, or the best this processor runs for NULL or "auto". NULL if it runs none of
 * that name. */
const struct gz_cast_kernels *gz_cast_kernels_find(const char *name);

#endif
