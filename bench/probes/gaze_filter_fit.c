/*
 * How the six settings that distinguish fixation from pursuit were chosen, and their agreement on
 * recordings that were kept out. Random settings are tried on all recordings; each is scored with
 * its neighbours' scores, so that a plateau wins and not a peak. Then a sixth of the recordings of
 * each kind is kept out at a time, the settings are chosen on the rest, and what they say of those
 * kept out is put together.
 *
 * usage: gaze_filter_fit [TRIALS]    (GAZECAST_DATA names the folder of recordings)
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/filter/labelled_recording.h"
#include "filter/pipeline.h"
#include "sim/random.h"

enum { SKIPPED = 77, PARTS = 6, SETTINGS = 6 };
enum { KINDS = GZ_LABELLED_STIMULI, CODERS = GZ_LABELLED_CODERS };
enum { TRACKS_MAX = GZ_LABELLED_FILES * CODERS };
enum { TRIALS_MAX = 2000 };

/** A setting and the range that was searched. */
static const struct {
	const char *key;
	double low, high;
} RANGES[SETTINGS] = {
	{ "pipeline.fixation_spread_deg", 0.14, 0.22 },
	{ "pipeline.fixation_drift_deg2_s", 0.005, 0.035 },
	{ "pipeline.pursuit_speed_deg_s", 3.5, 8 },
	{ "pipeline.pursuit_factor_max", 2.5, 7 },
	{ "pipeline.pursuit_scenes", 0.5, 0.8 },
	{ "pipeline.pursuit_begins", 0.5, 0.75 },
};

static const double WANTED[KINDS] = { 0.70, 0.63, 0.45 };

struct track {
	struct gz_labelled_recording recording;
	int kind, coder, part;
};

/** One choice of settings, between 0 and 1 in its range, and what it gives on each track. */
struct trial {
	double place[SETTINGS];
	struct gz_agreement counts[TRACKS_MAX];
	double score;
};

struct fit {
	struct track track[TRACKS_MAX];
	size_t track_count;
	struct trial trial[TRIALS_MAX];
	size_t trial_count;
};

static void add_counts(struct gz_agreement *sum, const struct gz_agreement *c)
{
	sum->both += c->both;
	sum->ours += c->ours;
	sum->theirs += c->theirs;
	sum->all += c->all;
}

static struct gz_pipeline_params params_at(const double place[SETTINGS])
{
	struct gz_pipeline_params params = gz_pipeline_default_params();
	const struct gz_option_binding binding = { gz_pipeline_options, gz_pipeline_option_count,
						   &params, NULL };
	for (int i = 0; i < SETTINGS; i++) {
		char text[32];
		double value = RANGES[i].low + place[i] * (RANGES[i].high - RANGES[i].low);
		snprintf(text, sizeof text, "%.9g", value);
		const struct gz_option *option = gz_options_find(&binding, 1, RANGES[i].key, NULL);
		if (!option || gz_option_parse(option, text, &params, NULL, 0) != GZ_OK)
			abort(); /* the table has changed */
	}
	return params;
}

static struct gz_agreement count_track(const struct track *track,
				       const struct gz_pipeline_params *params)
{
	const struct gz_labelled_recording *r = &track->recording;
	struct gz_agreement c = { .all = (double)r->count };
	struct gz_pipeline pipeline;
	gz_pipeline_init(&pipeline, params, &r->display);
	for (size_t i = 0; i < r->count; i++) {
		struct gz_pipeline_output out;
		gz_pipeline_step(&pipeline, &r->sample[i], &out);
		c.theirs += r->label[i] == GZ_HUMAN_FIXATION;
		if (!out.gaze.final_known || out.gaze.final_event != GZ_EVENT_FIXATION)
			continue;
		for (uint64_t k = 0; k <= out.gaze.final_span; k++) {
			c.ours++;
			c.both += r->label[out.gaze.final_seq - k] == GZ_HUMAN_FIXATION;
		}
	}
	return c;
}

/** Mean of the coders' kappas for a kind; @p without is a part to leave out, -1 for none. */
static double kind_kappa(const struct fit *fit, const struct trial *trial, int kind, int without)
{
	double sum = 0;
	for (int coder = 0; coder < CODERS; coder++) {
		struct gz_agreement all = { .all = 0 };
		for (size_t f = 0; f < fit->track_count; f++) {
			const struct track *t = &fit->track[f];
			if (t->kind == kind && t->coder == coder && t->part != without)
				add_counts(&all, &trial->counts[f]);
		}
		sum += gz_agreement_kappa(&all) / CODERS;
	}
	return sum;
}

/** Margin above the wanted agreement; more than 0.02 adds nothing. */
static double score_of(const struct fit *fit, const struct trial *trial, int without)
{
	double sum = 0;
	for (int kind = 0; kind < KINDS; kind++) {
		double above = kind_kappa(fit, trial, kind, without) - WANTED[kind] - 0.01;
		sum += (kind == 0 ? 2 : 1) * fmin(above, 0.02);
	}
	return sum;
}

static double nearness(const struct trial *a, const struct trial *b)
{
	double apart2 = 0;
	for (int i = 0; i < SETTINGS; i++)
		apart2 += pow(a->place[i] - b->place[i], 2);
	return exp(-apart2 / (2 * 0.15 * 0.15));
}

/** The trial whose neighbourhood is best. */
static const struct trial *choose_trial(struct fit *fit, int without)
{
	const struct trial *best = NULL;
	double best_score = -INFINITY;
	for (size_t i = 0; i < fit->trial_count; i++)
		fit->trial[i].score = score_of(fit, &fit->trial[i], without);
	for (size_t i = 0; i < fit->trial_count; i++) {
		double sum = 0, weights = 0;
		for (size_t k = 0; k < fit->trial_count; k++) {
			double weight = nearness(&fit->trial[i], &fit->trial[k]);
			sum += weight * fit->trial[k].score;
			weights += weight;
		}
		if (sum / weights > best_score) {
			best_score = sum / weights;
			best = &fit->trial[i];
		}
	}
	return best;
}

static bool read_fit_tracks(const char *data, struct fit *fit)
{
	int of_kind[KINDS] = { 0 };
	for (size_t f = 0; f < GZ_LABELLED_FILES; f++) {
		const int kind = (int)gz_labelled_files[f].stimulus;
		const int part = of_kind[kind]++ % PARTS;
		for (int coder = 0; coder < CODERS; coder++) {
			struct track *track = &fit->track[fit->track_count];
			if (!gz_labelled_recording_read(data, f, coder, &track->recording))
				return false;
			track->kind = kind;
			track->coder = coder;
			track->part = part;
			fit->track_count++;
		}
	}
	return true;
}

static void try_settings(struct fit *fit, size_t trials)
{
	struct gz_random random = gz_random_seeded(1, 1);
	for (; fit->trial_count < trials; fit->trial_count++) {
		struct trial *trial = &fit->trial[fit->trial_count];
		for (int i = 0; i < SETTINGS; i++)
			trial->place[i] = gz_random_uniform(&random);
		struct gz_pipeline_params params = params_at(trial->place);
		for (size_t f = 0; f < fit->track_count; f++)
			trial->counts[f] = count_track(&fit->track[f], &params);
	}
}

static void print_choice(const struct fit *fit, const struct trial *trial, const char *name)
{
	printf("%-24s", name);
	for (int kind = 0; kind < KINDS; kind++)
		printf(" %s %.3f", gz_labelled_stimulus_names[kind],
		       kind_kappa(fit, trial, kind, -1));
	for (int i = 0; i < SETTINGS; i++)
		printf("  %.3g",
		       RANGES[i].low + trial->place[i] * (RANGES[i].high - RANGES[i].low));
	putchar('\n');
}

/** Agreement on each part of the settings chosen without it, joined. */
static void cross_validate(struct fit *fit)
{
	static struct trial held_out;
	for (int part = 0; part < PARTS; part++) {
		const struct trial *chosen = choose_trial(fit, part);
		print_choice(fit, chosen, "without a part: all");
		for (size_t f = 0; f < fit->track_count; f++)
			if (fit->track[f].part == part)
				held_out.counts[f] = chosen->counts[f];
	}
	printf("%-24s", "on what was kept out:");
	for (int kind = 0; kind < KINDS; kind++)
		printf(" %s %.3f", gz_labelled_stimulus_names[kind],
		       kind_kappa(fit, &held_out, kind, -1));
	putchar('\n');
}

int main(int argc, char **argv)
{
	const char *data = getenv("GAZECAST_DATA");
	long trials = argc == 2 ? strtol(argv[1], NULL, 10) : 400;
	if (argc > 2 || trials < 1 || trials > TRIALS_MAX) {
		fprintf(stderr, "usage: gaze_filter_fit [TRIALS], 1 to %d\n", TRIALS_MAX);
		return 2;
	}
	struct fit *fit = calloc(1, sizeof *fit);
	if (!fit)
		return 1;
	bool ready = read_fit_tracks(data, fit);
	if (ready) {
		printf("kappa on fixations, and the settings in the order of the table\n");
		try_settings(fit, (size_t)trials);
		print_choice(fit, choose_trial(fit, -1), "chosen on all:");
		cross_validate(fit);
	} else {
		printf("no recordings: GAZECAST_DATA must name the folder that has "
		       "gaze/andersson2017\n");
	}
	for (size_t f = 0; f < fit->track_count; f++)
		gz_labelled_recording_free(&fit->track[f].recording);
	free(fit);
	return ready ? 0 : SKIPPED;
}
