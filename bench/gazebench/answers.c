/* gazebench answers: an experiment's answers summed up, with thresholds. */
#include "bench/gazebench/gazebench.h"

#include <stdio.h>
#include <string.h>

#include "base/sizes.h"
#include "bench/answers/answer_page.h"

#define GZ_LOG_MODULE "gazebench"

struct settings {
	struct gz_command_common common;
	char out[GZ_PATH_SIZE];
	char key[GZ_ANSWER_NAME_SIZE];
	struct gz_psychometric_params params;
};

#define AT(field) offsetof(struct settings, field)

static const struct gz_option options[] = {
	GZ_COMMAND_HELP_OPTION,
	{ "out", GZ_OPTION_STRING, AT(out), .max = GZ_PATH_SIZE, .preset = "",
	  .help = "page to write, with each psychometric function drawn" },
	{ "key", GZ_OPTION_STRING, AT(key), .max = GZ_ANSWER_NAME_SIZE, .preset = "",
	  .help = "scene key that differs between trials; each scene gets a function over it" },
	{ "gamma", GZ_OPTION_DOUBLE, AT(params.gamma), 0, 0.99, .preset = "0.5",
	  .help = "share of right answers by guessing: 0.5 with two answers" },
	{ "delta", GZ_OPTION_DOUBLE, AT(params.delta), 0, 0.5, .preset = "0.01",
	  .help = "share of answers that are blind guesses" },
	{ "target", GZ_OPTION_DOUBLE, AT(params.target), 0.01, 0.99, .preset = "0.82",
	  .help = "share of right answers at the threshold" },
};

/* The target must lie between what guessing gives and what blind answers leave. */
static bool target_is_possible(const struct gz_psychometric_params *params)
{
	return params->target > params->gamma &&
	       params->target < params->delta * params->gamma + 1 - params->delta;
}

static int run_answers(int argc, char *const *argv, const struct gz_log *log)
{
	struct settings settings;
	struct gz_operands operands;
	struct gz_answer_table table = { 0 };
	const int status = gz_command_read_arguments(&gazebench_answers, argc, argv, log, &settings,
						     &operands);
	if (status != GZ_COMMAND_GO_ON)
		return status;
	if (operands.count < 1 || !target_is_possible(&settings.params)) {
		gz_err(log, operands.count < 1
				    ? "answers: no file; name one or more *_events.tsv"
				    : "--target: must lie between --gamma and what --delta leaves");
		return GAZEBENCH_USAGE;
	}
	enum gz_result result = GZ_OK;
	for (int i = 0; i < operands.count && result == GZ_OK; i++)
		result = gz_answer_table_add(&table, operands.items[i], settings.key, log);
	if (result == GZ_OK)
		gz_answer_table_print(&table, &settings.params, stdout);
	if (result == GZ_OK && settings.out[0])
		result = gz_answer_page_write(&table, &settings.params, settings.out, log);
	gz_answer_table_free(&table);
	return result == GZ_OK ? GAZEBENCH_DONE : GAZEBENCH_FAILED;
}

const struct gz_command gazebench_answers = {
	.program = "gazebench",
	.name = "answers",
	.operands = "FILE...",
	.operands_max = -1,
	.summary = "sum up answers of an experiment, with thresholds",
	.details = "Reads tables that gazeview --experiment wrote (*_events.tsv), of any number of "
		   "participants.\nPrints the share of right answers of each trial and, where a "
		   "staircase or --key\nvaried a scene key, the threshold.\n",
	.options = options,
	.option_count = sizeof options / sizeof options[0],
	.run = run_answers,
};
