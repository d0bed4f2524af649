/*
 * How far from the true landing place gz_landing_step() (filter/landing.h) predicts it, on labelled
 * recordings of people whose recordings it was not fitted to. With a file as its argument, fits the
 * weights to all recordings and writes them there: filter/landing_weights.c.
 *
 * usage: gaze_landing [FILE]    (GAZECAST_DATA names the folder of recordings)
 *
 * The recordings count at their own rate and as every second, fourth and eighth sample. The true
 * landing place is the mean over 20 ms behind the saccade and its ringing, as people labelled them.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/order.h"
#include "base/vector.h"
#include "bench/filter/gazecom.h"
#include "bench/filter/labelled_recording.h"
#include "filter/angle.h"
#include "filter/landing.h"
#include "filter/pipeline.h"

enum { SKIPPED = 77, TERMS = GZ_LANDING_TERMS, FOLDS = 6, OBSERVERS_MAX = 128, ROUNDS = 8 };

/* Truth is the mean over this time. */
static const double REST_MS = 20;

/* The label at once may come this much before people's. */
static const double EARLY_MS = 16;

/* Smaller and larger saccades are noise and lids. */
static const double LEAST_DEG = 0.5, MOST_DEG = 35;

/* Delay that is to be bridged, and the sizes of saccades of which 95 % are, in Wang, Woods, Costela
 * and Luo, "Dynamic gaze-position prediction of saccadic eye movements using a Taylor series",
 * Journal of Vision 17(14), 2017. */
static const double AHEAD_MS = 10, AHEAD_LEAST_DEG = 1, AHEAD_MOST_DEG = 32;

/* Longest time between samples, ms. */
static const double INTERVAL_MOST_MS = 17;

enum set { ANDERSSON, GAZECOM, SETS };

/* A saccade as people labelled it. */
struct truth {
	int64_t noticed_ns_least; /* when it may be noticed at the earliest */
	int64_t end_ns;
	double size_deg;
	double landing_deg[3];
};

/* What the prediction takes of a recording at one rate. */
struct track {
	struct gz_display display;
	int observer;
	enum set set;
	double interval_ms;
	size_t count, truth_count;
	struct gz_landing_input *input;
	struct truth *truth;
};

struct tracks {
	size_t count, room;
	struct track *track;
	size_t observer_count;
	char observer[OBSERVERS_MAX][GZ_OBSERVER_SIZE];
};

/* A sample of a running saccade. */
struct row {
	struct gz_landing_look look;
	double to_go_deg, to_go_ms; /* along the heading, and until the saccade's end */
	double now_deg;             /* from here to the landing place */
	double size_deg;
	double error_deg, error_ms, sigma_deg; /* of the prediction */
	double ahead_now_deg, ahead_error_deg; /* see take_ahead(); NaN: not measured */
	int observer;
	enum set set;
};

struct rows {
	size_t count, room;
	struct row *row;
};

/* ---- recordings ---- */

static void *grow(void *array, size_t count, size_t *room, size_t size)
{
	if (count < *room)
		return array;
	*room = *room ? 2 * *room : 1024;
	array = realloc(array, *room * size);
	if (!array) {
		fprintf(stderr, "gaze_landing: out of memory\n");
		exit(1);
	}
	return array;
}

static int observer_number(struct tracks *tracks, const char *name)
{
	for (size_t i = 0; i < tracks->observer_count; i++)
		if (strcmp(tracks->observer[i], name) == 0)
			return (int)i;
	if (tracks->observer_count == OBSERVERS_MAX)
		return OBSERVERS_MAX - 1;
	strcpy(tracks->observer[tracks->observer_count], name);
	return (int)tracks->observer_count++;
}

static bool mean_direction(const struct gz_labelled_recording *recording, size_t from, size_t to,
			   double out_deg[3])
{
	memset(out_deg, 0, 3 * sizeof *out_deg);
	for (size_t i = from; i < to; i++) {
		double deg[3];
		if (!recording->sample[i].valid || recording->label[i] == GZ_HUMAN_BLINK)
			return false;
		gz_direction_deg(&recording->display, recording->sample[i].point, deg);
		for (int k = 0; k < 3; k++)
			out_deg[k] += deg[k] / (double)(to - from);
	}
	return true;
}

static double distance_deg(const double a[3], const double b[3])
{
	const double d[3] = { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
	return gz_length3(d);
}

/* The saccade from sample @p from to before @p to, if its ends were measured. */
static bool truth_of(const struct gz_labelled_recording *recording, size_t from, size_t to,
		     double interval_ms, struct truth *out)
{
	const size_t rest = (size_t)(REST_MS / interval_ms);
	size_t landed = to;
	while (landed < recording->count && recording->label[landed] == GZ_HUMAN_GLISSADE)
		landed++;
	if (from < rest || landed + rest > recording->count)
		return false;
	double start_deg[3];
	for (size_t i = from; i < landed; i++)
		if (!recording->sample[i].valid)
			return false;
	for (size_t i = landed; i < landed + rest; i++)
		if (recording->label[i] == GZ_HUMAN_SACCADE)
			return false;
	if (!mean_direction(recording, from - rest / 2, from, start_deg) ||
	    !mean_direction(recording, landed, landed + rest, out->landing_deg))
		return false;
	out->size_deg = distance_deg(start_deg, out->landing_deg);
	out->noticed_ns_least =
		recording->sample[from].host_ns - (int64_t)(EARLY_MS * (double)GZ_NS_PER_MS);
	out->end_ns = recording->sample[to].host_ns;
	return out->size_deg >= LEAST_DEG && out->size_deg <= MOST_DEG;
}

static void find_truths(const struct gz_labelled_recording *recording, double interval_ms,
			struct track *track)
{
	size_t room = 0;
	for (size_t i = 1; i < recording->count; i++) {
		if (recording->label[i] != GZ_HUMAN_SACCADE ||
		    recording->label[i - 1] == GZ_HUMAN_SACCADE)
			continue;
		size_t to = i;
		while (to < recording->count && recording->label[to] == GZ_HUMAN_SACCADE)
			to++;
		track->truth = grow(track->truth, track->truth_count, &room, sizeof *track->truth);
		track->truth_count +=
			to < recording->count &&
			truth_of(recording, i, to, interval_ms, &track->truth[track->truth_count]);
		i = to;
	}
}

static void run_pipeline(const struct gz_labelled_recording *recording, size_t step,
			 struct track *track)
{
	static struct gz_pipeline pipeline;
	static struct gz_pipeline_output out;
	size_t room = 0;
	gz_pipeline_init(&pipeline, NULL, &recording->display);
	for (size_t i = 0; i < recording->count; i += step) {
		gz_pipeline_step(&pipeline, &recording->sample[i], &out);
		track->input = grow(track->input, track->count, &room, sizeof *track->input);
		track->input[track->count++] =
			(struct gz_landing_input) { out.gaze.event, recording->sample[i].host_ns,
						    out.rejection == GZ_REJECT_NONE,
						    gz_classify_newest(&pipeline.classify)->point };
	}
}

static void add_recording(struct tracks *tracks, const struct gz_labelled_recording *recording,
			  enum set set)
{
	const double interval_ms =
		gz_ns_to_ms(recording->sample[1].host_ns - recording->sample[0].host_ns);
	for (size_t step = 1; (double)step * interval_ms < INTERVAL_MOST_MS; step *= 2) {
		tracks->track =
			grow(tracks->track, tracks->count, &tracks->room, sizeof *tracks->track);
		struct track *track = &tracks->track[tracks->count++];
		*track = (struct track) { .display = recording->display,
					  .observer = observer_number(tracks, recording->observer),
					  .set = set,
					  .interval_ms = interval_ms * (double)step };
		find_truths(recording, interval_ms, track);
		run_pipeline(recording, step, track);
	}
}

static bool read_tracks(const char *data, struct tracks *tracks)
{
	for (size_t i = 0; i < GZ_LABELLED_FILES; i++) {
		struct gz_labelled_recording recording;
		const bool good = gz_labelled_recording_read(data, i, 0, &recording);
		if (good)
			add_recording(tracks, &recording, ANDERSSON);
		gz_labelled_recording_free(&recording);
		if (!good)
			return false;
	}
	for (size_t film = 0; film < GZ_GAZECOM_FILMS; film++) {
		struct gz_gazecom gazecom;
		const bool good = gz_gazecom_read(data, film, &gazecom);
		for (size_t i = 0; good && i < gazecom.count; i++)
			add_recording(tracks, &gazecom.recording[i], GAZECOM);
		gz_gazecom_free(&gazecom);
		if (!good)
			return false;
	}
	return true;
}

/* ---- rows ---- */

/* Where the eye is AHEAD_MS after sample @p i. @return false: not measured */
static bool place_ahead(const struct track *track, size_t i, double out_deg[3])
{
	const int64_t time_ns = track->input[i].time_ns + (int64_t)(AHEAD_MS * GZ_NS_PER_MS);
	while (i + 1 < track->count && track->input[i + 1].time_ns < time_ns)
		i++;
	const struct gz_landing_input *a = &track->input[i], *b = a + 1;
	if (i + 1 >= track->count || !a->valid || !b->valid)
		return false;
	const float part = (float)(time_ns - a->time_ns) / (float)(b->time_ns - a->time_ns);
	const struct gz_point point = { a->point.x + part * (b->point.x - a->point.x),
					a->point.y + part * (b->point.y - a->point.y) };
	gz_direction_deg(&track->display, point, out_deg);
	return true;
}

/* How far the eye is from here after AHEAD_MS, and from where it would be with the present speed,
 * no farther than to the landing place. So Wang et al. 2017 measure. */
static void take_ahead(const struct track *track, size_t i, const double landing_deg[3],
		       struct row *row)
{
	const struct gz_landing_look *look = &row->look;
	double ahead_deg[3], place_deg[3];
	row->ahead_now_deg = row->ahead_error_deg = NAN;
	if (!place_ahead(track, i, ahead_deg))
		return;
	const double way_deg = fmin(look->speed_deg_s * AHEAD_MS * 1e-3,
				    distance_deg(landing_deg, look->place_deg));
	for (int k = 0; k < 3; k++)
		place_deg[k] = look->place_deg[k] + way_deg * look->heading[k];
	row->ahead_now_deg = distance_deg(ahead_deg, look->place_deg);
	row->ahead_error_deg = distance_deg(ahead_deg, place_deg);
}

static void take_row(const struct track *track, const struct truth *truth, size_t i,
		     const struct gz_landing_look *look, const struct gz_landing *landing,
		     struct rows *rows)
{
	const int64_t time_ns = track->input[i].time_ns;
	double way[3], predicted_deg[3];
	for (int k = 0; k < 3; k++)
		way[k] = truth->landing_deg[k] - look->place_deg[k];
	gz_direction_deg(&track->display, landing->point, predicted_deg);
	rows->row = grow(rows->row, rows->count, &rows->room, sizeof *rows->row);
	rows->row[rows->count++] = (struct row) {
		.look = *look,
		.to_go_deg = fmax(0, gz_dot3(way, look->heading)),
		.to_go_ms = fmax(0, gz_ns_to_ms(truth->end_ns - time_ns)),
		.now_deg = gz_length3(way),
		.size_deg = truth->size_deg,
		.error_deg = distance_deg(predicted_deg, truth->landing_deg),
		.error_ms = fabs(gz_ns_to_ms(landing->time_ns - truth->end_ns)),
		.sigma_deg = landing->sigma_deg,
		.observer = track->observer,
		.set = track->set,
	};
	take_ahead(track, i, predicted_deg, &rows->row[rows->count - 1]);
}

/* Predict in one track. Saccades that were noticed before they began do not count. */
static void predict_track(const struct track *track, const struct gz_landing_model *model,
			  struct rows *rows)
{
	static struct gz_landing_state state;
	state = (struct gz_landing_state) { .count = 0 };
	size_t t = 0;
	for (size_t i = 0; i < track->count; i++) {
		const struct gz_landing_input *input = &track->input[i];
		const struct gz_landing landing =
			gz_landing_step(&state, model, &track->display, input);
		while (t < track->truth_count && input->time_ns > track->truth[t].end_ns)
			t++;
		if (landing.known && t < track->truth_count &&
		    state.begin_ns >= track->truth[t].noticed_ns_least)
			take_row(track, &track->truth[t], i, &state.look, &landing, rows);
	}
}

/* ---- fitting ---- */

/* A x = b in place, by Gaussian elimination with the greatest pivot. */
static void solve(int count, double a[TERMS][TERMS], double b[TERMS])
{
	for (int i = 0; i < count; i++) {
		int pivot = i;
		for (int k = i + 1; k < count; k++)
			if (fabs(a[k][i]) > fabs(a[pivot][i]))
				pivot = k;
		for (int j = 0; j < count; j++) {
			const double kept = a[i][j];
			a[i][j] = a[pivot][j];
			a[pivot][j] = kept;
		}
		const double kept = b[i];
		b[i] = b[pivot];
		b[pivot] = kept;
		for (int k = i + 1; k < count; k++) {
			const double times = a[k][i] / a[i][i];
			for (int j = i; j < count; j++)
				a[k][j] -= times * a[i][j];
			b[k] -= times * b[i];
		}
	}
	for (int i = count - 1; i >= 0; i--) {
		for (int j = i + 1; j < count; j++)
			b[i] -= a[i][j] * b[j];
		b[i] /= a[i][i];
	}
}

/* Samples of one bin, with what is to be told from their terms. */
struct sample_set {
	size_t count;
	double (*terms)[TERMS];
	double *wanted, *weight, *rest;
};

/* Weighted least squares; a ridge of 1e-5 of each term's spread keeps terms that vary together
 * from cancelling each other. */
static void fit_squares(const struct sample_set *set, int count, double out[TERMS])
{
	double a[TERMS][TERMS] = { { 0 } }, b[TERMS] = { 0 }, scale[TERMS];
	for (int j = 0; j < count; j++) {
		double squares = 1e-18;
		for (size_t i = 0; i < set->count; i++)
			squares += set->terms[i][j] * set->terms[i][j] / (double)set->count;
		scale[j] = sqrt(squares);
	}
	double all = 0;
	for (size_t i = 0; i < set->count; i++) {
		const double *terms = set->terms[i], weight = set->weight[i];
		all += weight;
		for (int j = 0; j < count; j++) {
			for (int k = 0; k < count; k++)
				a[j][k] += weight * terms[j] * terms[k] / (scale[j] * scale[k]);
			b[j] += weight * terms[j] * set->wanted[i] / scale[j];
		}
	}
	for (int j = 0; j < count; j++)
		a[j][j] += 1e-5 * all;
	solve(count, a, b);
	for (int j = 0; j < count; j++)
		out[j] = b[j] / scale[j];
}

/* The number below which a share of them lies; sorts them. */
static double quantile(double *numbers, size_t count, double share)
{
	qsort(numbers, count, sizeof *numbers, gz_compare_doubles);
	return count ? numbers[(size_t)(share * (double)(count - 1))] : NAN;
}

static double weighted_sum(const double weights[TERMS], const double terms[TERMS], int count)
{
	double sum = 0;
	for (int j = 0; j < count; j++)
		sum += weights[j] * terms[j];
	return sum;
}

/* Relative errors count, those beyond 1.5 times the median less the larger they are (Huber). */
static void fit_robustly(struct sample_set *set, double least, double out[TERMS])
{
	for (size_t i = 0; i < set->count; i++)
		set->weight[i] = 1 / (least + set->wanted[i]);
	fit_squares(set, TERMS, out);
	for (int round = 0; round < ROUNDS; round++) {
		for (size_t i = 0; i < set->count; i++)
			set->rest[i] =
				fabs(set->wanted[i] - weighted_sum(out, set->terms[i], TERMS)) /
				(least + set->wanted[i]);
		memcpy(set->weight, set->rest, set->count * sizeof *set->weight);
		const double usual = 1.5 * quantile(set->weight, set->count, 0.5);
		for (size_t i = 0; i < set->count; i++)
			set->weight[i] = 1 / (least + set->wanted[i]) /
					 fmax(1, set->rest[i] / fmax(usual, 1e-9));
		fit_squares(set, TERMS, out);
	}
}

/* The line over the distance to go below which 68 % of the errors lie, by reweighted squares. */
static void fit_sigma(struct sample_set *set, const double *error_deg, double out[2])
{
	double line[TERMS] = { 1, 0 };
	memcpy(set->wanted, error_deg, set->count * sizeof *set->wanted);
	for (int round = 0; round < 4 * ROUNDS; round++) {
		for (size_t i = 0; i < set->count; i++) {
			const double rest = set->wanted[i] - weighted_sum(line, set->terms[i], 2);
			set->weight[i] = (rest > 0 ? 0.68 : 0.32) / fmax(0.02, fabs(rest));
		}
		fit_squares(set, 2, line);
	}
	out[0] = fmax(0.05, line[0]);
	out[1] = fmax(0, line[1]);
}

static bool kept_out(const struct row *row, int fold, int set)
{
	return (fold >= 0 && row->observer % FOLDS == fold) || (int)row->set == set;
}

static bool belongs(const struct row *row, size_t bin, bool slow)
{
	return gz_landing_bin(row->look.elapsed_ms) == bin &&
	       gz_landing_is_slow(row->look.interval_ms) == slow;
}

static double error_with(const struct row *row, double to_go_deg)
{
	const double along = row->to_go_deg - to_go_deg;
	const double aside2 = row->now_deg * row->now_deg - row->to_go_deg * row->to_go_deg;
	return sqrt(along * along + fmax(0, aside2));
}

/* Too few rows: the weights stay. */
static void fit_bin(const struct rows *rows, size_t bin, bool slow, int fold, int left_out_set,
		    struct sample_set *set, struct gz_landing_weights *out)
{
	enum { FEWEST = 200 };
	set->count = 0;
	for (size_t i = 0; i < rows->count; i++) {
		const struct row *row = &rows->row[i];
		if (!belongs(row, bin, slow) || kept_out(row, fold, left_out_set))
			continue;
		gz_landing_terms(&row->look, set->terms[set->count]);
		set->wanted[set->count++] = row->to_go_deg;
	}
	if (set->count < FEWEST)
		return;
	fit_robustly(set, 0.5, out->deg);
	double *error_deg = malloc(set->count * sizeof *error_deg);
	size_t k = 0;
	for (size_t i = 0; i < rows->count; i++) {
		const struct row *row = &rows->row[i];
		if (!belongs(row, bin, slow) || kept_out(row, fold, left_out_set))
			continue;
		const double to_go_deg = fmin(
			GZ_LANDING_DEG_MAX, fmax(0, weighted_sum(out->deg, set->terms[k], TERMS)));
		if (error_deg)
			error_deg[k] = error_with(row, to_go_deg);
		set->wanted[k++] = row->to_go_ms;
	}
	fit_robustly(set, 8, out->ms);
	for (k = 0; k < set->count; k++) {
		set->terms[k][1] = fmin(GZ_LANDING_DEG_MAX,
					fmax(0, weighted_sum(out->deg, set->terms[k], TERMS)));
		set->terms[k][0] = 1;
	}
	if (error_deg)
		fit_sigma(set, error_deg, out->sigma);
	free(error_deg);
}

static struct gz_landing_model fit(const struct rows *rows, int fold, int left_out_set)
{
	static struct gz_landing_model model;
	struct sample_set set = { 0 };
	set.terms = malloc((rows->count + 1) * sizeof *set.terms);
	set.wanted = malloc((rows->count + 1) * sizeof *set.wanted);
	set.weight = malloc((rows->count + 1) * sizeof *set.weight);
	set.rest = malloc((rows->count + 1) * sizeof *set.rest);
	memset(&model, 0, sizeof model);
	for (size_t bin = 0;
	     set.terms && set.wanted && set.weight && set.rest && bin < GZ_LANDING_BINS; bin++) {
		if (bin > 0) {
			model.fast[bin] = model.fast[bin - 1];
			model.slow[bin] = model.slow[bin - 1];
		}
		fit_bin(rows, bin, false, fold, left_out_set, &set, &model.fast[bin]);
		fit_bin(rows, bin, true, fold, left_out_set, &set, &model.slow[bin]);
	}
	free(set.terms);
	free(set.wanted);
	free(set.weight);
	free(set.rest);
	return model;
}

/* ---- tables ---- */

/* Rows that a line of a table is about. */
struct choice {
	double elapsed_least_ms, elapsed_most_ms;
	double size_least_deg, size_most_deg;
	int slow;     /* 0 or 1 */
	int observer; /* -1: all */
};

static bool chosen(const struct row *row, const struct choice *choice)
{
	return row->look.elapsed_ms >= choice->elapsed_least_ms &&
	       row->look.elapsed_ms < choice->elapsed_most_ms &&
	       row->size_deg >= choice->size_least_deg && row->size_deg < choice->size_most_deg &&
	       gz_landing_is_slow(row->look.interval_ms) == choice->slow &&
	       (choice->observer < 0 || row->observer == choice->observer);
}

struct spread {
	double median, mean, most; /* 95th percentile */
};

static struct spread spread_of(double *numbers, size_t count)
{
	double sum = 0;
	for (size_t i = 0; i < count; i++)
		sum += numbers[i];
	return (struct spread) { quantile(numbers, count, 0.5), sum / (double)count,
				 quantile(numbers, count, 0.95) };
}

static void print_line(const char *name, const struct rows *rows, const struct choice *choice)
{
	double *error = malloc((rows->count + 1) * sizeof *error),
	       *now = malloc((rows->count + 1) * sizeof *now);
	double *late = malloc((rows->count + 1) * sizeof *late);
	size_t count = 0, within = 0;
	for (size_t i = 0; error && now && late && i < rows->count; i++) {
		const struct row *row = &rows->row[i];
		if (!chosen(row, choice))
			continue;
		within += row->error_deg <= row->sigma_deg;
		error[count] = row->error_deg;
		late[count] = row->error_ms;
		now[count++] = row->now_deg;
	}
	if (count > 0) {
		const struct spread a = spread_of(now, count), b = spread_of(error, count),
				    c = spread_of(late, count);
		printf("%-24s %6zu  %5.2f %5.2f %6.2f  %5.2f %5.2f %6.2f  %5.1f %5.1f  %.2f\n",
		       name, count, a.median, a.mean, a.most, b.median, b.mean, b.most, c.median,
		       c.mean, (double)within / (double)count);
	}
	free(error);
	free(now);
	free(late);
}

static void print_head(const char *what)
{
	printf("\n%s\n%-24s %6s  %-18s  %-18s  %-11s  within\n", what, "", "", "the eye is off by",
	       "the prediction by", "its time by");
	printf("%-24s %6s  %5s %5s %6s  %5s %5s %6s  %5s %5s  sigma\n", "", "number", "med.",
	       "mean", "95 %", "med.", "mean", "95 %", "med.", "mean");
}

static void print_by_time(const struct rows *rows, int slow)
{
	char name[40];
	for (int ms = 0; ms < GZ_LANDING_BINS * GZ_LANDING_BIN_MS; ms += GZ_LANDING_BIN_MS) {
		const struct choice choice = { ms, ms + GZ_LANDING_BIN_MS, 0, 90, slow, -1 };
		snprintf(name, sizeof name, "%d ms after it is seen", ms);
		print_line(name, rows, &choice);
	}
}

static void print_by_size(const struct rows *rows, int slow)
{
	static const double sizes[] = { 0.5, 2, 5, 10, 20, 35 };
	char name[64];
	for (int ms = 8; ms <= 24; ms += 8)
		for (size_t i = 0; i + 1 < sizeof sizes / sizeof sizes[0]; i++) {
			const struct choice choice = { ms,       ms + GZ_LANDING_BIN_MS,
						       sizes[i], sizes[i + 1],
						       slow,     -1 };
			snprintf(name, sizeof name, "%d ms, %.1f to %.1f degrees", ms, sizes[i],
				 sizes[i + 1]);
			print_line(name, rows, &choice);
		}
}

static void print_by_observer(const struct tracks *tracks, const struct rows *rows)
{
	for (size_t i = 0; i < tracks->observer_count; i++) {
		const struct choice choice = { 12, 16, 0, 90, 0, (int)i };
		print_line(tracks->observer[i], rows, &choice);
	}
}

/* The place of the eye AHEAD_MS later, mean of all samples of saccades. */
static void print_ahead(const struct rows *rows)
{
	double now = 0, error = 0, count = 0;
	for (size_t i = 0; i < rows->count; i++) {
		const struct row *row = &rows->row[i];
		if (isnan(row->ahead_now_deg) || row->size_deg < AHEAD_LEAST_DEG ||
		    row->size_deg > AHEAD_MOST_DEG || gz_landing_is_slow(row->look.interval_ms))
			continue;
		now += row->ahead_now_deg;
		error += row->ahead_error_deg;
		count++;
	}
	printf("\nThe eye %.0f ms later, saccades of %.0f to %.0f degrees, 250 and 500 Hz, mean: "
	       "from where it is now %.2f, from where it is thought to be %.2f degrees\n",
	       AHEAD_MS, AHEAD_LEAST_DEG, AHEAD_MOST_DEG, now / count, error / count);
}

static struct rows predict_all(const struct tracks *tracks, const struct gz_landing_model *model)
{
	struct rows rows = { .count = 0 };
	for (size_t i = 0; i < tracks->count; i++)
		predict_track(&tracks->track[i], model, &rows);
	return rows;
}

static void evaluate(const struct tracks *tracks, const struct rows *looks)
{
	struct rows rows = { .count = 0 };
	for (int fold = 0; fold < FOLDS; fold++) {
		const struct gz_landing_model model = fit(looks, fold, -1);
		for (size_t i = 0; i < tracks->count; i++)
			if (tracks->track[i].observer % FOLDS == fold)
				predict_track(&tracks->track[i], &model, &rows);
	}
	print_head("Degrees and ms, people that it was not fitted to, 250 and 500 Hz");
	print_by_time(&rows, 0);
	print_head("by size");
	print_by_size(&rows, 0);
	print_head("60 and 125 Hz");
	print_by_time(&rows, 1);
	print_head("by person, 12 ms after it is seen");
	print_by_observer(tracks, &rows);
	print_ahead(&rows);
	rows.count = 0;
	for (int set = 0; set < SETS; set++) {
		const struct gz_landing_model model = fit(looks, -1, set);
		for (size_t i = 0; i < tracks->count; i++)
			if ((int)tracks->track[i].set == set)
				predict_track(&tracks->track[i], &model, &rows);
	}
	print_head("a data set that it was not fitted to, 250 and 500 Hz");
	print_by_time(&rows, 0);
	free(rows.row);
}

/* ---- writing ---- */

static void write_numbers(FILE *file, const char *name, const double *numbers, int count)
{
	fprintf(file, "\t\t  .%s = { ", name);
	for (int i = 0; i < count; i++)
		fprintf(file, "%s%.9g", i ? ", " : "", numbers[i]);
	fprintf(file, " },\n");
}

static void write_weights(FILE *file, const char *name, const struct gz_landing_weights *weights)
{
	fprintf(file, "\t.%s = {\n", name);
	for (int bin = 0; bin < GZ_LANDING_BINS; bin++) {
		fprintf(file, "\t\t{\n");
		write_numbers(file, "deg", weights[bin].deg, TERMS);
		write_numbers(file, "ms", weights[bin].ms, TERMS);
		write_numbers(file, "sigma", weights[bin].sigma, 2);
		fprintf(file, "\t\t},\n");
	}
	fprintf(file, "\t},\n");
}

static int write_model(const char *path, const struct gz_landing_model *model, size_t rows)
{
	FILE *file = fopen(path, "w");
	if (!file) {
		fprintf(stderr, "gaze_landing: cannot write %s\n", path);
		return 1;
	}
	fprintf(file,
		"/* Made by bench/probes/gaze_landing.c from %zu samples of saccades of Andersson "
		"2017\n"
		" * and GazeCom; do not edit. */\n#include \"filter/landing.h\"\n\n"
		"/* clang-format off */\nconst struct gz_landing_model gz_landing_model = {\n",
		rows);
	write_weights(file, "fast", model->fast);
	write_weights(file, "slow", model->slow);
	fprintf(file, "};\n");
	return fclose(file) == 0 ? 0 : 1;
}

static void free_tracks(struct tracks *tracks)
{
	for (size_t i = 0; i < tracks->count; i++) {
		free(tracks->track[i].input);
		free(tracks->track[i].truth);
	}
	free(tracks->track);
}

int main(int argc, char **argv)
{
	static struct tracks tracks;
	if (argc > 2 || (argc == 2 && argv[1][0] == '-')) {
		printf("usage: gaze_landing [FILE]\n");
		return argc == 2 && strcmp(argv[1], "--help") == 0 ? 0 : 2;
	}
	int status = 0;
	if (!read_tracks(getenv("GAZECAST_DATA"), &tracks)) {
		printf("no recordings: GAZECAST_DATA must name the folder that has "
		       "gaze/andersson2017 and gaze/gazecom\n");
		status = SKIPPED;
	} else {
		struct rows looks = predict_all(&tracks, &gz_landing_model);
		const struct gz_landing_model model = fit(&looks, -1, -1);
		if (argc == 2)
			status = write_model(argv[1], &model, looks.count);
		else
			evaluate(&tracks, &looks);
		free(looks.row);
	}
	free_tracks(&tracks);
	return status;
}
