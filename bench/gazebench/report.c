/* gazebench report and gazebench merge: commands on folders of studies. */
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>

#include "bench/gazebench/gazebench.h"
#include "bench/report/advice.h"
#include "bench/report/report.h"
#include "bench/report/summary_json.h"
#include "bench/study/merge.h"
#include "bench/study/study_folder.h"

#define GZ_LOG_MODULE "gazebench"

struct settings {
	struct gz_command_common common;
	char jod[GZ_PATH_SIZE];
	bool json;
};

static const struct gz_option options[] = {
	GZ_COMMAND_HELP_OPTION,
	{ .key = "jod",
	  .type = GZ_OPTION_STRING,
	  .offset = offsetof(struct settings, jod),
	  .max = GZ_PATH_SIZE,
	  .preset = "",
	  .help = "table of qualities that a published metric has found, entered by hand, to chart "
		  "over time: scene,method,jod,how" },
	{ .key = "json",
	  .type = GZ_OPTION_BOOL,
	  .offset = offsetof(struct settings, json),
	  .preset = "false",
	  .help = "print summary.json instead of text" },
};

/* The first paragraph of each section of the page. */
static enum gz_result print_answers(const struct gz_summary *summary, const char *folder)
{
	struct gz_text text = { 0 };
	for (size_t i = 0; i < summary->group_count; i++) {
		const struct gz_group *group = &summary->groups[i];
		const struct gz_advice_question question = gz_advice_preset(group);
		gz_advice_tell(summary->study, group, &question, gz_advice_find(group, &question),
			       false, &text);
		gz_text_add(&text, "\n");
	}
	gz_text_add(&text, "%s/report.html\n", folder);
	const bool whole = !text.failed;
	if (whole)
		fputs(text.bytes, stdout);
	gz_text_free(&text);
	return whole ? GZ_OK : GZ_ERR_NO_MEM;
}

static enum gz_result print_summary_json(const struct gz_summary *summary)
{
	json_t *json = gz_summary_to_json(summary);
	const bool printed =
		json && json_dumpf(json, stdout, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) == 0;
	json_decref(json);
	putchar('\n');
	return printed ? GZ_OK : GZ_ERR_IO;
}

static enum gz_result report_study(const struct gz_study *study, const char *folder,
				   const struct settings *settings, const struct gz_log *log)
{
	struct gz_summary summary;
	struct gz_jod_table jods = { 0 };
	enum gz_result result = gz_summary_make(study, &summary);
	if (result == GZ_ERR_END) {
		gz_err(log, "%s: no frame was measured yet; gazebench run resumes it", folder);
		return result;
	}
	if (result != GZ_OK) {
		gz_err(log, "%s: cannot be summed up: %s", folder, gz_result_text(result));
		return result;
	}
	if (settings->jod[0]) {
		result = gz_jod_table_read(settings->jod, study, log, &jods);
		summary.jods = &jods;
	}
	if (!study->complete)
		gz_warn(log, "%s: a partial study: %zu frames so far; the report says so", folder,
			study->row_count);
	else if (study->shard_count > 1)
		gz_warn(log, "%s: shard %d of %d alone; the report says so", folder,
			study->shard + 1, study->shard_count);
	if (result == GZ_OK)
		result = gz_report_write(&summary, folder, log);
	if (result == GZ_OK)
		result = settings->json ? print_summary_json(&summary)
					: print_answers(&summary, folder);
	gz_summary_free(&summary);
	gz_jod_table_free(&jods);
	return result;
}

static int run_report(int argc, char *const *argv, const struct gz_log *log)
{
	static struct settings settings; /* of some size; a program runs one command */
	struct gz_operands operands;
	struct gz_study study;
	int status =
		gz_command_read_arguments(&gazebench_report, argc, argv, log, &settings, &operands);
	if (status != GZ_COMMAND_GO_ON)
		return status;
	if (operands.count != 1) {
		gz_err(log, "give one folder: gazebench report DIR");
		return GAZEBENCH_USAGE;
	}
	const char *folder = operands.items[0];
	if (gz_study_read(folder, log, &study) != GZ_OK)
		return GAZEBENCH_FAILED;
	const enum gz_result result = report_study(&study, folder, &settings, log);
	gz_study_free(&study);
	return result == GZ_OK ? GAZEBENCH_DONE : GAZEBENCH_FAILED;
}

const struct gz_command gazebench_report = {
	.program = "gazebench",
	.name = "report",
	.operands = "DIR",
	.operands_max = 1,
	.summary = "chart a study, sum it up, and write it as a page",
	.details =
		"Writes into the study's folder: report.html, a complete page that needs no "
		"network;\n"
		"summary.json; each chart as SVG and PNG. Prints the page's first paragraph and "
		"its path.\n"
		"gnuplot draws the charts; without it there is a warning and the tables remain.\n"
		"A partial study is reported as far as it was measured, and marked.\n",
	.options = options,
	.option_count = sizeof options / sizeof options[0],
	.run = run_report,
};

/* ---- gazebench merge ---- */

static const struct gz_option merge_options[] = {
	GZ_COMMAND_HELP_OPTION,
	{ .key = "json",
	  .type = GZ_OPTION_BOOL,
	  .offset = offsetof(struct settings, json),
	  .preset = "no",
	  .help = "print the result as JSON" },
};

static void print_merge(const char *folder, const struct gz_study *study, size_t shards,
			bool as_json)
{
	if (!as_json) {
		printf("%s: %zu shards, %zu rows\n", folder, shards, study->row_count);
		return;
	}
	json_t *json = json_pack("{ss sI sI}", "out", folder, "shards", (json_int_t)shards, "rows",
				 (json_int_t)study->row_count);
	json_dumpf(json, stdout, JSON_INDENT(1));
	printf("\n");
	json_decref(json);
}

static int run_merge(int argc, char *const *argv, const struct gz_log *log)
{
	struct settings settings;
	struct gz_operands folders;
	int status =
		gz_command_read_arguments(&gazebench_merge, argc, argv, log, &settings, &folders);
	if (status != GZ_COMMAND_GO_ON)
		return status;
	if (folders.count < 2) {
		gz_err(log,
		       "give a new folder and those of the shards: gazebench merge OUT DIR...");
		return GAZEBENCH_USAGE;
	}
	struct gz_study *study = calloc(1, sizeof *study);
	const size_t shards = (size_t)folders.count - 1;
	enum gz_result result =
		study ? gz_study_merge(folders.items + 1, shards, log, study) : GZ_ERR_NO_MEM;
	if (result == GZ_OK) {
		result = gz_study_write(folders.items[0], study, log);
		if (result == GZ_OK)
			print_merge(folders.items[0], study, shards, settings.json);
		gz_study_free(study);
	}
	free(study);
	return result == GZ_OK ? GAZEBENCH_DONE : GAZEBENCH_FAILED;
}

const struct gz_command gazebench_merge = {
	.program = "gazebench",
	.name = "merge",
	.operands = "OUT DIR...",
	.operands_max = -1,
	.summary = "join the shards of a study into one folder",
	.details =
		"DIR... are the folders made by gazebench run --shard 1/N to N/N, in any order.\n"
		"The result is the study that one run would have made, except for its times.\n",
	.options = merge_options,
	.option_count = sizeof merge_options / sizeof merge_options[0],
	.run = run_merge,
};
