/**
 * @file
 * Light in the form that the backends take, and the grid of ambient occlusion, which is made again
 * when something that it depends on has changed.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_LIGHTING_H
#define GZ_RENDER_RAYCAST_SHARED_LIGHTING_H

#include "base/log.h"
#include "render/light/light.h"
#include "render/light/occlusion.h"
#include "render/picture/camera.h"
#include "render/raycast/shared/ray_params.h"

/** struct gz_light ready for the kernels: one light, and how surfaces reflect it. */
struct gz_cast_light {
	bool on;
	float towards[3]; /**< unit vector in world directions */
	float ambient, diffuse, specular, shininess;
	float gradient_scale[3]; /**< see gz_light_gradient_scale(); of the level of detail */
	float occlusion;         /**< greatest share of the ambient light that is blocked */
	const uint16_t *cells;   /**< of struct gz_occlusion; NULL without occlusion */
	float cell_scale[3], cell_bias[3]; /**< cell = datum * scale + bias, both
					      counted from the first one's middle */
	float cell_greatest[3];            /**< greatest index of a cell */
	int32_t cell_last[3];   /**< greatest index of the lower of two: max(dims - 2, 0) */
	int32_t cell_stride[3]; /**< 0 along an axis of one cell, x excepted */
};

/** Zero-initialised holds nothing. */
struct gz_lighting {
	struct gz_occlusion occlusion;
	bool current; /**< occlusion is for the present transfer function, radius and clip */
	double radius;
	struct gz_clip_box clip;
	const struct gz_volume *volume;        /**< of gz_lighting_prepare(), borrowed */
	const struct gz_transfer_table *table; /**< of gz_lighting_prepare(), borrowed */
};

/** The volume or the transfer function has changed; memory is kept. */
void gz_lighting_forget(struct gz_lighting *lighting);

/**
 * Prepare a frame: make the grid of occlusion if the frame needs one that is not there.
 *
 * @param volume, table  borrowed until the next call
 * @param workers        share the work; NULL for the calling thread alone
 * @retval GZ_ERR_NO_MEM       out of memory; logged
 * @retval GZ_ERR_UNSUPPORTED  occlusion of a volume of bricks, not all of whose voxels are in
 * memory; logged
 */
enum gz_result gz_lighting_prepare(struct gz_lighting *lighting, const struct gz_volume *volume,
				   const struct gz_transfer_table *table,
				   const struct gz_ray_params *rays, struct gz_workers *workers,
				   const struct gz_log *log);

/**
 * Fill what the kernels take of light, after gz_lighting_prepare() with the same @p rays.
 *
 * @param factor  ratio of the volume's voxels to those of the level of detail along each axis
 * @param[out] out_light  borrows from @p lighting until the next gz_lighting_prepare()
 */
void gz_lighting_fill(const struct gz_lighting *lighting, const int factor[3],
		      const struct gz_ray_params *rays, const struct gz_ray_frame *ray_frame,
		      struct gz_cast_light *out_light);

/** Free and zero. */
void gz_lighting_free(struct gz_lighting *lighting);

#endif
