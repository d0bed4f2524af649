/**
 * @file
 * Renders the picture that a foveated one is compared with: method `standard`, all rays, same
 * camera, on low-priority threads of its own. No caller waits for it.
 */
#ifndef GZ_VIEW_FRAME_REFERENCE_H
#define GZ_VIEW_FRAME_REFERENCE_H

#include <stdbool.h>

#include "base/log.h"
#include "base/result.h"
#include "render/data/volume.h"
#include "render/picture/camera.h"
#include "render/picture/image.h"
#include "render/raycast/shared/ray_params.h"
#include "render/technique/technique.h"
#include "render/transfer/transfer.h"

/** Renders reference pictures on its own threads. */
struct gz_reference_worker;

/** What a reference picture shows. */
struct gz_reference_view {
	struct gz_camera camera;
	struct gz_ray_params rays;
	double image_sampling_rate;
	int width, height; /**< of the picture, px */
};

/** What the worker needs. */
struct gz_reference_source {
	/** What is shown, at least one, in memory. The list is copied, with styles and templates;
	 *  what else it points to is borrowed until gz_reference_worker_stop(), but for transfer
	 *  functions. */
	const struct gz_object *objects;
	size_t object_count;
	/** "cpu", or "gl", in an OpenGL context of the worker's own without a window. NULL: cpu.
	 *  Static text: gz_frame_standard_backend(). */
	const char *backend;
	size_t gl_memory_bytes; /**< as in struct gz_backend_params */
	int threads;            /**< threads to cast with; 0: half of the processors */
	bool urgent;            /**< someone waits for it: the normal priority */
	/** Called on the worker's thread when a picture is finished or has failed. */
	void (*finished)(void *user);
	void *user;
	const struct gz_log *log;
};

/**
 * Start the worker's thread.
 *
 * @param transfer  copied
 * @param[out] out_worker  owned by the caller: gz_reference_worker_stop()
 * @retval GZ_ERR_INVAL        the source has no objects; not logged
 * @retval GZ_ERR_UNSUPPORTED  a volume is stored in bricks, which one renderer at a time can use;
 *                             not logged
 * @retval GZ_ERR_NO_MEM       out of memory, or no thread
 */
enum gz_result gz_reference_worker_start(const struct gz_reference_source *source,
					 const struct gz_transfer *transfer,
					 struct gz_reference_worker **out_worker);

/** Use another transfer function (copied) from now on. Does nothing if it is the same. */
void gz_reference_worker_set_transfer(struct gz_reference_worker *worker,
				      const struct gz_transfer *transfer);

/**
 * Show other objects from now on, of the same scene: some are hidden, others shown, and styles have
 * changed. Copied as those of gz_reference_worker_start(). Does nothing if they are the same.
 *
 * @param count  0: nothing changes
 * @retval GZ_ERR_NO_MEM  the present ones stay
 */
enum gz_result gz_reference_worker_set_objects(struct gz_reference_worker *worker,
					       const struct gz_object *objects, size_t count);

/** Request a picture and cancel the one being rendered. Does nothing if @p view equals the last
 * request. Does not block. @return whether another picture was requested */
bool gz_reference_worker_ask(struct gz_reference_worker *worker,
			     const struct gz_reference_view *view);

/** Cancel the last request, if there is one; the next one is made even if it is the same. Does not
 *  block. */
void gz_reference_worker_cancel(struct gz_reference_worker *worker);

/** Whether the last request is still being rendered, and the fraction done, 0 to 1. */
bool gz_reference_worker_busy(struct gz_reference_worker *worker, double *out_share);

/**
 * Take the picture finished since the last call.
 *
 * @param[in,out] image  swapped with the picture; the worker reuses its memory
 * @return whether a picture was taken; it shows the last request
 */
bool gz_reference_worker_take(struct gz_reference_worker *worker, struct gz_image *image);

/** End the thread within the time of a few rows, free the worker and set the pointer to NULL.
 * Accepts NULL and a pointer to NULL. */
void gz_reference_worker_stop(struct gz_reference_worker **worker);

#endif
