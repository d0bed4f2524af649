#include "suite.h"

#include "protocol/endpoint.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/captured_log.h"

struct folder {
	char path[64];   /* an empty folder for the test */
	char inside[96]; /* a path in it that does not exist */
	struct captured_log captured;
};

static int make_folder(void **state)
{
	struct folder *folder = calloc(1, sizeof *folder);
	assert_non_null(folder);
	snprintf(folder->path, sizeof folder->path, "/tmp/gz-endpoint-XXXXXX");
	assert_non_null(mkdtemp(folder->path));
	snprintf(folder->inside, sizeof folder->inside, "%s/gazecast", folder->path);
	captured_log_init(&folder->captured, "*:debug");
	*state = folder;
	return 0;
}

static int remove_folder(void **state)
{
	struct folder *folder = *state;
	remove(folder->inside);
	remove(folder->path);
	free(folder);
	return 0;
}

static void check_directory(const char *expected)
{
	char path[GZ_ENDPOINT_SIZE];
	assert_int_equal(gz_runtime_directory(path, sizeof path), GZ_OK);
	assert_string_equal(path, expected);
}

static void directory_own_variable_comes_first(void **state)
{
	(void)state;
	setenv("XDG_RUNTIME_DIR", "/run/user/1000", 1);
	setenv("GAZECAST_RUNTIME_DIR", "/somewhere/else", 1);
	check_directory("/somewhere/else");
	setenv("GAZECAST_RUNTIME_DIR", "", 1);
	check_directory("/run/user/1000/gazecast");
	unsetenv("GAZECAST_RUNTIME_DIR");
	check_directory("/run/user/1000/gazecast");
}

static void directory_without_session_is_the_systems_or_in_tmp(void **state)
{
	(void)state;
	unsetenv("GAZECAST_RUNTIME_DIR");
	char in_tmp[64];
	snprintf(in_tmp, sizeof in_tmp, "/tmp/gazecast-%ld", (long)getuid());
	struct stat status;
	const char *expected = stat("/run/gazecast", &status) == 0 ? "/run/gazecast" : in_tmp;
	const char *const useless[] = { NULL, "", "relative/path" };
	for (size_t i = 0; i < sizeof useless / sizeof *useless; i++) {
		if (useless[i])
			setenv("XDG_RUNTIME_DIR", useless[i], 1);
		else
			unsetenv("XDG_RUNTIME_DIR");
		check_directory(expected);
	}
}

static void directory_too_long_for_the_buffer_is_refused(void **state)
{
	(void)state;
	char path[6];
	setenv("GAZECAST_RUNTIME_DIR", "/12345", 1);
	assert_int_equal(gz_runtime_directory(path, sizeof path), GZ_ERR_FULL);
	setenv("GAZECAST_RUNTIME_DIR", "/1234", 1);
	assert_int_equal(gz_runtime_directory(path, sizeof path), GZ_OK);
	unsetenv("GAZECAST_RUNTIME_DIR");
}

static void prepare_makes_a_directory_for_us_alone(void **state)
{
	struct folder *folder = *state;
	struct stat status;
	for (int times = 0; times < 2; times++) {
		assert_int_equal(
			gz_runtime_directory_prepare(folder->inside, &folder->captured.log), GZ_OK);
		assert_int_equal(stat(folder->inside, &status), 0);
		assert_int_equal(status.st_mode & 07777, 0700);
	}
	assert_int_equal(folder->captured.messages, 0);
}

static void check_refused(struct folder *folder, enum gz_result expected, const char *remedy)
{
	assert_int_equal(gz_runtime_directory_prepare(folder->inside, &folder->captured.log),
			 expected);
	assert_int_equal(folder->captured.messages, 1);
	assert_non_null(strstr(folder->captured.last, folder->inside));
	if (!strstr(folder->captured.last, remedy))
		fail_msg("\"%s\" does not say \"%s\"", folder->captured.last, remedy);
}

static void prepare_open_directory_is_refused_with_chmod(void **state)
{
	struct folder *folder = *state;
	assert_int_equal(mkdir(folder->inside, 0700), 0);
	assert_int_equal(chmod(folder->inside, 0705), 0);
	check_refused(folder, GZ_ERR_ACCESS, "chmod 700");
}

static void prepare_link_is_refused(void **state)
{
	struct folder *folder = *state;
	assert_int_equal(symlink("/tmp", folder->inside), 0);
	check_refused(folder, GZ_ERR_ACCESS, "not a directory");
}

static void prepare_file_is_refused(void **state)
{
	struct folder *folder = *state;
	FILE *file = fopen(folder->inside, "w");
	assert_non_null(file);
	fclose(file);
	check_refused(folder, GZ_ERR_ACCESS, "not a directory");
}

static void prepare_without_parent_fails(void **state)
{
	struct folder *folder = *state;
	snprintf(folder->inside, sizeof folder->inside, "%s/absent/gazecast", folder->path);
	check_refused(folder, GZ_ERR_IO, "GAZECAST_RUNTIME_DIR");
}

static void prepare_anothers_directory_is_refused(void **state)
{
	struct folder *folder = *state;
	if (geteuid() != 0)
		skip(); /* only root can change the owner of a directory */
	assert_int_equal(mkdir(folder->inside, 0700), 0);
	assert_int_equal(chown(folder->inside, 12345, 12345), 0);
	check_refused(folder, GZ_ERR_ACCESS, "12345");
}

static void endpoint_is_directory_and_name(void **state)
{
	(void)state;
	char text[GZ_ENDPOINT_SIZE];
	assert_int_equal(gz_endpoint_ipc("/run/gazecast", "stream", text, sizeof text), GZ_OK);
	assert_string_equal(text, "ipc:///run/gazecast/stream");
}

static void endpoint_longer_than_a_socket_path_is_refused(void **state)
{
	(void)state;
	char directory[128], text[GZ_ENDPOINT_SIZE];
	memset(directory, 'd', sizeof directory);
	directory[0] = '/';
	directory[107 - strlen("/latest")] = '\0';
	assert_int_equal(gz_endpoint_ipc(directory, "latest", text, sizeof text), GZ_OK);
	assert_int_equal(strlen(text), strlen("ipc://") + 107);
	assert_int_equal(gz_endpoint_ipc(directory, "latest1", text, sizeof text), GZ_ERR_FULL);
	assert_int_equal(gz_endpoint_ipc("/a", "b", text, strlen("ipc:///a/b")), GZ_ERR_FULL);
}

/* Bind a socket @p name in @p directory. */
static void make_socket(const char *directory, const char *name)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	snprintf(address.sun_path, sizeof address.sun_path, "%s/%s", directory, name);
	int fd = socket(AF_UNIX, SOCK_STREAM, 0);
	assert_int_equal(bind(fd, (struct sockaddr *)&address, sizeof address), 0);
	close(fd);
}

static void reader_finds_the_daemon_of_its_user(void **state)
{
	struct folder *folder = *state;
	char found[GZ_ENDPOINT_SIZE], wanted[128];
	unsetenv("GAZECAST_RUNTIME_DIR");
	setenv("XDG_RUNTIME_DIR", folder->path, 1);
	assert_int_equal(mkdir(folder->inside, 0700), 0);
	make_socket(folder->inside, "latest");
	assert_int_equal(gz_endpoint_find("latest", &folder->captured.log, found, sizeof found),
			 GZ_OK);
	snprintf(wanted, sizeof wanted, "ipc://%s/latest", folder->inside);
	assert_string_equal(found, wanted);
	snprintf(wanted, sizeof wanted, "%s/latest", folder->inside);
	unlink(wanted);
	unsetenv("XDG_RUNTIME_DIR");
}

static void reader_waits_where_the_daemon_of_its_user_will_be(void **state)
{
	struct folder *folder = *state;
	char found[GZ_ENDPOINT_SIZE], wanted[128];
	struct stat status;
	if (stat(GZ_SYSTEM_RUNTIME_DIRECTORY "/latest", &status) == 0)
		skip(); /* a system daemon is running */
	unsetenv("GAZECAST_RUNTIME_DIR");
	setenv("XDG_RUNTIME_DIR", folder->path, 1);
	assert_int_equal(gz_endpoint_find("no-such", &folder->captured.log, found, sizeof found),
			 GZ_OK);
	snprintf(wanted, sizeof wanted, "ipc://%s/no-such", folder->inside);
	assert_string_equal(found, wanted);
	unsetenv("XDG_RUNTIME_DIR");
}

/* Another user makes the directory in /tmp before the user's daemon does. */
static void reader_refuses_a_directory_in_tmp_that_is_anothers(void **state)
{
	(void)state;
	enum { USER = 54321, OTHER = 54322 };
	struct stat status;
	static const char path[] = "/tmp/gazecast-54321";
	if (geteuid() != 0 || stat(GZ_SYSTEM_RUNTIME_DIRECTORY, &status) == 0)
		skip(); /* only root can act as both users */
	assert_int_equal(mkdir(path, 0755), 0);
	for (int theirs = 0; theirs < 2; theirs++) {
		int ended;
		assert_int_equal(chown(path, theirs ? OTHER : USER, 0), 0);
		pid_t reader = fork();
		if (reader == 0) {
			char found[GZ_ENDPOINT_SIZE];
			unsetenv("GAZECAST_RUNTIME_DIR");
			unsetenv("XDG_RUNTIME_DIR");
			if (setuid(USER) != 0)
				_exit(2);
			_exit(gz_endpoint_find("latest", NULL, found, sizeof found) ==
					      (theirs ? GZ_ERR_ACCESS : GZ_OK)
				      ? 0
				      : 1);
		}
		assert_int_equal(waitpid(reader, &ended, 0), reader);
		if (ended != 0)
			fail_msg("theirs %d: %x", theirs, ended);
	}
	assert_int_equal(rmdir(path), 0);
}

TEST_SUITE(endpoint)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(directory_own_variable_comes_first),
		cmocka_unit_test(directory_without_session_is_the_systems_or_in_tmp),
		cmocka_unit_test(directory_too_long_for_the_buffer_is_refused),
		cmocka_unit_test_setup_teardown(prepare_makes_a_directory_for_us_alone, make_folder,
						remove_folder),
		cmocka_unit_test_setup_teardown(prepare_open_directory_is_refused_with_chmod,
						make_folder, remove_folder),
		cmocka_unit_test_setup_teardown(prepare_link_is_refused, make_folder,
						remove_folder),
		cmocka_unit_test_setup_teardown(prepare_file_is_refused, make_folder,
						remove_folder),
		cmocka_unit_test_setup_teardown(prepare_without_parent_fails, make_folder,
						remove_folder),
		cmocka_unit_test_setup_teardown(prepare_anothers_directory_is_refused, make_folder,
						remove_folder),
		cmocka_unit_test(endpoint_is_directory_and_name),
		cmocka_unit_test(endpoint_longer_than_a_socket_path_is_refused),
		cmocka_unit_test_setup_teardown(reader_finds_the_daemon_of_its_user, make_folder,
						remove_folder),
		cmocka_unit_test_setup_teardown(reader_waits_where_the_daemon_of_its_user_will_be,
						make_folder, remove_folder),
		cmocka_unit_test(reader_refuses_a_directory_in_tmp_that_is_anothers),
	};
	return cmocka_run_group_tests_name("endpoint", tests, NULL, NULL);
}
