/* From where the client library reads: the board of a daemon on this machine, or the socket. */
#include "suite.h"

#include "client/client.h"
#include "client/connection.h"
#include "client/stream.h"
#include "program.h"
#include "publisher.h"

#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zmq.h>

#include "base/clock.h"
#include "protocol/board/board_door.h"
#include "protocol/wire.h"

/* A daemon that a test plays: what it writes on the board and what it sends at the socket differ,
 * so that a test sees from where a message comes. */
struct played {
	struct publisher publisher;
	struct gz_board *board;
	atomic_int board_fd; /* that is handed out */
	int door;
	atomic_bool stop;
	pthread_t thread;
};

static void *serve_readers(void *user)
{
	struct played *played = user;
	struct pollfd door = { .fd = played->door, .events = POLLIN };
	while (!atomic_load(&played->stop))
		if (poll(&door, 1, 1) > 0)
			gz_board_door_serve(played->door, atomic_load(&played->board_fd));
	return NULL;
}

static void played_open(struct played *played, const char *channel)
{
	char path[200];
	*played = (struct played) { 0 };
	assert_int_equal(gz_board_create(GZ_BOARD_SIZE_MIN, &played->board), GZ_OK);
	atomic_init(&played->board_fd, gz_board_fd(played->board));
	snprintf(path, sizeof path, "%s/%s", getenv("GAZECAST_RUNTIME_DIR"), GZ_BOARD_DOOR_NAME);
	assert_int_equal(gz_board_door_open(path, &played->door), GZ_OK);
	assert_int_equal(pthread_create(&played->thread, NULL, serve_readers, played), 0);
	publisher_open(&played->publisher, channel);
}

static void close_board(struct played *played)
{
	atomic_store(&played->stop, true);
	pthread_join(played->thread, NULL);
	close(played->door);
	gz_board_destroy(&played->board);
}

static void played_close(struct played *played)
{
	close_board(played);
	publisher_close(&played->publisher);
}

static void write_message(struct played *played, const char *topic, const void *bytes, size_t size)
{
	const struct gz_board_message message = {
		.topic = topic,
		.topic_size = strlen(topic),
		.body = bytes,
		.body_size = size,
		.time_ns = gz_clock_now_ns(),
		.is_gaze = strncmp(topic, GZ_TOPIC_GAZE, strlen(GZ_TOPIC_GAZE)) == 0,
	};
	assert_true(gz_board_write(played->board, &message));
	gz_board_show(played->board, true);
}

static void write_gaze(struct played *played, uint64_t seq)
{
	struct gz_display display = gz_display_default(1920, 1080);
	struct gz_gaze gaze = gaze_at(seq, 0.5f, 0.5f);
	struct gz_wire_message wire;
	assert_int_equal(gz_wire_encode_gaze(&gaze, &display, &wire), GZ_OK);
	write_message(played, GZ_TOPIC_GAZE_BOTH, wire.bytes, wire.size);
}

static void send_gaze(struct played *played, uint64_t seq)
{
	struct gz_gaze gaze = gaze_at(seq, 0.5f, 0.5f);
	publisher_send_gaze(&played->publisher, &gaze);
}

static struct gz_stream *open_topics(const char *const *topics)
{
	struct gz_stream *stream = NULL;
	assert_int_equal(gz_stream_open(NULL, topics, NULL, &stream), GZ_OK);
	return stream;
}

static struct gz_message read_one(struct gz_stream *stream)
{
	struct gz_message message;
	assert_int_equal(gz_stream_read(stream, PATIENCE_MS, &message), GZ_OK);
	return message;
}

static void assert_nothing_comes(struct gz_stream *stream)
{
	struct gz_message message;
	assert_int_equal(gz_stream_read(stream, 30, &message), GZ_ERR_TIMEOUT);
}

static struct gz_stream_counters counters_of(struct gz_stream *stream)
{
	struct gz_stream_counters counters;
	gz_stream_get_counters(stream, &counters);
	return counters;
}

static void wait_for_connections(struct gz_stream *stream, uint64_t connections)
{
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	struct gz_message message;
	while (counters_of(stream).connections < connections) {
		assert_true(gz_clock_now_ns() < deadline_ns);
		assert_int_equal(gz_stream_read(stream, 1, &message), GZ_ERR_TIMEOUT);
	}
}

static const unsigned char map[] = { 0x80 };

static void stream_reads_the_board_and_not_the_socket(void **state)
{
	(void)state;
	struct played played;
	played_open(&played, "stream");
	write_gaze(&played, 1); /* before it was opened */
	struct gz_stream *stream = open_topics(NULL);
	wait_for_connections(stream, 1);
	for (uint64_t seq = 10; seq < 20; seq++) {
		send_gaze(&played, seq + 1000);
		write_gaze(&played, seq);
		assert_int_equal(read_one(stream).gaze.seq, seq);
	}
	assert_nothing_comes(stream);
	struct gz_stream_counters counters = counters_of(stream);
	assert_true(counters.connected);
	assert_int_equal(counters.received, 10);
	assert_int_equal(counters.lost, 0);
	gz_stream_close(&stream);
	played_close(&played);
}

static void topics_leave_the_rest_of_the_board_out(void **state)
{
	(void)state;
	static const char *const topics[] = { "fix", "blinks", NULL };
	struct played played;
	played_open(&played, "stream");
	struct gz_stream *stream = open_topics(topics);
	write_gaze(&played, 1);
	write_message(&played, "fi", map, sizeof map);
	write_message(&played, "fixture", map, sizeof map);
	write_message(&played, "status", map, sizeof map);
	write_message(&played, "blinks.x", map, sizeof map);
	assert_string_equal(read_one(stream).topic, "fixture");
	assert_string_equal(read_one(stream).topic, "blinks.x");
	assert_nothing_comes(stream);
	gz_stream_close(&stream);
	played_close(&played);
}

static void reader_that_was_opened_first_gets_every_message_once(void **state)
{
	(void)state;
	struct played played;
	struct gz_stream *stream = open_topics(NULL);
	struct gz_message message;
	assert_int_equal(gz_stream_read(stream, 0, &message), GZ_ERR_TIMEOUT);
	played_open(&played, "stream");
	/* It does not read for a while. */
	int64_t until_ns = gz_clock_now_ns() + 100 * GZ_NS_PER_MS;
	for (uint64_t seq = 0; seq < 20; seq++) {
		send_gaze(&played, seq);
		write_gaze(&played, seq);
		gz_clock_sleep_until_ns(until_ns - (20 - (int64_t)seq) * 5 * GZ_NS_PER_MS);
	}
	for (uint64_t seq = 0; seq < 20; seq++)
		assert_int_equal(read_one(stream).gaze.seq, seq);
	assert_nothing_comes(stream);
	assert_int_equal(counters_of(stream).lost, 0);
	gz_stream_close(&stream);
	played_close(&played);
}

static void overtaken_reader_counts_what_it_lost(void **state)
{
	(void)state;
	struct played played;
	played_open(&played, "stream");
	struct gz_stream *stream = open_topics(NULL);
	write_gaze(&played, 0);
	assert_int_equal(read_one(stream).gaze.seq, 0);
	for (uint64_t seq = 1; seq <= 1000; seq++)
		write_gaze(&played, seq);
	struct gz_message message = read_one(stream);
	assert_true(message.lost > 500);
	assert_int_equal(message.lost, message.gaze.seq - 1);
	while (message.gaze.seq < 1000) {
		message = read_one(stream);
		assert_int_equal(message.lost, 0);
	}
	assert_int_equal(counters_of(stream).received + counters_of(stream).lost, 1001);
	gz_stream_close(&stream);
	played_close(&played);
}

static void wait_connected_again(struct played *played, struct gz_stream *stream,
				 struct gz_message *message)
{
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	do {
		assert_true(gz_clock_now_ns() < deadline_ns);
		publisher_send(&played->publisher, "sync", map, sizeof map);
	} while (gz_stream_read(stream, 10, message) != GZ_OK);
}

static void without_a_board_the_socket_is_read(void **state)
{
	(void)state;
	struct played played;
	struct gz_message message;
	played_open(&played, "stream");
	close_board(&played); /* nobody answers at the door */
	struct gz_stream *stream = open_topics(NULL);
	wait_connected_again(&played, stream, &message);
	send_gaze(&played, 7);
	do
		message = read_one(stream);
	while (message.kind != GZ_MESSAGE_GAZE);
	assert_int_equal(message.gaze.seq, 7);
	gz_stream_close(&stream);
	publisher_close(&played.publisher);
}

static void door_that_gives_something_else_leaves_the_socket(void **state)
{
	(void)state;
	struct played played;
	struct gz_message message;
	played_open(&played, "stream");
	atomic_store(&played.board_fd, played.door);
	struct gz_stream *stream = open_topics(NULL);
	wait_connected_again(&played, stream, &message);
	assert_string_equal(message.topic, "sync");
	gz_stream_close(&stream);
	played_close(&played);
}

static void door_where_nobody_answers_leaves_the_socket(void **state)
{
	(void)state;
	struct played played;
	struct gz_message message;
	played_open(&played, "stream");
	atomic_store(&played.stop, true);
	pthread_join(played.thread, NULL);
	struct gz_stream *stream = open_topics(NULL);
	wait_connected_again(&played, stream, &message);
	for (uint64_t seq = 5; seq < 10; seq++) {
		send_gaze(&played, seq);
		do
			message = read_one(stream);
		while (message.kind != GZ_MESSAGE_GAZE);
		assert_int_equal(message.gaze.seq, seq);
	}
	gz_stream_close(&stream);
	close(played.door);
	gz_board_destroy(&played.board);
	publisher_close(&played.publisher);
}

static void malformed_messages_on_the_board_are_counted(void **state)
{
	(void)state;
	static const unsigned char broken[] = { 0x82, 0xa1 };
	struct played played;
	played_open(&played, "stream");
	struct gz_stream *stream = open_topics(NULL);
	write_message(&played, "gaze.3d.01.", broken, sizeof broken);
	write_message(&played, "surfaces.x", broken, sizeof broken);
	write_gaze(&played, 4);
	assert_int_equal(read_one(stream).gaze.seq, 4);
	assert_int_equal(counters_of(stream).malformed, 2);
	gz_stream_close(&stream);
	played_close(&played);
}

static void latest_gaze_comes_from_the_board(void **state)
{
	(void)state;
	struct played played;
	struct gz_client *client = NULL;
	struct gz_gaze gaze;
	struct gz_client_counters counters;
	played_open(&played, "latest");
	write_gaze(&played, 1); /* before it was opened */
	assert_int_equal(gz_client_open(NULL, NULL, &client), GZ_OK);
	assert_int_equal(gz_client_latest(client, &gaze, NULL), GZ_ERR_TIMEOUT);
	for (uint64_t seq = 10; seq < 20; seq++) {
		struct gz_gaze other = gaze_at(1000, 0.1f, 0.1f);
		publisher_send_latest(&played.publisher, &other);
		write_gaze(&played, seq);
		assert_int_equal(gz_client_latest(client, &gaze, NULL), GZ_OK);
		assert_int_equal(gaze.seq, seq);
	}
	write_gaze(&played, 23);
	assert_int_equal(gz_client_latest(client, &gaze, NULL), GZ_OK);
	assert_int_equal(gz_client_latest(client, &gaze, NULL), GZ_OK);
	gz_client_get_counters(client, &counters);
	assert_int_equal(counters.received, 11);
	assert_int_equal(counters.skipped, 3);
	gz_client_close(&client);
	played_close(&played);
}

/* With the real daemon. */

static struct program daemon_program; /* large: not for the stack */

static void start_daemon(const char *rate_hz)
{
	program_start(&daemon_program,
		      (const char *const[]) { GAZED, "--config", "/dev/null", "--tcp", "off",
					      "--sim.rate_hz", rate_hz, NULL });
	program_wait_for(&daemon_program, "sim delivers samples");
}

static void end_daemon(int signal_number)
{
	assert_int_equal(kill(daemon_program.process, signal_number), 0);
	program_finish(&daemon_program);
}

static int kill_daemon(void **state)
{
	(void)state;
	program_kill(&daemon_program);
	return 0;
}

/* Read until the stream has given @p count gaze messages from now on. @return the last one */
static struct gz_gaze read_gaze(struct gz_stream *stream, int count)
{
	struct gz_message message;
	while (count > 0) {
		message = read_one(stream);
		count -= message.kind == GZ_MESSAGE_GAZE;
	}
	return message.gaze;
}

static void assert_reads_board(const struct gz_subscriber *subscriber, uint64_t boards)
{
	assert_int_equal(subscriber->board.source, GZ_BOARD_SOURCE_BOARD);
	assert_int_equal(subscriber->board.boards, boards);
}

static void killed_daemon_that_returns_is_read_at_its_new_board(void **state)
{
	(void)state;
	const struct gz_subscriber_params params = { .channel = "stream" };
	struct gz_subscriber subscriber;
	start_daemon("500");
	assert_int_equal(gz_subscriber_open(&subscriber, &params, NULL), GZ_OK);
	/* A busy daemon gives the board once the socket is connected. */
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (!gz_board_link_reader(&subscriber.board)) {
		assert_true(gz_clock_now_ns() < deadline_ns);
		gz_subscriber_take_events(&subscriber);
	}
	assert_reads_board(&subscriber, 1);
	end_daemon(SIGKILL);
	start_daemon("500");
	deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	struct gz_board_record record;
	while (subscriber.board.boards < 2) {
		assert_true(gz_clock_now_ns() < deadline_ns);
		gz_subscriber_take_events(&subscriber);
		struct gz_board_reader *reader = gz_board_link_reader(&subscriber.board);
		while (reader && gz_board_next(reader, &record) == GZ_OK)
			;
	}
	assert_reads_board(&subscriber, 2);
	gz_subscriber_close(&subscriber);
	end_daemon(SIGTERM);
}

static void stream_of_a_killed_daemon_goes_on_with_the_next(void **state)
{
	(void)state;
	start_daemon("1000");
	struct gz_stream *stream = open_topics(NULL);
	uint64_t before = read_gaze(stream, 200).seq;
	end_daemon(SIGKILL);
	start_daemon("200");
	struct gz_gaze gaze;
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	do {
		gaze = read_gaze(stream, 1);
		assert_true(gz_clock_now_ns() < deadline_ns);
	} while (gaze.seq >= before);
	read_gaze(stream, 50);
	struct gz_stream_counters counters = counters_of(stream);
	assert_true(counters.connected);
	assert_int_equal(counters.connections, 2);
	assert_int_equal(counters.malformed, 0);
	gz_stream_close(&stream);
	end_daemon(SIGTERM);
}

static void pupils_are_on_the_board_for_those_who_want_them(void **state)
{
	(void)state;
	static const char *const topics[] = { "pupil.", NULL };
	start_daemon("500");
	struct gz_stream *gaze_only = open_topics((const char *const[]) { "gaze.", NULL });
	struct gz_stream *stream = open_topics(topics);
	for (int i = 0; i < 20; i++)
		assert_memory_equal(read_one(stream).topic, "pupil.", 6);
	read_gaze(gaze_only, 20);
	gz_stream_close(&stream);
	gz_stream_close(&gaze_only);
	end_daemon(SIGTERM);
}

static void readers_of_the_board_are_counted_and_waited_for(void **state)
{
	(void)state;
	static const char *const topics[] = { "gaze.", NULL };
	struct gz_stream *first = open_topics(topics), *second = open_topics(NULL);
	program_start(&daemon_program,
		      (const char *const[]) { GAZED, "--config", "/dev/null", "--tcp", "off",
					      "--sim.rate_hz", "500", "--wait-readers", "3",
					      NULL });
	wait_for_connections(first, 1);
	struct gz_message message;
	do
		message = read_one(second);
	while (message.kind != GZ_MESSAGE_STATUS || message.status.subscribers < 2);
	assert_int_equal(message.status.samples, 0);
	struct gz_stream *third = open_topics(topics);
	assert_int_equal(read_gaze(third, 1).seq, 0);
	assert_int_equal(read_gaze(first, 1).seq, 0);
	assert_int_equal(read_gaze(second, 1).seq, 0);
	gz_stream_close(&first);
	gz_stream_close(&second);
	gz_stream_close(&third);
	end_daemon(SIGTERM);
}

static void wait_for_handshakes(struct gz_subscriber *subscriber, uint64_t count)
{
	const int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (subscriber->connections < count) {
		assert_true(gz_clock_now_ns() < deadline_ns);
		gz_subscriber_take_events(subscriber);
	}
}

static void count_connected_again(void *user, enum gz_log_level level, const char *module,
				  const char *message)
{
	(void)level;
	(void)module;
	*(int *)user += strstr(message, "connected again") != NULL;
}

/* A retry overtook the connection that libzmq had just made, and both were told. */
static void connection_made_twice_is_told_once(void **state)
{
	(void)state;
	const struct gz_subscriber_params params = { .channel = "stream" };
	struct gz_subscriber subscriber;
	struct publisher publisher;
	struct gz_log log;
	int told = 0;
	gz_log_init(&log, count_connected_again, &told, "info");
	publisher_open(&publisher, "stream");
	assert_int_equal(gz_subscriber_open(&subscriber, &params, &log), GZ_OK);
	wait_for_handshakes(&subscriber, 1);
	publisher_close(&publisher);
	while (subscriber.connected)
		gz_subscriber_take_events(&subscriber);
	publisher_open(&publisher, "stream");
	wait_for_handshakes(&subscriber, 2);
	assert_int_equal(told, 1);
	assert_int_equal(zmq_disconnect(subscriber.socket, subscriber.endpoint), 0);
	assert_int_equal(zmq_connect(subscriber.socket, subscriber.endpoint), 0);
	wait_for_handshakes(&subscriber, 3);
	gz_subscriber_close(&subscriber);
	publisher_close(&publisher);
	assert_int_equal(told, 1);
}

TEST_SUITE(board_link)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(stream_reads_the_board_and_not_the_socket),
		cmocka_unit_test(topics_leave_the_rest_of_the_board_out),
		cmocka_unit_test(reader_that_was_opened_first_gets_every_message_once),
		cmocka_unit_test(overtaken_reader_counts_what_it_lost),
		cmocka_unit_test(without_a_board_the_socket_is_read),
		cmocka_unit_test(door_that_gives_something_else_leaves_the_socket),
		cmocka_unit_test(door_where_nobody_answers_leaves_the_socket),
		cmocka_unit_test(malformed_messages_on_the_board_are_counted),
		cmocka_unit_test(latest_gaze_comes_from_the_board),
		cmocka_unit_test(connection_made_twice_is_told_once),
		cmocka_unit_test_teardown(killed_daemon_that_returns_is_read_at_its_new_board,
					  kill_daemon),
		cmocka_unit_test_teardown(stream_of_a_killed_daemon_goes_on_with_the_next,
					  kill_daemon),
		cmocka_unit_test_teardown(pupils_are_on_the_board_for_those_who_want_them,
					  kill_daemon),
		cmocka_unit_test_teardown(readers_of_the_board_are_counted_and_waited_for,
					  kill_daemon),
	};
	return cmocka_run_group_tests(tests, runtime_directory_make, runtime_directory_remove);
}
