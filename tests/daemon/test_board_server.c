#include "suite.h"

#include "daemon/board_server.h"

#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "protocol/board/board_door.h"

static char directory[] = "/tmp/gz_board_XXXXXX";
static char path[64];

static int make_directory(void **state)
{
	(void)state;
	if (!mkdtemp(directory))
		return -1;
	snprintf(path, sizeof path, "%s/%s", directory, GZ_BOARD_DOOR_NAME);
	return 0;
}

static int remove_directory(void **state)
{
	(void)state;
	return rmdir(directory);
}

static struct gz_board_server *create_server(void)
{
	struct gz_board_server *server = NULL;
	assert_int_equal(gz_board_server_create(directory, NULL, &server), GZ_OK);
	return server;
}

static void board_server_gives_its_board_to_everybody_who_may_connect(void **state)
{
	(void)state;
	struct gz_board_server *server = create_server();
	struct stat status;
	assert_int_equal(stat(path, &status), 0);
	assert_true(S_ISSOCK(status.st_mode));
	assert_int_equal(status.st_mode & 0777, 0600);
	for (int i = 0; i < 100; i++) {
		struct gz_board_reader *reader = NULL;
		int connection, fd;
		assert_int_equal(gz_board_door_ask(path, &connection), GZ_OK);
		struct pollfd answer = { .fd = connection, .events = POLLIN };
		assert_int_equal(poll(&answer, 1, PATIENCE_MS), 1);
		assert_int_equal(gz_board_door_take(connection, &fd), GZ_OK);
		assert_int_equal(gz_board_open(fd, &reader), GZ_OK);
		assert_true(gz_board_is_same(reader, gz_board_fd(gz_board_server_board(server))));
		gz_board_close(&reader);
		close(fd);
		close(connection);
	}
	gz_board_server_destroy(&server);
	assert_null(server);
	gz_board_server_destroy(&server);
}

static void board_server_leaves_no_socket_and_takes_the_place_of_an_old_one(void **state)
{
	(void)state;
	struct gz_board_server *server;
	int door;
	assert_int_equal(gz_board_door_open(path, &door), GZ_OK);
	close(door); /* as a daemon that was killed */
	assert_int_equal(access(path, F_OK), 0);
	server = create_server();
	gz_board_server_destroy(&server);
	assert_int_equal(access(path, F_OK), -1);
}

static void board_server_needs_a_directory(void **state)
{
	(void)state;
	struct gz_board_server *server = NULL;
	char longer[200];
	memset(longer, 'x', sizeof longer - 1);
	longer[sizeof longer - 1] = '\0';
	assert_int_equal(gz_board_server_create("/nonexistent", NULL, &server), GZ_ERR_IO);
	assert_int_equal(gz_board_server_create(longer, NULL, &server), GZ_ERR_FULL);
	assert_null(server);
}

TEST_SUITE(board_server)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(board_server_gives_its_board_to_everybody_who_may_connect),
		cmocka_unit_test(board_server_leaves_no_socket_and_takes_the_place_of_an_old_one),
		cmocka_unit_test(board_server_needs_a_directory),
	};
	return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
