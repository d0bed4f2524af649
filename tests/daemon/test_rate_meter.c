#include "suite.h"

#include <math.h>

#include "base/clock.h"
#include "daemon/tracker.h"

static void rate_meter_measures_the_samples_own_times(void **state)
{
	(void)state;
	const double rates_hz[] = { 30, 59.94, 1200, 2000 };
	for (size_t r = 0; r < sizeof rates_hz / sizeof *rates_hz; r++) {
		struct gz_rate_meter meter = { 0 };
		for (int i = 0; i < 3 * (int)rates_hz[r]; i++) {
			gz_rate_meter_step(&meter, (int64_t)(i * 1e9 / rates_hz[r]));
			if (i % (int)rates_hz[r] == (int)rates_hz[r] - 1) {
				double rate_hz = gz_rate_meter_take(&meter);
				if (fabs(rate_hz - rates_hz[r]) > 1e-3)
					fail_msg("%g Hz, is %g", rate_hz, rates_hz[r]);
			}
		}
	}
}

static void rate_meter_without_samples_says_nothing_comes(void **state)
{
	(void)state;
	struct gz_rate_meter meter = { 0 };
	assert_true(gz_rate_meter_take(&meter) == 0);
	gz_rate_meter_step(&meter, 5);
	assert_true(gz_rate_meter_take(&meter) == 0);
}

static void rate_meter_asked_too_soon_gives_its_last_answer(void **state)
{
	(void)state;
	struct gz_rate_meter meter = { 0 };
	for (int i = 0; i <= 100; i++)
		gz_rate_meter_step(&meter, i * 10 * GZ_NS_PER_MS);
	assert_true(fabs(gz_rate_meter_take(&meter) - 100) < 1e-6);
	gz_rate_meter_step(&meter, 1001 * GZ_NS_PER_MS);
	assert_true(fabs(gz_rate_meter_take(&meter) - 100) < 1e-6);
}

static void rate_meter_begins_anew_where_time_runs_backwards(void **state)
{
	(void)state;
	struct gz_rate_meter meter = { 0 };
	gz_rate_meter_step(&meter, INT64_MAX);
	for (int i = 0; i <= 100; i++)
		gz_rate_meter_step(&meter, INT64_MIN + i * 10 * GZ_NS_PER_MS);
	double rate_hz = gz_rate_meter_take(&meter);
	assert_true(rate_hz >= 0 && isfinite(rate_hz));
}

TEST_SUITE(rate_meter)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rate_meter_measures_the_samples_own_times),
		cmocka_unit_test(rate_meter_without_samples_says_nothing_comes),
		cmocka_unit_test(rate_meter_asked_too_soon_gives_its_last_answer),
		cmocka_unit_test(rate_meter_begins_anew_where_time_runs_backwards),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
