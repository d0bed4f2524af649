/* The settings of a shading map: the six combined ones, and the templates of etc/illustration/. */
#include "suite.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "render/illustration/illustration_look.h"
#include "render/illustration/shading_settings.h"
#include "render/illustration/shading_template.h"

static void preset_single(struct gz_shading_settings *settings)
{
	const struct gz_option_binding binding = { gz_shading_options, gz_shading_option_count,
						   settings, NULL };
	assert_int_equal(gz_options_preset(&binding), GZ_OK);
}

static void preset_combined(struct gz_illustration_settings *settings)
{
	const struct gz_option_binding binding = { gz_illustration_options,
						   gz_illustration_option_count, settings, NULL };
	assert_int_equal(gz_options_preset(&binding), GZ_OK);
}

static void there_are_27_single_and_6_combined_settings(void **state)
{
	(void)state;
	assert_int_equal(gz_shading_option_count, 27);
	assert_int_equal(gz_illustration_option_count, 6);
}

static void presets_of_both_tables_agree(void **state)
{
	(void)state;
	struct gz_shading_settings single = { 0 }, applied = { 0 };
	struct gz_illustration_settings combined = { 0 };
	preset_single(&single);
	preset_single(&applied);
	preset_combined(&combined);
	gz_illustration_apply(&combined, &applied);
	for (size_t i = 0; i < gz_shading_option_count; i++) {
		const struct gz_option *option = &gz_shading_options[i];
		double numbers[2] = { 0 };
		memcpy(&numbers[0], (const char *)&single + option->offset, sizeof numbers[0]);
		memcpy(&numbers[1], (const char *)&applied + option->offset, sizeof numbers[0]);
		const bool close =
			option->type == GZ_OPTION_DOUBLE && fabs(numbers[0] - numbers[1]) < 1e-12;
		if (!close && !gz_option_same(option, &single, &applied))
			fail_msg("%s differs", option->key);
	}
}

/* Whatever the six are, the single ones stay within their ranges. */
static void combined_settings_stay_within_the_ranges(void **state)
{
	(void)state;
	for (int i = 0; i < 1 << 5; i++)
		for (int shown = 0; shown < 4; shown++) {
			struct gz_shading_settings single = { 0 };
			const struct gz_illustration_settings combined = { i & 1,      i >> 1 & 1,
									   i >> 2 & 1, i >> 3 & 1,
									   i >> 4 & 1, shown };
			preset_single(&single);
			gz_illustration_apply(&combined, &single);
			assert_true(gz_options_hold(gz_shading_options, gz_shading_option_count,
						    &single));
			assert_true(single.importance + single.viewer_distance +
					    single.object_distance ==
				    (shown > 0));
		}
}

/* Section 3.3.2: in which direction each of the six moves the others. */
static void combined_settings_go_where_the_thesis_says(void **state)
{
	(void)state;
	struct gz_shading_settings low = { 0 }, middle = { 0 }, high = { 0 };
	struct gz_illustration_settings least = { 0, 0, 0, 0, 0, 0 }, most = { 1, 1, 1, 1, 1, 0 };
	struct gz_illustration_settings between = { 0.5, 0.5, 0.5, 0.5, 0.5, 0 };
	gz_illustration_apply(&least, &low);
	gz_illustration_apply(&between, &middle);
	gz_illustration_apply(&most, &high);
	assert_true(low.main_light > high.main_light && low.plateau_light < high.plateau_light);
	assert_true(middle.plateau_light <= middle.main_light / 2 + 1e-12);
	assert_int_equal(low.line_width, 1);
	assert_int_equal(high.line_width, 4);
	assert_true(fabs(2 * high.grazing_light - high.main_light - high.plateau_light) < 1e-12);
	assert_true(low.exaggeration < middle.exaggeration &&
		    middle.exaggeration < high.exaggeration);
	assert_true(low.main_light_smoothing > 0 && middle.main_light_smoothing == 0 &&
		    high.main_light_smoothing == 0);
	assert_true(low.surface_shape == 0 && middle.surface_shape == 0 && high.surface_shape > 0);
	assert_true(low.haze == 0 && low.edge_light == 0 && low.overlap_shadow == 0);
	assert_true(high.haze == 1 && high.edge_light == 1 && high.overlap_shadow == 1);
	/* A smaller foreground: a lower least depth and a lower exponent. */
	assert_true(low.haze_near < high.haze_near && low.haze_exponent < high.haze_exponent);
}

/* ---- templates ---- */

/* Table 3.1: edge emphasis, detail amplitude, spatial effect, foreground; a blank depends on the
 * model or does not matter. */
static const struct {
	const char *name, *levels;
} thesis_templates[] = {
	{ "whole-scene", "0 ++" },  { "vessels", "+-- " },         { "vessel-trees", "+-+-" },
	{ "single-bones", "+-- " }, { "bone-structures", "--+0" }, { "organs", "- - " },
	{ "information", "0-- " },  { "highlight", "    " },
};

static void check_level(char level, double value)
{
	const double kept = 0.123; /* what was there before */
	assert_true(value == (level == '-' ? 0 : level == '0' ? 0.5 : level == '+' ? 1 : kept));
}

static void templates_are_those_of_the_thesis(void **state)
{
	(void)state;
	const size_t count = sizeof thesis_templates / sizeof thesis_templates[0];
	for (size_t i = 0; i < count; i++) {
		char path[512];
		struct gz_shading_template read;
		struct gz_illustration_settings combined = { 0.123, 0.123, 0.123, 0.123, 0.123, 2 };
		const char *levels = thesis_templates[i].levels;
		snprintf(path, sizeof path, TEMPLATES "/%s.template", thesis_templates[i].name);
		assert_int_equal(gz_shading_template_read(path, NULL, &read), GZ_OK);
		assert_true(read.title[0] != '\0');
		gz_shading_template_apply(&read, &combined);
		check_level(levels[0], combined.edge_emphasis);
		check_level(levels[1], combined.detail_amplitude);
		check_level(' ', combined.detail_frequency);
		check_level(levels[2], combined.spatial_effect);
		check_level(levels[3], combined.foreground);
		assert_int_equal(combined.scene_information, 2);
	}
	size_t files = 0;
	DIR *folder = opendir(TEMPLATES);
	assert_non_null(folder);
	for (struct dirent *entry; (entry = readdir(folder));)
		files += gz_path_ends(entry->d_name, ".template");
	closedir(folder);
	assert_int_equal(files, count);
}

/* Figure 3.20: a template of few settings, which replaces only those. */
static void template_sets_edge_light_of_an_object_alone(void **state)
{
	(void)state;
	struct gz_illustration_look look = { .source = GZ_ILLUSTRATION_COMBINED };
	struct gz_option_binding bindings[GZ_ILLUSTRATION_BINDINGS];
	struct gz_shading_template highlight;
	struct gz_shading_settings without, with;
	gz_illustration_look_bind(&look, bindings);
	for (int i = 0; i < GZ_ILLUSTRATION_BINDINGS; i++)
		assert_int_equal(gz_options_preset(&bindings[i]), GZ_OK);
	look.combined.spatial_effect = 0.25;
	assert_int_equal(gz_shading_template_named("highlight", &highlight), GZ_OK);
	gz_illustration_look_resolve(&look, NULL, &without);
	gz_illustration_look_resolve(&look, &highlight, &with);
	assert_true(without.edge_light == 0.25 && with.edge_light == GZ_TEMPLATE_EDGE_LIGHT_MOST);
	with.edge_light = without.edge_light;
	assert_true(gz_options_same(gz_shading_options, gz_shading_option_count, &with, &without));
	/* as the template of the scene, which an object's replaces */
	strcpy(look.template_name, "highlight");
	look.shading_template = highlight;
	gz_illustration_look_resolve(&look, NULL, &with);
	assert_true(with.edge_light == GZ_TEMPLATE_EDGE_LIGHT_MOST);
	highlight.edge_light = GZ_TEMPLATE_SMALL;
	gz_illustration_look_resolve(&look, &highlight, &with);
	assert_true(with.edge_light == 0);
	/* single settings and parameters that are shown alone stay as they are */
	look.source = GZ_ILLUSTRATION_SINGLE;
	gz_illustration_look_resolve(&look, &highlight, &with);
	assert_true(with.edge_light == look.single.edge_light);
}

static char last_line[1024];

static void keep_line(void *user, enum gz_log_level level, const char *module, const char *message)
{
	(void)user;
	(void)level;
	(void)module;
	snprintf(last_line, sizeof last_line, "%s", message);
}

static void unknown_keys_and_values_are_refused_with_their_line(void **state)
{
	(void)state;
	static const struct {
		const char *text, *says;
	} faults[] = {
		{ "[template]\ntitle = x\nedge_emphasiss = +\n", "x.template:3: " },
		{ "[template]\nedge_emphasis = ++\n", "x.template:2: " },
		{ "\n[scene]\nedge_emphasis = +\n", "x.template:3: " },
		{ "[template]\nforeground = 0\nforeground = 0\n", "x.template:3: " },
	};
	struct gz_log log;
	gz_log_init(&log, keep_line, NULL, NULL);
	for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++) {
		struct gz_shading_template read = { .title = "kept" };
		assert_int_equal(gz_shading_template_parse("x.template", faults[i].text,
							   strlen(faults[i].text), &log, &read),
				 GZ_ERR_FORMAT);
		if (strncmp(last_line, faults[i].says, strlen(faults[i].says)) != 0)
			fail_msg("%zu: %s", i, last_line);
		assert_string_equal(read.title, "kept");
	}
	struct gz_shading_template read;
	assert_int_equal(gz_shading_template_read(TEMPLATES "/none.template", NULL, &read),
			 GZ_ERR_NOT_FOUND);
}

TEST_SUITE(shading_settings)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(there_are_27_single_and_6_combined_settings),
		cmocka_unit_test(presets_of_both_tables_agree),
		cmocka_unit_test(combined_settings_stay_within_the_ranges),
		cmocka_unit_test(combined_settings_go_where_the_thesis_says),
		cmocka_unit_test(templates_are_those_of_the_thesis),
		cmocka_unit_test(template_sets_edge_light_of_an_object_alone),
		cmocka_unit_test(unknown_keys_and_values_are_refused_with_their_line),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
