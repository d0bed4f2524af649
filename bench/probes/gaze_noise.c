/*
 * How much the point trembles in fixations, beside the raw signal and the 1 euro filter at its best
 * (bench/filter/precision.h), and where what remains comes from. On the recordings of Andersson et
 * al. and on GazeCom, by the labels of people, and on gaze logs, by the labels of gazectl label.
 *
 * usage: gaze_noise [--pipeline.…] [LOG.gzl …]   (GAZECAST_DATA names the folder of recordings)
 *
 * "1 euro" has, of all its settings (bench/filter/stillness.h), those with the least step-to-step
 * noise at a mean lag of at most one sample. They are chosen on each set for itself, on every tenth
 * observer of GazeCom. Logs whose names are the same up to the first dash are one set.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "base/option.h"
#include "base/order.h"
#include "bench/filter/gazecom.h"
#include "bench/filter/labelled_recording.h"
#include "bench/filter/precision.h"
#include "bench/filter/stillness.h"
#include "bench/filter/track.h"

enum { SKIPPED = 77, TRACKS_MAX = 512, SWEPT_STEP = 10 };

/* Recordings that are measured together. */
struct set {
	const char *name;
	struct gz_gaze_track track[TRACKS_MAX];
	size_t count;
};

static void set_free(struct set *set)
{
	while (set->count > 0)
		gz_gaze_track_free(&set->track[--set->count]);
}

/* ---- reading ---- */

static bool add_track(struct set *set, const struct gz_labelled_recording *recording)
{
	if (set->count == TRACKS_MAX ||
	    gz_gaze_track_take_labelled(recording, &set->track[set->count]) != GZ_OK)
		return false;
	set->count++;
	return true;
}

static bool read_stimulus(const char *data, int stimulus, struct set *set)
{
	set->name = gz_labelled_stimulus_names[stimulus];
	for (size_t f = 0; f < GZ_LABELLED_FILES; f++)
		for (int coder = 0; coder < GZ_LABELLED_CODERS; coder++) {
			struct gz_labelled_recording recording;
			if ((int)gz_labelled_files[f].stimulus != stimulus)
				continue;
			const bool read = gz_labelled_recording_read(data, f, coder, &recording) &&
					  add_track(set, &recording);
			gz_labelled_recording_free(&recording);
			if (!read)
				return false;
		}
	return true;
}

static bool read_films(const char *data, struct set *set)
{
	set->name = "GazeCom";
	for (size_t film = 0; film < GZ_GAZECOM_FILMS; film++) {
		static struct gz_gazecom gazecom;
		bool read = gz_gazecom_read(data, film, &gazecom);
		for (size_t i = 0; read && i < gazecom.count; i++)
			read = add_track(set, &gazecom.recording[i]);
		gz_gazecom_free(&gazecom);
		if (!read)
			return false;
	}
	return true;
}

static const char *name_of_log(const char *path)
{
	const char *slash = strrchr(path, '/');
	return slash ? slash + 1 : path;
}

/* Whether two logs are measured together: their names are the same up to the first dash. */
static bool of_one_set(const char *left, const char *right)
{
	const char *a = name_of_log(left), *b = name_of_log(right);
	const size_t length = strcspn(a, "-");
	return a[length] == '-' && strncmp(a, b, length + 1) == 0;
}

/* @return how many logs were read; 0: logged */
static int read_log_set(const char *const *paths, int count, const struct gz_log *log,
			struct set *set)
{
	int read = 0;
	set->name = name_of_log(paths[0]);
	while (read < count && (read == 0 || of_one_set(paths[0], paths[read]))) {
		struct gz_gaze_log_track track;
		if (set->count == TRACKS_MAX ||
		    gz_gaze_track_read_log(paths[read++], log, &track) != GZ_OK)
			return 0;
		set->track[set->count++] = track.track;
	}
	return read;
}

/* ---- where noise comes from ---- */

/* Parts of a fixation, and what the pipeline called the sample. */
enum { LANDING, INNER, LEAVING, PLACES };
enum { RESTING, MOVING, FOLLOWING, HIDDEN, CALLED };
static const char *const PLACE_NAMES[PLACES] = { "first 40 ms", "inner", "last 20 ms" };
static const char *const CALLED_NAMES[CALLED] = { "fixation", "saccade", "pursuit", "noise" };

struct shares {
	double steps[PLACES][CALLED], raw2[PLACES][CALLED], ours2[PLACES][CALLED];
};

static int called_of(enum gz_event event)
{
	return event == GZ_EVENT_FIXATION  ? RESTING
	       : event == GZ_EVENT_SACCADE ? MOVING
	       : event == GZ_EVENT_PURSUIT ? FOLLOWING
					   : HIDDEN;
}

static void add_shares(const struct gz_gaze_track *track, struct shares *shares)
{
	for (size_t begin = 0, end; begin < track->count; begin = end) {
		end = gz_gaze_stretch_end(track, begin);
		for (size_t i = begin + 1; i < end && track->label[begin] == GZ_EVENT_FIXATION;
		     i++) {
			if (!isfinite(track->raw[i].x) || !isfinite(track->raw[i - 1].x))
				continue;
			const int place =
				gz_gaze_track_elapsed_ms(track, begin, i) < GZ_PRECISION_LANDING_MS
					? LANDING
				: gz_gaze_track_elapsed_ms(track, i, end - 1) <
						GZ_PRECISION_LEAVING_MS
					? LEAVING
					: INNER;
			const int called = called_of(track->event[i]);
			const struct gz_display *display = &track->display;
			shares->steps[place][called]++;
			shares->raw2[place][called] += pow(
				gz_display_angle_deg(display, track->raw[i], track->raw[i - 1]), 2);
			shares->ours2[place][called] += pow(
				gz_display_angle_deg(display, track->point[i], track->point[i - 1]),
				2);
		}
	}
}

static void print_shares(const struct set *set)
{
	static struct shares shares;
	double steps = 0, raw2 = 0;
	memset(&shares, 0, sizeof shares);
	for (size_t i = 0; i < set->count; i++)
		add_shares(&set->track[i], &shares);
	for (int i = 0; i < PLACES * CALLED; i++) {
		steps += shares.steps[i / CALLED][i % CALLED];
		raw2 += shares.raw2[i / CALLED][i % CALLED];
	}
	for (int i = 0; i < PLACES * CALLED; i++) {
		const int place = i / CALLED, called = i % CALLED;
		if (shares.steps[place][called] > 0)
			printf("    %-11s called %-8s %5.1f %% of steps, %5.1f %% of raw², ours² "
			       "%5.1f %% of all raw²\n",
			       PLACE_NAMES[place], CALLED_NAMES[called],
			       100 * shares.steps[place][called] / steps,
			       100 * shares.raw2[place][called] / raw2,
			       100 * shares.ours2[place][called] / raw2);
	}
}

/* A few large steps make most of a sum of squares: the largest ones of so many. */
enum { LARGE_OF = 1000 };

/* The squares of the steps in fixations. @param[out] out_squares  room for all samples
 * @return how many */
static size_t collect_squares(const struct set *set, double *out_squares)
{
	size_t count = 0;
	for (size_t t = 0; t < set->count; t++) {
		const struct gz_gaze_track *track = &set->track[t];
		for (size_t i = 1; i < track->count; i++) {
			const bool rests = track->label[i] == GZ_EVENT_FIXATION &&
					   track->label[i - 1] == GZ_EVENT_FIXATION;
			if (rests && isfinite(track->raw[i].x) && isfinite(track->raw[i - 1].x))
				out_squares[count++] =
					pow(gz_display_angle_deg(&track->display, track->point[i],
								 track->point[i - 1]),
					    2);
		}
	}
	return count;
}

static void print_largest(const struct set *set)
{
	size_t room = 0;
	double all = 0, largest = 0;
	for (size_t t = 0; t < set->count; t++)
		room += set->track[t].count;
	double *squares = malloc((room + 1) * sizeof *squares);
	if (!squares)
		exit(1);
	const size_t count = collect_squares(set, squares), large = count / LARGE_OF;
	qsort(squares, count, sizeof *squares, gz_compare_doubles);
	for (size_t i = 0; i < count; i++) {
		all += squares[i];
		largest += i >= count - large ? squares[i] : 0;
	}
	if (large > 0)
		printf("    the largest %zu of %zu steps, %.2f to %.2f deg: %.1f %% of ours²\n",
		       large, count, sqrt(squares[count - large]), sqrt(squares[count - 1]),
		       100 * largest / all);
	free(squares);
}

/* ---- measuring ---- */

static struct gz_precision precision_or_exit(const struct set *set, bool raw,
					     enum gz_precision_part part)
{
	struct gz_precision precision;
	if (!gz_precision_of(set->track, set->count, raw, part, &precision))
		exit(1);
	return precision;
}

static void print_filter(const struct set *set, const char *name)
{
	struct gz_lags lags;
	printf("  %-10s", name);
	for (int part = 0; part < GZ_PRECISION_PARTS; part++) {
		const struct gz_precision raw =
			precision_or_exit(set, true, (enum gz_precision_part)part);
		const struct gz_precision ours =
			precision_or_exit(set, false, (enum gz_precision_part)part);
		printf(" | %.3f %.3f, median %.3f %.3f", ours.step_deg / raw.step_deg,
		       ours.spread_deg / raw.spread_deg, ours.step_median_deg / raw.step_median_deg,
		       ours.spread_median_deg / raw.spread_median_deg);
	}
	if (!gz_lags_of(set->track, set->count, &lags))
		exit(1);
	printf(" | %.2f %.2f %.2f | %.2f | %.1f\n", lags.onset_median, lags.onset_mean,
	       lags.onset_90, lags.overshoot_deg, lags.pursuit_ms);
}

static void print_raw(const struct set *set)
{
	for (int part = 0; part < GZ_PRECISION_PARTS; part++) {
		const struct gz_precision raw =
			precision_or_exit(set, true, (enum gz_precision_part)part);
		printf("  raw, %s: S2S %.4f, STD %.4f, median %.4f %.4f deg; %zu windows\n",
		       part == GZ_PRECISION_WHOLE ? "whole" : "inner", raw.step_deg, raw.spread_deg,
		       raw.step_median_deg, raw.spread_median_deg, raw.windows);
	}
}

/* Width of the mean that knows the future, ms. Chosen: as slow movement is usually told from noise.
 */
static const double HINDSIGHT_MS = 100;

/* The mean of the fixation's measured samples around sample @p i. */
static struct gz_point mean_around(const struct gz_gaze_track *track, size_t begin, size_t end,
				   size_t i)
{
	double sum[2] = { 0, 0 }, count = 0;
	size_t from = i, to = i + 1;
	while (from > begin && gz_gaze_track_elapsed_ms(track, from - 1, i) <= HINDSIGHT_MS / 2)
		from--;
	while (to < end && gz_gaze_track_elapsed_ms(track, i, to) <= HINDSIGHT_MS / 2)
		to++;
	for (size_t k = from; k < to; k++) {
		if (!isfinite(track->raw[k].x) || !isfinite(track->raw[k].y))
			continue;
		sum[0] += (double)track->raw[k].x;
		sum[1] += (double)track->raw[k].y;
		count++;
	}
	return count > 0 ? (struct gz_point) { (float)(sum[0] / count), (float)(sum[1] / count) }
			 : track->point[i];
}

/* What a filter leaves that has no lag, knows the labels, and looks 50 ms ahead: the movement of
 * the eye, the head and the tracker itself. */
static void smooth_by_hindsight(struct gz_gaze_track *track)
{
	for (size_t begin = 0, end; begin < track->count; begin = end) {
		end = gz_gaze_stretch_end(track, begin);
		for (size_t i = begin; i < end && track->label[begin] == GZ_EVENT_FIXATION; i++)
			track->point[i] = mean_around(track, begin, end, i);
	}
}

/* The least jitter at a lag of at most a sample, else the least lag. */
static const struct gz_sweep_point *best_point(const struct gz_sweep *sweep, double interval_ms)
{
	const struct gz_sweep_point *best = NULL;
	for (size_t i = 0; i < sweep->count; i++) {
		const struct gz_stillness *here = &sweep->point[i].stillness;
		const bool quick = !(here->lag_ms > interval_ms);
		if (quick && (!best || here->jitter < best->stillness.jitter))
			best = &sweep->point[i];
	}
	return best;
}

static void measure_one_euro(struct set *set)
{
	struct gz_gaze_track swept[TRACKS_MAX];
	char name[GZ_SWEEP_NAME_SIZE];
	size_t count = 0;
	for (size_t i = 0; i<set->count; i += set->count> 100 ? SWEPT_STEP : 1)
		swept[count++] = set->track[i];
	const struct gz_sweep sweep = gz_sweep_one_euro(swept, count);
	const struct gz_sweep_point *best =
		best_point(&sweep, gz_gaze_track_interval_ms(&set->track[0]));
	if (!best)
		return;
	for (size_t i = 0; i < set->count; i++)
		gz_gaze_track_run_one_euro(&set->track[i], &best->one_euro);
	print_filter(set, "1 euro");
	gz_sweep_name_point(best, true, name);
	printf("    %s\n", name);
}

static void measure_set(struct set *set, const struct gz_pipeline_params *params, bool compare)
{
	printf("%s\n", set->name);
	print_raw(set);
	for (size_t i = 0; i < set->count; i++)
		gz_gaze_track_run_pipeline(&set->track[i], params, false);
	print_filter(set, "pipeline");
	print_shares(set);
	print_largest(set);
	for (size_t i = 0; i < set->count; i++)
		smooth_by_hindsight(&set->track[i]);
	print_filter(set, "hindsight");
	if (compare)
		measure_one_euro(set);
	set_free(set);
	fflush(stdout);
}

struct settings {
	bool compare;
};

static const struct gz_option own_options[] = {
	{ .key = "one-euro",
	  .type = GZ_OPTION_BOOL,
	  .offset = offsetof(struct settings, compare),
	  .preset = "true",
	  .help = "sweep the 1 euro filter too" },
};

int main(int argc, char **argv)
{
	static struct set set;
	struct gz_log log;
	gz_log_init(&log, NULL, NULL, NULL);
	struct gz_pipeline_params params = gz_pipeline_default_params();
	struct settings settings = { .compare = true };
	const struct gz_option_binding bindings[] = {
		{ gz_pipeline_options, gz_pipeline_option_count, &params, NULL },
		{ own_options, 1, &settings, NULL },
	};
	struct gz_operands operands;
	if (gz_options_read_arguments(bindings, 2, argc, argv, &operands, &log) != GZ_OK)
		return 2;
	const char *data = getenv("GAZECAST_DATA");
	printf("filter | whole: S2S STD, median S2S STD of the raw signal's | inner: the same | "
	       "onset lag median mean 90 %%, samples | overshoot, degrees | pursuit lag, ms\n");
	for (int stimulus = 0; stimulus < GZ_LABELLED_STIMULI; stimulus++) {
		if (!read_stimulus(data, stimulus, &set))
			return SKIPPED;
		measure_set(&set, &params, settings.compare);
	}
	if (!read_films(data, &set))
		return SKIPPED;
	measure_set(&set, &params, settings.compare);
	for (int i = 0, read; i < operands.count; i += read) {
		read = read_log_set(&operands.items[i], operands.count - i, &log, &set);
		if (read == 0)
			return 1;
		measure_set(&set, &params, settings.compare);
	}
	return 0;
}
