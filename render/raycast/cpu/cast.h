/**
 * @file
 * Casting a tile of rays on the processor: the input of the kernels, and the table of kernels.
 */
#ifndef GZ_RENDER_RAYCAST_CPU_CAST_H
#define GZ_RENDER_RAYCAST_CPU_CAST_H

#include <stdbool.h>
#include <stdint.h>

#include "render/data/brick_pool.h"
#include "render/data/volume.h"
#include "render/light/surroundings.h"
#include "render/plan/plan.h"
#include "render/raycast/cpu/fine_cells.h"
#include "render/raycast/shared/cast_constants.h"
#include "render/raycast/shared/lighting.h"
#include "render/technique/ray_hits.h"
#include "render/transfer/transfer_table.h"

#define GZ_TILE_RAYS (GZ_TILE_EDGE * GZ_TILE_EDGE)

/** Where the voxels of a volume of bricks are, for one level. */
struct gz_cast_bricks {
	/** For each brick of the level: room << GZ_BRICK_LEVEL_BITS | level of the brick in that
	 * room, which is this level or a coarser one. NULL for a volume in memory. */
	const int32_t *table;
	float last[3]; /**< greatest number of a brick */
	int32_t stride[3];
	/** By level: its voxels per voxel of this level along each axis, 1 or less. */
	float scale[3][1 << GZ_BRICK_LEVEL_BITS];
};

/** One grid of fine cells (fine_cells.h). */
struct gz_cast_grid {
	const uint8_t *flags;
	float cells_per_voxel;
	float last[3]; /**< greatest cell index */
	int32_t stride[3];
};

/** What all tiles of a frame share; read-only while they are cast. Rays are in voxel coordinates:
 * voxel i along an axis spans [i, i + 1), its datum lies at i + 1/2. */
struct gz_cast {
	/* volume */
	const void *voxels;
	float box[3]; /**< far corner of the volume: dims, or less for a coarser level of odd size
		       */
	float dims[3];
	int32_t last[3];   /**< greatest index of the lower of two neighbours: max(dims - 2, 0) */
	int32_t stride[3]; /**< in voxels; 0 along an axis of one voxel, x excepted */
	struct gz_cast_bricks bricks; /**< their rooms begin at voxels */
	/* macrocells */
	const uint8_t *reach;
	float cell_last[3]; /**< greatest cell index */
	int32_t cell_stride[3];
	struct gz_cast_grid fine[GZ_FINE_GRIDS]; /* flags are NULL if there are none */
	/* transfer function */
	float entry_scale, entry_bias;
	float entry_last;            /**< greatest number of an entry */
	int32_t preintegrated_shift; /**< log2 of the entries in a cell of a pre-integrated table */
	bool fine_entries;           /**< the table has more than GZ_TRANSFER_TABLE_SIZE entries */
	const uint32_t *visible_before;             /**< see struct gz_transfer_table */
	const struct gz_transfer_entry *extinction; /**< per voxel length */
	const struct gz_transfer_entry
		*step_table[GZ_PLAN_STEPS_MAX]; /**< for each step of the plan */
	/** With pre-integration: a table for each step of the plan, and one for any length
	 *  (render/transfer/transfer_preintegrated.h). Without: NULL. */
	const struct gz_transfer_entry *preintegrated[GZ_PLAN_STEPS_MAX];
	const struct gz_transfer_entry *preintegrated_extinction;
	/* rays of pixel (x, y): see struct gz_ray_frame */
	float origin00[3], origin_dx[3], origin_dy[3];
	float direction00[3], direction_dx[3], direction_dy[3];
	float clip_least[3], clip_greatest[3];  /**< voxel coordinates */
	float clip_plane[4];                    /**< struct gz_clip_bounds */
	float world_per_voxel[3];               /**< world units per voxel */
	float step[GZ_PLAN_STEPS_MAX];          /**< world units */
	float voxel_lengths[GZ_PLAN_STEPS_MAX]; /**< the steps in voxel lengths */
	float end_transmittance; /**< a ray ends when less than this share of light comes through */
	/** From world units along a ray to the share of the shot's depths, [0, 1]: only rich
	 * kernels tell depths. A scale of 0: the fourth byte is 255. */
	float depth_scale, depth_bias;
	struct gz_cast_light light;
	struct gz_seen_surroundings around; /**< world units */
	const uint32_t *colours; /**< of voxels in memory, see gz_colour_pack(); NULL without */
};

/** The rays of a tile. */
struct gz_cast_tile {
	float x[GZ_TILE_RAYS], y[GZ_TILE_RAYS]; /**< pixels of its rays */
	float jitter[GZ_TILE_RAYS];             /**< see gz_ray_jitter() */
	int step;
	uint32_t active; /**< bit i: cast ray i */
	/** What the rays meet: they end at these depths, in front of these pixels, as in struct
	 *  gz_ray_hits. NULL: nothing. */
	const float *hit_depth;
	const uint32_t *hit_pixels;
};

/**
 * Cast a tile.
 *
 * @param[out] out_pixels  R, G, B, 255 in memory order; written for all rays, valid for active ones
 * @return number of voxel interpolations
 *
 * A ray's colour depends only on its pixel and its step, not on its tile.
 */
typedef uint32_t gz_cast_tile_function(const struct gz_cast *cast, const struct gz_cast_tile *tile,
				       uint32_t out_pixels[GZ_TILE_RAYS]);

/** Places counted from the first datum of the full volume. */
struct gz_cast_places {
	float at[3][GZ_TILE_RAYS];
	uint32_t active; /**< bit i: place i is asked for */
	float longer;    /**< times as long as planned are steps towards the light, but for the
			      first GZ_SHADOW_FIRST; at least 1 */
};

/** Find which share of the light arrives at some places by walking towards it, as struct gz_light
 *  says. @param[out] out_shares  written for all places, valid for active ones */
typedef void gz_cast_arriving_function(const struct gz_cast *cast, enum gz_voxel_type type,
				       bool nearest, const struct gz_cast_places *places,
				       float out_shares[GZ_TILE_RAYS]);

/** What a kernel can do. The plain one stays free of what is seldom needed. */
enum gz_cast_variant {
	GZ_CAST_PLAIN,
	GZ_CAST_RICH, /**< light, pre-integration, depths */
	/** what GZ_CAST_RICH can, and colours of voxels; only for GZ_VOXEL_U8 */
	GZ_CAST_COLOURED,
	GZ_CAST_VARIANT_COUNT,
};

/** One instruction set's kernels, by variant, voxel type and interpolation; NULL where a variant
 * does not take a type. */
struct gz_cast_kernels {
	const char *name;
	gz_cast_tile_function *tile[GZ_CAST_VARIANT_COUNT][GZ_VOXEL_TYPE_COUNT][2];
	gz_cast_arriving_function *arriving;
};

extern const struct gz_cast_kernels gz_cast_portable;
#ifdef GZ_CAST_X86
extern const struct gz_cast_kernels gz_cast_avx2;
extern const struct gz_cast_kernels gz_cast_avx512;
#endif

/** Fill in the voxels of a volume or level, in memory, and how they are counted. */
void gz_cast_fill_voxels(const struct gz_volume *volume, struct gz_cast *cast);

/** Fill in how values become entries of a table, which is borrowed, and its extinction. */
void gz_cast_fill_table(const struct gz_transfer_table *table, struct gz_cast *cast);

/** The kernels of an instruction set by name; for NULL or "auto" the best that this processor runs.
 *  NULL if it runs none of that name. */
const struct gz_cast_kernels *gz_cast_kernels_find(const char *name);

#endif
