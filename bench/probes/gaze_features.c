/*
 * Writes the features of all labelled recordings and of simulated viewers, for gaze_forest_fit.c.
 *
 * usage: gaze_features FOLDER [STEP]    (GAZECAST_DATA names the folder of recordings)
 *
 * With STEP, only every STEP-th observer of a film, and no copies or simulated viewers: little, for
 * a test.
 *
 * FOLDER/features.f32: GZ_WHOLE_FEATURES floats a sample; the first half of them is of earlier
 * samples FOLDER/labels.i16: five numbers a sample: track, labels of both people (enum
 * gz_human_label; the same where there is only one), whether it was measured, and reserved 0
 * FOLDER/tracks.tsv: a line a track: number, data set, stimulus or film, name, period in us, and 1
 * if it is altered
 * FOLDER/names.txt: the names of the features
 *
 * Each recording is also written at lower rates: every second, fourth and eighth sample. The
 * simulated viewers stand for trackers that are faster or noisier, and an altered copy of each
 * recording for a tracker that also loses an eye that does not blink.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "bench/filter/gazecom.h"
#include "bench/filter/labelled_recording.h"
#include "filter/classifier/whole.h"
#include "filter/pipeline.h"
#include "sim/random.h"
#include "sim/tracker.h"

enum { SKIPPED = 77, LABEL_NUMBERS = 5 };

struct output {
	FILE *features, *labels, *tracks;
	int track_count;
	bool failed;
	size_t few; /* every so many observers, without copies; 0: everything */
};

/* One recording at one rate. */
struct track {
	const struct gz_labelled_recording *recording;
	const int *second_label; /* of the other person; NULL: there is none */
	size_t step, phase;      /* every step-th sample from phase on */
};

static void write_features(void *user, size_t index, const float features[GZ_WHOLE_FEATURES])
{
	struct output *out = user;
	(void)index;
	if (fwrite(features, sizeof features[0], GZ_WHOLE_FEATURES, out->features) !=
	    GZ_WHOLE_FEATURES)
		out->failed = true;
}

static void write_labels(struct output *out, const int16_t numbers[LABEL_NUMBERS])
{
	if (fwrite(numbers, sizeof numbers[0], LABEL_NUMBERS, out->labels) != LABEL_NUMBERS)
		out->failed = true;
}

/* The input of the classifier, by the steps that come before it. */
static struct gz_movement_input prepare(struct gz_pipeline *pipeline,
					const struct gz_sample *sample)
{
	const struct gz_pipeline_params *params = &pipeline->params;
	struct gz_movement_input input = { .time_ns = sample->host_ns };
	const struct gz_validate_output valid = gz_validate_step(
		&pipeline->validate, &params->validate, &pipeline->display, sample);
	input.valid = valid.rejection == GZ_REJECT_NONE;
	if (input.valid)
		input.point = gz_combine_step(&pipeline->combine, &params->combine,
					      &pipeline->display, sample, &valid)
				      .point;
	return input;
}

static void write_track(struct output *out, const struct track *track)
{
	static struct gz_pipeline pipeline;
	const struct gz_labelled_recording *recording = track->recording;
	struct gz_movement_input *input = calloc(recording->count, sizeof *input);
	const struct gz_whole_rows rows = { out, write_features };
	size_t count = 0;
	gz_pipeline_init(&pipeline, NULL, &recording->display);
	for (size_t i = track->phase; input && i < recording->count; i += track->step) {
		const int label = recording->label[i];
		const int second = track->second_label ? track->second_label[i] : label;
		input[count] = prepare(&pipeline, &recording->sample[i]);
		write_labels(out, (int16_t[]) { (int16_t)out->track_count, (int16_t)label,
						(int16_t)second, input[count].valid, 0 });
		count++;
	}
	if (!input || gz_whole_features(&recording->display, input, count, &rows) != GZ_OK)
		out->failed = true;
	free(input);
	out->track_count++;
}

/* Losses in an altered copy. Chosen: as trackers lose an eye that does not blink. */
static const double LOSSES_PER_S = 0.4, LOSS_S = 0.06;

/* Lose samples now and then, whatever the eye does. */
static void lose_samples(struct gz_random *random, struct gz_labelled_recording *recording)
{
	const double step_s =
		gz_ns_to_s(recording->sample[1].host_ns - recording->sample[0].host_ns);
	double lost_s = 0;
	for (size_t i = 0; i < recording->count; i++, lost_s -= step_s) {
		const int64_t time_ns = recording->sample[i].host_ns;
		if (gz_random_uniform(random) < LOSSES_PER_S * step_s)
			lost_s = LOSS_S * gz_random_exponential(random);
		if (!(lost_s > 0))
			continue;
		recording->sample[i] = gz_sample_unmeasured();
		recording->sample[i].host_ns = time_ns;
	}
}

/* @param recording  is altered afterwards */
static void write_rates(struct output *out, const char *set, const char *kind, const char *name,
			struct gz_labelled_recording *recording, const int *second_label)
{
	struct gz_random random = gz_random_seeded((uint64_t)out->track_count, 0);
	if (recording->count < 2) {
		out->failed = true;
		return;
	}
	const double step_us =
		(double)(recording->sample[1].host_ns - recording->sample[0].host_ns) * 1e-3;
	for (size_t step = 1; step <= (out->few > 0 ? 1 : 8); step *= 2) {
		const struct track track = { recording, second_label, step, 0 };
		fprintf(out->tracks, "%d\t%s\t%s\t%s\t%.0f\t0\n", out->track_count, set, kind, name,
			step_us * (double)step);
		write_track(out, &track);
	}
	if (out->few > 0)
		return;
	const struct track track = { recording, second_label, 1, 0 };
	lose_samples(&random, recording);
	fprintf(out->tracks, "%d\t%s\t%s\t%s\t%.0f\t1\n", out->track_count, set, kind, name,
		step_us);
	write_track(out, &track);
}

static bool write_andersson(struct output *out, const char *data)
{
	for (size_t i = 0; i < GZ_LABELLED_FILES; i++) {
		struct gz_labelled_recording first, second = { .count = 0 };
		const bool good = gz_labelled_recording_read(data, i, 0, &first) &&
				  gz_labelled_recording_read(data, i, 1, &second);
		if (good && second.count < first.count) /* some end a sample or two earlier */
			first.count = second.count;
		if (good)
			write_rates(out, "andersson",
				    gz_labelled_stimulus_names[gz_labelled_files[i].stimulus],
				    gz_labelled_files[i].name, &first, second.label);
		gz_labelled_recording_free(&first);
		gz_labelled_recording_free(&second);
		if (!good)
			return false;
	}
	return true;
}

static bool write_gazecom(struct output *out, const char *data)
{
	for (size_t film = 0; film < GZ_GAZECOM_FILMS; film++) {
		struct gz_gazecom gazecom;
		const bool good = gz_gazecom_read(data, film, &gazecom);
		const size_t step = out->few > 0 ? out->few : 1;
		for (size_t i = 0; good && i < gazecom.count; i += step)
			write_rates(out, "gazecom", gz_gazecom_films[film], "-",
				    &gazecom.recording[i], NULL);
		gz_gazecom_free(&gazecom);
		if (!good)
			return false;
	}
	return true;
}

/* The label that a person would give to what a simulated eye does. */
static int human_label(enum gz_event event)
{
	switch (event) {
	case GZ_EVENT_SACCADE:
		return GZ_HUMAN_SACCADE;
	case GZ_EVENT_PURSUIT:
		return GZ_HUMAN_PURSUIT;
	case GZ_EVENT_FIXATION:
		return GZ_HUMAN_FIXATION;
	default:
		return GZ_HUMAN_BLINK;
	}
}

/* Simulated viewers and trackers. Without microsaccades: people call those that they see saccades,
 * and the simulator calls all of them fixation. */
static const struct simulation {
	double noise_deg, pursuits_per_min, pursuit_deg_s, blinks_per_min;
} SIMULATIONS[] = {
	{ 0.02, 0, 10, 20 }, { 0.05, 20, 5, 20 }, { 0.10, 20, 10, 40 }, { 0.25, 10, 20, 20 }
};
enum { SIMULATIONS_COUNT = sizeof SIMULATIONS / sizeof SIMULATIONS[0] };
static const double SIMULATED_HZ[] = { 60, 125, 250, 500, 1000, 2000 };
enum { SIMULATED_RATES = sizeof SIMULATED_HZ / sizeof SIMULATED_HZ[0] };
static const double SIMULATED_S = 20;

static bool simulate(const struct simulation *simulation, double rate_hz, int seed,
		     struct gz_labelled_recording *out)
{
	struct gz_sim_params params = gz_sim_default_params();
	struct gz_sim_tracker *tracker = NULL;
	params.seed = seed;
	params.rate_hz = rate_hz;
	params.noise_deg = simulation->noise_deg;
	params.viewer.pursuits_per_min = simulation->pursuits_per_min;
	params.viewer.pursuit_deg_s = simulation->pursuit_deg_s;
	params.viewer.blinks_per_min = simulation->blinks_per_min;
	params.viewer.microsaccades_per_s = 0;
	bool good = gz_sim_tracker_create(&params, GZ_NS_PER_S, NULL, &tracker) == GZ_OK;
	*out = (struct gz_labelled_recording) { .count = 0 };
	if (good)
		out->display = gz_sim_tracker_display(tracker);
	for (int i = 0; good && i < (int)(SIMULATED_S * rate_hz); i++) {
		struct gz_sim_sample sample;
		gz_sim_tracker_next(tracker, &sample);
		good = gz_labelled_recording_add(out, &sample.sample,
						 human_label(sample.truth.event));
	}
	gz_sim_tracker_destroy(&tracker);
	return good;
}

static bool write_simulated(struct output *out)
{
	for (int i = 0; i < SIMULATIONS_COUNT * SIMULATED_RATES; i++) {
		const double rate_hz = SIMULATED_HZ[i / SIMULATIONS_COUNT];
		struct gz_labelled_recording recording;
		const bool good =
			simulate(&SIMULATIONS[i % SIMULATIONS_COUNT], rate_hz, i + 1, &recording);
		const struct track track = { &recording, NULL, 1, 0 };
		fprintf(out->tracks, "%d\tsimulated\t%.0f\t-\t%.0f\t0\n", out->track_count, rate_hz,
			1e6 / rate_hz);
		if (good)
			write_track(out, &track);
		gz_labelled_recording_free(&recording);
		if (!good)
			return false;
	}
	return true;
}

static FILE *open_in(const char *folder, const char *name)
{
	char path[1024];
	const int length = snprintf(path, sizeof path, "%s/%s", folder, name);
	FILE *file = length < (int)sizeof path ? fopen(path, "wb") : NULL;
	if (!file)
		fprintf(stderr, "gaze_features: cannot write %s/%s\n", folder, name);
	return file;
}

static bool close_written(FILE *file)
{
	return !file || fclose(file) == 0;
}

static bool write_names(const char *folder)
{
	FILE *file = open_in(folder, "names.txt");
	if (!file)
		return false;
	for (size_t i = 0; i < GZ_MOVEMENT_FEATURES; i++)
		fprintf(file, "%s\n", gz_movement_feature_names[i]);
	return close_written(file);
}

int main(int argc, char **argv)
{
	const char *data = getenv("GAZECAST_DATA");
	if (!data) {
		printf("GAZECAST_DATA is not set\n");
		return SKIPPED;
	}
	const long few = argc == 3 ? strtol(argv[2], NULL, 10) : 0;
	if (argc < 2 || argc > 3 || (argc == 3 && few < 1)) {
		fprintf(stderr, "usage: gaze_features FOLDER [STEP]\n");
		return 2;
	}
	struct output out = {
		.features = open_in(argv[1], "features.f32"),
		.labels = open_in(argv[1], "labels.i16"),
		.tracks = open_in(argv[1], "tracks.tsv"),
		.few = (size_t)few,
	};
	bool good = out.features && out.labels && out.tracks && write_names(argv[1]);
	if (good && !(write_andersson(&out, data) && write_gazecom(&out, data))) {
		fprintf(stderr, "%s: a labelled recording is missing or damaged\n", data);
		good = false;
	}
	good = good && (out.few > 0 || write_simulated(&out));
	good = close_written(out.features) && good;
	good = close_written(out.labels) && good;
	good = close_written(out.tracks) && good;
	return good && !out.failed ? 0 : 1;
}
