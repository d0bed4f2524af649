#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/recorder.h"
#include "protocol/gaze.h"

static char directory[64];

static int make_directory(void **state)
{
	(void)state;
	snprintf(directory, sizeof directory, "/tmp/gz_recording_XXXXXX");
	return mkdtemp(directory) ? 0 : -1;
}

static int remove_directory(void **state)
{
	(void)state;
	return rmdir(directory);
}

static void recording_name_is_letters_digits_dot_underscore_and_dash(void **state)
{
	(void)state;
	static const char *const good[] = { "a", "A-Z_0.9", "..", "-x", "session.gzl" };
	static const char *const bad[] = { "",         "a/b",  "../x", "a b", "a\n",
					   "\xc3\xa4", "a\\b", "a:b",  "~",   "%s" };
	char name[66];
	for (size_t i = 0; i < sizeof good / sizeof *good; i++)
		assert_true(gz_recording_name_valid(good[i]));
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
		assert_false(gz_recording_name_valid(bad[i]));
	memset(name, 'x', sizeof name);
	name[64] = '\0';
	assert_true(gz_recording_name_valid(name));
	name[64] = 'x';
	name[65] = '\0';
	assert_false(gz_recording_name_valid(name));
}

static enum gz_result create(const char *name, char *path, char *message, size_t size)
{
	int fd = -1;
	enum gz_result result = gz_recording_create(directory, name, &fd, path, message, size);
	if (result == GZ_OK)
		assert_int_equal(close(fd), 0);
	return result;
}

static void recording_is_private_and_overwrites_nothing(void **state)
{
	(void)state;
	char path[GZ_PATH_SIZE], again[GZ_PATH_SIZE], expected[GZ_PATH_SIZE], message[2048];
	struct stat status;
	snprintf(expected, sizeof expected, "%s/one.gzl", directory);
	assert_int_equal(create("one", path, message, sizeof message), GZ_OK);
	assert_string_equal(path, expected);
	assert_int_equal(stat(path, &status), 0);
	assert_int_equal(status.st_mode & 0777, 0600);
	assert_int_equal(create("one", again, message, sizeof message), GZ_ERR_BUSY);
	assert_non_null(strstr(message, "exists; choose another name"));
	assert_int_equal(create("one.gzl", again, message, sizeof message), GZ_ERR_BUSY);
	unlink(path);
	/* Not even through a dangling link. */
	assert_int_equal(symlink("/tmp/gz_elsewhere", path), 0);
	assert_int_equal(create("one", again, message, sizeof message), GZ_ERR_BUSY);
	unlink(path);
}

static void recording_without_a_name_is_named_by_the_time(void **state)
{
	(void)state;
	char path[3][GZ_PATH_SIZE], message[2048];
	for (int i = 0; i < 3; i++)
		assert_int_equal(create("", path[i], message, sizeof message), GZ_OK);
	assert_non_null(strstr(path[0], "/gaze-2"));
	assert_string_not_equal(path[0], path[1]);
	assert_string_not_equal(path[1], path[2]);
	for (int i = 0; i < 3; i++)
		assert_int_equal(unlink(path[i]), 0);
}

static void recording_of_a_bad_name_or_directory_is_refused(void **state)
{
	(void)state;
	char path[GZ_PATH_SIZE], message[2048];
	int fd;
	assert_int_equal(create("../escape", path, message, sizeof message), GZ_ERR_INVAL);
	assert_non_null(strstr(message, "allowed: 1 to 64 of A-Z a-z 0-9 . _ -"));
	assert_int_equal(
		gz_recording_create("/nonexistent", "x", &fd, path, message, sizeof message),
		GZ_ERR_IO);
	assert_non_null(strstr(message, "recording.directory"));
}

TEST_SUITE(recording_name)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(recording_name_is_letters_digits_dot_underscore_and_dash),
		cmocka_unit_test(recording_is_private_and_overwrites_nothing),
		cmocka_unit_test(recording_without_a_name_is_named_by_the_time),
		cmocka_unit_test(recording_of_a_bad_name_or_directory_is_refused),
	};
	return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
