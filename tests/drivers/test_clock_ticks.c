#include "suite.h"

#include <math.h>

#include "base/clock.h"
#include "drivers/device/clock_ticks.h"

/* A device: its counter, its sample rate, and the delay of its samples. */
struct device {
	double tick_ns;
	double step_ns; /* step of its clock; 0: one tick */
	uint64_t start;
	unsigned bits;
	double rate_hz;
	double jitter_ns;
	uint64_t random;
};

struct outcome {
	struct gz_clock_ticks ticks;
	int findings[GZ_CLOCK_FOUND_JUMP + 1];
	double worst_ns; /* largest error in the last half, relative to exposure plus the least
			    delay */
	int backwards;
	int late;
};

/* Knuth's MMIX generator, uniform in (0, 1). */
static double uniform(struct device *device)
{
	device->random = device->random * 6364136223846793005u + 1442695040888963407u;
	return ((double)(device->random >> 11) + 0.5) / 9007199254740992.0;
}

static uint64_t counter_at(const struct device *device, double ns)
{
	if (device->step_ns > 0)
		ns = floor(ns / device->step_ns) * device->step_ns;
	uint64_t counter = device->start + (uint64_t)(ns / device->tick_ns);
	return device->bits < 64 ? counter & ((UINT64_C(1) << device->bits) - 1) : counter;
}

static const double DELAY_NS = 3e6;

static struct outcome run(struct device *device, double declared_ns, double seconds)
{
	struct outcome outcome = { 0 };
	int64_t last_ns = INT64_MIN, last_arrival_ns = 0;
	int count = (int)(seconds * device->rate_hz);
	gz_clock_ticks_init(&outcome.ticks, device->bits, declared_ns);
	for (int i = 0; i < count; i++) {
		double ns = 1e9 * i / device->rate_hz;
		int64_t arrival_ns =
			(int64_t)(1e12 + ns + DELAY_NS - log(uniform(device)) * device->jitter_ns);
		if (arrival_ns <= last_arrival_ns)
			arrival_ns = last_arrival_ns + 1;
		last_arrival_ns = arrival_ns;
		struct gz_clock_stamp stamp =
			gz_clock_ticks_step(&outcome.ticks, counter_at(device, ns), arrival_ns);
		outcome.findings[stamp.finding]++;
		outcome.backwards += stamp.host_ns <= last_ns;
		outcome.late += stamp.host_ns > arrival_ns;
		last_ns = stamp.host_ns;
		if (i >= count / 2)
			outcome.worst_ns = fmax(outcome.worst_ns,
						fabs((double)stamp.host_ns - 1e12 - ns - DELAY_NS));
	}
	return outcome;
}

static void expect_finding(const struct outcome *outcome, enum gz_clock_finding finding)
{
	for (int i = GZ_CLOCK_FOUND_DECLARED; i <= GZ_CLOCK_FOUND_JUMP; i++) {
		if (outcome->findings[i] != ((int)finding == i))
			fail_msg("finding %d came %d times, %d was expected; tick %g ns", i,
				 outcome->findings[i], finding, outcome->ticks.tick_ns);
	}
	assert_int_equal(outcome->backwards, 0);
	assert_int_equal(outcome->late, 0);
}

static void ticks_as_declared_are_believed_at_any_rate(void **state)
{
	(void)state;
	const double rates_hz[] = { 30, 60, 250, 1200, 2000 };
	for (size_t i = 0; i < sizeof rates_hz / sizeof *rates_hz; i++) {
		struct device device = { 1000, 0, 5000000, 64, rates_hz[i], 300e3, 1 };
		struct outcome outcome = run(&device, 1000, 12);
		expect_finding(&outcome, GZ_CLOCK_FOUND_DECLARED);
		assert_int_equal(gz_clock_ticks_status(&outcome.ticks).tick, GZ_CLOCK_DECLARED);
		if (outcome.worst_ns > 400e3)
			fail_msg("%g Hz: off by %g us", rates_hz[i], outcome.worst_ns / 1e3);
	}
}

static void ticks_of_another_length_than_declared_are_estimated(void **state)
{
	(void)state;
	static const struct {
		double tick_ns, declared_ns, expected_ns;
	} cases[] = {
		{ 100, 1000, 100 },                     /* a performance counter of 10 MHz */
		{ 1e6, 1000, 1e6 },                     /* milliseconds */
		{ 1000, 100, 1000 },                    /* the reverse */
		{ 1000, 0, 1000 },                      /* no unit */
		{ 1, 1000, 1 },                         /* nanoseconds */
		{ 1e9 / 3579545, 1000, 1e9 / 3579545 }, /* the ACPI timer */
		{ 100.5, 0, 100 },                      /* the rest is skew */
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct device device = { cases[i].tick_ns, 0, 77, 64, 120, 300e3, 1 };
		struct outcome outcome = run(&device, cases[i].declared_ns, 20);
		expect_finding(&outcome, GZ_CLOCK_FOUND_ESTIMATED);
		assert_int_equal(gz_clock_ticks_status(&outcome.ticks).tick, GZ_CLOCK_ESTIMATED);
		if (fabs(outcome.ticks.tick_ns / cases[i].expected_ns - 1) > 2e-3)
			fail_msg("tick %g ns, expected %g", outcome.ticks.tick_ns,
				 cases[i].expected_ns);
		if (outcome.worst_ns > 1e6)
			fail_msg("tick %g ns: off by %g us", cases[i].tick_ns,
				 outcome.worst_ns / 1e3);
	}
}

static void ticks_that_are_too_coarse_are_replaced_by_the_arrival(void **state)
{
	(void)state;
	static const struct {
		double tick_ns, step_ns, rate_hz, declared_ns;
	} cases[] = {
		{ 1000, 15.625e6, 60, 1000 },  /* the Windows clock; its steps are slightly shorter
						  than the sample period */
		{ 1000, 15.625e6, 250, 1000 }, /* its steps are longer */
		{ 1e7, 0, 250, 1e7 },          { 1000, 1e15, 60, 1000 }, /* it stands still */
		{ 100, 15.625e6, 90, 0 },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct device device = {
			cases[i].tick_ns, cases[i].step_ns, 1000, 64, cases[i].rate_hz, 300e3, 1
		};
		struct outcome outcome = run(&device, cases[i].declared_ns, 12);
		expect_finding(&outcome, GZ_CLOCK_FOUND_COARSE);
		struct gz_clock_status status = gz_clock_ticks_status(&outcome.ticks);
		assert_int_equal(status.tick, GZ_CLOCK_NONE);
		assert_int_equal(status.offset_ns, 0);
		if (outcome.worst_ns > 4e6)
			fail_msg("case %zu: off by %g us", i, outcome.worst_ns / 1e3);
	}
}

static void ticks_that_count_samples_are_not_a_coarse_clock(void **state)
{
	(void)state;
	/* A 60 Hz camera that counts its frames: a step of 16.7 ms. */
	struct device device = { 1e9 / 60, 0, 0, 32, 60, 300e3, 1 };
	device.start = 5;
	struct outcome outcome = run(&device, 0, 12);
	/* 60 * (i / 60) is not always i. */
	assert_true(outcome.findings[GZ_CLOCK_FOUND_ESTIMATED] == 1 ||
		    outcome.findings[GZ_CLOCK_FOUND_COARSE] == 1);
	struct gz_clock_ticks ticks;
	int estimated = 0;
	gz_clock_ticks_init(&ticks, 32, 0);
	for (int i = 0; i < 600; i++) {
		struct gz_clock_stamp stamp = gz_clock_ticks_step(
			&ticks, (uint64_t)i, (int64_t)(1e12 + 1e9 * i / 60 + 1e5 * (i % 3)));
		assert_int_not_equal(stamp.finding, GZ_CLOCK_FOUND_COARSE);
		estimated += stamp.finding == GZ_CLOCK_FOUND_ESTIMATED;
	}
	assert_int_equal(estimated, 1);
	assert_true(fabs(ticks.tick_ns / (1e9 / 60) - 1) < 1e-3);
}

static void ticks_wrap_without_a_jump(void **state)
{
	(void)state;
	const unsigned bits[] = { 16, 24, 32, 48, 63, 64 };
	for (size_t i = 0; i < sizeof bits / sizeof *bits; i++) {
		/* A 16-bit counter of 1 ms wraps after 65 s, so start just before the wrap. */
		double tick_ns = bits[i] == 16 ? 1e6 : 1e3;
		uint64_t start =
			bits[i] == 64 ? INT64_MAX - 4000000 : (UINT64_C(1) << bits[i]) - 4000;
		struct device device = { tick_ns, 0, start, bits[i], 250, 300e3, 1 };
		struct outcome outcome = run(&device, tick_ns, 12);
		if (bits[i] < 63) {
			expect_finding(&outcome, GZ_CLOCK_FOUND_DECLARED);
			assert_true(outcome.worst_ns < 2e6);
		}
		/* A counter of 2^63 us has no device time, but host time continues. */
		assert_int_equal(outcome.backwards, 0);
		assert_int_equal(outcome.late, 0);
	}
}

static void ticks_device_time_is_the_devices_own(void **state)
{
	(void)state;
	struct gz_clock_ticks ticks;
	gz_clock_ticks_init(&ticks, 64, 1000);
	for (int i = 0; i < 100; i++) {
		int64_t device_us = INT64_C(86400000000) + i * 8333;
		struct gz_clock_stamp stamp = gz_clock_ticks_step(
			&ticks, (uint64_t)device_us, (int64_t)1e12 + i * INT64_C(8333000));
		assert_int_equal(stamp.device_ns, device_us * 1000);
	}
	/* Without a tick there is no device time. */
	gz_clock_ticks_init(&ticks, 64, 0);
	struct gz_clock_stamp stamp = gz_clock_ticks_step(&ticks, 5, 7);
	assert_int_equal(stamp.device_ns, GZ_NO_DEVICE_TIME);
	assert_int_equal(stamp.host_ns, 7);
	assert_int_equal(gz_clock_ticks_status(&ticks).tick, GZ_CLOCK_NONE);
}

static void ticks_jump_is_reported_once_and_host_time_continues(void **state)
{
	(void)state;
	const int64_t jumps_us[] = { -4000000, 7200000000, -10 };
	for (size_t i = 0; i < sizeof jumps_us / sizeof *jumps_us; i++) {
		struct gz_clock_ticks ticks;
		int jumps = 0;
		int64_t last_ns = 0;
		gz_clock_ticks_init(&ticks, 64, 1000);
		for (int k = 0; k < 1000; k++) {
			int64_t ns = INT64_C(1000000000000) + k * INT64_C(4000000);
			int64_t device_us = ns / 1000 + (k >= 500 ? jumps_us[i] : 0);
			/* 10 us less than the last one: the device clock stepped back. */
			if (jumps_us[i] == -10 && k == 500)
				device_us = ns / 1000 - 4010;
			struct gz_clock_stamp stamp =
				gz_clock_ticks_step(&ticks, (uint64_t)device_us, ns + 1000000);
			jumps += stamp.finding == GZ_CLOCK_FOUND_JUMP;
			assert_true(stamp.host_ns > last_ns && stamp.host_ns <= ns + 1000000);
			last_ns = stamp.host_ns;
		}
		assert_int_equal(jumps, 1);
	}
}

static void ticks_survive_gaps_and_a_stalled_host(void **state)
{
	(void)state;
	struct gz_clock_ticks ticks;
	int told = 0;
	gz_clock_ticks_init(&ticks, 64, 1000);
	for (int k = 0; k < 5000; k++) {
		int64_t ns = INT64_C(1000000000000) + k * INT64_C(4000000);
		/* Blinks of 400 ms; in the first second the host hangs for 300 ms. */
		if (k % 700 < 100 && k > 100)
			continue;
		int64_t arrival_ns = k >= 50 && k < 125 ? INT64_C(1000500000000) + k : ns + 500000;
		struct gz_clock_stamp stamp =
			gz_clock_ticks_step(&ticks, (uint64_t)(ns / 1000), arrival_ns);
		told += stamp.finding != GZ_CLOCK_FOUND_NOTHING;
		assert_true(stamp.finding == GZ_CLOCK_FOUND_NOTHING ||
			    stamp.finding == GZ_CLOCK_FOUND_DECLARED);
	}
	assert_int_equal(told, 1);
}

static void ticks_accept_any_counters_and_times(void **state)
{
	(void)state;
	static const uint64_t counters[] = {
		0, 1, UINT64_MAX, INT64_MAX, UINT64_C(1) << 63, 12345, UINT32_MAX
	};
	const double declared[] = { 0, 1, 1e3, 1e-128, 1e128, 1e18 };
	for (size_t d = 0; d < sizeof declared / sizeof *declared; d++) {
		for (unsigned bits = 1; bits <= 64; bits++) {
			struct gz_clock_ticks ticks;
			int64_t last_ns = INT64_MIN;
			gz_clock_ticks_init(&ticks, bits, declared[d]);
			for (int k = 0; k < 343; k++) {
				struct gz_clock_stamp stamp =
					gz_clock_ticks_step(&ticks, counters[(k * 5 + k / 7) % 7],
							    k * INT64_C(77000000));
				assert_true(k == 0 || stamp.host_ns > last_ns);
				last_ns = stamp.host_ns;
			}
			gz_clock_ticks_status(&ticks);
		}
	}
}

TEST_SUITE(clock_ticks)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ticks_as_declared_are_believed_at_any_rate),
		cmocka_unit_test(ticks_of_another_length_than_declared_are_estimated),
		cmocka_unit_test(ticks_that_are_too_coarse_are_replaced_by_the_arrival),
		cmocka_unit_test(ticks_that_count_samples_are_not_a_coarse_clock),
		cmocka_unit_test(ticks_wrap_without_a_jump),
		cmocka_unit_test(ticks_device_time_is_the_devices_own),
		cmocka_unit_test(ticks_jump_is_reported_once_and_host_time_continues),
		cmocka_unit_test(ticks_survive_gaps_and_a_stalled_host),
		cmocka_unit_test(ticks_accept_any_counters_and_times),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
