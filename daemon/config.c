#include "daemon/config.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "daemon/config_check.h"

#define GZ_LOG_MODULE "config"

static const char *const tcp_names[] = { "off", "loopback", "curve", NULL };

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
	  "which driver; auto: that of the tracker that is there, see `gazectl devices`" },
	{ "tracker.choice", GZ_OPTION_STRING, AT(tracker), 0, GZ_NAME_SIZE, 0, NULL, "",
	  "name or serial number of the tracker, where there are several; empty: the first" },
	{ "tracker.corrections", GZ_OPTION_STRING, AT(corrections), 0, GZ_PATH_SIZE, 0, NULL, "",
	  "directory of the corrections that gazectl validate stores; empty: gazecast/corrections "
	  "in "
	  "the user's and the system's configuration; none: they are not used" },
	{ "network.tcp", GZ_OPTION_CHOICE, AT(tcp), 0, 0, 0, tcp_names, "loopback",
	  "loopback: for Pupil's clients and every user of this machine; curve: for clients with a "
	  "key, also on other machines; off: local sockets only" },
	{ "network.address", GZ_OPTION_STRING, AT(address), 0, GZ_NAME_SIZE, 0, NULL, "127.0.0.1",
	  "this machine's address that TCP is bound to, * for all; another than loopback takes tcp "
	  "= "
	  "curve" },
	{ "network.control", GZ_OPTION_STRING, AT(control), 0, GZ_ENDPOINT_SIZE, 0, NULL, "",
	  "where Pupil Remote's letters are taken, tcp://ADDRESS:PORT; empty: port 50020 of the "
	  "address above" },
	{ "network.stream_port", GZ_OPTION_INT, AT(stream_port), 0, 65535, 0, NULL, "0",
	  "TCP port of the stream; 0: the system chooses, and SUB_PORT tells" },
	{ "network.latest_port", GZ_OPTION_INT, AT(latest_port), 0, 65535, 0, NULL, "0",
	  "TCP port of the latest gaze; 0: the system chooses, and LATEST_PORT tells" },
	{ "network.inlet_port", GZ_OPTION_INT, AT(inlet_port), 0, 65535, 0, NULL, "0",
	  "TCP port for clients' messages; 0: the system chooses, and PUB_PORT tells" },
	{ "network.keys", GZ_OPTION_STRING, AT(key_directory), 0, GZ_PATH_SIZE, 0, NULL, "",
	  "directory of server_key and authorized_keys; empty: gazecast in the user's "
	  "configuration directory, else in the system's" },
	{ "daemon.user", GZ_OPTION_STRING, AT(user), 0, GZ_NAME_SIZE, 0, NULL, "",
	  "user to become where root has started the daemon; empty: stay who started it" },
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
_Static_assert(OPTION_COUNT <= GZ_CONFIG_OPTIONS_MAX, "room for what was given");
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
	struct gz_option_binding bindings[BINDINGS_MAX];
	size_t count = bind(config, NULL, NULL, bindings);
	char *path = config->file_read;
	if (chosen[0])
		snprintf(path, sizeof config->file_read, "%s", chosen);
	else if (find_file(path, sizeof config->file_read))
		gz_info(log, "configuration from %s", path);
	else
		path[0] = '\0';
	return path[0] ? gz_options_read_file(bindings, count, path, log) : GZ_OK;
}

bool gz_config_given(const struct gz_config *config, const char *key)
{
	for (size_t i = 0; i < OPTION_COUNT; i++) {
		if (strcmp(options[i].key, key) == 0)
			return config->own_given[i];
	}
	return false;
}

static void set_given(struct gz_config *config, const char *key)
{
	for (size_t i = 0; i < OPTION_COUNT; i++)
		config->own_given[i] = config->own_given[i] || strcmp(options[i].key, key) == 0;
}

static enum gz_result read_arguments(struct gz_config *config, int argc, char *const *argv,
				     const struct gz_log *log)
{
	static const char *const shorts[][2] = { { "driver", "tracker.driver" },
						 { "tracker", "tracker.choice" },
						 { "tcp", "network.tcp" },
						 { "control", "network.control" } };
	struct gz_option_binding bindings[BINDINGS_MAX];
	memset(config->own_given, 0, sizeof config->own_given);
	memset(config->pipeline_given, 0, sizeof config->pipeline_given);
	size_t count = bind(config, config->own_given, config->pipeline_given, bindings);
	enum gz_result result =
		gz_options_read_arguments(bindings, count, argc, argv, NULL, NULL, log);
	if (result != GZ_OK)
		return result;
	for (size_t i = 0; i < sizeof shorts / sizeof *shorts; i++) {
		if (gz_config_given(config, shorts[i][0]) &&
		    gz_config_given(config, shorts[i][1])) {
			gz_err(log, "--%s: given twice, as --%s too; keep one", shorts[i][1],
			       shorts[i][0]);
			return GZ_ERR_INVAL;
		}
		if (gz_config_given(config, shorts[i][0]))
			set_given(config, shorts[i][1]);
	}
	config->display_given[0] = gz_config_given(config, "display.px");
	config->display_given[1] = gz_config_given(config, "display.mm");
	config->display_given[2] = gz_config_given(config, "display.distance_mm");
	return GZ_OK;
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
	if (result == GZ_OK)
		result = gz_config_check_arguments(out_config, argc, argv, log);
	return result == GZ_OK ? gz_config_check(out_config, log) : result;
}

void gz_config_print_help(struct gz_config *config, FILE *out)
{
	struct gz_option_binding bindings[BINDINGS_MAX];
	fputs("usage: gazed [--key value]...\n\n"
	      "The gaze daemon: reads an eye tracker, publishes where the eye rests, and records.\n"
	      "Keys with a dot may also stand in the configuration file.\n\n",
	      out);
	gz_options_print_help(bindings, bind(config, NULL, NULL, bindings), out);
	fputs("\ndrivers:\n", out);
	for (size_t i = 0; gz_drivers[i]; i++)
		fprintf(out, "  %-10s %s\n", gz_drivers[i]->name, gz_drivers[i]->help);
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

void gz_config_all_settings(const struct gz_config *config,
			    const void *out_settings[GZ_CONFIG_DRIVERS_MAX])
{
	for (size_t i = 0; i < GZ_CONFIG_DRIVERS_MAX; i++)
		out_settings[i] = config->driver_settings[i].bytes;
}

const struct gz_driver *gz_config_driver(const struct gz_config *config, const void **out_settings)
{
	size_t i = 0;
	while (strcmp(gz_drivers[i]->name, config->driver) != 0)
		i++;
	*out_settings = config->driver_settings[i].bytes;
	return gz_drivers[i];
}
