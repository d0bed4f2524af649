/**
 * @file
 * What is shown, on the graphics device: the volume with its levels of detail, and the transfer
 * function. All calls need the context current.
 */
#ifndef GZ_RENDER_RAYCAST_GL_GL_SCENE_H
#define GZ_RENDER_RAYCAST_GL_GL_SCENE_H

#include <stdbool.h>

#include "base/log.h"
#include "base/result.h"
#include "render/picture/camera.h"
#include "render/raycast/gl/cast_block.h"
#include "render/raycast/gl/gl_bricks.h"
#include "render/raycast/gl/gl_tables.h"
#include "render/raycast/gl/gl_volume.h"
#include "render/raycast/shared/detail.h"
#include "render/raycast/shared/lighting.h"
#include "render/raycast/shared/preintegration.h"
#include "render/raycast/shared/ray_params.h"
#include "render/reconstruct/gl/gl_plan.h"
#include "render/transfer/transfer.h"

/** Zero-initialised holds nothing. */
struct gz_gl_scene {
	const struct gz_volume *volume; /**< borrowed; NULL: none */
	bool has_transfer;
	struct gz_transfer_table table;
	struct gz_detail detail;
	struct gz_preintegration preintegration;
	struct gz_workers *workers;                /**< NULL until there is much to do */
	struct gz_gl_volume levels[GZ_LEVELS_MAX]; /**< of those that the device has */
	int level_count;
	bool bricked; /**< voxels come by bricks: */
	struct gz_gl_bricks bricks;
	struct gz_gl_tables tables;
	struct gz_lighting lighting;
	unsigned occlusion;    /**< texture of the lighting's grid; 0: none */
	int occlusion_dims[3]; /**< of the texture */
};

/**
 * Show @p volume, borrowed until the next call or gz_gl_scene_free(): whole where the device has
 * room for that, else by bricks, as a file of bricks is.
 *
 * @retval GZ_ERR_UNSUPPORTED  the device's textures do not even hold the macrocells; logged
 * @retval GZ_ERR_NO_MEM       no room, on the device not even for the coarsest bricks; logged
 * @retval GZ_ERR_NO_DEVICE    the context is lost; logged
 */
enum gz_result gz_gl_scene_set_volume(struct gz_gl_scene *scene, const struct gz_gl_device *device,
				      const struct gz_volume *volume, const struct gz_log *log);

/** Use @p transfer (copied); needs a volume. */
void gz_gl_scene_set_transfer(struct gz_gl_scene *scene, const struct gz_transfer *transfer);

/**
 * Have ready what a frame needs: tables of its steps, coarser levels where its rays take them, and
 * those of its bricks that have come.
 *
 * @param camera  valid
 * @param wait    until all bricks are there that have room
 * @param[out] out_levels  which level each kind of tile takes
 * @retval GZ_ERR_NO_MEM  no room for pre-integrated tables or the list of wanted bricks; logged.
 *                        Without room for coarser levels all rays take the full one
 */
enum gz_result gz_gl_scene_prepare(struct gz_gl_scene *scene, const struct gz_gl_device *device,
				   const struct gz_camera *camera, const struct gz_ray_params *rays,
				   const struct gz_plan *plan, bool wait,
				   struct gz_gl_tile_levels *out_levels, const struct gz_log *log);

/** Fill what of @p block belongs to a level: rays and volume in its own voxel coordinates, and what
 *  all levels share of rays and transfer function. */
void gz_gl_scene_fill(const struct gz_gl_scene *scene, int level, const struct gz_ray_frame *world,
		      const struct gz_ray_params *rays, const struct gz_plan *plan,
		      struct gz_gl_cast_block *block);

/** Bind tables and light to their units. */
void gz_gl_scene_bind(const struct gz_gl_scene *scene);

/** Delete and free all of it, and zero the struct. */
void gz_gl_scene_free(struct gz_gl_scene *scene);

/** The same without a context, whose textures are gone with it. */
void gz_gl_scene_forget(struct gz_gl_scene *scene);

#endif
