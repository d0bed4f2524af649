/**
 * @file
 * Casting the rays of a plan through surfaces: those of volumes where the data have one value, and
 * meshes.
 */
#ifndef GZ_RENDER_SURFACE_CPU_SURFACE_CASTER_H
#define GZ_RENDER_SURFACE_CPU_SURFACE_CASTER_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "render/picture/image.h"
#include "render/surface/shared/surface_meshes.h"
#include "render/surface/shared/surface_shot.h"
#include "render/technique/technique.h"

/** Surfaces, their tree, and the threads that cast. One thread at a time may use it. */
struct gz_surface_caster;

/** Whether there is one in this build: it needs Embree. If not, every other call fails with
 *  GZ_ERR_UNSUPPORTED, and the first two log what is missing. */
bool gz_surface_caster_present(void);

/** Check parameters. @retval GZ_ERR_UNSUPPORTED  this processor lacks the instruction set; logged
 */
enum gz_result gz_surface_caster_check(const struct gz_backend_params *params,
				       const struct gz_log *log);

/**
 * Make a caster that shows nothing.
 *
 * @param log  outlives the caster
 * @param[out] out_caster  owned by the caller; gz_surface_caster_destroy()
 * @retval GZ_ERR_UNSUPPORTED  this processor lacks the instruction set; logged
 * @retval GZ_ERR_INVAL        the number of threads is out of range; logged
 * @retval GZ_ERR_NO_MEM       out of memory
 */
enum gz_result gz_surface_caster_create(const struct gz_backend_params *params,
					const struct gz_log *log,
					struct gz_surface_caster **out_caster);

/**
 * Show these objects from the next picture on. Surfaces are made when that picture is drawn, as its
 * settings have the isovalue.
 *
 * @param objects  volumes in memory, and meshes; all of one world, the first one's volume's box.
 *                 What they point to is borrowed until the next call
 * @retval GZ_ERR_INVAL        no objects
 * @retval GZ_ERR_UNSUPPORTED  a volume of bricks, or an object without a volume; logged
 * @retval GZ_ERR_NO_MEM       out of memory
 */
enum gz_result gz_surface_caster_show(struct gz_surface_caster *caster,
				      const struct gz_object *objects, size_t count);

/**
 * Cast a picture of the plan's size and write every pixel. Makes the surfaces first if the isovalue
 * or the objects have changed. The same bits for any number of threads.
 *
 * @param image      NULL: only hits are wanted
 * @param planes     NULL: only colours
 * @param out_stats  may be NULL; its prepare_ms is the time for surfaces and tree
 * @retval GZ_ERR_INVAL   the settings or the camera are not valid, or nothing is shown
 * @retval GZ_ERR_FULL    the surface has too many triangles; logged
 * @retval GZ_ERR_UNSUPPORTED  the volume has too many voxels for GZ_SURFACE_VOXELS; logged
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_FORMAT  pictures of the surroundings: gz_cube_load(); logged
 * @retval GZ_ERR_NO_MEM  out of memory; logged
 */
enum gz_result gz_surface_caster_draw(struct gz_surface_caster *caster,
				      const struct gz_surface_shot *shot, struct gz_image *image,
				      const struct gz_surface_planes *planes,
				      struct gz_frame_stats *out_stats);

/**
 * Say which places of a picture the surfaces keep the light from: those behind them, with
 * isosurface.shadows. Makes the surfaces as gz_surface_caster_draw() does, which tells the time.
 *
 * @param[out] out_shade  its shares are 0 and 1; borrows from the caster until it draws the next
 *                        picture
 * @return the failures of gz_surface_caster_draw()
 */
enum gz_result gz_surface_caster_shade(struct gz_surface_caster *caster,
				       const struct gz_surface_shot *shot,
				       struct gz_shade *out_shade);

/** Find what is at a place of a picture. @param shot  its plan is not used @return the failures of
 * gz_surface_caster_draw() */
enum gz_result gz_surface_caster_pick(struct gz_surface_caster *caster,
				      const struct gz_surface_shot *shot,
				      const struct gz_pick_request *request,
				      struct gz_pick *out_pick);

/** How much the triangles of the last picture take. */
struct gz_surface_size {
	size_t triangles;
	size_t mesh_bytes; /**< of meshes that the caster has made */
	size_t tree_bytes;
	size_t normal_bytes; /**< of the corners' normals beside the tree */
};

/** The meshes that it shows, for gz_surface_meshes_take(). The caster makes those anew that are
 *  taken. */
struct gz_surface_meshes *gz_surface_caster_meshes(struct gz_surface_caster *caster);

/** See struct gz_surface_size. */
struct gz_surface_size gz_surface_caster_size(const struct gz_surface_caster *caster);

/** One line for reports, such as "avx512, 2 threads"; owned by the caster. */
const char *gz_surface_caster_describe(const struct gz_surface_caster *caster);

/** Destroy the caster and set the pointer to NULL. Accepts a pointer to NULL. */
void gz_surface_caster_destroy(struct gz_surface_caster **caster);

#endif
