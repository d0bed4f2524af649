/* What every row of the table of techniques keeps. */
#include "suite.h"

#include <stdlib.h>
#include <string.h>

#include "render/raycast/raycast.h"
#include "render/raycast/shared/ray_params.h"
#include "render/scene/techniques.h"

static void every_technique_fills_its_row(void **state)
{
	(void)state;
	size_t count = 0;
	for (; gz_techniques[count]; count++) {
		const struct gz_technique *technique = gz_techniques[count];
		assert_string_equal(technique->name, gz_technique_names[count]);
		assert_non_null(technique->help);
		assert_true(technique->shows != 0 && technique->objects_max >= 1);
		assert_non_null(technique->backends[0]);
		assert_true(technique->check && technique->create && technique->bind);
	}
	assert_null(gz_technique_names[count]);
	assert_true(count >= 1);
}

static void every_technique_has_presets_and_few_tables(void **state)
{
	(void)state;
	for (size_t i = 0; gz_techniques[i]; i++) {
		const struct gz_technique *technique = gz_techniques[i];
		struct gz_option_binding bindings[GZ_TECHNIQUE_BINDINGS_MAX];
		void *settings = calloc(1, technique->settings_size);
		assert_non_null(settings);
		const size_t count = technique->bind(settings, bindings, 0);
		assert_in_range(count, 1, GZ_TECHNIQUE_BINDINGS_MAX);
		assert_int_equal(technique->bind(settings, bindings, GZ_TECHNIQUE_BINDINGS_MAX),
				 count);
		for (size_t table = 0; table < count; table++)
			assert_int_equal(gz_options_preset(&bindings[table]), GZ_OK);
		assert_true(gz_technique_settings_same(technique, settings, settings));
		free(settings);
	}
}

static void settings_are_compared_by_every_table(void **state)
{
	(void)state;
	struct gz_ray_params a, b;
	struct gz_option_binding bindings[GZ_TECHNIQUE_BINDINGS_MAX];
	memset(&a, 0, sizeof a);
	memset(&b, 0xFF, sizeof b); /* padding differs */
	struct gz_ray_params *const both[] = { &a, &b };
	size_t count = 0;
	for (int i = 0; i < 2; i++) {
		count = gz_raycast_technique.bind(both[i], bindings, GZ_TECHNIQUE_BINDINGS_MAX);
		for (size_t table = 0; table < count; table++)
			assert_int_equal(gz_options_preset(&bindings[table]), GZ_OK);
	}
	assert_true(gz_technique_settings_same(&gz_raycast_technique, &a, &b));
	b.clip.offset = 0.25; /* the last table's last option */
	assert_false(gz_technique_settings_same(&gz_raycast_technique, &a, &b));
}

TEST_SUITE(technique)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_technique_fills_its_row),
		cmocka_unit_test(every_technique_has_presets_and_few_tables),
		cmocka_unit_test(settings_are_compared_by_every_table),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
