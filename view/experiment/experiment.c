#include "view/experiment/experiment.h"

#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "view/experiment/experiment_internal.h"
#include "view/experiment/staircase.h"
#include "view/settings/scene_keys.h"

#define GZ_LOG_MODULE "experiment"

int gz_answer_key_of(const char *name)
{
	static const struct {
		const char *name;
		int key;
	} named[] = {
		{ "left", GZ_KEY_LEFT }, { "right", GZ_KEY_RIGHT }, { "up", GZ_KEY_UP },
		{ "down", GZ_KEY_DOWN }, { "space", GZ_KEY_SPACE }, { "return", GZ_KEY_RETURN },
	};
	for (size_t i = 0; i < sizeof named / sizeof named[0]; i++)
		if (strcmp(name, named[i].name) == 0)
			return named[i].key;
	char key = name[0];
	if (key == '\0' || name[1] != '\0')
		return GZ_KEY_NONE;
	return (key >= 'a' && key <= 'z') || (key >= '0' && key <= '9') ? key : GZ_KEY_NONE;
}

#define LETTERS_AND_DIGITS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"

bool gz_experiment_is_word(const char *text)
{
	return text[0] && text[strspn(text, LETTERS_AND_DIGITS)] == '\0';
}

bool gz_experiment_is_label(const char *text)
{
	return text[0] && text[strspn(text, LETTERS_AND_DIGITS "_.+-")] == '\0' &&
	       strlen(text) < GZ_EXPERIMENT_LABEL_SIZE;
}

const struct gz_experiment_setting *gz_experiment_find_setting(
	const struct gz_experiment_section *section, const char *key, int alternative)
{
	for (size_t i = 0; i < section->setting_count; i++) {
		const struct gz_experiment_setting *setting = &section->settings[i];
		if (setting->alternative == alternative && strcmp(setting->key, key) == 0)
			return setting;
	}
	return NULL;
}

uint64_t gz_experiment_hash(uint64_t hash, const void *bytes, size_t size)
{
	const unsigned char *byte = bytes;
	for (size_t i = 0; i < size; i++)
		hash = (hash ^ byte[i]) * UINT64_C(0x100000001b3);
	return hash;
}

enum gz_result gz_alternative_apply(const struct gz_alternative *alternative,
				    struct gz_scene_settings *settings)
{
	struct gz_view_scene_tables tables;
	gz_view_pick_scene_tables(settings, &tables);
	for (size_t i = 0; i < alternative->setting_count; i++) {
		size_t table = 0;
		const struct gz_experiment_setting *setting = alternative->settings[i];
		const struct gz_option *option = gz_options_find(
			tables.bindings, GZ_VIEW_SCENE_TABLES, setting->key, &table);
		if (!option || gz_option_parse(option, setting->value,
					       tables.bindings[table].target, NULL, 0) != GZ_OK)
			return GZ_ERR_INVAL;
	}
	return GZ_OK;
}

void gz_alternative_print(const struct gz_alternative *alternative, char *text, size_t size)
{
	size_t used = 0;
	text[0] = '\0';
	for (size_t i = 0; i < alternative->setting_count && used + 1 < size; i++) {
		const struct gz_experiment_setting *setting = alternative->settings[i];
		int length = snprintf(text + used, size - used, "%s%s=%s", i ? " " : "",
				      setting->key, setting->value);
		used += length > 0 ? (size_t)length : 0;
	}
}

static void free_sections(struct gz_experiment_section *sections, size_t count)
{
	for (size_t i = 0; i < count; i++)
		free(sections[i].settings);
	free(sections);
}

void gz_experiment_free(struct gz_experiment *experiment)
{
	for (size_t i = 0; i < experiment->block_count; i++) {
		for (size_t k = 0; k < experiment->blocks[i].condition_count; k++)
			free(experiment->blocks[i].conditions[k].staircase);
		free(experiment->blocks[i].conditions);
		free(experiment->blocks[i].instructions);
	}
	free(experiment->blocks);
	free(experiment->instructions);
	free(experiment->common.settings);
	if (experiment->trials)
		free_sections(experiment->trials, experiment->trial_count);
	if (experiment->sections)
		free_sections(experiment->sections, experiment->section_count);
	*experiment = (struct gz_experiment) { 0 };
}

/* The section that names a text, for messages. */
struct place {
	const struct gz_experiment *experiment;
	const struct gz_log *log;
	const struct gz_experiment_section *section;
};

static enum gz_result refuse_text(const struct place *place, const char *what,
				  enum gz_result result)
{
	const struct gz_experiment_setting *setting =
		gz_experiment_find_setting(place->section, "instructions_file", -1);
	gz_err(place->log, "%s:%d: instructions_file: %s", place->experiment->path,
	       setting ? setting->line : place->section->line, what);
	return result;
}

static enum gz_result read_text(const struct place *place, const char *name, char **out_text)
{
	char path[GZ_PATH_SIZE], what[GZ_PATH_SIZE + 128];
	if (gz_path_beside(place->experiment->path, name, path, sizeof path) != GZ_OK)
		return refuse_text(place, "the path is too long; move the file", GZ_ERR_FORMAT);
	FILE *file = fopen(path, "rb");
	if (!file) {
		enum gz_result result = errno == ENOENT ? GZ_ERR_NOT_FOUND : GZ_ERR_IO;
		snprintf(what, sizeof what, "%s cannot be opened: %s", path, strerror(errno));
		return refuse_text(place, what, result);
	}
	char *text = calloc(1, GZ_EXPERIMENT_TEXT_SIZE + 1);
	size_t size = text ? fread(text, 1, GZ_EXPERIMENT_TEXT_SIZE, file) : 0;
	bool failed = ferror(file) != 0;
	fclose(file);
	if (!text)
		return GZ_ERR_NO_MEM;
	if (!failed && size < GZ_EXPERIMENT_TEXT_SIZE && !memchr(text, '\0', size)) {
		*out_text = text;
		return GZ_OK;
	}
	free(text);
	snprintf(what, sizeof what, "%s is not a text of at most %d bytes", path,
		 GZ_EXPERIMENT_TEXT_SIZE - 1);
	return refuse_text(place, failed ? "cannot be read" : what,
			   failed ? GZ_ERR_IO : GZ_ERR_FORMAT);
}

static enum gz_result take_shown_text(struct gz_experiment *experiment, const struct place *place,
				      const char *text, const char *name, char **out_text)
{
	if (name[0]) {
		enum gz_result result = read_text(place, name, out_text);
		if (result == GZ_OK)
			experiment->fingerprint = gz_experiment_hash(
				experiment->fingerprint, *out_text, strlen(*out_text) + 1);
		return result;
	}
	if (!text[0])
		return GZ_OK;
	*out_text = strdup(text);
	return *out_text ? GZ_OK : GZ_ERR_NO_MEM;
}

enum gz_result gz_experiment_read_texts(struct gz_experiment *experiment, const struct gz_log *log)
{
	const struct place common = { experiment, log, &experiment->common };
	enum gz_result result =
		take_shown_text(experiment, &common, experiment->params.instructions,
				experiment->params.instructions_file, &experiment->instructions);
	for (size_t i = 0; i < experiment->section_count && result == GZ_OK; i++) {
		struct gz_block *block = &experiment->blocks[i];
		const struct place place = { experiment, log, &experiment->sections[i] };
		result = take_shown_text(experiment, &place, block->params.instructions,
					 block->params.instructions_file, &block->instructions);
	}
	return result;
}

/* One alternative being checked. */
struct check {
	const struct gz_experiment *experiment;
	const struct gz_log *log;
	const struct gz_condition *condition;
	int which;
	char place[GZ_PATH_SIZE + 128]; /* its place in the file, for messages */
};

/* The line for messages: that of the last setting, otherwise of the trial. */
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
		       "%s: no scene %s; correct the name, which is relative to the experiment",
		       check->place, alternative->scene);
		return GZ_ERR_NOT_FOUND;
	}
	const struct gz_scene_source source = {
		.path = alternative->scene,
		.change = apply,
		.user = check,
	};
	enum gz_result result = gz_scene_try(&source, check->log, &settings);
	if (result == GZ_OK)
		alternative->method = settings.foveation.method;
	else
		gz_err(check->log, "%s: cannot be shown, see the message above", check->place);
	return result;
}

/* A staircase's alternative, at both ends of its range. */
static enum gz_result check_values(struct check *check, struct gz_alternative *alternative)
{
	struct gz_staircase *staircase = check->condition->staircase;
	if (!staircase)
		return check_alternative(check, alternative);
	enum gz_result result = GZ_OK;
	for (int end = 0; end < 2 && result == GZ_OK; end++) {
		gz_staircase_go_to_end(staircase, end);
		result = check_alternative(check, alternative);
	}
	gz_staircase_place(staircase);
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
				result = check_values(&check, &condition->alternatives[which]);
			}
		}
	}
	return result;
}
