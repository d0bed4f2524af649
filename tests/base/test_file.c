/* Paths as seen from a folder. */
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/sizes.h"

static const char *const folders[] = { "", "/a", "/a/b", "/a/bc" };
static const char *const files[] = { "/a/x", "/a/b/x", "/a/bc/x" };

static void join(const char *folder, const char *name, char out_path[static 128])
{
	snprintf(out_path, 128, "%s%s", folder, name);
}

static int make_tree(void **state)
{
	static char root[64];
	char path[128];
	snprintf(root, sizeof root, "/tmp/gazecast-test-file-XXXXXX");
	if (!mkdtemp(root))
		return 1;
	for (size_t i = 1; i < sizeof folders / sizeof folders[0]; i++) {
		join(root, folders[i], path);
		if (mkdir(path, 0700) != 0)
			return 1;
	}
	for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
		join(root, files[i], path);
		FILE *file = fopen(path, "w");
		if (!file || fclose(file) != 0)
			return 1;
	}
	*state = root;
	return 0;
}

static int remove_tree(void **state)
{
	char path[128];
	for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
		join(*state, files[i], path);
		unlink(path);
	}
	for (size_t i = sizeof folders / sizeof folders[0]; i-- > 0;) {
		join(*state, folders[i], path);
		rmdir(path);
	}
	return 0;
}

static void path_from_a_folder_is_the_shortest(void **state)
{
	static const char *const expected[4][3] = {
		{ "a/x", "a/b/x", "a/bc/x" },
		{ "x", "b/x", "bc/x" },
		{ "../x", "x", "../bc/x" },
		{ "../x", "../b/x", "x" },
	};
	for (size_t i = 0; i < 4; i++)
		for (size_t k = 0; k < 3; k++) {
			char folder[128], file[128], path[GZ_PATH_SIZE];
			join(*state, folders[i], folder);
			join(*state, files[k], file);
			assert_int_equal(gz_path_from(folder, file, path, sizeof path), GZ_OK);
			assert_string_equal(path, expected[i][k]);
		}
}

static void path_from_the_root_has_no_slash_before_it(void **state)
{
	char file[128], path[GZ_PATH_SIZE];
	join(*state, "/a/x", file);
	assert_int_equal(gz_path_from("/", file, path, sizeof path), GZ_OK);
	assert_string_equal(path, file + 1);
}

static void path_of_what_is_missing_or_too_long_is_empty(void **state)
{
	char file[128], path[4] = "???";
	join(*state, "/a/none", file);
	assert_int_equal(gz_path_from(*state, file, path, sizeof path), GZ_ERR_NOT_FOUND);
	assert_string_equal(path, "");
	join(*state, "/a/b/x", file);
	assert_int_equal(gz_path_from(*state, file, path, sizeof path), GZ_ERR_FULL);
	assert_string_equal(path, "");
}

TEST_SUITE(file)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(path_from_a_folder_is_the_shortest),
		cmocka_unit_test(path_from_the_root_has_no_slash_before_it),
		cmocka_unit_test(path_of_what_is_missing_or_too_long_is_empty),
	};
	return cmocka_run_group_tests(tests, make_tree, remove_tree);
}
