#include "view/experiment/experiment.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "view/experiment/experiment_internal.h"
#include "view/settings/scene_tables.h"

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
