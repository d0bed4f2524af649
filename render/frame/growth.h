/**
 * @file
 * How much finer plans become while nothing but the gaze changes (foveation.still_growth). Rays of
 * earlier pictures are kept then, so a picture has time for more: each adds a share of the method's
 * rays, until every pixel has one. Pure steps over a state, by pictures and not by time.
 */
#ifndef GZ_RENDER_FRAME_GROWTH_H
#define GZ_RENDER_FRAME_GROWTH_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol/display.h"
#include "render/picture/camera.h"
#include "render/plan/plan.h"

/** What a picture shows. */
struct gz_growth_view {
	struct gz_camera camera;
	struct gz_display display;
	int width, height; /**< of the picture, in rays */
	uint64_t serial;   /**< another one when settings or data change */
};

/** The state. Zero-initialised has seen no picture. */
struct gz_growth {
	struct gz_growth_view view;
	int pictures;                    /**< of this view in a row */
	bool keeps;                      /**< rays of the last one can be taken by the next */
	bool whole;                      /**< the last one had a ray for every pixel */
	uint64_t method_rays, last_rays; /**< of the method's own plan, of the last one */
	/** The square of gz_plan_request.finer, to which rays are in proportion as long as few
	 *  pixels have one, and by how much it rises with the next picture. */
	double finer_squared, rise;
};

/**
 * Begin a picture.
 *
 * @return gz_plan_request.finer: 1 for the first two pictures of a view
 */
double gz_growth_begin(struct gz_growth *growth, const struct gz_growth_view *view);

/** What came of a picture. */
struct gz_growth_picture {
	const struct gz_plan *plan; /**< that it was made with */
	bool keeps;                 /**< tiles of it are kept for the next one */
	bool refines;               /**< the method's own plan is made in rounds */
	double share;               /**< foveation.still_growth */
};

/** End a picture that was made. If making one fails, the next one begins as that did. */
void gz_growth_end(struct gz_growth *growth, const struct gz_growth_picture *picture);

/** Whether a further picture of the same view may show more. */
bool gz_growth_settling(const struct gz_growth *growth);

#endif
