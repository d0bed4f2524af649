/* Which settings have an effect, given the others. */
#include "suite.h"

#include <string.h>

#include "render/plan/method.h"
#include "render/scene/techniques.h"
#include "view/settings/scene_keys.h"
#include "view/settings/setting_label.h"

static struct gz_scene_settings settings_of(int method)
{
	static const char text[] = "[volume]\nprocedural = shells\n[transfer]\nfile = a.tf\n";
	struct gz_scene_settings settings;
	bool has_display;
	assert_int_equal(gz_scene_parse("test", text, strlen(text), NULL, &settings, &has_display),
			 GZ_OK);
	settings.foveation.method = method;
	return settings;
}

static void foveation_keys_apply_to_the_methods_that_use_them(void **state)
{
	(void)state;
	static const struct {
		const char *key;
		bool counts[GZ_METHOD_COUNT]; /* standard mdc ddc acuity mdc3 uniform table
					       contrast */
	} cases[] = {
		{ "foveation.blend_px", { 0, 1, 1, 0, 1, 0, 0, 0 } },
		{ "foveation.step_phase", { 0, 0, 0, 1, 0, 0, 1, 1 } },
		{ "foveation.reconstruction", { 0, 0, 0, 1, 0, 0, 1, 1 } },
		{ "foveation.acuity_slope", { 0, 0, 0, 1, 0, 0, 0, 1 } },
		{ "foveation.acuity_full_deg", { 0, 0, 0, 1, 0, 0, 0, 1 } },
		{ "foveation.acuity_far_share", { 0, 0, 0, 1, 0, 0, 0, 1 } },
		{ "foveation.acuity_step_growth", { 0, 0, 0, 1, 0, 0, 0, 1 } },
		{ "foveation.acuity_step_error", { 0, 0, 0, 1, 0, 0, 0, 1 } },
		{ "foveation.still_growth", { 0, 0, 0, 1, 0, 0, 1, 1 } },
		{ "foveation.edge_contrast", { 0, 0, 0, 1, 0, 0, 0, 0 } },
		{ "foveation.contrast_finest", { 0, 0, 0, 0, 0, 0, 0, 1 } },
		{ "foveation.contrast_threshold", { 0, 0, 0, 0, 0, 0, 0, 1 } },
		{ "foveation.table",
		  { 1, 1, 1, 1, 1, 1, 1, 1 } }, /* must be named before the method is used */
		{ "foveation.method", { 1, 1, 1, 1, 1, 1, 1, 1 } },
		{ "attention.dead_band_deg", { 0, 1, 1, 1, 1, 0, 1, 1 } },
		{ "attention.budget_ms", { 0, 1, 1, 1, 1, 1, 1, 1 } },
		{ "render.ray_sampling_rate", { 1, 1, 1, 1, 1, 1, 1, 1 } },
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
		for (int method = 0; method < GZ_METHOD_COUNT; method++) {
			const struct gz_scene_settings settings = settings_of(method);
			if (gz_setting_applies(&settings, cases[i].key) != cases[i].counts[method])
				fail_msg("%s with %s: counts is not %d", cases[i].key,
					 gz_method_names[method], cases[i].counts[method]);
		}
}

static void keys_behind_a_switch_apply_once_it_is_on(void **state)
{
	(void)state;
	struct gz_scene_settings settings = settings_of(GZ_METHOD_STANDARD);
	assert_true(gz_setting_applies(&settings, "camera.fov_deg"));
	assert_false(gz_setting_applies(&settings, "camera.height"));
	settings.camera.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	assert_false(gz_setting_applies(&settings, "camera.fov_deg"));
	assert_true(gz_setting_applies(&settings, "camera.height"));

	assert_true(gz_setting_applies(&settings, "clip.plane"));
	assert_false(gz_setting_applies(&settings, "clip.normal"));
	settings.rays.clip.plane = true;
	assert_true(gz_setting_applies(&settings, "clip.normal"));
	assert_true(gz_setting_applies(&settings, "clip.offset"));

	settings.rays.shading = GZ_SHADING_NONE;
	settings.rays.light.occlusion = 0;
	assert_false(gz_setting_applies(&settings, "light.ambient"));
	assert_false(gz_setting_applies(&settings, "light.occlusion_radius"));
	settings.rays.shading = GZ_SHADING_GRADIENT;
	assert_true(gz_setting_applies(&settings, "light.ambient"));
	assert_true(gz_setting_applies(&settings, "light.occlusion"));
	assert_false(gz_setting_applies(&settings, "light.occlusion_radius"));
	settings.rays.light.occlusion = 0.5;
	assert_true(gz_setting_applies(&settings, "light.occlusion_radius"));

	settings.rays.shading = GZ_SHADING_NONE;
	assert_true(gz_setting_applies(&settings, "light.shadow_steps"));
	assert_false(gz_setting_applies(&settings, "light.shadow_reach"));
	assert_false(gz_setting_applies(&settings, "light.direction"));
	settings.rays.light.shadow_steps = 8;
	assert_true(gz_setting_applies(&settings, "light.shadow_reach"));
	assert_true(gz_setting_applies(&settings, "light.direction"));
	assert_true(gz_setting_applies(&settings, "light.ambient"));
	assert_false(gz_setting_applies(&settings, "light.diffuse"));

	assert_false(gz_setting_applies(&settings, "temporal.weight"));
	settings.temporal.accumulate = true;
	assert_true(gz_setting_applies(&settings, "temporal.weight"));

	assert_false(gz_setting_applies(&settings, "foveation.step_floor"));
	settings.foveation.step_rule = GZ_STEP_DISTANCE;
	assert_true(gz_setting_applies(&settings, "foveation.step_floor"));
	assert_true(gz_setting_applies(&settings, "attention.dead_band_deg"));
	settings.foveation.step_rule = GZ_STEP_ACUITY;
	assert_true(gz_setting_applies(&settings, "foveation.acuity_slope"));
}

static void keys_of_a_technique_apply_where_it_draws(void **state)
{
	(void)state;
	struct gz_scene_settings settings = settings_of(GZ_METHOD_STANDARD);
	assert_true(gz_setting_applies(&settings, "render.technique"));
	assert_true(gz_setting_applies(&settings, "render.ray_sampling_rate"));
	assert_false(gz_setting_applies(&settings, "isosurface.isovalue"));
	settings.technique = 2;
	assert_string_equal(gz_technique_choices[settings.technique], "isosurface");
	assert_true(gz_setting_applies(&settings, "isosurface.isovalue"));
	assert_true(gz_setting_applies(&settings, "isosurface.shadows"));
	assert_false(gz_setting_applies(&settings, "isosurface.refractive_index"));
	settings.rays.surface.material = GZ_MATERIAL_GLASS;
	assert_false(gz_setting_applies(&settings, "isosurface.shadows"));
	assert_true(gz_setting_applies(&settings, "isosurface.refractive_index"));
	assert_true(gz_setting_applies(&settings, "environment.kind"));
	assert_false(gz_setting_applies(&settings, "environment.tile"));
	assert_true(gz_setting_applies(&settings, "environment.cube"));
	assert_false(gz_setting_applies(&settings, "environment.up"));
	settings.rays.environment.kind = GZ_SURROUNDINGS_CUBE;
	assert_true(gz_setting_applies(&settings, "environment.up"));
	assert_false(gz_setting_applies(&settings, "environment.horizon"));
	settings.rays.environment.kind = GZ_SURROUNDINGS_SKY;
	settings.rays.environment.floor = true;
	assert_true(gz_setting_applies(&settings, "environment.tile"));
	assert_true(gz_setting_applies(&settings, "render.background"));
	assert_true(gz_setting_applies(&settings, "light.ambient")); /* always lit */
	assert_false(gz_setting_applies(&settings, "light.occlusion"));
	assert_false(gz_setting_applies(&settings, "light.shadow_steps"));
	assert_false(gz_setting_applies(&settings, "render.ray_sampling_rate"));
	assert_false(gz_setting_applies(&settings, "render.shading"));
	assert_false(gz_setting_applies(&settings, "slices.count"));
	settings.technique = 3;
	assert_string_equal(gz_technique_choices[settings.technique], "slices");
	assert_true(gz_setting_applies(&settings, "slices.count"));
	assert_true(gz_setting_applies(&settings, "render.shading"));
	assert_true(gz_setting_applies(&settings, "render.integration"));
	assert_false(gz_setting_applies(&settings, "render.ray_sampling_rate"));
	assert_false(gz_setting_applies(&settings, "isosurface.isovalue"));
	assert_false(gz_setting_applies(&settings, "light.ambient")); /* without shading */
	settings.rays.light.shadow_steps = 4;
	assert_true(gz_setting_applies(&settings, "light.shadow_steps"));
	assert_true(gz_setting_applies(&settings, "light.ambient"));
	settings.rays.light.shadow_steps = 0;
	/* two objects of two techniques */
	settings.technique = 0;
	settings.rays.shading = GZ_SHADING_NONE;
	settings.objects.count = 2;
	settings.objects.items[1].technique = 1;
	settings.objects.items[1].visible = true;
	assert_true(gz_setting_applies(&settings, "isosurface.isovalue"));
	assert_true(gz_setting_applies(&settings, "light.ambient"));
	assert_true(gz_setting_applies(&settings, "render.shading"));
	assert_false(gz_setting_applies(&settings, "light.occlusion"));
	settings.objects.items[1].visible = false;
	assert_false(gz_setting_applies(&settings, "isosurface.isovalue"));
}

static void sections_are_named_in_words(void **state)
{
	(void)state;
	static const struct {
		const char *key, *section;
	} rows[] = { { "shading_map.haze", "Shading map" }, { "camera.eye", "Camera" } };
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		const struct gz_option option = { .key = rows[i].key };
		char section[GZ_SETTING_LABEL_SIZE];
		gz_setting_section(&option, section);
		assert_string_equal(section, rows[i].section);
	}
}

TEST_SUITE(setting_applies)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(foveation_keys_apply_to_the_methods_that_use_them),
		cmocka_unit_test(keys_behind_a_switch_apply_once_it_is_on),
		cmocka_unit_test(keys_of_a_technique_apply_where_it_draws),
		cmocka_unit_test(sections_are_named_in_words),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
