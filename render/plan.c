#include "render/plan.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/image.h"
#include "render/plan_emit.h"

const char *const gz_method_names[] = { "standard", "mdc", "ddc", "acuity", NULL };
const char *const gz_step_rule_names[] = { "method", "none", "distance", "acuity", NULL };

#define AT(field) offsetof(struct gz_foveation, field)

const struct gz_option gz_foveation_options[] = {
	{ "foveation.method", GZ_OPTION_CHOICE, AT(method), .choices = gz_method_names,
	  .preset = "acuity", .help = "where rays go" },
	{ "foveation.step_rule", GZ_OPTION_CHOICE, AT(step_rule), .choices = gz_step_rule_names,
	  .preset = "method", .help = "when steps along a ray grow" },
	{ "foveation.acuity_slope", GZ_OPTION_DOUBLE, AT(acuity_slope), 0.001, 1, .preset = "0.022",
	  .help = "loss of acuity, degrees per cycle and degree of eccentricity" },
	{ "foveation.acuity_foveal_deg", GZ_OPTION_DOUBLE, AT(acuity_foveal_deg), 0.001, 1,
	  /* 1/48 */
	  .preset = "0.020833333333333332", .help = "smallest cycle seen at the gaze, degrees" },
	{ "foveation.mdc_square_px", GZ_OPTION_DOUBLE, AT(mdc_square_px), 1, GZ_IMAGE_SIDE_MAX,
	  .preset = "350", .help = "mdc: edge of the fine square, px" },
	{ "foveation.mdc_spacing", GZ_OPTION_INT, AT(mdc_spacing), 1, GZ_SPACING_MAX, .preset = "2",
	  .help = "mdc: spacing outside the square, px" },
	{ "foveation.ddc_inner_px", GZ_OPTION_DOUBLE, AT(ddc_inner_px), 1, GZ_IMAGE_SIDE_MAX,
	  .count = 2, .preset = "200 160", .help = "ddc: semi-axes of the inner ellipse, px" },
	{ "foveation.ddc_middle_px", GZ_OPTION_DOUBLE, AT(ddc_middle_px), 1, GZ_IMAGE_SIDE_MAX,
	  .count = 2, .preset = "480 380", .help = "ddc: semi-axes of the middle ellipse, px" },
	{ "foveation.ddc_spacing", GZ_OPTION_INT, AT(ddc_spacing), 1, GZ_SPACING_MAX, .count = 3,
	  .preset = "1 2 7", .help = "ddc: spacing of the inner, middle and outer region, px" },
	{ "foveation.step_floor", GZ_OPTION_DOUBLE, AT(step_floor), 0.0625, 1, .preset = "0.25",
	  .help = "distance rule: least share of the scene's sampling rate" },
};
const size_t gz_foveation_option_count =
	sizeof gz_foveation_options / sizeof gz_foveation_options[0];

struct gz_foveation gz_foveation_default(void)
{
	struct gz_foveation foveation = { 0 };
	const struct gz_option_binding binding = {
		.options = gz_foveation_options,
		.count = gz_foveation_option_count,
		.target = &foveation,
	};
	gz_options_preset(&binding);
	return foveation;
}

const uint8_t gz_tile_columns[GZ_TILE_PATTERN_COUNT][GZ_TILE_EDGE * GZ_TILE_EDGE] = {
	[GZ_TILE_SQUARE] = { 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3 },
	[GZ_TILE_QUINCUNX] = { 0, 2, 4, 6, 1, 3, 5, 7, 0, 2, 4, 6, 1, 3, 5, 7 },
};
const uint8_t gz_tile_rows[GZ_TILE_EDGE * GZ_TILE_EDGE] = {
	0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3,
};

enum gz_result gz_plan_add(struct gz_plan *plan, struct gz_tile tile)
{
	if (plan->tile_count == plan->tile_capacity) {
		size_t capacity = plan->tile_capacity ? 2 * plan->tile_capacity : 4096;
		struct gz_tile *tiles = realloc(plan->tiles, capacity * sizeof *tiles);
		if (!tiles)
			return GZ_ERR_NO_MEM;
		plan->tiles = tiles;
		plan->tile_capacity = capacity;
	}
	plan->tiles[plan->tile_count++] = tile;
	return GZ_OK;
}

struct gz_plan_layer gz_plan_layer_make(int width, int height, int spacing, struct gz_region region)
{
	return (struct gz_plan_layer) {
		.spacing = spacing,
		.columns = (width - 1 + spacing - 1) / spacing + 1,
		.rows = (height - 1 + spacing - 1) / spacing + 1,
		.region = region,
	};
}

/* Multipliers of the distance rule: a geometric ladder from 1 to 1 / floor, so that one opacity
 * table a rung serves all tiles. A tile takes the rung below its exact multiplier: never coarser
 * than asked. */
static void make_distance_ladder(const struct gz_foveation *foveation, struct gz_plan *plan)
{
	const double top = 1 / foveation->step_floor;
	plan->step_count = top > 1 ? GZ_PLAN_STEPS_MAX : 1;
	for (int i = 0; i < plan->step_count; i++)
		plan->steps[i] = (float)pow(top, (double)i / (GZ_PLAN_STEPS_MAX - 1));
}

/* Steps by rung: docs/foveation.md. Chosen: a step may grow more slowly than the spacing, since
 * errors along a ray show as shape, not only as blur. */
static const float acuity_steps[GZ_ACUITY_RUNGS] = { 1, 1.5F, 1.75F, 2, 2.5F, 3, 3.5F, 4 };

static void make_acuity_ladder(struct gz_plan *plan)
{
	plan->step_count = GZ_ACUITY_RUNGS;
	memcpy(plan->steps, acuity_steps, sizeof acuity_steps);
}

static void make_ladder(const struct gz_plan_context *context, struct gz_plan *plan)
{
	switch (context->step_rule) {
	case GZ_STEP_DISTANCE:
		make_distance_ladder(context->foveation, plan);
		return;
	case GZ_STEP_ACUITY:
		make_acuity_ladder(plan);
		return;
	default:
		plan->step_count = 1;
		plan->steps[0] = 1;
		return;
	}
}

static double clamp(double x, double low, double high)
{
	return x < low ? low : x > high ? high : x;
}

/* Bauer 2018, section 4.2.2: rate' = max(sf * rate, floor), sf = 1 - d / diagonal; unchanged within
 * 10 px of the gaze. */
static int distance_step(const struct gz_plan_context *context, const struct gz_plan *plan,
			 double d_px)
{
	enum { UNCHANGED_PX = 10 };
	if (d_px <= UNCHANGED_PX)
		return 0;
	const double diagonal = hypot(context->width, context->height);
	const double share = fmax(1 - d_px / diagonal, context->foveation->step_floor);
	int step = 0;
	while (step + 1 < plan->step_count && plan->steps[step + 1] <= 1 / share)
		step++;
	return step;
}

int gz_plan_step_for(const struct gz_plan_context *context, const struct gz_plan *plan, int x,
		     int y, int edge)
{
	if (plan->step_count == 1)
		return 0;
	const double near_x = clamp(context->gaze_px[0], x, x + edge);
	const double near_y = clamp(context->gaze_px[1], y, y + edge);
	if (context->step_rule == GZ_STEP_ACUITY)
		return gz_acuity_rung(gz_plan_spacing_at(context, near_x, near_y));
	return distance_step(context, plan,
			     hypot(near_x - context->gaze_px[0], near_y - context->gaze_px[1]));
}

/* Whether a pixel position lies on the lattice of a layer or, in a pyramid, of a coarser one. */
static bool on_lattice(const struct gz_plan *plan, int layer, int x, int y)
{
	const int last =
		plan->reconstruction == GZ_RECONSTRUCT_PYRAMID ? plan->layer_count - 1 : layer;
	for (int i = layer; i <= last; i++) {
		const struct gz_plan_layer *lattice = &plan->layers[i];
		const int spacing = lattice->spacing;
		if (x % spacing == 0 && y % spacing == 0 && x / spacing < lattice->columns &&
		    y / spacing < lattice->rows)
			return true;
	}
	return false;
}

uint32_t gz_plan_tile_active(const struct gz_plan *plan, const struct gz_tile *tile)
{
	const struct gz_plan_layer *layer = &plan->layers[tile->layer];
	const uint8_t *columns = gz_tile_columns[tile->pattern];
	const int last = GZ_TILE_EDGE * GZ_TILE_EDGE - 1;
	if (tile->x + columns[last] * layer->spacing <= (layer->columns - 1) * layer->spacing &&
	    tile->y + gz_tile_rows[last] * layer->spacing <= (layer->rows - 1) * layer->spacing)
		return 0xFFFF; /* all of it inside: nearly always */
	uint32_t active = 0;
	for (int i = 0; i <= last; i++)
		if (on_lattice(plan, tile->layer, tile->x + columns[i] * layer->spacing,
			       tile->y + gz_tile_rows[i] * layer->spacing))
			active |= 1U << i;
	return active;
}

static void count_rays(struct gz_plan *plan)
{
	plan->ray_count = 0;
	for (size_t i = 0; i < plan->tile_count; i++)
		plan->ray_count +=
			(uint64_t)__builtin_popcount(gz_plan_tile_active(plan, &plan->tiles[i]));
}

static bool parameters_valid(const struct gz_foveation *f)
{
	char text[256];
	for (size_t i = 0; i < gz_foveation_option_count; i++) {
		struct gz_foveation copy;
		/* The table is the one place that knows the ranges. */
		if (gz_option_format(&gz_foveation_options[i], f, text, sizeof text) != GZ_OK ||
		    gz_option_parse(&gz_foveation_options[i], text, &copy, NULL, 0) != GZ_OK)
			return false;
	}
	return true;
}

enum gz_result gz_plan_make(const struct gz_foveation *foveation, const struct gz_display *display,
			    struct gz_point gaze, int width, int height, struct gz_plan *plan)
{
	if (width < 1 || height < 1 || width > GZ_IMAGE_SIDE_MAX || height > GZ_IMAGE_SIDE_MAX)
		return GZ_ERR_INVAL;
	if (!gz_display_valid(display) || !parameters_valid(foveation))
		return GZ_ERR_INVAL;

	const struct gz_plan_context context =
		gz_plan_context_make(foveation, display, gaze, width, height);
	plan->width = width;
	plan->height = height;
	plan->tile_count = 0;
	plan->layer_count = 0;
	make_ladder(&context, plan);

	enum gz_result result = GZ_ERR_INVAL;
	switch ((enum gz_method)foveation->method) {
	case GZ_METHOD_STANDARD:
		result = gz_plan_standard(&context, plan);
		break;
	case GZ_METHOD_MDC:
		result = gz_plan_mdc(&context, plan);
		break;
	case GZ_METHOD_DDC:
		result = gz_plan_ddc(&context, plan);
		break;
	case GZ_METHOD_ACUITY:
		result = gz_plan_acuity(&context, plan);
		break;
	case GZ_METHOD_COUNT:
		break;
	}
	if (result == GZ_OK)
		count_rays(plan);
	return result;
}

void gz_plan_free(struct gz_plan *plan)
{
	free(plan->tiles);
	*plan = (struct gz_plan) { 0 };
}
