/*
 * The acuity method: at each eccentricity the spacing that the eye can resolve.
 *
 * Minimum angle of resolution omega(e) = m * e + omega0 in degrees per cycle (Guenter et al.,
 * "Foveated 3D Graphics", 2012, section 3); two samples a cycle, so the spacing is omega(e) / 2.
 */
#include <math.h>

#include "render/plan_emit.h"

enum { LEVELS = 5 };

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

static double nearest_to(double place, int from, int edge)
{
	return place < from ? from : place > from + edge ? from + edge : place;
}

/* The finest spacing that any pixel of a block asks for, from below: least eccentricity and least
 * distance from the eye need not belong to one pixel. */
static double block_spacing(const struct gz_plan_context *context, int x, int y, int edge)
{
	const double near_x = nearest_to(context->gaze_px[0], x, edge);
	const double near_y = nearest_to(context->gaze_px[1], y, edge);
	return gz_plan_spacing_at(context, near_x, near_y);
}

/* The rungs: lattice and pattern of each. Chosen: none between 1 and 2, where the display, not the
 * eye, is the limit and the picture shall equal the full one. */
static const struct rung {
	double spacing_px;
	uint8_t layer, pattern;
} rungs[GZ_ACUITY_RUNGS] = {
	{ 1, 0, GZ_TILE_SQUARE },
	{ 2, 1, GZ_TILE_SQUARE },
	{ 2 * M_SQRT2, 1, GZ_TILE_QUINCUNX },
	{ 4, 2, GZ_TILE_SQUARE },
	{ 4 * M_SQRT2, 2, GZ_TILE_QUINCUNX },
	{ 8, 3, GZ_TILE_SQUARE },
	{ 8 * M_SQRT2, 3, GZ_TILE_QUINCUNX },
	{ 16, 4, GZ_TILE_SQUARE },
};

int gz_acuity_rung(double spacing_px)
{
	int rung = 0;
	while (rung + 1 < GZ_ACUITY_RUNGS && spacing_px >= rungs[rung + 1].spacing_px)
		rung++;
	return rung;
}

/* Where the node at (x, y) is split into four, or cast: its lattice may be its own level's or, as
 * two quincunx tiles, that of the level below. */
static enum gz_result cast_node(const struct gz_plan_context *context, struct gz_plan *plan, int x,
				int y, int rung, int edge)
{
	/* A step of this rung's own, or one that serves whatever is cast. */
	const int step = context->step_rule == GZ_STEP_ACUITY
				 ? rung
				 : gz_plan_step_for(context, plan, x, y, edge);
	const struct gz_tile tile = {
		.x = (uint16_t)x,
		.y = (uint16_t)y,
		.layer = rungs[rung].layer,
		.step = (uint8_t)step,
		.pattern = rungs[rung].pattern,
	};
	enum gz_result result = gz_plan_add(plan, tile);
	if (result != GZ_OK || tile.pattern == GZ_TILE_SQUARE)
		return result;
	struct gz_tile lower = tile;
	lower.y = (uint16_t)(y + edge / 2);
	return gz_plan_add(plan, lower);
}

static enum gz_result subdivide(const struct gz_plan_context *context, struct gz_plan *plan, int x,
				int y, int level)
{
	const struct gz_plan_layer *coarsest = &plan->layers[LEVELS - 1];
	const int edge = GZ_TILE_EDGE << level;
	if (x > (coarsest->columns - 1) * coarsest->spacing ||
	    y > (coarsest->rows - 1) * coarsest->spacing)
		return GZ_OK; /* no lattice point of any level lies there */
	const int rung = gz_acuity_rung(block_spacing(context, x, y, edge));
	if (rungs[rung].layer >= level)
		/* A coarser rung would have been taken by the parent: this is the level's own. */
		return cast_node(context, plan, x, y, 2 * level - (level > 0), edge);
	if (rungs[rung].layer == level - 1 && rungs[rung].pattern == GZ_TILE_QUINCUNX)
		return cast_node(context, plan, x, y, rung, edge);
	const int half = edge / 2;
	for (int quarter = 0; quarter < 4; quarter++) {
		enum gz_result result = subdivide(context, plan, x + (quarter & 1) * half,
						  y + (quarter >> 1) * half, level - 1);
		if (result != GZ_OK)
			return result;
	}
	return GZ_OK;
}

enum gz_result gz_plan_acuity(const struct gz_plan_context *context, struct gz_plan *plan)
{
	plan->reconstruction = GZ_RECONSTRUCT_PYRAMID;
	plan->layer_count = LEVELS;
	plan->layers[0] = (struct gz_plan_layer) {
		.spacing = 1,
		.columns = context->width,
		.rows = context->height,
	};
	/* Each level spans the next finer one: point i of level k is point 2i of level k - 1. */
	for (int level = 1; level < LEVELS; level++)
		plan->layers[level] = (struct gz_plan_layer) {
			.spacing = 1 << level,
			.columns = plan->layers[level - 1].columns / 2 + 1,
			.rows = plan->layers[level - 1].rows / 2 + 1,
		};
	const int root = GZ_TILE_EDGE << (LEVELS - 1);
	const int right = plan->layers[LEVELS - 1].columns * GZ_SPACING_MAX;
	const int bottom = plan->layers[LEVELS - 1].rows * GZ_SPACING_MAX;
	for (int y = 0; y < bottom; y += root)
		for (int x = 0; x < right; x += root) {
			enum gz_result result = subdivide(context, plan, x, y, LEVELS - 1);
			if (result != GZ_OK)
				return result;
		}
	return GZ_OK;
}
