#include "suite.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "daemon/tracker.h"
#include "drivers/template_made.h"

/* The device is that of the template driver: a FIFO into which this test writes reports. */
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
	template_made_report(&report, bytes);
	assert_int_equal(write(fd, bytes, sizeof bytes), sizeof bytes);
}

/* Read until the tracker is in state @p wanted or a sample comes. @return the last result */
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
		/* Opened for reading and writing, so that opening does not wait. */
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

/* A driver for USB whose device is there when the test says so. */
static struct {
	enum gz_result answer;
	enum gz_result start; /* what its start returns */
	int looks;
} port;

static enum gz_result port_start(struct gz_device *device)
{
	if (port.start != GZ_OK)
		gz_log_write(device->log, GZ_LOG_ERROR, "port", "it does not start");
	return port.start;
}

static enum gz_result port_read(struct gz_device *device, int timeout_ms,
				struct gz_sample *out_sample)
{
	(void)device;
	(void)timeout_ms;
	*out_sample = gz_sample_unmeasured();
	return port.answer;
}

static void port_info(const struct gz_device *device, struct gz_device_info *out_info)
{
	(void)device;
	strcpy(out_info->name, "port");
}

static void port_counters(const struct gz_device *device, struct gz_device_counters *out_counters)
{
	(void)device;
	(void)out_counters;
}

static void port_destroy(struct gz_device *device)
{
	(void)device;
}

static const struct gz_device_ops port_ops = { port_start, port_read, port_info, port_counters,
					       port_destroy };

static enum gz_result port_create(const void *unused, const struct gz_driver_host *host,
				  struct gz_device **out_device)
{
	static struct gz_device device;
	(void)unused;
	port.looks++;
	if (port.answer != GZ_OK) {
		gz_log_write(host->log, GZ_LOG_ERROR, "port", "%s",
			     port.answer == GZ_ERR_ACCESS ? "install the rule" : "plug it in");
		return port.answer;
	}
	device = (struct gz_device) { &port_ops, host->log };
	*out_device = &device;
	return GZ_OK;
}

static const struct gz_driver port_driver = { .name = "port",
					      .on_usb = true,
					      .create = port_create };

static void arrive(int fd)
{
	assert_int_equal(eventfd_write(fd, 1), 0);
}

static void tracker_on_usb_is_looked_for_at_once_when_something_arrives(void **state)
{
	(void)state;
	struct gz_tracker tracker;
	struct gz_sample sample;
	int fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	port.answer = GZ_ERR_NO_DEVICE;
	port.looks = 0;
	assert_int_equal(gz_tracker_open(&tracker, &port_driver, NULL, &nothing), GZ_OK);
	gz_tracker_watch(&tracker, fd);
	/* Unplugged for long: the next search would come in an hour. */
	tracker.pause_ns = GZ_TRACKER_PAUSE_MAX_MS * GZ_NS_PER_MS;
	tracker.retry_ns = gz_clock_now_ns() + 3600 * GZ_NS_PER_S;
	assert_int_equal(gz_tracker_read(&tracker, 1, &sample), GZ_ERR_TIMEOUT);
	assert_int_equal(port.looks, 1);
	/* Another device arrives, or this one is not ready yet: one search at once, and more soon.
	 * */
	arrive(fd);
	assert_int_equal(gz_tracker_read(&tracker, 10000, &sample), GZ_ERR_TIMEOUT);
	assert_int_equal(port.looks, 2);
	assert_true(tracker.retry_ns < gz_clock_now_ns() + GZ_TRACKER_PAUSE_MIN_MS * GZ_NS_PER_MS);
	tracker.retry_ns = gz_clock_now_ns() + 3600 * GZ_NS_PER_S;
	port.answer = GZ_OK;
	arrive(fd);
	assert_int_equal(gz_tracker_read(&tracker, 10000, &sample), GZ_OK);
	assert_int_equal(tracker.state, GZ_TRACKER_RUNNING);
	/* Unplugged, and back. */
	port.answer = GZ_ERR_NO_DEVICE;
	assert_int_equal(gz_tracker_read(&tracker, 10, &sample), GZ_ERR_TIMEOUT);
	assert_int_equal(tracker.state, GZ_TRACKER_LOST);
	assert_string_equal(tracker.reason, "unplugged");
	tracker.retry_ns = gz_clock_now_ns() + 3600 * GZ_NS_PER_S;
	port.answer = GZ_OK;
	arrive(fd);
	assert_int_equal(gz_tracker_read(&tracker, 10000, &sample), GZ_OK);
	assert_int_equal(tracker.state, GZ_TRACKER_RUNNING);
	assert_int_equal(sample.seq, 1);
	gz_tracker_close(&tracker);
	close(fd);
}

static void arrivals_do_not_matter_to_a_tracker_that_is_not_on_usb(void **state)
{
	(void)state;
	struct gz_tracker tracker;
	struct gz_sample sample;
	static const struct gz_driver elsewhere = { .name = "elsewhere", .create = port_create };
	int fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	port.answer = GZ_ERR_NO_DEVICE;
	port.looks = 0;
	assert_int_equal(gz_tracker_open(&tracker, &elsewhere, NULL, &nothing), GZ_OK);
	gz_tracker_watch(&tracker, fd);
	tracker.retry_ns = gz_clock_now_ns() + 3600 * GZ_NS_PER_S;
	arrive(fd);
	assert_int_equal(gz_tracker_read(&tracker, 5, &sample), GZ_ERR_TIMEOUT);
	assert_int_equal(port.looks, 1);
	gz_tracker_close(&tracker);
	close(fd);
}

static int told_rule, told_plug, told_start, told_gone;

static void count_told(void *user, enum gz_log_level level, const char *module, const char *message)
{
	(void)user;
	(void)level;
	(void)module;
	told_rule += strstr(message, "install the rule") != NULL;
	told_plug += strstr(message, "plug it in") != NULL;
	told_start += strstr(message, "it does not start") != NULL;
	told_gone += strstr(message, "is lost") != NULL;
}

static void tracker_that_is_there_and_never_starts_is_told_of_once_until_it_has_delivered(
	void **state)
{
	(void)state;
	struct gz_log log;
	struct gz_tracker tracker;
	struct gz_sample sample;
	const struct gz_driver_host host = { .log = &log };
	gz_log_init(&log, count_told, NULL, "*:info");
	told_start = told_gone = 0;
	port.answer = GZ_OK;
	port.start = GZ_ERR_IO;
	assert_int_equal(gz_tracker_open(&tracker, &port_driver, NULL, &host), GZ_OK);
	for (int round = 1; round <= 2; round++) {
		for (int i = 0; i < 5; i++) {
			tracker.retry_ns = 0;
			assert_int_equal(gz_tracker_read(&tracker, 1, &sample), GZ_ERR_TIMEOUT);
		}
		assert_int_equal(told_start, round);
		assert_int_equal(told_gone, 2 * round - 1);
		port.start = GZ_OK;
		tracker.retry_ns = 0;
		assert_int_equal(gz_tracker_read(&tracker, 1, &sample), GZ_OK);
		port.answer = GZ_ERR_NO_DEVICE;
		assert_int_equal(gz_tracker_read(&tracker, 1, &sample), GZ_ERR_TIMEOUT);
		assert_int_equal(told_gone, 2 * round);
		port.answer = GZ_OK;
		port.start = GZ_ERR_IO;
	}
	port.start = GZ_OK;
	gz_tracker_close(&tracker);
}

static void tracker_that_never_sends_anything_has_a_reason_to_tell(void **state)
{
	(void)state;
	struct gz_tracker tracker;
	struct gz_sample sample;
	assert_int_equal(mkfifo(path, 0600), 0);
	int fd = open(path, O_RDWR | O_CLOEXEC);
	assert_int_equal(gz_tracker_open(&tracker, gz_driver_find("template"), settings, &nothing),
			 GZ_OK);
	assert_int_equal(gz_tracker_read(&tracker, 1, &sample), GZ_ERR_TIMEOUT);
	assert_string_equal(tracker.reason, "");
	tracker.arrival_ns -= GZ_TRACKER_SILENCE_MS * GZ_NS_PER_MS;
	assert_int_equal(gz_tracker_read(&tracker, 1, &sample), GZ_ERR_TIMEOUT);
	assert_int_equal(tracker.state, GZ_TRACKER_STARTING);
	assert_non_null(strstr(tracker.reason, "no samples yet"));
	send_report(fd, 0);
	assert_int_equal(gz_tracker_read(&tracker, 10000, &sample), GZ_OK);
	assert_string_equal(tracker.reason, "");
	gz_tracker_close(&tracker);
	close(fd);
	unlink(path);
}

static void why_a_tracker_cannot_be_had_is_told_again_only_where_it_changes(void **state)
{
	(void)state;
	struct gz_log log;
	struct gz_tracker tracker;
	struct gz_sample sample;
	const struct gz_driver_host host = { .log = &log };
	gz_log_init(&log, count_told, NULL, "*:info");
	port.answer = GZ_ERR_NO_DEVICE;
	assert_int_equal(gz_tracker_open(&tracker, &port_driver, NULL, &host), GZ_OK);
	assert_int_equal(told_plug, 1);
	assert_string_equal(tracker.reason, "plug it in");
	for (int i = 0; i < 6; i++) {
		if (i == 3)
			port.answer = GZ_ERR_ACCESS;
		tracker.retry_ns = 0;
		assert_int_equal(gz_tracker_read(&tracker, 1, &sample), GZ_ERR_TIMEOUT);
	}
	assert_int_equal(told_plug, 1);
	assert_int_equal(told_rule, 1);
	assert_string_equal(tracker.reason, "install the rule");
	assert_int_equal(tracker.state, GZ_TRACKER_ABSENT);
	gz_tracker_close(&tracker);
}

TEST_SUITE(tracker)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(tracker_that_vanishes_is_lost_and_returns_with_numbers_going_on),
		cmocka_unit_test(tracker_that_falls_silent_is_lost_until_it_speaks),
		cmocka_unit_test(tracker_whose_settings_cannot_work_is_refused_at_once),
		cmocka_unit_test(tracker_on_usb_is_looked_for_at_once_when_something_arrives),
		cmocka_unit_test(arrivals_do_not_matter_to_a_tracker_that_is_not_on_usb),
		cmocka_unit_test(
			tracker_that_is_there_and_never_starts_is_told_of_once_until_it_has_delivered),
		cmocka_unit_test(tracker_that_never_sends_anything_has_a_reason_to_tell),
		cmocka_unit_test(why_a_tracker_cannot_be_had_is_told_again_only_where_it_changes),
	};
	return cmocka_run_group_tests(tests, set_up, tear_down);
}
