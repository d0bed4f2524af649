/* Experiments from anywhere, without the files that they name: an accepted one has an order in
 * which every trial can be shown and answered. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "view/experiment/run.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
	if (!holds)
		abort();
}

static void check_condition(const struct gz_condition *condition)
{
	struct gz_scene_settings settings = { 0 };
	char text[256];
	require(condition->answer_count > 0);
	require(condition->params.intervals == 1 || condition->params.intervals == 2);
	require(condition->correct < (int)condition->answer_count);
	for (int i = 0; i < condition->params.intervals; i++) {
		require(condition->alternatives[i].scene[0] == '/');
		require(gz_alternative_apply(&condition->alternatives[i], &settings) == GZ_OK);
		gz_alternative_print(&condition->alternatives[i], text, sizeof text);
	}
}

/* Answer each question at once; texts and blanks take a second a step. */
static void run_through(const struct gz_experiment *experiment, const struct gz_sequence *sequence)
{
	static struct gz_run run; /* too large for the stack */
	struct gz_run_screen screen;
	int64_t now_ns = 1;
	const struct gz_run_start start = { experiment, sequence, "1", "", 0, { 0 } };
	gz_run_begin(&run, &start);
	for (size_t i = 0; i < 40 && run.phase != GZ_RUN_ENDED; i++) {
		const struct gz_run_input input = { now_ns, 1, true, true };
		gz_run_step(&run, &input);
		gz_run_screen(&run, &screen);
		require(screen.phase != GZ_RUN_INTERVAL || screen.alternative);
		gz_run_shown(&run, now_ns);
		if (screen.phase == GZ_RUN_TEXT)
			gz_run_key(&run, ' ', now_ns);
		else if (screen.phase == GZ_RUN_QUESTION)
			gz_run_key(&run, screen.presentation->condition->answers[0].key, now_ns);
		now_ns += INT64_C(4000000000000);
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct gz_experiment experiment;
	struct gz_sequence sequence;
	if (gz_experiment_parse("/fuzz/e", (const char *)data, size, NULL, &experiment) != GZ_OK)
		return 0;
	for (size_t b = 0; b < experiment.block_count; b++) {
		require(experiment.blocks[b].condition_count > 0);
		for (size_t i = 0; i < experiment.blocks[b].condition_count; i++)
			check_condition(&experiment.blocks[b].conditions[i]);
	}
	require(gz_sequence_make(&experiment, "1", "", NULL, &sequence) == GZ_OK);
	require(sequence.count > 0 && sequence.count <= GZ_EXPERIMENT_TRIALS_MAX);
	run_through(&experiment, &sequence);
	gz_sequence_free(&sequence);
	gz_experiment_free(&experiment);
	return 0;
}
