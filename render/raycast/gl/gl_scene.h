/**
 * @file
 * What the graphics device shows: the volume with its levels of detail, the transfer function and
 * the light. All calls need a current context.
 */
#ifndef GZ_RENDER_RAYCAST_GL_GL_SCENE_H
#define GZ_RENDER_RAYCAST_GL_GL_SCENE_H

#include <stdbool.h>

#include "base/log.h"
#include "base/result.h"
#include "render/light/cube_pictures.h"
#include "render/light/gl/gl_cube.h"
#include "render/picture/camera.h"
#include "render/raycast/cpu/faded_light.h"
#include "render/raycast/cpu/volume_shade.h"
#include "render/raycast/gl/gl_bricks.h"
#include "render/raycast/gl/gl_cast.h"
#include "render/raycast/gl/gl_textures.h"
#include "render/raycast/shared/detail.h"
#include "render/raycast/shared/lighting.h"
#include "render/raycast/shared/preintegration.h"
#include "render/raycast/shared/ray_params.h"
#include "render/reconstruct/gl/gl_plan.h"
#include "render/transfer/transfer.h"

/** A grid of cells as a texture. */
struct gz_gl_grid {
	unsigned texture; /**< 16 bits a cell; 0 = none */
	int dims[3];      /**< of the texture */
};

/** Zero-initialised holds nothing. */
struct gz_gl_scene {
	const struct gz_volume *volume; /**< borrowed; NULL: none */
	bool has_transfer;
	struct gz_transfer_table *table; /**< NULL: none yet */
	struct gz_detail detail;
	struct gz_preintegration preintegration;
	struct gz_workers *workers;                /**< NULL until needed */
	struct gz_gl_volume levels[GZ_LEVELS_MAX]; /**< those that the device has */
	int level_count;
	bool bricked; /**< the volume is shown by these bricks: */
	struct gz_gl_bricks bricks;
	struct gz_gl_tables tables;
	/** Made by the processor; shadows by the kernels of the cpu backend. */
	struct gz_faded_light light;
	struct gz_cube_pictures pictures; /**< of the surroundings, if they are wanted */
	struct gz_gl_cube cube;
	struct gz_gl_grid occlusion;
	uint64_t occlusion_serial;    /**< of the grid in the texture */
	struct gz_gl_grid arriving;   /**< the grid of shadows */
	uint64_t arriving_serial;     /**< of the grid in the texture */
	struct gz_volume_shade shade; /**< on others in the picture */
	double prepare_ms;            /**< that the last frame spent on what later frames reuse */
};

/** The threads that help the device's processor side, started when first asked for. NULL: there is
 *  no memory for them. */
struct gz_workers *gz_gl_scene_workers(struct gz_gl_scene *scene);

/**
 * Show @p volume, borrowed until the next call or gz_gl_scene_free(): whole if the device has room,
 * else by bricks. A file of bricks is always shown by bricks.
 *
 * @retval GZ_ERR_UNSUPPORTED  the device's textures cannot hold the macrocells; logged
 * @retval GZ_ERR_NO_MEM       no memory, or no room on the device even for the coarsest bricks;
 * logged
 * @retval GZ_ERR_NO_DEVICE    the context is lost; logged
 */
enum gz_result gz_gl_scene_set_volume(struct gz_gl_scene *scene, const struct gz_gl_device *device,
				      const struct gz_volume *volume, const struct gz_log *log);

/** Use @p transfer, which is copied. Needs a volume. GZ_ERR_NO_MEM: out of memory; not logged. */
enum gz_result gz_gl_scene_set_transfer(struct gz_gl_scene *scene,
					const struct gz_transfer *transfer);

/** One frame. What it points to is borrowed. */
struct gz_gl_frame {
	const struct gz_camera *camera;   /**< valid */
	const struct gz_ray_frame *world; /**< the camera's rays, by pixels of the plan */
	double near; /**< depth at which they begin, in lengths of their directions */
	const struct gz_ray_params *rays;
	const struct gz_plan *plan;
	const struct gz_ray_depths *depths; /**< that pixels tell; NULL: none */
	const struct gz_shade *shades;      /**< of others on the volume */
	size_t shade_count;
	bool wait; /**< wait until all bricks are there that have room */
};

/**
 * Prepare a frame: tables of its steps, coarser levels if its rays take them, the bricks that are
 * loaded, and the grids of light.
 *
 * @param[out] out_levels  which level each kind of tile takes
 * @retval GZ_ERR_NO_MEM  no memory for pre-integrated tables or the list of wanted bricks; logged.
 *                        Without room for coarser levels all rays take the full one
 * @retval GZ_ERR_UNSUPPORTED  occlusion or shadows need voxels that are not in memory, or cells
 *                             beyond the device's textures; logged
 */
enum gz_result gz_gl_scene_prepare(struct gz_gl_scene *scene, const struct gz_gl_device *device,
				   const struct gz_gl_frame *frame,
				   struct gz_gl_tile_levels *out_levels, const struct gz_log *log);

/** Say what the volume keeps back of the light, as gz_raycaster_shade() does. Needs no context. */
enum gz_result gz_gl_scene_shade(struct gz_gl_scene *scene, const struct gz_ray_params *rays,
				 const struct gz_ray_frame *world, const struct gz_log *log,
				 struct gz_shade *out_shade);

/** Fill in @p block for a level: rays and volume in the level's voxel coordinates, and what all
 * levels share. After gz_gl_scene_prepare() with the same frame. */
void gz_gl_scene_fill(const struct gz_gl_scene *scene, int level, const struct gz_gl_frame *frame,
		      struct gz_gl_cast_block *block);

/** Bind tables and light to their units. */
void gz_gl_scene_bind(const struct gz_gl_scene *scene);

/** Delete and free all of it, and zero the struct. */
void gz_gl_scene_free(struct gz_gl_scene *scene);

/** Free and zero without a context: a lost one took the textures with it. */
void gz_gl_scene_forget(struct gz_gl_scene *scene);

#endif
