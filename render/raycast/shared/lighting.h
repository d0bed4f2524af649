/**
 * @file
 * Light as the backends take it, and the grid of occlusion, made anew when what it depends on has
 * changed.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_LIGHTING_H
#define GZ_RENDER_RAYCAST_SHARED_LIGHTING_H

#include "base/log.h"
#include "render/light/light.h"
#include "render/light/occlusion.h"
#include "render/picture/camera.h"
#include "render/raycast/shared/ray_params.h"

/** One light and how surfaces answer it: struct gz_light, ready for use. */
struct gz_cast_light {
	bool on;
	float towards[3]; /**< unit vector in world directions */
	float ambient, diffuse, specular, shininess;
	float gradient_scale[3]; /**< see gz_light_gradient_scale(); of the level of detail */
	float occlusion;         /**< share of the ambient light that can be kept away */
	const uint16_t *cells;   /**< struct gz_occlusion; NULL where none is asked for */
	float cell_scale[3], cell_bias[3]; /**< from places counted from the first datum of the
					      volume to those counted from the first cell's */
	float cell_greatest[3];            /**< greatest index of a cell */
	int32_t cell_last[3];   /**< greatest index of the lower of two: max(dims - 2, 0) */
	int32_t cell_stride[3]; /**< 0 along an axis of one cell, x excepted */
};

/** Zero-initialised holds nothing. */
struct gz_lighting {
	struct gz_occlusion occlusion;
	bool current;            /**< occlusion is that of the transfer function at hand and of: */
	double radius;           /**< this one */
	struct gz_clip_box clip; /**< and this one */
};

/** The volume or the transfer function has changed; memory is kept. */
void gz_lighting_forget(struct gz_lighting *lighting);

/**
 * Make the grid of occlusion that a frame asks for, unless it is there.
 *
 * @param workers  who make it; NULL for the calling thread alone
 * @retval GZ_ERR_NO_MEM       there is none; logged
 * @retval GZ_ERR_UNSUPPORTED  of a volume of bricks, whose voxels are not all at hand; logged
 */
enum gz_result gz_lighting_prepare(struct gz_lighting *lighting, const struct gz_volume *volume,
				   const struct gz_transfer_table *table,
				   const struct gz_ray_params *rays, struct gz_workers *workers,
				   const struct gz_log *log);

/**
 * What the kernels take, after gz_lighting_prepare().
 *
 * @param volume  the whole one
 * @param factor  by how much coarser the level of detail is, along each axis
 * @param[out] out_light  borrows from @p lighting until the next gz_lighting_prepare()
 */
void gz_lighting_fill(const struct gz_lighting *lighting, const struct gz_volume *volume,
		      const int factor[3], const struct gz_transfer_table *table,
		      const struct gz_ray_params *rays, const struct gz_ray_frame *ray_frame,
		      struct gz_cast_light *out_light);

/** Free and zero. */
void gz_lighting_free(struct gz_lighting *lighting);

#endif
