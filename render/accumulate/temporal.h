/**
 * @file
 * Accumulation over frames. Each frame shifts its lattices by some pixels, so that rays go where
 * none went before, and what earlier frames saw is kept (docs/foveation.md). It works on finished
 * pictures and is the same for all backends. It is off by default; then nothing is kept and no
 * lattice moves.
 */
#ifndef GZ_RENDER_ACCUMULATE_TEMPORAL_H
#define GZ_RENDER_ACCUMULATE_TEMPORAL_H

#include <stdbool.h>
#include <stdint.h>

#include "base/option.h"
#include "base/result.h"
#include "base/workers.h"
#include "render/picture/camera.h"
#include "render/picture/image.h"
#include "render/plan/plan.h"

/** Lattices move by 0 to GZ_TEMPORAL_SHIFTS - 1 pixels along each axis: the widest spacing. */
#define GZ_TEMPORAL_SHIFTS 32

/** Section [temporal] of a scene. */
struct gz_temporal_params {
	bool keep_rays; /**< gz_shot.keeps_rays; not while frames accumulate, as their rays move */
	bool accumulate;
	double weight; /**< share of earlier frames in pixels between rays while the camera moves,
			  [0, 0.98] */
};

/** Table over struct gz_temporal_params. */
extern const struct gz_option gz_temporal_options[];
extern const size_t gz_temporal_option_count;

/** The table's presets. */
struct gz_temporal_params gz_temporal_default(void);

/** What a frame shows. Frames that differ in more than the camera do not share a history. */
struct gz_temporal_content {
	struct gz_camera camera;
	uint64_t serial; /**< the caller increases it when anything else changes what is shown */
	/** The fourth byte of frame_image's pixels is a depth (gz_shot.depths), of the range
	 *  gz_camera_ray_depths(). Otherwise nothing is kept while the camera moves. */
	bool deep;
};

/** Squared errors at a ray, of grey levels and all channels. */
struct gz_temporal_errors {
	float bend2; /**< how far it is from the means of its neighbours */
	float said2; /**< how far the history is from it; INFINITY: it does not show it */
};

/** The history. Zero-initialised is empty; keep it from frame to frame. One thread at a time. */
struct gz_temporal {
	struct gz_workers *workers;
	int width, height;
	unsigned frame;        /**< index of the shift, 0 to GZ_TEMPORAL_SHIFTS squared - 1 */
	unsigned still_frames; /**< frames since the camera moved or the history began */
	bool any;              /**< there is a history */
	int shift[2];          /**< of the current frame, px */
	struct gz_temporal_content shown;  /**< what the history shows */
	struct gz_image frame_image;       /**< render into this */
	struct gz_image history, moved;    /**< size of the picture */
	uint8_t *kept, *cast;              /**< for each pixel, how it is known */
	struct gz_temporal_errors *errors; /**< at each pixel with a ray apart from others */
};

/**
 * Begin a frame: choose its shift, and drop the history if it shows something else.
 *
 * @param content   what the frame shows
 * @param[in,out] request  for the picture's plan; changed into one for temporal->frame_image, which
 *                         is larger by GZ_TEMPORAL_SHIFTS along each axis
 * @param[in,out] display  the caller's copy of the request's display; enlarged by the same pixels.
 *                         The request then points to it
 * @retval GZ_ERR_INVAL   the picture is too large to be shifted; the request is unchanged
 * @retval GZ_ERR_NO_MEM  out of memory or threads; the request is unchanged
 */
enum gz_result gz_temporal_begin(struct gz_temporal *temporal,
				 const struct gz_temporal_content *content,
				 struct gz_plan_request *request, struct gz_display *display);

/** Set where the pixels of a plan lie that was made from the request. The caller then renders the
 * plan into temporal->frame_image. */
void gz_temporal_place(const struct gz_temporal *temporal, struct gz_plan *plan);

/**
 * End a frame: join temporal->frame_image with the history.
 *
 * @param content  the one passed to gz_temporal_begin()
 * @param plan     the plan of frame_image
 * @param[out] image  the picture; resized. A pixel that was cast is the frame's, bit for bit, where
 * the plan casts every pixel
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_temporal_end(struct gz_temporal *temporal,
			       const struct gz_temporal_params *params,
			       const struct gz_temporal_content *content,
			       const struct gz_plan *plan, struct gz_image *image);

/** Whether further frames of the same content would still change the picture. */
bool gz_temporal_settling(const struct gz_temporal *temporal);

/** Drop the history: the next frame starts a new one. */
void gz_temporal_forget(struct gz_temporal *temporal);

/** Free the history and zero it. */
void gz_temporal_free(struct gz_temporal *temporal);

#endif
