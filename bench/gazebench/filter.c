/* gazebench filter: lag and jitter of the gaze filter on a gaze log. */
#include "bench/gazebench/gazebench.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include <jansson.h>

#include "bench/filter/stillness.h"
#include "bench/filter/track.h"
#include "bench/report/filter_chart.h"

#define GZ_LOG_MODULE "gazebench"

struct settings {
	struct gz_command_common common;
	char out[GZ_PATH_SIZE];
	bool json;
};

static const struct gz_option options[] = {
	GZ_COMMAND_HELP_OPTION,
	{ .key = "out",
	  .type = GZ_OPTION_STRING,
	  .offset = offsetof(struct settings, out),
	  .max = GZ_PATH_SIZE,
	  .preset = "",
	  .help = "folder for jitter-over-lag.svg and .png; made if it is not there" },
	{ .key = "json",
	  .type = GZ_OPTION_BOOL,
	  .offset = offsetof(struct settings, json),
	  .preset = "false",
	  .help = "print one JSON object" },
};

/* Lags at which the filters are compared, samples. */
static const double equal_lags[] = { 1, 2, 3, 5, 10, 20 };
enum { EQUAL_LAGS = sizeof equal_lags / sizeof equal_lags[0] };

/* Results of a log. */
struct findings {
	const char *path;
	struct gz_gaze_log_track log;
	double interval_ms;
	struct gz_sweep pipeline, one_euro;
	const struct gz_stillness *given; /* in pipeline */
};

static bool lag_known(const struct findings *found)
{
	return found->given->saccades > 0;
}

static void print_sweep(const struct findings *found, const struct gz_sweep *sweep, bool one_euro)
{
	char name[GZ_SWEEP_NAME_SIZE];
	for (size_t i = 0; i < sweep->count; i++) {
		const struct gz_sweep_point *point = &sweep->point[i];
		const struct gz_stillness *still = &point->stillness;
		gz_sweep_name_point(point, one_euro, name);
		printf("%-42s  jitter %.3f  distance %.3f", name, still->jitter, still->distance);
		if (lag_known(found))
			printf("  lag %6.2f samples %7.2f ms", still->lag_ms / found->interval_ms,
			       still->lag_ms);
		printf("%s\n", point->as_given ? "  as recorded" : "");
	}
}

static void print_equal_lags(const struct findings *found)
{
	for (int i = 0; i < EQUAL_LAGS; i++) {
		const double lag_ms = equal_lags[i] * found->interval_ms;
		printf("at a lag of %2g samples %7.2f ms  jitter %.3f, 1 euro %.3f\n",
		       equal_lags[i], lag_ms, gz_sweep_jitter_at(&found->pipeline, lag_ms),
		       gz_sweep_jitter_at(&found->one_euro, lag_ms));
	}
}

static void print_lines(const struct findings *found)
{
	const struct gz_gaze_track *track = &found->log.track;
	printf("%s: %zu samples, one each %.3g ms (%.4g Hz), %zu fixations, %zu saccades above "
	       "%d degrees\n",
	       found->path, track->count, found->interval_ms, 1000 / found->interval_ms,
	       found->given->fixations, found->given->saccades, GZ_LAG_LEAST_DEG);
	printf("%-42s  jitter %.3f  distance %.3f  lag %6.2f samples %7.2f ms\n", "raw signal", 1.0,
	       1.0, 0.0, 0.0);
	print_sweep(found, &found->pipeline, false);
	print_sweep(found, &found->one_euro, true);
	if (lag_known(found))
		print_equal_lags(found);
}

/* NaN is null in JSON. */
static json_t *filter_number(double value)
{
	return isfinite(value) ? json_real(value) : json_null();
}

/* The settings of a point, to which its results are added. */
static json_t *settings_json(const struct gz_sweep_point *point, bool one_euro)
{
	const struct gz_one_euro_params *params = &point->one_euro;
	if (!one_euro)
		return json_pack("{s:f, s:b}", "smooth_pass_deg", point->pass_deg, "as_recorded",
				 point->as_given);
	return json_pack("{s:f, s:f, s:f}", "min_cutoff_hz", params->min_cutoff_hz,
			 "derivative_cutoff_hz", params->derivative_cutoff_hz, "beta",
			 params->beta);
}

static json_t *sweep_json(const struct findings *found, const struct gz_sweep *sweep, bool one_euro)
{
	json_t *points = json_array();
	for (size_t i = 0; i < sweep->count; i++) {
		const struct gz_stillness *still = &sweep->point[i].stillness;
		json_t *point = settings_json(&sweep->point[i], one_euro);
		json_object_set_new(point, "jitter", filter_number(still->jitter));
		json_object_set_new(point, "distance", filter_number(still->distance));
		json_object_set_new(point, "lag_samples",
				    filter_number(still->lag_ms / found->interval_ms));
		json_object_set_new(point, "lag_ms", filter_number(still->lag_ms));
		json_array_append_new(points, point);
	}
	return points;
}

static json_t *equal_lag_json(const struct findings *found)
{
	json_t *rows = json_array();
	for (int i = 0; i < EQUAL_LAGS && lag_known(found); i++) {
		const double lag_ms = equal_lags[i] * found->interval_ms;
		json_array_append_new(
			rows,
			json_pack("{s:f, s:f, s:o, s:o}", "lag_samples", equal_lags[i], "lag_ms",
				  lag_ms, "pipeline",
				  filter_number(gz_sweep_jitter_at(&found->pipeline, lag_ms)),
				  "one_euro",
				  filter_number(gz_sweep_jitter_at(&found->one_euro, lag_ms))));
	}
	return rows;
}

static enum gz_result print_filter_json(const struct findings *found, bool drawn)
{
	json_t *json = json_pack(
		"{s:s, s:I, s:f, s:f, s:b, s:I, s:I, s:o, s:o, s:o, s:b}", "log", found->path,
		"samples", (json_int_t)found->log.track.count, "interval_ms", found->interval_ms,
		"rate_hz", 1000 / found->interval_ms, "display_known", found->log.display_known,
		"fixations", (json_int_t)found->given->fixations, "saccades",
		(json_int_t)found->given->saccades, "pipeline",
		sweep_json(found, &found->pipeline, false), "one_euro",
		sweep_json(found, &found->one_euro, true), "equal_lag", equal_lag_json(found),
		"drawn", drawn);
	const bool printed =
		json && json_dumpf(json, stdout, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) == 0;
	json_decref(json);
	putchar('\n');
	return printed ? GZ_OK : GZ_ERR_NO_MEM;
}

static enum gz_result check_filter(const struct findings *found, const struct gz_log *log)
{
	if (!found->log.display_known)
		gz_warn(log,
			"%s: does not name its display: angles are those of the default, 50.4 "
			"degrees wide",
			found->path);
	if (!(found->interval_ms > 0)) {
		gz_err(log, "%s: a single sample; record for longer, or give another log",
		       found->path);
		return GZ_ERR_FORMAT;
	}
	if (found->given->fixations == 0) {
		gz_err(log,
		       "%s: holds no fixation with valid gaze; record someone who looks at the "
		       "display",
		       found->path);
		return GZ_ERR_FORMAT;
	}
	if (isnan(found->given->jitter)) {
		gz_err(log,
		       "%s: its fixations have no noise to compare with; give a log of a tracker",
		       found->path);
		return GZ_ERR_FORMAT;
	}
	if (!lag_known(found))
		gz_warn(log,
			"%s: holds no complete saccade above %d degrees: no lag and no chart, only "
			"jitter",
			found->path, GZ_LAG_LEAST_DEG);
	return GZ_OK;
}

static void measure_log(struct findings *found)
{
	struct gz_gaze_track *track = &found->log.track;
	found->interval_ms = gz_gaze_track_interval_ms(track);
	found->pipeline = gz_sweep_pipeline(track, 1, &found->log.params);
	for (size_t i = 0; i < found->pipeline.count; i++)
		if (found->pipeline.point[i].as_given)
			found->given = &found->pipeline.point[i].stillness;
	found->one_euro = gz_sweep_one_euro(track, 1);
}

static enum gz_result draw_chart(const struct findings *found, const char *folder,
				 const struct gz_log *log, bool *out_drawn)
{
	if (mkdir(folder, 0777) != 0 && errno != EEXIST) {
		gz_err(log, "%s: cannot be made: %s", folder, strerror(errno));
		return GZ_ERR_IO;
	}
	return gz_filter_chart_draw(&found->pipeline, &found->one_euro, found->interval_ms, folder,
				    log, out_drawn);
}

static enum gz_result tell_words(struct findings *found, const struct settings *settings,
				 const struct gz_log *log)
{
	measure_log(found);
	bool drawn = false;
	enum gz_result result = check_filter(found, log);
	if (result == GZ_OK && settings->out[0] && lag_known(found))
		result = draw_chart(found, settings->out, log, &drawn);
	if (result != GZ_OK)
		return result;
	if (settings->json)
		return print_filter_json(found, drawn);
	print_lines(found);
	if (drawn)
		printf("%s/jitter-over-lag.svg\n%s/jitter-over-lag.png\n", settings->out,
		       settings->out);
	return GZ_OK;
}

static int run_filter(int argc, char *const *argv, const struct gz_log *log)
{
	struct settings settings;
	struct gz_operands operands;
	int status =
		gz_command_read_arguments(&gazebench_filter, argc, argv, log, &settings, &operands);
	if (status != GZ_COMMAND_GO_ON)
		return status;
	if (operands.count != 1) {
		gz_err(log, "give one gaze log: gazebench filter LOG.gzl");
		return GAZEBENCH_USAGE;
	}
	struct findings found = { .path = operands.items[0] };
	if (gz_gaze_track_read_log(found.path, log, &found.log) != GZ_OK)
		return GAZEBENCH_FAILED;
	const enum gz_result result = tell_words(&found, &settings, log);
	gz_gaze_track_free(&found.log.track);
	return result == GZ_OK ? GAZEBENCH_DONE : GAZEBENCH_FAILED;
}

const struct gz_command gazebench_filter = {
	.program = "gazebench",
	.name = "filter",
	.operands = "LOG",
	.operands_max = 1,
	.summary = "measure jitter and lag of the gaze filter on a recording",
	.details = "LOG is a gaze log (.gzl). It runs through the pipeline with its recorded "
		   "settings; the\n"
		   "labels of gazectl label distinguish fixations and saccades. Prints, for the "
		   "pipeline "
		   "swept over\n"
		   "smooth_pass_deg and for the 1 euro filter swept over beta, relative to the raw "
		   "signal (1, 1, 0):\n"
		   "jitter, the step-to-step RMS within fixations; the RMS distance from a "
		   "fixation's centre; and\n"
		   "lag, how much later 20, 50 and 80 % of a saccade's way are done, in samples "
		   "and ms, over\n"
		   "saccades above 2 degrees. gnuplot draws the chart; without it there is a "
		   "warning.\n",
	.options = options,
	.option_count = sizeof options / sizeof options[0],
	.run = run_filter,
};
