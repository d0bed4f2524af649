/* Trackers that a test can play, behind the whole daemon: Gazepoint's server, Tobii's library, a
 * viewer's pointer and window. */
#include "suite.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "client/viewer_link.h"
#include "gazed_process.h"
#include "gazepoint_server.h"
#include "protocol/gaze_log.h"
#include "protocol/validated_file.h"
#include "protocol/wire.h"

static struct gazed_place place;
static struct reader reader;
static struct gazepoint_server server;

static int set_up(void **state)
{
	(void)state;
	gazed_place_make(&place);
	memset(&reader, 0, sizeof reader);
	reader_open(&reader, &place, "");
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	reader_close(&reader);
	gazed_kill_all();
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

/* The newest gaze among what was received. */
static bool newest_gaze(struct gz_gaze *out_gaze)
{
	for (size_t i = reader.count; i > 0; i--) {
		const struct received *message = &reader.messages[i - 1];
		if (strncmp(message->topic, GZ_TOPIC_GAZE, strlen(GZ_TOPIC_GAZE)) == 0)
			return gz_wire_decode_gaze(message->bytes, message->size, out_gaze) ==
			       GZ_OK;
	}
	return false;
}

static void wait_for_state(enum gz_tracker_state state)
{
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (reader.status_count == 0 || reader.status.tracker.state != state) {
		reader_receive(&reader, 500);
		if (gz_clock_now_ns() > deadline_ns)
			fail_msg("the tracker is %s, waited for %s",
				 gz_tracker_state_name(reader.status.tracker.state),
				 gz_tracker_state_name(state));
	}
}

static void gazepoint_server_may_die_and_return_and_numbers_go_on(void **state)
{
	(void)state;
	char port[16];
	const struct gazepoint_play play = { .stream = true };
	gazepoint_server_start(&server, &play, 0);
	snprintf(port, sizeof port, "%d", server.port);
	struct gazed_process gazed = SPAWN("--driver", "gazepoint", "--gazepoint.port", port);
	reader_receive_gaze(&reader, 200);
	wait_for_state(GZ_TRACKER_RUNNING);
	assert_string_equal(reader.status.tracker.name, "Gazepoint GP3HD");
	assert_string_equal(reader.status.tracker.serial, "13&7");
	assert_int_equal(reader.status.display.px[0], 2560);
	assert_true(reader.status.rate_hz_nominal == 150);
	gazepoint_server_stop(&server);
	wait_for_state(GZ_TRACKER_LOST);
	uint64_t seq = reader.newest_seq;
	gazepoint_server_start(&server, &play, server.port);
	wait_for_state(GZ_TRACKER_RUNNING);
	reader_receive_gaze(&reader, reader.gaze_count + 100);
	assert_true(reader.newest_seq >= seq + 100);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	gazepoint_server_stop(&server);
}

static void tracker_that_tells_its_display_with_its_samples_is_believed(void **state)
{
	(void)state;
	char port[16];
	const struct gazepoint_play play = {
		.refuses = "SCREEN_SIZE",
		.script = "<ACK ID=\"SCREEN_SIZE\" X=\"0\" Y=\"0\" WIDTH=\"1280\" HEIGHT=\"720\" "
			  "/>\r\n",
		.stream = true,
	};
	gazepoint_server_start(&server, &play, 0);
	snprintf(port, sizeof port, "%d", server.port);
	struct gazed_process gazed = SPAWN("--driver", "gazepoint", "--gazepoint.port", port);
	reader_receive_gaze(&reader, 50);
	wait_for_state(GZ_TRACKER_RUNNING);
	assert_int_equal(reader.status.display.px[0], 1280);
	assert_int_equal(reader.status.display.px[1], 720);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	gazepoint_server_stop(&server);
}

static void gazepoint_that_is_absent_is_waited_for(void **state)
{
	(void)state;
	char port[16];
	const struct gazepoint_play play = { .stream = true };
	gazepoint_server_start(&server, &play, 0);
	snprintf(port, sizeof port, "%d", server.port);
	gazepoint_server_stop(&server);
	struct gazed_process gazed = SPAWN("--driver", "gazepoint", "--gazepoint.port", port);
	wait_for_state(GZ_TRACKER_ABSENT);
	assert_non_null(strstr(gazed_said(&gazed), "gazepoint.host"));
	gazepoint_server_start(&server, &play, server.port);
	reader_receive_gaze(&reader, 50);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	gazepoint_server_stop(&server);
}

static void gazepoint_that_says_nothing_is_given_up_and_tried_again(void **state)
{
	(void)state;
	char port[16];
	const struct gazepoint_play play = { .mute = true };
	gazepoint_server_start(&server, &play, 0);
	snprintf(port, sizeof port, "%d", server.port);
	struct gazed_process gazed = SPAWN("--driver", "gazepoint", "--gazepoint.port", port);
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (atomic_load(&server.connections) < 2) {
		gz_clock_sleep_until_ns(gz_clock_now_ns() + 10 * GZ_NS_PER_MS);
		if (gz_clock_now_ns() > deadline_ns)
			fail_msg("%d connections", atomic_load(&server.connections));
	}
	assert_non_null(strstr(gazed_said(&gazed), "it sends nothing"));
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	gazepoint_server_stop(&server);
}

static void tobii_library_is_played_and_its_absence_refused(void **state)
{
	(void)state;
	struct gz_gaze gaze;
	struct gazed_process gazed = SPAWN("--driver", "tobii", "--tobii.library", TOBII_STAND_IN);
	reader_receive_gaze(&reader, 300);
	wait_for_state(GZ_TRACKER_RUNNING);
	assert_string_equal(reader.status.tracker.name, "Tobii Pro Spectrum");
	assert_string_equal(reader.status.tracker.serial, "TPSP1-01");
	assert_true(reader.status.display.mm[0] == 520);
	assert_true(newest_gaze(&gaze));
	assert_true(gaze.eye[GZ_EYE_LEFT].valid && !gaze.combined);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	gazed_spawn(
		&(struct gazed_start) {
			.place = &place,
			.arguments = (const char *const[]) { "--driver", "tobii", "--tobii.library",
							     "/nonexistent.so", NULL } },
		&gazed);
	assert_int_equal(gazed_wait_exit(&gazed), 1);
	assert_non_null(strstr(gazed_said(&gazed), "install the Tobii Pro SDK"));
	assert_non_null(strstr(gazed_said(&gazed), "tobii.library"));
}

static bool is_near(struct gz_point a, struct gz_point b)
{
	return fabsf(a.x - b.x) < 0.001f && fabsf(a.y - b.y) < 0.001f;
}

/* Point there until the gaze has followed. */
static void point_until_seen(struct gz_viewer_link *link, struct gz_point point)
{
	struct gz_gaze gaze = { 0 };
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	while (!newest_gaze(&gaze) || !is_near(gaze.point, point)) {
		gz_viewer_link_pointer(link, &point, gz_clock_now_ns());
		reader_receive(&reader, 20);
		if (gz_clock_now_ns() > deadline_ns)
			fail_msg("gaze at %g %g, pointed at %g %g", gaze.point.x, gaze.point.y,
				 point.x, point.y);
	}
	assert_true(gaze.combined);
}

static void pointer_leads_the_gaze_and_is_let_go(void **state)
{
	(void)state;
	char latest[128];
	struct gz_viewer_link *link;
	struct gz_gaze gaze;
	struct gazed_process gazed = SPAWN("--driver", "pointer", "--pointer.rate_hz", "250",
					   "--pointer.timeout_ms", "100000");
	snprintf(latest, sizeof latest, "ipc://%s/latest", place.directory);
	assert_int_equal(gz_viewer_link_open(latest, NULL, &link), GZ_OK);
	point_until_seen(link, (struct gz_point) { 0.25f, 0.75f });
	point_until_seen(link, (struct gz_point) { 0.75f, 0.25f });
	gz_viewer_link_pointer(link, NULL, gz_clock_now_ns());
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	do {
		reader_receive(&reader, 100);
		assert_true(gz_clock_now_ns() < deadline_ns);
	} while (!newest_gaze(&gaze) || gaze.confidence > 0);
	/* The pointer's position is not passed on to readers. */
	for (size_t i = 0; i < reader.count; i++)
		assert_string_not_equal(reader.messages[i].topic, GZ_TOPIC_POINTER);
	gz_viewer_link_close(&link);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
}

/* Report the window until a reader of the stream has received it @p times times. */
static void place_until_passed_on(struct gz_viewer_link *link, const int rect_px[4], size_t times)
{
	size_t seen = 0;
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	for (size_t from = reader.count; seen < times;) {
		gz_viewer_link_window(link, rect_px, gz_clock_now_ns());
		reader_receive(&reader, 20);
		for (; from < reader.count; from++)
			seen += strcmp(reader.messages[from].topic, GZ_TOPIC_WINDOW) == 0;
		assert_true(gz_clock_now_ns() < deadline_ns);
	}
}

static void window_is_recorded_at_once_and_at_the_start_of_a_later_recording(void **state)
{
	(void)state;
	static const int first_px[4] = { 10, 20, 640, 480 };
	static const int second_px[4] = { 11, 20, 640, 480 };
	char latest[128], path[128];
	struct gz_viewer_link *link;
	struct gz_gaze_log_reader *log;
	struct gz_gaze_log_record record;
	struct gazed_process gazed = SPAWN("--driver", "sim");
	snprintf(latest, sizeof latest, "ipc://%s/latest", place.directory);
	assert_int_equal(gz_viewer_link_open(latest, NULL, &link), GZ_OK);
	place_until_passed_on(link, first_px, 1);
	assert_string_equal(gazed_request(&place, "R windows", NULL), "OK");
	place_until_passed_on(link, second_px, 1);
	assert_string_equal(gazed_request(&place, "r", NULL), "OK");
	gz_viewer_link_close(&link);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
	snprintf(path, sizeof path, "%s/windows.gzl", place.recordings);
	assert_int_equal(gz_gaze_log_open(path, NULL, &log), GZ_OK);
	int windows = 0;
	uint64_t before = 0;
	while (gz_gaze_log_read(log, &record) == GZ_OK) {
		if (record.kind == GZ_GAZE_LOG_SAMPLE && windows == 0)
			before++;
		if (record.kind != GZ_GAZE_LOG_WINDOW)
			continue;
		assert_memory_equal(record.window_px, windows == 0 ? first_px : second_px,
				    sizeof first_px);
		windows++;
	}
	assert_int_equal(gz_gaze_log_ending(log), GZ_GAZE_LOG_WHOLE);
	gz_gaze_log_close(&log);
	assert_int_equal(windows, 2);
	assert_int_equal(before, 0);
}

/* Report the monitor until the status tells of a change that contains @p wanted; NULL: of none. */
static void report_until_told(struct gz_viewer_link *link, const struct gz_monitor_place *monitor,
			      const char *wanted)
{
	static const int rect_px[4] = { 0, 0, 640, 480 };
	const char *changed = reader.status.validation.changed;
	int64_t deadline_ns = gz_clock_now_ns() + PATIENCE_NS;
	gz_viewer_link_monitor(link, monitor);
	while (reader.status_count == 0 || !reader.status.validation.measured[0] ||
	       (wanted ? !strstr(changed, wanted) : changed[0] != '\0')) {
		gz_viewer_link_window(link, rect_px, gz_clock_now_ns());
		reader_receive(&reader, 20);
		if (gz_clock_now_ns() > deadline_ns)
			fail_msg("waited for \"%s\", was told \"%s\"", wanted ? wanted : "",
				 changed);
	}
}

static void monitor_that_changed_since_the_validation_is_told_in_the_status(void **state)
{
	(void)state;
	char path[160], latest[128];
	struct gz_viewer_link *link;
	struct gz_validated validated = {
		.tracker = "sim",
		.display = gz_display_default(1920, 1080),
		.monitor = { .px = { 1920, 1080 }, .scale = 1 },
		.measured = "2026-01-31T12:00:00Z",
		.accuracy_deg = 0.5,
	};
	assert_int_equal(
		gz_validated_path(place.recordings, validated.tracker, "", path, sizeof path),
		GZ_OK);
	assert_int_equal(gz_validated_write(path, &validated, NULL), GZ_OK);
	struct gazed_process gazed =
		SPAWN("--driver", "sim", "--tracker.corrections", place.recordings);
	snprintf(latest, sizeof latest, "ipc://%s/latest", place.directory);
	assert_int_equal(gz_viewer_link_open(latest, NULL, &link), GZ_OK);
	report_until_told(link, &validated.monitor, NULL);
	assert_true(reader.status.validation.accuracy_deg == 0.5);
	const struct gz_monitor_place scaled = { { 0, 0 }, { 1920, 1080 }, 2 };
	report_until_told(link, &scaled, "scale of the desktop 2, was 1");
	assert_non_null(strstr(gazed_said(&gazed), "the display has changed since sim"));
	/* What is not known any more has not changed. */
	report_until_told(link, NULL, NULL);
	gz_viewer_link_close(&link);
	assert_int_equal(gazed_stop(&gazed, SIGTERM), 0);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

TEST_SUITE(trackers)
{
	const struct CMUnitTest tests[] = {
		TEST(gazepoint_server_may_die_and_return_and_numbers_go_on),
		TEST(tracker_that_tells_its_display_with_its_samples_is_believed),
		TEST(gazepoint_that_is_absent_is_waited_for),
		TEST(gazepoint_that_says_nothing_is_given_up_and_tried_again),
		TEST(tobii_library_is_played_and_its_absence_refused),
		TEST(pointer_leads_the_gaze_and_is_let_go),
		TEST(window_is_recorded_at_once_and_at_the_start_of_a_later_recording),
		TEST(monitor_that_changed_since_the_validation_is_told_in_the_status),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
