/* The machine of the daemon: its disk fills up, it is suspended. */
#include "suite.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/mount.h>

#include "base/clock.h"
#include "guest.h"
#include "pipeline/gazed_process.h"
#include "recorded.h"

static struct gazed_place place;
static struct reader reader;

static int set_up(void **state)
{
	(void)state;
	gazed_place_make(&place);
	reader_open(&reader, &place, "");
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	reader_close(&reader);
	gazed_kill_all();
	umount(place.recordings);
	gazed_place_remove(&place);
	return 0;
}

static struct gazed_process spawn(const char *const *arguments)
{
	struct gazed_process process;
	gazed_spawn(&(struct gazed_start) { .place = &place, .arguments = arguments }, &process);
	gazed_wait_ready(&place, &process);
	return process;
}

#define SPAWN(...) spawn((const char *const[]) { __VA_ARGS__, NULL })

static void full_disk_ends_the_recording_and_not_the_stream(void **state)
{
	(void)state;
	if (mount("tmpfs", place.recordings, "tmpfs", 0, "size=64k") != 0)
		fail_msg("mounting a small disk: %s", strerror(errno));
	struct gazed_process gazed = SPAWN("--sim.rate_hz", "1000", "--sim.loss", "0");
	assert_string_equal(gazed_request(&place, "R full", NULL), "OK");
	reader_wait_recording(&reader, GZ_RECORDING_FAILED);
	print_message("           status says: %s\n", reader.status.recording.error);
	assert_non_null(strstr(reader.status.recording.error, "No space left on device"));
	uint64_t in_file = reader.status.recording.samples;
	uint64_t seq = reader.newest_seq;
	reader_receive_gaze(&reader, reader.gaze_count + 500);
	assert_true(reader.newest_seq >= seq + 500);
	struct recorded found = recorded_read(place.recordings, "full.gzl");
	print_message("           %d samples were saved\n", (int)found.samples);
	assert_true(found.samples > 50);
	assert_int_equal(found.samples, in_file);
	assert_int_equal(found.malformed, 0);
	assert_int_equal(found.last_seq - found.first_seq + 1, found.samples);

	/* When there is space again, it records again. */
	assert_int_equal(mount("tmpfs", place.recordings, "tmpfs", MS_REMOUNT, "size=1m"), 0);
	assert_string_equal(gazed_request(&place, "R again", NULL), "OK");
	reader_wait_recording(&reader, GZ_RECORDING_ON);
	reader_receive_gaze(&reader, reader.gaze_count + 200);
	assert_string_equal(gazed_request(&place, "r", NULL), "OK");
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	found = recorded_read(place.recordings, "again.gzl");
	assert_true(found.samples >= 200);
	assert_int_equal(found.ending, GZ_GAZE_LOG_WHOLE);
}

static void suspended_daemon_continues_where_it_stopped(void **state)
{
	(void)state;
	struct gazed_process gazed = SPAWN("--sim.rate_hz", "200", "--sim.loss", "0");
	assert_string_equal(gazed_request(&place, "R nap", NULL), "OK");
	reader_receive_gaze(&reader, reader.gaze_count + 200);
	uint64_t before = reader.newest_seq;
	int64_t slept_ns = guest_suspend();
	print_message("           asleep for %.1f s\n", gz_ns_to_s(slept_ns));
	assert_true(slept_ns > GZ_NS_PER_S);
	reader_receive_gaze(&reader, reader.gaze_count + 400);
	assert_true(reader.newest_seq >= before + 400);
	assert_int_equal(reader.status.tracker.state, GZ_TRACKER_RUNNING);
	assert_string_equal(gazed_request(&place, "r", NULL), "OK");
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	struct recorded found = recorded_read(place.recordings, "nap.gzl");
	assert_int_equal(found.ending, GZ_GAZE_LOG_WHOLE);
	assert_int_equal(found.malformed, 0);
	assert_int_equal(found.backwards, 0);
	assert_int_equal(found.samples + found.missing, found.last_seq - found.first_seq + 1);
	/* Host time stands still while the machine is suspended. */
	assert_true(found.longest_ns < GZ_NS_PER_S);
}

#define TEST(function) cmocka_unit_test_setup_teardown(function, set_up, tear_down)

int main(void)
{
	const struct CMUnitTest tests[] = {
		TEST(full_disk_ends_the_recording_and_not_the_stream),
		TEST(suspended_daemon_continues_where_it_stopped),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
