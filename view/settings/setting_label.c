#include "view/settings/setting_label.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

/* Names that the key alone does not give. */
static const struct {
	const char *key, *label;
} labels[] = {
	{ "camera.eye", "position" },
	{ "camera.look_at", "looks at" },
	{ "camera.up", "up direction" },
	{ "camera.fov_deg", "field of view, degrees" },
	{ "camera.height", "view height, box = 1" },
	{ "render.image_sampling_rate", "rays per pixel edge" },
	{ "render.ray_sampling_rate", "samples per voxel" },
	{ "render.levels", "coarser volume far out" },
	{ "render.jitter", "jitter seed, 0 = off" },
	{ "render.early_termination", "stop when opaque" },
	{ "light.direction", "towards the light" },
	{ "light.frame", "turns with" },
	{ "light.ambient", "ambient share" },
	{ "light.diffuse", "diffuse share" },
	{ "light.specular", "highlights" },
	{ "light.shininess", "sharpness of highlights" },
	{ "light.reflection", "mirrored share" },
	{ "light.occlusion", "occlusion share" },
	{ "light.occlusion_radius", "occlusion radius, voxels" },
	{ "light.shadow_steps", "shadow steps, 0 = off" },
	{ "light.shadow_reach", "shadow reach, voxels" },
	{ "clip.least", "box begins at, share" },
	{ "clip.greatest", "box ends at, share" },
	{ "clip.plane", "oblique plane" },
	{ "clip.normal", "plane faces" },
	{ "clip.offset", "place of the plane, share" },
	{ "environment.cube", "folder of six pictures" },
	{ "environment.up", "zenith" },
	{ "environment.horizon", "colour at the horizon" },
	{ "environment.zenith", "colour overhead" },
	{ "environment.tile", "floor tile, box = 1" },
	{ "environment.bright", "bright tiles" },
	{ "environment.dark", "dark tiles" },
	{ "isosurface.isovalue", "value of the surface" },
	{ "isosurface.bounces", "surfaces of a ray" },
	{ "slices.count", "number of slices" },
	{ "isosurface.source", "rays find it in" },
	{ "illustration.drawing", "drawn by" },
	{ "illustration.pen_width", "pen width, px" },
	{ "illustration.automatic", "follow what is seen" },
	{ "illustration.settings", "settings that count" },
	{ "illustration.foreground", "reach of the foreground" },
	{ "illustration.scene_information", "objects fade by" },
	{ "illustration.chosen_object", "distances from object" },
	{ "shading_map.light_direction", "towards the main light" },
	{ "shading_map.main_light_smoothing", "smoothed for it, level" },
	{ "shading_map.exaggeration", "details, times" },
	{ "shading_map.detail_frequency", "details: 0 wide, 1 fine" },
	{ "shading_map.flat", "brightness without light" },
	{ "shading_map.importance", "fading by importance" },
	{ "shading_map.viewer_distance", "fading with distance" },
	{ "shading_map.object_distance", "fading from the object" },
	{ "shading_map.object_distance_mm", "far from it is, mm" },
	{ "shading_map.edge_light_width", "its width, of the height" },
	{ "shading_map.overlap_shadow_width", "its width, of the height" },
	{ "shading_map.haze_near", "haze begins at depth" },
	{ "shading_map.haze_far", "haze is full at depth" },
	{ "shading_map.haze_exponent", "growth of the haze" },
	{ "shading_map.haze_background", "brightness far away" },
	{ "shading_map.line_width", "width of lines, 1 to 4" },
	{ "labels.smoothing", "smoothing steps" },
	{ "labels.reach", "smoothing reach, voxels" },
	{ "labels.names", "file of names" },
	{ "foveation.step_rule", "step length grows" },
	{ "foveation.acuity_slope", "acuity slope, deg/deg" },
	{ "foveation.acuity_foveal_deg", "finest cycle, degrees" },
	{ "foveation.acuity_full_deg", "every pixel up to, degrees" },
	{ "foveation.acuity_far_deg", "far from the gaze is, degrees" },
	{ "foveation.acuity_far_share", "share of the slope there" },
	{ "foveation.acuity_step_growth", "growth of steps" },
	{ "foveation.acuity_step_error", "change by longer steps" },
	{ "foveation.still_growth", "rays added by a frame" },
	{ "foveation.contrast_threshold", "least contrast seen" },
	{ "foveation.contrast_first", "first spacing, times" },
	{ "foveation.edge_contrast", "contrast of an edge" },
	{ "foveation.edge_finest", "finest spacing there, times" },
	{ "foveation.contrast_finest", "finest spacing, times" },
	{ "foveation.contrast_rounds", "rounds of rays" },
	{ "foveation.mdc_square_px", "fine square, px" },
	{ "foveation.mdc_spacing", "spacing outside, px" },
	{ "foveation.mdc3_square_px", "middle square, px" },
	{ "foveation.mdc3_spacing", "spacing outside it, px" },
	{ "foveation.ddc_inner_px", "inner ellipse, px" },
	{ "foveation.ddc_middle_px", "middle ellipse, px" },
	{ "foveation.ddc_spacing", "spacings, px" },
	{ "foveation.blend_px", "faded border, px" },
	{ "foveation.uniform_spacing", "spacing, px" },
	{ "foveation.step_floor", "least sampling share" },
	{ "foveation.table", "file of spacings" },
	{ "attention.dead_band_deg", "dead band, degrees" },
	{ "attention.dead_band_noise", "dead band, times noise" },
	{ "attention.saccade_scale", "coarser in saccades, times" },
	{ "attention.landing_deg", "landing from, degrees" },
	{ "attention.blink_ms", "longest blink, ms" },
	{ "attention.hold_ms", "hold a lost gaze, ms" },
	{ "attention.widen_ms", "then widen in, ms" },
	{ "attention.budget_ms", "time budget, ms; 0 = none" },
	{ "attention.importance", "importance by gaze" },
	{ "attention.importance_dwell_ms", "after a look of, ms" },
	{ "attention.importance_fade_ms", "fading in, ms" },
	{ "temporal.keep_rays", "rays of earlier frames" },
	{ "temporal.accumulate", "sharpen still pictures" },
	{ "temporal.weight", "share of earlier frames" },
	{ "view.gaze_cursor", "cross at the gaze" },
	{ "view.letters", "sides of the patient" },
	{ "view.overlay", "tint" },
	{ "view.trail", "trail of the gaze" },
	{ "view.vsync", "V-sync" },
	{ "view.gaze", "gaze from" },
	{ "view.tracker_display", "tracker's display" },
	{ "view.compare", "compare with standard" },
	{ "view.compare_with", "beside an illustration" },
	{ "view.split", "divider, share of width" },
	{ "view.difference_gain", "difference, times" },
	{ "view.gaze_mark", "circle in comparisons" },
	{ "view.refine", "refine at rest" },
	{ "view.frame_times", "plot of frame times" },
	{ "view.layout", "window shows" },
	{ "view.crosshair", "crosshair, share of the box" },
	{ "view.crosshair_follows", "crosshair follows" },
	{ "view.slice_colours", "colours in slices" },
	{ "view.slice_level", "grey level, values" },
	{ "view.slice_width", "grey width, 0 = automatic" },
	{ "view.distances", "distances, box shares" },
};

static const char *label_of(const char *key)
{
	for (size_t i = 0; i < sizeof labels / sizeof labels[0]; i++)
		if (strcmp(key, labels[i].key) == 0)
			return labels[i].label;
	return NULL;
}

/* "foveation.some_key" is "some key"; "views.3" is "view on F3". */
void gz_setting_label(const struct gz_option *option, char out_text[GZ_SETTING_LABEL_SIZE])
{
	const char *dot = strrchr(option->key, '.'), *label = label_of(option->key);
	const char *name = dot ? dot + 1 : option->key;
	if (label) {
		snprintf(out_text, GZ_SETTING_LABEL_SIZE, "%s", label);
		return;
	}
	snprintf(out_text, GZ_SETTING_LABEL_SIZE, "%s%s",
		 isdigit((unsigned char)name[0]) ? "view on F" : "", name);
	for (char *at = out_text; *at; at++)
		if (*at == '_')
			*at = ' ';
}

/* Labels have their unit after a comma, or their ends after a colon. */
void gz_setting_name(const struct gz_option *option, char out_text[GZ_SETTING_LABEL_SIZE])
{
	gz_setting_label(option, out_text);
	out_text[strcspn(out_text, ",:")] = '\0';
}

void gz_setting_section(const struct gz_option *option, char out_text[GZ_SETTING_LABEL_SIZE])
{
	snprintf(out_text, GZ_SETTING_LABEL_SIZE, "%.*s", (int)strcspn(option->key, "."),
		 option->key);
	for (char *at = out_text; *at; at++)
		*at = *at == '_' ? ' ' : *at;
	out_text[0] = (char)toupper((unsigned char)out_text[0]);
}

/* Three numbers from 0 to 1 are a colour, except for shares of the box. */
const char *gz_setting_axes(const struct gz_option *option)
{
	const bool share_of_box =
		strncmp(option->key, "clip.", 5) == 0 || strcmp(option->key, "view.crosshair") == 0;
	const bool colour = option->min == 0 && option->max == 1 && !share_of_box;
	const bool spacings = strncmp(option->key, "foveation.", 10) == 0;
	return option->count == 3 && !colour && !spacings ? "xyz" : NULL;
}
