/* The pointer of a viewer: the feed between two threads, and the driver that reads it. */
#include "suite.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

#include "base/clock.h"
#include "driver_stage.h"
#include "drivers/pointer/pointer_driver.h"

static struct gz_pointer_feed *feed;
static struct driver_stage stage;

static struct gz_pointer_report report_at(int64_t host_ns, float x)
{
	return (struct gz_pointer_report) { .host_ns = host_ns,
					    .known = true,
					    .point = { x, 0.5f } };
}

static void put(int64_t host_ns, float x)
{
	struct gz_pointer_report report = report_at(host_ns, x);
	assert_true(gz_pointer_feed_put(feed, &report));
}

static int make_feed(void **state)
{
	(void)state;
	return gz_pointer_feed_create(&feed) == GZ_OK ? 0 : -1;
}

static int free_feed(void **state)
{
	(void)state;
	gz_pointer_feed_destroy(&feed);
	gz_pointer_feed_destroy(&feed);
	gz_pointer_feed_destroy(NULL);
	return feed ? -1 : 0;
}

static struct gz_device *open_device(const char *rate, const char *timeout)
{
	stage_reset(&stage, "pointer");
	stage_set(&stage, "pointer.rate_hz", rate);
	stage_set(&stage, "pointer.timeout_ms", timeout);
	stage.host.pointer = feed;
	return stage_start(&stage);
}

static void feed_returns_due_reports_in_order(void **state)
{
	(void)state;
	struct gz_pointer_report report;
	assert_false(gz_pointer_feed_take(feed, INT64_MAX, &report));
	put(10, 0.1f);
	put(20, 0.2f);
	assert_false(gz_pointer_feed_take(feed, 9, &report));
	assert_true(gz_pointer_feed_take(feed, 10, &report));
	assert_true(report.point.x == 0.1f);
	assert_false(gz_pointer_feed_take(feed, 19, &report));
	assert_true(gz_pointer_feed_take(feed, 30, &report));
	assert_true(report.host_ns == 20);
	assert_false(gz_pointer_feed_take(feed, INT64_MAX, &report));
}

static void full_feed_refuses_and_continues(void **state)
{
	(void)state;
	struct gz_pointer_report report = report_at(1, 0.5f);
	for (int i = 0; i < GZ_POINTER_FEED_SIZE; i++)
		assert_true(gz_pointer_feed_put(feed, &report));
	assert_false(gz_pointer_feed_put(feed, &report));
	assert_true(gz_pointer_feed_take(feed, 1, &report));
	assert_true(gz_pointer_feed_put(feed, &report));
	assert_false(gz_pointer_feed_put(feed, &report));
}

enum { MANY = 200000 };

static void *put_many(void *user)
{
	(void)user;
	for (int64_t i = 0; i < MANY;) {
		struct gz_pointer_report report = report_at(i, (float)i);
		if (gz_pointer_feed_put(feed, &report))
			i++;
	}
	return NULL;
}

static void feed_between_threads_keeps_every_report_whole(void **state)
{
	(void)state;
	pthread_t thread;
	struct gz_pointer_report report;
	assert_int_equal(pthread_create(&thread, NULL, put_many, NULL), 0);
	for (int64_t i = 0; i < MANY;) {
		if (!gz_pointer_feed_take(feed, INT64_MAX, &report))
			continue;
		if (report.host_ns != i || report.point.x != (float)i)
			fail_msg("%lld and %g, expected %lld", (long long)report.host_ns,
				 report.point.x, (long long)i);
		i++;
	}
	pthread_join(thread, NULL);
}

static void no_pointer_is_an_invalid_sample(void **state)
{
	(void)state;
	struct gz_device *device = open_device("500", "1000");
	struct gz_sample sample = device_read_sample(device);
	assert_false(sample.valid);
	assert_true(isnan(sample.point.x));
	assert_true(sample.device_ns == GZ_NO_DEVICE_TIME);
	gz_device_destroy(&device);
}

static void pointer_at_rest_stays_and_is_sampled_evenly(void **state)
{
	(void)state;
	struct gz_device *device = open_device("500", "60000");
	put(gz_clock_now_ns() - 1, 0.25f);
	struct gz_sample first = device_read_sample(device), sample = first;
	for (int i = 1; i < 50; i++)
		sample = device_read_sample(device);
	assert_true(sample.valid && sample.point.x == 0.25f && sample.point.y == 0.5f);
	assert_true(gz_sample_combined_only(&sample));
	/* Whether or not the reader was late, unless it was too late. */
	int64_t steps = 49 + (int64_t)sample.lost_before;
	if (sample.lost_before == 0 && sample.host_ns - first.host_ns < steps * 2 * GZ_NS_PER_MS)
		fail_msg("%lld ns for %lld steps", (long long)(sample.host_ns - first.host_ns),
			 (long long)steps);
	assert_int_equal((sample.host_ns - first.host_ns) % (2 * GZ_NS_PER_MS), 0);
	gz_device_destroy(&device);
}

static void samples_have_the_position_of_their_own_time(void **state)
{
	(void)state;
	struct gz_device *device = open_device("100", "60000");
	int64_t now_ns = gz_clock_now_ns();
	/* A report is not used before its time. */
	put(now_ns - 1, 0.1f);
	put(now_ns + 35 * GZ_NS_PER_MS, 0.2f);
	for (int i = 0; i < 12; i++) {
		struct gz_sample sample = device_read_sample(device);
		float expected = sample.host_ns < now_ns - 1                   ? NAN
				 : sample.host_ns < now_ns + 35 * GZ_NS_PER_MS ? 0.1f
									       : 0.2f;
		if (isnan(expected) ? sample.valid : sample.point.x != expected)
			fail_msg("sample %d: %g, expected %g", i, sample.point.x, expected);
	}
	gz_device_destroy(&device);
}

static void pointer_that_leaves_or_times_out_is_invalid(void **state)
{
	(void)state;
	struct gz_device *device = open_device("500", "50");
	int64_t now_ns = gz_clock_now_ns();
	const struct gz_pointer_report gone = { .host_ns = gz_clock_now_ns(), .known = false };
	put(now_ns - 1, 0.5f);
	struct gz_sample sample;
	do
		sample = device_read_sample(device);
	while (sample.host_ns <= now_ns + 50 * GZ_NS_PER_MS - 1);
	assert_false(sample.valid);
	assert_true(isnan(sample.point.x));
	put(gz_clock_now_ns() + 60000 * GZ_NS_PER_MS, 0.5f); /* no further report for a minute */
	assert_false(device_read_sample(device).valid);
	gz_device_destroy(&device);
	gz_pointer_feed_destroy(&feed);
	assert_int_equal(gz_pointer_feed_create(&feed), GZ_OK);
	device = open_device("500", "0");
	put(1, 0.5f); /* reported when the machine was started */
	assert_true(device_read_sample(device).valid);
	assert_true(gz_pointer_feed_put(feed, &gone));
	assert_false(device_read_sample(device).valid);
	gz_device_destroy(&device);
}

static void late_reader_learns_what_it_lost(void **state)
{
	(void)state;
	struct gz_device *device = open_device("1000", "0");
	struct gz_device_counters counters;
	struct gz_sample first = device_read_sample(device);
	gz_clock_sleep_until_ns(first.host_ns + 300 * GZ_NS_PER_MS);
	struct gz_sample sample = device_read_sample(device);
	int64_t missing = (sample.host_ns - first.host_ns) / GZ_NS_PER_MS - 1;
	gz_device_get_counters(device, &counters);
	assert_true(missing >= 298);
	assert_int_equal(sample.lost_before, missing);
	assert_int_equal(counters.lost, missing);
	assert_int_equal(sample.seq, 1);
	gz_device_destroy(&device);
}

static void without_a_feed_there_is_no_device(void **state)
{
	(void)state;
	struct gz_device *device;
	stage_reset(&stage, "pointer");
	assert_int_equal(stage_create(&stage, NULL, &device), GZ_ERR_UNSUPPORTED);
	assert_null(device);
}

#define WITH_FEED(test) cmocka_unit_test_setup_teardown(test, make_feed, free_feed)

TEST_SUITE(pointer)
{
	const struct CMUnitTest tests[] = {
		WITH_FEED(feed_returns_due_reports_in_order),
		WITH_FEED(full_feed_refuses_and_continues),
		WITH_FEED(feed_between_threads_keeps_every_report_whole),
		WITH_FEED(no_pointer_is_an_invalid_sample),
		WITH_FEED(pointer_at_rest_stays_and_is_sampled_evenly),
		WITH_FEED(samples_have_the_position_of_their_own_time),
		WITH_FEED(pointer_that_leaves_or_times_out_is_invalid),
		WITH_FEED(late_reader_learns_what_it_lost),
		cmocka_unit_test(without_a_feed_there_is_no_device),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
