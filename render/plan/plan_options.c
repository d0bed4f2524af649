#include "render/image.h"
#include "render/plan/plan.h"

const char *const gz_method_names[] = { "standard", "mdc",     "ddc",   "acuity",
					"mdc3",     "uniform", "table", NULL };
const char *const gz_step_rule_names[] = { "method", "none", "distance", "acuity", NULL };

const char *const gz_filter_names[] = { "catmull_rom", "bilinear", NULL };

#define AT(field) offsetof(struct gz_foveation, field)

const struct gz_option gz_foveation_options[] = {
	{ "foveation.method", GZ_OPTION_CHOICE, AT(method), .choices = gz_method_names,
	  .preset = "acuity", .help = "where rays go" },
	{ "foveation.step_rule", GZ_OPTION_CHOICE, AT(step_rule), .choices = gz_step_rule_names,
	  .preset = "method", .help = "when steps along a ray grow" },
	{ "foveation.reconstruction", GZ_OPTION_CHOICE, AT(filter), .choices = gz_filter_names,
	  .preset = "catmull_rom", .help = "acuity, table: how pixels between rays are made" },
	{ "foveation.acuity_slope", GZ_OPTION_DOUBLE, AT(acuity_slope), 0.001, 1, .preset = "0.022",
	  .help = "loss of acuity, degrees per cycle and degree of eccentricity" },
	{ "foveation.acuity_foveal_deg", GZ_OPTION_DOUBLE, AT(acuity_foveal_deg), 0.001, 1,
	  /* 1/48 */
	  .preset = "0.020833333333333332", .help = "smallest cycle seen at the gaze, degrees" },
	{ "foveation.mdc_square_px", GZ_OPTION_DOUBLE, AT(mdc_square_px), 1, GZ_IMAGE_SIDE_MAX,
	  .preset = "350", .help = "mdc, mdc3: edge of the fine square, px" },
	{ "foveation.mdc_spacing", GZ_OPTION_INT, AT(mdc_spacing), 1, GZ_SPACING_MAX, .preset = "2",
	  .help = "mdc, mdc3: spacing outside the square, px" },
	{ "foveation.mdc3_square_px", GZ_OPTION_DOUBLE, AT(mdc3_square_px), 1, GZ_IMAGE_SIDE_MAX,
	  .preset = "900",
	  .help = "mdc3: edge of the square outside which it is coarser still, px" },
	{ "foveation.mdc3_spacing", GZ_OPTION_INT, AT(mdc3_spacing), 1, GZ_SPACING_MAX,
	  .preset = "4", .help = "mdc3: spacing outside that square, px" },
	{ "foveation.ddc_inner_px", GZ_OPTION_DOUBLE, AT(ddc_inner_px), 1, GZ_IMAGE_SIDE_MAX,
	  .count = 2, .preset = "200 160", .help = "ddc: semi-axes of the inner ellipse, px" },
	{ "foveation.ddc_middle_px", GZ_OPTION_DOUBLE, AT(ddc_middle_px), 1, GZ_IMAGE_SIDE_MAX,
	  .count = 2, .preset = "480 380", .help = "ddc: semi-axes of the middle ellipse, px" },
	{ "foveation.ddc_spacing", GZ_OPTION_INT, AT(ddc_spacing), 1, GZ_SPACING_MAX, .count = 3,
	  .preset = "1 2 7", .help = "ddc: spacing of the inner, middle and outer region, px" },
	{ "foveation.blend_px", GZ_OPTION_DOUBLE, AT(blend_px), 0, 1000, .preset = "0",
	  .help = "mdc, mdc3, ddc: band in which a region fades into the next, px; 0 = hard "
		  "border" },
	{ "foveation.uniform_spacing", GZ_OPTION_INT, AT(uniform_spacing), 1, GZ_SPACING_MAX,
	  .preset = "2", .help = "uniform: spacing everywhere, px" },
	{ "foveation.step_floor", GZ_OPTION_DOUBLE, AT(step_floor), 0.0625, 1, .preset = "0.25",
	  .help = "distance rule: least share of the scene's sampling rate" },
	{ "foveation.table", GZ_OPTION_STRING, AT(table_file), .max = GZ_PATH_SIZE, .preset = "",
	  .help = "table: file of spacings and steps by eccentricity; beside the scene, else under "
		  "$GAZECAST_DATA" },
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
