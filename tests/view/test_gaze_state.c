/* The verdict on a gaze, and its rate. */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "view/gaze/gaze_state.h"

#define MS INT64_C(1000000)

static struct gz_gaze_signs good_daemon(void)
{
	return (struct gz_gaze_signs) {
		.from_daemon = true,
		.reading = {
			.known = true,
			.connected = true,
			.has_age = true,
			.age_ns = 4 * MS,
			.has_event = true,
			.event = GZ_EVENT_FIXATION,
			.noise_deg = NAN,
		},
	};
}

static void judged(const struct gz_gaze_signs *signs, enum gz_gaze_level level, const char *word)
{
	struct gz_gaze_state state;
	gz_gaze_state_of(signs, &state);
	if (state.level != level || strncmp(state.reason, word, strlen(word)) != 0)
		fail_msg("level %d \"%s\", not %d \"%s\"", state.level, state.reason, level, word);
	assert_int_equal(state.level == GZ_GAZE_LEVEL_GOOD, state.reason[0] == '\0');
}

static void timely_gaze_is_good_whatever_the_eye_does(void **state)
{
	(void)state;
	struct gz_gaze_signs signs = good_daemon();
	static const enum gz_event events[] = { GZ_EVENT_FIXATION, GZ_EVENT_SACCADE,
						GZ_EVENT_PURSUIT, GZ_EVENT_BLINK };
	for (size_t i = 0; i < sizeof events / sizeof events[0]; i++) {
		signs.reading.event = events[i];
		judged(&signs, GZ_GAZE_LEVEL_GOOD, "");
	}
	signs.reading.age_ns = 50 * MS;
	judged(&signs, GZ_GAZE_LEVEL_GOOD, "");
}

static void late_is_amber_and_silent_is_red(void **state)
{
	(void)state;
	struct gz_gaze_signs signs = good_daemon();
	signs.reading.age_ns = 50 * MS + 1;
	judged(&signs, GZ_GAZE_LEVEL_WARN, "LATE");
	signs.reading.age_ns = 1000 * MS;
	judged(&signs, GZ_GAZE_LEVEL_WARN, "LATE");
	signs.reading.age_ns = 1000 * MS + 1;
	judged(&signs, GZ_GAZE_LEVEL_BAD, "SILENT");
}

static void lost_eye_is_red_even_if_late(void **state)
{
	(void)state;
	struct gz_gaze_signs signs = good_daemon();
	signs.reading.event = GZ_EVENT_LOST;
	judged(&signs, GZ_GAZE_LEVEL_BAD, "EYE LOST");
	signs.reading.age_ns = 80 * MS;
	signs.losing = true;
	judged(&signs, GZ_GAZE_LEVEL_BAD, "EYE LOST");
}

static void missing_daemon_is_amber_and_hides_other_reasons(void **state)
{
	(void)state;
	struct gz_gaze_signs signs = good_daemon();
	signs.reading.connected = false;
	signs.reading.age_ns = 5000 * MS;
	judged(&signs, GZ_GAZE_LEVEL_WARN, "NO DAEMON");
}

static void daemon_without_tracker_gives_its_reason(void **state)
{
	(void)state;
	static struct gz_status status;
	struct gz_gaze_state told;
	struct gz_gaze_signs signs = good_daemon();
	signs.reading.known = false;
	judged(&signs, GZ_GAZE_LEVEL_WARN, "NO GAZE");
	memset(&status, 0, sizeof status);
	status.tracker.state = GZ_TRACKER_ABSENT;
	strcpy(status.tracker.name, "tobii");
	strcpy(status.tracker.reason, "nothing is plugged in");
	signs.status = &status;
	judged(&signs, GZ_GAZE_LEVEL_WARN, "NO TRACKER");
	gz_gaze_state_of(&signs, &told);
	assert_non_null(strstr(told.reason, "tobii"));
	assert_non_null(strstr(told.reason, "nothing is plugged in"));
	/* The longest reason fits, and the remedy stays. */
	memset(status.tracker.reason, 'x', sizeof status.tracker.reason - 1);
	gz_gaze_state_of(&signs, &told);
	assert_non_null(strstr(told.reason, "; using the mouse"));
}

static void other_tracker_than_the_pointer_is_reported(void **state)
{
	(void)state;
	static struct gz_status status;
	struct gz_gaze_signs signs = good_daemon();
	memset(&status, 0, sizeof status);
	status.tracker.state = GZ_TRACKER_RUNNING;
	signs.wants_pointer = true;
	signs.status = &status;
	strcpy(status.tracker.name, "pointer");
	judged(&signs, GZ_GAZE_LEVEL_GOOD, "");
	strcpy(status.tracker.name, "sim");
	judged(&signs, GZ_GAZE_LEVEL_WARN, "OTHER TRACKER");
}

static void loss_and_another_display_are_amber(void **state)
{
	(void)state;
	struct gz_gaze_signs signs = good_daemon();
	signs.losing = true;
	judged(&signs, GZ_GAZE_LEVEL_WARN, "LOSING");
	signs.losing = false;
	signs.window_elsewhere = true;
	judged(&signs, GZ_GAZE_LEVEL_WARN, "OTHER DISPLAY");
	signs.from_daemon = false; /* the mouse is on the window wherever that is */
	judged(&signs, GZ_GAZE_LEVEL_GOOD, "");
}

static void display_that_changed_since_the_validation_is_amber(void **state)
{
	(void)state;
	static struct gz_status status;
	struct gz_gaze_signs signs = good_daemon();
	struct gz_gaze_state told;
	memset(&status, 0, sizeof status);
	status.tracker.state = GZ_TRACKER_RUNNING;
	signs.status = &status;
	judged(&signs, GZ_GAZE_LEVEL_GOOD, "");
	strcpy(status.validation.changed, "500 mm away, was 600 mm");
	judged(&signs, GZ_GAZE_LEVEL_WARN, "DISPLAY CHANGED");
	gz_gaze_state_of(&signs, &told);
	assert_non_null(strstr(told.reason, "500 mm away, was 600 mm; validate again"));
	signs.losing = true; /* what hurts the gaze more comes first */
	judged(&signs, GZ_GAZE_LEVEL_WARN, "LOSING");
	signs.losing = false;
	signs.from_daemon = false;
	judged(&signs, GZ_GAZE_LEVEL_GOOD, "");
}

static void ended_log_is_reported_and_mouse_is_always_good(void **state)
{
	(void)state;
	struct gz_gaze_signs signs = good_daemon();
	signs.from_daemon = false;
	signs.from_log = true;
	judged(&signs, GZ_GAZE_LEVEL_GOOD, "");
	signs.log_ended = true;
	signs.reading.age_ns = 9000 * MS;
	judged(&signs, GZ_GAZE_LEVEL_WARN, "LOG AT ITS END");
	const struct gz_gaze_signs mouse = { .reading = { .known = false, .connected = true } };
	judged(&mouse, GZ_GAZE_LEVEL_GOOD, "");
}

static void feed(struct gz_gaze_rate *rate, uint64_t first, int64_t start_ns, double hz,
		 double span_s, int step)
{
	for (int i = 0; i < (int)(span_s * hz); i += step) {
		const struct gz_gaze_reading reading = {
			.numbered = true,
			.seq = first + (uint64_t)i,
			.sample_ns = start_ns + (int64_t)(i * 1e9 / hz),
		};
		gz_gaze_rate_step(rate, &reading);
	}
}

static void rate_hz(const struct gz_gaze_rate *rate, double wanted, double tolerance)
{
	const double hz = gz_gaze_rate_hz(rate);
	if (fabs(hz - wanted) > tolerance)
		fail_msg("%.3f Hz, not %.3f", hz, wanted);
}

static void rate_counts_unread_samples(void **state)
{
	(void)state;
	struct gz_gaze_rate rate = { 0 };
	feed(&rate, 100, 5, 1000, 3, 17); /* read at 60 Hz */
	rate_hz(&rate, 1000, 0.5);
	rate = (struct gz_gaze_rate) { 0 };
	feed(&rate, 100, 5, 1000, 3, 1); /* each of them */
	rate_hz(&rate, 1000, 0.5);
	rate = (struct gz_gaze_rate) { 0 };
	feed(&rate, 7, -3, 30, 3, 1);
	rate_hz(&rate, 30, 0.1);
}

static void rate_covers_the_last_second_only(void **state)
{
	(void)state;
	struct gz_gaze_rate rate = { 0 };
	feed(&rate, 0, 0, 250, 5, 4);
	feed(&rate, 1250, INT64_C(5000000000), 60, 2, 1);
	rate_hz(&rate, 60, 0.5);
}

static void rate_restarts_when_numbers_or_times_decrease(void **state)
{
	(void)state;
	struct gz_gaze_rate rate = { 0 };
	feed(&rate, 1000, 0, 250, 2, 4);
	rate_hz(&rate, 250, 0.5);
	feed(&rate, 0, INT64_C(9000000000), 500, 0.1, 8);
	rate_hz(&rate, 0, 0); /* too short for a rate */
	feed(&rate, 50, INT64_C(9100000000), 500, 1, 8);
	rate_hz(&rate, 500, 1);
}

static void rate_accepts_extreme_times(void **state)
{
	(void)state;
	struct gz_gaze_rate rate = { 0 };
	const struct gz_gaze_reading first = { .numbered = true, .sample_ns = INT64_MIN };
	const struct gz_gaze_reading last = { .numbered = true, .seq = 1, .sample_ns = INT64_MAX };
	gz_gaze_rate_step(&rate, &first);
	gz_gaze_rate_step(&rate, &last);
	rate_hz(&rate, 0, 0);
	const struct gz_gaze_reading unnumbered = { .known = true };
	gz_gaze_rate_step(&rate, &unnumbered);
	assert_int_equal(rate.count, 2);
}

TEST_SUITE(gaze_state)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(timely_gaze_is_good_whatever_the_eye_does),
		cmocka_unit_test(late_is_amber_and_silent_is_red),
		cmocka_unit_test(lost_eye_is_red_even_if_late),
		cmocka_unit_test(missing_daemon_is_amber_and_hides_other_reasons),
		cmocka_unit_test(daemon_without_tracker_gives_its_reason),
		cmocka_unit_test(other_tracker_than_the_pointer_is_reported),
		cmocka_unit_test(loss_and_another_display_are_amber),
		cmocka_unit_test(display_that_changed_since_the_validation_is_amber),
		cmocka_unit_test(ended_log_is_reported_and_mouse_is_always_good),
		cmocka_unit_test(rate_counts_unread_samples),
		cmocka_unit_test(rate_covers_the_last_second_only),
		cmocka_unit_test(rate_restarts_when_numbers_or_times_decrease),
		cmocka_unit_test(rate_accepts_extreme_times),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
