#include "suite.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "sim/tracker.h"
#include "sim/viewer.h"

#define CHECK_BETWEEN(got, low, high)                                                   \
	do {                                                                            \
		double g = (got), l = (low), h = (high);                                \
		if (!(g >= l && g <= h))                                                \
			fail_msg("%s is %.9g, not within %.9g to %.9g", #got, g, l, h); \
	} while (0)

enum { STEP_NS = 1000000 };

static const int64_t START_NS = INT64_C(7000000000);

/* Statistics of a long run. */
struct counts {
	double seconds;
	double event_s[GZ_EVENT_COUNT];
	int fixations, saccades, pursuits, blinks, microsaccades;
	double fixation_s, shortest_s, longest_s; /* of those not next to a blink or pursuit */
	double amplitude_deg, amplitude_greatest_deg;
	double drift_deg_s;
	double worst_peak, worst_duration_ms; /* compared with the main sequence */
};

/* One saccade, as measured from samples. */
struct seen_saccade {
	struct gz_point start;
	int64_t start_ns;
	double peak_deg_s;
};

static void end_saccade(struct counts *counts, const struct seen_saccade *saccade,
			const struct gz_display *display, const struct gz_viewer_truth *after)
{
	double deg = gz_display_angle_deg(display, saccade->start, after->point);
	double duration_ms = gz_ns_to_ms(after->time_ns - saccade->start_ns);
	counts->saccades++;
	counts->amplitude_deg += deg;
	counts->amplitude_greatest_deg = fmax(counts->amplitude_greatest_deg, deg);
	double peak = fabs(saccade->peak_deg_s / gz_main_sequence_peak_deg_s(deg) - 1);
	counts->worst_peak = fmax(counts->worst_peak, peak);
	counts->worst_duration_ms = fmax(counts->worst_duration_ms,
					 fabs(duration_ms - gz_main_sequence_duration_ms(deg)));
}

static struct counts count_run(const struct gz_viewer_params *params,
			       const struct gz_display *display, double seconds)
{
	struct gz_viewer viewer;
	gz_viewer_init(&viewer, params, display, NULL, 11, START_NS);
	struct counts counts = { .seconds = seconds, .shortest_s = 1e9 };
	struct gz_viewer_truth last = gz_viewer_advance(&viewer, START_NS);
	struct seen_saccade saccade = { .start = last.point };
	int64_t phase_ns = START_NS;
	enum gz_event before = GZ_EVENT_COUNT; /* of the present phase */
	for (int64_t ns = STEP_NS; ns < seconds * 1e9; ns += STEP_NS) {
		struct gz_viewer_truth now = gz_viewer_advance(&viewer, START_NS + ns);
		counts.event_s[now.event] += STEP_NS * 1e-9;
		if (now.event == GZ_EVENT_FIXATION && !now.microsaccade)
			counts.drift_deg_s += now.velocity_deg_s * STEP_NS * 1e-9;
		counts.microsaccades += now.microsaccade && !last.microsaccade;
		if (now.event != last.event) {
			double lasted_s = gz_ns_to_s(now.time_ns - phase_ns);
			if (last.event == GZ_EVENT_FIXATION && before != GZ_EVENT_COUNT) {
				counts.fixations++;
				counts.fixation_s += lasted_s;
				counts.shortest_s = fmin(counts.shortest_s, lasted_s);
				counts.longest_s = fmax(counts.longest_s, lasted_s);
			}
			if (last.event == GZ_EVENT_SACCADE)
				end_saccade(&counts, &saccade, display, &now);
			counts.pursuits += now.event == GZ_EVENT_PURSUIT;
			counts.blinks += now.event == GZ_EVENT_BLINK;
			if (now.event == GZ_EVENT_SACCADE)
				saccade = (struct seen_saccade) { .start = last.point,
								  .start_ns = last.time_ns };
			before = last.event;
			phase_ns = now.time_ns;
		}
		if (now.event == GZ_EVENT_SACCADE)
			saccade.peak_deg_s = fmax(saccade.peak_deg_s, now.velocity_deg_s);
		last = now;
	}
	return counts;
}

static void long_run_has_the_stated_statistics(void **state)
{
	(void)state;
	struct gz_viewer_params params = gz_sim_default_params().viewer;
	struct gz_display display = gz_display_default(1920, 1080);
	struct counts c = count_run(&params, &display, 3000);
	double looking_s = c.seconds - c.event_s[GZ_EVENT_BLINK];
	print_message("fixation %.0f ms (%.0f to %.0f), saccades %.2f/s of %.2f deg (to %.1f), "
		      "pursuit %.1f %%, blinks %.1f/min, microsaccades %.2f/s, drift %.2f deg/s\n",
		      c.fixation_s / c.fixations * 1e3, c.shortest_s * 1e3, c.longest_s * 1e3,
		      c.saccades / looking_s, c.amplitude_deg / c.saccades,
		      c.amplitude_greatest_deg, c.event_s[GZ_EVENT_PURSUIT] / c.seconds * 100,
		      c.blinks / c.seconds * 60, c.microsaccades / c.event_s[GZ_EVENT_FIXATION],
		      c.drift_deg_s / c.event_s[GZ_EVENT_FIXATION]);
	CHECK_BETWEEN(c.fixation_s / c.fixations, 0.245, 0.255);
	CHECK_BETWEEN(c.shortest_s, 0.099, 0.110);
	CHECK_BETWEEN(c.longest_s, 0.6, 1.501);
	CHECK_BETWEEN(c.saccades / looking_s, 2.0, 3.0);
	CHECK_BETWEEN(c.amplitude_deg / c.saccades, 6.6, 7.4);
	CHECK_BETWEEN(c.blinks / c.seconds * 60, 11, 16);
	CHECK_BETWEEN(c.event_s[GZ_EVENT_BLINK] / c.blinks, 0.140, 0.160);
	CHECK_BETWEEN(c.event_s[GZ_EVENT_PURSUIT] / c.pursuits, 1.2, 1.6);
	CHECK_BETWEEN(c.microsaccades / c.event_s[GZ_EVENT_FIXATION], 0.3, 1.0);
	CHECK_BETWEEN(c.drift_deg_s / c.event_s[GZ_EVENT_FIXATION], 0.3, 0.7);
}

static void saccades_lie_on_the_main_sequence(void **state)
{
	(void)state;
	struct gz_viewer_params params = gz_sim_default_params().viewer;
	params.drift_deg_s = params.tremor_deg = 0;
	struct gz_display display = gz_display_default(1920, 1080);
	struct counts c = count_run(&params, &display, 600);
	print_message("worst peak velocity error %.1f %%, worst duration error %.2f ms\n",
		      c.worst_peak * 100, c.worst_duration_ms);
	assert_true(c.saccades > 1000);
	CHECK_BETWEEN(c.worst_peak, 0, 0.02);
	CHECK_BETWEEN(c.worst_duration_ms, 0, 2.0); /* two sampling steps */
}

static void main_sequence_reaches_900_deg_s_at_most(void **state)
{
	(void)state;
	CHECK_BETWEEN(gz_main_sequence_peak_deg_s(0), 0, 0);
	CHECK_BETWEEN(gz_main_sequence_peak_deg_s(7), 400, 450);
	CHECK_BETWEEN(gz_main_sequence_peak_deg_s(90), 890, 900);
	CHECK_BETWEEN(gz_main_sequence_duration_ms(7), 20, 40);
}

static void fixational_movement_stays_under_1_degree(void **state)
{
	(void)state;
	struct gz_viewer_params params = gz_sim_default_params().viewer;
	struct gz_display display = gz_display_default(1920, 1080);
	struct gz_viewer viewer;
	gz_viewer_init(&viewer, &params, &display, NULL, 3, START_NS);
	struct gz_viewer_truth first = gz_viewer_advance(&viewer, START_NS);
	double farthest = 0;
	for (int64_t ns = 0; ns < 300 * GZ_NS_PER_S; ns += STEP_NS) {
		struct gz_viewer_truth now = gz_viewer_advance(&viewer, START_NS + ns);
		if (now.fixation != first.fixation)
			first = now;
		if (now.event == GZ_EVENT_FIXATION)
			farthest = fmax(farthest,
					gz_display_angle_deg(&display, first.point, now.point));
	}
	CHECK_BETWEEN(farthest, 0.2, 1.3); /* the microsaccades, from one side to the other */
}

static void truth_does_not_depend_on_the_steps(void **state)
{
	(void)state;
	struct gz_viewer_params params = gz_sim_default_params().viewer;
	struct gz_display display = gz_display_default(1920, 1080);
	struct gz_viewer fine, coarse;
	gz_viewer_init(&fine, &params, &display, NULL, 9, 0);
	gz_viewer_init(&coarse, &params, &display, NULL, 9, 0);
	for (int64_t ns = 0; ns < 60 * GZ_NS_PER_S; ns += 500000) {
		struct gz_viewer_truth a = gz_viewer_advance(&fine, ns);
		if (ns % 33000000 != 0)
			continue;
		struct gz_viewer_truth b = gz_viewer_advance(&coarse, ns);
		assert_memory_equal(&a.point, &b.point, sizeof a.point);
		assert_int_equal(a.event, b.event);
		assert_int_equal(a.fixation, b.fixation);
	}
}

static void time_going_back_gives_the_last_truth(void **state)
{
	(void)state;
	struct gz_viewer_params params = gz_sim_default_params().viewer;
	struct gz_display display = gz_display_default(1920, 1080);
	struct gz_viewer viewer;
	gz_viewer_init(&viewer, &params, &display, NULL, 9, 0);
	struct gz_viewer_truth late = gz_viewer_advance(&viewer, 5 * GZ_NS_PER_S);
	struct gz_viewer_truth back = gz_viewer_advance(&viewer, GZ_NS_PER_S);
	assert_int_equal(back.time_ns, late.time_ns);
	assert_memory_equal(&back.point, &late.point, sizeof late.point);
}

static void gaze_stays_on_small_and_large_displays(void **state)
{
	(void)state;
	static const double widths_mm[] = { 40, 300, 2000 };
	struct gz_viewer_params params = gz_sim_default_params().viewer;
	for (size_t i = 0; i < 3; i++) {
		struct gz_display display = { { 1000, 1000 }, { widths_mm[i], widths_mm[i] }, 600 };
		struct gz_viewer viewer;
		gz_viewer_init(&viewer, &params, &display, NULL, 4, 0);
		double reach = 1.3 / 57.3 * 600 * 4 / widths_mm[i]; /* fixational movement */
		for (int64_t ns = 0; ns < 60 * GZ_NS_PER_S; ns += 5000000) {
			struct gz_point p = gz_viewer_advance(&viewer, ns).point;
			CHECK_BETWEEN(p.x, 0 - reach, 1 + reach);
			CHECK_BETWEEN(p.y, 0 - reach, 1 + reach);
		}
	}
}

static void targets_are_looked_at_by_weight(void **state)
{
	(void)state;
	static const struct gz_targets targets = {
		.count = 3,
		.target = { { { 0.2f, 0.2f }, 1 }, { { 0.8f, 0.3f }, 1 }, { { 0.5f, 0.8f }, 4 } },
	};
	struct gz_viewer_params params = gz_sim_default_params().viewer;
	params.pursuits_per_min = params.microsaccades_per_s = params.blinks_per_min = 0;
	struct gz_display display = gz_display_default(1920, 1080);
	struct gz_viewer viewer;
	gz_viewer_init(&viewer, &params, &display, &targets, 4, 0);
	int looks[3] = { 0 }, elsewhere = 0;
	for (int64_t ns = 0; ns < 200 * GZ_NS_PER_S; ns += 10000000) {
		struct gz_viewer_truth now = gz_viewer_advance(&viewer, ns);
		if (now.event != GZ_EVENT_FIXATION)
			continue;
		int at = -1;
		for (int i = 0; i < 3; i++)
			if (gz_display_angle_deg(&display, now.point, targets.target[i].point) < 5)
				at = i;
		if (at < 0)
			elsewhere++;
		else
			looks[at]++;
	}
	int all = looks[0] + looks[1] + looks[2];
	CHECK_BETWEEN((double)elsewhere / all, 0, 0.05);
	CHECK_BETWEEN((double)looks[2] / all, 0.4, 0.75);
	CHECK_BETWEEN((double)looks[0] / all, 0.1, 0.4);
}

static void a_single_target_is_fixated_for_ever(void **state)
{
	(void)state;
	static const struct gz_targets one = { .count = 1, .target = { { { 0.3f, 0.6f }, 1 } } };
	struct gz_viewer_params params = gz_sim_default_params().viewer;
	params.pursuits_per_min = 0;
	struct gz_display display = gz_display_default(1920, 1080);
	struct gz_viewer viewer;
	gz_viewer_init(&viewer, &params, &display, &one, 4, 0);
	for (int64_t ns = 0; ns < 60 * GZ_NS_PER_S; ns += 10000000) {
		struct gz_viewer_truth now = gz_viewer_advance(&viewer, ns);
		CHECK_BETWEEN(gz_display_angle_deg(&display, now.point, one.target[0].point), 0, 3);
	}
}

/* The viewer is told where to look while it looks around freely. */
static void a_viewer_that_follows_rests_on_its_aim_until_it_is_free_again(void **state)
{
	(void)state;
	struct gz_viewer_params params = gz_sim_default_params().viewer;
	struct gz_display display = gz_display_default(1920, 1080);
	static const struct gz_point aims[] = { { 0.9f, 0.1f }, { 0.1f, 0.9f }, { 0.5f, 0.5f } };
	params.blinks_per_min = 0;
	struct gz_viewer viewer;
	gz_viewer_init(&viewer, &params, &display, NULL, 3, START_NS);
	int64_t ns = START_NS;
	for (size_t i = 0; i < sizeof aims / sizeof aims[0]; i++) {
		double sum_deg = 0;
		gz_viewer_advance(&viewer, ns += GZ_NS_PER_S);
		gz_viewer_follow(&viewer, &aims[i]);
		gz_viewer_advance(&viewer, ns += GZ_NS_PER_S);
		for (int k = 0; k < 2000; k++) {
			struct gz_viewer_truth truth = gz_viewer_advance(&viewer, ns += STEP_NS);
			double deg = gz_display_angle_deg(&display, truth.point, aims[i]);
			CHECK_BETWEEN(deg, 0, 1.2); /* a microsaccade and some drift */
			sum_deg += deg / 2000;
		}
		CHECK_BETWEEN(sum_deg, 0, 0.5);
	}
	gz_viewer_follow(&viewer, NULL);
	double farthest_deg = 0;
	for (int k = 0; k < 5000; k++) {
		struct gz_viewer_truth truth = gz_viewer_advance(&viewer, ns += STEP_NS);
		farthest_deg =
			fmax(farthest_deg, gz_display_angle_deg(&display, truth.point, aims[2]));
	}
	CHECK_BETWEEN(farthest_deg, 2, 60);
}

TEST_SUITE(viewer)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(long_run_has_the_stated_statistics),
		cmocka_unit_test(saccades_lie_on_the_main_sequence),
		cmocka_unit_test(main_sequence_reaches_900_deg_s_at_most),
		cmocka_unit_test(fixational_movement_stays_under_1_degree),
		cmocka_unit_test(truth_does_not_depend_on_the_steps),
		cmocka_unit_test(time_going_back_gives_the_last_truth),
		cmocka_unit_test(gaze_stays_on_small_and_large_displays),
		cmocka_unit_test(targets_are_looked_at_by_weight),
		cmocka_unit_test(a_single_target_is_fixated_for_ever),
		cmocka_unit_test(a_viewer_that_follows_rests_on_its_aim_until_it_is_free_again),
	};
	return cmocka_run_group_tests_name("sim.viewer", tests, NULL, NULL);
}
