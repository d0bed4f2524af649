/*
 * Spacings and step lengths: what the eye resolves at each place, by the geometry of the display.
 *
 * Minimum angle of resolution omega(e) = m * e + omega0 in degrees per cycle (Guenter et al.,
 * "Foveated 3D Graphics", 2012, section 3); two samples a cycle, so the spacing is omega(e) / 2.
 */
#include <math.h>

#include "render/plan/plan_context.h"

static const double deg_per_rad = 57.29577951308232;
static const double fovea_deg = 2.5;      /* docs/units.md */
static const double full_scale_deg = 5.0; /* chosen: twice the fovea's radius */

static void curve_add(struct gz_plan_curve *curve, double at_deg, double value)
{
	const int i = curve->count++;
	curve->at_rad[i] = at_deg / deg_per_rad;
	curve->value[i] = value;
	curve->slope[i] = 0;
	if (i > 0)
		curve->slope[i - 1] =
			(value - curve->value[i - 1]) / (curve->at_rad[i] - curve->at_rad[i - 1]);
}

static double curve_at(const struct gz_plan_curve *curve, double rad)
{
	int i = 0;
	while (i + 1 < curve->count && rad >= curve->at_rad[i + 1])
		i++;
	return curve->value[i] + curve->slope[i] * fmax(rad - curve->at_rad[i], 0);
}

/* Two rays for a cycle of so many degrees. */
static void add_cycle(struct gz_plan_context *context, double at_deg, double cycle_deg)
{
	curve_add(&context->spacing, at_deg, cycle_deg / 2 / deg_per_rad);
}

void gz_plan_set_acuity_curve(struct gz_plan_context *context)
{
	const double foveal_deg = context->foveation->acuity_foveal_deg;
	add_cycle(context, 0, foveal_deg);
	add_cycle(context, 180, foveal_deg + 180 * context->foveation->acuity_slope);
}

void gz_plan_set_ray_curve(struct gz_plan_context *context)
{
	const struct gz_foveation *foveation = context->foveation;
	const double slope = foveation->acuity_slope, far_deg = foveation->acuity_far_deg;
	const double near = foveation->acuity_foveal_deg + far_deg * slope;
	add_cycle(context, 0, foveation->acuity_foveal_deg);
	add_cycle(context, far_deg, near);
	add_cycle(context, 180, near + (180 - far_deg) * slope * foveation->acuity_far_share);
	context->full_rad = foveation->acuity_full_deg / deg_per_rad;
}

void gz_plan_set_table_curves(struct gz_plan_context *context)
{
	const struct gz_spacing_table *table = &context->foveation->table;
	context->spacing_in_px = !table->in_deg;
	const double unit = table->in_deg ? 1 / deg_per_rad : context->rays_per_px;
	for (int i = 0; i < table->count; i++) {
		const struct gz_spacing_row *row = &table->rows[i];
		curve_add(&context->spacing, row->eccentricity_deg, row->spacing * unit);
		curve_add(&context->step, row->eccentricity_deg, row->step);
	}
}

static enum gz_plan_steps steps_of(const struct gz_foveation *foveation)
{
	switch ((enum gz_step_rule)foveation->step_rule) {
	case GZ_STEP_DISTANCE:
		return GZ_STEPS_DISTANCE;
	case GZ_STEP_ACUITY:
		return GZ_STEPS_RUNG;
	case GZ_STEP_METHOD:
		return gz_method_of(foveation)->own_steps;
	case GZ_STEP_NONE:
		break;
	}
	return GZ_STEPS_ONE;
}

bool gz_plan_steps_by_acuity(const struct gz_foveation *foveation)
{
	const enum gz_plan_steps steps = steps_of(foveation);
	return steps == GZ_STEPS_RUNG || steps == GZ_STEPS_PLACE;
}

bool gz_plan_can_grow(const struct gz_foveation *foveation)
{
	const struct gz_method *method = gz_method_of(foveation);
	const enum gz_plan_steps steps = steps_of(foveation);
	const bool finer_at_edges = (method->refines_edges && foveation->edge_contrast < 1) ||
				    (method->refines && foveation->contrast_finest < 1);
	return method->is_pyramid && steps != GZ_STEPS_DISTANCE && steps != GZ_STEPS_TABLE &&
	       !finer_at_edges;
}

static double step_growth_of(const struct gz_plan_request *request)
{
	const struct gz_foveation *foveation = request->foveation;
	if (foveation->acuity_step_error >= 1)
		return foveation->acuity_step_growth;
	return fmin(foveation->acuity_step_growth, request->step_growth);
}

/* Whether a technique that refines plans does so with this method. */
static bool refines(const struct gz_foveation *foveation)
{
	const struct gz_method *method = gz_method_of(foveation);
	return method->refines || (method->refines_edges && foveation->edge_contrast < 1);
}

/* Everything but the curves. */
static void set_geometry(const struct gz_plan_request *request, struct gz_plan_context *out_context)
{
	const struct gz_display *display = request->display;
	const int width = request->width, height = request->height;
	/* A lost gaze: the plan is made for the centre. */
	struct gz_point gaze = request->gaze;
	if (!isfinite(gaze.x) || !isfinite(gaze.y))
		gaze = (struct gz_point) { 0.5F, 0.5F };
	*out_context = (struct gz_plan_context) {
		.foveation = request->foveation,
		.width = width,
		.diagonal_px = hypot(width, height),
		.height = height,
		.rays_per_px = request->rays_per_px,
		.gaze_px = { gaze.x * (double)width - 0.5, gaze.y * (double)height - 0.5 },
		.steps = steps_of(request->foveation),
		.px_mm = { display->mm[0] / width, display->mm[1] / height },
		.centre_px = { 0.5 * width - 0.5, 0.5 * height - 0.5 },
		.distance_mm = display->distance_mm,
		.rays_per_mm = 1 / fmax(display->mm[0] / width, display->mm[1] / height),
		.scale_all = fmax(request->scale / GZ_PLAN_SCALE_OUTSIDE, 1),
		.scale_outside = fmin(request->scale, GZ_PLAN_SCALE_OUTSIDE),
		.finer = request->finer,
		.widen = request->widen,
		.steps_per_px = request->steps_per_px,
		.step_growth = step_growth_of(request),
		.round = request->refines && request->finer <= 1 && request->widen <= 0 &&
					 refines(request->foveation)
				 ? GZ_ROUND_FIRST
				 : GZ_ROUND_ONLY,
	};
	double mm[3];
	gz_display_to_mm(display, gaze, mm);
	const double length = hypot(hypot(mm[0], mm[1]), mm[2]);
	for (int axis = 0; axis < 3; axis++)
		out_context->gaze_unit[axis] = mm[axis] / length;
}

void gz_plan_context_make(const struct gz_plan_request *request,
			  struct gz_plan_context *out_context)
{
	const struct gz_method *method = gz_method_of(request->foveation);
	set_geometry(request, out_context);
	if (method->set_curves)
		method->set_curves(out_context);
	else /* the acuity step rule may be set for a method of regions */
		gz_plan_set_acuity_curve(out_context);
}

/*
 * The angle whose chord on the unit sphere is c, 2 asin(c / 2), by the first terms of its series.
 * All terms are positive, so the angle is never overstated; it falls short by less than 1e-6 at 20
 * degrees and by .3 % at 90.
 */
static double angle_of_chord(double c2)
{
	return sqrt(c2) * (1 + c2 * (1.0 / 24 + c2 * (3.0 / 640 + c2 * (5.0 / 7168))));
}

/* Factor by which a budget enlarges spacings at this eccentricity. */
static double budget_scale_at(const struct gz_plan_context *context, double eccentricity_rad)
{
	const double beyond =
		(eccentricity_rad * deg_per_rad - fovea_deg) / (full_scale_deg - fovea_deg);
	const double share = beyond < 0 ? 0 : beyond > 1 ? 1 : beyond;
	return context->scale_all * (1 + (context->scale_outside - 1) * share);
}

/* Mixes densities of rays, not spacings, so that the cost of the mixture is the mixture of the
 * costs. The more the gaze is lost, the more a spacing is rounded to the nearest rung instead of
 * down. */
static double widened(const struct gz_plan_context *context, double spacing_px)
{
	const double quarter_octave = 1.189207115002721;
	const double w = context->widen;
	const double density = (1 - w) / (spacing_px * spacing_px) +
			       w / (context->uniform_px * context->uniform_px);
	return (1 + w * (quarter_octave - 1)) / sqrt(density);
}

/* Angle between the gaze and a position, rad, and the position's distance from the eye. */
static double eccentricity_at(const struct gz_plan_context *context, double x, double y,
			      double *out_length_mm)
{
	const double *gaze = context->gaze_unit;
	const double x_mm = (x - context->centre_px[0]) * context->px_mm[0];
	const double y_mm = (y - context->centre_px[1]) * context->px_mm[1];
	const double z_mm = context->distance_mm;
	const double length = sqrt(x_mm * x_mm + y_mm * y_mm + z_mm * z_mm);
	const double cosine = (x_mm * gaze[0] + y_mm * gaze[1] + z_mm * gaze[2]) / length;
	*out_length_mm = length;
	return angle_of_chord(fmax(2 - 2 * cosine, 0));
}

/* Geisler and Perry's threshold, solved for the frequency: plan.h. rad. */
static double contrast_spacing(const struct gz_plan_context *context, double eccentricity_rad)
{
	static const double alpha = 0.106, e2_deg = 2.3;
	/* Chosen: colours are seen up to a third of luminance's frequencies (Mullen, "The contrast
	 * sensitivity of human colour vision", 1985), and half is careful. */
	static const double colour_alpha = 2 * 0.106;
	const double threshold = context->foveation->contrast_threshold;
	const double seen = fmax(log(context->contrast.luminance / threshold) / alpha,
				 log(context->contrast.colour / threshold) / colour_alpha);
	if (!(seen > 0))
		return INFINITY;
	const double away = (eccentricity_rad * deg_per_rad + e2_deg) / e2_deg;
	return away / (2 * seen) / deg_per_rad;
}

/* Spacing of further rays where the contrast is known; @p unit: of rad in px. */
static double further_spacing(const struct gz_plan_context *context, double spacing,
			      double eccentricity_rad, double unit)
{
	const struct gz_foveation *foveation = context->foveation;
	if (gz_method_of(foveation)->refines_edges)
		return context->contrast.luminance >= foveation->edge_contrast
			       ? spacing * foveation->edge_finest
			       : spacing;
	return fmax(spacing * foveation->contrast_finest,
		    contrast_spacing(context, eccentricity_rad) * unit);
}

/*
 * At the distance |p| from the eye, a length of s mm across the line of sight spans s / |p| rad.
 * Along the radius from the screen's centre a flat screen is seen at a slant and the same length
 * spans less, so the direction across needs the finer spacing.
 */
double gz_plan_spacing_at(const struct gz_plan_context *context, double x, double y)
{
	double length_mm;
	const double eccentricity = eccentricity_at(context, x, y, &length_mm);
	const double unit = context->spacing_in_px ? 1 : length_mm * context->rays_per_mm;
	double spacing = curve_at(&context->spacing, eccentricity) * unit;
	if (eccentricity < context->full_rad)
		spacing = fmin(spacing, 1);
	if (context->round == GZ_ROUND_FURTHER)
		spacing = further_spacing(context, spacing, eccentricity, unit);
	if (context->round == GZ_ROUND_FIRST && gz_method_of(context->foveation)->refines &&
	    eccentricity >= context->full_rad) {
		/* Where pixels are much coarser than the eye, every second one. */
		const double first = context->foveation->contrast_first;
		spacing = fmax(first * spacing, fmin(first, 2));
	}
	if (context->scale_all * context->scale_outside > 1)
		spacing *= budget_scale_at(context, eccentricity);
	spacing /= context->finer;
	return context->widen > 0 ? widened(context, spacing) : spacing;
}

static double table_step_at(const struct gz_plan_context *context, double x, double y)
{
	double length_mm;
	const double eccentricity = eccentricity_at(context, x, y, &length_mm);
	return curve_at(&context->step, eccentricity) * budget_scale_at(context, eccentricity);
}

double gz_acuity_spacing_px(const struct gz_foveation *foveation, const struct gz_display *display,
			    struct gz_point gaze, struct gz_point pixel, int width, int height)
{
	struct gz_plan_context context;
	const struct gz_plan_request request =
		gz_plan_request_make(foveation, display, gaze, width, height);
	set_geometry(&request, &context);
	gz_plan_set_acuity_curve(&context);
	return gz_plan_spacing_at(&context, pixel.x * (double)width - 0.5,
				  pixel.y * (double)height - 0.5);
}

double gz_plan_contrast_spacing_px(const struct gz_foveation *foveation,
				   const struct gz_display *display, double contrast,
				   struct gz_point gaze, struct gz_point pixel, int width,
				   int height)
{
	struct gz_plan_context context;
	const struct gz_plan_request request =
		gz_plan_request_make(foveation, display, gaze, width, height);
	set_geometry(&request, &context);
	context.contrast = (struct gz_plan_contrast) { .luminance = contrast };
	double length_mm;
	const double eccentricity = eccentricity_at(&context, pixel.x * (double)width - 0.5,
						    pixel.y * (double)height - 0.5, &length_mm);
	return contrast_spacing(&context, eccentricity) * length_mm * context.rays_per_mm;
}

/* Step lengths. */

/* Powers of two and the quincunx between them. */
const double gz_ladder_px[GZ_LADDER_RUNGS] = {
	1, M_SQRT2, 2, 2 * M_SQRT2, 4, 4 * M_SQRT2, 8, 8 * M_SQRT2, 16, 16 * M_SQRT2, 32,
};

int gz_ladder_rung(double spacing_px)
{
	int rung = 0;
	while (rung + 1 < GZ_LADDER_RUNGS && spacing_px >= gz_ladder_px[rung + 1])
		rung++;
	return rung;
}

/* Multipliers of the distance rule and of tables: a geometric ladder from 1 to the longest, since
 * each multiplier needs an opacity table. A tile takes the rung below its exact multiplier, so its
 * step is never longer than asked for. */
static void make_even_ladder(double top, struct gz_plan *plan)
{
	plan->step_count = top > 1 ? GZ_PLAN_STEPS_MAX : 1;
	for (int i = 0; i < plan->step_count; i++)
		plan->steps[i] = (float)pow(top, (double)i / (GZ_PLAN_STEPS_MAX - 1));
}

/* Longest steps by rung. Chosen: they grow more slowly than the spacing, since errors along a ray
 * change shapes instead of only blurring them. */
static const double longest_steps[GZ_LADDER_RUNGS] = {
	1, 1.4, 2, 2.5, 3, 3.5, 4, 5, 6, 7, 8,
};

double gz_plan_step_growth(double multiplier)
{
	const double longest = longest_steps[gz_ladder_rung(8)];
	return multiplier > 1 ? fmin(log(multiplier) / log(longest), 1) : 0;
}

/* With longer steps a ray misses most of a volume. */
static const double step_max = 16;

static void make_acuity_ladder(const struct gz_plan_context *context, struct gz_plan *plan)
{
	plan->step_count = GZ_LADDER_RUNGS;
	for (int i = 0; i < GZ_LADDER_RUNGS; i++) {
		const double most = fmax(1, context->steps_per_px * gz_ladder_px[i]);
		const double step = pow(longest_steps[i], context->step_growth);
		plan->steps[i] = (float)fmin(step, most);
	}
}

static void make_table_ladder(const struct gz_plan_context *context, struct gz_plan *plan)
{
	const struct gz_plan_curve *step = &context->step;
	const double top =
		step->value[step->count - 1] * context->scale_all * context->scale_outside;
	make_even_ladder(fmin(top, step_max), plan);
}

void gz_plan_make_steps(const struct gz_plan_context *context, struct gz_plan *plan)
{
	plan->step_count = 1;
	plan->steps[0] = 1;
	switch (context->steps) {
	case GZ_STEPS_DISTANCE:
		make_even_ladder(1 / context->foveation->step_floor, plan);
		return;
	case GZ_STEPS_RUNG:
	case GZ_STEPS_PLACE:
		make_acuity_ladder(context, plan);
		return;
	case GZ_STEPS_TABLE:
		make_table_ladder(context, plan);
		return;
	case GZ_STEPS_ONE:
		return;
	}
}

/* Index of the longest step that is at most @p step. */
static int rung_below(const struct gz_plan *plan, double step)
{
	int rung = 0;
	while (rung + 1 < plan->step_count && (double)plan->steps[rung + 1] <= step)
		rung++;
	return rung;
}

/* Bauer 2018, section 4.2.2: rate' = max(sf * rate, floor), sf = 1 - d / diagonal; unchanged within
 * 10 px of the gaze. */
static int distance_step(const struct gz_plan_context *context, const struct gz_plan *plan,
			 double d_px)
{
	enum { UNCHANGED_PX = 10 };
	if (d_px <= UNCHANGED_PX * context->rays_per_px)
		return 0;
	const double share = fmax(1 - d_px / context->diagonal_px, context->foveation->step_floor);
	return rung_below(plan, 1 / share);
}

/* Index of the step for the spacing that the eye resolves at a place in every round. */
static int place_step(const struct gz_plan_context *context, double x, double y)
{
	double length_mm;
	const double eccentricity = eccentricity_at(context, x, y, &length_mm);
	if (eccentricity < context->full_rad)
		return 0;
	const double spacing =
		curve_at(&context->spacing, eccentricity) * length_mm * context->rays_per_mm;
	return gz_ladder_rung(spacing * budget_scale_at(context, eccentricity) / context->finer);
}

int gz_plan_step_for(const struct gz_plan_context *context, const struct gz_plan *plan, int x,
		     int y, int edge)
{
	if (plan->step_count == 1)
		return 0;
	const double near_x = fmin(fmax(context->gaze_px[0], x), x + edge);
	const double near_y = fmin(fmax(context->gaze_px[1], y), y + edge);
	if (context->steps == GZ_STEPS_TABLE)
		return rung_below(plan, table_step_at(context, near_x, near_y));
	if (context->steps == GZ_STEPS_PLACE)
		return place_step(context, near_x, near_y);
	if (context->steps == GZ_STEPS_RUNG)
		return gz_ladder_rung(gz_plan_spacing_at(context, near_x, near_y));
	/* Not hypot(): it costs three times as much, and these squares cannot overflow. */
	const double x_px = near_x - context->gaze_px[0], y_px = near_y - context->gaze_px[1];
	return distance_step(context, plan, sqrt(x_px * x_px + y_px * y_px));
}
