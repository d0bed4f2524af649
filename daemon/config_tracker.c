/* Settings that depend on the tracker or on a recording: display, pipeline, stored correction; and
 * the directory for recordings. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/text.h"
#include "daemon/config.h"
#include "protocol/correction_file.h"
#include "protocol/validated_file.h"

#define GZ_LOG_MODULE "config"

/* Size of the display in pixels if no source gives it. */
enum { DEFAULT_WIDTH_PX = 1920, DEFAULT_HEIGHT_PX = 1080 };

struct gz_display gz_config_display(const struct gz_config *config,
				    const struct gz_device_info *info)
{
	/* The display of a recording is the one it was made on, so the configuration file does not
	 * count. */
	bool fixed = info->recorded && info->has_display;
	bool px = config->display_px[0] > 0 && config->display_px[1] > 0 &&
		  (!fixed || config->display_given[0]);
	bool mm = config->display_mm[0] > 0 && config->display_mm[1] > 0 &&
		  (!fixed || config->display_given[1]);
	bool distance = config->distance_mm > 0 && (!fixed || config->display_given[2]);
	struct gz_display display =
		gz_display_default(px ? config->display_px[0] : DEFAULT_WIDTH_PX,
				   px ? config->display_px[1] : DEFAULT_HEIGHT_PX);
	if (info->has_display)
		display = info->display;
	if (px)
		memcpy(display.px, config->display_px, sizeof display.px);
	if (mm)
		memcpy(display.mm, config->display_mm, sizeof display.mm);
	if (distance)
		display.distance_mm = config->distance_mm;
	return display;
}

static enum gz_result apply_recorded_setting(const struct gz_config *config,
					     const struct gz_gaze_log_setting *setting,
					     const struct gz_log *log,
					     struct gz_pipeline_params *params)
{
	char key[GZ_NAME_SIZE + sizeof "pipeline."];
	char message[256];
	if (strcmp(setting->key, GZ_PIPELINE_FORESTS_KEY) == 0)
		return GZ_OK;
	snprintf(key, sizeof key, "pipeline.%s", setting->key);
	struct gz_option_binding binding = { gz_pipeline_options, gz_pipeline_option_count, params,
					     NULL };
	const struct gz_option *option = gz_options_find(&binding, 1, key, NULL);
	if (!option) {
		gz_warn(log,
			"the recording has the setting %s %s, which this version does not know; it "
			"is ignored",
			key, setting->value);
		return GZ_OK;
	}
	if (config->pipeline_given[option - gz_pipeline_options])
		return GZ_OK;
	if (gz_option_parse(option, setting->value, params, message, sizeof message) == GZ_OK)
		return GZ_OK;
	gz_err(log, "setting %s of the recording: %s; override it with --%s", key, message, key);
	return GZ_ERR_FORMAT;
}

/* Whether the command line gives a setting; it then overrides the recorded or stored one. */
static bool given_on_command_line(const struct gz_config *config, const char *key)
{
	for (size_t i = 0; i < gz_pipeline_option_count; i++)
		if (config->pipeline_given[i] && strcmp(gz_pipeline_options[i].key, key) == 0)
			return true;
	return false;
}

enum gz_result gz_config_pipeline(const struct gz_config *config,
				  const struct gz_gaze_log_header *recorded,
				  const struct gz_log *log, struct gz_pipeline_params *out_params)
{
	struct gz_pipeline_params params = config->pipeline;
	if (recorded && recorded->setting_count > 0 &&
	    !given_on_command_line(config, "pipeline.labels"))
		params.classify.source = gz_pipeline_unnamed_params(recorded).classify.source;
	for (size_t i = 0; recorded && i < recorded->setting_count; i++) {
		enum gz_result result =
			apply_recorded_setting(config, &recorded->settings[i], log, &params);
		if (result != GZ_OK)
			return result;
	}
	char message[256];
	enum gz_result checked = gz_pipeline_check_params(&params, message, sizeof message);
	if (checked != GZ_OK) {
		gz_err(log, "%s", message);
		return checked;
	}
	if (recorded)
		(void)gz_pipeline_other_forests(recorded, &params, "the recording", log);
	*out_params = params;
	return GZ_OK;
}

void gz_config_describe_pipeline(const struct gz_pipeline_params *params,
				 struct gz_gaze_log_header *header)
{
	static const char prefix[] = "pipeline.";
	header->setting_count = 0;
	for (size_t i = 0; i < gz_pipeline_option_count && i + 1 < GZ_GAZE_LOG_SETTINGS_MAX; i++) {
		const struct gz_option *option = &gz_pipeline_options[i];
		struct gz_gaze_log_setting *setting = &header->settings[header->setting_count];
		snprintf(setting->key, sizeof setting->key, "%s", option->key + sizeof prefix - 1);
		if (gz_option_format(option, params, setting->value, sizeof setting->value) ==
		    GZ_OK)
			header->setting_count++;
	}
	struct gz_gaze_log_setting *forests = &header->settings[header->setting_count++];
	snprintf(forests->key, sizeof forests->key, "%s", GZ_PIPELINE_FORESTS_KEY);
	gz_pipeline_name_forests(forests->value);
}

/* Take the correction from its file in @p directory. @return whether it is used */
static bool take_correction_from(const char *directory, const struct gz_device_info *info,
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
		       "%s: measured with another tracker or display, so it is not used; measure "
		       "again with gazectl validate --correct",
		       path);
		return false;
	}
	memcpy(correct.x, file.x, sizeof correct.x);
	memcpy(correct.y, file.y, sizeof correct.y);
	if (!gz_correct_usable(&correct)) {
		gz_err(log,
		       "%s: the correction maps the display to a line or a point, so it is not "
		       "used; measure again with gazectl validate --correct",
		       path);
		return false;
	}
	params->correct = correct;
	gz_info(log, "gaze is corrected with %s", path);
	return true;
}

void gz_config_correction(const struct gz_config *config, const struct gz_device_info *info,
			  const struct gz_display *display, const struct gz_log *log,
			  struct gz_pipeline_params *params)
{
	char directory[GZ_PATH_SIZE];
	if (info->recorded ||
	    (given_on_command_line(config, "pipeline.correction.x") ||
	     given_on_command_line(config, "pipeline.correction.y")) ||
	    strcmp(config->corrections, "none") == 0)
		return;
	if (config->corrections[0]) {
		take_correction_from(config->corrections, info, display, log, params);
		return;
	}
	if (gz_correction_directory(directory, sizeof directory) == GZ_OK &&
	    take_correction_from(directory, info, display, log, params))
		return;
	take_correction_from(GAZECAST_SYSCONFDIR "/gazecast/corrections", info, display, log,
			     params);
}

static bool read_validated_from(const char *directory, const struct gz_device_info *info,
				const struct gz_log *log, struct gz_validated *out_validated)
{
	char path[2 * GZ_PATH_SIZE];
	struct gz_validated validated;
	if (gz_validated_path(directory, info->name, info->serial, path, sizeof path) != GZ_OK ||
	    gz_validated_read(path, log, &validated) != GZ_OK)
		return false;
	if (!gz_validated_fits(&validated, info->name, info->serial)) {
		gz_err(log, "%s: it is of another tracker, so it is ignored; run gazectl validate",
		       path);
		return false;
	}
	*out_validated = validated;
	return true;
}

bool gz_config_validated(const struct gz_config *config, const struct gz_device_info *info,
			 const struct gz_log *log, struct gz_validated *out_validated)
{
	char directory[GZ_PATH_SIZE];
	if (info->recorded || strcmp(config->corrections, "none") == 0)
		return false;
	if (config->corrections[0])
		return read_validated_from(config->corrections, info, log, out_validated);
	if (gz_correction_directory(directory, sizeof directory) == GZ_OK &&
	    read_validated_from(directory, info, log, out_validated))
		return true;
	return read_validated_from(GAZECAST_SYSCONFDIR "/gazecast/corrections", info, log,
				   out_validated);
}

/* The user's data directory (XDG base directory specification). */
static bool user_data_directory(char *text, size_t size)
{
	const char *data = getenv("XDG_DATA_HOME");
	const char *home = getenv("HOME");
	int length = -1;
	if (data && data[0] == '/')
		length = snprintf(text, size, "%s/gazecast", data);
	else if (home && home[0] == '/')
		length = snprintf(text, size, "%s/.local/share/gazecast", home);
	return length > 0 && (size_t)length < size;
}

/* Make a directory and its parents, 0700: recordings are private. */
static bool make_private_directories(char *path)
{
	for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
		*slash = '\0';
		bool made = mkdir(path, 0700) == 0 || errno == EEXIST;
		*slash = '/';
		if (!made)
			return false;
	}
	return mkdir(path, 0700) == 0 || errno == EEXIST;
}

static bool is_recording_directory(const char *path)
{
	struct stat status;
	return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

enum gz_result gz_config_recording_directory(const struct gz_config *config,
					     const struct gz_log *log, char *text, size_t size)
{
	if (config->recording_directory[0]) {
		/* The whole path: clients that are told it run in other folders. */
		char *whole = realpath(config->recording_directory, NULL);
		const bool good = whole && is_recording_directory(whole) &&
				  gz_text_print(text, size, "%s", whole) == GZ_OK;
		free(whole);
		if (good)
			return GZ_OK;
		gz_err(log,
		       "recording.directory: %s is not a directory; create it, or name another",
		       config->recording_directory);
		return GZ_ERR_NOT_FOUND;
	}
	if (user_data_directory(text, size) && make_private_directories(text) &&
	    is_recording_directory(text))
		return GZ_OK;
	gz_err(log, "cannot create a directory for recordings in the user's data directory; name "
		    "one with --recording.directory DIR");
	return GZ_ERR_NOT_FOUND;
}
