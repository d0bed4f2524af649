/* The daemon under a service manager: signs of life, and as which user it runs. */
#include "suite.h"

#include <dirent.h>
#include <fcntl.h>
#include <poll.h>
#include <pwd.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "gazed_process.h"
#include "protocol/board/board.h"
#include "protocol/board/board_door.h"

/* The period of a watchdog that wants a sign of life every 0.1 s. */
static const char watchdog_usec[] = "200000";

static struct gazed_place place;
static int manager = -1; /* the socket of the service manager that the test plays */

static int set_up(void **state)
{
	(void)state;
	gazed_place_make(&place);
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	gazed_kill_all();
	gazed_place_remove(&place);
	if (manager >= 0)
		close(manager);
	manager = -1;
	unsetenv("NOTIFY_SOCKET");
	unsetenv("WATCHDOG_USEC");
	unsetenv("WATCHDOG_PID");
	return 0;
}

static struct gazed_process spawn(const char *const *arguments)
{
	struct gazed_process process;
	gazed_spawn(&(struct gazed_start) { .place = &place, .arguments = arguments }, &process);
	return process;
}

#define SPAWN(...) spawn((const char *const[]) { __VA_ARGS__, NULL })

/* Play the service manager, at a path or at an abstract name. */
static void listen_as_manager(bool abstract)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	socklen_t size = sizeof address;
	char name[sizeof address.sun_path];
	snprintf(name, sizeof name, "%s%s/manager", abstract ? "@" : "", place.directory);
	memcpy(address.sun_path, name, sizeof name);
	if (abstract) {
		address.sun_path[0] = '\0';
		size = (socklen_t)(offsetof(struct sockaddr_un, sun_path) + strlen(name));
	}
	manager = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
	assert_int_equal(bind(manager, (struct sockaddr *)&address, size), 0);
	setenv("NOTIFY_SOCKET", name, 1);
}

/* The next message of the daemon within @p timeout_ms, or NULL. */
static const char *hear(int timeout_ms)
{
	static char text[1024];
	struct pollfd readable = { .fd = manager, .events = POLLIN };
	if (poll(&readable, 1, timeout_ms) != 1)
		return NULL;
	ssize_t size = recv(manager, text, sizeof text - 1, 0);
	assert_true(size > 0);
	text[size] = '\0';
	return text;
}

static void hear_until(const char *wanted, const struct gazed_process *gazed)
{
	const char *text;
	do {
		text = hear(PATIENCE_MS);
		if (!text)
			fail_msg("no %s; gazed: %s", wanted, gazed_said(gazed));
	} while (strcmp(text, wanted) != 0);
}

static void manager_is_told_of_start_life_and_end(void **state)
{
	(void)state;
	listen_as_manager(false);
	setenv("WATCHDOG_USEC", watchdog_usec, 1);
	struct gazed_process gazed = SPAWN("--sim.rate_hz", "120");
	hear_until("READY=1", &gazed);
	hear_until("WATCHDOG=1", &gazed);
	hear_until("STATUS=sim: running", &gazed);
	/* Once it is ready, samples are served. */
	assert_non_null(gazed_request(&place, "v", NULL));
	hear_until("WATCHDOG=1", &gazed);
	assert_int_equal(kill(gazed.pid, SIGTERM), 0);
	hear_until("STOPPING=1", &gazed);
	assert_int_equal(gazed_wait_exit(&gazed), 0);
}

static void manager_may_listen_at_an_abstract_name(void **state)
{
	(void)state;
	listen_as_manager(true);
	struct gazed_process gazed = SPAWN("--sim.rate_hz", "120");
	hear_until("READY=1", &gazed);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	/* Without a watchdog no signs of life are sent. */
	for (const char *text; (text = hear(0));)
		assert_string_not_equal(text, "WATCHDOG=1");
}

static void watchdog_of_another_process_gets_no_signs_of_life(void **state)
{
	(void)state;
	listen_as_manager(false);
	setenv("WATCHDOG_USEC", watchdog_usec, 1);
	setenv("WATCHDOG_PID", "1", 1);
	struct gazed_process gazed = SPAWN("--sim.rate_hz", "120");
	hear_until("READY=1", &gazed);
	for (const char *text; (text = hear(500));)
		assert_string_not_equal(text, "WATCHDOG=1");
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
}

static void manager_that_cannot_be_told_does_not_stop_the_daemon(void **state)
{
	(void)state;
	static const char *const names[] = { "/nonexistent/manager", "vsock:2:1", "@" };
	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		setenv("NOTIFY_SOCKET", names[i], 1);
		struct gazed_process gazed = SPAWN("--sim.rate_hz", "120");
		gazed_wait_ready(&place, &gazed);
		assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	}
}

/* The thread of @p process that is called @p name. */
static pid_t find_thread(pid_t process, const char *name)
{
	char path[64], comm[64];
	pid_t found = 0;
	snprintf(path, sizeof path, "/proc/%d/task", process);
	DIR *tasks = opendir(path);
	assert_non_null(tasks);
	for (struct dirent *entry; !found && (entry = readdir(tasks));) {
		snprintf(path, sizeof path, "/proc/%d/task/%.16s/comm", process, entry->d_name);
		FILE *file = entry->d_name[0] != '.' ? fopen(path, "r") : NULL;
		if (file && fgets(comm, sizeof comm, file) &&
		    strncmp(comm, name, strlen(name)) == 0)
			found = atoi(entry->d_name);
		if (file)
			fclose(file);
	}
	closedir(tasks);
	return found;
}

static void signs_of_life_end_when_the_serving_thread_hangs(void **state)
{
	(void)state;
	listen_as_manager(false);
	setenv("WATCHDOG_USEC", watchdog_usec, 1);
	struct gazed_process gazed = SPAWN("--sim.rate_hz", "120");
	hear_until("WATCHDOG=1", &gazed);
	pid_t thread = find_thread(gazed.pid, "gazed-serve");
	assert_true(thread > 0);
	if (ptrace(PTRACE_SEIZE, thread, NULL, NULL) != 0)
		skip(); /* not allowed here */
	assert_int_equal(ptrace(PTRACE_INTERRUPT, thread, NULL, NULL), 0);
	assert_int_equal(waitpid(thread, NULL, __WALL), thread);
	while (hear(0))
		;
	/* The rest of the daemon is alive, which would mislead a watchdog that asks there. */
	assert_non_null(gazed_request(&place, "t", NULL));
	const char *text = hear(1000);
	if (text)
		fail_msg("ten signs of life should be missing, and there is %s", text);
	assert_int_equal(ptrace(PTRACE_DETACH, thread, NULL, NULL), 0);
	hear_until("WATCHDOG=1", &gazed);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
}

/* The line of /proc/PID/status that begins with @p key, without it. */
static const char *status_line(pid_t process, const char *key)
{
	static char line[256];
	char path[64];
	snprintf(path, sizeof path, "/proc/%d/status", process);
	FILE *file = fopen(path, "r");
	assert_non_null(file);
	const char *found = NULL;
	while (!found && fgets(line, sizeof line, file)) {
		if (strncmp(line, key, strlen(key)) == 0)
			found = line + strlen(key);
	}
	fclose(file);
	assert_non_null(found);
	return found;
}

static void started_by_root_it_becomes_the_user_that_is_named(void **state)
{
	(void)state;
	const struct passwd *user = getpwnam("nobody");
	if (geteuid() != 0 || !user)
		skip();
	char wanted[64];
	assert_int_equal(chown(place.directory, user->pw_uid, user->pw_gid), 0);
	assert_int_equal(chown(place.recordings, user->pw_uid, user->pw_gid), 0);
	struct gazed_process gazed = SPAWN("--daemon.user", "nobody", "--record", "mine");
	gazed_wait_ready(&place, &gazed);
	snprintf(wanted, sizeof wanted, "\t%u\t%u\t%u\t%u\n", user->pw_uid, user->pw_uid,
		 user->pw_uid, user->pw_uid);
	assert_string_equal(status_line(gazed.pid, "Uid:"), wanted);
	snprintf(wanted, sizeof wanted, "\t%u\t%u\t%u\t%u\n", user->pw_gid, user->pw_gid,
		 user->pw_gid, user->pw_gid);
	assert_string_equal(status_line(gazed.pid, "Gid:"), wanted);
	assert_string_equal(status_line(gazed.pid, "CapPrm:"), "\t0000000000000000\n");
	assert_string_equal(status_line(gazed.pid, "NoNewPrivs:"), "\t1\n");
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	assert_non_null(strstr(gazed_said(&gazed), "running as user nobody"));
}

static void user_that_cannot_be_is_refused(void **state)
{
	(void)state;
	static const char *const users[][2] = {
		{ "no-such-user", "does not exist on this machine" },
		{ "root", "root is root" },
	};
	for (size_t i = 0; i < sizeof users / sizeof *users; i++) {
		struct gazed_process gazed = SPAWN("--daemon.user", users[i][0]);
		assert_int_equal(gazed_wait_exit(&gazed), 1);
		if (!strstr(gazed_said(&gazed), users[i][1]))
			fail_msg("%s: %s", users[i][0], gazed_said(&gazed));
	}
}

/* Sockets that the test binds as the manager does, beyond the descriptors that it hands them over
 * as. */
enum { HANDED = 5, HANDED_FROM = 64 };

/* Bind the daemon's sockets and listen there, as gazed.socket tells systemd to. */
static void bind_as_manager(int sockets[HANDED])
{
	static const struct {
		const char *name;
		int type;
	} bound[HANDED] = { { "control", SOCK_STREAM },
			    { "latest", SOCK_STREAM },
			    { "stream", SOCK_STREAM },
			    { "inlet", SOCK_STREAM },
			    { "board", SOCK_SEQPACKET } };
	for (int i = 0; i < HANDED; i++) {
		struct sockaddr_un address = { .sun_family = AF_UNIX };
		snprintf(address.sun_path, sizeof address.sun_path, "%s/%s", place.directory,
			 bound[i].name);
		int fd = socket(AF_UNIX, bound[i].type | SOCK_CLOEXEC, 0);
		assert_int_equal(bind(fd, (struct sockaddr *)&address, sizeof address), 0);
		assert_int_equal(listen(fd, 128), 0);
		sockets[i] = fcntl(fd, F_DUPFD_CLOEXEC, HANDED_FROM);
		close(fd);
	}
}

static void close_handed(const int sockets[HANDED])
{
	for (int i = 0; i < HANDED; i++)
		close(sockets[i]);
}

static void client_that_comes_first_is_served_by_the_daemon_that_it_starts(void **state)
{
	(void)state;
	static const char *const arguments[] = { "--sim.rate_hz", "120", NULL };
	int sockets[HANDED];
	bind_as_manager(sockets);
	/* Twice: the sockets outlive a daemon. */
	for (int i = 0; i < 2; i++) {
		struct reader reader;
		struct gazed_process gazed;
		reader_open(&reader, &place, "gaze");
		gazed_spawn(&(struct gazed_start) { .place = &place,
						    .arguments = arguments,
						    .handed = sockets,
						    .handed_count = HANDED },
			    &gazed);
		reader_receive_gaze(&reader, 10);
		assert_non_null(gazed_request(&place, "v", NULL));
		struct gz_board_reader *board = NULL;
		char path[128];
		int connection, fd;
		snprintf(path, sizeof path, "%s/%s", place.directory, GZ_BOARD_DOOR_NAME);
		assert_int_equal(gz_board_door_ask(path, &connection), GZ_OK);
		struct pollfd answer = { .fd = connection, .events = POLLIN };
		assert_int_equal(poll(&answer, 1, PATIENCE_MS), 1);
		assert_int_equal(gz_board_door_take(connection, &fd), GZ_OK);
		assert_int_equal(gz_board_open(fd, &board), GZ_OK);
		gz_board_close(&board);
		close(fd);
		close(connection);
		assert_null(strstr(gazed_said(&gazed), "service manager"));
		reader_close(&reader);
		assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
		assert_int_equal(access(path, F_OK), 0);
	}
	close_handed(sockets);
}

static void sockets_of_a_manager_are_not_taken_from_it(void **state)
{
	(void)state;
	int sockets[HANDED];
	bind_as_manager(sockets);
	struct gazed_process gazed = SPAWN("--sim.rate_hz", "120");
	assert_int_equal(gazed_wait_exit(&gazed), 1);
	assert_non_null(strstr(gazed_said(&gazed), "gazed.socket"));
	close_handed(sockets);
	/* Nobody listens any more: the files are in nobody's way. */
	gazed = SPAWN("--sim.rate_hz", "120");
	gazed_wait_ready(&place, &gazed);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
}

static void descriptors_that_are_no_sockets_of_the_daemon_are_closed(void **state)
{
	(void)state;
	static const char *const arguments[] = { "--sim.rate_hz", "120", NULL };
	int file = open("/dev/null", O_RDONLY | O_CLOEXEC);
	int handed[] = { fcntl(file, F_DUPFD_CLOEXEC, HANDED_FROM) };
	close(file);
	struct gazed_process gazed;
	gazed_spawn(&(struct gazed_start) { .place = &place,
					    .arguments = arguments,
					    .handed = handed,
					    .handed_count = 1 },
		    &gazed);
	gazed_wait_ready(&place, &gazed);
	assert_non_null(strstr(gazed_said(&gazed), "descriptor 3 of the service manager"));
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	close(handed[0]);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

TEST_SUITE(service_manager)
{
	const struct CMUnitTest tests[] = {
		TEST(manager_is_told_of_start_life_and_end),
		TEST(manager_may_listen_at_an_abstract_name),
		TEST(watchdog_of_another_process_gets_no_signs_of_life),
		TEST(manager_that_cannot_be_told_does_not_stop_the_daemon),
		TEST(signs_of_life_end_when_the_serving_thread_hangs),
		TEST(started_by_root_it_becomes_the_user_that_is_named),
		TEST(user_that_cannot_be_is_refused),
		TEST(client_that_comes_first_is_served_by_the_daemon_that_it_starts),
		TEST(sockets_of_a_manager_are_not_taken_from_it),
		TEST(descriptors_that_are_no_sockets_of_the_daemon_are_closed),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
