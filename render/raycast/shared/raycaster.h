/**
 * @file
 * The ray caster: a volume, its transfer function, a camera and a plan become a picture, by one of
 * the backends. The technique's row is in render/raycast/raycast.h.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_RAYCASTER_H
#define GZ_RENDER_RAYCAST_SHARED_RAYCASTER_H

#include "base/log.h"
#include "base/result.h"
#include "render/data/volume.h"
#include "render/picture/camera.h"
#include "render/picture/image.h"
#include "render/plan/plan.h"
#include "render/raycast/shared/ray_params.h"
#include "render/technique/technique.h"
#include "render/transfer/transfer.h"

struct gz_raycaster;

/** What a backend must provide. Every table is const and has static storage. */
struct gz_raycaster_ops {
	const char *name; /**< "cpu", "gl" */
	enum gz_result (*create)(const struct gz_backend_params *params, const struct gz_log *log,
				 struct gz_raycaster **out_raycaster);
	/** Borrow @p volume until the next call or destroy, and prepare for skipping empty space.
	 */
	enum gz_result (*set_volume)(struct gz_raycaster *raycaster,
				     const struct gz_volume *volume);
	/** Copy @p transfer; needs a volume. */
	enum gz_result (*set_transfer)(struct gz_raycaster *raycaster,
				       const struct gz_transfer *transfer);
	/** See gz_raycaster_draw(). */
	enum gz_result (*draw)(struct gz_raycaster *raycaster, const struct gz_shot *shot,
			       struct gz_image *image, struct gz_frame_stats *out_stats);
	/** See gz_raycaster_shade(); only with light.shadow_steps. */
	enum gz_result (*shade)(struct gz_raycaster *raycaster, const struct gz_shot *shot,
				struct gz_shade *out_shade);
	/** Whether draw() refines plans (gz_plan_refine()) of what is shown. Bricks are asked for
	 *  by the plan before any ray is cast, so they have to do without. */
	bool (*refines)(const struct gz_raycaster *raycaster);
	/** Optional: see gz_drawer_ops. */
	unsigned (*picture_texture)(const struct gz_raycaster *raycaster);
	/** One line for reports, as in "avx512, 2 threads". */
	const char *(*describe)(const struct gz_raycaster *raycaster);
	void (*destroy)(struct gz_raycaster *raycaster);
};

/** Common head of every ray caster; a backend's own struct starts with one. */
struct gz_raycaster {
	const struct gz_raycaster_ops *ops;
	const struct gz_log *log;
};

/** All backends of this build, NULL-terminated. */
extern const struct gz_raycaster_ops *const gz_raycaster_backends[];

/**
 * Make a ray caster.
 *
 * @param backend  name of one of gz_raycaster_backends; NULL or "auto" for gl if a GPU runs it,
 * else cpu, which is about three times as fast as OpenGL in software
 * @param params   NULL for the defaults
 * @param[out] out_raycaster  owned by the caller: gz_raycaster_destroy()
 * @retval GZ_ERR_NOT_FOUND    no such backend; logged with the names of all
 * @retval GZ_ERR_UNSUPPORTED  this machine cannot run it, or not with that SIMD path; logged
 */
enum gz_result gz_raycaster_create(const char *backend, const struct gz_backend_params *params,
				   const struct gz_log *log, struct gz_raycaster **out_raycaster);

/**
 * Check a ray caster's settings before there is anything to show: that the backend exists, and that
 * the processor has the instructions.
 *
 * @return what gz_raycaster_create() would return for these reasons; logged
 */
enum gz_result gz_raycaster_check(const char *backend, const struct gz_backend_params *params,
				  const struct gz_log *log);

/** Show @p volume, borrowed until the next call or destroy. A transfer function must be set again
 *  after it. */
enum gz_result gz_raycaster_set_volume(struct gz_raycaster *raycaster,
				       const struct gz_volume *volume);

/** Use @p transfer (copied). GZ_ERR_INVAL before a volume is set. */
enum gz_result gz_raycaster_set_transfer(struct gz_raycaster *raycaster,
					 const struct gz_transfer *transfer);

/**
 * Cast the plan's rays and reconstruct the picture. Every pixel is written.
 *
 * @param shot   its settings are a struct gz_ray_params. A ray ends at its hit, if hits are there:
 *               the pixel of the hit takes the place of the background. With light.shadow_steps
 *               the shades of others fall on the volume
 * @param image  resized to the plan's size; NULL leaves the picture on the device
 * @param[out] out_stats  may be NULL
 * @retval GZ_ERR_INVAL   no volume or transfer function, or an invalid camera or parameter
 * @retval GZ_ERR_NO_MEM  no room for the picture; gl: on the graphics device, logged
 * @retval GZ_ERR_UNSUPPORTED  gl: the device or driver cannot do this; logged
 * @retval GZ_ERR_NO_DEVICE    gl: the context is lost; logged. Destroy the ray caster; cpu still
 *                             works
 *
 * The same inputs give the same bits, for any number of threads; gl: on the same device and driver.
 * Threads: one at a time for each ray caster.
 */
enum gz_result gz_raycaster_draw(struct gz_raycaster *raycaster, const struct gz_shot *shot,
				 struct gz_image *image, struct gz_frame_stats *out_stats);

/**
 * Say what the volume keeps back of the light: with light.shadow_steps as many steps from each
 * place, GZ_SHADOW_START voxel lengths away from it or where the way enters the clip region,
 * whichever is farther. Without, nothing.
 *
 * @param[out] out_shade  borrows from the ray caster until gz_raycaster_draw() of the same shot
 * @return the failures of gz_raycaster_draw() but GZ_ERR_NO_DEVICE
 */
enum gz_result gz_raycaster_shade(struct gz_raycaster *raycaster, const struct gz_shot *shot,
				  struct gz_shade *out_shade);

/** gz_raycaster_draw() of a shot without hits. */
enum gz_result gz_raycaster_render(struct gz_raycaster *raycaster, const struct gz_camera *camera,
				   const struct gz_ray_params *rays, const struct gz_plan *plan,
				   struct gz_image *image, struct gz_frame_stats *out_stats);

/** See gz_drawer_ops, picture_texture. 0 where the backend has none. */
unsigned gz_raycaster_picture_texture(const struct gz_raycaster *raycaster);

/** One line for people: the kernel and its threads, or the device. Owned by the ray caster. */
const char *gz_raycaster_describe(const struct gz_raycaster *raycaster);

/** Destroy and set to NULL. Accepts a pointer to NULL. */
void gz_raycaster_destroy(struct gz_raycaster **raycaster);

#endif
