#include "suite.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "sim/tracker.h"

#define CHECK_BETWEEN(got, low, high)                                                   \
	do {                                                                            \
		double g = (got), l = (low), h = (high);                                \
		if (!(g >= l && g <= h))                                                \
			fail_msg("%s is %.9g, not within %.9g to %.9g", #got, g, l, h); \
	} while (0)

static const int64_t START_NS = INT64_C(123456789000);

static struct gz_sim_tracker *tracker_of(const struct gz_sim_params *params)
{
	struct gz_sim_tracker *tracker = NULL;
	assert_int_equal(gz_sim_tracker_create(params, START_NS, NULL, &tracker), GZ_OK);
	return tracker;
}

static struct gz_sim_params clean_params(double rate_hz)
{
	struct gz_sim_params params = gz_sim_default_params();
	params.rate_hz = rate_hz;
	params.noise_deg = params.offset_deg = params.loss = params.eye_loss = params.spikes = 0;
	params.latency_jitter_ms = 0;
	return params;
}

static void every_preset_parses(void **state)
{
	(void)state;
	struct gz_sim_params params;
	for (size_t i = 0; i < gz_sim_option_count; i++) {
		char message[256] = "";
		const struct gz_option *option = &gz_sim_options[i];
		enum gz_result r =
			gz_option_parse(option, option->preset, &params, message, sizeof message);
		if (r != GZ_OK)
			fail_msg("%s: %s", option->key, message);
	}
	assert_true(gz_sim_default_params().rate_hz == 120);
}

static void same_seed_gives_the_same_bits(void **state)
{
	(void)state;
	struct gz_sim_params params = gz_sim_default_params();
	params.rate_hz = 500;
	struct gz_sim_tracker *a = tracker_of(&params), *b = tracker_of(&params);
	for (int i = 0; i < 20000; i++) {
		struct gz_sim_sample x, y;
		memset(&x, 0, sizeof x);
		memset(&y, 0, sizeof y);
		gz_sim_tracker_next(a, &x);
		gz_sim_tracker_next(b, &y);
		assert_memory_equal(&x.sample.point, &y.sample.point, sizeof x.sample.point);
		assert_memory_equal(&x.sample.eye[0].point, &y.sample.eye[0].point,
				    sizeof x.sample.eye[0].point);
		assert_memory_equal(&x.truth.point, &y.truth.point, sizeof x.truth.point);
		assert_int_equal(x.arrival_ns, y.arrival_ns);
		assert_int_equal(x.sample.device_ns, y.sample.device_ns);
	}
	gz_sim_tracker_destroy(&a);
	gz_sim_tracker_destroy(&b);
}

/* FNV-1a hash of the measurements. */
static uint64_t digest(const struct gz_sim_params *params, int count)
{
	struct gz_sim_tracker *tracker = tracker_of(params);
	uint64_t hash = UINT64_C(14695981039346656037);
	for (int i = 0; i < count; i++) {
		struct gz_sim_sample s;
		gz_sim_tracker_next(tracker, &s);
		float values[] = { s.sample.valid ? s.sample.point.x : 9,
				   s.sample.valid ? s.sample.point.y : 9, s.truth.point.x,
				   s.truth.point.y, (float)s.truth.velocity_deg_s };
		for (size_t k = 0; k < sizeof values; k++)
			hash = (hash ^ ((const unsigned char *)values)[k]) *
			       UINT64_C(1099511628211);
	}
	gz_sim_tracker_destroy(&tracker);
	return hash;
}

static void the_sequence_is_the_same_on_every_machine(void **state)
{
	(void)state;
	struct gz_sim_params params = gz_sim_default_params();
	params.rate_hz = 500;
	uint64_t hash = digest(&params, 20000);
	if (hash != UINT64_C(13901986022408306648))
		fail_msg("digest is %llu", (unsigned long long)hash);
}

static void another_seed_gives_another_sequence(void **state)
{
	(void)state;
	struct gz_sim_params params = gz_sim_default_params();
	uint64_t first = digest(&params, 1000);
	params.seed = 2;
	assert_int_not_equal(first, digest(&params, 1000));
}

static void noise_does_not_change_the_truth(void **state)
{
	(void)state;
	struct gz_sim_params quiet = clean_params(250), noisy = clean_params(250);
	noisy.noise_deg = 1;
	noisy.eye_loss = 0.2;
	struct gz_sim_tracker *a = tracker_of(&quiet), *b = tracker_of(&noisy);
	for (int i = 0; i < 5000; i++) {
		struct gz_sim_sample x, y;
		gz_sim_tracker_next(a, &x);
		gz_sim_tracker_next(b, &y);
		assert_memory_equal(&x.truth.point, &y.truth.point, sizeof x.truth.point);
	}
	gz_sim_tracker_destroy(&a);
	gz_sim_tracker_destroy(&b);
}

static void every_rate_is_kept(void **state)
{
	(void)state;
	static const double rates_hz[] = { 30, 59.94, 120, 500, 1200, 2000 };
	for (size_t i = 0; i < sizeof rates_hz / sizeof rates_hz[0]; i++) {
		struct gz_sim_params params = clean_params(rates_hz[i]);
		struct gz_sim_tracker *tracker = tracker_of(&params);
		int64_t last_ns = 0;
		for (uint64_t k = 0; k < 5000; k++) {
			struct gz_sim_sample s;
			gz_sim_tracker_next(tracker, &s);
			assert_int_equal(s.sample.seq, k);
			int64_t wanted_ns = START_NS + llround((double)k * 1e9 / rates_hz[i]);
			assert_true(llabs(s.sample.host_ns - wanted_ns) <= 1);
			assert_true(s.sample.host_ns > last_ns);
			last_ns = s.sample.host_ns;
		}
		gz_sim_tracker_destroy(&tracker);
	}
}

static void lost_samples_are_the_wanted_part_and_counted(void **state)
{
	(void)state;
	struct gz_sim_params params = clean_params(1000);
	params.loss = 0.1;
	struct gz_sim_tracker *tracker = tracker_of(&params);
	uint64_t lost = 0;
	const int count = 50000;
	struct gz_sim_sample s;
	for (int i = 0; i < count; i++) {
		gz_sim_tracker_next(tracker, &s);
		lost += s.sample.lost_before;
	}
	CHECK_BETWEEN((double)lost / (double)(lost + count), 0.095, 0.105);
	double elapsed_s = gz_ns_to_s(s.sample.host_ns - START_NS);
	CHECK_BETWEEN(elapsed_s, (double)(lost + count - 1) / 1000 - 1e-6,
		      (double)(lost + count - 1) / 1000 + 1e-6);
	gz_sim_tracker_destroy(&tracker);
}

static void noise_and_eye_loss_are_as_wanted(void **state)
{
	(void)state;
	struct gz_sim_params params = clean_params(500);
	params.noise_deg = 0.5;
	params.eye_loss = 0.1;
	params.viewer.blinks_per_min = 0;
	struct gz_sim_tracker *tracker = tracker_of(&params);
	struct gz_display display = gz_sim_tracker_display(tracker);
	double squares = 0;
	int seen = 0, one_eyed = 0;
	const int count = 100000;
	for (int i = 0; i < count; i++) {
		struct gz_sim_sample s;
		gz_sim_tracker_next(tracker, &s);
		one_eyed += !s.sample.eye[0].valid || !s.sample.eye[1].valid;
		if (!s.sample.eye[0].valid) {
			assert_true(isnan(s.sample.eye[0].point.x));
			continue;
		}
		double deg = gz_display_angle_deg(&display, s.sample.eye[0].point, s.truth.point);
		squares += deg * deg;
		seen++;
	}
	CHECK_BETWEEN(sqrt(squares / seen / 2), 0.49, 0.51);
	CHECK_BETWEEN((double)one_eyed / count, 0.08, 0.12);
	gz_sim_tracker_destroy(&tracker);
}

static void blinks_measure_nothing(void **state)
{
	(void)state;
	struct gz_sim_params params = clean_params(200);
	params.viewer.blinks_per_min = 60;
	struct gz_sim_tracker *tracker = tracker_of(&params);
	int blinks = 0;
	for (int i = 0; i < 20000; i++) {
		struct gz_sim_sample s;
		gz_sim_tracker_next(tracker, &s);
		assert_int_equal(s.sample.valid, s.truth.event != GZ_EVENT_BLINK);
		if (!s.sample.valid) {
			assert_true(isnan(s.sample.point.x) && isnan(s.sample.eye[1].point.y));
			blinks++;
		}
	}
	assert_true(blinks > 500);
	gz_sim_tracker_destroy(&tracker);
}

/* With lids, a blink begins and ends with pupils that become smaller and points that sink; the
 * truth is the same as without. */
static void lids_cover_pupils_before_they_are_lost(void **state)
{
	(void)state;
	struct gz_sim_params params = clean_params(1000);
	params.viewer.blinks_per_min = 30;
	struct gz_sim_tracker *plain = tracker_of(&params);
	params.lids = true;
	struct gz_sim_tracker *lids = tracker_of(&params);
	int flanks = 0, hidden = 0;
	for (int i = 0; i < 60000; i++) {
		struct gz_sim_sample x, y;
		gz_sim_tracker_next(plain, &x);
		gz_sim_tracker_next(lids, &y);
		assert_memory_equal(&x.truth.point, &y.truth.point, sizeof x.truth.point);
		assert_int_equal(x.truth.event, y.truth.event);
		assert_true(y.truth.lid >= 0 && y.truth.lid <= 1);
		if (y.truth.event != GZ_EVENT_BLINK) {
			assert_true(y.truth.lid == 0);
			assert_memory_equal(&x.sample.eye, &y.sample.eye, sizeof x.sample.eye);
			continue;
		}
		const struct gz_eye_sample *eye = &y.sample.eye[GZ_EYE_LEFT];
		if (!eye->valid)
			hidden++;
		else if (eye->pupil_mm < 3.1F) {
			flanks++;
			assert_true(eye->point.y > y.truth.point.y + 0.05F);
		}
	}
	CHECK_BETWEEN(hidden, 1000, 6000);
	CHECK_BETWEEN(flanks, 300, 1500);
	gz_sim_tracker_destroy(&plain);
	gz_sim_tracker_destroy(&lids);
}

static void combined_only_measures_no_eye(void **state)
{
	(void)state;
	struct gz_sim_params params = clean_params(120);
	params.combined_only = true;
	params.viewer.blinks_per_min = 0;
	struct gz_sim_tracker *tracker = tracker_of(&params);
	for (int i = 0; i < 1000; i++) {
		struct gz_sim_sample s;
		gz_sim_tracker_next(tracker, &s);
		assert_true(gz_sample_combined_only(&s.sample));
		CHECK_BETWEEN(s.sample.point.x, s.truth.point.x - 1e-5, s.truth.point.x + 1e-5);
	}
	gz_sim_tracker_destroy(&tracker);
}

static void calibration_moves_the_measurement_and_not_the_truth(void **state)
{
	(void)state;
	struct gz_sim_params params = clean_params(250);
	params.viewer.blinks_per_min = 0;
	struct gz_sim_tracker *good = tracker_of(&params);
	params.calibration_x[0] = 0.02;
	params.calibration_x[1] = 1.1;
	params.calibration_y[1] = -0.05;
	struct gz_sim_tracker *bad = tracker_of(&params);
	for (int i = 0; i < 2000; i++) {
		struct gz_sim_sample a, b;
		gz_sim_tracker_next(good, &a);
		gz_sim_tracker_next(bad, &b);
		assert_memory_equal(&a.truth.point, &b.truth.point, sizeof a.truth.point);
		for (int eye = 0; eye < GZ_EYE_COUNT; eye++) {
			struct gz_point p = a.sample.eye[eye].point, q = b.sample.eye[eye].point;
			CHECK_BETWEEN(q.x - (0.02 + 1.1 * p.x), -1e-6, 1e-6);
			CHECK_BETWEEN(q.y - (p.y - 0.05 * p.x), -1e-6, 1e-6);
		}
		CHECK_BETWEEN(b.sample.point.x - (0.02 + 1.1 * a.sample.point.x), -1e-6, 1e-6);
	}
	gz_sim_tracker_destroy(&good);
	gz_sim_tracker_destroy(&bad);
}

static void eyes_look_from_their_place_to_the_point(void **state)
{
	(void)state;
	struct gz_sim_params params = clean_params(120);
	struct gz_sim_tracker *tracker = tracker_of(&params);
	struct gz_display display = gz_sim_tracker_display(tracker);
	struct gz_sim_sample s;
	gz_sim_tracker_next(tracker, &s);
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		const struct gz_eye_sample *eye = &s.sample.eye[i];
		double way = -eye->origin_mm[2] /
			     eye->direction[2]; /* distance to the plane of the display */
		double x_mm = eye->origin_mm[0] + way * eye->direction[0];
		double y_mm = eye->origin_mm[1] + way * eye->direction[1];
		CHECK_BETWEEN(x_mm / display.mm[0] + 0.5 - eye->point.x, -1e-4, 1e-4);
		CHECK_BETWEEN(0.5 - y_mm / display.mm[1] - eye->point.y, -1e-4, 1e-4);
	}
	assert_true(s.sample.eye[GZ_EYE_RIGHT].origin_mm[0] > 0);
	gz_sim_tracker_destroy(&tracker);
}

static void device_clock_has_its_offset_and_skew(void **state)
{
	(void)state;
	struct gz_sim_params params = clean_params(100);
	params.clock_offset_ms = 5000;
	params.clock_skew_ppm = 100;
	struct gz_sim_tracker *tracker = tracker_of(&params);
	struct gz_sim_sample first, last;
	gz_sim_tracker_next(tracker, &first);
	for (int i = 0; i < 10000; i++)
		gz_sim_tracker_next(tracker, &last);
	assert_int_equal(first.sample.device_ns, 5000 * GZ_NS_PER_MS);
	double host_s = gz_ns_to_s(last.sample.host_ns - first.sample.host_ns);
	double device_s = gz_ns_to_s(last.sample.device_ns - first.sample.device_ns);
	CHECK_BETWEEN((device_s / host_s - 1) * 1e6, 99.9, 100.1);
	struct gz_clock_status clock = gz_sim_tracker_clock(tracker);
	assert_int_equal(clock.offset_ns, last.sample.host_ns - last.sample.device_ns);
	gz_sim_tracker_destroy(&tracker);
}

static void arrival_follows_exposure_by_the_latency(void **state)
{
	(void)state;
	struct gz_sim_params params = clean_params(1000);
	params.latency_ms = 7;
	params.latency_jitter_ms = 2;
	struct gz_sim_tracker *tracker = tracker_of(&params);
	int64_t last_ns = 0;
	for (int i = 0; i < 10000; i++) {
		struct gz_sim_sample s;
		gz_sim_tracker_next(tracker, &s);
		assert_true(s.arrival_ns - s.sample.host_ns >= 7 * GZ_NS_PER_MS);
		assert_true(s.arrival_ns >= last_ns);
		last_ns = s.arrival_ns;
	}
	gz_sim_tracker_destroy(&tracker);
}

static void wrong_settings_are_refused(void **state)
{
	(void)state;
	struct gz_sim_tracker *tracker = NULL;
	struct gz_sim_params params = gz_sim_default_params();
	params.rate_hz = 2001;
	assert_int_equal(gz_sim_tracker_create(&params, 0, NULL, &tracker), GZ_ERR_INVAL);
	params = gz_sim_default_params();
	params.noise_deg = NAN;
	assert_int_equal(gz_sim_tracker_create(&params, 0, NULL, &tracker), GZ_ERR_INVAL);
	params = gz_sim_default_params();
	strcpy(params.targets, "a");
	strcpy(params.picture, "b");
	assert_int_equal(gz_sim_tracker_create(&params, 0, NULL, &tracker), GZ_ERR_INVAL);
	params = gz_sim_default_params();
	strcpy(params.targets, "/nonexistent/list");
	assert_int_equal(gz_sim_tracker_create(&params, 0, NULL, &tracker), GZ_ERR_NOT_FOUND);
	assert_null(tracker);
	gz_sim_tracker_destroy(&tracker);
	gz_sim_tracker_destroy(NULL);
}

static void viewer_turns_to_other_targets(void **state)
{
	(void)state;
	static const struct gz_targets sides[2] = {
		{ .count = 1, .target = { { .point = { 0.25F, 0.5F }, .weight = 1 } } },
		{ .count = 1, .target = { { .point = { 0.75F, 0.5F }, .weight = 1 } } },
	};
	struct gz_sim_params params = clean_params(100);
	params.viewer.pursuits_per_min = 0;
	struct gz_sim_tracker *tracker = tracker_of(&params);
	for (int side = 0; side < 2; side++) {
		int there = 0;
		gz_sim_tracker_attract(tracker, &sides[side]);
		for (int i = 0; i < 1000; i++) {
			struct gz_sim_sample sample;
			gz_sim_tracker_next(tracker, &sample);
			there += fabsf(sample.truth.point.x - sides[side].target[0].point.x) < 0.1F;
		}
		assert_in_range(there, 850, 1000);
	}
	gz_sim_tracker_destroy(&tracker);
}

TEST_SUITE(tracker)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_preset_parses),
		cmocka_unit_test(same_seed_gives_the_same_bits),
		cmocka_unit_test(the_sequence_is_the_same_on_every_machine),
		cmocka_unit_test(another_seed_gives_another_sequence),
		cmocka_unit_test(noise_does_not_change_the_truth),
		cmocka_unit_test(every_rate_is_kept),
		cmocka_unit_test(lost_samples_are_the_wanted_part_and_counted),
		cmocka_unit_test(noise_and_eye_loss_are_as_wanted),
		cmocka_unit_test(blinks_measure_nothing),
		cmocka_unit_test(lids_cover_pupils_before_they_are_lost),
		cmocka_unit_test(combined_only_measures_no_eye),
		cmocka_unit_test(calibration_moves_the_measurement_and_not_the_truth),
		cmocka_unit_test(eyes_look_from_their_place_to_the_point),
		cmocka_unit_test(device_clock_has_its_offset_and_skew),
		cmocka_unit_test(arrival_follows_exposure_by_the_latency),
		cmocka_unit_test(viewer_turns_to_other_targets),
		cmocka_unit_test(wrong_settings_are_refused),
	};
	return cmocka_run_group_tests_name("sim.tracker", tests, NULL, NULL);
}
