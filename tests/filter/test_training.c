/* What the training of the forests computed is what the filter gives. */
#include "suite.h"

#include <stdlib.h>
#include <string.h>

#include "bench/filter/gazecom.h"
#include "bench/filter/labelled_recording.h"
#include "filter/classifier/whole.h"
#include "filter/pipeline.h"

/* FNV-1a, as gaze_forest_fit computes it. */
static uint64_t hash_scores(uint64_t hash, const int32_t *scores, int count)
{
	for (int k = 0; k < count; k++)
		for (int shift = 0; shift < 32; shift += 8)
			hash = (hash ^ ((uint32_t)scores[k] >> shift & 0xff)) *
			       UINT64_C(1099511628211);
	return hash;
}

struct hashes {
	uint64_t at_once, certain, whole;
};

/* The input of the classifier for one sample. */
static struct gz_movement_input input_of(struct gz_pipeline *pipeline,
					 const struct gz_sample *sample)
{
	const struct gz_validate_output valid = gz_validate_step(
		&pipeline->validate, &pipeline->params.validate, &pipeline->display, sample);
	return (struct gz_movement_input) {
		.time_ns = sample->host_ns,
		.valid = valid.rejection == GZ_REJECT_NONE,
		.point = sample->point,
	};
}

static void hash_row(void *user, size_t index, const float features[GZ_WHOLE_FEATURES])
{
	struct hashes *hashes = user;
	int32_t scores[GZ_FOREST_CLASSES];
	(void)index;
	gz_whole_score(features, scores);
	hashes->whole = hash_scores(hashes->whole, scores, GZ_FOREST_CLASSES);
}

static void hash_whole_recording(const struct gz_labelled_recording *recording,
				 struct hashes *hashes)
{
	static struct gz_pipeline pipeline;
	const struct gz_whole_rows rows = { hashes, hash_row };
	struct gz_movement_input *input = calloc(recording->count, sizeof *input);
	assert_non_null(input);
	gz_pipeline_init(&pipeline, NULL, &recording->display);
	for (size_t i = 0; i < recording->count; i++)
		input[i] = input_of(&pipeline, &recording->sample[i]);
	assert_int_equal(gz_whole_features(&recording->display, input, recording->count, &rows),
			 GZ_OK);
	free(input);
}

static void hash_recording(const struct gz_labelled_recording *recording, struct hashes *hashes)
{
	static struct gz_pipeline pipeline;
	static struct gz_movement movement;
	gz_pipeline_init(&pipeline, NULL, &recording->display);
	memset(&movement, 0, sizeof movement);
	for (size_t i = 0; i < recording->count; i++) {
		const struct gz_movement_input input = input_of(&pipeline, &recording->sample[i]);
		float features[GZ_MOVEMENT_FEATURES];
		int32_t scores[GZ_FOREST_CLASSES];
		(void)gz_movement_step(&movement, &recording->display, &input, features);
		gz_forest_score(&gz_forest_at_once, features, scores);
		hashes->at_once =
			hash_scores(hashes->at_once, scores, gz_forest_at_once.class_count);
		gz_forest_score(&gz_forest_certain, features, scores);
		hashes->certain =
			hash_scores(hashes->certain, scores, gz_forest_certain.class_count);
	}
}

/* What the training computed from its own copy of the features and trees is what the filter gives.
 */
static void scores_are_those_of_the_training(void **state)
{
	(void)state;
	const char *data = getenv("GAZECAST_DATA");
	if (!data)
		skip();
	const uint64_t start = UINT64_C(14695981039346656037);
	struct hashes hashes = { start, start, start };
	for (size_t i = 0; i < GZ_LABELLED_FILES; i++) {
		struct gz_labelled_recording first, second = { .count = 0 };
		assert_true(gz_labelled_recording_read(data, i, 0, &first));
		assert_true(gz_labelled_recording_read(data, i, 1, &second));
		if (second.count < first.count)
			first.count = second.count;
		hash_recording(&first, &hashes);
		hash_whole_recording(&first, &hashes);
		gz_labelled_recording_free(&first);
		gz_labelled_recording_free(&second);
	}
	for (size_t film = 0; film < GZ_GAZECOM_FILMS; film++) {
		static struct gz_gazecom gazecom;
		assert_true(gz_gazecom_read(data, film, &gazecom));
		for (size_t i = 0; i < gazecom.count; i++)
			hash_recording(&gazecom.recording[i], &hashes);
		gz_gazecom_free(&gazecom);
	}
	assert_true(hashes.at_once == gz_forest_at_once.training_hash);
	assert_true(hashes.certain == gz_forest_certain.training_hash);
	assert_true(hashes.whole == gz_forest_whole.training_hash);
}

TEST_SUITE(training)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(scores_are_those_of_the_training),
	};
	return cmocka_run_group_tests_name("filter.training", tests, NULL, NULL);
}
