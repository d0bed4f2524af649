#include "suite.h"

#include <arpa/inet.h>
#include <errno.h>
#include <poll.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/clock.h"
#include "daemon/accept.h"
#include "daemon/quota.h"

/* A connection: our end, and the client's. */
struct pair {
	int ours;
	int client;
};

static struct gz_quota *quota;
static const char stream[] = "stream", control[] = "control";

static struct pair connect_locally(void)
{
	int fds[2];
	assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, fds), 0);
	return (struct pair) { fds[0], fds[1] };
}

/* A socket with one connection that waits to be accepted. @param[out] out_client  the other end */
static int listen_with_one_waiting(int *out_client)
{
	struct sockaddr_in address = { .sin_family = AF_INET,
				       .sin_addr = { htonl(INADDR_LOOPBACK) } };
	socklen_t size = sizeof address;
	int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	assert_int_equal(bind(listener, (struct sockaddr *)&address, size), 0);
	assert_int_equal(listen(listener, 1), 0);
	assert_int_equal(getsockname(listener, (struct sockaddr *)&address, &size), 0);
	*out_client = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	assert_int_equal(connect(*out_client, (struct sockaddr *)&address, size), 0);
	return listener;
}

static struct pair connect_over_tcp(void)
{
	struct pair pair;
	int listener = listen_with_one_waiting(&pair.client);
	pair.ours = accept(listener, NULL, NULL);
	assert_true(pair.ours >= 0);
	close(listener);
	return pair;
}

static void disconnect(struct pair *pair)
{
	close(pair->ours);
	close(pair->client);
}

/* Whether the quota has ended the connection. */
static bool has_ended(const struct pair *pair)
{
	char byte;
	struct pollfd poll_fd = { .fd = pair->client, .events = POLLIN };
	return poll(&poll_fd, 1, 0) == 1 && recv(pair->client, &byte, 1, MSG_DONTWAIT) <= 0;
}

static void send_bytes(const struct pair *pair, size_t size)
{
	static const char bytes[65536];
	assert_true(size <= sizeof bytes);
	assert_int_equal(send(pair->client, bytes, size, MSG_NOSIGNAL), size);
	struct pollfd poll_fd = { .fd = pair->ours, .events = POLLIN };
	assert_int_equal(poll(&poll_fd, 1, PATIENCE_MS), 1);
}

static void create_quota(uint32_t connections)
{
	assert_int_equal(gz_quota_create(connections, NULL, &quota), GZ_OK);
}

static int tear_down(void **state)
{
	(void)state;
	gz_quota_destroy(&quota);
	gz_quota_destroy(&quota);
	return quota != NULL;
}

static void quota_newest_of_too_many_connections_is_ended(void **state)
{
	(void)state;
	struct pair pairs[5];
	create_quota(4);
	for (int i = 0; i < 5; i++) {
		pairs[i] = connect_locally();
		gz_quota_arrived(quota, pairs[i].ours, control, false, 0);
		assert_int_equal(has_ended(&pairs[i]), i == 4);
	}
	assert_int_equal(gz_quota_count(quota), 4);
	assert_int_equal(gz_quota_ended(quota, GZ_QUOTA_TOO_MANY), 1);
	gz_quota_left(quota, pairs[4].ours, control);
	gz_quota_left(quota, pairs[0].ours, control);
	gz_quota_left(quota, pairs[0].ours, control);
	assert_int_equal(gz_quota_count(quota), 3);
	for (int i = 0; i < 5; i++)
		disconnect(&pairs[i]);
}

/* A burst over TCP, which libzmq has not closed yet, does not keep a local connection out. */
static void quota_ended_connections_do_not_count(void **state)
{
	(void)state;
	struct pair pairs[9];
	create_quota(4);
	for (int i = 0; i < 9; i++) {
		pairs[i] = i < 8 ? connect_over_tcp() : connect_locally();
		gz_quota_arrived(quota, pairs[i].ours, control, false, 0);
		assert_int_equal(has_ended(&pairs[i]), i >= 3 && i < 8);
	}
	for (int i = 0; i < 9; i++)
		gz_quota_left(quota, pairs[i].ours, control);
	assert_int_equal(gz_quota_count(quota), 0);
	for (int i = 0; i < 9; i++)
		disconnect(&pairs[i]);
}

static void quota_tcp_leaves_a_quarter_to_local_connections(void **state)
{
	(void)state;
	struct pair pairs[5];
	create_quota(4);
	for (int i = 0; i < 5; i++) {
		pairs[i] = i < 4 ? connect_over_tcp() : connect_locally();
		gz_quota_arrived(quota, pairs[i].ours, control, false, 0);
		assert_int_equal(has_ended(&pairs[i]), i == 3);
	}
	for (int i = 0; i < 5; i++)
		disconnect(&pairs[i]);
}

/* Two sockets report in any order that one closed a connection and the other got its number. */
static void quota_end_of_a_connection_of_another_socket_is_not_its_own(void **state)
{
	(void)state;
	struct pair pair = connect_locally();
	create_quota(4);
	gz_quota_arrived(quota, pair.ours, stream, true, 0);
	gz_quota_arrived(quota, pair.ours, control, false, 0);
	assert_int_equal(gz_quota_count(quota), 1);
	gz_quota_left(quota, pair.ours, stream);
	assert_int_equal(gz_quota_count(quota), 1);
	gz_quota_left(quota, pair.ours, control);
	assert_int_equal(gz_quota_count(quota), 0);
	disconnect(&pair);
	gz_quota_arrived(quota, pair.ours, control, false, 0);
	assert_int_equal(gz_quota_count(quota), 0);
}

static void check_flood(struct pair pair)
{
	struct pollfd poll_fd = { .events = POLLIN };
	create_quota(4);
	gz_quota_arrived(quota, pair.ours, stream, true, 0);
	send_bytes(&pair, GZ_QUOTA_HANDSHAKE);
	gz_quota_check(quota, 0);
	assert_false(has_ended(&pair));
	for (int i = 0; i < 2; i++)
		send_bytes(&pair, GZ_QUOTA_READER_BYTES);
	poll_fd.fd = gz_quota_fd(quota);
	assert_int_equal(poll(&poll_fd, 1, PATIENCE_MS), 1);
	gz_quota_check(quota, 0);
	assert_true(has_ended(&pair));
	assert_int_equal(gz_quota_ended(quota, GZ_QUOTA_TOO_LARGE), 1);
	char byte; /* nothing of it is left to be read */
	assert_int_equal(recv(pair.ours, &byte, 1, MSG_DONTWAIT), 0);
	disconnect(&pair);
	gz_quota_destroy(&quota);
}

static void quota_reader_that_floods_is_ended_and_what_it_sent_is_discarded(void **state)
{
	(void)state;
	check_flood(connect_over_tcp());
	check_flood(connect_locally());
}

/* What libzmq has read counts too, over TCP. With time a reader may send more. */
static void quota_reader_may_send_a_little_without_an_end(void **state)
{
	(void)state;
	char bytes[GZ_QUOTA_READER_BYTES];
	struct pair pair = connect_over_tcp();
	create_quota(4);
	gz_quota_arrived(quota, pair.ours, stream, true, 0);
	const int64_t enough_ns = GZ_QUOTA_READER_BYTES / GZ_QUOTA_READER_BYTES_PER_S * GZ_NS_PER_S;
	for (int i = 0; i < 8; i++) {
		send_bytes(&pair, sizeof bytes);
		assert_int_equal(recv(pair.ours, bytes, sizeof bytes, MSG_WAITALL), sizeof bytes);
		gz_quota_check(quota, i * enough_ns);
		assert_false(has_ended(&pair));
	}
	send_bytes(&pair, sizeof bytes);
	gz_quota_check(quota, 7 * enough_ns);
	assert_true(has_ended(&pair));
	disconnect(&pair);
}

static void quota_readers_together_are_limited(void **state)
{
	(void)state;
	enum { ENOUGH = GZ_QUOTA_ALL_BYTES / GZ_QUOTA_READER_BYTES };
	static struct pair pairs[ENOUGH + 1];
	static char bytes[GZ_QUOTA_HANDSHAKE + GZ_QUOTA_READER_BYTES];
	create_quota(2 * ENOUGH);
	for (int i = 0; i <= ENOUGH; i++) {
		pairs[i] = connect_over_tcp();
		gz_quota_arrived(quota, pairs[i].ours, stream, true, 0);
		send_bytes(&pairs[i], sizeof bytes);
		gz_quota_check(quota, 0);
		assert_int_equal(has_ended(&pairs[i]), i == ENOUGH);
		recv(pairs[i].ours, bytes, sizeof bytes, MSG_DONTWAIT);
	}
	for (int i = 0; i <= ENOUGH; i++)
		disconnect(&pairs[i]);
}

static void quota_end_of_another_file_changes_nothing(void **state)
{
	(void)state;
	struct pair pair = connect_locally();
	uint64_t identity = gz_connection_identity(pair.ours);
	assert_true(identity != 0);
	assert_int_equal(gz_connection_identity(-1), 0);
	assert_int_equal(gz_connection_identity(STDIN_FILENO), 0);
	gz_connection_end(pair.ours, identity + 1);
	assert_false(has_ended(&pair));
	gz_connection_end(pair.ours, identity);
	assert_true(has_ended(&pair));
	disconnect(&pair);
}

/* What libzmq calls: it would end the program with EMFILE at a local socket. */
static void accept_without_a_free_descriptor_is_told_to_try_again(void **state)
{
	(void)state;
	int client, listener = listen_with_one_waiting(&client);
	struct rlimit before, none;
	assert_true(gz_accept_is_found());
	assert_int_equal(getrlimit(RLIMIT_NOFILE, &before), 0);
	none = (struct rlimit) { .rlim_cur = 0, .rlim_max = before.rlim_max };
	assert_int_equal(setrlimit(RLIMIT_NOFILE, &none), 0);
	int refused = accept4(listener, NULL, NULL, SOCK_CLOEXEC), error = errno;
	int old_refused = accept(listener, NULL, NULL), old_error = errno;
	assert_int_equal(setrlimit(RLIMIT_NOFILE, &before), 0);
	assert_int_equal(refused, -1);
	assert_int_equal(error, EAGAIN);
	assert_int_equal(old_refused, -1);
	assert_int_equal(old_error, EAGAIN);
	int accepted = accept4(listener, NULL, NULL, SOCK_CLOEXEC);
	assert_true(accepted >= 0);
	errno = 0;
	assert_int_equal(accept4(-1, NULL, NULL, 0), -1);
	assert_int_equal(errno, EBADF);
	close(accepted);
	close(client);
	close(listener);
}

static void quota_depends_on_the_limit_of_files(void **state)
{
	(void)state;
	assert_in_range(gz_quota_connections_possible(), 4, GZ_QUOTA_CONNECTIONS);
}

#define TEST(function) cmocka_unit_test_teardown(function, tear_down)

TEST_SUITE(quota)
{
	const struct CMUnitTest tests[] = {
		TEST(quota_newest_of_too_many_connections_is_ended),
		TEST(quota_ended_connections_do_not_count),
		TEST(quota_tcp_leaves_a_quarter_to_local_connections),
		TEST(quota_end_of_a_connection_of_another_socket_is_not_its_own),
		TEST(quota_reader_that_floods_is_ended_and_what_it_sent_is_discarded),
		TEST(quota_reader_may_send_a_little_without_an_end),
		TEST(quota_readers_together_are_limited),
		TEST(quota_end_of_another_file_changes_nothing),
		TEST(accept_without_a_free_descriptor_is_told_to_try_again),
		TEST(quota_depends_on_the_limit_of_files),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
