/**
 * @file
 * How much finer plans become while nothing but the gaze changes (foveation.still_growth). Rays of
 * earlier pictures are kept then, so a picture has time for more: each adds a share of the method's
 * rays, until every pixel has one. Pure steps over a state, by pictures and not by time, so a
 * replay gives the same pictures.
 */
#ifndef GZ_RENDER_FRAME_STILL_H
#define GZ_RENDER_FRAME_STILL_H

#include <stdbool.h>
#include <stdint.h>

#include "render/picture/camera.h"
#include "render/plan/plan.h"

/** What a picture shows, and its size in rays. */
struct gz_still_view {
	struct gz_camera camera;
	int width, height;
	uint64_t serial; /**< another one when anything but the gaze and the camera changes */
};

/** The state. Zero-initialised has seen no picture. */
struct gz_still {
	struct gz_still_view view;
	int pictures;                    /**< of this view in a row */
	bool keeps;                      /**< the last one took rays of earlier ones */
	bool whole;                      /**< the last one had a ray for every pixel */
	uint64_t method_rays, last_rays; /**< of the method's own plan, of the last one */
	/** The square of gz_plan_request.finer, to which rays are in proportion as long as few
	 *  pixels have one, and by how much the next picture raises it. */
	double finer2, raise;
};

/**
 * Begin a picture.
 *
 * @param growth  foveation.still_growth
 * @return gz_plan_request.finer: 1 for the first pictures of a view
 */
double gz_still_begin(struct gz_still *still, const struct gz_still_view *view, double growth);

/**
 * End a picture.
 *
 * @param plan   that it was made with
 * @param keeps  it took rays of earlier pictures
 */
void gz_still_end(struct gz_still *still, const struct gz_plan *plan, bool keeps, double growth);

/** Whether a further picture of the same view may show more. */
bool gz_still_settling(const struct gz_still *still);

#endif
