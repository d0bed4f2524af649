#include "view/settings/scene_keys.h"

#include <string.h>

#include "render/illustration/technique/illustrate_technique.h"
#include "render/plan/method.h"
#include "render/raycast/raycast.h"
#include "render/slices/slices_technique.h"
#include "render/surface/isosurface_technique.h"

static const enum gz_scene_table picked[GZ_VIEW_SCENE_TABLES] = {
	GZ_SCENE_CAMERA,       GZ_SCENE_IMAGE,
	GZ_SCENE_RAYS,         GZ_SCENE_LIGHT,
	GZ_SCENE_CLIP,         GZ_SCENE_ENVIRONMENT,
	GZ_SCENE_ISOSURFACE,   GZ_SCENE_SLICES,
	GZ_SCENE_ILLUSTRATION, GZ_SCENE_ILLUSTRATION_COMBINED,
	GZ_SCENE_SHADING_MAP,  GZ_SCENE_LABELS,
	GZ_SCENE_FOVEATION,    GZ_SCENE_ATTENTION,
	GZ_SCENE_TEMPORAL,     GZ_SCENE_VIEW,
};

void gz_view_pick_scene_tables(struct gz_scene_settings *settings,
			       struct gz_view_scene_tables *out_tables)
{
	struct gz_option_binding all[GZ_SCENE_TABLE_COUNT];
	gz_scene_bind(settings, all);
	for (size_t i = 0; i < GZ_VIEW_SCENE_TABLES; i++)
		out_tables->bindings[i] = all[picked[i]];
}

void gz_view_pick_live_tables(struct gz_scene_settings *settings,
			      struct gz_view_live_tables *out_tables)
{
	struct gz_view_scene_tables scene;
	gz_view_pick_scene_tables(settings, &scene);
	memcpy(out_tables->bindings, scene.bindings, sizeof scene.bindings);
	out_tables->count = GZ_VIEW_SCENE_TABLES;
	for (size_t i = 0; i < GZ_SCENE_REGIONS_MAX; i++)
		out_tables->bindings[out_tables->count++] = gz_scene_region_bind(
			&settings->regions.items[i], i, &out_tables->regions[i]);
	for (size_t i = 0; i < settings->objects.count; i++)
		out_tables->bindings[out_tables->count++] = gz_scene_object_bind_shown(
			&settings->objects.items[i], &out_tables->objects[i]);
}

size_t gz_view_scene_key_count(const struct gz_view_scene_tables *tables)
{
	size_t count = 0;
	for (size_t i = 0; i < GZ_VIEW_SCENE_TABLES; i++)
		count += tables->bindings[i].count;
	return count;
}

typedef bool applies_function(const struct gz_scene_settings *settings);

static bool in_perspective(const struct gz_scene_settings *settings)
{
	return settings->camera.projection == GZ_PROJECTION_PERSPECTIVE;
}

static bool in_parallel(const struct gz_scene_settings *settings)
{
	return !in_perspective(settings);
}

static bool by_raycast(const struct gz_scene_settings *settings)
{
	return gz_scene_draws_by(settings, &gz_raycast_technique);
}

static bool by_slices(const struct gz_scene_settings *settings)
{
	return gz_scene_draws_by(settings, &gz_slices_technique);
}

/* Samples of a volume, coloured by its transfer function. */
static bool by_samples(const struct gz_scene_settings *settings)
{
	return by_raycast(settings) || by_slices(settings);
}

static bool by_isosurface(const struct gz_scene_settings *settings)
{
	return gz_scene_draws_by(settings, &gz_isosurface_technique);
}

static bool by_illustrate(const struct gz_scene_settings *settings)
{
	return gz_scene_draws_by(settings, &gz_illustrate_technique);
}

/* The surface of a volume, whatever it looks like. */
static bool by_surface(const struct gz_scene_settings *settings)
{
	return by_isosurface(settings) || by_illustrate(settings);
}

/* What is looked at can stand out. */
static bool with_importance(const struct gz_scene_settings *settings)
{
	return by_illustrate(settings) || by_raycast(settings);
}

static bool by_combined(const struct gz_scene_settings *settings)
{
	return by_illustrate(settings) &&
	       settings->rays.illustration.source == GZ_ILLUSTRATION_COMBINED;
}

/* What the scene's template says replaces a combined setting. */
static bool is_kept_by_template(const struct gz_scene_settings *settings, int level)
{
	return by_combined(settings) &&
	       (!settings->rays.illustration.template_name[0] || level == GZ_TEMPLATE_KEEP);
}

#define KEPT_BY_TEMPLATE(member)                                                                 \
	static bool keeps_##member(const struct gz_scene_settings *settings)                     \
	{                                                                                        \
		return is_kept_by_template(settings,                                             \
					   settings->rays.illustration.shading_template.member); \
	}
KEPT_BY_TEMPLATE(edge_emphasis)
KEPT_BY_TEMPLATE(detail_amplitude)
KEPT_BY_TEMPLATE(detail_frequency)
KEPT_BY_TEMPLATE(spatial_effect)
KEPT_BY_TEMPLATE(foreground)

static bool with_labels(const struct gz_scene_settings *settings)
{
	for (size_t i = 0; i < settings->objects.count; i++)
		if (settings->objects.items[i].labels[0])
			return true;
	return false;
}

static bool by_glass(const struct gz_scene_settings *settings)
{
	return by_isosurface(settings) && settings->rays.surface.material == GZ_MATERIAL_GLASS;
}

static bool by_matte(const struct gz_scene_settings *settings)
{
	return by_isosurface(settings) && !by_glass(settings);
}

static bool in_every_scene(const struct gz_scene_settings *settings)
{
	(void)settings;
	return true;
}

static bool under_the_sky(const struct gz_scene_settings *settings)
{
	return settings->rays.environment.kind == GZ_SURROUNDINGS_SKY;
}

static bool with_a_zenith(const struct gz_scene_settings *settings)
{
	return settings->rays.environment.kind != GZ_SURROUNDINGS_NONE;
}

static bool on_the_floor(const struct gz_scene_settings *settings)
{
	return under_the_sky(settings) && settings->rays.environment.floor;
}

/* Surfaces are always lit. */
static bool with_light(const struct gz_scene_settings *settings)
{
	return by_isosurface(settings) || settings->rays.shading == GZ_SHADING_GRADIENT;
}

static bool with_lit_samples(const struct gz_scene_settings *settings)
{
	return by_samples(settings) && settings->rays.shading == GZ_SHADING_GRADIENT;
}

static bool with_occlusion(const struct gz_scene_settings *settings)
{
	return with_lit_samples(settings) && settings->rays.light.occlusion > 0;
}

static bool with_shadows(const struct gz_scene_settings *settings)
{
	return by_samples(settings) && settings->rays.light.shadow_steps > 0;
}

/* Shadows alone know how much light is ambient and where the rest comes from. */
static bool with_a_plane(const struct gz_scene_settings *settings)
{
	return settings->rays.clip.plane;
}

static bool with_a_lamp(const struct gz_scene_settings *settings)
{
	return with_light(settings) || with_shadows(settings);
}

static bool with_borders(const struct gz_scene_settings *settings)
{
	return gz_method_of(&settings->foveation)->has_borders;
}

static bool with_a_pyramid(const struct gz_scene_settings *settings)
{
	return gz_method_of(&settings->foveation)->is_pyramid;
}

/* The acuity keys also apply if only the step lengths follow acuity. */
static bool by_acuity(const struct gz_scene_settings *settings)
{
	return gz_method_of(&settings->foveation)->own_steps == GZ_STEPS_RUNG ||
	       gz_method_of(&settings->foveation)->own_steps == GZ_STEPS_PLACE ||
	       settings->foveation.step_rule == GZ_STEP_ACUITY;
}

static bool by_contrast(const struct gz_scene_settings *settings)
{
	return gz_method_of(&settings->foveation)->refines;
}

static bool by_edges(const struct gz_scene_settings *settings)
{
	return gz_method_of(&settings->foveation)->refines_edges;
}

static bool with_longer_steps(const struct gz_scene_settings *settings)
{
	const int rule = settings->foveation.step_rule;
	return rule == GZ_STEP_METHOD
		       ? gz_method_of(&settings->foveation)->own_steps != GZ_STEPS_ONE
		       : rule != GZ_STEP_NONE;
}

static bool by_distance(const struct gz_scene_settings *settings)
{
	return settings->foveation.step_rule == GZ_STEP_DISTANCE;
}

static bool with_the_gaze(const struct gz_scene_settings *settings)
{
	return gz_foveation_follows_gaze(&settings->foveation);
}

static bool with_a_scale(const struct gz_scene_settings *settings)
{
	return gz_method_of(&settings->foveation)->can_be_coarser;
}

static bool with_the_past(const struct gz_scene_settings *settings)
{
	return settings->temporal.accumulate;
}

static bool without_the_past(const struct gz_scene_settings *settings)
{
	return !settings->temporal.accumulate;
}

/* Plans of pyramids grow while rays of earlier frames are kept. */
static bool with_kept_rays(const struct gz_scene_settings *settings)
{
	return with_a_pyramid(settings) && settings->temporal.keep_rays &&
	       without_the_past(settings);
}

static bool with_a_split(const struct gz_scene_settings *settings)
{
	return settings->view.compare == GZ_COMPARE_SPLIT;
}

static bool with_a_difference(const struct gz_scene_settings *settings)
{
	return settings->view.compare == GZ_COMPARE_DIFFERENCE;
}

/* The first row whose key begins the given one applies. */
static const struct {
	const char *key;
	applies_function *applies;
} conditions[] = {
	{ "camera.fov_deg", in_perspective },
	{ "camera.height", in_parallel },
	{ "clip.normal", with_a_plane },
	{ "clip.offset", with_a_plane },
	{ "light.occlusion_radius", with_occlusion },
	{ "light.occlusion", with_lit_samples },
	{ "light.shadow_reach", with_shadows },
	{ "light.shadow_steps", by_samples },
	{ "light.direction", with_a_lamp },
	{ "light.frame", with_a_lamp },
	{ "light.ambient", with_a_lamp },
	{ "light.", with_light },
	{ "isosurface.refractive_index", by_glass },
	{ "isosurface.bounces", by_glass },
	{ "isosurface.shadows", by_matte },
	{ "isosurface.isovalue", by_surface },
	{ "isosurface.", by_isosurface },
	{ "illustration.show", by_illustrate },
	{ "illustration.settings", by_illustrate },
	{ "illustration.chosen_object", by_illustrate },
	{ "illustration.automatic", by_combined },
	{ "illustration.edge_emphasis", keeps_edge_emphasis },
	{ "illustration.detail_amplitude", keeps_detail_amplitude },
	{ "illustration.detail_frequency", keeps_detail_frequency },
	{ "illustration.spatial_effect", keeps_spatial_effect },
	{ "illustration.foreground", keeps_foreground },
	{ "illustration.", by_combined },
	{ "shading_map.", by_illustrate },
	{ "environment.tile", on_the_floor },
	{ "environment.bright", on_the_floor },
	{ "environment.dark", on_the_floor },
	{ "environment.kind", in_every_scene },
	{ "environment.cube", in_every_scene },
	{ "environment.up", with_a_zenith },
	{ "environment.", under_the_sky },
	{ "labels.", with_labels },
	{ "slices.", by_slices },
	{ "render.ray_sampling_rate", by_raycast },
	{ "render.interpolation", by_samples },
	{ "render.integration", by_samples },
	{ "render.shading", by_samples },
	{ "render.levels", by_samples },
	{ "render.jitter", by_raycast },
	{ "render.early_termination", by_samples },
	{ "foveation.step_phase", with_longer_steps },
	{ "foveation.reconstruction", with_a_pyramid },
	{ "foveation.still_growth", with_kept_rays },
	{ "foveation.acuity_", by_acuity },
	{ "foveation.contrast_", by_contrast },
	{ "foveation.edge_", by_edges },
	{ "foveation.blend_px", with_borders },
	{ "foveation.step_floor", by_distance },
	{ "attention.budget_ms", with_a_scale },
	{ "attention.importance", with_importance },
	{ "attention.", with_the_gaze },
	{ "temporal.keep_rays", without_the_past },
	{ "temporal.weight", with_the_past },
	{ "view.compare_with", by_illustrate },
	{ "view.split", with_a_split },
	{ "view.difference_gain", with_a_difference },
};

bool gz_setting_applies(const struct gz_scene_settings *settings, const char *key)
{
	for (size_t i = 0; i < sizeof conditions / sizeof conditions[0]; i++)
		if (strncmp(key, conditions[i].key, strlen(conditions[i].key)) == 0)
			return conditions[i].applies(settings);
	return true;
}

bool gz_object_style_applies(const struct gz_scene_settings *settings,
			     const struct gz_scene_object *object)
{
	return object && gz_scene_technique(settings, object) == &gz_illustrate_technique;
}
