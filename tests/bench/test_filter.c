/* gazebench filter, and the measures and sweeps behind it. */
#include "suite.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <jansson.h>

#include "bench/filter/stillness.h"
#include "bench/filter/track.h"
#include "called.h"
#include "protocol/gaze_log.h"
#include "sim/tracker.h"

static void check_close(double is, double wanted, double tolerance)
{
	if (isnan(wanted) ? !isnan(is) : !(fabs(is - wanted) <= tolerance))
		fail_msg("%.9g, not %.9g to %.9g", is, wanted, tolerance);
}

static int set_up(void **state)
{
	static struct place place;
	if (place_make(&place) != 0)
		return 1;
	*state = &place;
	return 0;
}

/* How a log is made. */
struct making {
	double rate_hz;
	int count;
	bool no_display; /* the header does not name it */
	bool stare;      /* the eye stays where it is */
	bool lost;       /* the tracker never finds it */
};

static void write_log(const struct place *place, const struct making *making)
{
	struct gz_sim_params params = gz_sim_default_params();
	struct gz_sim_tracker *tracker;
	struct gz_sim_sample in;
	const struct gz_point middle = { 0.5f, 0.5f };
	params.rate_hz = making->rate_hz;
	assert_int_equal(gz_sim_tracker_create(&params, 1000000000, NULL, &tracker), GZ_OK);
	if (making->stare)
		gz_sim_tracker_follow(tracker, &middle);
	const struct gz_gaze_log_header header = {
		.tracker = "sim",
		.serial = "1",
		.rate_hz = making->rate_hz,
		.has_display = !making->no_display,
		.display = gz_sim_tracker_display(tracker),
		.started = "2026-01-01T00:00:00Z",
		.software = "test",
		.setting_count = 1,
		.settings = { { "smooth_pass_deg", "1.3" } },
	};
	static struct gz_gaze_log_writer writer;
	const int fd = open(place->log, O_WRONLY | O_CREAT | O_TRUNC, 0600);
	assert_true(fd >= 0);
	assert_int_equal(gz_gaze_log_writer_begin(&writer, fd, &header), GZ_OK);
	for (int i = 0; i < making->count; i++) {
		gz_sim_tracker_next(tracker, &in);
		struct gz_gaze_log_record record = { .kind = GZ_GAZE_LOG_SAMPLE };
		record.sample = in.sample;
		record.sample.lost_before = 0;
		record.sample.seq = 1000 + 7 * (uint64_t)i; /* a log may count as it likes */
		if (making->lost) {
			record.sample.valid = false;
			record.sample.eye[0].valid = record.sample.eye[1].valid = false;
		}
		assert_int_equal(gz_gaze_log_writer_add(&writer, &record), GZ_OK);
	}
	assert_int_equal(gz_gaze_log_writer_end(&writer), GZ_OK);
	close(fd);
	gz_sim_tracker_destroy(&tracker);
}

static void read_track(const struct place *place, struct gz_gaze_log_track *out)
{
	assert_int_equal(gz_gaze_track_read_log(place->log, NULL, out), GZ_OK);
}

static bool is_there(const struct place *place, const char *file)
{
	char path[128];
	snprintf(path, sizeof path, "%s/%s", place->path, file);
	return access(path, R_OK) == 0;
}

static void pipeline_has_less_jitter_than_the_1_euro_filter_at_equal_lag(void **state)
{
	const struct place *place = *state;
	static const double rates_hz[] = { 120, 500 };
	for (size_t i = 0; i < sizeof rates_hz / sizeof rates_hz[0]; i++) {
		const struct making making = { .rate_hz = rates_hz[i],
					       .count = (int)(30 * rates_hz[i]) };
		struct gz_gaze_log_track log;
		write_log(place, &making);
		read_track(place, &log);
		const double step_ms = 1000 / rates_hz[i];
		const struct gz_sweep ours = gz_sweep_pipeline(&log.track, 1, &log.params);
		const struct gz_sweep theirs = gz_sweep_one_euro(&log.track, 1);
		gz_gaze_track_free(&log.track);
		assert_true(ours.point[0].stillness.saccades >= 20);
		assert_true(isfinite(gz_sweep_jitter_at(&theirs, step_ms)));
		const double lag_ms = gz_sweep_first_not_below(&ours, &theirs, step_ms,
							       20 * step_ms, step_ms / 4);
		if (!isnan(lag_ms))
			fail_msg("at %g Hz and a lag of %g ms: jitter %g against %g", rates_hz[i],
				 lag_ms, gz_sweep_jitter_at(&ours, lag_ms),
				 gz_sweep_jitter_at(&theirs, lag_ms));
	}
}

static void comparison_of_curves_that_cross_names_the_lag(void **state)
{
	(void)state;
	const struct gz_sweep level = {
		.count = 2,
		.point = { { .stillness = { .jitter = 0.5, .lag_ms = 0 } },
			   { .stillness = { .jitter = 0.5, .lag_ms = 30 } } }
	};
	const struct gz_sweep falling = {
		.count = 2,
		.point = { { .stillness = { .jitter = 1, .lag_ms = 0 } },
			   { .stillness = { .jitter = 0, .lag_ms = 20 } } }
	};
	check_close(gz_sweep_jitter_at(&falling, 5), 0.75, 1e-12);
	check_close(gz_sweep_first_not_below(&level, &falling, 1, 20, 1), 10, 1e-12);
	check_close(gz_sweep_first_not_below(&falling, &level, 11, 20, 1), NAN, 0);
	assert_true(isinf(gz_sweep_jitter_at(&falling, -1)));
}

static void raw_signal_has_jitter_1_and_lag_0_and_a_late_one_its_delay(void **state)
{
	const struct place *place = *state;
	const struct making making = { .rate_hz = 250, .count = 5000 };
	enum { DELAY = 3 };
	struct gz_gaze_log_track log;
	write_log(place, &making);
	read_track(place, &log);
	struct gz_gaze_track *track = &log.track;
	check_close(gz_gaze_track_interval_ms(track), 4, 0.01);
	memcpy(track->point, track->raw, track->count * sizeof track->point[0]);
	struct gz_stillness still = gz_stillness_of(track, 1);
	assert_true(still.fixations > 10 && still.saccades > 10);
	check_close(still.jitter, 1, 1e-12);
	check_close(still.distance, 1, 1e-12);
	check_close(still.lag_ms, 0, 1e-12);
	for (size_t i = DELAY; i < track->count; i++)
		track->point[i] = track->raw[i - DELAY];
	still = gz_stillness_of(track, 1);
	/* Samples that the tracker lost make some steps longer. */
	check_close(still.lag_ms, DELAY * 4, 0.5);
	gz_gaze_track_free(track);
}

static void slow_filter_is_late_also_where_a_saccade_has_a_single_sample(void **state)
{
	const struct place *place = *state;
	const struct making making = { .rate_hz = 30, .count = 900 };
	struct gz_gaze_log_track log;
	write_log(place, &making);
	read_track(place, &log);
	const struct gz_one_euro_params slow = { 1, 1, 1e-4 };
	gz_gaze_track_run_one_euro(&log.track, &slow);
	const struct gz_stillness still = gz_stillness_of(&log.track, 1);
	const struct gz_sweep sweep = gz_sweep_one_euro(&log.track, 1);
	gz_gaze_track_free(&log.track);
	assert_true(still.saccades > 10);
	assert_true(still.lag_ms > 50);
	for (size_t i = 0; i < sweep.count; i++)
		if (!(sweep.point[i].stillness.lag_ms > 0))
			fail_msg("point %zu: a lag of %g ms", i, sweep.point[i].stillness.lag_ms);
}

/* Whether a point has no more jitter and no more lag than another. */
static bool beats(const struct gz_stillness *one, const struct gz_stillness *other)
{
	return one->jitter <= other->jitter && one->lag_ms <= other->lag_ms;
}

static void no_setting_of_the_1_euro_filter_beats_its_curve(void **state)
{
	const struct place *place = *state;
	const struct making making = { .rate_hz = 250, .count = 5000 };
	/* Around the paper's first guess, and with a derivative that gaze needs. */
	const struct gz_one_euro_params guesses[] = { { 1, 1, 0.5 },
						      { 1, 1, 0.007 },
						      { 1, 50, 0.2 } };
	struct gz_gaze_log_track log;
	write_log(place, &making);
	read_track(place, &log);
	const struct gz_sweep sweep = gz_sweep_one_euro(&log.track, 1);
	assert_in_range(sweep.count, 10, GZ_SWEEP_MAX);
	for (size_t i = 1; i < sweep.count; i++)
		if (beats(&sweep.point[i].stillness, &sweep.point[i - 1].stillness) ||
		    beats(&sweep.point[i - 1].stillness, &sweep.point[i].stillness))
			fail_msg("point %zu and the one before: one beats the other", i);
	for (size_t i = 0; i < sizeof guesses / sizeof guesses[0]; i++) {
		gz_gaze_track_run_one_euro(&log.track, &guesses[i]);
		const struct gz_stillness still = gz_stillness_of(&log.track, 1);
		/* Between points of the curve there may be a little more. */
		if (still.jitter < 0.97 * gz_sweep_jitter_at(&sweep, still.lag_ms))
			fail_msg("beta %g: jitter %g at %g ms, the curve has %g", guesses[i].beta,
				 still.jitter, still.lag_ms,
				 gz_sweep_jitter_at(&sweep, still.lag_ms));
	}
	gz_gaze_track_free(&log.track);
}

static void sweep_of_the_pipeline_has_the_recorded_setting_once(void **state)
{
	const struct place *place = *state;
	const struct making making = { .rate_hz = 120, .count = 600 };
	struct gz_gaze_log_track log;
	write_log(place, &making);
	read_track(place, &log);
	const struct gz_sweep sweep = gz_sweep_pipeline(&log.track, 1, &log.params);
	gz_gaze_track_free(&log.track);
	int given = 0;
	for (size_t i = 0; i < sweep.count; i++) {
		assert_true(i == 0 || sweep.point[i].pass_deg > sweep.point[i - 1].pass_deg);
		given += sweep.point[i].as_given && sweep.point[i].pass_deg == 1.3;
	}
	assert_int_equal(given, 1);
}

static void log_is_measured_in_samples_and_ms_and_drawn(void **state)
{
	struct place *place = *state;
	const struct making making = { .rate_hz = 250, .count = 5000 };
	write_log(place, &making);
	place_run(place, (const char *[]) { "filter", "viewer.gzl", NULL });
	assert_said(place, 0, "5000 samples, one each 4 ms (250 Hz)");
	assert_said(place, 0, "as recorded");
	assert_said(place, 0, "at a lag of  5 samples   20.0");
	place_run(place,
		  (const char *[]) { "filter", "viewer.gzl", "--out", "out", "--json", NULL });
	assert_int_equal(place->status, 0);
	const char *begin = strchr(place->said.bytes, '{'); /* a warning may stand before it */
	json_t *json = begin ? json_loads(begin, 0, NULL) : NULL;
	assert_non_null(json);
	check_close(json_number_value(json_object_get(json, "rate_hz")), 250, 0.5);
	assert_int_equal(json_array_size(json_object_get(json, "equal_lag")), 6);
	assert_int_equal(json_array_size(json_object_get(json, "pipeline")), 11);
	const json_t *point = json_array_get(json_object_get(json, "one_euro"), 5);
	const double interval_ms = json_number_value(json_object_get(json, "interval_ms"));
	check_close(json_number_value(json_object_get(point, "lag_samples")) * interval_ms,
		    json_number_value(json_object_get(point, "lag_ms")), 1e-6);
	const bool drawn = json_is_true(json_object_get(json, "drawn"));
	json_decref(json);
	assert_int_equal(is_there(place, "out/jitter-over-lag.svg"), drawn);
	assert_int_equal(is_there(place, "out/jitter-over-lag.png"), drawn);
	assert_true(drawn || strstr(place->said.bytes, "there are no charts"));
}

static void without_gnuplot_the_numbers_are_printed(void **state)
{
	struct place *place = *state;
	const struct making making = { .rate_hz = 250, .count = 5000 };
	char kept[4096];
	const char *before = getenv("PATH");
	snprintf(kept, sizeof kept, "%s", before ? before : "");
	write_log(place, &making);
	setenv("PATH", "/nonexistent", 1);
	place_run(place, (const char *[]) { "filter", "viewer.gzl", "--out", "out", NULL });
	setenv("PATH", kept, 1);
	assert_said(place, 0, "gnuplot is not installed: there are no charts");
	assert_said(place, 0, "1 euro, ");
	assert_false(is_there(place, "out/jitter-over-lag.svg"));
}

static void log_without_a_display_takes_the_default_and_says_so(void **state)
{
	struct place *place = *state;
	const struct making making = { .rate_hz = 120, .count = 1200, .no_display = true };
	write_log(place, &making);
	place_run(place, (const char *[]) { "filter", "viewer.gzl", NULL });
	assert_said(place, 0, "angles are those of the default, 50.4 degrees wide");
}

static void log_of_an_eye_that_stays_has_jitter_but_no_lag(void **state)
{
	struct place *place = *state;
	const struct making making = { .rate_hz = 120, .count = 360, .stare = true };
	write_log(place, &making);
	place_run(place, (const char *[]) { "filter", "viewer.gzl", "--out", "out", NULL });
	assert_said(place, 0, "holds no complete saccade above 2 degrees");
	assert_said(place, 0, "pipeline, smooth_pass_deg");
	assert_null(strstr(place->said.bytes, "at a lag"));
	assert_null(strstr(place->said.bytes, "nan"));
	assert_false(is_there(place, "out/jitter-over-lag.svg"));
}

static void logs_without_samples_or_fixations_are_refused(void **state)
{
	struct place *place = *state;
	write_log(place, &(struct making) { .rate_hz = 120, .count = 0 });
	place_run(place, (const char *[]) { "filter", "viewer.gzl", NULL });
	assert_said(place, 1, "holds no sample");
	write_log(place, &(struct making) { .rate_hz = 120, .count = 1 });
	place_run(place, (const char *[]) { "filter", "viewer.gzl", NULL });
	assert_said(place, 1, "a single sample");
	write_log(place, &(struct making) { .rate_hz = 120, .count = 600, .lost = true });
	place_run(place, (const char *[]) { "filter", "viewer.gzl", NULL });
	assert_said(place, 1, "holds no fixation");
	place_run(place, (const char *[]) { "filter", "said.txt", NULL });
	assert_said(place, 1, "said.txt");
	place_run(place, (const char *[]) { "filter", "nowhere.gzl", NULL });
	assert_said(place, 1, "nowhere.gzl");
	place_run(place, (const char *[]) { "filter", NULL });
	assert_said(place, 2, "give one gaze log");
	write_log(place, &(struct making) { .rate_hz = 120, .count = 1200 });
	place_run(place,
		  (const char *[]) { "filter", "viewer.gzl", "--out", "viewer.gzl/in", NULL });
	assert_said(place, 1, "viewer.gzl/in: cannot be made");
}

TEST_SUITE(filter)
{
#define IN_A_PLACE(test) cmocka_unit_test_setup_teardown(test, set_up, place_remove)
	const struct CMUnitTest tests[] = {
		IN_A_PLACE(pipeline_has_less_jitter_than_the_1_euro_filter_at_equal_lag),
		cmocka_unit_test(comparison_of_curves_that_cross_names_the_lag),
		IN_A_PLACE(raw_signal_has_jitter_1_and_lag_0_and_a_late_one_its_delay),
		IN_A_PLACE(slow_filter_is_late_also_where_a_saccade_has_a_single_sample),
		IN_A_PLACE(no_setting_of_the_1_euro_filter_beats_its_curve),
		IN_A_PLACE(sweep_of_the_pipeline_has_the_recorded_setting_once),
		IN_A_PLACE(log_is_measured_in_samples_and_ms_and_drawn),
		IN_A_PLACE(without_gnuplot_the_numbers_are_printed),
		IN_A_PLACE(log_without_a_display_takes_the_default_and_says_so),
		IN_A_PLACE(log_of_an_eye_that_stays_has_jitter_but_no_lag),
		IN_A_PLACE(logs_without_samples_or_fixations_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
