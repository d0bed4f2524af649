#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "render/scene/scene.h"
#include "render/scene/scene_files.h"
#include "render/scene/scene_write.h"
#include "scene_text.h"
#include "volume_files.h"

#define SCENE "[volume]\nprocedural = shells\n[transfer]\nfile = ramp.tf\n"

/* Every value of every table, as text: equal settings are those of equal texts. */
static void assert_same(const struct gz_scene_settings *a, const struct gz_scene_settings *b,
			const char *text)
{
	struct gz_scene_settings one = *a, other = *b;
	struct gz_option_binding left[GZ_SCENE_TABLE_COUNT], right[GZ_SCENE_TABLE_COUNT];
	gz_scene_bind(&one, left);
	gz_scene_bind(&other, right);
	for (size_t t = 0; t < GZ_SCENE_TABLE_COUNT; t++)
		for (size_t i = 0; i < left[t].count; i++) {
			char x[GZ_PATH_SIZE], y[GZ_PATH_SIZE];
			const struct gz_option *option = &left[t].options[i];
			gz_option_format(option, left[t].target, x, sizeof x);
			gz_option_format(option, right[t].target, y, sizeof y);
			if (strcmp(x, y) != 0)
				fail_msg("%s: %s became %s in\n%s", option->key, x, y, text);
		}
	assert_true(gz_scene_objects_same(&a->objects, &b->objects));
}

static void assert_prints_back(const struct gz_scene_settings *settings, bool has_display)
{
	struct gz_text text = { 0 };
	struct captured_log log;
	bool display = !has_display;
	const struct gz_scene_saved saved = { settings, has_display, "" };
	captured_log_init(&log, NULL);
	if (gz_scene_print(&saved, &log.log, &text) != GZ_OK)
		fail_msg("not printed: %s", log.last);
	struct gz_scene_settings read = scene_of_text(text.bytes, &display);
	if (!has_display) {
		assert_int_equal(read.display.px[0], 0);
		read.display = settings->display;
	}
	assert_same(settings, &read, text.bytes);
	assert_int_equal(display, has_display);
	gz_text_free(&text);
}

/* A value that is not the preset and needs all digits where it is a double. */
static void unset(const struct gz_option *option, void *target, int turn)
{
	char *field = (char *)target + option->offset;
	const int count = option->count > 0 ? option->count : 1;
	const double low = option->min > -1e3 ? option->min : -1e3;
	const double high = option->max < 1e3 ? option->max : 1e3;
	switch (option->type) {
	case GZ_OPTION_BOOL:
		*(bool *)field = !*(bool *)field;
		break;
	case GZ_OPTION_INT:
	case GZ_OPTION_SIZE:
		for (int i = 0; i < count; i++)
			((int *)field)[i] = (int)low + 3 + i;
		break;
	case GZ_OPTION_DOUBLE:
		for (int i = 0; i < count; i++)
			((double *)field)[i] =
				low + (high - low) * ((i + turn % 7 + 2.0) / (count + 11.0));
		break;
	case GZ_OPTION_STRING:
		snprintf(field, (size_t)option->max,
			 strncmp(option->key, "views.", 6) == 0
				 ? "eye 0 -2 %d look_at 0 0 0 up 0 0 1 height 2"
			 : strcmp(option->key, "view.distances") == 0 ? "0.1 0 0 1 1 1e-%d"
								      : "some file %d.x",
			 turn);
		break;
	case GZ_OPTION_CHOICE:
		*(int *)field = *(int *)field == 0 ? 1 : 0;
		break;
	}
}

/* Settings in which whatever goes together does. */
static void make_right(struct gz_scene_settings *settings, const char *changed)
{
	if (strcmp(changed, "volume.procedural") != 0 && !settings->volume_file[0])
		strcpy(settings->volume_file, "a.raw");
	const char *layout[] = { "volume.dims", "volume.type", "volume.endian", "volume.spacing",
				 "volume.channels" };
	for (size_t i = 0; i < sizeof layout / sizeof layout[0]; i++)
		if (strcmp(changed, layout[i]) == 0 && settings->dims[0] == 0)
			settings->dims[0] = settings->dims[1] = settings->dims[2] = 5;
	if (!settings->transfer_file[0])
		strcpy(settings->transfer_file, "a.tf");
	for (int i = 0; i < 3; i++)
		if (settings->rays.clip.least[i] >= settings->rays.clip.greatest[i]) {
			settings->rays.clip.least[i] = 0.1;
			settings->rays.clip.greatest[i] = 0.7;
		}
	settings->display = (struct gz_display) { .px = { 1920, 1080 },
						  .mm = { 520.3, 290.7 },
						  .distance_mm = 600.1 };
}

static void every_key_of_every_table_reads_back(void **state)
{
	(void)state;
	struct gz_scene_settings all;
	assert_int_equal(gz_scene_settings_preset(&all), GZ_OK);
	struct gz_option_binding every[GZ_SCENE_TABLE_COUNT], bindings[GZ_SCENE_TABLE_COUNT];
	gz_scene_bind(&all, every);
	int turn = 0;
	for (size_t t = 0; t < GZ_SCENE_TABLE_COUNT; t++)
		for (size_t i = 0; i < every[t].count; i++, turn++) {
			struct gz_scene_settings one;
			gz_scene_settings_preset(&one);
			gz_scene_bind(&one, bindings);
			unset(&bindings[t].options[i], bindings[t].target, turn);
			make_right(&one, bindings[t].options[i].key);
			if (strcmp(bindings[t].options[i].key, "volume.procedural") == 0)
				one.type = gz_scene_procedural_type(one.volume_procedural);
			assert_prints_back(&one, turn % 2 == 0);
			if (strcmp(bindings[t].options[i].key, "volume.procedural") != 0)
				unset(&every[t].options[i], every[t].target, turn);
		}
	make_right(&all, "");
	assert_true(turn > 60);
	assert_prints_back(&all, true);
}

static void only_values_that_differ_from_presets_are_printed(void **state)
{
	(void)state;
	bool display;
	struct gz_text text = { 0 };
	struct gz_scene_settings settings =
		scene_of_text(SCENE "[camera]\nfov_deg = 40\n", &display);
	settings.rays.ray_sampling_rate = 2;
	settings.image_sampling_rate = 0.1 + 0.2;
	const struct gz_scene_saved saved = { &settings, false, "" };
	assert_int_equal(gz_scene_print(&saved, NULL, &text), GZ_OK);
	assert_string_equal(text.bytes,
			    "[volume]\nprocedural = shells\n\n[transfer]\nfile = ramp.tf\n\n"
			    "[render]\nimage_sampling_rate = 0.30000000000000004\n"
			    "ray_sampling_rate = 2\n");
	gz_text_free(&text);
}

static void type_of_a_procedural_volume_is_kept(void **state)
{
	(void)state;
	bool display;
	struct gz_scene_settings settings = scene_of_text(
		"[volume]\nprocedural = supernova\n[transfer]\nfile = a.tf\n", &display);
	assert_int_equal(settings.type, GZ_RAW_FLOAT32);
	assert_prints_back(&settings, false);
	settings.type = GZ_RAW_UINT8;
	assert_prints_back(&settings, false);
}

static void value_outside_its_table_is_refused(void **state)
{
	(void)state;
	bool display;
	struct gz_text text = { 0 };
	struct captured_log log;
	struct gz_scene_settings settings = scene_of_text(SCENE, &display);
	const struct gz_scene_saved saved = { &settings, false, "" };
	captured_log_init(&log, NULL);
	settings.camera.fov_deg = NAN;
	assert_int_equal(gz_scene_print(&saved, &log.log, &text), GZ_ERR_INVAL);
	assert_non_null(strstr(log.last, "camera.fov_deg"));
	gz_text_free(&text);
}

static void edit(const char *before, const struct gz_scene_settings *settings, bool has_display,
		 const char *expected)
{
	struct gz_text text = { 0 };
	const struct gz_scene_saved saved = { settings, has_display, "" };
	gz_text_add(&text, "%s", before);
	assert_int_equal(gz_scene_edit(&saved, "s.scene", NULL, &text), GZ_OK);
	assert_string_equal(text.bytes, expected);
	gz_text_free(&text);
}

static void edited_scene_keeps_comments_and_lines_that_are_true(void **state)
{
	(void)state;
	bool display;
	const char before[] =
		"; my scene\n" SCENE "[camera]\n  fov_deg=3.0e1 ; narrow\nheight = 1.50\n";
	struct gz_scene_settings settings = scene_of_text(before, &display);
	edit(before, &settings, false, before);
	settings.camera.fov_deg = 40;
	settings.foveation.mdc_square_px = 400;
	edit(before, &settings, false,
	     "; my scene\n" SCENE "[camera]\n  fov_deg=40 ; narrow\nheight = 1.50\n[foveation]\n"
	     "mdc_square_px = 400\n");
}

static void edited_scene_of_another_volume_loses_keys_of_the_first(void **state)
{
	(void)state;
	bool display;
	const char before[] = "[volume]\nfile = a.raw\ndims = 2 3 4\ntype = uint16 ; as told\n"
			      "endian = big\nspacing = 1 1 2\n[transfer]\nfile = a.tf\n"
			      "[display]\npx = 100 100\nmm = 10 10\ndistance_mm = 600\n";
	struct gz_scene_settings settings = scene_of_text(before, &display);
	memset(settings.volume_file, 0, sizeof settings.volume_file);
	strcpy(settings.volume_file, "b.nii");
	settings.dims[0] = 0;
	edit(before, &settings, false,
	     "[volume]\nfile = b.nii\n[transfer]\nfile = a.tf\n[display]\n");
}

static void objects_are_printed_and_edited_under_their_names(void **state)
{
	(void)state;
	static const char before[] = "; two halves\n[object left]\nvolume = a.nii ; the data\n"
				     "visible = no\n";
	bool display;
	struct gz_scene_settings settings = scene_of_text(before, &display);
	assert_prints_back(&settings, false);
	struct gz_scene_object *object = &settings.objects.items[0];
	object->visible = true;
	object->style.importance = 1;
	edit(before, &settings, false,
	     "; two halves\n[object left]\nvolume = a.nii ; the data\nvisible = true\n"
	     "importance = 1\n");
}

static void scene_saved_over_other_objects_loses_theirs(void **state)
{
	(void)state;
	bool display;
	struct gz_scene_settings settings =
		scene_of_text("[object left]\nvolume = a.nii\n", &display);
	edit("; mine\n[object right]\nvolume = b.nii\n[camera]\nheight = 2\n", &settings, false,
	     "[object left]\nvolume = a.nii\n");
	settings = scene_of_text(SCENE, &display);
	edit("[object right]\nvolume = b.nii\n", &settings, false,
	     "[volume]\nprocedural = shells\n\n[transfer]\nfile = ramp.tf\n");
}

static void text_that_is_no_scene_is_not_edited(void **state)
{
	(void)state;
	bool display;
	struct gz_text text = { 0 };
	struct gz_scene_settings settings = scene_of_text(SCENE, &display);
	const struct gz_scene_saved saved = { &settings, false, "" };
	gz_text_add(&text, "nonsense\n");
	assert_int_equal(gz_scene_edit(&saved, "s.scene", NULL, &text), GZ_ERR_FORMAT);
	assert_string_equal(text.bytes, "nonsense\n");
	gz_text_free(&text);
}

static void make_folder(const char *name)
{
	char path[GZ_PATH_SIZE];
	snprintf(path, sizeof path, "%s", files_path(name));
	if (mkdir(path, 0700) != 0)
		fail_msg("%s: cannot be made", path);
}

static void files_of_a_scene_saved_elsewhere_are_found(void **state)
{
	(void)state;
	struct gz_scene scene;
	struct gz_text text = { 0 };
	struct captured_log log;
	make_folder("there");
	files_write("tiny.raw", "abcdefgh", 8);
	files_write("tiny.tf", "0 0 0 0 0\n1 1 1 1 1\n", 20);
	char from[GZ_PATH_SIZE], to[GZ_PATH_SIZE];
	snprintf(from, sizeof from, "%s",
		 files_write_text("tiny.scene",
				  "[volume]\nfile = tiny.raw\ndims = 2 2 2\ntype = uint8\n"
				  "[transfer]\nfile = tiny.tf\nalso = tiny.tf other.tf\n",
				  "", 0));
	snprintf(to, sizeof to, "%s", files_path("there/moved.scene"));
	captured_log_init(&log, NULL);
	assert_int_equal(gz_scene_load(from, NULL, &log.log, &scene), GZ_OK);
	const struct gz_scene_saved saved = { &scene.settings, false, from };
	assert_int_equal(gz_scene_write(&saved, to, &log.log), GZ_OK);
	gz_scene_free(&scene);
	if (gz_scene_load(to, NULL, &log.log, &scene) != GZ_OK)
		fail_msg("the saved scene is not read: %s", log.last);
	assert_int_equal(scene.volume.dims[0], 2);
	assert_true(scene.settings.volume_file[0] == '/');
	assert_non_null(strstr(scene.settings.transfer_also, "/tiny.tf other.tf"));
	gz_scene_free(&scene);
	unlink(to);
	/* Beside the first its names stay as they were. */
	const char *beside = files_path("beside.scene");
	assert_int_equal(gz_scene_load(from, NULL, &log.log, &scene), GZ_OK);
	assert_int_equal(gz_scene_write(&saved, beside, &log.log), GZ_OK);
	assert_int_equal(gz_text_add_file(&text, beside), GZ_OK);
	assert_non_null(strstr(text.bytes, "file = tiny.raw\n"));
	gz_text_free(&text);
	gz_scene_free(&scene);
	rmdir(files_path("there"));
}

static void gaze_log_of_a_saved_scene_is_found_other_sources_stay(void **state)
{
	(void)state;
	bool display;
	struct gz_scene_settings settings = scene_of_text(SCENE, &display);
	char from[GZ_PATH_SIZE], to[GZ_PATH_SIZE];
	files_write("eye.gzl", "x", 1);
	make_folder("logs");
	snprintf(from, sizeof from, "%s", files_path("a.scene"));
	snprintf(to, sizeof to, "%s", files_path("logs/a.scene"));
	strcpy(settings.view.gaze, "eye.gzl");
	assert_int_equal(gz_scene_move_files(&settings, from, to, NULL), GZ_OK);
	assert_string_equal(settings.view.gaze, files_path("eye.gzl"));
	strcpy(settings.view.gaze, "ipc:///run/eye");
	assert_int_equal(gz_scene_move_files(&settings, from, to, NULL), GZ_OK);
	assert_string_equal(settings.view.gaze, "ipc:///run/eye");
	rmdir(files_path("logs"));
}

static void file_in_a_folder_below_is_named_relative(void **state)
{
	(void)state;
	struct gz_text text = { 0 };
	bool display;
	make_folder("below");
	files_write("below/v.nii", "x", 1);
	char scene[GZ_PATH_SIZE];
	snprintf(scene, sizeof scene, "%s", files_path("below/a.scene"));
	struct gz_scene_settings settings =
		scene_of_text("[volume]\nfile = v.nii\n[transfer]\nfile = none.tf\n", &display);
	const struct gz_scene_saved saved = { &settings, false, scene };
	const char *up = files_path("up.scene");
	assert_int_equal(gz_scene_write(&saved, up, NULL), GZ_OK);
	assert_int_equal(gz_text_add_file(&text, up), GZ_OK);
	assert_string_equal(text.bytes,
			    "[volume]\nfile = below/v.nii\n\n[transfer]\nfile = none.tf\n");
	gz_text_free(&text);
	unlink(files_path("below/v.nii"));
	rmdir(files_path("below"));
}

static void name_that_a_line_cannot_hold_is_refused_and_the_file_stays(void **state)
{
	(void)state;
	bool display;
	struct captured_log log;
	struct gz_text text = { 0 };
	struct gz_scene_settings settings = scene_of_text(SCENE, &display);
	const char *path = files_write("kept.scene", SCENE, sizeof SCENE - 1);
	const struct gz_scene_saved saved = { &settings, false, "" };
	captured_log_init(&log, NULL);
	strcpy(settings.transfer_file, "a ;b.tf");
	assert_int_equal(gz_scene_write(&saved, path, &log.log), GZ_ERR_INVAL);
	assert_non_null(strstr(log.last, "transfer.file"));
	memset(settings.transfer_file, 'x', 300);
	assert_int_equal(gz_scene_write(&saved, path, &log.log), GZ_ERR_INVAL);
	assert_int_equal(gz_text_add_file(&text, path), GZ_OK);
	assert_string_equal(text.bytes, SCENE);
	gz_text_free(&text);
}

static void file_that_is_no_scene_is_replaced_whole(void **state)
{
	(void)state;
	bool display;
	struct gz_text text = { 0 };
	struct gz_scene_settings settings = scene_of_text(SCENE, &display);
	const char *path = files_write("notes.txt", "milk, bread\n", 12);
	const struct gz_scene_saved saved = { &settings, false, "" };
	assert_int_equal(gz_scene_write(&saved, path, NULL), GZ_OK);
	assert_int_equal(gz_text_add_file(&text, path), GZ_OK);
	assert_null(strstr(text.bytes, "milk"));
	gz_text_free(&text);
	assert_int_equal(gz_scene_write(&saved, "/no/such/folder/a.scene", NULL), GZ_ERR_IO);
}

TEST_SUITE(scene_write)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_key_of_every_table_reads_back),
		cmocka_unit_test(only_values_that_differ_from_presets_are_printed),
		cmocka_unit_test(type_of_a_procedural_volume_is_kept),
		cmocka_unit_test(value_outside_its_table_is_refused),
		cmocka_unit_test(edited_scene_keeps_comments_and_lines_that_are_true),
		cmocka_unit_test(edited_scene_of_another_volume_loses_keys_of_the_first),
		cmocka_unit_test(objects_are_printed_and_edited_under_their_names),
		cmocka_unit_test(scene_saved_over_other_objects_loses_theirs),
		cmocka_unit_test(text_that_is_no_scene_is_not_edited),
		cmocka_unit_test(files_of_a_scene_saved_elsewhere_are_found),
		cmocka_unit_test(gaze_log_of_a_saved_scene_is_found_other_sources_stay),
		cmocka_unit_test(file_in_a_folder_below_is_named_relative),
		cmocka_unit_test(name_that_a_line_cannot_hold_is_refused_and_the_file_stays),
		cmocka_unit_test(file_that_is_no_scene_is_replaced_whole),
	};
	unsetenv("GAZECAST_DATA");
	return cmocka_run_group_tests(tests, NULL, NULL);
}
