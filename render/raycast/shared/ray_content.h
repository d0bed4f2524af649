/**
 * @file
 * What decides the rays of a picture, besides its plan's tiles: whether two pictures have equal
 * rays where they have equal tiles.
 */
#ifndef GZ_RENDER_RAYCAST_SHARED_RAY_CONTENT_H
#define GZ_RENDER_RAYCAST_SHARED_RAY_CONTENT_H

#include <stdbool.h>
#include <stdint.h>

#include "render/picture/camera.h"
#include "render/plan/plan.h"
#include "render/raycast/shared/ray_params.h"

/** What the last picture showed. Zero-initialised is no picture. */
struct gz_ray_content {
	bool any;
	uint64_t serial;   /**< of it: 1 or more */
	uint64_t revision; /**< of gz_ray_content_follow() */
	struct gz_ray_frame frame;
	int shift[2]; /**< of the plan's pixels */
	int step_phase;
	bool deep; /**< rays tell depths: */
	struct gz_ray_depths depths;
	struct gz_ray_params rays;
};

/**
 * Go on to another picture.
 *
 * @param frame     the rays of the picture that the camera frames
 * @param depths    as in struct gz_shot; NULL: none
 * @param revision  another number if what no option tells of has changed and decides rays, such as
 *                  the pictures of the surroundings
 * @return a number of what is shown, 1 or more: that of the last picture if both have equal rays
 */
uint64_t gz_ray_content_follow(struct gz_ray_content *content, const struct gz_plan *plan,
			       const struct gz_ray_params *rays, const struct gz_ray_frame *frame,
			       const struct gz_ray_depths *depths, uint64_t revision);

/** The objects have changed: the next picture gets a new number. */
void gz_ray_content_forget(struct gz_ray_content *content);

#endif
