/* gazebench merge: join the shards of a study. */
#include "bench/gazebench/gazebench.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>

#include "bench/study/merge.h"
#include "bench/study/study_folder.h"

#define GZ_LOG_MODULE "gazebench"

struct settings {
	struct gz_command_common common;
	bool json;
};

static const struct gz_option options[] = {
	GZ_COMMAND_HELP_OPTION,
	{ .key = "json",
	  .type = GZ_OPTION_BOOL,
	  .offset = offsetof(struct settings, json),
	  .preset = "no",
	  .help = "print what came of it as JSON" },
};

static void print_outcome(const char *folder, const struct gz_study *study, size_t shards,
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

static int run(int argc, char *const *argv, const struct gz_log *log)
{
	struct settings settings;
	struct gz_operands folders;
	int status =
		gz_command_read_arguments(&gazebench_merge, argc, argv, log, &settings, &folders);
	if (status != GZ_COMMAND_GO_ON)
		return status;
	if (folders.count < 2) {
		gz_err(log, "a folder to make and those of the shards are wanted: gazebench merge "
			    "OUT DIR...");
		return GAZEBENCH_USAGE;
	}
	struct gz_study *study = calloc(1, sizeof *study);
	const size_t shards = (size_t)folders.count - 1;
	enum gz_result result =
		study ? gz_study_merge(folders.items + 1, shards, log, study) : GZ_ERR_NO_MEM;
	if (result == GZ_OK) {
		result = gz_study_write(folders.items[0], study, log);
		if (result == GZ_OK)
			print_outcome(folders.items[0], study, shards, settings.json);
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
	.details = "DIR... are the folders that gazebench run --shard 1/N to N/N has made, in any "
		   "order.\nThe result is what one run would have measured, but for its times.\n",
	.options = options,
	.option_count = sizeof options / sizeof options[0],
	.run = run,
};
