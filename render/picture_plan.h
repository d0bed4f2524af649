/**
 * @file
 * Plans for pictures of a volume: what the gaze asks for, bounded by what the volume shows. Whoever
 * plans a frame begins here, so that what is measured is what is seen.
 */
#ifndef GZ_RENDER_PICTURE_PLAN_H
#define GZ_RENDER_PICTURE_PLAN_H

#include "base/result.h"
#include "render/camera.h"
#include "render/plan/plan.h"
#include "render/ray_params.h"
#include "render/volume/volume.h"

/** What a picture shows, as far as its plan depends on it. Borrowed. */
struct gz_picture_subject {
	const struct gz_volume *volume;
	const struct gz_camera *camera;
	const struct gz_ray_params *rays;
};

/** gz_plan_request_make() with steps bounded by gz_detail_steps_per_px(). Borrows @p foveation and
 *  @p display; keeps nothing of @p subject. */
struct gz_plan_request gz_picture_plan_request(const struct gz_picture_subject *subject,
					       const struct gz_foveation *foveation,
					       const struct gz_display *display,
					       struct gz_point gaze, int width, int height);

/** gz_plan_update() of gz_picture_plan_request(). */
enum gz_result gz_picture_plan_make(const struct gz_picture_subject *subject,
				    const struct gz_foveation *foveation,
				    const struct gz_display *display, struct gz_point gaze,
				    int width, int height, struct gz_plan *plan);

#endif
