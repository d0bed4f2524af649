#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "render/scene/scene_open.h"
#include "view/files/scene_save.h"
#include "view/place.h"

#define RAMP "0 0 0 0 0\n1 1 1 1 0.5\n"

static int make_place(void **state)
{
	(void)state;
	if (create_place() != 0)
		return 1;
	return mkdir(in_place("other"), 0700);
}

static struct gz_scene load(const char *path)
{
	struct gz_scene scene;
	struct captured_log log;
	const struct gz_scene_request request = { .path = path };
	captured_log_init(&log, NULL);
	if (gz_scene_open(&request, &log.log, &scene) != GZ_OK)
		fail_msg("%s", log.last);
	return scene;
}

static void scene_names_the_file_of_its_transfer_function(void **state)
{
	(void)state;
	char file[GZ_PATH_SIZE];
	write_in_place("a.tf", RAMP);
	const char *from = write_in_place("a.scene", "[volume]\nprocedural = shells\ndims = 8 8 8\n"
						     "[transfer]\nfile = a.tf\n");
	struct gz_scene scene = load(from);
	const struct gz_scene_save save = { { &scene.settings, false, from },
					    &scene.transfer,
					    NULL };
	const char *to = in_place("other/b.scene");
	assert_false(gz_scene_save_writes_transfer(&save, to, file));
	assert_int_equal(gz_scene_save(&save, to, NULL, &scene.settings), GZ_OK);
	assert_int_equal(scene.settings.transfer_file[0], '/');
	struct gz_scene again = load(to);
	assert_int_equal(again.transfer.count, 2);
	assert_int_not_equal(access(in_place("other/b.tf"), F_OK), 0);
	gz_scene_free(&scene);
	gz_scene_free(&again);
}

static void changed_transfer_function_is_written_beside_the_scene(void **state)
{
	(void)state;
	char file[GZ_PATH_SIZE];
	write_in_place("c.tf", RAMP);
	const char *from = write_in_place("c.scene", "[volume]\nprocedural = shells\ndims = 8 8 8\n"
						     "[transfer]\nfile = c.tf\n");
	/* Of the same name as the first, so that one is not taken for the other. */
	const char *to = in_place("other/c.scene");
	struct gz_scene scene = load(from);
	scene.transfer.points[1].opacity = 0.3;
	const struct gz_scene_save save = { { &scene.settings, false, from },
					    &scene.transfer,
					    NULL };
	assert_true(gz_scene_save_writes_transfer(&save, to, file));
	assert_string_equal(file, in_place("other/c.tf"));
	assert_int_equal(gz_scene_save(&save, to, NULL, &scene.settings), GZ_OK);
	assert_string_equal(scene.settings.transfer_file, "c.tf");
	struct gz_scene again = load(to), first = load(from);
	assert_true(again.transfer.points[1].opacity == 0.3);
	assert_true(first.transfer.points[1].opacity == 0.5);
	gz_scene_free(&scene);
	gz_scene_free(&again);
	gz_scene_free(&first);
}

static void default_transfer_function_is_not_written(void **state)
{
	(void)state;
	char file[GZ_PATH_SIZE];
	const char *from =
		write_in_place("d.scene", "[volume]\nprocedural = shells\ndims = 8 8 8\n");
	struct gz_scene scene = load(from);
	struct gz_transfer made = scene.transfer;
	struct gz_scene_save save = { { &scene.settings, false, from }, &scene.transfer, &made };
	assert_false(gz_scene_save_writes_transfer(&save, from, file));
	save.made = NULL; /* of a picture, which had another once */
	assert_true(gz_scene_save_writes_transfer(&save, from, file));
	gz_scene_free(&scene);
}

static void path_gets_its_ending_and_suggestion_lies_beside_the_volume(void **state)
{
	(void)state;
	static const char *const rows[][2] = {
		{ "/a/b.nii.gz", "/a/b.scene" }, { "/a.b/c", "/a.b/c.scene" },
		{ "/a/b.scene", "/a/b.scene" },  { "", "untitled.scene" },
		{ "/a/.b.raw", "/a/.b.scene" },  { "p.png", "p.scene" },
	};
	char path[GZ_PATH_SIZE];
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		gz_scene_save_suggest(rows[i][0], path);
		assert_string_equal(path, rows[i][1]);
	}
	assert_int_equal(gz_scene_save_path("a", path), GZ_OK);
	assert_string_equal(path, "a.scene");
	assert_int_equal(gz_scene_save_path("a.SCENE", path), GZ_OK);
	assert_string_equal(path, "a.SCENE");
	char long_name[GZ_PATH_SIZE];
	memset(long_name, 'x', sizeof long_name - 1);
	long_name[sizeof long_name - 1] = '\0';
	assert_int_equal(gz_scene_save_path(long_name, path), GZ_ERR_FULL);
}

static void failed_save_leaves_the_settings(void **state)
{
	(void)state;
	const char *from =
		write_in_place("e.scene", "[volume]\nprocedural = shells\ndims = 8 8 8\n");
	struct gz_scene scene = load(from);
	const struct gz_scene_save save = { { &scene.settings, false, from },
					    &scene.transfer,
					    NULL };
	assert_int_equal(gz_scene_save(&save, "/no/such/e.scene", NULL, &scene.settings),
			 GZ_ERR_IO);
	assert_string_equal(scene.settings.transfer_file, "");
	gz_scene_free(&scene);
}

TEST_SUITE(scene_save)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(scene_names_the_file_of_its_transfer_function),
		cmocka_unit_test(changed_transfer_function_is_written_beside_the_scene),
		cmocka_unit_test(default_transfer_function_is_not_written),
		cmocka_unit_test(path_gets_its_ending_and_suggestion_lies_beside_the_volume),
		cmocka_unit_test(failed_save_leaves_the_settings),
	};
	unsetenv("GAZECAST_DATA");
	return cmocka_run_group_tests(tests, make_place, remove_place);
}
