#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "view/files/folder.h"
#include "view/place.h"

static int make_place(void **state)
{
	(void)state;
	if (create_place() != 0)
		return 1;
	static const char *const files[] = { "b10.nii",   "b9.nii",        "a.scene",
					     "notes.txt", ".hidden.scene", "p.png" };
	for (size_t i = 0; i < sizeof files / sizeof files[0]; i++)
		write_in_place(files[i], "xyz");
	mkdir(in_place("zoo"), 0700);
	return mkfifo(in_place("fifo.raw"), 0600);
}

static struct gz_folder read_place(bool others, bool hidden)
{
	const struct gz_folder_filter filter = { others, hidden };
	struct gz_folder folder = { 0 };
	char message[128];
	if (gz_folder_read(place, &filter, &folder, message, sizeof message) != GZ_OK)
		fail_msg("%s", message);
	return folder;
}

static void assert_names(const struct gz_folder *folder, const char *expected)
{
	char names[512] = "";
	for (size_t i = 0; i < folder->count; i++)
		snprintf(names + strlen(names), sizeof names - strlen(names), "%s%s", i ? " " : "",
			 folder->entries[i].name);
	assert_string_equal(names, expected);
}

static void folders_come_first_then_openable_files_in_order(void **state)
{
	(void)state;
	struct gz_folder folder = read_place(false, false);
	assert_names(&folder, "zoo a.scene b9.nii b10.nii p.png");
	assert_true(folder.entries[0].is_folder);
	assert_int_equal(folder.entries[2].kind, GZ_FILE_VOLUME);
	assert_int_equal(folder.entries[2].bytes, 3);
	assert_int_equal(folder.others, 2);
	gz_folder_free(&folder);
	assert_null(folder.entries);
}

static void other_and_hidden_files_are_listed_on_request(void **state)
{
	(void)state;
	struct gz_folder folder = read_place(true, true);
	assert_names(&folder, "zoo .hidden.scene a.scene b9.nii b10.nii notes.txt p.png");
	gz_folder_free(&folder);
}

static void typed_text_finds_the_beginning_of_a_name_first(void **state)
{
	(void)state;
	struct gz_folder folder = read_place(false, false);
	assert_int_equal(gz_folder_find(&folder, "B1"), 3);
	assert_int_equal(gz_folder_find(&folder, "p"), 4);
	assert_int_equal(gz_folder_find(&folder, "scene"), 1);
	assert_int_equal(gz_folder_find(&folder, "nothing"), folder.count);
	assert_int_equal(gz_folder_find(&folder, ""), folder.count);
	gz_folder_free(&folder);
}

static void names_become_paths(void **state)
{
	(void)state;
	struct gz_folder folder = { .path = "/" };
	char path[GZ_PATH_SIZE], name[GZ_PATH_SIZE];
	setenv("HOME", "/home/someone", 1);
	assert_int_equal(gz_folder_path_of(&folder, "a", path), GZ_OK);
	assert_string_equal(path, "/a");
	strcpy(folder.path, "/b");
	assert_int_equal(gz_folder_path_of(&folder, "a", path), GZ_OK);
	assert_string_equal(path, "/b/a");
	assert_int_equal(gz_folder_path_of(&folder, "/c", path), GZ_OK);
	assert_string_equal(path, "/c");
	assert_int_equal(gz_folder_path_of(&folder, "~/d", path), GZ_OK);
	assert_string_equal(path, "/home/someone/d");
	memset(name, 'x', sizeof name - 1);
	name[sizeof name - 1] = '\0';
	assert_int_equal(gz_folder_path_of(&folder, name, path), GZ_ERR_FULL);
}

static void missing_folder_leaves_the_current_one(void **state)
{
	(void)state;
	const struct gz_folder_filter filter = { 0 };
	struct gz_folder folder = read_place(false, false);
	char message[128] = "";
	const size_t count = folder.count;
	assert_int_equal(
		gz_folder_read("/no/such/folder", &filter, &folder, message, sizeof message),
		GZ_ERR_IO);
	assert_string_equal(message, "/no/such/folder: No such file or directory");
	assert_int_equal(folder.count, count);
	gz_folder_free(&folder);
}

TEST_SUITE(folder)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(folders_come_first_then_openable_files_in_order),
		cmocka_unit_test(other_and_hidden_files_are_listed_on_request),
		cmocka_unit_test(typed_text_finds_the_beginning_of_a_name_first),
		cmocka_unit_test(names_become_paths),
		cmocka_unit_test(missing_folder_leaves_the_current_one),
	};
	return cmocka_run_group_tests(tests, make_place, remove_place);
}
