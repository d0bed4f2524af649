#include "suite.h"

#include <math.h>
#include <stdlib.h>

#include "base/clock.h"
#include "drivers/pupil/pupil_clock.h"

#define START_NS (1000 * GZ_NS_PER_S)

/* A Pupil clock with an offset and a skew, seen through a network. */
struct pupil {
	int64_t ahead_ns;
	double skew;
};

static int64_t shows(const struct pupil *pupil, int64_t host_ns)
{
	return host_ns + pupil->ahead_ns + (int64_t)(pupil->skew * (double)(host_ns - START_NS));
}

/* A round at @p host_ns: most exchanges take 0.2 ms each way, some are delayed on the way back. */
static enum gz_pupil_sync run_round(struct gz_pupil_clock *clock, const struct pupil *pupil,
				    int64_t host_ns)
{
	enum gz_pupil_sync sync = GZ_PUPIL_SYNC_MORE;
	for (int i = 0; i < GZ_PUPIL_EXCHANGES; i++) {
		int64_t sent_ns = host_ns + i * GZ_NS_PER_MS;
		int64_t there_ns = sent_ns + 200 * GZ_NS_PER_US;
		int64_t back_ns = there_ns + 200 * GZ_NS_PER_US;
		if (i % 4 == 3)
			back_ns += 30 * GZ_NS_PER_MS;
		assert_int_equal(sync, GZ_PUPIL_SYNC_MORE);
		sync = gz_pupil_clock_exchange(clock, sent_ns, shows(pupil, there_ns), back_ns);
	}
	return sync;
}

static void assert_maps(struct gz_pupil_clock *clock, const struct pupil *pupil, int64_t host_ns,
			int64_t tolerance_ns)
{
	bool believed;
	int64_t answer_ns = gz_pupil_clock_map(clock, shows(pupil, host_ns),
					       host_ns + 5 * GZ_NS_PER_MS, &believed);
	if (!believed || llabs(answer_ns - host_ns) > tolerance_ns)
		fail_msg("%lld ns off, believed %d", (long long)(answer_ns - host_ns), believed);
}

static void offset_is_found_despite_slow_answers(void **state)
{
	(void)state;
	/* Ahead, behind, and by as much as wall time is ahead of uptime. */
	static const int64_t ahead_ns[] = { 0, 123456789, -987654321012, 1700000000000000000 };
	for (size_t i = 0; i < sizeof ahead_ns / sizeof *ahead_ns; i++) {
		struct gz_pupil_clock clock = { 0 };
		const struct pupil pupil = { .ahead_ns = ahead_ns[i] };
		assert_int_equal(run_round(&clock, &pupil, START_NS), GZ_PUPIL_SYNC_DONE);
		assert_maps(&clock, &pupil, START_NS + GZ_NS_PER_S, 2000);
		struct gz_clock_status status = gz_pupil_clock_status(&clock);
		assert_true(llabs(status.offset_ns + ahead_ns[i]) < 2000);
		assert_int_equal(status.tick, GZ_CLOCK_DECLARED);
		assert_true(status.sigma_ns < 2000);
	}
}

static void equal_delays_both_ways_leave_no_error(void **state)
{
	(void)state;
	/* Pupil time is that of the middle, whatever the round trip. */
	for (int64_t delay_ns = 0; delay_ns <= 10 * GZ_NS_PER_MS; delay_ns += 2 * GZ_NS_PER_MS) {
		struct gz_pupil_clock clock = { 0 };
		for (int i = 0; i < GZ_PUPIL_EXCHANGES; i++)
			gz_pupil_clock_exchange(&clock, START_NS, 5000 + delay_ns / 2,
						START_NS + delay_ns);
		assert_int_equal(gz_pupil_clock_status(&clock).offset_ns, START_NS - 5000);
	}
}

static void drift_is_followed_between_rounds(void **state)
{
	(void)state;
	struct gz_pupil_clock clock = { 0 };
	const struct pupil pupil = { .ahead_ns = GZ_NS_PER_S, .skew = 80e-6 };
	for (int i = 0; i < 20; i++) {
		int64_t host_ns = START_NS + i * 10 * GZ_NS_PER_S;
		assert_int_equal(run_round(&clock, &pupil, host_ns), GZ_PUPIL_SYNC_DONE);
		/* Without the slope the error before the next round would be 0.8 ms. */
		if (i > 0)
			assert_maps(&clock, &pupil, host_ns + 9 * GZ_NS_PER_S, 30000);
	}
	double skew_ppm = gz_pupil_clock_status(&clock).skew_ppm;
	if (fabs(skew_ppm - 80) > 2)
		fail_msg("skew %g ppm, not 80", skew_ppm);
	assert_int_equal(clock.round_count, GZ_PUPIL_ROUNDS);
}

static void first_exchanges_are_used_until_the_round_is_complete(void **state)
{
	(void)state;
	struct gz_pupil_clock clock = { 0 };
	bool believed;
	assert_int_equal(gz_pupil_clock_status(&clock).tick, GZ_CLOCK_NONE);
	/* Nothing is known yet: the answer is the arrival, and is marked as doubtful. */
	assert_int_equal(gz_pupil_clock_map(&clock, 42, START_NS, &believed), START_NS);
	assert_false(believed);
	gz_pupil_clock_exchange(&clock, START_NS, 7 * GZ_NS_PER_S, START_NS + 8 * GZ_NS_PER_MS);
	gz_pupil_clock_exchange(&clock, START_NS, 7 * GZ_NS_PER_S, START_NS + 2 * GZ_NS_PER_MS);
	gz_pupil_clock_exchange(&clock, START_NS, 7 * GZ_NS_PER_S, START_NS + 9 * GZ_NS_PER_MS);
	/* The fastest one counts. */
	assert_int_equal(gz_pupil_clock_status(&clock).offset_ns,
			 START_NS + GZ_NS_PER_MS - 7 * GZ_NS_PER_S);
}

static void clock_that_is_set_restarts_and_answers_never_run_backwards(void **state)
{
	(void)state;
	static const int64_t leaps_ns[] = { 20 * GZ_NS_PER_MS, -20 * GZ_NS_PER_MS,
					    -900 * GZ_NS_PER_S, 1700000000000000000 };
	for (size_t i = 0; i < sizeof leaps_ns / sizeof *leaps_ns; i++) {
		struct gz_pupil_clock clock = { 0 };
		struct pupil pupil = { .ahead_ns = 0 };
		int64_t host_ns = START_NS;
		run_round(&clock, &pupil, host_ns);
		bool believed;
		int64_t last_ns =
			gz_pupil_clock_map(&clock, shows(&pupil, host_ns), host_ns, &believed);
		pupil.ahead_ns = leaps_ns[i];
		host_ns += GZ_NS_PER_S;
		int64_t next_ns =
			gz_pupil_clock_map(&clock, shows(&pupil, host_ns), host_ns, &believed);
		assert_true(next_ns > last_ns && next_ns <= host_ns);
		assert_int_equal(run_round(&clock, &pupil, host_ns), GZ_PUPIL_SYNC_JUMPED);
		assert_maps(&clock, &pupil, host_ns + GZ_NS_PER_S, 2000);
	}
}

static void clock_that_is_set_during_a_round_spoils_only_that_round(void **state)
{
	(void)state;
	struct gz_pupil_clock clock = { 0 };
	struct pupil pupil = { .ahead_ns = 0 };
	run_round(&clock, &pupil, START_NS);
	for (int i = 0; i < GZ_PUPIL_EXCHANGES; i++) {
		int64_t sent_ns = START_NS + GZ_NS_PER_S + i * GZ_NS_PER_MS;
		pupil.ahead_ns = i < 30 ? 0 : 3 * GZ_NS_PER_S;
		assert_int_equal(gz_pupil_clock_exchange(&clock, sent_ns, shows(&pupil, sent_ns),
							 sent_ns + 100),
				 GZ_PUPIL_SYNC_MORE);
	}
	assert_int_equal(run_round(&clock, &pupil, START_NS + 2 * GZ_NS_PER_S),
			 GZ_PUPIL_SYNC_JUMPED);
	assert_maps(&clock, &pupil, START_NS + 3 * GZ_NS_PER_S, 2000);
}

static void answers_rise_and_are_not_ahead_of_the_arrival(void **state)
{
	(void)state;
	struct gz_pupil_clock clock = { 0 };
	const struct pupil pupil = { .ahead_ns = 0 };
	bool believed;
	run_round(&clock, &pupil, START_NS);
	int64_t first_ns = gz_pupil_clock_map(&clock, START_NS + 3000000, START_NS, &believed);
	assert_int_equal(first_ns, START_NS);
	assert_true(believed);
	/* Older than the last one: the next nanosecond. */
	assert_int_equal(gz_pupil_clock_map(&clock, START_NS - 5000000, START_NS, &believed),
			 START_NS + 1);
}

static void any_time_is_accepted(void **state)
{
	(void)state;
	static const int64_t times_ns[] = { INT64_MIN, INT64_MIN + 1, -1, 0, 1, INT64_MAX };
	struct gz_pupil_clock clock = { 0 };
	bool believed;
	int64_t last_ns = 0;
	for (int i = 0; i < 1000; i++) {
		int64_t now_ns = START_NS + i * GZ_NS_PER_MS;
		gz_pupil_clock_exchange(&clock, now_ns, times_ns[i * 7 % 6], now_ns + 1000);
		int64_t host_ns = gz_pupil_clock_map(&clock, times_ns[i % 6], now_ns, &believed);
		assert_true(host_ns > last_ns);
		assert_true(host_ns <= now_ns + 1000);
		assert_true(isfinite(gz_pupil_clock_status(&clock).skew_ppm));
		last_ns = host_ns;
	}
}

TEST_SUITE(pupil_clock)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(offset_is_found_despite_slow_answers),
		cmocka_unit_test(equal_delays_both_ways_leave_no_error),
		cmocka_unit_test(drift_is_followed_between_rounds),
		cmocka_unit_test(first_exchanges_are_used_until_the_round_is_complete),
		cmocka_unit_test(clock_that_is_set_restarts_and_answers_never_run_backwards),
		cmocka_unit_test(clock_that_is_set_during_a_round_spoils_only_that_round),
		cmocka_unit_test(answers_rise_and_are_not_ahead_of_the_arrival),
		cmocka_unit_test(any_time_is_accepted),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
