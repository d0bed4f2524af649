/*
 * Recordings of other trackers, 250 to 2000 Hz, without labels and with the default settings: the
 * result must be what eyes do. Prints one line per recording.
 */
#include "suite.h"

#include "filter/check.h"
#include "filter/tested_params.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/clock.h"
#include "base/order.h"
#include "client/gazectl/convert/recording_format.h"
#include "filter/pipeline.h"
#include "tests/base/captured_log.h"

enum { SKIPPED = 77, DURATIONS_MAX = 8192 };

/* The results of one recording. */
struct run {
	struct gz_pipeline pipeline;
	bool started;
	uint64_t samples, good, labelled;
	int64_t first_ns, last_ns, last_good_ns;
	int64_t gap_begin_ns, gap_end_ns; /* of the newest stretch without a good sample */
	double raw_step2, smooth_step2;
	double raw_settled2, smooth_settled2; /* of these, from SETTLED_NS after landing on */
	int64_t landed_ns;
	struct gz_gaze last;
	bool last_fixated;
	size_t fixations, saccades;
	double duration_ms[DURATIONS_MAX];
};

static enum gz_result begin(void *user, const struct gz_gaze_log_header *header)
{
	struct run *run = user;
	struct gz_display display = gz_display_default(1920, 1080);
	if (header->has_display && gz_display_valid(&header->display))
		display = header->display;
	gz_pipeline_init(&run->pipeline, &tested_params, &display);
	return GZ_OK;
}

static void check_numbers(const struct run *run, const struct gz_gaze *gaze)
{
	assert_true(isfinite(gaze->point.x) && isfinite(gaze->point.y));
	assert_true(isfinite(gaze->velocity_deg_s) && gaze->velocity_deg_s >= 0);
	assert_true(gaze->confidence >= 0 && gaze->confidence <= 1);
	assert_true(run->samples == 0 || gaze->host_ns >= run->last.host_ns);
}

/* How long the labelled fixation may still contain the end of a saccade: the eye's ringing, and
 * what a label at once notices late. */
static const int64_t SETTLED_NS = 40 * GZ_NS_PER_MS;

static void add_noise(struct run *run, const struct gz_gaze *gaze, bool good)
{
	bool fixated = good && gaze->event == GZ_EVENT_FIXATION;
	bool next = gaze->host_ns - run->last.host_ns < 30 * GZ_NS_PER_MS;
	if (fixated && run->last_fixated && next) {
		const struct gz_display *d = &run->pipeline.display;
		const double raw2 = pow(gz_display_angle_deg(d, gaze->raw, run->last.raw), 2);
		const double smooth2 =
			pow(gz_display_angle_deg(d, gaze->point, run->last.point), 2);
		const bool settled = gaze->host_ns - run->landed_ns >= SETTLED_NS;
		run->raw_step2 += raw2;
		run->smooth_step2 += smooth2;
		run->raw_settled2 += settled ? raw2 : 0;
		run->smooth_settled2 += settled ? smooth2 : 0;
	}
	if (fixated && !run->last_fixated)
		run->landed_ns = gaze->host_ns;
	run->last_fixated = fixated;
}

/* At any of these rates, a loss of more than 30 ms is not a dropout. */
static void follow_gaps(struct run *run, int64_t now_ns, bool good)
{
	if (!good)
		return;
	if (run->good > 0 && now_ns - run->last_good_ns > 30 * GZ_NS_PER_MS) {
		run->gap_begin_ns = run->last_good_ns;
		run->gap_end_ns = now_ns;
	}
	run->last_good_ns = now_ns;
	run->good++;
}

static enum gz_result take(void *user, const struct gz_gaze_log_record *record)
{
	struct run *run = user;
	if (record->kind != GZ_GAZE_LOG_SAMPLE)
		return GZ_OK;
	struct gz_pipeline_output out;
	struct gz_sample sample = record->sample;
	sample.seq = run->samples; /* some formats skip */
	gz_pipeline_step(&run->pipeline, &sample, &out);
	bool good = out.rejection == GZ_REJECT_NONE;
	check_numbers(run, &out.gaze);
	if (out.gaze.final_known) {
		run->labelled += out.gaze.final_span + 1;
		assert_true(out.gaze.final_seq <= run->samples);
	}
	add_noise(run, &out.gaze, good);
	follow_gaps(run, out.gaze.host_ns, good);
	for (size_t i = 0; i < out.fixation_count; i++) {
		const struct gz_fixation *f = &out.fixations[i];
		int64_t end_ns = f->onset_ns + f->duration_ns;
		if (f->onset_ns <= run->gap_begin_ns && end_ns >= run->gap_end_ns &&
		    run->gap_end_ns > 0)
			fail_msg("a fixation lasts across a loss at %.3f s",
				 gz_ns_to_s(run->gap_begin_ns));
		if (f->final && run->fixations < DURATIONS_MAX)
			run->duration_ms[run->fixations++] = gz_ns_to_ms(f->duration_ns);
	}
	run->saccades += out.saccade_count;
	if (run->samples++ == 0)
		run->first_ns = out.gaze.host_ns;
	run->last_ns = out.gaze.host_ns;
	run->last = out.gaze;
	return GZ_OK;
}

/* @p still: the person looks at one place for seconds, according to the tracker's own software. */
static void check_run(struct run *run, const char *name, bool still)
{
	if (!(run->samples > 500 && run->fixations > 3 && run->raw_step2 > 0))
		fail_msg("%s: %.0f samples, %.0f good, %zu fixations", name, (double)run->samples,
			 (double)run->good, run->fixations);
	double seconds = gz_ns_to_s(run->last_ns - run->first_ns);
	double looking_s = seconds * (double)run->good / (double)run->samples;
	double rate_hz = (double)run->samples / seconds;
	double saccades_s = (double)run->saccades / looking_s;
	double noise = sqrt(run->smooth_step2 / run->raw_step2);
	double settled = sqrt(run->smooth_settled2 / run->raw_settled2);
	qsort(run->duration_ms, run->fixations, sizeof run->duration_ms[0], gz_compare_doubles);
	double median_ms = run->duration_ms[run->fixations / 2];
	printf("%-34s %5.0f Hz %6.1f s, %3.0f %% good: %4.2f saccades/s, fixations' median %4.0f "
	       "ms, noise %.2f of raw, %.2f when settled\n",
	       name, rate_hz, seconds, 100.0 * (double)run->good / (double)run->samples, saccades_s,
	       median_ms, noise, settled);
	CHECK_BETWEEN(saccades_s, still ? 0 : 0.3, still ? 0.5 : 6);
	CHECK_BETWEEN(median_ms, 80, still ? 6000 : 1500);
	CHECK_BETWEEN(noise, 0, 0.9);
	CHECK_BETWEEN(settled, 0, 0.5);
	CHECK_BETWEEN((double)run->samples - (double)run->labelled, 0, 64);
}

static void check_file(const char *reader, const char *file, struct gz_convert_settings settings)
{
	char path[1024];
	struct captured_log captured; /* so that skipped lines are not logged */
	captured_log_init(&captured, NULL);
	settings.name = file;
	settings.log = &captured.log;
	snprintf(path, sizeof path, "%s/gaze/%s", getenv("GAZECAST_DATA"), file);
	struct gz_text_lines *lines = NULL;
	if (gz_text_lines_open(path, &lines) != GZ_OK)
		fail_msg("cannot read %s", path);
	struct run *run = calloc(1, sizeof *run);
	assert_non_null(run);
	struct gz_recording_sink sink = { run, begin, take };
	struct gz_convert_counts counts = { 0 };
	enum gz_result result =
		gz_recording_reader_find(reader)->read(lines, &settings, &sink, &counts);
	gz_text_lines_close(&lines);
	assert_int_equal(result, GZ_OK);
	check_run(run, strrchr(file, '/') + 1, strstr(file, "Remote250") != NULL);
	free(run);
}

static void eyelink_recordings_give_what_eyes_do(void **state)
{
	(void)state;
	static const char *const names[] = { "mono250",       "mono500",       "mono1000",
					     "mono2000",      "bino250",       "bino500",
					     "bino1000",      "monoRemote250", "monoRemote500",
					     "binoRemote250", "binoRemote500" };
	struct gz_convert_settings settings = { .display_px = { 1024, 768 },
						.display_mm = { 400, 300 },
						.distance_mm = 700 };
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
		char file[128];
		snprintf(file, sizeof file, "eyelinker_asc/extdata/%s.asc.gz", names[i]);
		check_file("eyelink", file, settings);
	}
}

static void pupil_recordings_give_what_eyes_do(void **state)
{
	(void)state;
	struct gz_convert_settings settings = { .display_px = { 1280, 720 },
						.display_mm = { 1000, 560 },
						.distance_mm = 700 };
	check_file("pupil", "pupil_tutorials/data/gaze_positions.csv.gz", settings);
}

/** SMI at 250 Hz, of low quality on purpose; in pixels, with a time that starts again in each
 * trial.
 */
static void poor_recordings_give_what_eyes_do(void **state)
{
	(void)state;
	char path[1024], line[256];
	snprintf(path, sizeof path, "%s/gaze/tmalsburg_saccades/samples.tsv.gz",
		 getenv("GAZECAST_DATA"));
	gzFile file = gzopen(path, "rb");
	assert_non_null(file);
	struct run *run = calloc(1, sizeof *run);
	assert_non_null(run);
	struct gz_gaze_log_header header = { .has_display = true,
					     .display = { { 1024, 768 }, { 380, 300 }, 650 } };
	(void)begin(run, &header);
	struct gz_gaze_log_record record = { .kind = GZ_GAZE_LOG_SAMPLE };
	int64_t begin_ns = GZ_NS_PER_S, last_ns = 0;
	int last_trial = 0;
	while (gzgets(file, line, sizeof line)) {
		double time_ms, x_px, y_px;
		int trial;
		if (sscanf(line, "%lf %lf %lf %d", &time_ms, &x_px, &y_px, &trial) != 4)
			continue;
		if (trial != last_trial)
			begin_ns = last_ns + GZ_NS_PER_S - (int64_t)(time_ms * 1e6);
		last_trial = trial;
		record.sample = gz_sample_unmeasured();
		record.sample.host_ns = last_ns = begin_ns + (int64_t)(time_ms * 1e6);
		record.sample.valid = x_px > 0 && y_px > 0;
		if (record.sample.valid)
			record.sample.point =
				(struct gz_point) { (float)(x_px / 1024), (float)(y_px / 768) };
		(void)take(run, &record);
	}
	gzclose(file);
	check_run(run, "tmalsburg_saccades", false);
	free(run);
}

TEST_SUITE(any_recording)
{
	if (!read_tested_params(argc, argv))
		return 2;
	if (!getenv("GAZECAST_DATA")) {
		printf("GAZECAST_DATA is not set\n");
		return SKIPPED;
	}
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(eyelink_recordings_give_what_eyes_do),
		cmocka_unit_test(pupil_recordings_give_what_eyes_do),
		cmocka_unit_test(poor_recordings_give_what_eyes_do),
	};
	return cmocka_run_group_tests_name("filter.any_recording", tests, NULL, NULL);
}
