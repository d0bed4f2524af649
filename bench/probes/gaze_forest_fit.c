/*
 * Trains the forests that label eye movements (filter/classifier), and measures them on recordings
 * that were kept out.
 *
 * usage: gaze_forest_fit FOLDER [KEY=NUMBER...] [without=NAME,NAME...]
 *
 * FOLDER holds what gaze_features wrote. Writes FOLDER/TAG.forest, and for each row that a fold
 * kept out its scores into FOLDER/TAG.scores; again=1 measures these scores with other settings.
 * Features whose names begin with a NAME are not used.
 *
 * Gradient boosting with trees whose leaves have one value for each class: Friedman, "Greedy
 * function approximation: a gradient boosting machine", Annals of Statistics 29, 2001, with
 * histograms of quantised features (Ke et al., "LightGBM", NIPS 2017), Newton steps for softmax,
 * and a random part of rows and features for each tree (Friedman, "Stochastic gradient boosting",
 * 2002).
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/filter/labelled_recording.h"
#include "filter/classifier/whole.h"
#include "sim/random.h"

enum { FEATURES_MAX = GZ_WHOLE_FEATURES, CLASSES_MAX = GZ_FOREST_CLASSES };
enum { BINS_MAX = 256, LEAVES_MAX = 64 };
enum { NODES_MAX = 2 * LEAVES_MAX, TREES_MAX = 1024, TRACKS_MAX = 2048, FOLDS_MAX = 32 };
enum { FOLDS_WITHOUT_FILMS = 6 };
enum { LABEL_NUMBERS = 5, UNUSED = -1 };

/* Gradients of the classes, the Hessian and the weight of a row or of a bin's rows. */
typedef float sums __attribute__((vector_size(32)));
enum { HESSIAN = CLASSES_MAX, WEIGHT = CLASSES_MAX + 1 };

struct settings {
	double certain; /* 1: learn the label of 8 ms ago, 0: that of the sample itself */
	double again;   /* 1: measure the scores of an earlier run with this tag */
	double whole;   /* 1: learn from later samples too, and the ringing after a saccade */
	double rings;   /* 1: learn the ringing after a saccade */
	double trees, leaves, depth, rate, lambda, bins;
	double rows, columns; /* parts for each tree */
	double least;         /* least weight of a leaf */
	double andersson;     /* weight of a sample of that set, against one of GazeCom */
	double slow;          /* weight of recordings at lower rates */
	double simulated;     /* weight of 4 ms of a simulated viewer */
	double altered;       /* weight of altered copies of recordings */
	double ringing;       /* weight of samples in which the eye rings after a saccade */
	double folds; /* 0: train on all; 1: by film and person; 2: by data set; more: so many,
			 each of several films and persons */
	double each;  /* 1: with again=1, print figures of each film and each recording */
	double worth; /* 1: measure what groups of features are worth, on what folds kept out */
	double recordings; /* 1: folds of several recordings each, whoever they are of */
	double thin;       /* learn from every so many samples only: neighbours are alike */
	double dense;      /* 1: but from all of Andersson et al., each with so much less weight */
	double saccade, pursuit, noise; /* added to the scores of these classes */
	double seed, tag, only_fold;
};

static const struct {
	const char *key;
	size_t offset;
	double preset;
} KEYS[] = {
#define KEY(name, preset)                                      \
	{                                                      \
#name, offsetof(struct settings, name), preset \
	}
	KEY(certain, 0),    KEY(trees, 100), KEY(leaves, 32),    KEY(depth, 8),     KEY(rate, 0.1),
	KEY(lambda, 1),     KEY(bins, 64),   KEY(rows, 0.25),    KEY(columns, 0.4), KEY(least, 20),
	KEY(andersson, 5),  KEY(slow, 0),    KEY(simulated, 0),  KEY(ringing, 1),   KEY(folds, 1),
	KEY(seed, 1),       KEY(saccade, 0), KEY(pursuit, 0),    KEY(noise, 0),     KEY(tag, 0),
	KEY(only_fold, -1), KEY(whole, 0),   KEY(again, 0),      KEY(thin, 1),      KEY(altered, 0),
	KEY(rings, 0),      KEY(dense, 0),   KEY(recordings, 0), KEY(worth, 0),     KEY(each, 0),
};
enum { KEY_COUNT = sizeof KEYS / sizeof KEYS[0] };

static double *setting_at(struct settings *settings, int key)
{
	return (double *)(void *)((char *)settings + KEYS[key].offset);
}

struct track {
	bool andersson, simulated, altered;
	char kind[64], name[64];
	double period_ms;
	int fold;
};

struct row {
	float *features;
	int index; /* place in the file */
	int16_t track;
	int8_t label[2]; /* classes by both people; UNUSED */
	bool either;     /* a saccade may as well be the ringing after it */
	int8_t human[2]; /* the same as enum gz_human_label; 0: unknown */
	bool valid;      /* whether the labelled sample was measured */
	bool learned;    /* whether it is learned from, where it is not kept out */
	float weight;
};

struct node {
	int feature; /* -1: a leaf */
	int bin;     /* left if the feature's bin is at most this */
	int left, right;
	float value[CLASSES_MAX];
	int begin, end; /* its rows in the order of the tree */
	int depth;
	double gain;
	sums total;
	sums *histogram; /* features x bins */
};

struct tree {
	int node_count;
	struct node node[NODES_MAX];
};

struct training {
	struct settings settings;
	struct track track[TRACKS_MAX];
	int track_count;
	struct row *row;
	int row_count;
	int feature_count, class_count;
	uint8_t *bins; /* row_count x feature_count */
	int bin_count;
	float edges[FEATURES_MAX][BINS_MAX];
	int edge_count[FEATURES_MAX];
	struct gz_random random;
	/* of the present forest */
	float (*score)[CLASSES_MAX];
	sums *gradient;
	bool *kept_out;
	float base[CLASSES_MAX];
	struct tree *tree;
	int tree_count;
	int *order, *spare;
	bool column[FEATURES_MAX];
	bool unused[FEATURES_MAX];
	const char *without; /* the argument that says so; NULL: none */
	sums *pool;          /* histograms of the leaves of the present tree */
};

/* ---- reading ---- */

/* Vectors need memory at multiples of their size. */
static void *new_array(size_t count, size_t size)
{
	const size_t bytes = (count * size + 31) / 32 * 32;
	void *array = aligned_alloc(32, bytes);
	if (!array) {
		fprintf(stderr, "gaze_forest_fit: no memory\n");
		exit(1);
	}
	return memset(array, 0, bytes);
}

static void *read_all(const char *folder, const char *name, size_t *out_size)
{
	char path[1024];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	FILE *file = fopen(path, "rb");
	if (!file || fseek(file, 0, SEEK_END) != 0) {
		fprintf(stderr, "%s: cannot read it\n", path);
		exit(1);
	}
	*out_size = (size_t)ftell(file);
	rewind(file);
	char *bytes = malloc(*out_size + 1);
	if (!bytes || fread(bytes, 1, *out_size, file) != *out_size)
		exit(1);
	bytes[*out_size] = 0;
	fclose(file);
	return bytes;
}

static void read_tracks(struct training *t, const char *folder)
{
	size_t size;
	char *text = read_all(folder, "tracks.tsv", &size), *save = NULL;
	for (char *line = strtok_r(text, "\n", &save); line; line = strtok_r(NULL, "\n", &save)) {
		struct track *track = &t->track[t->track_count++];
		char set[32];
		double period_us;
		int number, altered;
		if (sscanf(line, "%d\t%31[^\t]\t%63[^\t]\t%63[^\t]\t%lf\t%d", &number, set,
			   track->kind, track->name, &period_us, &altered) != 6)
			exit(1);
		track->altered = altered != 0;
		track->andersson = strcmp(set, "andersson") == 0;
		track->simulated = strcmp(set, "simulated") == 0;
		track->period_ms = period_us * 1e-3;
	}
	free(text);
}

static int8_t class_of(int label)
{
	switch (label) {
	case GZ_HUMAN_FIXATION:
		return 0;
	case GZ_HUMAN_SACCADE:
		return 1;
	case GZ_HUMAN_PURSUIT:
		return 2;
	case GZ_HUMAN_BLINK:
	case GZ_HUMAN_UNDEFINED:
		return 3;
	default:
		return UNUSED;
	}
}

/* Whether ringing after a saccade is a class of its own. */
static bool knows_ringing(const struct training *t)
{
	return t->class_count == GZ_FOREST_CLASSES;
}

/* The class of a sample. While the eye rings after a saccade, it is that of what follows, unless
 * ringing is a class of its own. */
static int8_t class_at(const struct training *t, const int16_t *numbers, size_t index, size_t count,
		       int person)
{
	const int16_t *here = numbers + index * LABEL_NUMBERS;
	if (knows_ringing(t) && here[1 + person] == GZ_HUMAN_GLISSADE)
		return GZ_FOREST_RINGING;
	size_t i = index;
	while (i < count && numbers[i * LABEL_NUMBERS] == here[0] &&
	       numbers[i * LABEL_NUMBERS + 1 + person] == GZ_HUMAN_GLISSADE)
		i++;
	if (i == count || numbers[i * LABEL_NUMBERS] != here[0])
		return UNUSED;
	int8_t found = class_of(numbers[i * LABEL_NUMBERS + 1 + person]);
	return i > index && (found == 1 || found == 3) ? UNUSED : found;
}

static double native_ms(const struct track *track)
{
	return track->andersson ? 2 : 4;
}

/* Whether it is a recording as it is, and no copy at another rate, nor altered, nor simulated. */
static bool is_original(const struct track *track)
{
	return !track->simulated && !track->altered && track->period_ms <= native_ms(track);
}

static float weight_of(const struct training *t, const struct track *track)
{
	const struct settings *s = &t->settings;
	double weight = track->simulated   ? s->simulated * track->period_ms / 4
			: track->andersson ? s->andersson
					   : 1;
	if (track->altered)
		weight *= s->altered;
	if (!track->simulated && track->period_ms > native_ms(track))
		weight *= s->slow * track->period_ms / native_ms(track);
	if (s->certain > 0 && track->period_ms > 8)
		weight = 0;
	return (float)weight;
}

static void read_rows(struct training *t, const char *folder)
{
	size_t label_size, size;
	float *features = read_all(folder, "features.f32", &size);
	int16_t *numbers = read_all(folder, "labels.i16", &label_size);
	size_t count = label_size / (LABEL_NUMBERS * sizeof *numbers);
	t->row = calloc(count, sizeof *t->row);
	for (size_t i = 0; i < count; i++) {
		const int16_t *n = numbers + i * LABEL_NUMBERS;
		const struct track *track = &t->track[n[0]];
		struct row *row = &t->row[t->row_count];
		size_t back = t->settings.certain > 0 ? (size_t)(8 / track->period_ms + 0.1) : 0;
		const bool dense = t->settings.dense > 0 && track->andersson;
		row->features = features + i * FEATURES_MAX;
		row->index = (int)i;
		row->track = n[0];
		row->weight = weight_of(t, track);
		row->learned = dense || i % (size_t)t->settings.thin == 0;
		if (dense)
			row->weight /= (float)t->settings.thin;
		if (row->weight <= 0 || (!row->learned && !is_original(track)))
			continue;
		bool known = i >= back && numbers[(i - back) * LABEL_NUMBERS] == n[0];
		for (int p = 0; p < 2; p++) {
			row->label[p] = known ? class_at(t, numbers, i - back, count, p) : UNUSED;
			row->human[p] =
				known ? (int8_t)numbers[(i - back) * LABEL_NUMBERS + 1 + (size_t)p]
				      : 0;
		}
		/* The coders of GazeCom call both a saccade. */
		row->either = knows_ringing(t) && !track->andersson && !track->simulated;
		row->valid = known && numbers[(i - back) * LABEL_NUMBERS + 3] != 0;
		row->learned = row->learned && (row->valid || !track->altered);
		if (known && numbers[(i - back) * LABEL_NUMBERS + 1] == GZ_HUMAN_GLISSADE)
			row->weight *= (float)t->settings.ringing;
		t->row_count++;
	}
	free(numbers);
}

static int compare_floats(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

/* To four digits, so that thresholds are short to write. */
static float rounded(float x)
{
	char text[32];
	snprintf(text, sizeof text, "%.3e", (double)x);
	return strtof(text, NULL);
}

static uint8_t *bins_of(const struct training *t, int row)
{
	return t->bins + (size_t)row * (size_t)t->feature_count;
}

static void make_bins(struct training *t)
{
	enum { PROBES = 60000 };
	float *probe = malloc(PROBES * sizeof *probe);
	t->bin_count = (int)t->settings.bins;
	t->bins = malloc((size_t)t->row_count * (size_t)t->feature_count);
	for (int f = 0; f < t->feature_count; f++) {
		for (int i = 0; i < PROBES; i++)
			probe[i] = t->row[gz_random_bits(&t->random) % (uint64_t)t->row_count]
					   .features[f];
		qsort(probe, PROBES, sizeof *probe, compare_floats);
		int n = 0;
		for (int b = 1; b < t->bin_count; b++) {
			float edge = rounded(probe[(size_t)b * PROBES / (size_t)t->bin_count]);
			if (edge > probe[0] && (n == 0 || edge > t->edges[f][n - 1]))
				t->edges[f][n++] = edge;
		}
		t->edge_count[f] = n;
	}
	for (int i = 0; i < t->row_count; i++)
		for (int f = 0; f < t->feature_count; f++) {
			int low = 0, high = t->edge_count[f];
			float x = t->row[i].features[f];
			while (low < high) {
				int middle = (low + high) / 2;
				if (x >= t->edges[f][middle])
					low = middle + 1;
				else
					high = middle;
			}
			bins_of(t, i)[f] = (uint8_t)low;
		}
	free(probe);
}

/* ---- one tree ---- */

static sums *histogram_of(struct training *t, int leaf)
{
	return t->pool + (size_t)leaf * (size_t)t->feature_count * (size_t)t->bin_count;
}

static void fill_histogram(struct training *t, const struct node *node)
{
	size_t bins = (size_t)t->bin_count;
	int column[FEATURES_MAX] = { 0 }, columns = 0;
	for (int f = 0; f < t->feature_count; f++)
		if (t->column[f])
			column[columns++] = f;
	memset(node->histogram, 0, (size_t)t->feature_count * bins * sizeof *node->histogram);
	for (int i = node->begin; i < node->end; i++) {
		int row = t->order[i];
		const uint8_t *bin = bins_of(t, row);
		sums g = t->gradient[row];
		for (int c = 0; c < columns; c++)
			node->histogram[(size_t)column[c] * bins + bin[column[c]]] += g;
	}
}

static double score_sums(const sums *s, double lambda)
{
	double g2 = 0;
	for (int k = 0; k < CLASSES_MAX; k++) /* those that are not there are 0 */
		g2 += (double)(*s)[k] * (*s)[k];
	return g2 / ((*s)[HESSIAN] + lambda);
}

static void find_split(struct training *t, struct node *node)
{
	const struct settings *s = &t->settings;
	size_t bins = (size_t)t->bin_count;
	node->gain = 0;
	if (node->depth >= (int)s->depth)
		return;
	double whole = score_sums(&node->total, s->lambda);
	for (int f = 0; f < t->feature_count; f++) {
		if (!t->column[f])
			continue;
		sums left = { 0 };
		for (int b = 0; b < t->edge_count[f]; b++) {
			left += node->histogram[(size_t)f * bins + (size_t)b];
			sums right = node->total - left;
			if (left[WEIGHT] < s->least || right[WEIGHT] < s->least)
				continue;
			double gain = score_sums(&left, s->lambda) + score_sums(&right, s->lambda) -
				      whole;
			if (gain > node->gain) {
				node->gain = gain;
				node->feature = f;
				node->bin = b;
			}
		}
	}
}

static void split_rows(struct training *t, struct node *node, struct node *left, struct node *right)
{
	int a = node->begin, spare = 0;
	for (int i = node->begin; i < node->end; i++) {
		int row = t->order[i];
		if (bins_of(t, row)[node->feature] <= node->bin)
			t->order[a++] = row;
		else
			t->spare[spare++] = row;
	}
	memcpy(t->order + a, t->spare, (size_t)spare * sizeof *t->order);
	left->begin = node->begin;
	left->end = right->begin = a;
	right->end = node->end;
}

static void total_rows(struct training *t, struct node *node)
{
	sums total = { 0 };
	for (int i = node->begin; i < node->end; i++)
		total += t->gradient[t->order[i]];
	node->total = total;
}

/* Split a leaf into two: the smaller one's histogram is filled, the other's is the difference. */
static void split_leaf(struct training *t, struct tree *tree, int leaf, int *pool_used)
{
	struct node *node = &tree->node[leaf];
	node->left = tree->node_count++;
	node->right = tree->node_count++;
	struct node *child[2] = { &tree->node[node->left], &tree->node[node->right] };
	for (int i = 0; i < 2; i++)
		*child[i] = (struct node) { .feature = -1, .depth = node->depth + 1 };
	split_rows(t, node, child[0], child[1]);
	int small = child[0]->end - child[0]->begin > child[1]->end - child[1]->begin;
	child[small]->histogram = histogram_of(t, (*pool_used)++);
	fill_histogram(t, child[small]);
	child[!small]->histogram = node->histogram;
	size_t cells = (size_t)t->feature_count * (size_t)t->bin_count;
	for (size_t i = 0; i < cells; i++)
		node->histogram[i] -= child[small]->histogram[i];
	for (int i = 0; i < 2; i++) {
		total_rows(t, child[i]);
		find_split(t, child[i]);
		child[i]->feature = child[i]->gain > 0 ? child[i]->feature : -1;
	}
}

static void set_leaf_value(struct training *t, struct node *node)
{
	double g[CLASSES_MAX] = { 0 }, h[CLASSES_MAX] = { 0 };
	for (int i = node->begin; i < node->end; i++) {
		int row = t->order[i];
		const float *score = t->score[row];
		double p[CLASSES_MAX], sum = 0;
		for (int k = 0; k < t->class_count; k++)
			sum += p[k] = exp((double)score[k]);
		for (int k = 0; k < t->class_count; k++) {
			p[k] /= sum;
			g[k] += (double)t->gradient[row][k];
			h[k] += p[k] * (1 - p[k]) * (double)t->gradient[row][WEIGHT];
		}
	}
	double mean = 0, value[CLASSES_MAX];
	for (int k = 0; k < t->class_count; k++) {
		value[k] = -g[k] / (h[k] + t->settings.lambda);
		value[k] = t->settings.rate * fmax(-4, fmin(4, value[k]));
		mean += value[k] / t->class_count;
	}
	for (int k = 0; k < t->class_count; k++)
		node->value[k] = (float)(value[k] - mean);
}

static void grow_tree(struct training *t, struct tree *tree, int rows)
{
	int leaves = 1, pool_used = 1;
	for (int f = 0; f < t->feature_count; f++)
		t->column[f] = gz_random_uniform(&t->random) < t->settings.columns && !t->unused[f];
	tree->node_count = 1;
	tree->node[0] =
		(struct node) { .feature = -1, .end = rows, .histogram = histogram_of(t, 0) };
	fill_histogram(t, &tree->node[0]);
	total_rows(t, &tree->node[0]);
	find_split(t, &tree->node[0]);
	bool split[NODES_MAX] = { false };
	while (leaves < (int)t->settings.leaves) {
		int best = -1;
		for (int i = 0; i < tree->node_count; i++)
			if (!split[i] && tree->node[i].gain > 0 &&
			    (best < 0 || tree->node[i].gain > tree->node[best].gain))
				best = i;
		if (best < 0)
			break;
		split[best] = true;
		split_leaf(t, tree, best, &pool_used);
		leaves++;
	}
	for (int i = 0; i < tree->node_count; i++)
		if (!split[i]) {
			tree->node[i].feature = -1;
			set_leaf_value(t, &tree->node[i]);
		}
}

static const struct node *leaf_of(const struct tree *tree, const uint8_t *bins)
{
	const struct node *node = &tree->node[0];
	while (node->feature >= 0)
		node = &tree->node[bins[node->feature] <= node->bin ? node->left : node->right];
	return node;
}

/* ---- what the folds give on the recordings that they kept out, at their native rates ---- */

enum { KINDS = GZ_LABELLED_STIMULI, FIGURES_EVERY = 20 };

/* The classes that the coders of GazeCom know: all but ringing. */
enum { FILM_CLASSES = GZ_FOREST_RINGING };

/* What is compared with each person. */
static const struct {
	const char *name;
	int class, human;
} COMPARED[] = {
	{ "saccade", GZ_FOREST_SACCADE, GZ_HUMAN_SACCADE },
	{ "fixation", GZ_FOREST_FIXATION, GZ_HUMAN_FIXATION },
	{ "pursuit", GZ_FOREST_PURSUIT, GZ_HUMAN_PURSUIT },
	{ "blink", GZ_FOREST_NOISE, GZ_HUMAN_BLINK },
	{ "ringing", GZ_FOREST_RINGING, GZ_HUMAN_GLISSADE },
};
enum { COMPARED_COUNT = sizeof COMPARED / sizeof COMPARED[0] };

struct figures {
	struct gz_agreement film[FILM_CLASSES]; /* GazeCom */
	struct gz_agreement coder[KINDS][2][COMPARED_COUNT];
};

static int kind_of(const struct track *track)
{
	for (int k = 0; k < KINDS; k++)
		if (strcmp(track->kind, gz_labelled_stimulus_names[k]) == 0)
			return k;
	return 0;
}

/* Whether a row is of a recording that was kept out and is measured. */
static bool is_measured_row(const struct training *t, int row)
{
	const struct track *track = &t->track[t->row[row].track];
	return t->kept_out[t->row[row].track] && is_original(track);
}

/* What is added to the score of a class. */
static double added_score(const struct training *t, int class)
{
	const double more[CLASSES_MAX] = { 0, t->settings.saccade, t->settings.pursuit,
					   t->settings.noise };
	return more[class];
}

static int quantised(float value);

/* The class of each row, as the filter labels one sample after the other. Whole recordings are
 * decoded further (try_ways()). */
static void decide_classes(const struct training *t, uint8_t *out_class)
{
	struct gz_forest_memory memory = { .any = false };
	for (int i = 0; i < t->row_count; i++) {
		const struct row *row = &t->row[i];
		int32_t scores[GZ_FOREST_CLASSES];
		if (!is_measured_row(t, i))
			continue;
		if (i == 0 || row->track != row[-1].track)
			memory = (struct gz_forest_memory) { .any = false };
		for (int k = 0; k < GZ_FOREST_CLASSES; k++)
			scores[k] = k < t->class_count
					    ? quantised(t->score[i][k] + (float)added_score(t, k))
					    : GZ_FOREST_NEVER;
		out_class[i] = (uint8_t)gz_forest_label(&memory, row->valid ? scores : NULL, false);
	}
}

/* Count the rows whose class is in @p class. The coders of GazeCom call ringing a saccade. */
static void add_figures(const struct training *t, const uint8_t *class, struct figures *figures)
{
	for (int i = 0; i < t->row_count; i++) {
		const struct row *row = &t->row[i];
		const struct track *track = &t->track[row->track];
		if (!is_measured_row(t, i) || !row->human[0])
			continue;
		const int named =
			class[i] == GZ_FOREST_RINGING ? (int)GZ_FOREST_SACCADE : (int)class[i];
		for (int k = 0; k < FILM_CLASSES && !track->andersson; k++)
			gz_agreement_add(&figures->film[k], named == k, row->label[0] == k);
		for (int p = 0; p < 2 && track->andersson; p++)
			for (int c = 0; c < COMPARED_COUNT; c++)
				gz_agreement_add(&figures->coder[kind_of(track)][p][c],
						 class[i] == COMPARED[c].class,
						 row->human[p] == COMPARED[c].human);
	}
}

static void print_figures(const struct figures *figures)
{
	printf("GazeCom F1");
	static const char *const names[FILM_CLASSES] = { "fixation", "saccade", "pursuit",
							 "noise" };
	for (int k = 0; k < FILM_CLASSES; k++) {
		const struct gz_agreement *a = &figures->film[k];
		printf(" %s %.3f", names[k], 2 * a->both / fmax(a->ours + a->theirs, 1));
	}
	printf("\nAndersson kappa");
	for (int kind = 0; kind < KINDS; kind++) {
		printf(" %s", gz_labelled_stimulus_names[kind]);
		for (int c = 0; c < COMPARED_COUNT; c++)
			printf(" %s %.3f", COMPARED[c].name,
			       (gz_agreement_kappa(&figures->coder[kind][0][c]) +
				gz_agreement_kappa(&figures->coder[kind][1][c])) /
				       2);
	}
	printf("\n");
}

/* ---- labels of whole recordings ---- */

/* A way to decode the scores. */
struct way {
	const char *name;
	struct gz_whole_costs costs;
	struct gz_whole_odds odds;
};
enum { WAYS_MAX = 32 };

/* Scores are in GZ_FOREST_UNIT. */
static int32_t units(double logarithm)
{
	return (int32_t)lrint(logarithm / GZ_FOREST_UNIT);
}

struct ways {
	struct way way[WAYS_MAX];
	int count;
};

/* Add the presets, for something to be changed in them. */
static struct way *add_way(struct ways *ways, const char *name)
{
	struct way *way = &ways->way[ways->count++];
	*way = (struct way) { name, gz_whole_preset_costs, gz_whole_preset_odds };
	return way;
}

/* List the presets, and ways in which one of them is another. */
static void list_ways(struct ways *out)
{
	const struct gz_whole_odds own = { .limit = INT32_MAX / 2, .share = 1 };
	out->count = 0;
	(void)add_way(out, "presets");
	add_way(out, "odds of each sample for itself")->odds = own;
	add_way(out, "the same, and no score raised or lowered")->odds = own;
	memset(out->way[out->count - 1].costs.added, 0, sizeof out->way[0].costs.added);
	add_way(out, "a change costs 0 ms")->costs.change_us = 0;
	add_way(out, "a change costs 2 ms")->costs.change_us = 2000;
	add_way(out, "a change costs 8 ms")->costs.change_us = 8000;
	add_way(out, "a change costs 20 ms")->costs.change_us = 20000;
	add_way(out, "pursuit costs 20 ms")->costs.pursuit_us = 20000;
	add_way(out, "pursuit costs 80 ms")->costs.pursuit_us = 80000;
	add_way(out, "a saccade's end costs 4 ms")->costs.saccade_us = 4000;
	add_way(out, "a saccade's end costs 8 ms")->costs.saccade_us = 8000;
	add_way(out, "a saccade's end costs 32 ms")->costs.saccade_us = 32000;
	add_way(out, "saccade 0")->costs.added[GZ_FOREST_SACCADE] = 0;
	add_way(out, "saccade -0.4")->costs.added[GZ_FOREST_SACCADE] = units(-0.4);
	add_way(out, "noise 0.3")->costs.added[GZ_FOREST_NOISE] = units(0.3);
	add_way(out, "ringing 0")->costs.added[GZ_FOREST_RINGING] = 0;
	add_way(out, "ringing 0.6")->costs.added[GZ_FOREST_RINGING] = units(0.6);
	add_way(out, "odds over 50 ms")->odds.reach_us = 50000;
	add_way(out, "odds over 75 ms")->odds.reach_us = 75000;
	add_way(out, "odds over 300 ms")->odds.reach_us = 300000;
	add_way(out, "odds limited at 1.5")->odds.limit = units(1.5);
	add_way(out, "odds limited at 6")->odds.limit = units(6);
	add_way(out, "lead 0")->odds.lead = 0;
	add_way(out, "lead 0.25")->odds.lead = units(0.25);
	add_way(out, "lead 1")->odds.lead = units(1);
	add_way(out, "share not used")->odds.share = 0;
	add_way(out, "share 0.25")->odds.share = 0.25;
	add_way(out, "share 1")->odds.share = 1;
}

/* Decode the rows from @p begin to @p end, which are one recording. */
static void decode_track(const struct training *t, int begin, int end, const struct way *way,
			 uint8_t *class)
{
	const size_t count = (size_t)(end - begin);
	struct gz_movement_input *input = calloc(count, sizeof *input);
	int32_t(*scores)[GZ_FOREST_CLASSES] = calloc(count, sizeof *scores);
	bool good = input && scores;
	for (size_t i = 0; good && i < count; i++) {
		const int row = begin + (int)i;
		input[i].time_ns =
			(int64_t)(t->track[t->row[row].track].period_ms * 1e6) * (int64_t)i;
		input[i].valid = t->row[row].valid;
		for (int k = 0; k < GZ_FOREST_CLASSES; k++)
			scores[i][k] = quantised(t->score[row][k] + (float)added_score(t, k));
	}
	good = good && gz_whole_weigh(input, count, &way->odds, scores) == GZ_OK &&
	       gz_whole_decode(input, (const int32_t(*)[GZ_FOREST_CLASSES])scores, count,
			       &way->costs, class + begin) == GZ_OK;
	free(input);
	free(scores);
	if (!good)
		exit(1);
}

static void decode_all(const struct training *t, const struct way *way, uint8_t *out_class)
{
	for (int i = 0, end; i < t->row_count; i = end) {
		for (end = i; end < t->row_count && t->row[end].track == t->row[i].track;)
			end++;
		if (is_measured_row(t, i))
			decode_track(t, i, end, way, out_class);
	}
}

/* @p figures: of each way */
static void try_ways(const struct training *t, struct figures figures[WAYS_MAX])
{
	struct ways ways;
	list_ways(&ways);
	uint8_t *class = new_array((size_t)t->row_count, 1);
	for (int w = 0; w < ways.count; w++) {
		decode_all(t, &ways.way[w], class);
		add_figures(t, class, &figures[w]);
	}
	free(class);
}

static void write_scores(const struct training *t, FILE *file)
{
	for (int i = 0; i < t->row_count; i++) {
		if (!is_measured_row(t, i))
			continue;
		float out[2 + CLASSES_MAX] = { (float)t->row[i].index, t->row[i].track };
		memcpy(out + 2, t->score[i], sizeof t->score[i]);
		fwrite(out, sizeof *out, 2 + (size_t)t->class_count, file);
	}
}

static void print_ways(const struct training *t, const struct figures figures[WAYS_MAX])
{
	struct ways ways;
	list_ways(&ways);
	for (int w = 0; w < ways.count && t->settings.whole > 0; w++) {
		printf("%s: ", ways.way[w].name);
		print_figures(&figures[w]);
	}
}

/* Read what write_scores() wrote. The recordings in it are those that were kept out. */
static void read_scores(struct training *t, const char *folder)
{
	char name[64];
	size_t size, record = (2 + (size_t)t->class_count) * sizeof(float);
	snprintf(name, sizeof name, "%.0f.scores", t->settings.tag);
	char *bytes = read_all(folder, name, &size);
	int row = 0;
	for (size_t at = 0; at + record <= size; at += record) {
		float in[2 + CLASSES_MAX];
		memcpy(in, bytes + at, record);
		/* The rows of a fold are in order; the next fold may begin before. */
		if (row == t->row_count || t->row[row].index > (int)in[0])
			row = 0;
		while (row < t->row_count && t->row[row].index < (int)in[0])
			row++;
		if (row == t->row_count)
			break;
		memcpy(t->score[row], in + 2, (size_t)t->class_count * sizeof(float));
		t->kept_out[t->row[row].track] = true;
	}
	free(bytes);
}

/* ---- a forest ---- */

static void set_gradient(struct training *t, int row)
{
	const struct row *r = &t->row[row];
	double p[CLASSES_MAX] = { 0 }, sum = 0, h = 0;
	sums g = { 0 };
	for (int k = 0; k < t->class_count; k++)
		sum += p[k] = exp((double)t->score[row][k]);
	double weight = 0;
	for (int n = 0; n < 2; n++)
		if (r->label[n] != UNUSED) {
			weight += 0.5 * r->weight;
			g[r->label[n]] -= 0.5f * r->weight;
		}
	if (r->either && r->label[0] == GZ_FOREST_SACCADE) {
		const double saccade = p[GZ_FOREST_SACCADE], ringing = p[GZ_FOREST_RINGING];
		g[GZ_FOREST_SACCADE] = (float)(-weight * saccade / (saccade + ringing));
		g[GZ_FOREST_RINGING] = (float)(-weight * ringing / (saccade + ringing));
	}
	for (int k = 0; k < t->class_count; k++) {
		p[k] /= sum;
		g[k] += (float)(weight * p[k]);
		h += 0.5 * weight * p[k] * (1 - p[k]);
	}
	g[HESSIAN] = (float)h;
	g[WEIGHT] = (float)weight;
	t->gradient[row] = g;
}

static int choose_rows(struct training *t)
{
	int n = 0;
	for (int i = 0; i < t->row_count; i++) {
		const struct row *row = &t->row[i];
		if (t->kept_out[row->track] || !row->learned ||
		    (row->label[0] == UNUSED && row->label[1] == UNUSED) ||
		    gz_random_uniform(&t->random) >= t->settings.rows)
			continue;
		set_gradient(t, i);
		t->order[n++] = i;
	}
	return n;
}

static void add_leaf(struct training *t, const struct tree *tree, int row)
{
	const struct node *leaf = leaf_of(tree, bins_of(t, row));
	for (int k = 0; k < t->class_count; k++)
		t->score[row][k] += leaf->value[k];
}

/* @p figures: of the rows kept out, after each FIGURES_EVERY trees; or NULL. @p class: room */
static void grow_forest(struct training *t, struct figures *figures, uint8_t *class)
{
	double prior[CLASSES_MAX] = { 0 };
	for (int i = 0; i < t->row_count; i++)
		for (int n = 0; n < 2; n++)
			if (!t->kept_out[t->row[i].track] && t->row[i].label[n] != UNUSED)
				prior[t->row[i].label[n]] += t->row[i].weight;
	double mean = 0;
	for (int k = 0; k < t->class_count; k++)
		mean += log(fmax(prior[k], 1)) / t->class_count;
	for (int k = 0; k < t->class_count; k++)
		t->base[k] = (float)(log(fmax(prior[k], 1)) - mean);
	for (int i = 0; i < t->row_count; i++)
		memcpy(t->score[i], t->base, sizeof t->base);
	t->tree_count = (int)t->settings.trees;
	const bool late = t->settings.thin > 1; /* what was kept out gets its scores in the end */
	for (int n = 0; n < t->tree_count; n++) {
		struct tree *tree = &t->tree[n];
		grow_tree(t, tree, choose_rows(t));
		for (int i = 0; i < t->row_count; i++)
			if (!late || (t->row[i].learned && !t->kept_out[t->row[i].track]))
				add_leaf(t, tree, i);
		if (late || !figures || (n + 1) % FIGURES_EVERY != 0)
			continue;
		decide_classes(t, class);
		add_figures(t, class, &figures[n / FIGURES_EVERY]);
	}
	for (int i = 0; late && figures && i < t->row_count; i++)
		for (int n = 0; is_measured_row(t, i) && n < t->tree_count; n++)
			add_leaf(t, &t->tree[n], i);
	if (late && figures) {
		decide_classes(t, class);
		add_figures(t, class, &figures[t->tree_count / FIGURES_EVERY - 1]);
	}
}

/* The score of a leaf or of the base, in GZ_FOREST_UNIT. */
static int quantised(float value)
{
	return (int)lrint((double)value / GZ_FOREST_UNIT);
}

/* What a class's sum begins with, GZ_FOREST_UNIT. */
static int base_of(const struct training *t, int class)
{
	return (int)lrint(((double)t->base[class] + added_score(t, class)) / GZ_FOREST_UNIT);
}

/* A hash of the scores of all samples at their native rates, of a whole recording only of Andersson
 * et al., so that the test is short: FNV-1a (Fowler, Noll and Vo), 64 bits. The test
 * filter.training compares it with what the filter makes of the recordings. */
static uint64_t hash_scores(const struct training *t)
{
	uint64_t hash = UINT64_C(14695981039346656037);
	for (int i = 0; i < t->row_count; i++) {
		int32_t score[CLASSES_MAX];
		const struct track *track = &t->track[t->row[i].track];
		if (!is_original(track) || (t->settings.whole > 0 && !track->andersson))
			continue;
		for (int k = 0; k < t->class_count; k++)
			score[k] = base_of(t, k);
		for (int n = 0; n < t->tree_count; n++) {
			const struct node *leaf = leaf_of(&t->tree[n], bins_of(t, i));
			for (int k = 0; k < t->class_count; k++)
				score[k] += quantised(leaf->value[k]);
		}
		for (int k = 0; k < t->class_count; k++)
			for (int shift = 0; shift < 32; shift += 8)
				hash = (hash ^ ((uint32_t)score[k] >> shift & 0xff)) *
				       UINT64_C(1099511628211);
	}
	return hash;
}

static const char *name_of(const struct training *t)
{
	return t->settings.whole > 0 ? "whole" : t->settings.certain > 0 ? "certain" : "at_once";
}

static void write_provenance(const struct training *t, FILE *file)
{
	struct settings settings = t->settings;
	fprintf(file, "/*\n * Made by bench/probes/gaze_forest_fit.c; do not edit. Settings:");
	for (int k = 0; k < KEY_COUNT; k++)
		fprintf(file, "%s%s=%g", k % 6 == 0 ? "\n * " : " ", KEYS[k].key,
			*setting_at(&settings, k));
	if (t->without)
		fprintf(file, "\n * %s", t->without);
	fprintf(file, "\n * from %d samples of these recordings:\n", t->row_count);
	const char *last = "";
	for (int i = 0; i < t->track_count; i++) {
		const struct track *track = &t->track[i];
		const char *name = track->andersson ? track->name : track->kind;
		if (strcmp(name, last) != 0)
			fprintf(file, " *   %s %s\n",
				track->simulated   ? "simulated"
				: track->andersson ? "andersson"
						   : "gazecom",
				name);
		last = name;
	}
	fprintf(file, " */\n/* clang-format off */\n");
}

static int depth_below(const struct tree *tree, int node)
{
	if (tree->node[node].feature < 0)
		return 0;
	const int left = depth_below(tree, tree->node[node].left);
	const int right = depth_below(tree, tree->node[node].right);
	return 1 + (left > right ? left : right);
}

/* Begin a new line of a table where the last one is full. */
static void wrap_line(FILE *file, long *line_start)
{
	if (ftell(file) - *line_start < 88)
		return;
	fputc('\n', file);
	*line_start = ftell(file);
}

static void write_nodes(const struct training *t, FILE *file)
{
	fprintf(file, "static const struct gz_forest_node %s_nodes[] = {\n", name_of(t));
	long line_start = ftell(file);
	for (int n = 0; n < t->tree_count; n++) {
		int leaves = 0;
		for (int i = 0; i < t->tree[n].node_count; i++) {
			const struct node *node = &t->tree[n].node[i];
			if (node->feature < 0)
				fprintf(file, "L(%d,%d)", i, leaves++);
			else
				fprintf(file, "N(%d,%.3e,%d,%d)", node->feature,
					(double)t->edges[node->feature][node->bin], node->left,
					node->right);
			wrap_line(file, &line_start);
		}
	}
	fprintf(file, "\n};\n");
}

static void write_leaves(const struct training *t, FILE *file)
{
	fprintf(file, "static const int16_t %s_leaves[][%d] = {\n", name_of(t), t->class_count);
	long line_start = ftell(file);
	for (int n = 0; n < t->tree_count; n++)
		for (int i = 0; i < t->tree[n].node_count; i++) {
			const struct node *node = &t->tree[n].node[i];
			if (node->feature >= 0)
				continue;
			for (int k = 0; k < t->class_count; k++)
				fprintf(file, "%c%d", k > 0 ? ',' : '{', quantised(node->value[k]));
			fprintf(file, "},");
			wrap_line(file, &line_start);
		}
	fprintf(file, "\n};\n");
}

static void write_trees(const struct training *t, FILE *file)
{
	fprintf(file, "static const struct gz_forest_tree %s_trees[] = {\n", name_of(t));
	long line_start = ftell(file);
	int node = 0, leaf = 0;
	for (int n = 0; n < t->tree_count; n++) {
		const struct tree *tree = &t->tree[n];
		fprintf(file, "{%d,%d,%d},", node, leaf, depth_below(tree, 0));
		wrap_line(file, &line_start);
		node += tree->node_count;
		leaf += (tree->node_count + 1) / 2;
	}
	fprintf(file, "\n};\n");
}

static void write_forest(const struct training *t, const char *folder)
{
	char path[1024];
	snprintf(path, sizeof path, "%s/forest_%s.inc", folder, name_of(t));
	FILE *file = fopen(path, "w");
	if (!file) {
		fprintf(stderr, "%s: cannot write it\n", path);
		exit(1);
	}
	write_provenance(t, file);
	write_nodes(t, file);
	write_leaves(t, file);
	write_trees(t, file);
	fprintf(file, "static const int32_t %s_base[%d] = {", name_of(t), t->class_count);
	for (int k = 0; k < t->class_count; k++)
		fprintf(file, "%s %d", k > 0 ? "," : "", base_of(t, k));
	fprintf(file, " };\n");
	fprintf(file, "#define %s_hash UINT64_C(0x%016llx)\n", name_of(t),
		(unsigned long long)hash_scores(t));
	fclose(file);
}

/* ---- what groups of features are worth ---- */

/* Beginnings of the names of features that tell something together. */
static const struct group {
	const char *name;
	const char *begins[8];
} GROUPS[] = {
	{ "nothing", { NULL } },
	{ "speeds of the last 32 ms", { "speed_", "along_" } },
	{ "distance relative to noise", { "signal_" } },
	{ "distances and ways", { "distance_", "way_" } },
	{ "spreads", { "spread_" } },
	{ "turns and straightness", { "turn_", "straight_" } },
	{ "across and down", { "across_", "down_" } },
	{ "the slow movement now and before",
	  { "slope", "residual", "stretch_ms", "last_", "mean_slow" } },
	{ "where slow movement went", { "flow_", "burst_slope", "burst_last", "burst_flow" } },
	{ "the last fast movement",
	  { "burst_peak", "burst_ms", "burst_deg", "burst_part", "burst_down", "since_fast",
	    "since_peak" } },
	{ "what was lost, and when", { "lost_", "since_lost", "valid" } },
	{ "beyond the display", { "beyond_" } },
};
enum { GROUPS_COUNT = sizeof GROUPS / sizeof GROUPS[0] };

static bool is_in_group(const struct group *group, int feature)
{
	const char *name = gz_movement_feature_names[feature % GZ_MOVEMENT_FEATURES];
	for (size_t i = 0; i < sizeof group->begins / sizeof group->begins[0]; i++)
		if (group->begins[i] &&
		    strncmp(name, group->begins[i], strlen(group->begins[i])) == 0)
			return true;
	return false;
}

/* The rows of one data set that are measured. @return how many */
static int list_rows(const struct training *t, bool andersson, int *out_rows)
{
	int count = 0;
	for (int i = 0; i < t->row_count; i++)
		if (is_measured_row(t, i) && t->track[t->row[i].track].andersson == andersson)
			out_rows[count++] = i;
	return count;
}

/* Score the measured rows of a data set anew, each with the group's features of another one: the
 * one half of all of them away, so that the features are as usual as they were, and tell nothing.
 */
static void score_exchanged(struct training *t, const struct group *group, bool andersson)
{
	const int count = list_rows(t, andersson, t->order);
	uint8_t bins[FEATURES_MAX];
	for (int i = 0; i < count; i++) {
		const int row = t->order[i];
		const uint8_t *others = bins_of(t, t->order[(i + count / 2) % count]);
		memcpy(bins, bins_of(t, row), (size_t)t->feature_count);
		for (int f = 0; f < t->feature_count; f++)
			if (is_in_group(group, f))
				bins[f] = others[f];
		memcpy(t->score[row], t->base, sizeof t->base);
		for (int n = 0; n < t->tree_count; n++) {
			const struct node *leaf = leaf_of(&t->tree[n], bins);
			for (int k = 0; k < t->class_count; k++)
				t->score[row][k] += leaf->value[k];
		}
	}
}

/* Add the figures that the present forest has without each group. The scores are lost. */
static void add_worths(struct training *t, uint8_t *class, struct figures figures[GROUPS_COUNT])
{
	struct way preset = { "presets", gz_whole_preset_costs, gz_whole_preset_odds };
	for (int g = 0; g < GROUPS_COUNT; g++) {
		score_exchanged(t, &GROUPS[g], false);
		score_exchanged(t, &GROUPS[g], true);
		if (t->settings.whole > 0)
			decode_all(t, &preset, class);
		else
			decide_classes(t, class);
		add_figures(t, class, &figures[g]);
	}
}

static void print_worths(const struct figures figures[GROUPS_COUNT])
{
	for (int g = 0; g < GROUPS_COUNT; g++) {
		printf("without %s: ", GROUPS[g].name);
		print_figures(&figures[g]);
	}
}

/* ---- folds ---- */

/* A recording comes before the copies of it. */
static int set_folds_by_recording(struct training *t)
{
	const int folds = (int)t->settings.folds;
	int recordings = 0;
	for (int i = 0; i < t->track_count; i++) {
		recordings += is_original(&t->track[i]);
		t->track[i].fold = t->track[i].simulated ? UNUSED : recordings % folds;
	}
	return folds;
}

static int set_folds(struct training *t)
{
	if (t->settings.recordings > 0)
		return set_folds_by_recording(t);
	static char names[FOLDS_MAX][64];
	int films = 0;
	if (t->settings.folds == 2) {
		for (int i = 0; i < t->track_count; i++)
			t->track[i].fold = t->track[i].simulated ? UNUSED : t->track[i].andersson;
		return 2;
	}
	for (int i = 0; i < t->track_count; i++) {
		struct track *track = &t->track[i];
		if (track->andersson || track->simulated)
			continue;
		int f = 0;
		while (f < films && strcmp(names[f], track->kind) != 0)
			f++;
		if (f == films)
			strcpy(names[films++], track->kind);
		track->fold = f;
	}
	int folds = films > 0 ? films : FOLDS_WITHOUT_FILMS;
	if (t->settings.folds > 2 && t->settings.folds < folds)
		folds = (int)t->settings.folds;
	for (int i = 0; i < t->track_count; i++)
		t->track[i].fold %= folds;
	/* Persons: the letters and digits after the stimulus, e.g. "UH21". */
	int persons = 0;
	static char person[FOLDS_MAX][5];
	for (int i = 0; i < t->track_count; i++) {
		struct track *track = &t->track[i];
		if (track->simulated)
			track->fold = UNUSED; /* always learned from */
		if (!track->andersson)
			continue;
		const char *name = strchr(track->name, '_') + 1;
		int p = 0;
		while (p < persons && strncmp(person[p], name, 4) != 0)
			p++;
		if (p == persons)
			memcpy(person[persons++], name, 4);
		track->fold = p % folds;
	}
	return folds;
}

/* Print how much each feature has lowered the loss of the training, the best first. */
static void print_worth(const struct training *t)
{
	double worth[FEATURES_MAX] = { 0 }, whole = 0;
	for (int n = 0; n < t->tree_count; n++)
		for (int i = 0; i < t->tree[n].node_count; i++) {
			const struct node *node = &t->tree[n].node[i];
			if (node->feature < 0)
				continue;
			worth[node->feature] += node->gain;
			whole += node->gain;
		}
	for (int shown = 0; shown < t->feature_count; shown++) {
		int best = 0;
		for (int f = 1; f < t->feature_count; f++)
			best = worth[f] > worth[best] ? f : best;
		printf("%s%-16s %5.2f %%\n", best < GZ_MOVEMENT_FEATURES ? "" : "later ",
		       gz_movement_feature_names[best % GZ_MOVEMENT_FEATURES],
		       100 * worth[best] / whole);
		worth[best] = -1;
	}
}

/* ---- the command ---- */

static const char WITHOUT[] = "without=";

/* Do not use the features whose names begin with one of these. */
static void ban_features(struct training *t, const char *names)
{
	for (; *names; names += strcspn(names, ","), names += *names == ',')
		for (int f = 0; f < t->feature_count; f++)
			if (strncmp(gz_movement_feature_names[f % GZ_MOVEMENT_FEATURES], names,
				    strcspn(names, ",")) == 0)
				t->unused[f] = true;
}

static bool is_ban(const char *argument)
{
	return strncmp(argument, WITHOUT, strlen(WITHOUT)) == 0;
}

/* @return whether all arguments are settings */
static bool read_settings(int argc, char **argv, struct settings *out)
{
	for (int k = 0; k < KEY_COUNT; k++)
		*setting_at(out, k) = KEYS[k].preset;
	for (int i = 2; i < argc; i++) {
		const size_t length = strcspn(argv[i], "=");
		bool found = is_ban(argv[i]);
		for (int k = 0; k < KEY_COUNT && argv[i][length]; k++) {
			if (strncmp(KEYS[k].key, argv[i], length) != 0 || KEYS[k].key[length])
				continue;
			*setting_at(out, k) = strtod(argv[i] + length + 1, NULL);
			found = true;
		}
		if (!found) {
			fprintf(stderr, "gaze_forest_fit: no such setting: %s\n", argv[i]);
			return false;
		}
	}
	return out->leaves <= LEAVES_MAX && out->bins <= BINS_MAX && out->trees <= TREES_MAX;
}

static void make_room(struct training *t)
{
	const size_t rows = (size_t)t->row_count;
	t->score = new_array(rows, sizeof *t->score);
	t->gradient = new_array(rows, sizeof *t->gradient);
	t->order = new_array(rows, sizeof *t->order);
	t->spare = new_array(rows, sizeof *t->spare);
	t->tree = new_array(TREES_MAX, sizeof *t->tree);
	t->kept_out = new_array(TRACKS_MAX, sizeof *t->kept_out);
	t->pool = new_array((LEAVES_MAX + 1) * (size_t)t->feature_count * (size_t)t->bin_count,
			    sizeof *t->pool);
}

static void train_on_all(struct training *t, const char *folder)
{
	grow_forest(t, NULL, NULL);
	write_forest(t, folder);
	print_worth(t);
}

/* What people and a forest call the slow movement of one film or recording. */
struct slow_figures {
	char name[64];
	double samples, ours[2], theirs[2], both[2]; /* fixations and pursuits */
	double fixation_lost, pursuit_lost;          /* that are the other one to the forest */
};

static void add_slow(struct slow_figures *figures, int ours, int theirs)
{
	static const int classes[2] = { GZ_FOREST_FIXATION, GZ_FOREST_PURSUIT };
	for (int c = 0; c < 2; c++) {
		figures->ours[c] += ours == classes[c];
		figures->theirs[c] += theirs == classes[c];
		figures->both[c] += ours == classes[c] && theirs == classes[c];
	}
	figures->fixation_lost += theirs == GZ_FOREST_FIXATION && ours == GZ_FOREST_PURSUIT;
	figures->pursuit_lost += theirs == GZ_FOREST_PURSUIT && ours == GZ_FOREST_FIXATION;
	figures->samples++;
}

static void print_slow(const struct slow_figures *f)
{
	printf("%s: people %.3f fixation %.3f pursuit, forest %.3f %.3f, F1 %.3f %.3f, "
	       "fixation called pursuit %.2f, pursuit called fixation %.2f\n",
	       f->name, f->theirs[0] / f->samples, f->theirs[1] / f->samples,
	       f->ours[0] / f->samples, f->ours[1] / f->samples,
	       2 * f->both[0] / fmax(f->ours[0] + f->theirs[0], 1),
	       2 * f->both[1] / fmax(f->ours[1] + f->theirs[1], 1),
	       f->fixation_lost / fmax(f->theirs[0], 1), f->pursuit_lost / fmax(f->theirs[1], 1));
}

/* For each film and, with both coders together, for each recording of Andersson et al. */
static void print_each(const struct training *t, const uint8_t *class)
{
	static struct slow_figures all[FOLDS_MAX];
	int count = 0;
	for (int i = 0; i < t->row_count; i++) {
		const struct row *row = &t->row[i];
		const struct track *track = &t->track[row->track];
		const char *name = track->andersson ? track->name : track->kind;
		if (!is_measured_row(t, i) || !row->human[0])
			continue;
		int n = 0;
		while (n < count && strcmp(all[n].name, name) != 0)
			n++;
		if (n == FOLDS_MAX)
			continue;
		if (n == count)
			strcpy(all[count++].name, name);
		for (int p = 0; p < (track->andersson ? 2 : 1); p++)
			add_slow(&all[n], class[i], row -> label[p]);
	}
	for (int n = 0; n < count; n++)
		print_slow(&all[n]);
}

/* Measure the scores of an earlier run. */
static void measure_again(struct training *t, const char *folder)
{
	static struct figures figures, decoded[WAYS_MAX];
	uint8_t *class = new_array((size_t)t->row_count, 1);
	read_scores(t, folder);
	decide_classes(t, class);
	add_figures(t, class, &figures);
	print_figures(&figures);
	const struct way preset = { "presets", gz_whole_preset_costs, gz_whole_preset_odds };
	if (t->settings.whole > 0)
		decode_all(t, &preset, class);
	if (t->settings.each > 0)
		print_each(t, class);
	if (t->settings.whole > 0)
		try_ways(t, decoded);
	print_ways(t, decoded);
	free(class);
}

static void train_on_folds(struct training *t, const char *folder)
{
	static struct figures figures[TREES_MAX / FIGURES_EVERY + 1], decoded[WAYS_MAX];
	static struct figures worths[GROUPS_COUNT];
	uint8_t *class = new_array((size_t)t->row_count, 1);
	const int folds = set_folds(t);
	char path[1024];
	snprintf(path, sizeof path, "%s/%.0f.scores", folder, t->settings.tag);
	FILE *scores = fopen(path, "wb");
	if (!scores) {
		fprintf(stderr, "%s: cannot write it\n", path);
		exit(1);
	}
	for (int fold = 0; fold < folds; fold++) {
		if (t->settings.only_fold >= 0 && fold != (int)t->settings.only_fold)
			continue;
		for (int i = 0; i < t->track_count; i++)
			t->kept_out[i] = t->track[i].fold == fold;
		grow_forest(t, figures, class);
		write_scores(t, scores);
		if (t->settings.whole > 0)
			try_ways(t, decoded);
		if (t->settings.worth > 0)
			add_worths(t, class, worths);
	}
	fclose(scores);
	free(class);
	const int last =
		t->tree_count / FIGURES_EVERY - 1; /* the only one if samples are thinned */
	for (int n = t->settings.thin > 1 ? last : 0; n <= last; n++) {
		printf("%d trees: ", (n + 1) * FIGURES_EVERY);
		print_figures(&figures[n]);
	}
	print_ways(t, decoded);
	if (t->settings.worth > 0)
		print_worths(worths);
}

int main(int argc, char **argv)
{
	static struct training t;
	if (argc < 2 || !read_settings(argc, argv, &t.settings)) {
		fprintf(stderr,
			"usage: gaze_forest_fit FOLDER [KEY=NUMBER...] [without=NAME,NAME...]\n");
		return 2;
	}
	t.feature_count = t.settings.whole > 0 ? GZ_WHOLE_FEATURES : GZ_MOVEMENT_FEATURES;
	t.class_count = t.settings.whole > 0 || t.settings.rings > 0 ? GZ_FOREST_CLASSES
								     : GZ_FOREST_RINGING;
	for (int i = 2; i < argc; i++)
		if (is_ban(argv[i])) {
			ban_features(&t, argv[i] + strlen(WITHOUT));
			t.without = argv[i];
		}
	t.random = gz_random_seeded((uint64_t)t.settings.seed, 0);
	read_tracks(&t, argv[1]);
	read_rows(&t, argv[1]);
	if (!(t.settings.again > 0))
		make_bins(&t);
	make_room(&t);
	if (t.settings.again > 0)
		measure_again(&t, argv[1]);
	else if (t.settings.folds > 0)
		train_on_folds(&t, argv[1]);
	else
		train_on_all(&t, argv[1]);
	return 0;
}
