/* The daemon as its users meet it: a process, its sockets, its signals and its files. */
#include "suite.h"

#include <arpa/inet.h>
#include <math.h>
#include <netinet/in.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zmq.h>

#include "base/clock.h"
#include "client/viewer_link.h"
#include "gazed_process.h"
#include "lsl_stand_in.h"
#include "protocol/gaze_log.h"
#include "protocol/wire.h"

static struct gazed_place place;

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
	return 0;
}

static struct gazed_process spawn(const char *const *arguments)
{
	struct gazed_process process;
	gazed_spawn(&(struct gazed_start) { .place = &place, .arguments = arguments }, &process);
	return process;
}

#define SPAWN(...) spawn((const char *const[]) { __VA_ARGS__, NULL })

/* The content of a log, and how it ended. */
struct found {
	uint64_t samples, first_seq, last_seq;
	enum gz_gaze_log_ending ending;
};

static struct found read_log(const char *name)
{
	char path[256];
	struct gz_gaze_log_reader *reader = NULL;
	struct gz_gaze_log_record record;
	struct found found = { 0 };
	enum gz_result result;
	snprintf(path, sizeof path, "%s/%s", place.recordings, name);
	assert_int_equal(gz_gaze_log_open(path, NULL, &reader), GZ_OK);
	while ((result = gz_gaze_log_read(reader, &record)) == GZ_OK) {
		if (record.kind != GZ_GAZE_LOG_SAMPLE)
			continue;
		if (found.samples++ == 0)
			found.first_seq = record.sample.seq;
		found.last_seq = record.sample.seq;
	}
	assert_int_equal(result, GZ_ERR_END);
	found.ending = gz_gaze_log_ending(reader);
	gz_gaze_log_close(&reader);
	return found;
}

static void gazed_starts_at_once_and_ends_cleanly_on_each_signal(void **state)
{
	(void)state;
	const int signals[] = { SIGTERM, SIGINT, SIGHUP };
	for (size_t i = 0; i < 3; i++) {
		int64_t begin_ns = gz_clock_now_ns();
		struct gazed_process gazed = SPAWN("--driver", "sim");
		gazed_wait_ready(&place, &gazed);
		double ready_ms = gz_ns_to_ms(gz_clock_now_ns() - begin_ns);
		print_message("           answers after %.0f ms\n", ready_ms);
		assert_true(ready_ms < 2000 * SLOWNESS);
		assert_int_equal(gazed_stop(&gazed, signals[i]), 0);
	}
}

static void gazed_answers_every_letter_within_100_ms(void **state)
{
	(void)state;
	static const char *const requests[][2] = {
		{ "v", GAZECAST_VERSION },
		{ "T 5", "the time is this machine's monotonic clock, which cannot be set; read it "
			 "with t and keep the difference" },
		{ "C", "this tracker is calibrated by its own software, not by gazed" },
		{ "c", "this tracker is calibrated by its own software, not by gazed" },
		{ "bogus", "unknown command" },
		{ "", "unknown command" },
		{ "r", "no recording is running" },
		{ "R ../x",
		  "this is not a valid name for a recording; allowed: 1 to 64 of A-Z a-z 0-9 . _ "
		  "-" },
		{ "R one", "OK" },
		{ "R two", "a recording is running; end it first (gazectl stop, or r)" },
		{ "r", "OK" },
		{ "R", "OK" },
		{ "r", "OK" },
	};
	const size_t count = sizeof requests / sizeof *requests;
	size_t late = 0;
	struct gazed_process gazed = SPAWN("--sim.rate_hz", "1200");
	gazed_wait_ready(&place, &gazed);
	for (size_t i = 0; i < count; i++) {
		double ms;
		const char *answer = gazed_request(&place, requests[i][0], &ms);
		/* The disk may take long to sync. */
		while (strstr(answer, "still being written"))
			answer = gazed_request(&place, requests[i][0], &ms);
		assert_string_equal(answer, requests[i][1]);
		late += ms > 100 * SLOWNESS;
	}
	/* On a machine that is busy with other tests a few answers may be late. */
	if (late > count / 4)
		fail_msg("%zu of %zu answers took more than 100 ms", late, count);
	double seconds = atof(gazed_request(&place, "t", NULL));
	assert_true(fabs(seconds - gz_ns_to_s(gz_clock_now_ns())) < 1);
	assert_non_null(strstr(gazed_request(&place, "SUB_PORT", NULL), "/stream"));
	assert_non_null(strstr(gazed_request(&place, "LATEST_PORT", NULL), "/latest"));
	assert_non_null(strstr(gazed_request(&place, "PUB_PORT", NULL), "/inlet"));
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	assert_int_equal(read_log("one.gzl").ending, GZ_GAZE_LOG_WHOLE);
}

static void gazed_ports_of_tcp_lead_to_the_stream(void **state)
{
	(void)state;
	struct gazed_process gazed = SPAWN("--control", "tcp://127.0.0.1:*");
	gazed_wait_ready(&place, &gazed);
	int port = atoi(gazed_request(&place, "SUB_PORT", NULL));
	assert_in_range(port, 1024, 65535);
	char endpoint[64], topic[80];
	void *context = zmq_ctx_new(), *socket = zmq_socket(context, ZMQ_SUB);
	int timeout_ms = PATIENCE_MS, linger = 0;
	snprintf(endpoint, sizeof endpoint, "tcp://127.0.0.1:%d", port);
	zmq_setsockopt(socket, ZMQ_SUBSCRIBE, "gaze.", 5);
	zmq_setsockopt(socket, ZMQ_RCVTIMEO, &timeout_ms, sizeof timeout_ms);
	zmq_setsockopt(socket, ZMQ_LINGER, &linger, sizeof linger);
	assert_int_equal(zmq_connect(socket, endpoint), 0);
	int length = zmq_recv(socket, topic, sizeof topic, 0);
	zmq_close(socket);
	zmq_ctx_term(context);
	assert_true(length > 8);
	assert_memory_equal(topic, "gaze.3d.", 8);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
}

static size_t count_topic(const struct reader *reader, const char *topic)
{
	size_t count = 0;
	for (size_t i = 0; i < reader->count; i++)
		count += strcmp(reader->messages[i].topic, topic) == 0;
	return count;
}

/* From its first surface on, a reader gets one for each gaze. The daemon makes surfaces once it has
 * looked at the reader's subscriptions, when libzmq may have sent some gaze already. */
static void expect_surface_of_each_gaze(const struct reader *reader, const char *topic)
{
	size_t before = 0, gaze = 0, surfaces = 0;
	for (size_t i = 0; i < reader->count; i++) {
		surfaces += strcmp(reader->messages[i].topic, topic) == 0;
		if (strncmp(reader->messages[i].topic, "gaze.", 5) == 0)
			*(surfaces > 0 ? &gaze : &before) += 1;
	}
	print_message("           %s: %zu for %zu gaze messages, after %zu\n", topic, surfaces,
		      gaze, before);
	assert_in_range(before, 1, reader->gaze_count / 10);
	/* The first surface has its gaze before it; those of the last gaze may not have come. */
	assert_in_range(surfaces, gaze, gaze + 1);
}

static void gazed_stream_carries_every_topic_and_the_status(void **state)
{
	(void)state;
	struct reader reader;
	struct gazed_process gazed =
		SPAWN("--sim.rate_hz", "500", "--stream.surfaces", "screen other");
	reader_open(&reader, &place, "");
	reader_receive_gaze(&reader, 1200);
	expect_surface_of_each_gaze(&reader, "surfaces.screen");
	expect_surface_of_each_gaze(&reader, "surfaces.other");
	assert_true(count_topic(&reader, "fixations") > 5);
	assert_true(count_topic(&reader, "saccades") > 0);
	assert_true(reader.status_count >= 2);
	const struct gz_status *status = &reader.status;
	assert_string_equal(status->tracker.name, "sim");
	assert_int_equal(status->tracker.state, GZ_TRACKER_RUNNING);
	assert_true(status->rate_hz_nominal == 500);
	assert_true(status->rate_hz_measured > 250 && status->rate_hz_measured < 600);
	assert_true(status->samples > 500);
	assert_int_equal(status->subscribers, 1);
	assert_string_equal(status->version, GAZECAST_VERSION);
	assert_int_equal(status->recording.state, GZ_RECORDING_OFF);
	assert_int_equal(status->clock.tick, GZ_CLOCK_DECLARED);
	assert_true(gz_display_valid(&status->display));
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	reader_close(&reader);
}

static void gazed_newcomers_do_not_wait_for_the_next_second_s_status(void **state)
{
	(void)state;
	enum { NEWCOMERS = 12 };
	struct gazed_process gazed = SPAWN("--driver", "sim");
	gazed_wait_ready(&place, &gazed);
	int64_t begin_ns = gz_clock_now_ns();
	for (int i = 0; i < NEWCOMERS; i++) {
		struct reader reader;
		reader_open(&reader, &place, GZ_TOPIC_STATUS);
		assert_true(reader_receive(&reader, PATIENCE_MS));
		reader_close(&reader);
	}
	/* Otherwise each would wait for most of a second on average. */
	double seconds = gz_ns_to_s(gz_clock_now_ns() - begin_ns);
	if (seconds > NEWCOMERS / 2.0 * SLOWNESS)
		fail_msg("%d newcomers waited %.1f s", NEWCOMERS, seconds);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
}

static void gazed_latest_is_one_frame_and_the_newest(void **state)
{
	(void)state;
	struct gazed_process gazed = SPAWN("--sim.rate_hz", "1000");
	char endpoint[128];
	unsigned char bytes[GZ_WIRE_MESSAGE_SIZE];
	void *context = zmq_ctx_new(), *socket = zmq_socket(context, ZMQ_SUB);
	int timeout_ms = PATIENCE_MS, linger = 0, conflate = 1, more;
	size_t more_size = sizeof more;
	snprintf(endpoint, sizeof endpoint, "ipc://%s/latest", place.directory);
	zmq_setsockopt(socket, ZMQ_CONFLATE, &conflate, sizeof conflate);
	zmq_setsockopt(socket, ZMQ_SUBSCRIBE, "", 0);
	zmq_setsockopt(socket, ZMQ_RCVTIMEO, &timeout_ms, sizeof timeout_ms);
	zmq_setsockopt(socket, ZMQ_LINGER, &linger, sizeof linger);
	gazed_wait_ready(&place, &gazed);
	assert_int_equal(zmq_connect(socket, endpoint), 0);
	struct gz_gaze gaze, last = { 0 };
	for (int i = 0; i < 20; i++) {
		int size = zmq_recv(socket, bytes, sizeof bytes, 0);
		assert_true(size > 0);
		zmq_getsockopt(socket, ZMQ_RCVMORE, &more, &more_size);
		assert_int_equal(more, 0);
		assert_int_equal(gz_wire_decode_gaze(bytes, (size_t)size, &gaze), GZ_OK);
		assert_true(i == 0 || gaze.seq > last.seq);
		assert_true(gz_clock_now_ns() - gaze.publish_ns < SLOWNESS * GZ_NS_PER_S);
		last = gaze;
		/* A reader slower than the tracker still gets the newest gaze. */
		gz_clock_sleep_until_ns(gz_clock_now_ns() + 5 * GZ_NS_PER_MS);
	}
	zmq_close(socket);
	zmq_ctx_term(context);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
}

/* The next message of the pipeline from @p i on: neither a status nor a notification, nor a
 * viewer's window, nor what only the end of a replay has. */
static size_t skip_others(const struct reader *reader, size_t i)
{
	while (i < reader->count && (strcmp(reader->messages[i].topic, "status") == 0 ||
				     strcmp(reader->messages[i].topic, "event_final") == 0 ||
				     strcmp(reader->messages[i].topic, GZ_TOPIC_WINDOW) == 0 ||
				     strncmp(reader->messages[i].topic, "notify.", 7) == 0))
		i++;
	return i;
}

/* The index of the gaze message of sample @p seq, from index @p from on. */
static size_t find_gaze(const struct reader *reader, size_t from, uint64_t seq)
{
	for (size_t i = from; i < reader->count; i++) {
		const struct received *message = &reader->messages[i];
		struct gz_gaze gaze;
		if (strncmp(message->topic, "gaze.", 5) == 0 &&
		    gz_wire_decode_gaze(message->bytes, message->size, &gaze) == GZ_OK &&
		    gaze.seq == seq)
			return i;
	}
	fail_msg("no gaze of sample %llu", (unsigned long long)seq);
	return 0;
}

static bool same_message(const struct received *a, const struct received *b)
{
	size_t ignored = strncmp(a->topic, "gaze.", 5) == 0 ? GZ_WIRE_PUBLISH_SIZE : 0;
	return strcmp(a->topic, b->topic) == 0 && a->size == b->size &&
	       memcmp(a->bytes, b->bytes, a->size - ignored) == 0;
}

/* Compare all messages of the pipeline in @p replay with those in @p live from index @p from on. */
static void compare(const struct reader *live, size_t from, const struct reader *replay)
{
	size_t a = skip_others(live, from), b = skip_others(replay, 0), compared = 0;
	while (b < replay->count) {
		if (a == live->count)
			fail_msg("the live stream ends after %zu messages, before %s", compared,
				 replay->messages[b].topic);
		if (!same_message(&live->messages[a], &replay->messages[b]))
			fail_msg("message %zu differs: %s and %s", compared,
				 live->messages[a].topic, replay->messages[b].topic);
		compared++;
		a = skip_others(live, a + 1);
		b = skip_others(replay, b + 1);
	}
	print_message("           %zu messages are the same\n", compared);
}

/* Replay @p name and keep all messages. */
static void replay_log(const char *name, struct reader *reader)
{
	char path[256];
	snprintf(path, sizeof path, "%s/%s", place.recordings, name);
	reader_open(reader, &place, "");
	struct gazed_process gazed =
		SPAWN("--driver", "replay", "--replay.file", path, "--replay.speed", "4",
		      "--wait-readers", "1", "--exit-at-end");
	while (reader->status_count == 0 || reader->status.tracker.state != GZ_TRACKER_ENDED)
		assert_true(reader_receive(reader, PATIENCE_MS));
	assert_int_equal(gazed_wait_exit(&gazed), 0);
	reader_drain(reader, 100 * SLOWNESS);
}

static void gazed_replay_gives_the_live_messages_bit_for_bit(void **state)
{
	(void)state;
	struct reader live, replay;
	reader_open(&live, &place, "");
	struct gazed_process gazed =
		SPAWN("--sim.rate_hz", "500", "--wait-readers", "1", "--record", "live",
		      "--pipeline.margin", "0.2", "--display.distance_mm", "650");
	reader_receive_gaze(&live, 1500);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	struct found found = read_log("live.gzl");
	reader_receive_gaze(&live, found.samples);
	reader_drain(&live, 100 * SLOWNESS);
	reader_hang_up(&live);
	assert_int_equal(found.ending, GZ_GAZE_LOG_WHOLE);
	assert_int_equal(found.samples, live.gaze_count);
	replay_log("live.gzl", &replay);
	assert_int_equal(replay.gaze_count, live.gaze_count);
	compare(&live, 0, &replay);
	/* Conversely, the live stream had no more messages. */
	compare(&replay, 0, &live);
	assert_true(count_topic(&replay, "event_final") > 0);
	assert_int_equal(count_topic(&live, "event_final"), 0);
	reader_close(&live);
	reader_close(&replay);
}

static void gazed_recording_begun_in_mid_stream_replays_bit_for_bit(void **state)
{
	(void)state;
	struct reader live, replay;
	struct gazed_process gazed = SPAWN("--sim.rate_hz", "500");
	reader_open(&live, &place, "");
	reader_receive_gaze(&live, 400);
	assert_string_equal(gazed_request(&place, "R middle", NULL), "OK");
	reader_receive_gaze(&live, 1400);
	assert_string_equal(gazed_request(&place, "r", NULL), "OK");
	struct found found = read_log("middle.gzl"); /* complete when the answer comes */
	reader_receive_gaze(&live, live.gaze_count + 600);
	assert_int_equal(gazed_stop(&gazed, SIGINT), 0);
	reader_drain(&live, 100 * SLOWNESS);
	reader_hang_up(&live);
	assert_int_equal(found.ending, GZ_GAZE_LOG_WHOLE);
	assert_true(found.first_seq > 300 && found.samples > 800);
	replay_log("middle.gzl", &replay);
	assert_int_equal(replay.gaze_count, found.samples);
	compare(&live, find_gaze(&live, 0, found.first_seq), &replay);
	reader_close(&live);
	reader_close(&replay);
}

/* Report a window whose scene is still or moves until the status says so. */
static void show_scene(struct reader *live, struct gz_viewer_link *link, bool still)
{
	static const int rect_px[4] = { 0, 0, 640, 480 };
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	gz_viewer_link_scene(link, still);
	do {
		gz_viewer_link_window(link, rect_px, gz_clock_now_ns());
		reader_receive(live, 20);
		assert_true(gz_clock_now_ns() < deadline_ns);
	} while (live->status_count == 0 || live->status.still_scene != still);
}

/* Samples of a log that are in a still scene, and pursuits among the messages about them. */
static void count_still(const char *name, const struct reader *reader, size_t *out_still,
			size_t *out_pursuits)
{
	char path[256];
	struct gz_gaze_log_reader *log;
	struct gz_gaze_log_record record;
	struct gz_gaze gaze;
	snprintf(path, sizeof path, "%s/%s", place.recordings, name);
	assert_int_equal(gz_gaze_log_open(path, NULL, &log), GZ_OK);
	size_t at = 0;
	*out_still = *out_pursuits = 0;
	while (gz_gaze_log_read(log, &record) == GZ_OK) {
		if (record.kind != GZ_GAZE_LOG_SAMPLE || !record.sample.still_scene)
			continue;
		at = find_gaze(reader, at, record.sample.seq);
		const struct received *message = &reader->messages[at];
		assert_int_equal(gz_wire_decode_gaze(message->bytes, message->size, &gaze), GZ_OK);
		++*out_still;
		*out_pursuits += gaze.event == GZ_EVENT_PURSUIT;
	}
	gz_gaze_log_close(&log);
}

static void scene_that_becomes_still_in_mid_recording_replays_bit_for_bit(void **state)
{
	(void)state;
	char latest[128];
	struct reader live, replay;
	struct gz_viewer_link *link;
	size_t still, pursuits;
	reader_open(&live, &place, "");
	struct gazed_process gazed = SPAWN("--sim.rate_hz", "500", "--sim.pursuits_per_min", "60",
					   "--wait-readers", "1", "--record", "scene");
	snprintf(latest, sizeof latest, "ipc://%s/latest", place.directory);
	assert_int_equal(gz_viewer_link_open(latest, NULL, &link), GZ_OK);
	show_scene(&live, link, true);
	reader_receive_gaze(&live, live.gaze_count + 500);
	assert_true(live.status.still_scene);
	show_scene(&live, link, false);
	reader_receive_gaze(&live, live.gaze_count + 200);
	gz_viewer_link_close(&link);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	struct found found = read_log("scene.gzl");
	reader_receive_gaze(&live, found.samples);
	reader_drain(&live, 100 * SLOWNESS);
	reader_hang_up(&live);
	count_still("scene.gzl", &live, &still, &pursuits);
	assert_true(still >= 500 && still < found.samples);
	assert_int_equal(pursuits, 0);
	replay_log("scene.gzl", &replay);
	assert_int_equal(replay.gaze_count, found.samples);
	compare(&live, 0, &replay);
	reader_close(&live);
	reader_close(&replay);
}

static void viewers_may_be_forbidden_to_say_that_a_scene_is_still(void **state)
{
	(void)state;
	static const int rect_px[4] = { 0, 0, 640, 480 };
	char latest[128];
	struct reader live;
	struct gz_viewer_link *link;
	reader_open(&live, &place, "");
	struct gazed_process gazed = SPAWN("--viewers.still_scene=false");
	snprintf(latest, sizeof latest, "ipc://%s/latest", place.directory);
	assert_int_equal(gz_viewer_link_open(latest, NULL, &link), GZ_OK);
	gz_viewer_link_scene(link, true);
	/* The window has come when it is forwarded; a status that is sent after it knows it. */
	for (int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	     count_topic(&live, GZ_TOPIC_WINDOW) == 0;) {
		gz_viewer_link_window(link, rect_px, gz_clock_now_ns());
		reader_receive(&live, 20);
		assert_true(gz_clock_now_ns() < deadline_ns);
	}
	for (size_t before = live.status_count; live.status_count < before + 2;)
		assert_true(reader_receive(&live, PATIENCE_MS));
	assert_false(live.status.still_scene);
	gz_viewer_link_close(&link);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	reader_close(&live);
}

static size_t count_marks(const char *name, const char *text)
{
	char path[256];
	struct gz_gaze_log_reader *reader = NULL;
	struct gz_gaze_log_record record;
	size_t count = 0;
	snprintf(path, sizeof path, "%s/%s", place.recordings, name);
	assert_int_equal(gz_gaze_log_open(path, NULL, &reader), GZ_OK);
	while (gz_gaze_log_read(reader, &record) == GZ_OK)
		count += record.kind == GZ_GAZE_LOG_MARK && strcmp(record.text, text) == 0;
	gz_gaze_log_close(&reader);
	return count;
}

/* Send a forged gaze, which the daemon drops, and then the annotation "go"; wait until it comes
 * back. */
static void annotate(struct reader *reader)
{
	static const char go[] = "\x81\xa5label\xa2go"; /* {"label": "go"} */
	char endpoint[128];
	snprintf(endpoint, sizeof endpoint, "ipc://%s/inlet", place.directory);
	void *context = zmq_ctx_new(), *socket = zmq_socket(context, ZMQ_XPUB);
	int timeout_ms = PATIENCE_MS;
	unsigned char subscription[8];
	zmq_setsockopt(socket, ZMQ_RCVTIMEO, &timeout_ms, sizeof timeout_ms);
	assert_int_equal(zmq_connect(socket, endpoint), 0);
	/* Messages sent before the daemon has subscribed would be lost. */
	assert_true(zmq_recv(socket, subscription, sizeof subscription, 0) >= 0);
	zmq_send(socket, "gaze.forged", 11, ZMQ_SNDMORE);
	zmq_send(socket, go, sizeof go - 1, 0);
	zmq_send(socket, "annotation", 10, ZMQ_SNDMORE);
	zmq_send(socket, go, sizeof go - 1, 0);
	while (count_topic(reader, "annotation") == 0)
		assert_true(reader_receive(reader, PATIENCE_MS));
	zmq_close(socket);
	zmq_ctx_term(context);
}

static void gazed_annotation_is_marked_in_the_log_and_sent_to_all_readers(void **state)
{
	(void)state;
	struct reader reader;
	struct gazed_process gazed =
		SPAWN("--sim.rate_hz", "500", "--wait-readers", "1", "--record", "marked");
	reader_open(&reader, &place, "");
	reader_receive_gaze(&reader, 10);
	annotate(&reader);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	assert_int_equal(count_topic(&reader, "gaze.forged"), 0);
	assert_non_null(strstr(gazed_said(&gazed), "reserved for the daemon"));
	assert_int_equal(count_marks("marked.gzl", "go"), 1);
	reader_close(&reader);
}

/* The sum of the numbers behind @p what in the file that the fake liblsl writes. */
static int sum_of_lsl(const char *path, const char *what)
{
	char line[256];
	int sum = 0;
	FILE *file = fopen(path, "r");
	assert_non_null(file);
	while (fgets(line, sizeof line, file)) {
		char *number = strrchr(line, ' ');
		if (!number || (size_t)(number - line) != strlen(what) ||
		    strncmp(line, what, strlen(what)) != 0)
			continue;
		sum += (int)strtol(number, NULL, 10);
	}
	fclose(file);
	return sum;
}

static void gazed_lsl_readers_get_every_sample_event_and_annotation(void **state)
{
	(void)state;
	char path[128];
	struct reader reader;
	snprintf(path, sizeof path, "%s/lsl", place.recordings);
	setenv(LSL_STAND_IN_FILE, path, 1);
	struct gazed_process gazed =
		SPAWN("--sim.rate_hz", "500", "--wait-readers", "1", "--record", "beside",
		      "--lsl.outlet", "--lsl.library", LSL_STAND_IN);
	unsetenv(LSL_STAND_IN_FILE);
	reader_open(&reader, &place, "");
	reader_receive_gaze(&reader, 1000);
	annotate(&reader);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	assert_int_equal(sum_of_lsl(path, "Gaze"), read_log("beside.gzl").samples);
	assert_int_equal(sum_of_lsl(path, "go"), 1);
	int onsets = sum_of_lsl(path, "fixation_onset");
	assert_in_range(onsets, 3, 20); /* in two seconds */
	assert_in_range(sum_of_lsl(path, "fixation_offset"), onsets - 1, onsets);
	assert_true(sum_of_lsl(path, "saccade_onset") > 0);
	assert_true(reader.status.refused[GZ_REFUSAL_LSL] == 0);
	reader_close(&reader);
}

static void gazed_second_one_in_a_directory_is_refused_and_harms_nothing(void **state)
{
	(void)state;
	struct reader reader;
	struct gazed_process first = SPAWN("--driver", "sim");
	gazed_wait_ready(&place, &first);
	struct gazed_process second = SPAWN("--driver", "sim");
	assert_int_equal(gazed_wait_exit(&second), 1);
	assert_non_null(strstr(gazed_said(&second), "already uses"));
	assert_non_null(strstr(gazed_said(&second), "GAZECAST_RUNTIME_DIR"));
	reader_open(&reader, &place, "gaze.");
	reader_receive_gaze(&reader, 10);
	reader_close(&reader);
	assert_int_equal(gazed_stop(&first, SIGTERM), 0);
	/* The directory is free again. */
	struct gazed_process third = SPAWN("--driver", "sim");
	gazed_wait_ready(&place, &third);
	assert_int_equal(gazed_stop(&third, SIGTERM), 0);
}

static void gazed_taken_endpoint_is_refused_with_the_remedy(void **state)
{
	(void)state;
	struct sockaddr_in address = { .sin_family = AF_INET,
				       .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
	socklen_t size = sizeof address;
	char endpoint[64];
	int taken = socket(AF_INET, SOCK_STREAM, 0);
	assert_int_equal(bind(taken, (struct sockaddr *)&address, sizeof address), 0);
	assert_int_equal(listen(taken, 1), 0);
	assert_int_equal(getsockname(taken, (struct sockaddr *)&address, &size), 0);
	snprintf(endpoint, sizeof endpoint, "tcp://127.0.0.1:%d", ntohs(address.sin_port));
	struct gazed_process gazed = SPAWN("--control", endpoint);
	assert_int_equal(gazed_wait_exit(&gazed), 1);
	close(taken);
	const char *said = gazed_said(&gazed);
	assert_non_null(strstr(said, endpoint));
	assert_non_null(strstr(said, "is in use"));
	assert_non_null(strstr(said, "--tcp off"));
	assert_ptr_equal(strchr(said, '\n'), said + strlen(said) - 1); /* one line */
}

static void gazed_refuses_bad_configuration_in_one_line(void **state)
{
	(void)state;
	char path[128];
	snprintf(path, sizeof path, "%s/bad.conf", place.directory);
	FILE *file = fopen(path, "w");
	fputs("[tracker]\ndriver = sim\n[sim]\nrate_hz = many\n", file);
	fclose(file);
	const char *const refusals[][3] = {
		{ "--bogus", "1", "--bogus: unknown option" },
		{ "--config", path, "bad.conf:4: sim.rate_hz: many" },
		{ "--driver", "replay", "--replay.file" },
		{ "--record", "a/b", "this is not a valid name" },
		{ "--sim.targets", "/nonexistent", "/nonexistent" },
		{ "--lsl.outlet", "--lsl.library=/nonexistent.so", "lsl.outlet: /nonexistent.so" },
	};
	for (size_t i = 0; i < sizeof refusals / sizeof *refusals; i++) {
		struct gazed_process gazed = SPAWN(refusals[i][0], refusals[i][1]);
		assert_int_equal(gazed_wait_exit(&gazed), 1);
		const char *said = gazed_said(&gazed);
		if (!strstr(said, refusals[i][2]) || strchr(said, '\n') != said + strlen(said) - 1)
			fail_msg("%s %s: said: %s", refusals[i][0], refusals[i][1], said);
	}
}

static void gazed_killed_loses_no_more_than_a_second_of_the_recording(void **state)
{
	(void)state;
	struct reader reader;
	reader_open(&reader, &place, "");
	struct gazed_process gazed =
		SPAWN("--sim.rate_hz", "500", "--wait-readers", "1", "--record", "killed");
	reader_receive_gaze(&reader, 1500);
	assert_int_equal(gazed_stop(&gazed, SIGKILL), -SIGKILL);
	reader_drain(&reader, 100);
	struct found found = read_log("killed.gzl");
	assert_int_equal(found.ending, GZ_GAZE_LOG_CUT);
	if (found.samples + 500 < reader.gaze_count)
		fail_msg("%llu of %zu samples are in the log", (unsigned long long)found.samples,
			 reader.gaze_count);
	/* The sockets and the lock that it left behind do not disturb the next daemon. */
	struct gazed_process next = SPAWN("--driver", "sim");
	gazed_wait_ready(&place, &next);
	assert_int_equal(gazed_stop(&next, SIGTERM), 0);
	reader_close(&reader);
}

static void gazed_full_disk_stops_the_recording_and_not_the_stream(void **state)
{
	(void)state;
	struct reader reader;
	struct gazed_process gazed;
	const char *const arguments[] = { "--sim.rate_hz", "500", "--record", "full", NULL };
	reader_open(&reader, &place, "");
	gazed_spawn(&(struct gazed_start) { .place = &place,
					    .arguments = arguments,
					    .file_size_max = 40000 },
		    &gazed);
	reader_wait_recording(&reader, GZ_RECORDING_FAILED);
	assert_non_null(strstr(reader.status.recording.error, "File too large"));
	assert_non_null(strstr(reader.status.recording.file, "full.gzl"));
	uint64_t in_file = reader.status.recording.samples;
	reader_receive_gaze(&reader, reader.gaze_count + 500);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	struct found found = read_log("full.gzl");
	assert_int_equal(found.samples, in_file);
	assert_true(found.samples > 50);
	assert_true(found.ending == GZ_GAZE_LOG_WHOLE || found.ending == GZ_GAZE_LOG_CUT);
	reader_close(&reader);
}

static size_t count_gaps(const char *name, const char *reason)
{
	char path[256];
	struct gz_gaze_log_reader *reader = NULL;
	struct gz_gaze_log_record record;
	size_t count = 0;
	snprintf(path, sizeof path, "%s/%s", place.recordings, name);
	assert_int_equal(gz_gaze_log_open(path, NULL, &reader), GZ_OK);
	while (gz_gaze_log_read(reader, &record) == GZ_OK)
		count += record.kind == GZ_GAZE_LOG_GAP && strstr(record.text, reason);
	gz_gaze_log_close(&reader);
	return count;
}

static void gazed_source_faster_than_the_disk_is_recorded_whole(void **state)
{
	(void)state;
	struct reader reader;
	struct gazed_process gazed = SPAWN("--sim.realtime=no", "--record", "fast");
	reader_open(&reader, &place, "status");
	while (reader.status_count == 0 || reader.status.recording.samples < 30000)
		assert_true(reader_receive(&reader, PATIENCE_MS));
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	reader_close(&reader);
	struct found found = read_log("fast.gzl");
	assert_int_equal(found.ending, GZ_GAZE_LOG_WHOLE);
	assert_int_equal(found.samples, found.last_seq - found.first_seq + 1);
	assert_int_equal(count_gaps("fast.gzl", "too slow"), 0);
}

static void gazed_reader_that_stops_reading_delays_nobody(void **state)
{
	(void)state;
	struct reader lively, dead;
	int small = 1;
	struct gazed_process gazed = SPAWN("--sim.rate_hz", "2000");
	reader_open(&lively, &place, "gaze.");
	reader_open(&dead, &place, "");
	zmq_setsockopt(dead.socket, ZMQ_RCVHWM, &small, sizeof small);
	reader_receive_gaze(&lively, 8000); /* the queues of the dead reader have long been full */
	struct gz_gaze first, last;
	assert_int_equal(
		gz_wire_decode_gaze(lively.messages[0].bytes, lively.messages[0].size, &first),
		GZ_OK);
	assert_int_equal(
		gz_wire_decode_gaze(lively.messages[7999].bytes, lively.messages[7999].size, &last),
		GZ_OK);
	assert_int_equal(last.seq - first.seq, 7999); /* nothing is missing */
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	reader_close(&lively);
	reader_close(&dead);
}

static void gazed_started_with_closed_streams_logs_into_no_socket(void **state)
{
	(void)state;
	const char *const arguments[] = { "--record", "silent", NULL };
	const struct gazed_start start = { .place = &place,
					   .arguments = arguments,
					   .without_streams = true };
	struct gazed_process gazed;
	gazed_spawn(&start, &gazed);
	gazed_wait_ready(&place, &gazed);
	for (int fd = 0; fd <= STDERR_FILENO; fd++) {
		char link[64], target[128] = "";
		snprintf(link, sizeof link, "/proc/%ld/fd/%d", (long)gazed.pid, fd);
		assert_true(readlink(link, target, sizeof target - 1) > 0);
		assert_string_equal(target, "/dev/null");
	}
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	assert_int_equal(read_log("silent.gzl").ending, GZ_GAZE_LOG_WHOLE);
}

/* Each in directories of its own, so that a failed test does not disturb the others. */
#define TEST(function) cmocka_unit_test_setup_teardown(function, set_up, tear_down)

TEST_SUITE(gazed)
{
	const struct CMUnitTest tests[] = {
		TEST(gazed_starts_at_once_and_ends_cleanly_on_each_signal),
		TEST(gazed_answers_every_letter_within_100_ms),
		TEST(gazed_ports_of_tcp_lead_to_the_stream),
		TEST(gazed_stream_carries_every_topic_and_the_status),
		TEST(gazed_newcomers_do_not_wait_for_the_next_second_s_status),
		TEST(gazed_latest_is_one_frame_and_the_newest),
		TEST(gazed_replay_gives_the_live_messages_bit_for_bit),
		TEST(gazed_recording_begun_in_mid_stream_replays_bit_for_bit),
		TEST(scene_that_becomes_still_in_mid_recording_replays_bit_for_bit),
		TEST(viewers_may_be_forbidden_to_say_that_a_scene_is_still),
		TEST(gazed_annotation_is_marked_in_the_log_and_sent_to_all_readers),
		TEST(gazed_lsl_readers_get_every_sample_event_and_annotation),
		TEST(gazed_second_one_in_a_directory_is_refused_and_harms_nothing),
		TEST(gazed_taken_endpoint_is_refused_with_the_remedy),
		TEST(gazed_refuses_bad_configuration_in_one_line),
		TEST(gazed_killed_loses_no_more_than_a_second_of_the_recording),
		TEST(gazed_full_disk_stops_the_recording_and_not_the_stream),
		TEST(gazed_source_faster_than_the_disk_is_recorded_whole),
		TEST(gazed_reader_that_stops_reading_delays_nobody),
		TEST(gazed_started_with_closed_streams_logs_into_no_socket),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
