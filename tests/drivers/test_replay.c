#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "driver_stage.h"
#include "made_log.h"

static char path[64];
static struct driver_stage stage;

static int make_path(void **state)
{
	(void)state;
	snprintf(path, sizeof path, "/tmp/gz_replay_XXXXXX");
	int fd = mkstemp(path);
	return fd < 0 ? -1 : close(fd);
}

static int remove_path(void **state)
{
	(void)state;
	return unlink(path);
}

static struct gz_device *open_replay(const char *speed)
{
	stage_reset(&stage, "replay");
	stage_set(&stage, "replay.file", path);
	stage_set(&stage, "replay.speed", speed);
	return stage_start(&stage);
}

static void replay_keeps_numbers_times_and_header(void **state)
{
	(void)state;
	struct made_log made;
	struct gz_sample sample;
	struct gz_device_info info;
	assert_true(made_log_begin(&made, path));
	made_log_sample(&made, 100, 5000000);
	made_log_sample(&made, 107, 6000000);
	made_log_end(&made);
	struct gz_device *device = open_replay("0");
	gz_device_get_info(device, &info);
	assert_string_equal(info.name, "made");
	assert_string_equal(info.serial, "S1");
	assert_true(info.rate_hz == 500 && info.has_display && info.display.px[0] == 1280);
	assert_non_null(info.recorded);
	assert_int_equal(gz_device_read(device, 100, &sample), GZ_OK);
	assert_int_equal(sample.seq, 100);
	assert_int_equal(sample.host_ns, 5000000);
	assert_int_equal(sample.device_ns, 2500000);
	assert_int_equal(gz_device_read(device, 100, &sample), GZ_OK);
	assert_int_equal(sample.seq, 107);
	assert_int_equal(gz_device_read(device, 100, &sample), GZ_ERR_END);
	assert_int_equal(gz_device_read(device, 100, &sample), GZ_ERR_END);
	gz_device_destroy(&device);
}

static void replay_counts_gaps_as_lost(void **state)
{
	(void)state;
	struct made_log made;
	struct gz_sample sample;
	struct gz_device_counters counters;
	assert_true(made_log_begin(&made, path));
	made_log_gap(&made, 1, 3);
	made_log_sample(&made, 0, 1000);
	made_log_sample(&made, 1, 2000);
	made_log_gap(&made, 2500, 5);
	made_log_gap(&made, 2600, UINT64_C(10000000000));
	made_log_sample(&made, 2, 3000);
	made_log_end(&made);
	struct gz_device *device = open_replay("0");
	const uint32_t expected[] = { 3, 0, UINT32_MAX };
	for (int i = 0; i < 3; i++) {
		assert_int_equal(gz_device_read(device, 100, &sample), GZ_OK);
		assert_int_equal(sample.lost_before, expected[i]);
	}
	gz_device_get_counters(device, &counters);
	assert_int_equal(counters.lost, UINT64_C(10000000008));
	gz_device_destroy(&device);
}

static void replay_skips_and_counts_malformed_lines(void **state)
{
	(void)state;
	struct made_log made;
	struct gz_sample sample;
	struct gz_device_counters counters;
	assert_true(made_log_begin(&made, path));
	made_log_sample(&made, 0, 1000);
	made_log_write(&made, "nonsense\n", 9);
	made_log_sample(&made, 1, 2000);
	made_log_end(&made);
	struct gz_device *device = open_replay("0");
	assert_int_equal(gz_device_read(device, 100, &sample), GZ_OK);
	assert_int_equal(gz_device_read(device, 100, &sample), GZ_OK);
	assert_int_equal(sample.seq, 1);
	gz_device_get_counters(device, &counters);
	assert_int_equal(counters.malformed[GZ_MALFORMED_SYNTAX], 1);
	gz_device_destroy(&device);
}

/* Time that it takes to play 20 samples from 100 recorded ms, ms. */
static double play_ms(const char *speed)
{
	struct made_log made;
	struct gz_sample sample;
	assert_true(made_log_begin(&made, path));
	for (int i = 0; i <= 20; i++)
		made_log_sample(&made, (uint64_t)i, 777 * GZ_NS_PER_S + i * 5 * GZ_NS_PER_MS);
	made_log_end(&made);
	struct gz_device *device = open_replay(speed);
	int64_t begin_ns = gz_clock_now_ns();
	enum gz_result result;
	do
		result = gz_device_read(device, 3, &sample);
	while (result != GZ_ERR_END);
	gz_device_destroy(&device);
	return gz_ns_to_ms(gz_clock_now_ns() - begin_ns);
}

static void replay_speed_sets_the_duration(void **state)
{
	(void)state;
	/* The upper limits are generous, for a busy machine; the lower ones are exact. */
	double one_ms = play_ms("1"), four_ms = play_ms("4"), at_once_ms = play_ms("0");
	if (one_ms < 100 || one_ms > 2000 || four_ms < 25 || four_ms > one_ms ||
	    at_once_ms > four_ms)
		fail_msg("%g ms in real time, %g ms at speed 4, %g ms at once", one_ms, four_ms,
			 at_once_ms);
}

static void replay_continues_at_once_when_recorded_time_runs_backwards(void **state)
{
	(void)state;
	const int64_t times_ns[] = { 0, INT64_MAX, INT64_MIN, -5, INT64_MIN, 3 };
	struct made_log made;
	struct gz_sample sample;
	assert_true(made_log_begin(&made, path));
	made_log_sample(&made, 0, 3600 * GZ_NS_PER_S);
	made_log_sample(&made, 1, 1000);
	made_log_sample(&made, 2, 2000);
	for (uint64_t i = 0; i < sizeof times_ns / sizeof *times_ns; i++)
		made_log_sample(&made, 3 + i, times_ns[i]);
	made_log_end(&made);
	struct gz_device *device = open_replay("1");
	for (int i = 0; i < 4; i++)
		assert_int_equal(gz_device_read(device, 1000, &sample), GZ_OK);
	/* For a sample in the far future, the wait ends in time. */
	assert_int_equal(gz_device_read(device, 5, &sample), GZ_ERR_TIMEOUT);
	gz_device_destroy(&device);
}

static void expect_refusal(const char *file, enum gz_result expected)
{
	struct gz_device *device;
	stage_reset(&stage, "replay");
	stage_set(&stage, "replay.file", file);
	assert_int_equal(stage_create(&stage, NULL, &device), expected);
	assert_null(device);
}

static void replay_without_a_gaze_log_is_refused(void **state)
{
	(void)state;
	expect_refusal("", GZ_ERR_INVAL);
	stage_expect_logged(&stage, "--replay.file");
	expect_refusal("/nonexistent.gzl", GZ_ERR_NOT_FOUND);
	/* Neither blocks: a directory cannot be read, and a FIFO may never be written. */
	char fifo[] = "/tmp/gz_replay_XXXXXX";
	assert_non_null(mkdtemp(fifo));
	expect_refusal(fifo, GZ_ERR_INVAL);
	assert_int_equal(rmdir(fifo), 0);
	assert_int_equal(mkfifo(fifo, 0600), 0);
	expect_refusal(fifo, GZ_ERR_INVAL);
	stage_expect_logged(&stage, "not a regular file");
	unlink(fifo);
	expect_refusal("/proc/self/status", GZ_ERR_FORMAT);
}

TEST_SUITE(replay)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(replay_keeps_numbers_times_and_header),
		cmocka_unit_test(replay_counts_gaps_as_lost),
		cmocka_unit_test(replay_skips_and_counts_malformed_lines),
		cmocka_unit_test(replay_speed_sets_the_duration),
		cmocka_unit_test(replay_continues_at_once_when_recorded_time_runs_backwards),
		cmocka_unit_test(replay_without_a_gaze_log_is_refused),
	};
	return cmocka_run_group_tests(tests, make_path, remove_path);
}
