#include "render/illustration/shading_settings.h"

#include <math.h>
#include <stddef.h>

#include "render/illustration/shading_parameters.h"
#include "render/illustration/shading_template.h"

#define AT(field) offsetof(struct gz_shading_settings, field)

const struct gz_option gz_shading_options[] = {
	{ "shading_map.light_direction", GZ_OPTION_DOUBLE, AT(light_direction), -1, 1, .count = 3,
	  .preset = "-1 1 0", .help = "towards the light: right, up, towards the viewer" },
	{ "shading_map.main_light", GZ_OPTION_DOUBLE, AT(main_light), 0, 1, .preset = "0.7",
	  .help = "weight of the main light" },
	{ "shading_map.main_light_smoothing", GZ_OPTION_INT, AT(main_light_smoothing), 0,
	  GZ_SHADING_LEVELS - 1, .preset = "0",
	  .help = "level of smoothing of the surface under the main light" },
	{ "shading_map.plateau_light", GZ_OPTION_DOUBLE, AT(plateau_light), 0, 1, .preset = "0.35",
	  .help = "weight of the light at the viewer" },
	{ "shading_map.grazing_light", GZ_OPTION_DOUBLE, AT(grazing_light), 0, 1, .preset = "0.525",
	  .help = "weight of light along the surface, which shows details" },
	{ "shading_map.exaggeration", GZ_OPTION_DOUBLE, AT(exaggeration), 0.01, 100, .preset = "1",
	  .help = "how much grazing light exaggerates details" },
	{ "shading_map.detail_frequency", GZ_OPTION_DOUBLE, AT(detail_frequency), 0, 1,
	  .preset = "0.5", .help = "details that grazing light shows: 0 wide, 1 fine" },
	{ "shading_map.surface_shape", GZ_OPTION_DOUBLE, AT(surface_shape), 0, 1, .preset = "0",
	  .help = "weight of the surface's shape: convex bright, hollow dark" },
	{ "shading_map.curvature", GZ_OPTION_DOUBLE, AT(curvature), 0, 1, .preset = "0",
	  .help = "weight of curvature: strongly bent places dark" },
	{ "shading_map.plain_light", GZ_OPTION_DOUBLE, AT(plain_light), 0, 1, .preset = "0",
	  .help = "weight of a plain lamp at the viewer's left shoulder" },
	{ "shading_map.flat", GZ_OPTION_DOUBLE, AT(flat), 0, 1, .preset = "1",
	  .help = "brightness of surfaces if all weights above are 0" },
	{ "shading_map.equalisation", GZ_OPTION_DOUBLE, AT(equalisation), 0, 1, .preset = "1",
	  .help = "how far the picture's brightnesses are spread evenly from black to white" },
	{ "shading_map.importance", GZ_OPTION_DOUBLE, AT(importance), 0, 1, .preset = "0",
	  .help = "how much unimportant objects fade" },
	{ "shading_map.viewer_distance", GZ_OPTION_DOUBLE, AT(viewer_distance), 0, 1, .preset = "0",
	  .help = "how much fades with the distance to the viewer" },
	{ "shading_map.object_distance", GZ_OPTION_DOUBLE, AT(object_distance), 0, 1, .preset = "0",
	  .help = "how much fades with the distance to a chosen object" },
	{ "shading_map.object_distance_mm", GZ_OPTION_DOUBLE, AT(object_distance_mm), 1e-3, 1e6,
	  .preset = "50", .help = "distance to the chosen object that counts as far, mm" },
	{ "shading_map.edge_light", GZ_OPTION_DOUBLE, AT(edge_light), 0,
	  GZ_TEMPLATE_EDGE_LIGHT_MOST, .preset = "0.5",
	  .help = "weight of light along the edges of near objects; more than 1 is extreme" },
	{ "shading_map.edge_light_width", GZ_OPTION_DOUBLE, AT(edge_light_width), 0, 0.02,
	  .preset = "0.005", .help = "width of edge light, share of the picture's height" },
	{ "shading_map.overlap_shadow", GZ_OPTION_DOUBLE, AT(overlap_shadow), 0, 1, .preset = "0.5",
	  .help = "weight of the shadow around near objects" },
	{ "shading_map.overlap_shadow_width", GZ_OPTION_DOUBLE, AT(overlap_shadow_width), 0, 0.02,
	  .preset = "0.015", .help = "width of that shadow, share of the picture's height" },
	{ "shading_map.haze", GZ_OPTION_DOUBLE, AT(haze), 0, 1, .preset = "0.5",
	  .help = "weight of atmospheric perspective" },
	{ "shading_map.haze_near", GZ_OPTION_DOUBLE, AT(haze_near), 0, 1, .preset = "0.3",
	  .help = "depth where it begins: 0 is the nearest point of the scene, 1 the farthest" },
	{ "shading_map.haze_far", GZ_OPTION_DOUBLE, AT(haze_far), 0, 1, .preset = "0.8",
	  .help = "depth where it is complete" },
	{ "shading_map.haze_exponent", GZ_OPTION_DOUBLE, AT(haze_exponent), 0.1, 10, .preset = "1",
	  .help = "how it grows between: above 1 late, below 1 early" },
	{ "shading_map.haze_background", GZ_OPTION_DOUBLE, AT(haze_background), 0, 1, .preset = "1",
	  .help = "brightness of what is far" },
	{ "shading_map.lines", GZ_OPTION_DOUBLE, AT(lines), 0, 1, .preset = "0.8",
	  .help = "weight of silhouettes and feature lines" },
	{ "shading_map.line_width", GZ_OPTION_INT, AT(line_width), 1, 4, .preset = "2",
	  .help = "number of the filter that finds lines: 1 is the thinnest" },
};
const size_t gz_shading_option_count = sizeof gz_shading_options / sizeof gz_shading_options[0];

#undef AT
#define AT(field) offsetof(struct gz_illustration_settings, field)

static const char *const information_names[] = { "none", "importance", "viewer-distance",
						 "object-distance", NULL };

const struct gz_option gz_illustration_options[] = {
	{ "illustration.edge_emphasis", GZ_OPTION_DOUBLE, AT(edge_emphasis), 0, 1, .preset = "0.5",
	  .help = "how much the edges of objects stand out" },
	{ "illustration.detail_amplitude", GZ_OPTION_DOUBLE, AT(detail_amplitude), 0, 1,
	  .preset = "0.5", .help = "how strong details are: 0.5 as they are, less is smoother" },
	{ "illustration.detail_frequency", GZ_OPTION_DOUBLE, AT(detail_frequency), 0, 1,
	  .preset = "0.5", .help = "which details show: 0 wide, 1 fine" },
	{ "illustration.spatial_effect", GZ_OPTION_DOUBLE, AT(spatial_effect), 0, 1,
	  .preset = "0.5", .help = "how much depth shows by light, shadow and haze" },
	{ "illustration.foreground", GZ_OPTION_DOUBLE, AT(foreground), 0, 1, .preset = "0.5",
	  .help = "how far the foreground reaches" },
	{ "illustration.scene_information", GZ_OPTION_CHOICE, AT(scene_information),
	  .choices = information_names, .preset = "none", .help = "by what objects fade" },
};
const size_t gz_illustration_option_count =
	sizeof gz_illustration_options / sizeof gz_illustration_options[0];

/* Most levels by which the main light is smoothed for little detail. Chosen: forms stay. */
#define SMOOTHING_MOST 4

static void apply_details(double amplitude, struct gz_shading_settings *settings)
{
	const double above = 2 * amplitude - 1; /* -1: smooth, 0: as it is, 1: exaggerated */
	settings->exaggeration = exp2(2 * above);
	settings->main_light_smoothing = (int)floor(SMOOTHING_MOST * fmax(-above, 0) + 0.5);
	settings->surface_shape = 0.5 * fmax(above, 0);
}

void gz_illustration_apply(const struct gz_illustration_settings *combined,
			   struct gz_shading_settings *settings)
{
	const double edges = combined->edge_emphasis;
	const int shown = combined->scene_information;
	settings->main_light = 1 - 0.6 * edges;
	settings->plateau_light = 0.7 * edges;
	settings->grazing_light = (settings->main_light + settings->plateau_light) / 2;
	settings->line_width = (int)ceil(0.5 + 3 * edges);
	apply_details(combined->detail_amplitude, settings);
	settings->detail_frequency = combined->detail_frequency;
	settings->edge_light = combined->spatial_effect;
	settings->overlap_shadow = combined->spatial_effect;
	settings->haze = combined->spatial_effect;
	settings->haze_near = GZ_HAZE_NEAR_OF_FOREGROUND * combined->foreground;
	settings->haze_exponent = 0.5 * exp2(2 * combined->foreground);
	settings->importance = shown == GZ_SHOWS_IMPORTANCE;
	settings->viewer_distance = shown == GZ_SHOWS_VIEWER_DISTANCE;
	settings->object_distance = shown == GZ_SHOWS_OBJECT_DISTANCE;
}
