/* Whether what an experiment names is there, before anything of it is shown. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "view/experiment/experiment_internal.h"

#define GZ_LOG_MODULE "experiment"

/* One alternative in checking. */
struct check {
	const struct gz_experiment *experiment;
	const struct gz_log *log;
	const struct gz_condition *condition;
	int which;
	char place[GZ_PATH_SIZE + 128]; /* of it in the file, for messages */
};

/* The line that counts most for it: that of its last setting, else of its trial. */
static int line_of(const struct check *check)
{
	const struct gz_alternative *alternative = &check->condition->alternatives[check->which];
	int line = check->condition->line;
	for (size_t i = 0; i < alternative->setting_count; i++)
		if (alternative->settings[i]->line > line)
			line = alternative->settings[i]->line;
	return line;
}

static enum gz_result apply(void *user, struct gz_scene_settings *settings)
{
	const struct check *check = user;
	const struct gz_alternative *alternative = &check->condition->alternatives[check->which];
	enum gz_result result = gz_alternative_apply(alternative, settings);
	return result == GZ_OK ? gz_scene_settings_check(settings, check->place, check->log)
			       : result;
}

static enum gz_result check_alternative(struct check *check, struct gz_alternative *alternative)
{
	struct gz_scene_settings settings;
	snprintf(check->place, sizeof check->place, "%s:%d: [trial %s] %c", check->experiment->path,
		 line_of(check), check->condition->label, 'a' + check->which);
	if (access(alternative->scene, R_OK) != 0) {
		gz_err(check->log,
		       "%s: no scene %s; correct the name, which is beside the "
		       "experiment",
		       check->place, alternative->scene);
		return GZ_ERR_NOT_FOUND;
	}
	enum gz_result result =
		gz_scene_try(alternative->scene, apply, check, check->log, &settings);
	if (result == GZ_OK)
		alternative->method = settings.foveation.method;
	else
		gz_err(check->log, "%s: cannot be shown, as said above", check->place);
	return result;
}

enum gz_result gz_experiment_check(struct gz_experiment *experiment, const struct gz_log *log)
{
	enum gz_result result = GZ_OK;
	for (size_t b = 0; b < experiment->block_count; b++) {
		struct gz_block *block = &experiment->blocks[b];
		for (size_t i = 0; i < block->condition_count; i++) {
			struct gz_condition *condition = &block->conditions[i];
			for (int which = 0; which < condition->params.intervals && result == GZ_OK;
			     which++) {
				struct check check = { experiment, log, condition, which, "" };
				result = check_alternative(&check, &condition->alternatives[which]);
			}
		}
	}
	return result;
}
