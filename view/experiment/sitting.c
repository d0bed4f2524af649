#include "view/experiment/sitting.h"
#include "render/plan/method.h"
#include "view/experiment/staircase.h"

#include <stdlib.h>
#include <string.h>

#define GZ_LOG_MODULE "experiment"

#define AT(field) offsetof(struct gz_sitting_options, field)

const struct gz_option gz_sitting_option_table[] = {
	{ "experiment", GZ_OPTION_STRING, AT(file), .max = GZ_PATH_SIZE, .preset = "",
	  .help = "run the experiment in this file, full screen; headless: check it and list its "
		  "trials" },
	{ "participant", GZ_OPTION_STRING, AT(participant), .max = GZ_PARTICIPANT_SIZE,
	  .preset = "",
	  .help = "participant's label: letters and digits, such as 07; the window asks for a "
		  "missing one" },
	{ "session", GZ_OPTION_STRING, AT(session), .max = GZ_PARTICIPANT_SIZE, .preset = "",
	  .help = "session's label, if there are several: letters and digits" },
	{ "notes", GZ_OPTION_STRING, AT(notes), .max = GZ_NOTES_SIZE, .preset = "",
	  .help = "notes on this session, for participants.tsv" },
	{ "answers", GZ_OPTION_STRING, AT(answers), .max = GZ_PATH_SIZE, .preset = ".",
	  .help = "folder for the answers, or the file itself, ending in .tsv" },
	{ "resume", GZ_OPTION_BOOL, AT(resume), .preset = "false",
	  .help = "continue an experiment that was left, adding to its answers" },
};

const size_t gz_sitting_option_count =
	sizeof gz_sitting_option_table / sizeof gz_sitting_option_table[0];

enum gz_result gz_sitting_options_check(const struct gz_sitting_options *options,
					const struct gz_log *log)
{
	if (!options->file[0]) {
		const char *other = options->participant[0] ? "participant"
				    : options->session[0]   ? "session"
				    : options->notes[0]     ? "notes"
				    : options->resume       ? "resume"
							    : NULL;
		if (!other)
			return GZ_OK;
		gz_err(log, "--%s: needs an experiment; add --experiment FILE", other);
		return GZ_ERR_INVAL;
	}
	if (options->participant[0] && !gz_answers_label_valid(options->participant)) {
		gz_err(log,
		       "--participant %s: not a label; give letters and digits, as in "
		       "--participant 07",
		       options->participant);
		return GZ_ERR_INVAL;
	}
	if (options->session[0] && !gz_answers_label_valid(options->session)) {
		gz_err(log, "--session %s: not a label; give letters and digits", options->session);
		return GZ_ERR_INVAL;
	}
	for (const char *letter = options->notes; *letter; letter++) {
		if ((unsigned char)*letter >= ' ' && *letter != 0x7f)
			continue;
		gz_err(log, "--notes: contains a tab or line break; give one line of text");
		return GZ_ERR_INVAL;
	}
	return GZ_OK;
}

static enum gz_result open_answers(struct gz_sitting *sitting,
				   const struct gz_sitting_program *program,
				   const struct gz_log *log)
{
	const struct gz_sitting_options *options = sitting->options;
	const struct gz_answers_request request = {
		.place = options->answers,
		.participant = options->participant,
		.session = options->session,
		.notes = options->notes,
		.resume = options->resume,
		.version = program->version,
		.gaze_source = program->gaze_source,
	};
	return gz_answers_open(&sitting->experiment, &sitting->sequence, &request, log,
			       &sitting->answers);
}

enum gz_result gz_sitting_open(const struct gz_sitting_options *options,
			       const struct gz_sitting_program *program, const struct gz_log *log,
			       struct gz_sitting **out_sitting)
{
	struct gz_sitting *sitting = calloc(1, sizeof *sitting);
	if (!sitting)
		return GZ_ERR_NO_MEM;
	sitting->options = options;
	enum gz_result r = gz_experiment_load(options->file, log, &sitting->experiment);
	if (r == GZ_OK)
		r = gz_experiment_check(&sitting->experiment, log);
	if (r == GZ_OK)
		r = gz_sequence_make(&sitting->experiment, options->participant, options->session,
				     log, &sitting->sequence);
	if (r == GZ_OK && program)
		r = open_answers(sitting, program, log);
	if (r != GZ_OK) {
		gz_sitting_close(&sitting);
		return r;
	}
	*out_sitting = sitting;
	return GZ_OK;
}

/* Time of a trial without the wait for its answer, s. */
static double length_s(const struct gz_condition *condition)
{
	const struct gz_trial_params *params = &condition->params;
	return params->fixation_s + params->intervals * params->duration_s +
	       (params->intervals - 1) * params->blank_s + params->pause_s +
	       (params->feedback ? params->feedback_s : 0);
}

void gz_sitting_print(const struct gz_sitting *sitting, FILE *out)
{
	double total_s = 0;
	for (size_t i = 0; i < sitting->sequence.count; i++) {
		const struct gz_presentation *presentation = &sitting->sequence.presentations[i];
		const struct gz_condition *condition = presentation->condition;
		fprintf(out, "%zu %s %s %d", i + 1, presentation->block->label, condition->label,
			presentation->repetition);
		for (int k = 0; k < condition->params.intervals; k++) {
			const int which = gz_presentation_alternative(presentation, k);
			fprintf(out, " %c:%s", 'a' + which,
				gz_method_names[condition->alternatives[which].method]);
		}
		fputc('\n', out);
		total_s += length_s(condition);
	}
	fprintf(out, "%zu trials, %.1f min without answers and breaks\n", sitting->sequence.count,
		total_s / 60);
}

void gz_sitting_log_thresholds(const struct gz_sitting *sitting, const struct gz_log *log)
{
	for (size_t b = 0; b < sitting->experiment.block_count; b++) {
		const struct gz_block *block = &sitting->experiment.blocks[b];
		for (size_t i = 0; i < block->condition_count; i++) {
			const struct gz_staircase *staircase = block->conditions[i].staircase;
			if (!staircase || staircase->quest.trials == 0)
				continue;
			const struct gz_quest_estimate found = gz_quest_estimate(&staircase->quest);
			gz_info(log, "%s, %s: threshold of %s %.3g, 95 %% %.3g to %.3g, %d answers",
				block->label, block->conditions[i].label, staircase->setting.key,
				found.threshold, found.low, found.high, staircase->quest.trials);
		}
	}
}

void gz_sitting_close(struct gz_sitting **sitting)
{
	if (!*sitting)
		return;
	gz_answers_close(&(*sitting)->answers);
	gz_sequence_free(&(*sitting)->sequence);
	gz_experiment_free(&(*sitting)->experiment);
	free(*sitting);
	*sitting = NULL;
}
