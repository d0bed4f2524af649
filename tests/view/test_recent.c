#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "view/files/recent.h"
#include "view/place.h"

static const char *file_of(int number)
{
	char name[32];
	snprintf(name, sizeof name, "%d.scene", number);
	return write_in_place(name, "");
}

static int make_place(void **state)
{
	(void)state;
	return create_place();
}

static void newest_path_is_first_and_listed_once(void **state)
{
	(void)state;
	struct gz_recent recent = { 0 };
	for (int i = 0; i < GZ_RECENT_MAX + 3; i++)
		gz_recent_add(&recent, file_of(i));
	assert_int_equal(recent.count, GZ_RECENT_MAX);
	assert_string_equal(recent.paths[0], file_of(GZ_RECENT_MAX + 2));
	assert_string_equal(recent.paths[GZ_RECENT_MAX - 1], file_of(3));
	gz_recent_add(&recent, file_of(5));
	assert_int_equal(recent.count, GZ_RECENT_MAX);
	assert_string_equal(recent.paths[0], file_of(5));
	assert_string_equal(recent.paths[1], file_of(GZ_RECENT_MAX + 2));
	gz_recent_add(&recent, "/no/such.scene");
	assert_string_equal(recent.paths[0], file_of(5));
}

static void list_is_written_to_a_new_folder_and_read_back(void **state)
{
	(void)state;
	struct captured_log log;
	static struct gz_recent recent, read;
	struct stat status;
	char file[GZ_PATH_SIZE];
	snprintf(file, sizeof file, "%s/state/gazecast/recent", place);
	gz_recent_read(file, &read);
	assert_int_equal(read.count, 0);
	gz_recent_add(&recent, file_of(1));
	gz_recent_add(&recent, file_of(2));
	assert_int_equal(gz_recent_write(&recent, file, NULL), GZ_OK);
	gz_recent_read(file, &read);
	assert_int_equal(read.count, 2);
	assert_string_equal(read.paths[0], file_of(2));
	*strrchr(file, '/') = '\0';
	assert_int_equal(stat(file, &status), 0);
	assert_int_equal(status.st_mode & 077, 0);
	captured_log_init(&log, NULL);
	assert_int_equal(gz_recent_write(&recent, "/proc/no/recent", &log.log), GZ_ERR_IO);
	assert_int_equal(log.messages, 1);
	assert_int_equal(log.level, GZ_LOG_INFO); /* a read-only home is no error */
	assert_non_null(strstr(log.last, "not listed as recent"));
}

static void lines_that_are_not_paths_are_skipped(void **state)
{
	(void)state;
	static struct gz_recent read;
	char path[GZ_PATH_SIZE];
	snprintf(path, sizeof path, "%s/list", place);
	FILE *file = fopen(path, "w");
	fputs("relative\n/", file);
	for (int i = 0; i < 3000; i++)
		fputc('x', file);
	fputs("\n\n/fine\n/without an end", file);
	fclose(file);
	gz_recent_read(path, &read);
	assert_int_equal(read.count, 1);
	assert_string_equal(read.paths[0], "/fine");
}

static void path_of_the_list_follows_the_environment(void **state)
{
	(void)state;
	char path[GZ_PATH_SIZE];
	setenv("HOME", "/home/someone", 1);
	setenv("XDG_STATE_HOME", "/state", 1);
	assert_int_equal(gz_recent_file(path), GZ_OK);
	assert_string_equal(path, "/state/gazecast/recent");
	setenv("XDG_STATE_HOME", "relative", 1);
	assert_int_equal(gz_recent_file(path), GZ_OK);
	assert_string_equal(path, "/home/someone/.local/state/gazecast/recent");
	unsetenv("XDG_STATE_HOME");
	unsetenv("HOME");
	assert_int_equal(gz_recent_file(path), GZ_ERR_NOT_FOUND);
}

TEST_SUITE(recent)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(newest_path_is_first_and_listed_once),
		cmocka_unit_test(list_is_written_to_a_new_folder_and_read_back),
		cmocka_unit_test(lines_that_are_not_paths_are_skipped),
		cmocka_unit_test(path_of_the_list_follows_the_environment),
	};
	return cmocka_run_group_tests(tests, make_place, remove_place);
}
