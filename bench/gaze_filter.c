/*
 * The pipeline beside the 1 euro filter and plain I-VT, on recordings that two people labelled:
 * agreement, jitter and lag. With a folder as its argument, writes the curves of jitter over lag
 * there, for bench/gaze_filter.gp to draw.
 *
 * Jitter is the step-to-step RMS within labelled fixations, of the raw signal's. Lag is how much
 * later than the raw signal a filtered one has done 20, 50 and 80 % of a labelled saccade's way, in
 * samples: the mean over these and over all saccades of more than 2 degrees.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "bench/gaze_baselines.h"
#include "filter/pipeline.h"
#include "filter/recording.h"

enum { SKIPPED = 77, STIMULI = 3, CODERS = 2, FILES_MAX = 12, SWEEP_MAX = 32 };

static const char *const STIMULUS_NAMES[STIMULI] = { "img", "dots", "video" };
static const char *const CODER_NAMES[CODERS] = { "MN", "RA" };
static const char *const FILES[STIMULI][FILES_MAX] = {
	{ "img_TH34_img_Europe", "img_TH34_img_vy", "img_TL20_img_konijntjes", "img_UH21_img_Rome",
	  "img_UH29_img_Europe", "img_UL23_img_Europe", "img_UL43_img_Rome" },
	{ "dots_TH20_trial1", "dots_TL22_trial17", "dots_UH21_trial17", "dots_UH25_trial1",
	  "dots_UL27_trial17" },
	{ "video_TH34_video_BergoDalbana", "video_TL30_video_triple_jump",
	  "video_UH21_video_BergoDalbana", "video_UL23_video_triple_jump" },
};

/** A recording, and what a filter made of it. */
struct track {
	struct recording recording;
	int stimulus, coder;
	struct gz_point *point;
	bool *saccade, *fixation;
};

/** All of them. */
struct tracks {
	struct track track[STIMULI * CODERS * FILES_MAX];
	size_t count;
};

/** What a filter reaches. */
struct score {
	double saccade_kappa[STIMULI], fixation_kappa[STIMULI];
	double jitter, distance, lag;
};

/** Counts for Cohen's kappa, one against the rest. */
struct agreement {
	double both, ours, theirs, all;
};

static double kappa(const struct agreement *a)
{
	double neither = a->all - a->ours - a->theirs + a->both;
	double observed = (a->both + neither) / a->all;
	double chance = (a->ours * a->theirs + (a->all - a->ours) * (a->all - a->theirs)) /
			(a->all * a->all);
	return (observed - chance) / (1 - chance);
}

static double kappa_of(const struct tracks *tracks, int stimulus, bool saccades)
{
	double sum = 0;
	for (int coder = 0; coder < CODERS; coder++) {
		struct agreement a = { .all = 0 };
		for (size_t f = 0; f < tracks->count; f++) {
			const struct track *t = &tracks->track[f];
			if (t->stimulus != stimulus || t->coder != coder)
				continue;
			for (size_t i = 0; i < t->recording.count; i++) {
				bool ours = saccades ? t->saccade[i] : t->fixation[i];
				int wanted = saccades ? LABEL_SACCADE : LABEL_FIXATION;
				bool theirs = t->recording.label[i] == wanted;
				a.all++;
				a.ours += ours;
				a.theirs += theirs;
				a.both += ours && theirs;
			}
		}
		sum += kappa(&a) / CODERS;
	}
	return sum;
}

static double apart_deg(const struct track *t, struct gz_point a, struct gz_point b)
{
	return gz_display_angle_deg(&t->recording.display, a, b);
}

static struct gz_point raw_at(const struct track *t, size_t i)
{
	return t->recording.sample[i].point;
}

static bool good_at(const struct track *t, size_t i)
{
	return t->recording.sample[i].valid;
}

static size_t stretch_end(const struct track *t, size_t begin)
{
	size_t end = begin;
	while (end < t->recording.count && t->recording.label[end] == t->recording.label[begin])
		end++;
	return end;
}

/** Sums over fixations. */
struct stillness {
	double raw_step2, our_step2, raw_off2, our_off2;
};

static void add_fixation(const struct track *t, size_t begin, size_t end, struct stillness *sum)
{
	double x = 0, y = 0, count = 0;
	for (size_t i = begin; i < end; i++) {
		if (!good_at(t, i))
			continue;
		x += raw_at(t, i).x;
		y += raw_at(t, i).y;
		count++;
	}
	struct gz_point centre = { (float)(x / count), (float)(y / count) };
	for (size_t i = begin; i < end; i++) {
		if (!good_at(t, i))
			continue;
		sum->raw_off2 += pow(apart_deg(t, raw_at(t, i), centre), 2);
		sum->our_off2 += pow(apart_deg(t, t->point[i], centre), 2);
		if (i == begin || !good_at(t, i - 1))
			continue;
		sum->raw_step2 += pow(apart_deg(t, raw_at(t, i), raw_at(t, i - 1)), 2);
		sum->our_step2 += pow(apart_deg(t, t->point[i], t->point[i - 1]), 2);
	}
}

/** When a path is first so far from a place, in samples from @p begin on, between samples too. */
static double crossing(const struct track *t, bool raw, struct gz_point from, double deg,
		       size_t begin, size_t end)
{
	double last = 0;
	for (size_t i = begin; i < end; i++) {
		double now = apart_deg(t, raw ? raw_at(t, i) : t->point[i], from);
		if (now >= deg)
			return (double)(i - begin) -
			       (now > last && i > begin ? (now - deg) / (now - last) : 0);
		last = now;
	}
	return (double)(end - begin);
}

/** @return lag of one saccade, or NaN where it is too small or not whole */
static double lag_of(const struct track *t, size_t begin, size_t end)
{
	size_t late = end + 100 < t->recording.count ? end + 100 : t->recording.count;
	for (size_t i = begin; i < end; i++)
		if (!good_at(t, i))
			return NAN;
	struct gz_point from = raw_at(t, begin);
	double way_deg = apart_deg(t, from, raw_at(t, end - 1)), sum = 0;
	if (way_deg < 2)
		return NAN;
	for (int part = 2; part <= 8; part += 3) {
		double deg = way_deg * part / 10;
		sum += (crossing(t, false, from, deg, begin, late) -
			crossing(t, true, from, deg, begin, late)) /
		       3;
	}
	return sum;
}

static struct score score_of(const struct tracks *tracks)
{
	struct score score = { .lag = 0 };
	struct stillness still = { .raw_step2 = 0 };
	double saccades = 0;
	for (size_t f = 0; f < tracks->count; f++) {
		const struct track *t = &tracks->track[f];
		for (size_t begin = 0, end; begin < t->recording.count; begin = end) {
			end = stretch_end(t, begin);
			if (t->recording.label[begin] == LABEL_FIXATION)
				add_fixation(t, begin, end, &still);
			if (t->recording.label[begin] != LABEL_SACCADE)
				continue;
			double lag = lag_of(t, begin, end);
			if (!isnan(lag)) {
				score.lag += lag;
				saccades++;
			}
		}
	}
	score.lag /= saccades;
	score.jitter = sqrt(still.our_step2 / still.raw_step2);
	score.distance = sqrt(still.our_off2 / still.raw_off2);
	for (int s = 0; s < STIMULI; s++) {
		score.saccade_kappa[s] = kappa_of(tracks, s, true);
		score.fixation_kappa[s] = kappa_of(tracks, s, false);
	}
	return score;
}

static void run_pipeline(struct tracks *tracks, const struct gz_pipeline_params *params,
			 bool certain)
{
	for (size_t f = 0; f < tracks->count; f++) {
		struct track *t = &tracks->track[f];
		struct gz_pipeline pipeline;
		gz_pipeline_init(&pipeline, params, &t->recording.display);
		for (size_t i = 0; i < t->recording.count; i++) {
			struct gz_pipeline_output out;
			gz_pipeline_step(&pipeline, &t->recording.sample[i], &out);
			t->point[i] = out.gaze.point;
			t->saccade[i] = out.gaze.event == GZ_EVENT_SACCADE;
			t->fixation[i] = out.gaze.event == GZ_EVENT_FIXATION;
			if (!certain || !out.gaze.final_known)
				continue;
			for (uint64_t k = 0; k <= out.gaze.final_span; k++) {
				uint64_t seq = out.gaze.final_seq - k;
				t->saccade[seq] = out.gaze.final_event == GZ_EVENT_SACCADE;
				t->fixation[seq] = out.gaze.final_event == GZ_EVENT_FIXATION;
			}
		}
	}
}

/** In degrees on each axis; where nothing was measured, the last place. Labels stay. */
static void run_one_euro(struct tracks *tracks, double beta)
{
	struct gz_one_euro_params params = { 1, 1, beta };
	for (size_t f = 0; f < tracks->count; f++) {
		struct track *t = &tracks->track[f];
		const struct gz_display *d = &t->recording.display;
		double scale[2] = { d->mm[0] / d->distance_mm * 57.29577951,
				    d->mm[1] / d->distance_mm * 57.29577951 };
		struct gz_one_euro axis[2] = { { .started = false } };
		int64_t last_ns = 0;
		struct gz_point last = { 0.5f, 0.5f };
		for (size_t i = 0; i < t->recording.count; i++) {
			const struct gz_sample *sample = &t->recording.sample[i];
			if (sample->valid) {
				double step_s = gz_ns_to_s(sample->host_ns - last_ns);
				double x = sample->point.x * scale[0];
				double y = sample->point.y * scale[1];
				x = gz_one_euro_step(&axis[0], &params, step_s, x);
				y = gz_one_euro_step(&axis[1], &params, step_s, y);
				last = (struct gz_point) { (float)(x / scale[0]),
							   (float)(y / scale[1]) };
				last_ns = sample->host_ns;
			}
			t->point[i] = last;
		}
	}
}

static void run_velocity_threshold(struct tracks *tracks, double threshold_deg_s)
{
	for (size_t f = 0; f < tracks->count; f++) {
		struct track *t = &tracks->track[f];
		for (size_t i = 0; i < t->recording.count; i++) {
			bool known = i > 0 && good_at(t, i) && good_at(t, i - 1);
			t->point[i] = raw_at(t, i);
			t->saccade[i] =
				known && gz_is_saccade_by_velocity(
						 threshold_deg_s,
						 apart_deg(t, raw_at(t, i), raw_at(t, i - 1)),
						 gz_ns_to_s(t->recording.sample[i].host_ns -
							    t->recording.sample[i - 1].host_ns));
			t->fixation[i] = good_at(t, i) && !t->saccade[i];
		}
	}
}

static void print_agreement(const char *name, const struct score *s)
{
	printf("%-30s", name);
	for (int i = 0; i < STIMULI; i++)
		printf("  %.3f %.3f", s->saccade_kappa[i], s->fixation_kappa[i]);
	putchar('\n');
}

static void print_stillness(const char *name, const struct score *s)
{
	printf("%-30s  jitter %.3f  distance %.3f  lag %5.2f samples\n", name, s->jitter,
	       s->distance, s->lag);
}

static void compare_labels(struct tracks *tracks)
{
	char name[64];
	printf("kappa with the coders           ");
	for (int i = 0; i < STIMULI; i++)
		printf("%-5s sacc fix  ", STIMULUS_NAMES[i]);
	putchar('\n');
	run_pipeline(tracks, NULL, true);
	struct score score = score_of(tracks);
	print_agreement("pipeline, certain label", &score);
	run_pipeline(tracks, NULL, false);
	score = score_of(tracks);
	print_agreement("pipeline, label at once", &score);
	static const double thresholds[] = { 30, 50, 75, 100, 130 };
	for (size_t i = 0; i < sizeof thresholds / sizeof thresholds[0]; i++) {
		run_velocity_threshold(tracks, thresholds[i]);
		score = score_of(tracks);
		snprintf(name, sizeof name, "I-VT at %.0f deg/s", thresholds[i]);
		print_agreement(name, &score);
	}
}

/** One point of a curve. */
struct curve_point {
	double lag, jitter;
};

static size_t sweep_one_euro(struct tracks *tracks, struct curve_point *curve)
{
	size_t count = 0;
	for (double beta = 1e-4; beta < 200 && count < SWEEP_MAX; beta *= 1.6) {
		char name[64];
		run_one_euro(tracks, beta);
		struct score score = score_of(tracks);
		snprintf(name, sizeof name, "1 euro, beta %.4g", beta);
		print_stillness(name, &score);
		curve[count++] = (struct curve_point) { score.lag, score.jitter };
	}
	return count;
}

/** From where on a saccade passes unsmoothed: this trades lag for jitter. */
static const double PASSES_DEG[] = { 0, 0.3, 0.6, 0.9, 1, 1.1, 1.2, 1.4, 1.6, 2 };

static size_t sweep_pipeline(struct tracks *tracks, struct curve_point *curve)
{
	size_t count = 0;
	for (size_t i = 0; i < sizeof PASSES_DEG / sizeof PASSES_DEG[0]; i++) {
		struct gz_pipeline_params params = gz_pipeline_default_params();
		params.smooth.pass_deg = PASSES_DEG[i];
		char name[64];
		run_pipeline(tracks, &params, true);
		struct score score = score_of(tracks);
		snprintf(name, sizeof name, "pipeline, smooth_pass_deg %g", PASSES_DEG[i]);
		print_stillness(name, &score);
		curve[count++] = (struct curve_point) { score.lag, score.jitter };
	}
	return count;
}

/** Least jitter that a curve gives for a lag, by a straight line between its points. */
static double jitter_at(const struct curve_point *curve, size_t count, double lag)
{
	double least = INFINITY;
	for (size_t i = 0; i < count; i++) {
		if (curve[i].lag <= lag)
			least = fmin(least, curve[i].jitter);
		for (size_t k = 0; k < count; k++) {
			double span = curve[k].lag - curve[i].lag,
			       part = (lag - curve[i].lag) / span;
			if (span > 0 && part >= 0 && part <= 1 && (k == i + 1 || i == k + 1))
				least = fmin(least, curve[i].jitter + part * (curve[k].jitter -
									      curve[i].jitter));
		}
	}
	return least;
}

static bool write_curve(const char *folder, const char *name, const struct curve_point *curve,
			size_t count)
{
	char path[1024];
	snprintf(path, sizeof path, "%s/%s.dat", folder, name);
	FILE *file = fopen(path, "w");
	if (!file)
		return false;
	fputs("# lag in samples, jitter of raw\n", file);
	for (size_t i = 0; i < count; i++)
		fprintf(file, "%.4f %.4f\n", curve[i].lag, curve[i].jitter);
	return fclose(file) == 0;
}

/** @return whether the pipeline's curve lies below at every lag above one sample */
static bool compare_curves(struct tracks *tracks, const char *folder)
{
	struct curve_point ours[SWEEP_MAX], theirs[SWEEP_MAX];
	size_t our_count = sweep_pipeline(tracks, ours);
	size_t their_count = sweep_one_euro(tracks, theirs);
	bool below = true;
	for (double lag = 1; lag <= 20; lag += 0.25) {
		double our_jitter = jitter_at(ours, our_count, lag);
		double their_jitter = jitter_at(theirs, their_count, lag);
		if (our_jitter < their_jitter)
			continue;
		below = false;
		printf("at a lag of %.2f samples: jitter %.3f against %.3f\n", lag, our_jitter,
		       their_jitter);
	}
	printf("the pipeline's jitter lies below the 1 euro filter's at every lag from 1 to 20 "
	       "samples: %s\n",
	       below ? "yes" : "no");
	if (folder && (!write_curve(folder, "pipeline", ours, our_count) ||
		       !write_curve(folder, "one_euro", theirs, their_count))) {
		fprintf(stderr, "%s: cannot be written to; name another folder\n", folder);
		return false;
	}
	return below;
}

/** One person corrected one file, which then has another name. */
static bool read_track(const char *data, int stimulus, int coder, const char *file,
		       struct track *out)
{
	char path[1024];
	bool corrected = coder == 0 && strcmp(file, "img_UH29_img_Europe") == 0;
	snprintf(path, sizeof path, "%s/gaze/andersson2017/%s_labelled_%s%s.tsv.gz", data,
		 corrected ? "fix_UH29_img_Europe" : file, corrected ? "FIX_" : "",
		 CODER_NAMES[coder]);
	if (!recording_read(path, &out->recording))
		return false;
	out->stimulus = stimulus;
	out->coder = coder;
	out->point = calloc(out->recording.count, sizeof *out->point);
	out->saccade = calloc(out->recording.count, sizeof *out->saccade);
	out->fixation = calloc(out->recording.count, sizeof *out->fixation);
	return out->point && out->saccade && out->fixation;
}

static bool read_tracks(const char *data, struct tracks *tracks)
{
	for (int stimulus = 0; stimulus < STIMULI; stimulus++)
		for (int coder = 0; coder < CODERS; coder++)
			for (int f = 0; f < FILES_MAX && FILES[stimulus][f]; f++)
				if (!read_track(data, stimulus, coder, FILES[stimulus][f],
						&tracks->track[tracks->count++]))
					return false;
	return true;
}

static void free_tracks(struct tracks *tracks)
{
	for (size_t f = 0; f < tracks->count; f++) {
		recording_free(&tracks->track[f].recording);
		free(tracks->track[f].point);
		free(tracks->track[f].saccade);
		free(tracks->track[f].fixation);
	}
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
	if (!data || !read_tracks(data, tracks)) {
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
