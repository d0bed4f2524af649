/* The pixels that a method promises to show as they are. */
#include "bench/stability/stability_bench.h"

#include <math.h>

/* With the distance rule steps are as they are within 10 px (Bauer 2018, 3.2.3). */
#define DISTANCE_RULE_PX 10

/* cos 2.5 degrees */
#define FOVEA_COSINE 0.99904822158185778

/* Looked at millions of times a row: no arc cosine. */
static bool near_gaze(const struct gz_display *display, const double gaze_mm[3], struct gz_point at)
{
	double at_mm[3], dot = 0, gaze_square = 0, at_square = 0;
	gz_display_to_mm(display, at, at_mm);
	for (int axis = 0; axis < 3; axis++) {
		dot += gaze_mm[axis] * at_mm[axis];
		gaze_square += gaze_mm[axis] * gaze_mm[axis];
		at_square += at_mm[axis] * at_mm[axis];
	}
	return dot >= FOVEA_COSINE * sqrt(gaze_square * at_square);
}

static bool foveal(const struct gz_foveation *foveation, const struct gz_stability_view *view,
		   struct gz_point gaze, const double gaze_mm[3], int x, int y)
{
	const struct gz_point at = { (float)((x + 0.5) / view->width),
				     (float)((y + 0.5) / view->height) };
	if (!near_gaze(&view->display, gaze_mm, at))
		return false;
	const double across_px = x + 0.5 - (double)gaze.x * view->width;
	const double down_px = y + 0.5 - (double)gaze.y * view->height;
	if (foveation->step_rule == GZ_STEP_DISTANCE &&
	    !(hypot(across_px, down_px) < DISTANCE_RULE_PX))
		return false;
	return gz_acuity_spacing_px(foveation, &view->display, gaze, at, view->width,
				    view->height) < 2;
}

void gz_stability_mark_fovea(const struct gz_foveation *foveation,
			     const struct gz_stability_view *view, struct gz_point gaze, bool keep,
			     uint8_t *marks)
{
	double gaze_mm[3];
	gz_display_to_mm(&view->display, gaze, gaze_mm);
	for (int y = 0; y < view->height; y++)
		for (int x = 0; x < view->width; x++, marks++)
			*marks = (!keep || *marks) && foveal(foveation, view, gaze, gaze_mm, x, y);
}
