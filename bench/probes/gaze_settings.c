/*
 * What each setting of the pipeline does at half and at twice its preset, on labelled recordings:
 * those of Andersson et al. as their first coder labelled them, and every tenth observer of
 * GazeCom. The forests know all of these recordings, so only differences count.
 *
 * usage: gaze_settings [rules]    (GAZECAST_DATA names the folder of recordings; rules: the labels
 * come from the rules)
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/filter/gazecom.h"
#include "bench/filter/labelled_recording.h"
#include "filter/pipeline.h"

enum { SKIPPED = 77, RECORDINGS_MAX = 64, OBSERVER_STEP = 10 };
enum { FILMS = GZ_LABELLED_STIMULI, SETS };  /* pictures, dots, videos, films */
enum { CLASSES = 3, FIGURES = CLASSES + 1 }; /* kappa of each class, and noise */
static const int HUMAN[CLASSES] = { GZ_HUMAN_SACCADE, GZ_HUMAN_FIXATION, GZ_HUMAN_PURSUIT };
static const enum gz_event OURS[CLASSES] = { GZ_EVENT_SACCADE, GZ_EVENT_FIXATION,
					     GZ_EVENT_PURSUIT };

struct recordings {
	size_t count;
	struct gz_labelled_recording recording[RECORDINGS_MAX];
	int set[RECORDINGS_MAX];
};

struct sums {
	struct gz_agreement agreement[CLASSES];
	double raw2, smooth2; /* squares of steps in what people call fixations */
};

static bool read_recordings(const char *data, struct recordings *out)
{
	for (size_t i = 0; i < GZ_LABELLED_FILES; i++, out->count++) {
		out->set[out->count] = (int)gz_labelled_files[i].stimulus;
		if (!gz_labelled_recording_read(data, i, 0, &out->recording[out->count]))
			return false;
	}
	for (size_t film = 0; film < GZ_GAZECOM_FILMS; film++) {
		static struct gz_gazecom gazecom;
		if (!gz_gazecom_read(data, film, &gazecom))
			return false;
		for (size_t i = film; i < gazecom.count && out->count < RECORDINGS_MAX;
		     i += OBSERVER_STEP) {
			out->set[out->count] = FILMS;
			out->recording[out->count++] = gazecom.recording[i];
			gazecom.recording[i] = (struct gz_labelled_recording) { .count = 0 };
		}
		gz_gazecom_free(&gazecom);
	}
	return true;
}

static void add_steps(const struct gz_labelled_recording *recording, const struct gz_point *smooth,
		      struct sums *sums)
{
	const struct gz_display *display = &recording->display;
	for (size_t i = 1; i < recording->count; i++) {
		const struct gz_sample *sample = &recording->sample[i];
		if (recording->label[i] != GZ_HUMAN_FIXATION ||
		    recording->label[i - 1] != GZ_HUMAN_FIXATION || !sample->valid ||
		    !sample[-1].valid)
			continue;
		const double raw = gz_display_angle_deg(display, sample->point, sample[-1].point);
		const double ours = gz_display_angle_deg(display, smooth[i], smooth[i - 1]);
		sums->raw2 += raw * raw;
		sums->smooth2 += ours * ours;
	}
}

static void add_recording(const struct gz_labelled_recording *recording,
			  const struct gz_pipeline_params *params, struct sums *sums)
{
	static struct gz_pipeline pipeline;
	struct gz_point *smooth = calloc(recording->count, sizeof *smooth);
	if (!smooth)
		exit(1);
	gz_pipeline_init(&pipeline, params, &recording->display);
	for (size_t i = 0; i < recording->count; i++) {
		struct gz_pipeline_output out;
		gz_pipeline_step(&pipeline, &recording->sample[i], &out);
		smooth[i] = out.gaze.point;
		for (uint64_t k = 0; out.gaze.final_known && k <= out.gaze.final_span; k++)
			for (int c = 0; c < CLASSES; c++)
				gz_agreement_add(
					&sums->agreement[c], out.gaze.final_event == OURS[c],
					recording->label[out.gaze.final_seq - k] == HUMAN[c]);
	}
	add_steps(recording, smooth, sums);
	free(smooth);
}

static void measure(const struct recordings *recordings, const struct gz_pipeline_params *params,
		    double out[SETS][FIGURES])
{
	struct sums sums[SETS] = { { .raw2 = 0 } };
	for (size_t i = 0; i < recordings->count; i++)
		add_recording(&recordings->recording[i], params, &sums[recordings->set[i]]);
	for (int s = 0; s < SETS; s++) {
		for (int c = 0; c < CLASSES; c++)
			out[s][c] = gz_agreement_kappa(&sums[s].agreement[c]);
		out[s][CLASSES] = sqrt(sums[s].smooth2 / sums[s].raw2);
	}
}

/* A change that counts: less is no more than the labels of a few samples. */
static const double CHANGE_LEAST = 0.001;

/* Print the figures, or by how much they are more than @p preset. */
static void print_figures(const char *name, double value, double figures[SETS][FIGURES],
			  double preset[SETS][FIGURES])
{
	printf("| `%s` | %g |", name, value);
	for (int s = 0; s < SETS; s++) {
		for (int f = 0; f < FIGURES; f++)
			printf(preset ? " %+.3f" : " %.3f",
			       figures[s][f] - (preset ? preset[s][f] : 0));
		printf(" |");
	}
	printf("\n");
}

static bool differ(double figures[SETS][FIGURES], double preset[SETS][FIGURES])
{
	for (int s = 0; s < SETS; s++)
		for (int f = 0; f < FIGURES; f++)
			if (fabs(figures[s][f] - preset[s][f]) >= CHANGE_LEAST)
				return true;
	return false;
}

/* @return whether the setting changes a figure */
static bool try_setting(const struct recordings *recordings, const struct gz_option *option,
			const struct gz_pipeline_params *presets, double preset[SETS][FIGURES])
{
	static const double factors[] = { 0.5, 2 };
	bool changes = false;
	for (int i = 0; i < 2; i++) {
		struct gz_pipeline_params params = *presets;
		double figures[SETS][FIGURES];
		double *value = (double *)(void *)((char *)&params + option->offset);
		*value = fmax(option->min, fmin(option->max, factors[i] * *value));
		measure(recordings, &params, figures);
		if (!differ(figures, preset))
			continue;
		print_figures(option->key, *value, figures, preset);
		changes = true;
	}
	return changes;
}

int main(int argc, char **argv)
{
	static struct recordings recordings;
	static const char *unchanging[128];
	size_t unchanging_count = 0;
	double preset[SETS][FIGURES];
	const char *data = getenv("GAZECAST_DATA");
	if (!data || !read_recordings(data, &recordings)) {
		printf("GAZECAST_DATA is not set, or a recording is missing\n");
		return SKIPPED;
	}
	struct gz_pipeline_params params = gz_pipeline_default_params();
	if (argc > 1 && strcmp(argv[1], "rules") == 0)
		params.classify.source = GZ_CLASSIFY_RULES;
	measure(&recordings, &params, preset);
	printf("| setting | value | picture | dots | video | GazeCom "
	       "|\n|---|---|---|---|---|---|\n");
	print_figures("presets", 1, preset, NULL);
	for (size_t i = 0; i < gz_pipeline_option_count; i++) {
		const struct gz_option *option = &gz_pipeline_options[i];
		if (option->type == GZ_OPTION_DOUBLE && option->count <= 1 &&
		    !try_setting(&recordings, option, &params, preset) && unchanging_count < 128)
			unchanging[unchanging_count++] = option->key;
		fflush(stdout);
	}
	printf("No effect:");
	for (size_t i = 0; i < unchanging_count; i++)
		printf(" %s", unchanging[i]);
	printf("\n");
	for (size_t i = 0; i < recordings.count; i++)
		gz_labelled_recording_free(&recordings.recording[i]);
	return 0;
}
