/*
 * What the guard against lids (filter/lid.h) is worth, on the recordings of Andersson et al., whose
 * tracker measured the pupil: the agreement about blinks with each of two people, and how many
 * samples are called saccade during what they call a blink. With the labels of the forests, which
 * know these recordings, and with those of the rules, which know nothing of lids.
 *
 * usage: gaze_lids [CHANGE]...    (GAZECAST_DATA names the folder of recordings; other values of
 * pipeline.lid_change)
 */
#include <stdio.h>
#include <stdlib.h>

#include "bench/filter/labelled_recording.h"
#include "filter/pipeline.h"

enum { SKIPPED = 77, CODERS = 2 };

/* What is counted of at once and of certain labels. */
enum { AT_ONCE, CERTAIN, LABELS };

struct lid_sums {
	struct gz_agreement blink[LABELS], saccade[LABELS];
	int saccades[LABELS];   /* samples called saccade */
	int false_ones[LABELS]; /* of them, those that are neither saccade nor ringing to people */
	int in_blinks[LABELS];  /* of those, the ones in blinks */
};

static void add_label(struct lid_sums *sums, int kind, enum gz_event ours, int human)
{
	bool saccade = ours == GZ_EVENT_SACCADE;
	bool blink = ours == GZ_EVENT_BLINK || ours == GZ_EVENT_LOST;
	bool false_one = saccade && human != GZ_HUMAN_SACCADE && human != GZ_HUMAN_GLISSADE;
	gz_agreement_add(&sums->blink[kind], blink, human == GZ_HUMAN_BLINK);
	gz_agreement_add(&sums->saccade[kind], saccade, human == GZ_HUMAN_SACCADE);
	sums->saccades[kind] += saccade;
	sums->false_ones[kind] += false_one;
	sums->in_blinks[kind] += saccade && human == GZ_HUMAN_BLINK;
}

static void add_recording(const struct gz_labelled_recording *recording,
			  const struct gz_pipeline_params *params, struct lid_sums *sums)
{
	static struct gz_pipeline pipeline;
	gz_pipeline_init(&pipeline, params, &recording->display);
	for (size_t i = 0; i < recording->count; i++) {
		struct gz_pipeline_output out;
		gz_pipeline_step(&pipeline, &recording->sample[i], &out);
		add_label(sums, AT_ONCE, out.gaze.event, recording->label[i]);
		for (uint64_t k = 0; out.gaze.final_known && k <= out.gaze.final_span; k++)
			add_label(sums, CERTAIN, out.gaze.final_event,
				  recording->label[out.gaze.final_seq - k]);
	}
}

/* @return false: a recording is missing */
static bool measure_lids(const char *data, const struct gz_pipeline_params *params,
			 enum gz_labelled_stimulus stimulus, struct lid_sums *out)
{
	*out = (struct lid_sums) { .saccades = { 0 } };
	for (size_t i = 0; i < GZ_LABELLED_FILES * CODERS; i++) {
		struct gz_labelled_recording recording;
		if (gz_labelled_files[i / CODERS].stimulus != stimulus)
			continue;
		if (!gz_labelled_recording_read(data, i / CODERS, (int)(i % CODERS), &recording))
			return false;
		add_recording(&recording, params, out);
		gz_labelled_recording_free(&recording);
	}
	return true;
}

static void print_lids(enum gz_labelled_stimulus stimulus, const struct gz_pipeline_params *params,
		       const struct lid_sums *sums)
{
	static const char *const names[LABELS] = { "at once", "certain" };
	for (int k = 0; k < LABELS; k++)
		printf("| %s | %s | %g | %s | %.3f | %.3f | %d | %d | %d |\n",
		       gz_labelled_stimulus_names[stimulus],
		       params->classify.source == GZ_CLASSIFY_RULES ? "rules" : "forests",
		       params->lid.change, names[k], gz_agreement_kappa(&sums->blink[k]),
		       gz_agreement_kappa(&sums->saccade[k]), sums->saccades[k],
		       sums->false_ones[k], sums->in_blinks[k]);
}

int main(int argc, char **argv)
{
	const char *data = getenv("GAZECAST_DATA");
	struct gz_pipeline_params params = gz_pipeline_default_params();
	const double preset = params.lid.change;
	printf("| recordings | labels from | lid_change | label | kappa blink | kappa saccade | "
	       "called saccade | of them false | in blinks "
	       "|\n|---|---|---|---|---|---|---|---|---|\n");
	for (int s = 0; s < GZ_LABELLED_STIMULI; s++)
		for (int source = 0; source < 2; source++)
			for (int i = 0; i < argc + 1; i++) {
				struct lid_sums sums;
				params.classify.source =
					source ? GZ_CLASSIFY_LEARNED : GZ_CLASSIFY_RULES;
				params.lid.change = i == 0   ? 0
						    : i == 1 ? preset
							     : atof(argv[i - 1]);
				if (!data || !measure_lids(data, &params, s, &sums)) {
					printf("GAZECAST_DATA is not set, or a recording is "
					       "missing\n");
					return SKIPPED;
				}
				print_lids(s, &params, &sums);
			}
	return 0;
}
