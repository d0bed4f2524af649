/**
 * @file
 * Light in the form that the backends take, with the grid of ambient occlusion and the cells of
 * shadows, which are made again when something that they depend on has changed.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_LIGHTING_H
#define GZ_RENDER_RAYCAST_SHARED_LIGHTING_H

#include "base/log.h"
#include "render/light/light.h"
#include "render/light/occlusion.h"
#include "render/picture/camera.h"
#include "render/raycast/shared/ray_params.h"
#include "render/raycast/shared/shadow_cells.h"

/** A grid of cells around the volume's voxels, of one level of detail. */
struct gz_cast_cells {
	const uint16_t *cells;   /**< NULL: there are none */
	float scale[3], bias[3]; /**< cell = datum * scale + bias, both counted from the first
				    one's middle */
	float greatest[3];       /**< greatest index of a cell */
	int32_t last[3];         /**< greatest index of the lower of two: max(dims - 2, 0) */
	int32_t stride[3];       /**< 0 along an axis of one cell, x excepted */
};

/** A cell's number in the grid of struct gz_cast_shadow where all light arrives. */
#define GZ_LIGHT_GRID_UNIT 65535

/** Shadows ready for the kernels; lengths in voxel lengths, places in voxels of the level of detail
 *  counted from the first datum. */
struct gz_cast_shadow {
	int steps;        /**< 0: no shadows */
	float reach;      /**< of the last step's end */
	float towards[3]; /**< one voxel length towards the light; no component is 0 */
	float inverse[3]; /**< 1 / towards */
	float exit[3];    /**< the faces of the clip box that face the light */
	/** The way to the clip plane, if that faces the light: exit_plane[3] less the dot product
	 *  of the place and the others; else very long. */
	float exit_plane[4];
	int levels;
	struct gz_cast_cells level[GZ_SHADOW_LEVELS];
	float kept_per_length[GZ_SHADOW_LEVELS]; /**< turns a cell of the level into powers of two
						    per voxel length */
	/** The share of the light that arrives, in units of 1 / GZ_LIGHT_GRID_UNIT. Filled by the
	 *  backend, which makes it. */
	struct gz_cast_cells arriving;
};

/** struct gz_light ready for the kernels: one light, and how surfaces reflect it. */
struct gz_cast_light {
	bool on;          /**< by gradients or with shadows */
	bool gradient;    /**< surfaces are lit */
	float towards[3]; /**< unit vector in world directions */
	float ambient, diffuse, specular, shininess;
	int whole_shininess; /**< 0: shininess is not a whole number */
	float least_cosine;  /**< its power is far below what can be seen, and no less */
	float reflection;
	float gradient_scale[3];       /**< see gz_light_gradient_scale(); of the level of detail */
	float occlusion;               /**< greatest share of the ambient light that is blocked */
	struct gz_cast_cells occluded; /**< of struct gz_occlusion */
	struct gz_cast_shadow shadow;
};

/** Zero-initialised holds nothing. */
struct gz_lighting {
	struct gz_occlusion occlusion;
	uint64_t serial; /**< increased whenever occlusion is made */
	bool current;    /**< occlusion is for the present transfer function, radius and clip */
	double radius;
	struct gz_clip_region clip;
	struct gz_shadow_cells shadows;
	uint64_t shadow_serial; /**< increased whenever shadows are made */
	bool shadows_current; /**< shadows are for the present transfer function and shadow_clip */
	struct gz_clip_region shadow_clip;
	double spent_ms;                /**< making both, until gz_lighting_take_spent_ms() */
	const struct gz_volume *volume; /**< of gz_lighting_prepare(), borrowed */
	const struct gz_transfer_table *table; /**< of gz_lighting_prepare(), borrowed */
};

/** Whether frames take the grid of occlusion. */
bool gz_lighting_wants_occlusion(const struct gz_ray_params *rays);

/** The volume or the transfer function has changed; memory is kept. */
void gz_lighting_forget(struct gz_lighting *lighting);

/**
 * Prepare a frame: make the grid of occlusion and the cells of shadows if the frame needs some that
 * are not there.
 *
 * @param volume, table  borrowed until the next call
 * @param workers        share the work; NULL for the calling thread alone
 * @retval GZ_ERR_NO_MEM       out of memory; logged
 * @retval GZ_ERR_UNSUPPORTED  occlusion or shadows of a volume of bricks, not all of whose voxels
 * are in memory; logged
 */
enum gz_result gz_lighting_prepare(struct gz_lighting *lighting, const struct gz_volume *volume,
				   const struct gz_transfer_table *table,
				   const struct gz_ray_params *rays, struct gz_workers *workers,
				   const struct gz_log *log);

/** The time that gz_lighting_prepare() has spent on what later frames reuse, since the last call;
 * 0: none was due. */
double gz_lighting_take_spent_ms(struct gz_lighting *lighting);

/** Fill the shininess and what follows from it. */
void gz_cast_light_polish(double shininess, struct gz_cast_light *out_light);

/**
 * Fill what the kernels take of light, after gz_lighting_prepare() with the same @p rays.
 *
 * @param factor  ratio of the volume's voxels to those of the level of detail along each axis
 * @param[out] out_light  borrows from @p lighting until the next gz_lighting_prepare()
 */
void gz_lighting_fill(const struct gz_lighting *lighting, const int factor[3],
		      const struct gz_ray_params *rays, const struct gz_ray_frame *ray_frame,
		      struct gz_cast_light *out_light);

/**
 * Fill a grid for the kernels.
 *
 * @param cells   x fastest; GZ_VOLUME_PADDING bytes follow; borrowed
 * @param dims    cells along each axis
 * @param edge    of a cell, voxels of the full volume
 * @param factor  as for gz_lighting_fill()
 */
void gz_cast_cells_fill(const uint16_t *cells, const int dims[3], const int edge[3],
			const int factor[3], struct gz_cast_cells *out_cells);

/** Free and zero. */
void gz_lighting_free(struct gz_lighting *lighting);

#endif
