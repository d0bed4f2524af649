#include "bench/report/scene_edit.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/ini.h"
#include "render/plan/plan.h"
#include "render/raycast/shared/ray_params.h"
#include "render/scene/scene.h"

#define GZ_LOG_MODULE "scene"

/* The section in which scenes have an option; NULL if none does. */
static const char *section_of(const char *name)
{
	struct gz_foveation foveation;
	struct gz_ray_params rays;
	const struct {
		const char *section;
		struct gz_option_binding binding;
	} tables[] = {
		{ "foveation",
		  { gz_foveation_options, gz_foveation_option_count, &foveation, NULL } },
		{ "render", { gz_ray_options, gz_ray_option_count, &rays, NULL } },
	};
	for (size_t i = 0; i < sizeof tables / sizeof tables[0]; i++) {
		char key[GZ_STUDY_TEXT_SIZE + 16];
		snprintf(key, sizeof key, "%s.%s", tables[i].section, name);
		if (gz_options_find(&tables[i].binding, 1, key, NULL))
			return tables[i].section;
	}
	return NULL;
}

enum gz_result gz_scene_text_set_variant(struct gz_text *text,
					 const struct gz_study_variant *variant,
					 const struct gz_log *log)
{
	char copy[GZ_STUDY_TEXT_SIZE];
	snprintf(copy, sizeof copy, "%s", variant->text);
	char *rest = copy;
	strsep(&rest, ":");
	gz_ini_text_set(text, "foveation", "method", variant->method);
	for (char *option = strsep(&rest, ":"); option; option = strsep(&rest, ":")) {
		char *value = strchr(option, '=');
		if (value)
			*value++ = '\0';
		const char *section = section_of(option);
		if (!section || !value) {
			gz_err(log, "%s: %s is no option of a scene", variant->text, option);
			return GZ_ERR_INVAL;
		}
		gz_ini_text_set(text, section, option, value);
	}
	return GZ_OK;
}

/* A file that lies beside the scene must lie beside the copy too. */
static enum gz_result check_file(const char *scene, const char *copy, const char *key,
				 const char *name, const struct gz_log *log)
{
	char before[GZ_PATH_SIZE], after[GZ_PATH_SIZE];
	if (!name[0] || gz_path_beside(scene, name, before, sizeof before) != GZ_OK ||
	    gz_path_beside(copy, name, after, sizeof after) != GZ_OK || access(before, F_OK) != 0 ||
	    access(after, F_OK) == 0)
		return GZ_OK;
	gz_err(log, "%s: %s = %s lies beside %s and would not be found: write the copy there", copy,
	       key, name, scene);
	return GZ_ERR_NOT_FOUND;
}

static enum gz_result check_copy(const struct gz_text *text, const char *scene, const char *copy,
				 const struct gz_log *log)
{
	struct gz_scene_settings settings;
	bool has_display;
	enum gz_result result =
		gz_scene_parse(copy, text->bytes, text->length, log, &settings, &has_display);
	if (result == GZ_OK)
		result = check_file(scene, copy, "volume.file", settings.volume_file, log);
	if (result == GZ_OK)
		result = check_file(scene, copy, "transfer.file", settings.transfer_file, log);
	if (result == GZ_OK)
		result = check_file(scene, copy, "foveation.table", settings.foveation.table_file,
				    log);
	return result;
}

enum gz_result gz_scene_copy_with(const char *scene, const char *copy,
				  const struct gz_study_variant *variant, const struct gz_log *log)
{
	struct gz_text text = { 0 };
	if (access(copy, F_OK) == 0) {
		gz_err(log, "%s is there already: name another file, or remove it", copy);
		return GZ_ERR_BUSY;
	}
	enum gz_result result = gz_text_add_file(&text, scene);
	if (result != GZ_OK)
		gz_err(log, "%s: cannot be read (%s): --scene takes the path of the scene, too",
		       scene, gz_result_text(result));
	if (result == GZ_OK)
		result = gz_scene_text_set_variant(&text, variant, log);
	if (result == GZ_OK && !text.failed)
		result = check_copy(&text, scene, copy, log);
	if (result == GZ_OK)
		result = gz_text_write(&text, copy, log);
	gz_text_free(&text);
	return result;
}
