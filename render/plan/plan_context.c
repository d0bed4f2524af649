/*
 * What the eye resolves where, by the geometry of the display.
 *
 * Minimum angle of resolution omega(e) = m * e + omega0 in degrees per cycle (Guenter et al.,
 * "Foveated 3D Graphics", 2012, section 3); two samples a cycle, so the spacing is omega(e) / 2.
 */
#include <math.h>

#include "render/plan/plan_emit.h"

static const double deg_per_rad = 57.29577951308232;

struct gz_plan_context gz_plan_context_make(const struct gz_foveation *foveation,
					    const struct gz_display *display, struct gz_point gaze,
					    int width, int height)
{
	/* A gaze that is not a place counts as lost: the centre stands in. */
	if (!isfinite(gaze.x) || !isfinite(gaze.y))
		gaze = (struct gz_point) { 0.5F, 0.5F };
	struct gz_plan_context context = {
		.foveation = foveation,
		.width = width,
		.height = height,
		.gaze_px = { gaze.x * (double)width - 0.5, gaze.y * (double)height - 0.5 },
		.step_rule = (enum gz_step_rule)foveation->step_rule,
		.px_mm = { display->mm[0] / width, display->mm[1] / height },
		.centre_px = { 0.5 * width - 0.5, 0.5 * height - 0.5 },
		.distance_mm = display->distance_mm,
	};
	if (context.step_rule == GZ_STEP_METHOD)
		context.step_rule =
			foveation->method == GZ_METHOD_ACUITY ? GZ_STEP_ACUITY : GZ_STEP_NONE;
	double mm[3];
	gz_display_to_mm(display, gaze, mm);
	const double length = hypot(hypot(mm[0], mm[1]), mm[2]);
	for (int axis = 0; axis < 3; axis++)
		context.gaze_mm[axis] = mm[axis] / length;
	return context;
}

/*
 * Spacing by geometry: eccentricity e from the angle between the directions to gaze and pixel; at
 * the distance |p| from the eye, a length of s mm across the line of sight spans s / |p| rad. Along
 * the radius a flat screen is oblique and the same length spans less, so the finer of both
 * directions is the one across.
 */
double gz_plan_spacing_at(const struct gz_plan_context *context, double x, double y)
{
	const double mm[3] = {
		(x - context->centre_px[0]) * context->px_mm[0],
		(y - context->centre_px[1]) * context->px_mm[1],
		context->distance_mm,
	};
	const double length = sqrt(mm[0] * mm[0] + mm[1] * mm[1] + mm[2] * mm[2]);
	double cosine = (mm[0] * context->gaze_mm[0] + mm[1] * context->gaze_mm[1] +
			 mm[2] * context->gaze_mm[2]) /
			length;
	cosine = cosine > 1 ? 1 : cosine;
	const double eccentricity_deg = acos(cosine) * deg_per_rad;
	const double omega_deg = context->foveation->acuity_slope * eccentricity_deg +
				 context->foveation->acuity_foveal_deg;
	const double px_mm = fmax(context->px_mm[0], context->px_mm[1]);
	return omega_deg / 2 / deg_per_rad * length / px_mm;
}

double gz_acuity_spacing_px(const struct gz_foveation *foveation, const struct gz_display *display,
			    struct gz_point gaze, struct gz_point pixel, int width, int height)
{
	const struct gz_plan_context context =
		gz_plan_context_make(foveation, display, gaze, width, height);
	return gz_plan_spacing_at(&context, pixel.x * (double)width - 0.5,
				  pixel.y * (double)height - 0.5);
}
