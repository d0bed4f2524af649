/* The daemon at a fast tracker's rate for long, and over many samples: nothing lost, no memory
 * taken. usage: test_pipeline_endurance [SECONDS SAMPLES]; the preset is what fits between other
 * tests. */
#include "suite.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zmq.h>

#include "base/clock.h"
#include "gazed_process.h"
#include "protocol/gaze_log.h"
#include "protocol/wire.h"

/* A sanitizer needs more memory and time. */
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
enum { SANITIZED = 1, RATE_HZ = 250 };
#else
enum { SANITIZED = 0, RATE_HZ = 2000 };
#endif

enum { MEMORY_MAX_KIB = 20 * 1024, MEMORY_GROWTH_MAX_KIB = 256 };

static double seconds = SANITIZED ? 2 : 20;
static uint64_t samples = SANITIZED ? 40000 : 400000;

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

/* One gaze message, of which only the map is kept. */
static struct gz_gaze receive_gaze(struct reader *reader)
{
	char topic[80];
	unsigned char bytes[GZ_WIRE_MESSAGE_SIZE];
	struct gz_gaze gaze = { 0 };
	int patience_ms = PATIENCE_MS;
	zmq_setsockopt(reader->socket, ZMQ_RCVTIMEO, &patience_ms, sizeof patience_ms);
	int length = zmq_recv(reader->socket, topic, sizeof topic, 0);
	int size = length < 0 ? -1 : zmq_recv(reader->socket, bytes, sizeof bytes, 0);
	if (size < 0)
		fail_msg("the stream has stopped");
	assert_int_equal(gz_wire_decode_gaze(bytes, (size_t)size, &gaze), GZ_OK);
	return gaze;
}

/* Every sample from 0 on exactly once, without a gap. */
static void check_log(const char *name, uint64_t at_least)
{
	char path[256];
	struct gz_gaze_log_reader *log = NULL;
	struct gz_gaze_log_record record;
	uint64_t next = 0;
	snprintf(path, sizeof path, "%s/%s", place.recordings, name);
	assert_int_equal(gz_gaze_log_open(path, NULL, &log), GZ_OK);
	while (gz_gaze_log_read(log, &record) == GZ_OK) {
		assert_int_equal(record.kind, GZ_GAZE_LOG_SAMPLE);
		assert_int_equal(record.sample.seq, next);
		next++;
	}
	assert_int_equal(gz_gaze_log_ending(log), GZ_GAZE_LOG_WHOLE);
	assert_true(next >= at_least);
	gz_gaze_log_close(&log);
}

static void gazed_at_its_highest_rate_loses_nothing_on_the_stream_or_in_the_log(void **state)
{
	(void)state;
	char rate[16];
	struct reader reader;
	struct gazed_process gazed;
	snprintf(rate, sizeof rate, "%d", RATE_HZ);
	const char *const arguments[] = {
		"--sim.rate_hz", rate,   "--sim.loss", "0", "--wait-readers", "1",
		"--record",      "fast", NULL,
	};
	reader_open(&reader, &place, "gaze.");
	gazed_spawn(&(struct gazed_start) { .place = &place, .arguments = arguments }, &gazed);
	uint64_t wanted = (uint64_t)(seconds * RATE_HZ);
	for (uint64_t seq = 0; seq < wanted; seq++) {
		struct gz_gaze gaze = receive_gaze(&reader);
		if (gaze.seq != seq)
			fail_msg("sample %llu came where %llu was due",
				 (unsigned long long)gaze.seq, (unsigned long long)seq);
	}
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	check_log("fast.gzl", wanted);
	reader_close(&reader);
}

/* Resident memory of a process, KiB. */
static long memory_kib(pid_t pid)
{
	char path[64], line[256];
	long kib = 0;
	snprintf(path, sizeof path, "/proc/%ld/status", (long)pid);
	FILE *file = fopen(path, "re");
	assert_non_null(file);
	while (fgets(line, sizeof line, file))
		if (strncmp(line, "VmRSS:", 6) == 0)
			kib = atol(line + 6);
	fclose(file);
	return kib;
}

static void wait_samples(struct reader *reader, uint64_t count)
{
	while (reader->status_count == 0 || reader->status.samples < count)
		if (!reader_receive(reader, PATIENCE_MS))
			fail_msg("no status after %llu of %llu samples",
				 (unsigned long long)reader->status.samples,
				 (unsigned long long)count);
}

static void gazed_memory_is_the_same_after_many_samples(void **state)
{
	(void)state;
	struct reader reader;
	struct gazed_process gazed;
	const char *const arguments[] = { "--sim.realtime=no", "--sim.rate_hz", "1200", NULL };
	reader_open(&reader, &place, "status");
	gazed_spawn(&(struct gazed_start) { .place = &place, .arguments = arguments }, &gazed);
	wait_samples(&reader, samples / 10);
	long early_kib = memory_kib(gazed.pid);
	wait_samples(&reader, samples);
	long late_kib = memory_kib(gazed.pid);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	print_message("%llu samples: %ld KiB, after a tenth of them %ld KiB\n",
		      (unsigned long long)reader.status.samples, late_kib, early_kib);
	if (!SANITIZED) {
		assert_in_range(late_kib, 1, MEMORY_MAX_KIB);
		assert_true(late_kib - early_kib <= MEMORY_GROWTH_MAX_KIB);
	}
	reader_close(&reader);
}

#define TEST(function) cmocka_unit_test_setup_teardown(function, set_up, tear_down)

TEST_SUITE(endurance)
{
	if (argc == 3) {
		seconds = atof(argv[1]);
		samples = strtoull(argv[2], NULL, 10);
	}
	const struct CMUnitTest tests[] = {
		TEST(gazed_at_its_highest_rate_loses_nothing_on_the_stream_or_in_the_log),
		TEST(gazed_memory_is_the_same_after_many_samples),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
