/*
 * The pipeline beside the 1 euro filter and plain I-VT, on recordings that two people labelled:
 * agreement, jitter and lag (bench/filter/stillness.h). With a folder as its argument, draws jitter
 * over lag there: docs/images/jitter-over-lag.svg.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/log.h"
#include "bench/filter/labelled_recording.h"
#include "bench/filter/stillness.h"
#include "bench/filter/track.h"
#include "bench/report/filter_chart.h"

enum { SKIPPED = 77, TRACKS = GZ_LABELLED_FILES * GZ_LABELLED_CODERS };

/* A step between samples of these recordings, ms: 500 Hz. */
static const double SAMPLE_MS = 2;

/** Stimulus and coder of a recording. */
struct origin {
	enum gz_labelled_stimulus stimulus;
	int coder;
};

/** All of them. */
struct tracks {
	struct gz_gaze_track track[TRACKS];
	struct origin origin[TRACKS];
	size_t count;
};

/* The mean over both people. */
static double mean_kappa(const struct tracks *tracks, int stimulus, enum gz_event event)
{
	double sum = 0;
	for (int coder = 0; coder < GZ_LABELLED_CODERS; coder++) {
		struct gz_agreement agreement = { .all = 0 };
		for (size_t f = 0; f < tracks->count; f++) {
			const struct gz_gaze_track *track = &tracks->track[f];
			const struct origin *origin = &tracks->origin[f];
			if ((int)origin->stimulus != stimulus || origin->coder != coder)
				continue;
			for (size_t i = 0; i < track->count; i++)
				gz_agreement_add(&agreement, track->event[i] == event,
						 track->label[i] == event);
		}
		sum += gz_agreement_kappa(&agreement) / GZ_LABELLED_CODERS;
	}
	return sum;
}

static void run_pipeline(struct tracks *tracks, bool certain)
{
	for (size_t f = 0; f < tracks->count; f++)
		gz_gaze_track_run_pipeline(&tracks->track[f], NULL, certain);
}

static bool is_saccade(const struct gz_gaze_track *track, size_t i, double threshold_deg_s)
{
	if (i == 0 || !track->sample[i].valid || !track->sample[i - 1].valid)
		return false;
	const double step_deg =
		gz_display_angle_deg(&track->display, track->raw[i], track->raw[i - 1]);
	return gz_is_saccade_by_velocity(threshold_deg_s, step_deg,
					 gz_gaze_track_elapsed_ms(track, i - 1, i) / 1000);
}

static void run_velocity_threshold(struct tracks *tracks, double threshold_deg_s)
{
	for (size_t f = 0; f < tracks->count; f++) {
		struct gz_gaze_track *track = &tracks->track[f];
		for (size_t i = 0; i < track->count; i++)
			track->event[i] = is_saccade(track, i, threshold_deg_s) ? GZ_EVENT_SACCADE
					  : track->sample[i].valid              ? GZ_EVENT_FIXATION
										: GZ_EVENT_LOST;
	}
}

static void print_agreement(const char *name, const struct tracks *tracks)
{
	printf("%-30s", name);
	for (int i = 0; i < GZ_LABELLED_STIMULI; i++)
		printf("  %.3f %.3f", mean_kappa(tracks, i, GZ_EVENT_SACCADE),
		       mean_kappa(tracks, i, GZ_EVENT_FIXATION));
	putchar('\n');
}

static void compare_labels(struct tracks *tracks)
{
	char name[64];
	printf("kappa with the coders           ");
	for (int i = 0; i < GZ_LABELLED_STIMULI; i++)
		printf("%-5s sacc fix  ", gz_labelled_stimulus_names[i]);
	putchar('\n');
	run_pipeline(tracks, true);
	print_agreement("pipeline, certain label", tracks);
	run_pipeline(tracks, false);
	print_agreement("pipeline, label at once", tracks);
	static const double thresholds[] = { 30, 50, 75, 100, 130 };
	for (size_t i = 0; i < sizeof thresholds / sizeof thresholds[0]; i++) {
		run_velocity_threshold(tracks, thresholds[i]);
		snprintf(name, sizeof name, "I-VT at %.0f deg/s", thresholds[i]);
		print_agreement(name, tracks);
	}
}

static void print_curve(const struct gz_sweep *sweep, bool one_euro)
{
	char name[GZ_SWEEP_NAME_SIZE];
	for (size_t i = 0; i < sweep->count; i++) {
		const struct gz_stillness *still = &sweep->point[i].stillness;
		gz_sweep_name_point(&sweep->point[i], one_euro, name);
		printf("%-42s  jitter %.3f  distance %.3f  lag %5.2f samples\n", name,
		       still->jitter, still->distance, still->lag_ms / SAMPLE_MS);
	}
}

static bool draw_curves(const struct gz_sweep *ours, const struct gz_sweep *theirs,
			const char *folder)
{
	struct gz_log log;
	bool drawn;
	gz_log_init(&log, NULL, NULL, NULL);
	return gz_filter_chart_draw(ours, theirs, SAMPLE_MS, folder, &log, &drawn) == GZ_OK;
}

/** @return whether the pipeline's curve lies below at every lag from one sample to 20 */
static bool compare_curves(struct tracks *tracks, const char *folder)
{
	const struct gz_pipeline_params params = gz_pipeline_default_params();
	const struct gz_sweep ours = gz_sweep_pipeline(tracks->track, tracks->count, &params);
	const struct gz_sweep theirs = gz_sweep_one_euro(tracks->track, tracks->count);
	print_curve(&ours, false);
	print_curve(&theirs, true);
	const double lag_ms =
		gz_sweep_first_not_below(&ours, &theirs, SAMPLE_MS, 20 * SAMPLE_MS, SAMPLE_MS / 4);
	const bool below = isnan(lag_ms);
	if (!below)
		printf("at a lag of %.2f samples: jitter %.3f against %.3f\n", lag_ms / SAMPLE_MS,
		       gz_sweep_jitter_at(&ours, lag_ms), gz_sweep_jitter_at(&theirs, lag_ms));
	printf("the pipeline's jitter lies below the 1 euro filter's at every lag from 1 to 20 "
	       "samples: %s\n",
	       below ? "yes" : "no");
	return (!folder || draw_curves(&ours, &theirs, folder)) && below;
}

static bool read_track(const char *data, size_t file, int coder, struct gz_gaze_track *out)
{
	struct gz_labelled_recording recording;
	const bool taken = gz_labelled_recording_read(data, file, coder, &recording) &&
			   gz_gaze_track_take_labelled(&recording, out) == GZ_OK;
	gz_labelled_recording_free(&recording);
	return taken;
}

/* Grouped by stimulus, then by coder. */
static bool read_all_tracks(const char *data, struct tracks *tracks)
{
	for (int stimulus = 0; stimulus < GZ_LABELLED_STIMULI; stimulus++)
		for (int coder = 0; coder < GZ_LABELLED_CODERS; coder++)
			for (size_t f = 0; f < GZ_LABELLED_FILES; f++) {
				const struct origin origin = { gz_labelled_files[f].stimulus,
							       coder };
				if ((int)origin.stimulus != stimulus)
					continue;
				if (!read_track(data, f, coder, &tracks->track[tracks->count]))
					return false;
				tracks->origin[tracks->count++] = origin;
			}
	return true;
}

static void free_tracks(struct tracks *tracks)
{
	for (size_t f = 0; f < tracks->count; f++)
		gz_gaze_track_free(&tracks->track[f]);
	free(tracks);
}

int main(int argc, char **argv)
{
	const char *data = getenv("GAZECAST_DATA");
	struct tracks *tracks = calloc(1, sizeof *tracks);
	if (!tracks)
		return 1;
	if (argc > 2 || (argc == 2 && argv[1][0] == '-')) {
		printf("usage: gaze_filter [FOLDER]\n");
		free_tracks(tracks);
		return argc == 2 && strcmp(argv[1], "--help") == 0 ? 0 : 2;
	}
	if (!read_all_tracks(data, tracks)) {
		printf("no recordings: GAZECAST_DATA must name the folder that has "
		       "gaze/andersson2017\n");
		free_tracks(tracks);
		return SKIPPED;
	}
	compare_labels(tracks);
	bool below = compare_curves(tracks, argc == 2 ? argv[1] : NULL);
	free_tracks(tracks);
	return below ? 0 : 1;
}
