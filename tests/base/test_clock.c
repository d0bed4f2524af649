#include "suite.h"

#include "base/clock.h"

#include <signal.h>
#include <sys/time.h>
#include <time.h>

static void clock_now_is_clock_monotonic(void **state)
{
	(void)state;
	struct timespec t;
	int64_t before_ns = gz_clock_now_ns();
	assert_int_equal(clock_gettime(CLOCK_MONOTONIC, &t), 0);
	int64_t system_ns = (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
	int64_t after_ns = gz_clock_now_ns();
	assert_in_range(system_ns, before_ns, after_ns);
}

static void clock_now_never_goes_back(void **state)
{
	(void)state;
	int64_t last_ns = gz_clock_now_ns();
	for (int i = 0; i < 10000; i++) {
		int64_t now_ns = gz_clock_now_ns();
		assert_true(now_ns >= last_ns);
		last_ns = now_ns;
	}
}

static void sleep_until_future_deadline_wakes_after_it(void **state)
{
	(void)state;
	int64_t deadline_ns = gz_clock_now_ns() + 5 * GZ_NS_PER_MS;
	gz_clock_sleep_until_ns(deadline_ns);
	assert_true(gz_clock_now_ns() >= deadline_ns);
}

static void sleep_until_past_deadline_returns_at_once(void **state)
{
	(void)state;
	const int64_t past_ns[] = { INT64_MIN, -1, 0, 1, gz_clock_now_ns() };
	int64_t start_ns = gz_clock_now_ns();
	for (size_t i = 0; i < sizeof past_ns / sizeof *past_ns; i++)
		gz_clock_sleep_until_ns(past_ns[i]);
	/* One second for five calls: enough on a busy machine, and short for a test that hangs. */
	assert_true(gz_clock_now_ns() - start_ns < GZ_NS_PER_S);
}

static volatile sig_atomic_t alarms;

static void count_alarm(int number)
{
	(void)number;
	alarms++;
}

static void sleep_until_a_signal_does_not_shorten_it(void **state)
{
	(void)state;
	const struct sigaction action = { .sa_handler = count_alarm };
	const struct itimerval every_ms = { .it_interval = { .tv_usec = 1000 },
					    .it_value = { .tv_usec = 1000 } };
	const struct itimerval never = { 0 };
	assert_int_equal(sigaction(SIGALRM, &action, NULL), 0);
	assert_int_equal(setitimer(ITIMER_REAL, &every_ms, NULL), 0);
	int64_t deadline_ns = gz_clock_now_ns() + 20 * GZ_NS_PER_MS;
	gz_clock_sleep_until_ns(deadline_ns);
	int64_t woke_ns = gz_clock_now_ns();
	assert_int_equal(setitimer(ITIMER_REAL, &never, NULL), 0);
	assert_true(alarms > 0);
	assert_true(woke_ns >= deadline_ns);
}

static void conversions_keep_known_values(void **state)
{
	(void)state;
	assert_float_equal(gz_ns_to_s(1500000000), 1.5, 1e-12);
	assert_float_equal(gz_ns_to_ms(1500000), 1.5, 1e-12);
	assert_float_equal(gz_ns_to_ms(-1500000), -1.5, 1e-12);
}

TEST_SUITE(clock)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(clock_now_is_clock_monotonic),
		cmocka_unit_test(clock_now_never_goes_back),
		cmocka_unit_test(sleep_until_future_deadline_wakes_after_it),
		cmocka_unit_test(sleep_until_past_deadline_returns_at_once),
		cmocka_unit_test(sleep_until_a_signal_does_not_shorten_it),
		cmocka_unit_test(conversions_keep_known_values),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
