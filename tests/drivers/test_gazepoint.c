/* The Gazepoint driver with a fake server, well behaved or not. */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "driver_stage.h"
#include "drivers/gazepoint/gazepoint_link.h"
#include "drivers/gazepoint/gazepoint_protocol.h"
#include "gazepoint_server.h"

static struct gazepoint_server server;
static struct driver_stage stage;

static void point_at(int port)
{
	char text[16];
	stage_reset(&stage, "gazepoint");
	snprintf(text, sizeof text, "%d", port);
	stage_set(&stage, "gazepoint.port", text);
}

/* Start a device at a server that plays @p play. */
static struct gz_device *begin(const struct gazepoint_play *play)
{
	gazepoint_server_start(&server, play, 0);
	point_at(server.port);
	return stage_start(&stage);
}

static void end(struct gz_device *device)
{
	gz_device_destroy(&device);
	gazepoint_server_stop(&server);
}

static uint64_t malformed(const struct gz_device *device, enum gz_malformed reason)
{
	return device_counters(device).malformed[reason];
}

static void tracker_is_identified_before_it_streams(void **state)
{
	(void)state;
	struct gz_device_info info;
	gazepoint_server_start(&server, &(struct gazepoint_play) { .stream = true }, 0);
	point_at(server.port);
	struct gz_device *device = stage_open(&stage, NULL);
	gz_device_get_info(device, &info);
	assert_string_equal(info.name, "Gazepoint GP3HD");
	assert_string_equal(info.serial, "13&7");
	assert_true(info.rate_hz == 150);
	assert_true(info.has_display && gz_display_valid(&info.display));
	assert_int_equal(info.display.px[0], 2560);
	assert_int_equal(info.display.px[1], 1440);
	end(device);
}

static void record_becomes_a_sample_in_our_units(void **state)
{
	(void)state;
	struct gz_device *device = begin(&(struct gazepoint_play) { .stream = true });
	struct gz_device_counters counters;
	struct gz_sample sample = device_read_sample(device);
	assert_int_equal(sample.seq, 0);
	assert_true(sample.valid && sample.point.x == 0.5f && sample.point.y == 0.5f);
	assert_true(sample.eye[GZ_EYE_LEFT].point.x == 0.4f);
	assert_true(sample.eye[GZ_EYE_RIGHT].point.x == 0.6f);
	assert_false(sample.eye[GZ_EYE_LEFT]
			     .valid); /* every third one is invalid, beginning with the first */
	assert_true(sample.eye[GZ_EYE_RIGHT].valid);
	assert_true(fabsf(sample.eye[GZ_EYE_LEFT].pupil_mm - 3.1f) < 1e-6f);
	assert_true(fabsf(sample.eye[GZ_EYE_LEFT].origin_mm[0] + 30) < 1e-4f);
	assert_true(fabsf(sample.eye[GZ_EYE_RIGHT].origin_mm[2] - 600) < 1e-3f);
	assert_true(isnan(sample.eye[GZ_EYE_LEFT].direction[0]));
	/* 5e9 ticks of 10 MHz */
	assert_true(sample.device_ns == 500 * GZ_NS_PER_S);
	assert_true(device_read_sample(device).device_ns == 500 * GZ_NS_PER_S + 2 * GZ_NS_PER_MS);
	gz_device_get_counters(device, &counters);
	assert_int_equal(counters.clock.tick, GZ_CLOCK_DECLARED);
	end(device);
}

static void counter_shows_lost_records(void **state)
{
	(void)state;
	struct gz_device *device = begin(&(struct gazepoint_play) { .stream = true });
	struct gz_device_counters counters;
	uint32_t lost = 0;
	for (int i = 0; i < 120; i++)
		lost += device_read_sample(device).lost_before;
	gz_device_get_counters(device, &counters);
	/* Of records 0 to 122, numbers 49 and 99 were not sent and 69 is unreadable. */
	assert_int_equal(lost, 3);
	assert_int_equal(counters.lost, 3);
	assert_int_equal(counters.malformed[GZ_MALFORMED_SYNTAX], 1);
	end(device);
}

#define REC(counter, more) \
	"<REC CNT=\"" counter "\" BPOGX=\"0.5\" BPOGY=\"0.5\" BPOGV=\"1\" " more "/>\r\n"

static void records_in_pieces_and_many_at_once_are_the_same(void **state)
{
	(void)state;
	static const char script[] = REC("1", "") REC("2", "") REC("3", "") REC("4", "");
	static const size_t chunks[] = { 0, 1, 7, 50 };
	for (size_t i = 0; i < sizeof chunks / sizeof *chunks; i++) {
		struct gz_device *device =
			begin(&(struct gazepoint_play) { .script = script, .chunk = chunks[i] });
		for (uint64_t seq = 0; seq < 4; seq++) {
			struct gz_sample sample = device_read_sample(device);
			assert_int_equal(sample.seq, seq);
			assert_int_equal(sample.lost_before, 0);
			assert_true(gz_sample_combined_only(&sample));
		}
		end(device);
	}
}

static void unusable_records_are_counted_by_reason(void **state)
{
	(void)state;
	static const char script[] = "garbage\r\n\x01\x02\xff\r\n" REC("1", "") REC("1",
										    "TIME=\"3\" ")
		REC("2", "LPOGX=\"x\" ") "<REC CNT=\"3\"/>\r\n<CAL ID=\"x\"/>\r\n" REC("5", "");
	struct gz_device *device = begin(&(struct gazepoint_play) { .script = script });
	assert_int_equal(device_read_sample(device).lost_before, 0);
	/* Records 2 and 3 came without data; 4 never came. */
	assert_int_equal(device_read_sample(device).lost_before, 3);
	assert_int_equal(malformed(device, GZ_MALFORMED_SYNTAX), 2);
	assert_int_equal(malformed(device, GZ_MALFORMED_STALE), 1);
	assert_int_equal(malformed(device, GZ_MALFORMED_VALUE), 2);
	assert_int_equal(malformed(device, GZ_MALFORMED_LONG), 0);
	end(device);
}

static void endless_record_is_bounded_and_keeps_to_the_timeout(void **state)
{
	(void)state;
	static char script[8 * GZ_GAZEPOINT_RECORD_MAX];
	static const char last[] = "\r\n" REC("1", "");
	memset(script, '<', sizeof script);
	memcpy(script + sizeof script - (sizeof last - 1), last, sizeof last - 1);
	struct gz_device *device = begin(&(struct gazepoint_play) {
		.script = script, .script_size = sizeof script, .chunk = 1000 });
	assert_int_equal(device_read_sample(device).seq, 0);
	assert_int_equal(malformed(device, GZ_MALFORMED_LONG), 1);
	struct gz_sample sample;
	assert_int_equal(gz_device_read(device, 1, &sample), GZ_ERR_TIMEOUT);
	assert_int_equal(gz_device_read(device, 0, &sample), GZ_ERR_TIMEOUT);
	end(device);
}

static void counter_that_runs_backwards_has_restarted(void **state)
{
	(void)state;
	static const char script[] = REC("100", "") REC("-9223372036854775808", "")
		REC("9223372036854775807", "") REC("1", "") REC("3", "");
	struct gz_device *device = begin(&(struct gazepoint_play) { .script = script });
	for (int i = 0; i < 4; i++)
		assert_int_equal(device_read_sample(device).lost_before, 0);
	assert_int_equal(device_read_sample(device).lost_before, 1);
	end(device);
}

static void without_ticks_time_is_used_and_without_time_the_arrival(void **state)
{
	(void)state;
	static const char script[] = REC("1", "TIME=\"1.5\" TIME_TICK=\"77\" ")
		REC("2", "TIME=\"1.25\" ") REC("3", "") REC("4", "TIME=\"1e300\" ");
	struct gz_device_counters counters;
	struct gz_device *device = begin(
		&(struct gazepoint_play) { .script = script, .refuses = "TIME_TICK_FREQUENCY" });
	assert_true(device_read_sample(device).device_ns == 1500 * GZ_NS_PER_MS);
	/* A calibration sets TIME back. */
	assert_true(device_read_sample(device).device_ns == 1250 * GZ_NS_PER_MS);
	struct gz_sample sample = device_read_sample(device);
	assert_true(sample.device_ns == GZ_NO_DEVICE_TIME);
	assert_true(sample.host_ns <= gz_clock_now_ns());
	gz_device_get_counters(device, &counters);
	assert_int_equal(counters.clock.tick, GZ_CLOCK_NONE);
	assert_true(device_read_sample(device).device_ns == GZ_NO_DEVICE_TIME);
	end(device);
}

static void ticks_without_a_frequency_are_not_device_time_until_it_is_estimated(void **state)
{
	(void)state;
	static const char script[] = REC("1", "TIME_TICK=\"77\" ") REC("2", "TIME_TICK=\"78\" ");
	struct gz_device_counters counters;
	struct gz_device *device = begin(
		&(struct gazepoint_play) { .script = script, .refuses = "TIME_TICK_FREQUENCY" });
	for (int i = 0; i < 2; i++)
		assert_true(device_read_sample(device).device_ns == GZ_NO_DEVICE_TIME);
	gz_device_get_counters(device, &counters);
	assert_int_equal(counters.clock.tick, GZ_CLOCK_NONE);
	end(device);
}

static void impossible_frequency_is_not_believed(void **state)
{
	(void)state;
	static const char script[] = REC("1", "TIME=\"1.5\" TIME_TICK=\"77\" ");
	struct gz_device *device =
		begin(&(struct gazepoint_play) { .script = script, .frequency = "0" });
	assert_true(device_read_sample(device).device_ns == 1500 * GZ_NS_PER_MS);
	end(device);
}

static void fields_that_an_older_version_refuses_are_not_needed(void **state)
{
	(void)state;
	struct gz_device *device =
		begin(&(struct gazepoint_play) { .stream = true, .refuses = "PUPILMM" });
	assert_true(device_read_sample(device).valid);
	end(device);
}

static void server_that_refuses_data_is_not_a_device(void **state)
{
	(void)state;
	struct gz_sample sample;
	struct gz_device *device =
		begin(&(struct gazepoint_play) { .stream = true, .refuses = "SEND_DATA" });
	assert_int_equal(device_read_result(device, &sample), GZ_ERR_NO_DEVICE);
	end(device);
}

static void another_screen_reopens_the_tracker_and_the_same_one_does_not(void **state)
{
	(void)state;
	static const char script[] =
		"<UPDATE ACTIVE_ID=\"1\" MAX_ID=\"2\" WIDTH=\"2560\" HEIGHT=\"1440\" >\r\n" REC(
			"1", "") "<UPDATE ACTIVE_ID=\"2\" MAX_ID=\"2\" WIDTH=\"1920\" "
				 "HEIGHT=\"1080\" >\r\n" REC("2", "");
	struct gz_sample sample;
	struct gz_device *device = begin(&(struct gazepoint_play) { .script = script });
	assert_true(device_read_sample(device).valid);
	assert_int_equal(device_read_result(device, &sample), GZ_ERR_NO_DEVICE);
	assert_int_equal(gz_device_read(device, 10, &sample), GZ_ERR_NO_DEVICE);
	end(device);
}

static void server_that_dies_is_reported_and_may_return(void **state)
{
	(void)state;
	struct gz_sample sample;
	static const char script[] = REC("1", "") "<REC CNT=\"2\"";
	struct gz_device *device =
		begin(&(struct gazepoint_play) { .script = script, .hang_up = true });
	device_read_sample(device);
	assert_int_equal(device_read_result(device, &sample), GZ_ERR_NO_DEVICE);
	assert_int_equal(gz_device_read(device, 10, &sample), GZ_ERR_NO_DEVICE);
	int port = server.port;
	end(device);
	/* While the server is gone. */
	device = NULL;
	assert_int_equal(stage_create(&stage, NULL, &device), GZ_ERR_NO_DEVICE);
	assert_null(device);
	gazepoint_server_start(&server, &(struct gazepoint_play) { .stream = true }, port);
	device = stage_open(&stage, NULL);
	assert_int_equal(gz_device_start(device), GZ_OK);
	assert_int_equal(device_read_sample(device).seq, 0);
	end(device);
}

static void server_that_does_not_answer_is_waited_for_as_long_as_documented(void **state)
{
	(void)state;
	struct gz_sample sample;
	gazepoint_server_start(&server, &(struct gazepoint_play) { .mute = true }, 0);
	point_at(server.port);
	int64_t begin_ns = gz_clock_now_ns();
	struct gz_device *device = stage_open(&stage, NULL);
	int64_t took_ns = gz_clock_now_ns() - begin_ns;
	if (took_ns < GZ_GAZEPOINT_ANSWER_MS * GZ_NS_PER_MS || took_ns > 2 * GZ_NS_PER_S)
		fail_msg("took %g ms", gz_ns_to_ms(took_ns));
	assert_int_equal(gz_device_start(device), GZ_OK);
	assert_int_equal(gz_device_read(device, 5, &sample), GZ_ERR_TIMEOUT);
	end(device);
}

static void list_says_whether_the_server_is_there(void **state)
{
	(void)state;
	struct gz_device_entry entries[GZ_DEVICE_ENTRIES_MAX];
	gazepoint_server_start(&server, &(struct gazepoint_play) { 0 }, 0);
	point_at(server.port);
	assert_int_equal(stage_list(&stage, entries), 1);
	assert_true(entries[0].usable);
	assert_string_equal(entries[0].reason, "");
	gazepoint_server_stop(&server);
	assert_int_equal(stage_list(&stage, entries), 1);
	assert_false(entries[0].usable);
	if (!strstr(entries[0].reason, "refused") || !strstr(entries[0].reason, "gazepoint.host"))
		fail_msg("%s", entries[0].reason);
}

static void list_omits_a_default_server_that_does_not_answer(void **state)
{
	(void)state;
	struct gz_device_entry entries[GZ_DEVICE_ENTRIES_MAX];
	point_at(4242);
	size_t count = stage_list(&stage, entries);
	if (count > 0 && !entries[0].usable)
		fail_msg("%s", entries[0].reason);
}

static void unknown_host_is_not_a_device(void **state)
{
	(void)state;
	struct gz_device *device = NULL;
	point_at(1);
	stage_set(&stage, "gazepoint.host", "256.256.256.256");
	assert_int_equal(stage_create(&stage, NULL, &device), GZ_ERR_NO_DEVICE);
	assert_null(device);
}

TEST_SUITE(gazepoint)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(tracker_is_identified_before_it_streams),
		cmocka_unit_test(record_becomes_a_sample_in_our_units),
		cmocka_unit_test(counter_shows_lost_records),
		cmocka_unit_test(records_in_pieces_and_many_at_once_are_the_same),
		cmocka_unit_test(unusable_records_are_counted_by_reason),
		cmocka_unit_test(endless_record_is_bounded_and_keeps_to_the_timeout),
		cmocka_unit_test(counter_that_runs_backwards_has_restarted),
		cmocka_unit_test(without_ticks_time_is_used_and_without_time_the_arrival),
		cmocka_unit_test(
			ticks_without_a_frequency_are_not_device_time_until_it_is_estimated),
		cmocka_unit_test(impossible_frequency_is_not_believed),
		cmocka_unit_test(fields_that_an_older_version_refuses_are_not_needed),
		cmocka_unit_test(server_that_refuses_data_is_not_a_device),
		cmocka_unit_test(another_screen_reopens_the_tracker_and_the_same_one_does_not),
		cmocka_unit_test(server_that_dies_is_reported_and_may_return),
		cmocka_unit_test(server_that_does_not_answer_is_waited_for_as_long_as_documented),
		cmocka_unit_test(list_says_whether_the_server_is_there),
		cmocka_unit_test(list_omits_a_default_server_that_does_not_answer),
		cmocka_unit_test(unknown_host_is_not_a_device),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
