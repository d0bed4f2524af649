#include "daemon/config.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define GZ_LOG_MODULE "config"

static const char *const tcp_names[] = { "off", "loopback", NULL };

#define AT(field) offsetof(struct gz_config, field)

static const struct gz_option options[] = {
	{ "config", GZ_OPTION_STRING, AT(file), 0, GZ_PATH_SIZE, 0, NULL, "",
	  "configuration file" },
	{ "help", GZ_OPTION_BOOL, AT(help), 0, 0, 0, NULL, "false", "print this and leave" },
	{ "version", GZ_OPTION_BOOL, AT(version), 0, 0, 0, NULL, "false",
	  "print the version and leave" },
	{ "print-config", GZ_OPTION_BOOL, AT(print_config), 0, 0, 0, NULL, "false",
	  "print a configuration file with the present settings and leave" },
	{ "driver", GZ_OPTION_STRING, AT(driver), 0, GZ_NAME_SIZE, 0, NULL, NULL,
	  "short for --tracker.driver" },
	{ "tracker", GZ_OPTION_STRING, AT(tracker), 0, GZ_NAME_SIZE, 0, NULL, NULL,
	  "short for --tracker.choice" },
	{ "tcp", GZ_OPTION_CHOICE, AT(tcp), 0, 0, 0, tcp_names, NULL, "short for --network.tcp" },
	{ "control", GZ_OPTION_STRING, AT(control), 0, GZ_ENDPOINT_SIZE, 0, NULL, NULL,
	  "short for --network.control" },
	{ "record", GZ_OPTION_STRING, AT(record), 0, GZ_NAME_SIZE, 0, NULL, "",
	  "record from the first sample under this name" },
	{ "exit-at-end", GZ_OPTION_BOOL, AT(exit_at_end), 0, 0, 0, NULL, "false",
	  "leave when a replay is over" },
	{ "wait-readers", GZ_OPTION_INT, AT(wait_readers), 0, 1000, 0, NULL, "0",
	  "start the tracker once the stream has so many subscriptions" },
	{ "tracker.driver", GZ_OPTION_STRING, AT(driver), 0, GZ_NAME_SIZE, 0, NULL, "sim",
	  "which driver; `gazectl devices` lists the trackers that are there" },
	{ "tracker.choice", GZ_OPTION_STRING, AT(tracker), 0, GZ_NAME_SIZE, 0, NULL, "",
	  "name or serial number of the tracker, where there are several; empty: the first" },
	{ "network.tcp", GZ_OPTION_CHOICE, AT(tcp), 0, 0, 0, tcp_names, "loopback",
	  "TCP for Pupil's clients, open to every user of this machine; or local sockets only" },
	{ "network.control", GZ_OPTION_STRING, AT(control), 0, GZ_ENDPOINT_SIZE, 0, NULL,
	  GZ_CONTROL_TCP_ENDPOINT, "where Pupil Remote's letters are taken; a loopback address" },
	{ "stream.surfaces", GZ_OPTION_STRING, AT(surfaces), 0, 256, 0, NULL,
	  "screen psychopy_iohub_surface", "names that the screen is published under; at most 8" },
	{ "recording.directory", GZ_OPTION_STRING, AT(recording_directory), 0, GZ_PATH_SIZE, 0,
	  NULL, "", "where recordings go; empty: gazecast in the user's data directory" },
	{ "display.px", GZ_OPTION_SIZE, AT(display_px), 0, 32768, 0, NULL, "0x0",
	  "the display, pixels; 0x0: as the tracker says, else 1920x1080" },
	{ "display.mm", GZ_OPTION_DOUBLE, AT(display_mm), 0, 100000, 2, NULL, "0 0",
	  "its width and height, mm; 0 0: as the tracker says, else 50.4 degrees wide" },
	{ "display.distance_mm", GZ_OPTION_DOUBLE, AT(distance_mm), 0, 100000, 0, NULL, "0",
	  "from the eyes to its centre, mm; 0: as the tracker says, else 600" },
};

enum { OPTION_COUNT = sizeof options / sizeof *options };
enum { BINDINGS_MAX = 2 + GZ_CONFIG_DRIVERS_MAX };

/* The tables that make up the configuration, bound to @p config. */
static size_t bind(struct gz_config *config, bool *own_given, bool *pipeline_given,
		   struct gz_option_binding *bindings)
{
	size_t count = 0;
	bindings[count++] = (struct gz_option_binding) { options, OPTION_COUNT, config, own_given };
	bindings[count++] =
		(struct gz_option_binding) { gz_pipeline_options, gz_pipeline_option_count,
					     &config->pipeline, pipeline_given };
	for (size_t i = 0; i < GZ_CONFIG_DRIVERS_MAX && gz_drivers[i]; i++) {
		if (!gz_drivers[i]->options)
			continue;
		bindings[count++] =
			(struct gz_option_binding) { gz_drivers[i]->options,
						     *gz_drivers[i]->option_count,
						     config->driver_settings[i].bytes, NULL };
	}
	return count;
}

static enum gz_result set_presets(struct gz_config *config)
{
	struct gz_option_binding bindings[BINDINGS_MAX];
	*config = (struct gz_config) { 0 };
	size_t count = bind(config, NULL, NULL, bindings);
	for (size_t i = 0; i < count; i++) {
		enum gz_result result = gz_options_preset(&bindings[i]);
		if (result != GZ_OK)
			return result;
	}
	return GZ_OK;
}

static bool find_file(char *path, size_t size)
{
	const char *home = getenv("HOME");
	const char *configuration = getenv("XDG_CONFIG_HOME");
	int length = 0;
	if (configuration && configuration[0] == '/')
		length = snprintf(path, size, "%s/gazecast/gazed.conf", configuration);
	else if (home && home[0] == '/')
		length = snprintf(path, size, "%s/.config/gazecast/gazed.conf", home);
	if (length > 0 && (size_t)length < size && access(path, F_OK) == 0)
		return true;
	length = snprintf(path, size, "%s/gazecast/gazed.conf", GAZECAST_SYSCONFDIR);
	return length > 0 && (size_t)length < size && access(path, F_OK) == 0;
}

static enum gz_result read_file(struct gz_config *config, const char *chosen,
				const struct gz_log *log)
{
	char path[GZ_PATH_SIZE];
	struct gz_option_binding bindings[BINDINGS_MAX];
	size_t count = bind(config, NULL, NULL, bindings);
	if (chosen[0])
		return gz_options_read_file(bindings, count, chosen, log);
	if (!find_file(path, sizeof path))
		return GZ_OK;
	gz_info(log, "configuration from %s", path);
	return gz_options_read_file(bindings, count, path, log);
}

/* Whether option @p key was given; the key is one of this file's table. */
static bool given(const bool *own_given, const char *key)
{
	for (size_t i = 0; i < OPTION_COUNT; i++) {
		if (strcmp(options[i].key, key) == 0)
			return own_given[i];
	}
	return false;
}

static enum gz_result read_arguments(struct gz_config *config, int argc, char *const *argv,
				     const struct gz_log *log)
{
	static const char *const shorts[][2] = { { "driver", "tracker.driver" },
						 { "tracker", "tracker.choice" },
						 { "tcp", "network.tcp" },
						 { "control", "network.control" } };
	struct gz_option_binding bindings[BINDINGS_MAX];
	bool own_given[OPTION_COUNT] = { false };
	memset(config->pipeline_given, 0, sizeof config->pipeline_given);
	size_t count = bind(config, own_given, config->pipeline_given, bindings);
	enum gz_result result =
		gz_options_read_arguments(bindings, count, argc, argv, NULL, NULL, log);
	if (result != GZ_OK)
		return result;
	for (size_t i = 0; i < sizeof shorts / sizeof *shorts; i++) {
		if (given(own_given, shorts[i][0]) && given(own_given, shorts[i][1])) {
			gz_err(log, "--%s: given twice, as --%s too; keep one", shorts[i][1],
			       shorts[i][0]);
			return GZ_ERR_INVAL;
		}
	}
	config->display_given[0] = given(own_given, "display.px");
	config->display_given[1] = given(own_given, "display.mm");
	config->display_given[2] = given(own_given, "display.distance_mm");
	return GZ_OK;
}

static bool is_surface_name(const char *word, size_t length)
{
	for (size_t i = 0; i < length; i++) {
		if (!isalnum((unsigned char)word[i]) && !strchr("._-", word[i]))
			return false;
	}
	return length > 0 && length < GZ_NAME_SIZE;
}

static enum gz_result split_surfaces(struct gz_config *config, const struct gz_log *log)
{
	const char *word = config->surfaces;
	for (;;) {
		word += strspn(word, " \t");
		size_t length = strcspn(word, " \t");
		if (length == 0)
			return GZ_OK;
		if (!is_surface_name(word, length)) {
			gz_err(log,
			       "stream.surfaces: %.*s is no name; allowed: letters, digits, . _ -, "
			       "at most %d bytes",
			       (int)length, word, GZ_NAME_SIZE - 1);
			return GZ_ERR_INVAL;
		}
		if (config->surface_count == GZ_SURFACES_MAX) {
			gz_err(log, "stream.surfaces: more than %d names; leave some out",
			       GZ_SURFACES_MAX);
			return GZ_ERR_INVAL;
		}
		memcpy(config->surface[config->surface_count], word, length);
		config->surface[config->surface_count++][length] = '\0';
		word += length;
	}
}

/* Gaze is biometric data: nothing but this machine may reach an endpoint without keys. */
static bool is_loopback(const char *endpoint)
{
	static const char *const allowed[] = { "tcp://127.", "tcp://localhost:", "tcp://[::1]:" };
	for (size_t i = 0; i < sizeof allowed / sizeof *allowed; i++) {
		if (strncmp(endpoint, allowed[i], strlen(allowed[i])) == 0)
			return true;
	}
	return false;
}

static void list_drivers(char *text, size_t size)
{
	size_t used = 0;
	for (size_t i = 0; gz_drivers[i] && used < size; i++) {
		int n = snprintf(text + used, size - used, "%s%s", i > 0 ? ", " : "",
				 gz_drivers[i]->name);
		used += n > 0 ? (size_t)n : 0;
	}
}

static enum gz_result check(struct gz_config *config, const struct gz_log *log)
{
	if (!gz_driver_find(config->driver)) {
		char names[256];
		list_drivers(names, sizeof names);
		gz_err(log, "tracker.driver: no driver %s; allowed: %s", config->driver, names);
		return GZ_ERR_INVAL;
	}
	if (config->tcp == GZ_TCP_LOOPBACK && !is_loopback(config->control)) {
		gz_err(log,
		       "network.control: %s is no loopback address, and others may not listen in; "
		       "use tcp://127.0.0.1:PORT, or --tcp off for local sockets only",
		       config->control);
		return GZ_ERR_INVAL;
	}
	char message[256];
	if (gz_pipeline_check_params(&config->pipeline, message, sizeof message) != GZ_OK) {
		gz_err(log, "%s", message);
		return GZ_ERR_INVAL;
	}
	return split_surfaces(config, log);
}

enum gz_result gz_config_read(int argc, char *const *argv, const struct gz_log *log,
			      struct gz_config *out_config)
{
	char file[GZ_PATH_SIZE];
	/* Once to learn which file to read, and again because the command line has the last word.
	 */
	enum gz_result result = set_presets(out_config);
	if (result == GZ_OK)
		result = read_arguments(out_config, argc, argv, log);
	if (result != GZ_OK || out_config->help || out_config->version)
		return result;
	memcpy(file, out_config->file, sizeof file);
	result = set_presets(out_config);
	if (result == GZ_OK)
		result = read_file(out_config, file, log);
	if (result == GZ_OK)
		result = read_arguments(out_config, argc, argv, log);
	return result == GZ_OK ? check(out_config, log) : result;
}

void gz_config_print_help(struct gz_config *config, FILE *out)
{
	struct gz_option_binding bindings[BINDINGS_MAX];
	fputs("usage: gazed [--key value]...\n\n"
	      "The gaze daemon: reads an eye tracker, publishes where the eye rests, and records.\n"
	      "Keys with a dot may also stand in the configuration file.\n\n",
	      out);
	gz_options_print_help(bindings, bind(config, NULL, NULL, bindings), out);
}

void gz_config_print_file(struct gz_config *config, FILE *out)
{
	struct gz_option_binding bindings[BINDINGS_MAX];
	fputs("; Configuration of gazed. The command line takes the same keys as --section.name "
	      "and "
	      "has the last word.\n\n",
	      out);
	gz_options_print_file(bindings, bind(config, NULL, NULL, bindings), out);
}

const struct gz_driver *gz_config_driver(const struct gz_config *config, const void **out_settings)
{
	size_t i = 0;
	while (strcmp(gz_drivers[i]->name, config->driver) != 0)
		i++;
	*out_settings = config->driver_settings[i].bytes;
	return gz_drivers[i];
}
