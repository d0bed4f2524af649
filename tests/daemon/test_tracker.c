#include "check.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "daemon/tracker.h"
#include "drivers/template/template_protocol.h"

/* The device is the template's: a FIFO that this test writes reports into. */
static const struct gz_driver_host nothing = { 0 };

static char directory[64], path[128];
static _Alignas(max_align_t) unsigned char settings[GZ_DRIVER_SETTINGS_SIZE];

static int set_up(void **state)
{
	(void)state;
	const struct gz_driver *driver = gz_driver_find("template");
	struct gz_option_binding binding = { driver->options, *driver->option_count, settings,
					     NULL };
	snprintf(directory, sizeof directory, "/tmp/gz_tracker_XXXXXX");
	if (!mkdtemp(directory))
		return -1;
	snprintf(path, sizeof path, "%s/fifo", directory);
	return gz_options_preset(&binding) == GZ_OK &&
			       gz_option_parse(gz_options_find(&binding, 1, "template.path", NULL),
					       path, settings, NULL, 0) == GZ_OK
		       ? 0
		       : -1;
}

static int tear_down(void **state)
{
	(void)state;
	unlink(path);
	return rmdir(directory);
}

static void send_report(int fd, uint32_t counter)
{
	unsigned char bytes[GZ_TEMPLATE_REPORT_SIZE];
	struct gz_template_report report = { .counter = counter,
					     .clock_us = counter * 2000,
					     .found = { true, true } };
	gz_template_print(&report, bytes);
	assert_int_equal(write(fd, bytes, sizeof bytes), sizeof bytes);
}

/* Read until the tracker is in @p wanted or a sample comes; what came last. */
static enum gz_result read_until(struct gz_tracker *tracker, enum gz_tracker_state wanted,
				 struct gz_sample *sample)
{
	enum gz_result result = GZ_ERR_TIMEOUT;
	int64_t deadline_ns = gz_clock_now_ns() + 20 * GZ_NS_PER_S;
	while (gz_clock_now_ns() < deadline_ns) {
		result = gz_tracker_read(tracker, 10, sample);
		if (tracker->state == wanted)
			return result;
	}
	fail_msg("%s (%s), waited for %s", gz_tracker_state_name(tracker->state), tracker->reason,
		 gz_tracker_state_name(wanted));
	return result;
}

static void tracker_that_vanishes_is_lost_and_returns_with_numbers_going_on(void **state)
{
	(void)state;
	struct gz_tracker tracker;
	struct gz_sample sample;
	/* Absent at first. */
	assert_int_equal(gz_tracker_open(&tracker, gz_driver_find("template"), settings, &nothing),
			 GZ_OK);
	assert_int_equal(tracker.state, GZ_TRACKER_ABSENT);
	assert_true(tracker.reason[0] != '\0');
	assert_int_equal(gz_tracker_read(&tracker, 1, &sample), GZ_ERR_TIMEOUT);

	uint64_t expected = 0;
	for (int round = 0; round < 2; round++) {
		assert_int_equal(mkfifo(path, 0600), 0);
		/* Read and write, so that opening it waits for nobody. */
		int fd = open(path, O_RDWR | O_CLOEXEC);
		assert_true(fd >= 0);
		for (uint32_t i = 0; i < 3; i++)
			send_report(fd, 2 * i);
		assert_int_equal(read_until(&tracker, GZ_TRACKER_RUNNING, &sample), GZ_OK);
		assert_string_equal(tracker.reason, "");
		for (int i = 0; i < 3; i++) {
			if (i > 0)
				assert_int_equal(gz_tracker_read(&tracker, 1000, &sample), GZ_OK);
			assert_int_equal(sample.seq, expected++);
		}
		/* Unplugged: no name, no writer. */
		unlink(path);
		close(fd);
		assert_int_equal(read_until(&tracker, GZ_TRACKER_LOST, &sample), GZ_ERR_TIMEOUT);
		assert_true(tracker.reason[0] != '\0');
		gz_tracker_update_counters(&tracker);
		assert_int_equal(tracker.counters.lost, 2 * (round + 1));
		assert_int_equal(tracker.samples, expected);
	}
	gz_tracker_close(&tracker);
	assert_null(tracker.device);
}

static void tracker_that_falls_silent_is_lost_until_it_speaks(void **state)
{
	(void)state;
	struct gz_tracker tracker;
	struct gz_sample sample;
	assert_int_equal(mkfifo(path, 0600), 0);
	int fd = open(path, O_RDWR | O_CLOEXEC);
	assert_int_equal(gz_tracker_open(&tracker, gz_driver_find("template"), settings, &nothing),
			 GZ_OK);
	assert_int_equal(tracker.state, GZ_TRACKER_STARTING);
	send_report(fd, 0);
	assert_int_equal(read_until(&tracker, GZ_TRACKER_RUNNING, &sample), GZ_OK);
	assert_int_equal(read_until(&tracker, GZ_TRACKER_LOST, &sample), GZ_ERR_TIMEOUT);
	assert_non_null(tracker.device);
	assert_non_null(strstr(tracker.reason, "no samples"));
	send_report(fd, 1);
	assert_int_equal(read_until(&tracker, GZ_TRACKER_RUNNING, &sample), GZ_OK);
	assert_int_equal(sample.seq, 1);
	gz_tracker_close(&tracker);
	close(fd);
	unlink(path);
}

static void tracker_whose_settings_cannot_work_is_refused_at_once(void **state)
{
	(void)state;
	struct gz_tracker tracker;
	static _Alignas(max_align_t) unsigned char none[GZ_DRIVER_SETTINGS_SIZE];
	assert_int_equal(gz_tracker_open(&tracker, gz_driver_find("template"), none, &nothing),
			 GZ_ERR_INVAL);
	assert_int_equal(gz_tracker_open(&tracker, gz_driver_find("replay"), none, &nothing),
			 GZ_ERR_INVAL);
	gz_tracker_close(&tracker);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(tracker_that_vanishes_is_lost_and_returns_with_numbers_going_on),
		cmocka_unit_test(tracker_that_falls_silent_is_lost_until_it_speaks),
		cmocka_unit_test(tracker_whose_settings_cannot_work_is_refused_at_once),
	};
	return cmocka_run_group_tests(tests, set_up, tear_down);
}
