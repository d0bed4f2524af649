#include "client/gazectl/inspect/log_pipeline.h"

#include <stdio.h>

#define GZ_LOG_MODULE "pipeline"

/* The settings that the log was recorded with, where this pipeline knows them. */
static struct gz_pipeline_params recorded_params(const struct gz_gaze_log_header *header,
						 const struct gz_log *log)
{
	struct gz_pipeline_params params = gz_pipeline_default_params();
	const struct gz_option_binding binding = {
		.options = gz_pipeline_options,
		.count = gz_pipeline_option_count,
		.target = &params,
	};
	for (size_t i = 0; i < header->setting_count; i++) {
		char key[GZ_NAME_SIZE + 16], message[256] = "unknown";
		snprintf(key, sizeof key, "pipeline.%s", header->settings[i].key);
		const struct gz_option *option = gz_options_find(&binding, 1, key, NULL);
		if (!option || gz_option_parse(option, header->settings[i].value, &params, message,
					       sizeof message) != GZ_OK)
			gz_warn(log, "%s %s: %s; the default stands in", key,
				header->settings[i].value, message);
	}
	char reason[256];
	if (gz_pipeline_check_params(&params, reason, sizeof reason) != GZ_OK) {
		gz_warn(log, "%s; the default stands in", reason);
		params.correct = gz_pipeline_default_params().correct;
	}
	return params;
}

void gz_log_pipeline_init(struct gz_pipeline *pipeline, const struct gz_gaze_log_header *header,
			  const struct gz_log *log)
{
	struct gz_pipeline_params params = recorded_params(header, log);
	struct gz_display display = gz_display_default(1920, 1080);
	if (header->has_display)
		display = header->display;
	gz_pipeline_init(pipeline, &params, &display);
}
