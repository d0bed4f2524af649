#include "render/picture_plan.h"

#include "render/detail.h"

struct gz_plan_request gz_picture_plan_request(const struct gz_picture_subject *subject,
					       const struct gz_foveation *foveation,
					       const struct gz_display *display,
					       struct gz_point gaze, int width, int height)
{
	struct gz_plan_request request =
		gz_plan_request_make(foveation, display, gaze, width, height);
	if (height > 0) /* gz_plan_update() refuses others */
		request.steps_per_px = gz_detail_steps_per_px(subject->volume, subject->camera,
							      subject->rays, height);
	return request;
}

enum gz_result gz_picture_plan_make(const struct gz_picture_subject *subject,
				    const struct gz_foveation *foveation,
				    const struct gz_display *display, struct gz_point gaze,
				    int width, int height, struct gz_plan *plan)
{
	const struct gz_plan_request request =
		gz_picture_plan_request(subject, foveation, display, gaze, width, height);
	return gz_plan_update(&request, plan);
}
