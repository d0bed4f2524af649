/* Settings are undone and redone, together with steps of something else. */
#include "suite.h"

#include <stdlib.h>
#include <string.h>

#include "view/settings/setting_history.h"

#define LATER_NS (2 * GZ_SETTING_HISTORY_MERGE_NS)

struct place {
	struct gz_scene_settings settings;
	struct gz_setting_history *history;
	char name[GZ_SETTING_STEP_SIZE];
	int64_t now_ns;
};

static int make_place(void **state)
{
	struct place *place = calloc(1, sizeof *place);
	static const char text[] = "[volume]\nprocedural = shells\n[transfer]\nfile = a.tf\n";
	bool has_display;
	if (!place ||
	    gz_scene_parse("test", text, strlen(text), NULL, &place->settings, &has_display) !=
		    GZ_OK ||
	    gz_setting_history_create(&place->settings, &place->history) != GZ_OK)
		return -1;
	*state = place;
	return 0;
}

static int free_place(void **state)
{
	struct place *place = *state;
	gz_setting_history_destroy(&place->history);
	free(place);
	return 0;
}

static void note(struct place *place)
{
	place->now_ns += LATER_NS;
	assert_true(gz_setting_history_note(place->history, place->now_ns));
}

static void values_go_back_and_forth_in_order(void **state)
{
	struct place *place = *state;
	double *ambient = &place->settings.rays.light.ambient;
	const double first = *ambient;
	*ambient = 0.1 + 0.2; /* not a short decimal */
	note(place);
	place->settings.view.letters = true;
	note(place);
	assert_false(gz_setting_history_note(place->history, place->now_ns));
	assert_int_equal(gz_setting_history_undo(place->history, place->name), GZ_HISTORY_SETTING);
	assert_false(place->settings.view.letters);
	assert_true(*ambient == 0.1 + 0.2);
	assert_int_equal(gz_setting_history_undo(place->history, place->name), GZ_HISTORY_SETTING);
	assert_string_equal(place->name, "Light, ambient share");
	assert_true(*ambient == first);
	assert_int_equal(gz_setting_history_undo(place->history, place->name), GZ_HISTORY_NOTHING);
	assert_int_equal(gz_setting_history_redo(place->history, place->name), GZ_HISTORY_SETTING);
	assert_true(*ambient == 0.1 + 0.2);
	/* What is done now takes the place of what was undone. */
	*ambient = 0.5;
	note(place);
	assert_false(gz_setting_history_can_redo(place->history));
	assert_false(place->settings.view.letters);
}

static void quick_changes_of_the_camera_are_one_step_and_slow_ones_are_not(void **state)
{
	struct place *place = *state;
	struct gz_camera *camera = &place->settings.camera;
	const double first = camera->eye[0];
	for (int i = 1; i <= 3; i++) {
		camera->eye[0] = first + i;
		assert_true(gz_setting_history_note(place->history, i));
	}
	camera->eye[0] = first + 10;
	note(place);
	gz_setting_history_undo(place->history, place->name);
	assert_true(camera->eye[0] == first + 3);
	gz_setting_history_undo(place->history, place->name);
	assert_true(camera->eye[0] == first);
	assert_false(gz_setting_history_can_undo(place->history));
	gz_setting_history_redo(place->history, place->name);
	assert_true(camera->eye[0] == first + 3);
}

/* A unit says nothing about what was undone. */
static void steps_are_named_without_units(void **state)
{
	struct place *place = *state;
	place->settings.rays.clip.offset = 0.25;
	note(place);
	place->settings.rays.illustration.single.detail_frequency = 0.125;
	note(place);
	gz_setting_history_undo(place->history, place->name);
	assert_string_equal(place->name, "Shading map, details");
	gz_setting_history_undo(place->history, place->name);
	assert_string_equal(place->name, "Clip, place of the plane");
}

static void foreign_steps_keep_their_place(void **state)
{
	struct place *place = *state;
	place->settings.rays.clip.least[2] = 0.25;
	note(place);
	gz_setting_history_mark(place->history);
	place->settings.rays.clip.least[2] = 0.5;
	note(place);
	assert_int_equal(gz_setting_history_undo(place->history, place->name), GZ_HISTORY_SETTING);
	assert_int_equal(gz_setting_history_undo(place->history, place->name), GZ_HISTORY_FOREIGN);
	assert_true(place->settings.rays.clip.least[2] == 0.25);
	assert_int_equal(gz_setting_history_redo(place->history, place->name), GZ_HISTORY_FOREIGN);
	gz_setting_history_unmark(place->history);
	assert_int_equal(gz_setting_history_undo(place->history, place->name), GZ_HISTORY_SETTING);
	assert_true(place->settings.rays.clip.least[2] == 0);
}

static void oldest_steps_make_room_and_adopted_changes_are_no_step(void **state)
{
	struct place *place = *state;
	for (int i = 1; i <= GZ_SETTING_HISTORY_STEPS + 7; i++) {
		place->settings.foveation.mdc_square_px = 400 + i;
		note(place);
	}
	place->settings.view.vsync = !place->settings.view.vsync;
	gz_setting_history_adopt(place->history);
	assert_false(gz_setting_history_note(place->history, place->now_ns));
	int undone = 0;
	while (gz_setting_history_undo(place->history, place->name) == GZ_HISTORY_SETTING)
		undone++;
	assert_int_equal(undone, GZ_SETTING_HISTORY_STEPS);
	assert_int_equal(place->settings.foveation.mdc_square_px, 407);
}

static void objects_and_regions_are_undone_by_their_names(void **state)
{
	struct place *place = *state;
	static const char text[] = "[object brain]\nlabels = b.nii\ntechnique = illustrate\n";
	struct gz_scene_settings *settings = &place->settings;
	bool has_display;
	assert_int_equal(gz_scene_parse("test", text, strlen(text), NULL, settings, &has_display),
			 GZ_OK);
	gz_setting_history_restart(place->history);
	struct gz_scene_object *brain = &settings->objects.items[0];
	brain->style.importance = 0.75;
	note(place);
	gz_scene_region_take(&settings->regions, brain, 37)->visible = false;
	note(place);
	gz_setting_history_undo(place->history, place->name);
	assert_string_equal(place->name, "Region 1");
	assert_null(gz_scene_region_of(&settings->regions, brain, 37));
	gz_setting_history_undo(place->history, place->name);
	assert_string_equal(place->name, "Object brain, importance");
	assert_true(brain->style.importance == 0.5);
	gz_setting_history_redo(place->history, place->name);
	gz_setting_history_redo(place->history, place->name);
	assert_false(gz_scene_region_of(&settings->regions, brain, 37)->visible);
	assert_true(gz_scene_region_of(&settings->regions, brain, 37)->style.importance == 0.75);
}

TEST_SUITE(setting_history)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(values_go_back_and_forth_in_order, make_place,
						free_place),
		cmocka_unit_test_setup_teardown(
			quick_changes_of_the_camera_are_one_step_and_slow_ones_are_not, make_place,
			free_place),
		cmocka_unit_test_setup_teardown(steps_are_named_without_units, make_place,
						free_place),
		cmocka_unit_test_setup_teardown(foreign_steps_keep_their_place, make_place,
						free_place),
		cmocka_unit_test_setup_teardown(
			oldest_steps_make_room_and_adopted_changes_are_no_step, make_place,
			free_place),
		cmocka_unit_test_setup_teardown(objects_and_regions_are_undone_by_their_names,
						make_place, free_place),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
