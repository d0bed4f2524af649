/* The daemon with trackers that misbehave and with more readers than in any real use. */
#include "suite.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/clock.h"
#include "drivers/template_made.h"
#include "gazed_process.h"
#include "protocol/wire.h"

/* A thread sanitizer needs half a second for each context of libzmq. */
#if defined __SANITIZE_THREAD__
#define READERS 8
#else
#define READERS 64
#endif
#define TEXT_OF(number) #number
#define TEXT(number)    TEXT_OF(number)

static struct gazed_place place;
static char fifo[128];

/* The tracker: reports of the template driver through a FIFO. */
static struct {
	int fd;
	uint32_t counter;
	uint32_t clock_us;
} tracker;

static int set_up(void **state)
{
	(void)state;
	gazed_place_make(&place);
	snprintf(fifo, sizeof fifo, "%s/fifo", place.directory);
	/* Opened for reading and writing, so that neither end waits for the other. */
	if (mkfifo(fifo, 0600) != 0)
		return -1;
	tracker.fd = open(fifo, O_RDWR | O_CLOEXEC);
	tracker.counter = 0;
	tracker.clock_us = 0;
	return tracker.fd >= 0 ? 0 : -1;
}

static int tear_down(void **state)
{
	(void)state;
	gazed_kill_all();
	close(tracker.fd);
	unlink(fifo);
	gazed_place_remove(&place);
	return 0;
}

static struct gazed_process spawn_with_tracker(void)
{
	const char *const arguments[] = { "--driver", "template",           "--template.path",
					  fifo,       "--template.rate_hz", "500",
					  NULL };
	struct gazed_process process;
	gazed_spawn(&(struct gazed_start) { .place = &place, .arguments = arguments }, &process);
	gazed_wait_ready(&place, &process);
	return process;
}

/* A valid report, @p step_us after the last by the device's clock and 2 ms by ours. */
static void send_report(int32_t step_us)
{
	unsigned char bytes[GZ_TEMPLATE_REPORT_SIZE];
	tracker.clock_us += (uint32_t)step_us;
	struct gz_template_report report = { .counter = tracker.counter++,
					     .clock_us = tracker.clock_us,
					     .found = { true, true },
					     .point = { { 0.5f, 0.5f }, { 0.5f, 0.5f } } };
	template_made_report(&report, bytes);
	assert_int_equal(write(tracker.fd, bytes, sizeof bytes), sizeof bytes);
	gz_clock_sleep_until_ns(gz_clock_now_ns() + 2 * GZ_NS_PER_MS);
}

static struct gz_gaze gaze_of(const struct received *message)
{
	struct gz_gaze gaze = { 0 };
	assert_int_equal(gz_wire_decode_gaze(message->bytes, message->size, &gaze), GZ_OK);
	return gaze;
}

static bool is_gaze(const struct received *message)
{
	return strncmp(message->topic, GZ_TOPIC_GAZE, strlen(GZ_TOPIC_GAZE)) == 0;
}

static void wait_status(struct reader *reader, uint64_t samples)
{
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (reader->status_count == 0 || reader->status.samples < samples) {
		reader_receive(reader, 1000);
		if (gz_clock_now_ns() > deadline_ns)
			fail_msg("%llu samples by the status, waited for %llu",
				 (unsigned long long)reader->status.samples,
				 (unsigned long long)samples);
	}
}

static void gazed_tracker_that_sends_garbage_is_heard_between_it_and_counted(void **state)
{
	(void)state;
	enum { ROUNDS = 100 };
	struct reader reader;
	unsigned char garbage[257];
	unsigned random = 1;
	struct gazed_process gazed = spawn_with_tracker();
	reader_open(&reader, &place, "");
	for (int round = 0; round < ROUNDS; round++) {
		for (size_t i = 0; i < sizeof garbage; i++) {
			random = random * 1664525u + 1013904223u;
			garbage[i] = (unsigned char)(random >> 24);
		}
		size_t size = 1 + (random >> 8) % sizeof garbage;
		assert_int_equal(write(tracker.fd, garbage, size), (ssize_t)size);
		/* Garbage left in the buffer may cost the first report after it. */
		for (int i = 0; i < 3; i++)
			send_report(2000);
	}
	wait_status(&reader, 2 * ROUNDS);
	assert_in_range(reader.status.samples, 2 * ROUNDS, 3 * ROUNDS);
	assert_true(reader.status.malformed[GZ_MALFORMED_SYNTAX] >= ROUNDS / 2);
	assert_int_equal(reader.status.tracker.state, GZ_TRACKER_RUNNING);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	reader_close(&reader);
}

static void gazed_device_clock_that_jumps_or_runs_back_never_turns_the_streams_time(void **state)
{
	(void)state;
	static const int32_t jumps_us[] = { 10000000, -5000000, 0, -2000, 2000000000 };
	enum { BETWEEN = 100, JUMPS = sizeof jumps_us / sizeof *jumps_us };
	struct reader reader;
	struct gazed_process gazed = spawn_with_tracker();
	reader_open(&reader, &place, "");
	while (reader.status_count == 0)
		reader_receive(&reader, 1000);
	for (int jump = 0; jump < JUMPS; jump++) {
		for (int i = 0; i < BETWEEN; i++)
			send_report(2000);
		send_report(jumps_us[jump]);
	}
	for (int i = 0; i < BETWEEN; i++)
		send_report(2000);
	reader_receive_gaze(&reader, JUMPS * (BETWEEN + 1) + BETWEEN);
	int64_t newest_ns = 0;
	uint64_t good = 0;
	for (size_t i = 0; i < reader.count; i++) {
		if (!is_gaze(&reader.messages[i]))
			continue;
		struct gz_gaze gaze = gaze_of(&reader.messages[i]);
		if (gaze.host_ns < newest_ns || gaze.host_ns > gaze.publish_ns)
			fail_msg("sample %llu at %lld, after %lld, sent at %lld",
				 (unsigned long long)gaze.seq, (long long)gaze.host_ns,
				 (long long)newest_ns, (long long)gaze.publish_ns);
		newest_ns = gaze.host_ns;
		good += gaze.confidence > 0;
	}
	/* Each jump may cost some samples with the time of the last one, but not the stream. */
	if (good < JUMPS * (BETWEEN - 10) + BETWEEN)
		fail_msg("%llu good samples of %zu", (unsigned long long)good, reader.gaze_count);
	assert_non_null(strstr(gazed_said(&gazed), "clock jumped"));
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	reader_close(&reader);
}

static void gazed_serves_many_readers_without_a_gap(void **state)
{
	(void)state;
	enum { WANTED = 300 };
	static struct reader readers[READERS];
	struct gazed_process gazed;
	const char *const arguments[] = { "--sim.rate_hz", "250", "--wait-readers", TEXT(READERS),
					  NULL };
	gazed_spawn(&(struct gazed_start) { .place = &place, .arguments = arguments }, &gazed);
	for (int i = 0; i < READERS; i++)
		reader_open(&readers[i], &place, "gaze.");
	for (int i = 0; i < READERS; i++) {
		reader_receive_gaze(&readers[i], WANTED);
		if (readers[i].newest_seq != WANTED - 1)
			fail_msg("reader %d: message %d is of sample %llu", i, WANTED,
				 (unsigned long long)readers[i].newest_seq);
	}
	gazed_request(&place, "t", NULL);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	for (int i = 0; i < READERS; i++)
		reader_close(&readers[i]);
}

/* The daemon greets whom it has let in and closes the others. */
static void wait_until_taken(int fd)
{
	struct pollfd answer = { .fd = fd, .events = POLLIN };
	assert_int_equal(poll(&answer, 1, PATIENCE_MS), 1);
}

/* As many connections as a client might forget to close. Each turn is fewer than may wait at a
 * socket of libzmq (ZMQ_BACKLOG, 100): one beyond that tries again only after a second, and after
 * five seconds the first ones have used up the time of their handshake. */
static void connect_idly(int port, int *sockets, int count)
{
	enum { TURN = 50 };
	struct sockaddr_in address = { .sin_family = AF_INET,
				       .sin_port = htons((uint16_t)port),
				       .sin_addr = { htonl(INADDR_LOOPBACK) } };
	for (int i = 0; i < count; i++) {
		sockets[i] = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
		assert_true(sockets[i] >= 0);
		assert_return_code(connect(sockets[i], (struct sockaddr *)&address, sizeof address),
				   errno);
		if (i % TURN == TURN - 1 || i == count - 1)
			wait_until_taken(sockets[i]);
	}
}

/* Send what a client of ZMTP 3 sends until the daemon takes messages. @param kind  SUB or PUB */
static void shake_hands_as(int fd, const char *kind)
{
	static const unsigned char greeting[64] = { 0xff, 0,    0, 0, 0,   0,   0,   0,
						    1,    0x7f, 3, 0, 'N', 'U', 'L', 'L' };
	char ready[] = "\x04\x19\x05READY\x0bSocket-Type\0\0\0\3...";
	/* READY of an XPUB has 28 bytes, that of a SUB and its subscription have more. */
	unsigned char answer[sizeof greeting + 28];
	memcpy(ready + sizeof ready - 4, kind, 3);
	assert_int_equal(send(fd, greeting, sizeof greeting, MSG_NOSIGNAL), sizeof greeting);
	assert_int_equal(send(fd, ready, sizeof ready - 1, MSG_NOSIGNAL), sizeof ready - 1);
	assert_int_equal(recv(fd, answer, sizeof answer, MSG_WAITALL), sizeof answer);
}

static void shake_hands(int fd)
{
	shake_hands_as(fd, "SUB");
}

/* Subscribe to @p count topics of 200 bytes that nobody else has. The daemon may end the connection
 * meanwhile. */
static void subscribe_strangely(int fd, int connection, int count)
{
	unsigned char frame[2 + 201] = { 0, 201, 1 };
	for (int i = 0; i < count; i++) {
		char topic[32];
		int length = snprintf(topic, sizeof topic, "%d.%d.", connection, i);
		memset(frame + 3, 'x', 200);
		memcpy(frame + 3, topic, (size_t)length);
		if (send(fd, frame, sizeof frame, MSG_NOSIGNAL) < 0)
			return;
	}
}

/* libzmq walks all subscriptions for each connection that ends, in the thread of the stream. */
static void gazed_readers_with_many_strange_subscriptions_are_refused(void **state)
{
	(void)state;
	enum { STRANGERS = 48, EACH = 2, LET_IN_MAX = 16, STATUS_MAX = 20 };
	int strangers[STRANGERS];
	struct reader reader;
	struct gazed_process gazed;
	const char *const arguments[] = { "--control", "tcp://127.0.0.1:*", NULL };
	gazed_spawn(&(struct gazed_start) { .place = &place, .arguments = arguments }, &gazed);
	gazed_wait_ready(&place, &gazed);
	connect_idly(atoi(gazed_request(&place, "SUB_PORT", NULL)), strangers, STRANGERS);
	for (int i = 0; i < STRANGERS; i++) {
		shake_hands(strangers[i]);
		subscribe_strangely(strangers[i], i, EACH);
	}
	for (int i = 0; i < STRANGERS; i++)
		close(strangers[i]);
	reader_open(&reader, &place, "");
	while (reader.status_count == 0 ||
	       reader.status.refused[GZ_REFUSAL_SUBSCRIPTIONS] < STRANGERS - LET_IN_MAX) {
		reader_receive_gaze(&reader, reader.gaze_count + 10);
		assert_true(reader.status_count < STATUS_MAX);
	}
	reader_close(&reader);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	assert_non_null(strstr(gazed_said(&gazed), "sent too many subscriptions"));
}

static int connect_locally(const char *name)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
	snprintf(address.sun_path, sizeof address.sun_path, "%s/%s", place.directory, name);
	assert_true(fd >= 0);
	assert_return_code(connect(fd, (struct sockaddr *)&address, sizeof address), errno);
	return fd;
}

/* Subscribe to new topics until the daemon ends the connection, slowly enough for libzmq to keep
 * up. @return how many were sent */
static int subscribe_until_ended(int fd, int connection, int most)
{
	enum { AT_ONCE = 20 };
	int sent = 0;
	char byte;
	while (sent < most) {
		subscribe_strangely(fd, connection * most + sent, AT_ONCE);
		sent += AT_ONCE;
		ssize_t size = recv(fd, &byte, 1, MSG_DONTWAIT);
		if (size == 0 || (size < 0 && errno != EAGAIN))
			return sent;
		gz_clock_sleep_until_ns(gz_clock_now_ns() + GZ_NS_PER_MS / 10);
	}
	return sent;
}

/* The other test's flood at the local socket, by one program that comes again and again. */
static void gazed_local_flood_of_subscriptions_is_ended(void **state)
{
	(void)state;
	enum { TOPICS = 300000, ENOUGH = 2000, TIMES = 10, MEMORY_KIB = 8192, GAP_MS = 500 };
	struct reader reader;
	struct gazed_process gazed;
	const char *const arguments[] = { NULL };
	gazed_spawn(&(struct gazed_start) { .place = &place, .arguments = arguments }, &gazed);
	gazed_wait_ready(&place, &gazed);
	reader_open(&reader, &place, "");
	reader_receive_gaze(&reader, 10);
	long before_kib = gazed_resident_kib(&gazed);
	for (int i = 0; i < TIMES; i++) {
		int fd = connect_locally("stream");
		shake_hands(fd);
		assert_true(subscribe_until_ended(fd, i, TOPICS) < ENOUGH);
		close(fd);
		/* The stream goes on meanwhile. */
		assert_true(reader_receive(&reader, GAP_MS));
	}
	reader_receive_gaze(&reader, reader.gaze_count + 10);
	while (reader.status.refused[GZ_REFUSAL_SUBSCRIPTIONS] < TIMES)
		assert_true(reader_receive(&reader, 2000));
#if !defined __SANITIZE_ADDRESS__ && !defined __SANITIZE_THREAD__
	assert_in_range(gazed_resident_kib(&gazed), 0, before_kib + MEMORY_KIB);
#else
	(void)before_kib;
#endif
	reader_close(&reader);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	assert_non_null(strstr(gazed_said(&gazed), "at a local socket are closed"));
}

/* Connections that say nothing fill a port only until somebody else comes. */
static void gazed_silent_connections_give_way(void **state)
{
	(void)state;
	enum { SILENT = 256 };
	static int silent[2][SILENT];
	char bytes[64];
	struct gazed_process gazed;
	const char *const arguments[] = { "--control", "tcp://127.0.0.1:*", NULL };
	gazed_spawn(&(struct gazed_start) { .place = &place, .arguments = arguments }, &gazed);
	gazed_wait_ready(&place, &gazed);
	int stream = atoi(gazed_request(&place, "SUB_PORT", NULL));
	int inlet = atoi(gazed_request(&place, "PUB_PORT", NULL));
	connect_idly(stream, silent[0], SILENT);
	connect_idly(inlet, silent[1], SILENT);
	gz_clock_sleep_until_ns(gz_clock_now_ns() + 300 * GZ_NS_PER_MS);
	for (int i = 0; i < 2; i++) {
		static const unsigned char subscription[] = { 0, 6, 1, 'g', 'a', 'z', 'e', '.' };
		int newcomer;
		connect_idly(i == 0 ? stream : inlet, &newcomer, 1);
		shake_hands_as(newcomer, i == 0 ? "SUB" : "PUB");
		assert_int_equal(send(newcomer, subscription, sizeof subscription, MSG_NOSIGNAL),
				 sizeof subscription);
		/* The reader gets gaze, and the client of the inlet a subscription. */
		assert_int_equal(recv(newcomer, bytes, 1, 0), 1);
		/* The oldest one has given way, after the daemon's greeting. */
		while (recv(silent[i][0], bytes, sizeof bytes, 0) > 0)
			;
		assert_true(recv(silent[i][1], bytes, sizeof bytes, 0) > 0);
		assert_int_equal(recv(silent[i][1], bytes, sizeof bytes, MSG_DONTWAIT), -1);
		close(newcomer);
	}
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	for (int i = 0; i < SILENT; i++) {
		close(silent[0][i]);
		close(silent[1][i]);
	}
}

static void gazed_with_more_connections_than_its_soft_limit_of_files_goes_on(void **state)
{
	(void)state;
	enum { SOFT = 100, IDLE = 300 };
	int idle[IDLE];
	struct reader reader;
	struct rlimit before, low;
	struct gazed_process gazed;
	assert_return_code(getrlimit(RLIMIT_NOFILE, &before), errno);
	if (before.rlim_max < 2 * IDLE)
		skip(); /* the limit cannot be raised */
	const char *const arguments[] = { "--control", "tcp://127.0.0.1:*", NULL };
	low = (struct rlimit) { .rlim_cur = SOFT, .rlim_max = before.rlim_max };
	assert_return_code(setrlimit(RLIMIT_NOFILE, &low), errno);
	gazed_spawn(&(struct gazed_start) { .place = &place, .arguments = arguments }, &gazed);
	low.rlim_cur = before.rlim_max < 1024 ? before.rlim_max : 1024;
	assert_return_code(setrlimit(RLIMIT_NOFILE, &low), errno);
	gazed_wait_ready(&place, &gazed);
	connect_idly(atoi(gazed_request(&place, "SUB_PORT", NULL)), idle, IDLE);
	reader_open(&reader, &place, "gaze.");
	reader_receive_gaze(&reader, 100);
	reader_close(&reader);
	assert_string_equal(gazed_request(&place, "R idle", NULL), "OK");
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	for (int i = 0; i < IDLE; i++)
		close(idle[i]);
	assert_return_code(setrlimit(RLIMIT_NOFILE, &before), errno);
}

#define TEST(function) cmocka_unit_test_setup_teardown(function, set_up, tear_down)

TEST_SUITE(faults)
{
	const struct CMUnitTest tests[] = {
		TEST(gazed_tracker_that_sends_garbage_is_heard_between_it_and_counted),
		TEST(gazed_device_clock_that_jumps_or_runs_back_never_turns_the_streams_time),
		TEST(gazed_serves_many_readers_without_a_gap),
		TEST(gazed_with_more_connections_than_its_soft_limit_of_files_goes_on),
		TEST(gazed_readers_with_many_strange_subscriptions_are_refused),
		TEST(gazed_local_flood_of_subscriptions_is_ended),
		TEST(gazed_silent_connections_give_way),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
