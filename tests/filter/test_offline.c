/* Labels of whole recordings. */
#include "suite.h"

#include "filter/viewing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench/filter/gazecom.h"
#include "bench/filter/labelled_recording.h"
#include "filter/classifier/whole.h"
#include "filter/offline.h"

/* A recording of a simulated viewer, and what the eye really did. */
struct recording {
	struct gz_display display;
	size_t count;
	struct gz_sample *sample;
	enum gz_event *truth;
	struct gz_offline_labels labels;
};

static void recording_open(struct recording *recording, const struct gz_sim_params *params,
			   double seconds)
{
	struct gz_sim_tracker *tracker = NULL;
	*recording = (struct recording) { .count = (size_t)(seconds * params->rate_hz) };
	recording->sample = calloc(recording->count, sizeof *recording->sample);
	recording->truth = calloc(recording->count, sizeof *recording->truth);
	assert_true(recording->sample && recording->truth);
	assert_int_equal(gz_sim_tracker_create(params, VIEWING_START_NS, NULL, &tracker), GZ_OK);
	recording->display = gz_sim_tracker_display(tracker);
	for (size_t i = 0; i < recording->count; i++) {
		struct gz_sim_sample sample;
		gz_sim_tracker_next(tracker, &sample);
		recording->sample[i] = sample.sample;
		recording->truth[i] = sample.truth.event;
	}
	gz_sim_tracker_destroy(&tracker);
}

static void recording_label(struct recording *recording)
{
	struct gz_offline *offline = NULL;
	assert_int_equal(gz_offline_create(NULL, &recording->display, &offline), GZ_OK);
	for (size_t i = 0; i < recording->count; i++)
		assert_int_equal(gz_offline_add(offline, &recording->sample[i]), GZ_OK);
	assert_int_equal(gz_offline_finish(offline, &recording->labels), GZ_OK);
	gz_offline_destroy(&offline);
	assert_null(offline);
	assert_int_equal(recording->labels.count, recording->count);
}

static void recording_close(struct recording *recording)
{
	free(recording->sample);
	free(recording->truth);
	gz_offline_labels_free(&recording->labels);
	assert_null(recording->labels.label);
}

/* F1 of the samples with a label. */
static double f1_of(const struct recording *recording, enum gz_event event,
		    enum gz_offline_label label)
{
	double both = 0, either = 0;
	for (size_t i = 0; i < recording->count; i++) {
		bool ours = recording->labels.label[i] == label;
		bool theirs = recording->truth[i] == event;
		both += ours && theirs;
		either += ours + theirs;
	}
	return 2 * both / either;
}

/* Each interval begins where the last one ends, and the samples of each have its label. */
static void check_intervals(const struct recording *recording)
{
	const struct gz_offline_labels *labels = &recording->labels;
	size_t sample = 0;
	for (size_t k = 0; k < labels->interval_count; k++) {
		const struct gz_offline_interval *interval = &labels->interval[k];
		assert_true(interval->end_ns >= interval->start_ns);
		if (k > 0)
			assert_true(interval->start_ns == labels->interval[k - 1].end_ns);
		if (interval->label == GZ_OFFLINE_OSCILLATION)
			assert_true(k > 0 && labels->interval[k - 1].label == GZ_OFFLINE_SACCADE);
		for (uint64_t i = 0; i < interval->samples; i++, sample++) {
			assert_int_equal(labels->label[sample], interval->label);
			CHECK_BETWEEN(
				(double)(recording->sample[sample].host_ns - interval->start_ns), 0,
				(double)(interval->end_ns - interval->start_ns));
		}
	}
	assert_int_equal(sample, recording->count);
}

static void simulated_viewers_are_labelled_at_any_rate(void **state)
{
	(void)state;
	for (int i = 0; i < RATE_COUNT; i++) {
		struct recording recording;
		struct gz_sim_params params = sim_params(RATES_HZ[i]);
		params.viewer.microsaccades_per_s = 0;
		recording_open(&recording, &params, 20);
		recording_label(&recording);
		check_intervals(&recording);
		double least = RATES_HZ[i] < 100 ? 0.5 : 0.8;
		CHECK_BETWEEN(f1_of(&recording, GZ_EVENT_SACCADE, GZ_OFFLINE_SACCADE), least, 1);
		CHECK_BETWEEN(f1_of(&recording, GZ_EVENT_BLINK, GZ_OFFLINE_BLINK), least, 1);
		recording_close(&recording);
	}
}

static void in_the_still_part_of_a_recording_there_is_no_pursuit(void **state)
{
	(void)state;
	struct gz_sim_params params = sim_params(250);
	struct recording recording;
	size_t pursuits[2] = { 0 };
	params.viewer.pursuits_per_min = 30;
	recording_open(&recording, &params, 20);
	for (size_t i = 0; i < recording.count; i++)
		recording.sample[i].still_scene = i > recording.count / 2;
	recording_label(&recording);
	for (size_t i = 0; i < recording.count; i++)
		pursuits[i > recording.count / 2] +=
			recording.labels.label[i] == GZ_OFFLINE_PURSUIT;
	assert_true(pursuits[false] > 100);
	assert_int_equal(pursuits[true], 0);
	recording_close(&recording);
}

static void a_gap_in_time_is_a_blink_or_lost_by_its_length(void **state)
{
	(void)state;
	static const int64_t gaps_ms[] = { 30, 200, 800 };
	for (size_t g = 0; g < sizeof gaps_ms / sizeof gaps_ms[0]; g++) {
		struct recording recording;
		struct gz_sim_params params = sim_params(250);
		params.viewer.blinks_per_min = 0;
		params.loss = params.eye_loss = 0;
		recording_open(&recording, &params, 4);
		const size_t half = recording.count / 2;
		for (size_t i = half; i < recording.count; i++)
			recording.sample[i].host_ns += gaps_ms[g] * GZ_NS_PER_MS;
		recording_label(&recording);
		check_intervals(&recording);
		bool found = false;
		for (size_t k = 0; k < recording.labels.interval_count; k++) {
			const struct gz_offline_interval *interval = &recording.labels.interval[k];
			if (interval->start_ns > recording.sample[half - 1].host_ns ||
			    interval->end_ns < recording.sample[half].host_ns)
				continue;
			found = true;
			assert_int_equal(interval->label,
					 gaps_ms[g] < 500 ? GZ_OFFLINE_BLINK : GZ_OFFLINE_LOST);
		}
		assert_true(found);
		recording_close(&recording);
	}
}

static void samples_whose_time_stands_still_have_the_label_of_the_last(void **state)
{
	(void)state;
	struct recording plain, repeated;
	struct gz_sim_params params = sim_params(250);
	recording_open(&plain, &params, 4);
	recording_open(&repeated, &params, 8);
	for (size_t i = 0; i < repeated.count; i++)
		repeated.sample[i] = plain.sample[i / 2];
	recording_label(&plain);
	recording_label(&repeated);
	for (size_t i = 0; i < repeated.count; i++)
		assert_int_equal(repeated.labels.label[i], plain.labels.label[i / 2]);
	assert_int_equal(repeated.labels.interval_count, plain.labels.interval_count);
	recording_close(&plain);
	recording_close(&repeated);
}

static void without_a_time_that_counts_all_is_lost(void **state)
{
	(void)state;
	struct recording recording;
	struct gz_sim_params params = sim_params(250);
	recording_open(&recording, &params, 1);
	for (size_t i = 0; i < recording.count; i++)
		recording.sample[i].host_ns = -1;
	recording_label(&recording);
	assert_int_equal(recording.labels.interval_count, 0);
	for (size_t i = 0; i < recording.count; i++)
		assert_int_equal(recording.labels.label[i], GZ_OFFLINE_LOST);
	recording_close(&recording);
	recording_open(&recording, &params, 0);
	recording_label(&recording);
	recording_close(&recording);
}

static void any_samples_give_labels(void **state)
{
	(void)state;
	static const float wild[] = { NAN, INFINITY, -INFINITY, 1e30f, 0, 0.5f, 0.6f, 1 };
	struct recording recording;
	struct gz_sim_params params = sim_params(250);
	struct gz_random random = gz_random_seeded(9, 9);
	int64_t time_ns = VIEWING_START_NS;
	recording_open(&recording, &params, 40);
	for (size_t i = 0; i < recording.count; i++) {
		struct gz_sample *sample = &recording.sample[i];
		const uint64_t bits = gz_random_bits(&random);
		time_ns += (int64_t)(bits % 9000000) - (bits % 97 == 0 ? 50000000 : 0) +
			   (bits % 1009 == 0 ? 700000000 : 0);
		*sample = gz_sample_unmeasured();
		sample->host_ns = bits % 499 == 0 ? INT64_MAX : time_ns;
		sample->valid = bits & 1 << 20;
		sample->point = (struct gz_point) { wild[bits >> 24 & 7], wild[bits >> 28 & 7] };
	}
	recording_label(&recording);
	const struct gz_offline_labels *labels = &recording.labels;
	for (size_t i = 0; i < labels->count; i++)
		assert_in_range(labels->label[i], 0, GZ_OFFLINE_LABELS - 1);
	for (size_t k = 0; k < labels->interval_count; k++) {
		const struct gz_offline_interval *interval = &labels->interval[k];
		assert_true(interval->end_ns >= interval->start_ns);
		assert_true(isfinite(interval->mean.x) == isfinite(interval->amplitude_deg));
		if (k > 0)
			assert_true(interval->start_ns == labels->interval[k - 1].end_ns);
	}
	recording_close(&recording);
}

/*
 * Features of both directions, and the best sequence.
 */

enum { ROWS = 9000 }; /* more than two blocks of whole.c */

static struct gz_movement_input row_input[ROWS];
static float row_features[ROWS][GZ_WHOLE_FEATURES];

static void keep_row(void *user, size_t index, const float features[GZ_WHOLE_FEATURES])
{
	size_t *next = user;
	assert_int_equal(index, *next);
	memcpy(row_features[(*next)++], features, sizeof row_features[0]);
}

static void later_features_are_those_of_reversed_time(void **state)
{
	(void)state;
	static struct gz_movement movement;
	const struct gz_display display = gz_display_default(1920, 1080);
	struct gz_random random = gz_random_seeded(7, 7);
	for (size_t i = 0; i < ROWS; i++)
		row_input[i] = (struct gz_movement_input) {
			.time_ns = VIEWING_START_NS + (int64_t)i * 2000000,
			.valid = gz_random_uniform(&random) < 0.9,
			.point = { (float)gz_random_uniform(&random), 0.5f },
		};
	size_t next = 0;
	const struct gz_whole_rows rows = { &next, keep_row };
	assert_int_equal(gz_whole_features(&display, row_input, ROWS, &rows), GZ_OK);
	assert_int_equal(next, ROWS);
	for (size_t i = ROWS; i > 0; i--) {
		float features[GZ_MOVEMENT_FEATURES];
		struct gz_movement_input reversed = row_input[i - 1];
		reversed.time_ns = row_input[ROWS - 1].time_ns - reversed.time_ns;
		(void)gz_movement_step(&movement, &display, &reversed, features);
		assert_memory_equal(row_features[i - 1] + GZ_MOVEMENT_FEATURES, features,
				    sizeof features);
	}
}

/* Decode samples at 250 Hz of which one class each is the likeliest by @p lead. */
static void decode(const char *likeliest, int32_t lead, uint8_t *out_class)
{
	enum { MOST = 64 };
	static const char classes[] = "fspnr";
	struct gz_movement_input input[MOST];
	int32_t scores[MOST][GZ_FOREST_CLASSES] = { { 0 } };
	const size_t count = strlen(likeliest);
	const struct gz_whole_costs costs = { 10000, 20000, 30000, { 0 } };
	assert_in_range(count, 1, MOST);
	for (size_t i = 0; i < count; i++) {
		const char *place = strchr(classes, likeliest[i]);
		input[i] = (struct gz_movement_input) { .time_ns = (int64_t)i * 4000000,
							.valid = place != NULL };
		if (place)
			scores[i][place - classes] = lead;
	}
	assert_int_equal(gz_whole_decode(input, (const int32_t(*)[GZ_FOREST_CLASSES])scores, count,
					 &costs, out_class),
			 GZ_OK);
	for (size_t i = 0; i < count; i++)
		out_class[i] = (uint8_t)classes[out_class[i]];
	out_class[count] = 0;
}

static void the_best_sequence_has_no_needless_change(void **state)
{
	(void)state;
	uint8_t class[65];
	const int32_t one = (int32_t)(1 / GZ_FOREST_UNIT); /* odds of e */
	decode("ffffnffff", 2 * one, class);               /* 8 ms, and two changes cost 20 ms */
	assert_string_equal((char *)class, "fffffffff");
	decode("ffffnffff", 6 * one, class);
	assert_string_equal((char *)class, "ffffnffff");
	decode("ffffsffff", 9 * one, class); /* 36 ms, and one change and a saccade's end cost 40 */
	assert_string_equal((char *)class, "fffffffff");
	decode("ffffsffff", 11 * one, class);
	assert_string_equal((char *)class, "ffffsffff");
	decode("ffffffssssssffffff", 6 * one, class); /* its end costs 30 ms, ringing 20 + 24 */
	assert_string_equal((char *)class, "ffffffssssssffffff");
	decode("ffffffssssssffffff", 2 * one, class); /* 20 + 8 */
	assert_non_null(strstr((char *)class, "srf"));
	decode("nnnnssnnnn", 7 * one, class); /* 56 ms, and both changes cost 60 ms */
	assert_string_equal((char *)class, "nnnnnnnnnn");
	decode("nnnnssnnnn", 8 * one, class);
	assert_string_equal((char *)class, "nnnnssnnnn");
	decode("fffffppppp", one, class); /* 20 ms, and a change costs 20 ms */
	assert_string_equal((char *)class, "ffffffffff");
	decode("fffffpppppp", one, class);
	assert_string_equal((char *)class, "fffffpppppp");
}

static void ringing_follows_saccades_only(void **state)
{
	(void)state;
	uint8_t class[65];
	const int32_t much = (int32_t)(20 / GZ_FOREST_UNIT);
	decode("fffsssrrrfff", much, class);
	assert_string_equal((char *)class, "fffsssrrrfff");
	decode("ffffrrrrffff", much, class);
	assert_null(strstr((char *)class, "fr"));
	decode("rrff", much, class);
	assert_true(class[0] != 'r');
}

static void losses_are_noise_unless_they_are_short(void **state)
{
	(void)state;
	uint8_t class[65];
	const int32_t much = (int32_t)(20 / GZ_FOREST_UNIT);
	decode("ffff.ffff", much, class);
	assert_string_equal((char *)class, "fffffffff");
	decode("ffff...ffff", much, class); /* 16 ms from one measured sample to the next */
	assert_string_equal((char *)class, "ffffnnnffff");
	decode("..ffff..", much, class);
	assert_string_equal((char *)class, "nnffffnn");
}

/* Weigh slow movement at 250 Hz: a letter a sample, whose odds of pursuit are @p odds for 'p', as
 * much against it for 'f', and which is neither for 's'. */
static void weigh(const char *movement, int32_t odds, const struct gz_whole_odds *how,
		  int32_t (*out_scores)[GZ_FOREST_CLASSES])
{
	enum { MOST = 64 };
	struct gz_movement_input input[MOST];
	const size_t count = strlen(movement);
	assert_in_range(count, 1, MOST);
	for (size_t i = 0; i < count; i++) {
		input[i] = (struct gz_movement_input) { .time_ns = (int64_t)i * 4000000,
							.valid = true };
		memset(out_scores[i], 0, sizeof out_scores[i]);
		out_scores[i][GZ_FOREST_FIXATION] = movement[i] == 'f' ? odds : 0;
		out_scores[i][GZ_FOREST_PURSUIT] = movement[i] == 'p' ? odds : 0;
		out_scores[i][GZ_FOREST_SACCADE] = movement[i] == 's' ? 2 * odds : -odds;
	}
	assert_int_equal(gz_whole_weigh(input, count, how, out_scores), GZ_OK);
}

static int32_t odds_of(const int32_t scores[GZ_FOREST_CLASSES])
{
	return scores[GZ_FOREST_PURSUIT] - scores[GZ_FOREST_FIXATION];
}

static void odds_of_pursuit_are_means_of_those_around(void **state)
{
	(void)state;
	int32_t scores[64][GZ_FOREST_CLASSES];
	const int32_t much = 3000;
	struct gz_whole_odds how = { .reach_us = 8000, .limit = much };
	weigh("fffppppsspppp", much, &how, scores);
	assert_int_equal(odds_of(scores[1]), -much / 3); /* of two to one: the first has no time */
	assert_int_equal(odds_of(scores[2]), 0);         /* of two to two */
	assert_int_equal(odds_of(scores[5]), much);
	assert_int_equal(odds_of(scores[7]), 0); /* saccades stay as they are */
	assert_int_equal(scores[7][GZ_FOREST_SACCADE], 2 * much);
	assert_int_equal(scores[2][GZ_FOREST_FIXATION], much); /* as likely as it was */
	how.lead = 2 * much; /* more than the limit, and what is beyond does not count */
	weigh("fffppppsspppp", much, &how, scores);
	assert_int_equal(odds_of(scores[1]), much);
	how.lead = 0, how.limit = 100;
	weigh("fpp", much, &how, scores);
	assert_int_equal(odds_of(scores[2]), 100);
	how.reach_us = 0;
	weigh("fpfpp", much, &how, scores);
	assert_int_equal(odds_of(scores[2]), -100);
}

static void much_pursuit_makes_more_of_it_likely(void **state)
{
	(void)state;
	int32_t scores[64][GZ_FOREST_CLASSES], without;
	struct gz_whole_odds how = { .limit = 100000 };
	weigh("fpppppppppppppppppppppppppppppppf", 9000, &how, scores);
	without = odds_of(scores[32]);
	how.share = 0.5;
	weigh("fpppppppppppppppppppppppppppppppf", 9000, &how, scores);
	const int32_t half = odds_of(scores[32]);
	how.share = 1;
	weigh("fpppppppppppppppppppppppppppppppf", 9000, &how, scores);
	assert_int_equal(without, -9000);
	assert_true(half > without + 100);
	assert_in_range(odds_of(scores[32]) - half, half - without - 1, half - without + 1);
}

/*
 * Recordings that people labelled.
 */

/* What is compared, and the least kappa (mean of both people) in pictures, dots and videos: that on
 * recordings that were not learned from (docs/gaze-pipeline.md); for fixations in dots, 0.925
 * there, what the installed forest reaches. 0: too rare there. */
static const struct {
	enum gz_offline_label label;
	enum gz_human_label human;
	double least[GZ_LABELLED_STIMULI];
} AGREEMENTS[] = {
	{ GZ_OFFLINE_SACCADE, GZ_HUMAN_SACCADE, { 0.877, 0.718, 0.813 } },
	{ GZ_OFFLINE_FIXATION, GZ_HUMAN_FIXATION, { 0.843, 0.908, 0.609 } },
	{ GZ_OFFLINE_OSCILLATION, GZ_HUMAN_GLISSADE, { 0.711, 0.418, 0.537 } },
	{ GZ_OFFLINE_BLINK, GZ_HUMAN_BLINK, { 0.828, 0, 0.950 } },
};
enum { AGREEMENTS_COUNT = sizeof AGREEMENTS / sizeof AGREEMENTS[0] };

struct agreements {
	struct gz_agreement of[AGREEMENTS_COUNT][GZ_LABELLED_CODERS];
};

static void add_agreement(const char *data, size_t file, int coder, struct agreements *agreements)
{
	struct gz_labelled_recording human;
	assert_true(gz_labelled_recording_read(data, file, coder, &human));
	struct recording recording = { .display = human.display,
				       .count = human.count,
				       .sample = human.sample };
	recording_label(&recording);
	for (size_t i = 0; i < recording.count; i++)
		for (int k = 0; k < AGREEMENTS_COUNT; k++)
			gz_agreement_add(&agreements->of[k][coder],
					 recording.labels.label[i] == AGREEMENTS[k].label,
					 human.label[i] == (int)AGREEMENTS[k].human);
	gz_offline_labels_free(&recording.labels);
	gz_labelled_recording_free(&human);
}

static void people_agree_no_less_than_on_recordings_that_were_not_learned_from(void **state)
{
	(void)state;
	static struct agreements agreements[GZ_LABELLED_STIMULI];
	const char *data = getenv("GAZECAST_DATA");
	if (!data)
		skip();
	for (size_t i = 0; i < GZ_LABELLED_FILES; i++)
		for (int coder = 0; coder < GZ_LABELLED_CODERS; coder++)
			add_agreement(data, i, coder, &agreements[gz_labelled_files[i].stimulus]);
	for (int k = 0; k < AGREEMENTS_COUNT; k++)
		for (int i = 0; i < GZ_LABELLED_STIMULI; i++) {
			const struct gz_agreement *of = agreements[i].of[k];
			double kappa =
				(gz_agreement_kappa(&of[0]) + gz_agreement_kappa(&of[1])) / 2;
			print_message("%s, %s: kappa %.3f\n", gz_labelled_stimulus_names[i],
				      gz_offline_label_name(AGREEMENTS[k].label), kappa);
			if (AGREEMENTS[k].least[i] > 0)
				CHECK_BETWEEN(kappa, AGREEMENTS[k].least[i], 1);
		}
}

/* What people call a sample of GazeCom, what the filter calls it, and the least F1: that on films
 * that were not learned from. The coders call ringing a saccade. */
static const struct {
	enum gz_human_label human;
	enum gz_offline_label label[2];
	double least;
} FILM_LABELS[] = {
	{ GZ_HUMAN_FIXATION, { GZ_OFFLINE_FIXATION, GZ_OFFLINE_FIXATION }, 0.935 },
	{ GZ_HUMAN_SACCADE, { GZ_OFFLINE_SACCADE, GZ_OFFLINE_OSCILLATION }, 0.884 },
	{ GZ_HUMAN_PURSUIT, { GZ_OFFLINE_PURSUIT, GZ_OFFLINE_PURSUIT }, 0.707 },
	{ GZ_HUMAN_BLINK, { GZ_OFFLINE_BLINK, GZ_OFFLINE_LOST }, 0.773 },
};
enum { FILM_LABELS_COUNT = sizeof FILM_LABELS / sizeof FILM_LABELS[0] };

/* Every so many observers of a film; chosen so that the test takes little time. */
enum { FILM_STEP = 10 };

static void add_film(const struct gz_labelled_recording *human,
		     struct gz_agreement agreement[FILM_LABELS_COUNT])
{
	struct recording recording = { .display = human->display,
				       .count = human->count,
				       .sample = human->sample };
	recording_label(&recording);
	for (size_t i = 0; i < recording.count; i++)
		for (int k = 0; k < FILM_LABELS_COUNT; k++) {
			const uint8_t label = recording.labels.label[i];
			gz_agreement_add(&agreement[k],
					 label == FILM_LABELS[k].label[0] ||
						 label == FILM_LABELS[k].label[1],
					 human->label[i] == (int)FILM_LABELS[k].human);
		}
	gz_offline_labels_free(&recording.labels);
}

static void people_agree_about_films_no_less_than_on_others(void **state)
{
	(void)state;
	struct gz_agreement agreement[FILM_LABELS_COUNT] = { { .both = 0 } };
	const char *data = getenv("GAZECAST_DATA");
	if (!data)
		skip();
	for (size_t film = 0; film < GZ_GAZECOM_FILMS; film++) {
		static struct gz_gazecom gazecom;
		assert_true(gz_gazecom_read(data, film, &gazecom));
		for (size_t i = film; i < gazecom.count; i += FILM_STEP)
			add_film(&gazecom.recording[i], agreement);
		gz_gazecom_free(&gazecom);
	}
	for (int k = 0; k < FILM_LABELS_COUNT; k++) {
		const struct gz_agreement *a = &agreement[k];
		const double f1 = 2 * a->both / (a->ours + a->theirs);
		print_message("GazeCom, %s: F1 %.3f\n",
			      gz_offline_label_name(FILM_LABELS[k].label[0]), f1);
		CHECK_BETWEEN(f1, FILM_LABELS[k].least, 1);
	}
}

TEST_SUITE(offline)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(simulated_viewers_are_labelled_at_any_rate),
		cmocka_unit_test(in_the_still_part_of_a_recording_there_is_no_pursuit),
		cmocka_unit_test(a_gap_in_time_is_a_blink_or_lost_by_its_length),
		cmocka_unit_test(samples_whose_time_stands_still_have_the_label_of_the_last),
		cmocka_unit_test(without_a_time_that_counts_all_is_lost),
		cmocka_unit_test(any_samples_give_labels),
		cmocka_unit_test(later_features_are_those_of_reversed_time),
		cmocka_unit_test(the_best_sequence_has_no_needless_change),
		cmocka_unit_test(ringing_follows_saccades_only),
		cmocka_unit_test(losses_are_noise_unless_they_are_short),
		cmocka_unit_test(odds_of_pursuit_are_means_of_those_around),
		cmocka_unit_test(much_pursuit_makes_more_of_it_likely),
		cmocka_unit_test(
			people_agree_no_less_than_on_recordings_that_were_not_learned_from),
		cmocka_unit_test(people_agree_about_films_no_less_than_on_others),
	};
	return cmocka_run_group_tests_name("filter.offline", tests, NULL, NULL);
}
