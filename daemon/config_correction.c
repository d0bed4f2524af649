/* The stored correction of a tracker's gaze, as gazectl validate leaves it. */
#include <string.h>

#include "daemon/config.h"
#include "protocol/correction_file.h"

#define GZ_LOG_MODULE "config"

/* Whether the command line says how to correct: it has the last word. */
static bool is_given(const struct gz_config *config)
{
	for (size_t i = 0; i < gz_pipeline_option_count; i++) {
		const char *key = gz_pipeline_options[i].key;
		if (config->pipeline_given[i] && (strcmp(key, "pipeline.correction.x") == 0 ||
						  strcmp(key, "pipeline.correction.y") == 0))
			return true;
	}
	return false;
}

/* The file in @p directory; whether it could be used. */
static bool take_from(const char *directory, const struct gz_device_info *info,
		      const struct gz_display *display, const struct gz_log *log,
		      struct gz_pipeline_params *params)
{
	char path[2 * GZ_PATH_SIZE];
	struct gz_correction_file file;
	struct gz_correct_params correct;
	if (gz_correction_path(directory, info->name, info->serial, display, path, sizeof path) !=
		    GZ_OK ||
	    gz_correction_read(path, log, &file) != GZ_OK)
		return false;
	if (!gz_correction_fits(&file, info->name, info->serial, display)) {
		gz_err(log,
		       "%s: measured with another tracker or display, and not used; measure it "
		       "anew with gazectl validate --correct",
		       path);
		return false;
	}
	memcpy(correct.x, file.x, sizeof correct.x);
	memcpy(correct.y, file.y, sizeof correct.y);
	if (!gz_correct_usable(&correct)) {
		gz_err(log,
		       "%s: the map leaves no area, and is not used; measure it anew with gazectl "
		       "validate --correct",
		       path);
		return false;
	}
	params->correct = correct;
	gz_info(log, "gaze is corrected by %s", path);
	return true;
}

void gz_config_correction(const struct gz_config *config, const struct gz_device_info *info,
			  const struct gz_display *display, const struct gz_log *log,
			  struct gz_pipeline_params *params)
{
	char directory[GZ_PATH_SIZE];
	if (info->recorded || is_given(config) || strcmp(config->corrections, "none") == 0)
		return;
	if (config->corrections[0]) {
		take_from(config->corrections, info, display, log, params);
		return;
	}
	if (gz_correction_directory(directory, sizeof directory) == GZ_OK &&
	    take_from(directory, info, display, log, params))
		return;
	take_from(GAZECAST_SYSCONFDIR "/gazecast/corrections", info, display, log, params);
}
