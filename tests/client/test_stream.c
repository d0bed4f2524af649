#include "suite.h"

#include "client/stream.h"
#include "publisher.h"

#include <stdio.h>
#include <string.h>
#include <zmq.h>

#include "base/clock.h"
#include "protocol/wire.h"

static struct gz_stream *open_stream(const char *const *topics)
{
	struct gz_stream *stream = NULL;
	assert_int_equal(gz_stream_open(NULL, topics, NULL, &stream), GZ_OK);
	return stream;
}

static const unsigned char empty_map[] = { 0x80 };

/* Send empty maps of @p topic until one arrives, then read the rest of them. */
static void wait_connection(struct publisher *publisher, struct gz_stream *stream,
			    const char *topic)
{
	struct gz_message message;
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	do {
		assert_true(gz_clock_now_ns() < deadline_ns);
		publisher_send(publisher, topic, empty_map, sizeof empty_map);
	} while (gz_stream_read(stream, 10, &message) != GZ_OK);
	/* The last one has another payload. */
	static const unsigned char last[] = { 0x81, 0xa1, 'z', 0x01 };
	publisher_send(publisher, topic, last, sizeof last);
	while (message.size != sizeof last)
		assert_int_equal(gz_stream_read(stream, PATIENCE_MS, &message), GZ_OK);
}

static struct gz_message read_message(struct gz_stream *stream)
{
	struct gz_message message;
	assert_int_equal(gz_stream_read(stream, PATIENCE_MS, &message), GZ_OK);
	return message;
}

static struct gz_stream_counters counters_of(struct gz_stream *stream)
{
	struct gz_stream_counters counters;
	gz_stream_get_counters(stream, &counters);
	return counters;
}

static void send_seq(struct publisher *publisher, uint64_t seq)
{
	struct gz_gaze gaze = gaze_at(seq, 0.5f, 0.5f);
	publisher_send_gaze(publisher, &gaze);
}

static void send_fixation(struct publisher *publisher, uint64_t id)
{
	const struct gz_fixation fixation = { .id = id, .duration_ns = 250 * GZ_NS_PER_MS };
	struct gz_wire_message wire;
	assert_int_equal(gz_wire_encode_fixation(&fixation, &wire), GZ_OK);
	publisher_send(publisher, GZ_TOPIC_FIXATIONS, wire.bytes, wire.size);
}

static void read_without_a_daemon_times_out_in_time(void **state)
{
	(void)state;
	struct gz_stream *stream = open_stream(NULL);
	struct gz_message message = { .size = 77 };
	int64_t start_ns = gz_clock_now_ns();
	assert_int_equal(gz_stream_read(stream, 30, &message), GZ_ERR_TIMEOUT);
	int64_t spent_ns = gz_clock_now_ns() - start_ns;
	assert_in_range(spent_ns, 29 * GZ_NS_PER_MS, 2 * GZ_NS_PER_S);
	assert_int_equal(gz_stream_read(stream, 0, &message), GZ_ERR_TIMEOUT);
	assert_int_equal(gz_stream_read(stream, -1, &message), GZ_ERR_INVAL);
	assert_int_equal(message.size, 77);
	assert_false(counters_of(stream).connected);
	gz_stream_close(&stream);
	assert_null(stream);
	gz_stream_close(&stream);
}

static void open_with_what_is_no_endpoint_is_refused(void **state)
{
	(void)state;
	struct gz_stream *stream = NULL;
	assert_int_equal(gz_stream_open("nonsense", NULL, NULL, &stream), GZ_ERR_INVAL);
	assert_null(stream);
}

static void gaze_arrives_as_it_was_sent(void **state)
{
	(void)state;
	struct publisher publisher;
	struct gz_stream *stream = open_stream(NULL);
	publisher_open(&publisher, "stream");
	wait_connection(&publisher, stream, "sync");
	struct gz_gaze sent = gaze_at(41, 0.25f, 0.5f);
	publisher_send_gaze(&publisher, &sent);
	struct gz_message message = read_message(stream);
	assert_int_equal(message.kind, GZ_MESSAGE_GAZE);
	assert_string_equal(message.topic, GZ_TOPIC_GAZE_BOTH);
	assert_int_equal(message.gaze.seq, 41);
	assert_float_equal(message.gaze.point.x, 0.25f, 1e-6);
	assert_true(message.received_ns >= sent.host_ns);
	gz_stream_close(&stream);
	publisher_close(&publisher);
}

static void every_kind_is_told_by_its_topic(void **state)
{
	(void)state;
	struct publisher publisher;
	struct gz_stream *stream = open_stream(NULL);
	struct gz_wire_message wire;
	publisher_open(&publisher, "stream");
	wait_connection(&publisher, stream, "sync");

	send_fixation(&publisher, 9);
	const struct gz_blink blink = { .onset = true, .time_ns = 5 * GZ_NS_PER_S };
	assert_int_equal(gz_wire_encode_blink(&blink, &wire), GZ_OK);
	publisher_send(&publisher, GZ_TOPIC_BLINKS, wire.bytes, wire.size);
	const struct gz_saccade saccade = { .amplitude_deg = 12 };
	assert_int_equal(gz_wire_encode_saccade(&saccade, &wire), GZ_OK);
	publisher_send(&publisher, GZ_TOPIC_SACCADES, wire.bytes, wire.size);
	struct gz_status status = { .samples = 1234 };
	assert_int_equal(gz_wire_encode_status(&status, &wire), GZ_OK);
	publisher_send(&publisher, GZ_TOPIC_STATUS, wire.bytes, wire.size);
	publisher_send(&publisher, "surfaces.screen", empty_map, sizeof empty_map);

	struct gz_message message = read_message(stream);
	assert_int_equal(message.kind, GZ_MESSAGE_FIXATION);
	assert_int_equal(message.fixation.id, 9);
	assert_int_equal(message.fixation.duration_ns, 250 * GZ_NS_PER_MS);
	message = read_message(stream);
	assert_int_equal(message.kind, GZ_MESSAGE_BLINK);
	assert_true(message.blink.onset);
	message = read_message(stream);
	assert_int_equal(message.kind, GZ_MESSAGE_SACCADE);
	assert_float_equal(message.saccade.amplitude_deg, 12, 1e-6);
	message = read_message(stream);
	assert_int_equal(message.kind, GZ_MESSAGE_STATUS);
	assert_int_equal(message.status.samples, 1234);
	message = read_message(stream);
	assert_int_equal(message.kind, GZ_MESSAGE_OTHER);
	assert_string_equal(message.topic, "surfaces.screen");
	assert_int_equal(message.size, sizeof empty_map);
	assert_memory_equal(message.bytes, empty_map, sizeof empty_map);
	gz_stream_close(&stream);
	publisher_close(&publisher);
}

static void topics_leave_the_rest_out(void **state)
{
	(void)state;
	static const char *const topics[] = { "fixations", "sync", NULL };
	struct publisher publisher;
	struct gz_stream *stream = open_stream(topics);
	publisher_open(&publisher, "stream");
	wait_connection(&publisher, stream, "sync");
	send_seq(&publisher, 1);
	publisher_send(&publisher, "surfaces.x", empty_map, sizeof empty_map);
	send_fixation(&publisher, 9);
	assert_int_equal(read_message(stream).kind, GZ_MESSAGE_FIXATION);
	gz_stream_close(&stream);
	publisher_close(&publisher);
}

static void gaps_in_the_numbers_are_counted(void **state)
{
	(void)state;
	static const uint64_t sent[] = { 10, 11, 14, 15, 16, 26 };
	static const uint64_t lost[] = { 0, 0, 2, 0, 0, 9 };
	struct publisher publisher;
	struct gz_stream *stream = open_stream(NULL);
	publisher_open(&publisher, "stream");
	wait_connection(&publisher, stream, "sync");
	for (size_t i = 0; i < sizeof sent / sizeof sent[0]; i++) {
		send_seq(&publisher, sent[i]);
		struct gz_message message = read_message(stream);
		assert_int_equal(message.gaze.seq, sent[i]);
		assert_int_equal(message.lost, lost[i]);
	}
	assert_int_equal(counters_of(stream).lost, 11);
	gz_stream_close(&stream);
	publisher_close(&publisher);
}

static void numbers_that_begin_again_are_no_loss(void **state)
{
	(void)state;
	static const uint64_t sent[] = { 1000, 0, 1, 1, 2 };
	struct publisher publisher;
	struct gz_stream *stream = open_stream(NULL);
	publisher_open(&publisher, "stream");
	wait_connection(&publisher, stream, "sync");
	for (size_t i = 0; i < sizeof sent / sizeof sent[0]; i++) {
		send_seq(&publisher, sent[i]);
		assert_int_equal(read_message(stream).gaze.seq, sent[i]);
	}
	assert_int_equal(counters_of(stream).lost, 0);
	gz_stream_close(&stream);
	publisher_close(&publisher);
}

static void topics_that_leave_gaze_out_count_no_loss(void **state)
{
	(void)state;
	static const char *const topics[] = { GZ_TOPIC_GAZE_BOTH, "sync", NULL };
	struct publisher publisher;
	struct gz_stream *stream = open_stream(topics);
	publisher_open(&publisher, "stream");
	wait_connection(&publisher, stream, "sync");
	send_seq(&publisher, 1);
	send_seq(&publisher, 9); /* those in between may have been of one eye */
	assert_int_equal(read_message(stream).gaze.seq, 1);
	struct gz_message message = read_message(stream);
	assert_int_equal(message.gaze.seq, 9);
	assert_int_equal(message.lost, 0);
	assert_int_equal(counters_of(stream).lost, 0);
	gz_stream_close(&stream);
	publisher_close(&publisher);
}

static void killed_daemon_that_returns_is_read_again_without_loss(void **state)
{
	(void)state;
	struct gz_stream *stream = open_stream(NULL);
	pid_t process = publisher_process_start("stream", 1);
	read_message(stream);
	publisher_process_kill(process);
	struct gz_message message;
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (gz_stream_read(stream, 5, &message) == GZ_OK || counters_of(stream).connected)
		assert_true(gz_clock_now_ns() < deadline_ns);
	/* Its numbers may be above those of the one that ended. */
	process = publisher_process_start("stream", 1000000);
	message = read_message(stream);
	publisher_process_kill(process);
	assert_true(message.gaze.seq >= 1000000);
	assert_int_equal(counters_of(stream).lost, 0);
	assert_int_equal(counters_of(stream).connections, 2);
	gz_stream_close(&stream);
}

static void send_malformed(struct publisher *publisher)
{
	char long_topic[GZ_NAME_SIZE + 1];
	memset(long_topic, 'a', sizeof long_topic - 1);
	long_topic[sizeof long_topic - 1] = '\0';
	static const unsigned char cut[] = { 0xdf, 0xff, 0xff, 0xff, 0xff };

	publisher_send_frame(publisher, "gaze.3d.01.", 11);  /* one frame */
	publisher_send(publisher, long_topic, empty_map, 1); /* a topic that is too long */
	publisher_send(publisher, GZ_TOPIC_GAZE_BOTH, cut, sizeof cut); /* a cut payload */
	publisher_send(publisher, "surfaces.x", cut, sizeof cut);       /* of other kinds too */
	publisher_send(publisher, GZ_TOPIC_STATUS, "", 0);              /* no payload */
	zmq_send(publisher->socket, "ga\0ze", 5, ZMQ_SNDMORE);          /* a NUL in the topic */
	publisher_send_frame(publisher, empty_map, 1);
	zmq_send(publisher->socket, "fixations", 9, ZMQ_SNDMORE); /* three frames */
	publisher_send(publisher, "x", empty_map, 1);
}

static void malformed_messages_are_counted_and_left_out(void **state)
{
	(void)state;
	struct publisher publisher;
	struct gz_stream *stream = open_stream(NULL);
	publisher_open(&publisher, "stream");
	wait_connection(&publisher, stream, "sync");
	send_malformed(&publisher);
	send_seq(&publisher, 3);
	struct gz_message message = read_message(stream);
	assert_int_equal(message.kind, GZ_MESSAGE_GAZE);
	assert_int_equal(message.gaze.seq, 3);
	assert_int_equal(counters_of(stream).malformed, 7);
	gz_stream_close(&stream);
	publisher_close(&publisher);
}

TEST_SUITE(stream)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(read_without_a_daemon_times_out_in_time),
		cmocka_unit_test(open_with_what_is_no_endpoint_is_refused),
		cmocka_unit_test(gaze_arrives_as_it_was_sent),
		cmocka_unit_test(every_kind_is_told_by_its_topic),
		cmocka_unit_test(topics_leave_the_rest_out),
		cmocka_unit_test(gaps_in_the_numbers_are_counted),
		cmocka_unit_test(numbers_that_begin_again_are_no_loss),
		cmocka_unit_test(topics_that_leave_gaze_out_count_no_loss),
		cmocka_unit_test(killed_daemon_that_returns_is_read_again_without_loss),
		cmocka_unit_test(malformed_messages_are_counted_and_left_out),
	};
	return cmocka_run_group_tests(tests, runtime_directory_make, runtime_directory_remove);
}
