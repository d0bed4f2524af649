#include "filter/recorded.h"

#include <stdio.h>

#define GZ_LOG_MODULE "pipeline"

/* One "#pipeline." line; a setting that this version does not have changes nothing here. */
static enum gz_result take_setting(const struct gz_gaze_log_setting *setting, const char *path,
				   const struct gz_log *log, struct gz_pipeline_params *params)
{
	const struct gz_option_binding binding = { gz_pipeline_options, gz_pipeline_option_count,
						   params, NULL };
	char key[GZ_NAME_SIZE + sizeof "pipeline."];
	char message[256];
	snprintf(key, sizeof key, "pipeline.%s", setting->key);
	const struct gz_option *option = gz_options_find(&binding, 1, key, NULL);
	if (!option) {
		gz_warn(log, "%s: #%s %s: this version has no such setting; going on without", path,
			key, setting->value);
		return GZ_OK;
	}
	if (gz_option_parse(option, setting->value, params, message, sizeof message) == GZ_OK)
		return GZ_OK;
	gz_err(log, "%s: #%s: %s; correct the line to play the log", path, key, message);
	return GZ_ERR_FORMAT;
}

enum gz_result gz_pipeline_recorded_params(const struct gz_gaze_log_header *header,
					   const char *path, const struct gz_log *log,
					   struct gz_pipeline_params *out_params)
{
	struct gz_pipeline_params params = gz_pipeline_default_params();
	for (size_t i = 0; i < header->setting_count; i++) {
		const enum gz_result result =
			take_setting(&header->settings[i], path, log, &params);
		if (result != GZ_OK)
			return result;
	}
	char message[256];
	if (gz_pipeline_check_params(&params, message, sizeof message) != GZ_OK) {
		gz_err(log, "%s: %s", path, message);
		return GZ_ERR_FORMAT;
	}
	*out_params = params;
	return GZ_OK;
}
