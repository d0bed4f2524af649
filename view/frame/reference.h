/**
 * @file
 * The picture that a foveated one is compared with: `standard`, every pixel, of the same camera,
 * cast by the cpu backend on threads of its own that leave the processor to others. Nobody waits
 * for it.
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

/** What makes them. */
struct gz_reference_worker;

/** What a picture shows. */
struct gz_reference_view {
	struct gz_camera camera;
	struct gz_ray_params rays;
	double image_sampling_rate;
	int width, height; /**< of the picture, px */
};

/** What it takes to make them. */
struct gz_reference_source {
	const struct gz_technique *technique;
	const struct gz_volume *volume; /**< borrowed until gz_reference_worker_stop(); in memory */
	int threads;                    /**< 0: half of the machine's */
	/** Called on a thread of the worker's when a picture is finished or cannot be made. */
	void (*finished)(void *user);
	void *user;
	const struct gz_log *log;
};

/**
 * Start the thread. Its renderer is made there.
 *
 * @param transfer  copied
 * @param[out] out_worker  owned by the caller: gz_reference_worker_stop()
 * @retval GZ_ERR_UNSUPPORTED  a volume of bricks, which one picture at a time has; not logged
 * @retval GZ_ERR_NO_MEM       no room or no thread
 */
enum gz_result gz_reference_worker_start(const struct gz_reference_source *source,
					 const struct gz_transfer *transfer,
					 struct gz_reference_worker **out_worker);

/** Have pictures made by another transfer function (copied); nothing where it is the same. */
void gz_reference_worker_set_transfer(struct gz_reference_worker *worker,
				      const struct gz_transfer *transfer);

/** Ask for a picture. One in the making that shows something else is given up; nothing where it is
 *  what was asked for last. Waits for nobody. */
void gz_reference_worker_ask(struct gz_reference_worker *worker,
			     const struct gz_reference_view *view);

/** Whether what was asked for last is still to come, and how much of it is done, 0 to 1. */
bool gz_reference_worker_busy(struct gz_reference_worker *worker, double *out_share);

/**
 * Take the picture finished since the last call.
 *
 * @param[in,out] image  becomes it; what it held is the worker's next room
 * @return whether there was one: it is of what was asked for last
 */
bool gz_reference_worker_take(struct gz_reference_worker *worker, struct gz_image *image);

/** End the thread, which takes as long as a few rows of a picture; free, set to NULL. Accepts a
 *  pointer to NULL. */
void gz_reference_worker_stop(struct gz_reference_worker **worker);

#endif
