/**
 * @file
 * The renderer: volume, transfer function, camera and plan to picture, by one of the backends.
 */
#ifndef GZ_RENDER_RENDERER_H
#define GZ_RENDER_RENDERER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "render/camera.h"
#include "render/image.h"
#include "render/plan/plan.h"
#include "render/ray_params.h"
#include "render/transfer.h"
#include "render/volume/volume.h"

/** What one frame cost. */
struct gz_frame_stats {
	uint64_t rays;    /**< cast, those that miss the volume included */
	uint64_t samples; /**< voxel interpolations done */
	double cast_ms;
	double reconstruct_ms;
	double gpu_ms; /**< gl: both together, by the device's clock; NaN where there is none, or a
			    processor does the device's work */
	uint64_t bricks_coming; /**< of a volume shown by bricks: sent for and not there yet. While
				   it is above 0 the same picture, made again, is sharper */
};

struct gz_renderer;
struct gz_gl_context;

/** Settings of a backend. */
struct gz_renderer_params {
	int threads;      /**< cpu: 0 = one per processor, else 1 to 256 */
	const char *simd; /**< cpu: NULL or "auto", else "portable", "avx2", "avx512" */
	/** Of a volume that is shown by bricks: each picture waits for all bricks that it shows, or
	 * as many as have room; else it shows those that are there, coarse ones first. */
	bool wait_for_bricks;
	/** gl: where it draws, borrowed, outlives the renderer; NULL = headless, from EGL. A
	 * program with windows must give a window's (render/gl/gl_context.h). */
	struct gz_gl_context *gl_context;
	bool gl_hardware_only;  /**< gl: refuse OpenGL that a processor works out */
	bool gl_as_hardware;    /**< gl: draw as on a graphics device wherever it is, for tests */
	int gl_volume_edge_max; /**< gl: show volumes with a longer edge, voxels, by bricks, as with
				     a driver with smaller textures; 0 = the driver's own limit */
	/** gl: voxels take no more of the device's memory, bytes, as if it had no more; what does
	 * not fit whole is shown by bricks. 0 = what the driver has. */
	size_t gl_memory_bytes;
};

/** What a backend must provide. Every table is const and has static storage. */
struct gz_renderer_ops {
	const char *name; /**< "cpu", "gl" */
	enum gz_result (*create)(const struct gz_renderer_params *params, const struct gz_log *log,
				 struct gz_renderer **out_renderer);
	/** Borrow @p volume until the next call or destroy; build what skipping needs. */
	enum gz_result (*set_volume)(struct gz_renderer *renderer, const struct gz_volume *volume);
	/** Copy @p transfer; needs a volume. */
	enum gz_result (*set_transfer)(struct gz_renderer *renderer,
				       const struct gz_transfer *transfer);
	/** See gz_renderer_render(). */
	enum gz_result (*render)(struct gz_renderer *renderer, const struct gz_camera *camera,
				 const struct gz_ray_params *rays, const struct gz_plan *plan,
				 struct gz_image *image, struct gz_frame_stats *out_stats);
	/** Optional: see gz_renderer_picture_texture(). */
	unsigned (*picture_texture)(const struct gz_renderer *renderer);
	/** One line for reports: "avx512, 2 threads". */
	const char *(*describe)(const struct gz_renderer *renderer);
	void (*destroy)(struct gz_renderer *renderer);
};

/** Common head of every renderer; a backend's own struct starts with one. */
struct gz_renderer {
	const struct gz_renderer_ops *ops;
	const struct gz_log *log;
};

/** All backends of this build, NULL-terminated; in the order that "auto" tries them. */
extern const struct gz_renderer_ops *const gz_backends[];

/**
 * Make a renderer.
 *
 * @param backend  name of one of gz_backends; NULL or "auto" for gl where a GPU does its work, else
 *                 cpu, which beats OpenGL on a processor about three times
 * @param params   NULL for the defaults
 * @param[out] out_renderer  owned by the caller: gz_renderer_destroy()
 * @retval GZ_ERR_NOT_FOUND    no such backend; logged with those there are
 * @retval GZ_ERR_UNSUPPORTED  this machine cannot run it (or that SIMD path); logged
 */
enum gz_result gz_renderer_create(const char *backend, const struct gz_renderer_params *params,
				  const struct gz_log *log, struct gz_renderer **out_renderer);

/**
 * Check what can be known of a renderer's settings before there is anything to show: that there is
 * such a backend, and that the processor runs such instructions.
 *
 * @return what gz_renderer_create() would return for these reasons; logged
 */
enum gz_result gz_renderer_check(const char *backend, const struct gz_renderer_params *params,
				 const struct gz_log *log);

/** Show @p volume, borrowed until the next call or destroy. The transfer function must be set anew.
 */
enum gz_result gz_renderer_set_volume(struct gz_renderer *renderer, const struct gz_volume *volume);

/** Use @p transfer (copied). GZ_ERR_INVAL before a volume is set. */
enum gz_result gz_renderer_set_transfer(struct gz_renderer *renderer,
					const struct gz_transfer *transfer);

/**
 * Cast the plan's rays and reconstruct the picture. Every pixel is written.
 *
 * @param plan   made for the size of the picture wanted
 * @param image  resized to the plan's size; NULL leaves the picture on the device: see
 *               gz_renderer_picture_texture()
 * @param[out] out_stats  may be NULL
 * @retval GZ_ERR_INVAL   no volume or transfer function, or an invalid camera or parameter
 * @retval GZ_ERR_NO_MEM  no room for the picture; gl: on the graphics device, logged
 * @retval GZ_ERR_UNSUPPORTED  gl: something it cannot do is asked for; logged
 * @retval GZ_ERR_NO_DEVICE    gl: the context is lost; logged. Destroy the renderer; cpu can go on
 *
 * The same inputs give the same bits, for any number of threads; gl: on the same device and driver.
 * Threads: one at a time per renderer.
 */
enum gz_result gz_renderer_render(struct gz_renderer *renderer, const struct gz_camera *camera,
				  const struct gz_ray_params *rays, const struct gz_plan *plan,
				  struct gz_image *image, struct gz_frame_stats *out_stats);

/** OpenGL's name of the texture, RGBA8 with row 0 on top, that the last picture without an image is
 *  in: of the renderer's context, valid until the next frame. 0 where the backend has none, and
 * then pictures need an image. */
unsigned gz_renderer_picture_texture(const struct gz_renderer *renderer);

/** One line for people: the kernel chosen and its threads. Owned by the renderer. */
const char *gz_renderer_describe(const struct gz_renderer *renderer);

/** Destroy and set to NULL. Accepts a pointer to NULL. */
void gz_renderer_destroy(struct gz_renderer **renderer);

#endif
