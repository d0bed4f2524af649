#include "suite.h"

#include <math.h>
#include <stdlib.h>

#include "base/clock.h"
#include "drivers/device/clock_model.h"

/* A device and its link, as the host sees them. */
struct link {
	double skew;       /* device clock over host clock */
	int64_t offset_ns; /* device time at host time 0 */
	int64_t delay_ns;  /* constant part of the delay */
	double jitter_ns;  /* mean of the random part of the delay */
	uint64_t random;
};

/* Uniform in (0, 1): Knuth's MMIX generator. */
static double uniform(struct link *link)
{
	link->random = link->random * 6364136223846793005u + 1442695040888963407u;
	return ((double)(link->random >> 11) + 0.5) / 9007199254740992.0;
}

static int64_t device_time(const struct link *link, int64_t host_ns)
{
	return host_ns + (int64_t)((double)host_ns * link->skew) + link->offset_ns;
}

static int64_t arrival(struct link *link, int64_t host_ns)
{
	return host_ns + link->delay_ns + (int64_t)(-log(uniform(link)) * link->jitter_ns);
}

struct errors {
	double worst_ns; /* after the first 3 s, relative to exposure plus constant delay */
	int jumps;
	int backwards;
	int late; /* answers later than the arrival */
};

static struct errors run_link(struct gz_clock_model *model, struct link *link, double rate_hz,
			      double seconds)
{
	struct errors errors = { 0 };
	int64_t last_ns = INT64_MIN, last_arrival_ns = 0;
	for (int i = 0; i < (int)(rate_hz * seconds); i++) {
		int64_t host_ns = (int64_t)(1e9 * i / rate_hz);
		int64_t arrival_ns = arrival(link, host_ns);
		bool jumped;
		if (arrival_ns < last_arrival_ns)
			arrival_ns = last_arrival_ns;
		last_arrival_ns = arrival_ns;
		int64_t answer_ns =
			gz_clock_model_step(model, device_time(link, host_ns), arrival_ns, &jumped);
		double error_ns = fabs((double)(answer_ns - host_ns - link->delay_ns));
		errors.jumps += jumped;
		errors.backwards += answer_ns <= last_ns;
		errors.late += answer_ns > arrival_ns;
		if (host_ns > 3 * GZ_NS_PER_S && error_ns > errors.worst_ns)
			errors.worst_ns = error_ns;
		last_ns = answer_ns;
	}
	return errors;
}

static void clock_model_follows_offset_and_skew_through_jitter(void **state)
{
	(void)state;
	const double rates_hz[] = { 30, 120, 1200, 2000 };
	const double skews[] = { 0, 50e-6, -80e-6, 5e-3 };
	for (size_t r = 0; r < 4; r++) {
		for (size_t s = 0; s < 4; s++) {
			struct gz_clock_model model = { 0 };
			struct link link = { skews[s], -7777777777, 4000000, 200000, 1 };
			struct errors errors = run_link(&model, &link, rates_hz[r], 30);
			struct gz_clock_status status =
				gz_clock_model_status(&model, GZ_CLOCK_DECLARED);
			if (errors.worst_ns > 150e3)
				fail_msg("%g Hz, skew %g: off by %g us", rates_hz[r], skews[s],
					 errors.worst_ns / 1e3);
			if (fabs(status.skew_ppm - skews[s] * 1e6) > 10)
				fail_msg("%g Hz: skew %g ppm, is %g", rates_hz[r], status.skew_ppm,
					 skews[s] * 1e6);
			assert_int_equal(errors.jumps, 0);
			assert_int_equal(errors.backwards, 0);
			assert_int_equal(errors.late, 0);
			assert_true(status.sigma_ns > 0 && status.sigma_ns < 100e3);
			assert_int_equal(status.tick, GZ_CLOCK_DECLARED);
		}
	}
}

static void clock_model_exact_link_is_followed_exactly(void **state)
{
	(void)state;
	struct gz_clock_model model = { 0 };
	struct link link = { 0, 123456789, 1000000, 0, 1 };
	struct errors errors = run_link(&model, &link, 500, 20);
	struct gz_clock_status status = gz_clock_model_status(&model, GZ_CLOCK_ESTIMATED);
	assert_true(errors.worst_ns <= 1);
	assert_int_equal(status.offset_ns, 1000000 - 123456789);
	assert_true(status.sigma_ns < 1 && fabs(status.skew_ppm) < 0.01);
}

static void clock_model_restarts_when_the_device_clock_jumps(void **state)
{
	(void)state;
	const int64_t jumps_ns[] = { -5 * GZ_NS_PER_S, 3600 * GZ_NS_PER_S, -1, 100000000,
				     INT64_MAX / 4 };
	for (size_t i = 0; i < sizeof jumps_ns / sizeof *jumps_ns; i++) {
		struct gz_clock_model model = { 0 };
		int64_t last_ns = 0;
		int jumps = 0;
		for (int k = 0; k < 10000; k++) {
			int64_t host_ns = 1000000000000 + k * GZ_NS_PER_MS;
			int64_t device_ns = k * GZ_NS_PER_MS + (k >= 5000 ? jumps_ns[i] : 0);
			bool jumped;
			if (jumps_ns[i] == -1 && k == 5000)
				device_ns = 4999 * GZ_NS_PER_MS; /* repeats the time */
			int64_t answer_ns =
				gz_clock_model_step(&model, device_ns, host_ns + 500000, &jumped);
			jumps += jumped;
			assert_true(k == 0 || answer_ns > last_ns);
			assert_true(answer_ns <= host_ns + 500000);
			last_ns = answer_ns;
		}
		if (jumps != 1)
			fail_msg("a jump of %lld ns: %d segments more", (long long)jumps_ns[i],
				 jumps);
	}
}

static void clock_model_small_step_back_of_the_device_is_a_jump_once_it_lasts(void **state)
{
	(void)state;
	struct gz_clock_model model = { 0 };
	int jumps = 0;
	/* The device clock loses 0.3 s between two samples: from then on every sample seems late.
	 */
	for (int k = 0; k < 4000; k++) {
		int64_t arrival_ns = k * GZ_NS_PER_MS + (k >= 2000 ? 300 * GZ_NS_PER_MS : 0);
		bool jumped;
		gz_clock_model_step(&model, k * GZ_NS_PER_MS, arrival_ns, &jumped);
		jumps += jumped;
		if (k < 2400)
			assert_int_equal(jumps, 0);
	}
	assert_int_equal(jumps, 1);
}

static void clock_model_burst_after_a_stall_keeps_the_device_times(void **state)
{
	(void)state;
	struct gz_clock_model model = { 0 };
	/* The host sleeps for 0.4 s and then finds 400 samples at once. */
	for (int k = 0; k < 4000; k++) {
		int64_t due_ns = k * GZ_NS_PER_MS;
		int64_t arrival_ns = k >= 2000 && k < 2400 ? 2400 * GZ_NS_PER_MS : due_ns;
		bool jumped;
		int64_t answer_ns = gz_clock_model_step(&model, due_ns + 5, arrival_ns, &jumped);
		assert_false(jumped);
		assert_true(llabs(answer_ns - due_ns) < 1000);
	}
}

static void clock_model_accepts_any_times(void **state)
{
	(void)state;
	static const int64_t times[] = { 0, 1, -1, INT64_MAX, INT64_MIN, INT64_MAX - 1, 42 };
	struct gz_clock_model model = { 0 };
	int64_t last_ns = INT64_MIN;
	for (int k = 0; k < 7 * 7 * 7; k++) {
		int64_t device_ns = times[(k * 5 + k / 7) % 7];
		int64_t answer_ns = gz_clock_model_step(&model, device_ns, k, NULL);
		assert_true(answer_ns > last_ns);
		last_ns = answer_ns;
	}
	gz_clock_model_status(&model, GZ_CLOCK_NONE);
}

static void clock_that_is_behind_by_up_to_a_second_has_not_restarted(void **state)
{
	(void)state;
	assert_true(gz_clock_is_behind(5, 5));
	assert_true(gz_clock_is_behind(-1, GZ_NS_PER_S - 2));
	assert_false(gz_clock_is_behind(-1, GZ_NS_PER_S - 1));
	assert_false(gz_clock_is_behind(6, 5));
	/* The difference of these is not an int64_t. */
	assert_false(gz_clock_is_behind(INT64_MAX, INT64_MIN));
	assert_false(gz_clock_is_behind(INT64_MIN, INT64_MAX));
}

static void clock_unwrap_follows_wraps_and_small_steps_back(void **state)
{
	(void)state;
	assert_int_equal(gz_clock_unwrap32(0, 5), 5);
	assert_int_equal(gz_clock_unwrap32(0xfffffff0, 0xfffffff8), 0xfffffff8);
	assert_int_equal(gz_clock_unwrap32(0xfffffff0, 0x10), 0x100000010);
	assert_int_equal(gz_clock_unwrap32(0x500000010, 0xfffffff0), 0x4fffffff0);
	assert_int_equal(gz_clock_unwrap32(5, 0xfffffff0), 0xfffffff0);
}

TEST_SUITE(clock_model)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(clock_model_follows_offset_and_skew_through_jitter),
		cmocka_unit_test(clock_model_exact_link_is_followed_exactly),
		cmocka_unit_test(clock_model_restarts_when_the_device_clock_jumps),
		cmocka_unit_test(clock_model_small_step_back_of_the_device_is_a_jump_once_it_lasts),
		cmocka_unit_test(clock_model_burst_after_a_stall_keeps_the_device_times),
		cmocka_unit_test(clock_model_accepts_any_times),
		cmocka_unit_test(clock_that_is_behind_by_up_to_a_second_has_not_restarted),
		cmocka_unit_test(clock_unwrap_follows_wraps_and_small_steps_back),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
