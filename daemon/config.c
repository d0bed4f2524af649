#include "daemon/config.h"

#include <arpa/inet.h>
#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define GZ_LOG_MODULE "config"

/* Port of the control socket if none is given: that of Pupil Remote. */
enum { CONTROL_PORT = 50020 };

/* Greatest ratio of a pixel's sides. Chosen: no display comes near it. */
#define PIXEL_ASPECT_MAX 2.0

static const char *const tcp_names[] = { "off", "loopback", "curve", NULL };

#define AT(field) offsetof(struct gz_config, field)

static const struct gz_option options[] = {
	{ "config", GZ_OPTION_STRING, AT(file), 0, GZ_PATH_SIZE, 0, NULL, "",
	  "configuration file" },
	{ "help", GZ_OPTION_BOOL, AT(help), 0, 0, 0, NULL, "false", "print this help and exit" },
	{ "version", GZ_OPTION_BOOL, AT(version), 0, 0, 0, NULL, "false",
	  "print the version and exit" },
	{ "print-config", GZ_OPTION_BOOL, AT(print_config), 0, 0, 0, NULL, "false",
	  "print a configuration file with the present settings and exit" },
	{ "driver", GZ_OPTION_STRING, AT(driver), 0, GZ_NAME_SIZE, 0, NULL, NULL,
	  "short for --tracker.driver" },
	{ "tracker", GZ_OPTION_STRING, AT(tracker), 0, GZ_NAME_SIZE, 0, NULL, NULL,
	  "short for --tracker.choice" },
	{ "tcp", GZ_OPTION_CHOICE, AT(tcp), 0, 0, 0, tcp_names, NULL, "short for --network.tcp" },
	{ "control", GZ_OPTION_STRING, AT(control), 0, GZ_ENDPOINT_SIZE, 0, NULL, NULL,
	  "short for --network.control" },
	{ "record", GZ_OPTION_STRING, AT(record), 0, GZ_NAME_SIZE, 0, NULL, "",
	  "start a recording with this name before the first sample" },
	{ "exit-at-end", GZ_OPTION_BOOL, AT(exit_at_end), 0, 0, 0, NULL, "false",
	  "exit when a replay ends" },
	{ "wait-readers", GZ_OPTION_INT, AT(wait_readers), 0, 1000, 0, NULL, "0",
	  "start the tracker once the stream has this many subscriptions" },
	{ "tracker.driver", GZ_OPTION_STRING, AT(driver), 0, GZ_NAME_SIZE, 0, NULL, "sim",
	  "driver; auto: the driver of the tracker that is connected, see `gazectl devices`" },
	{ "tracker.choice", GZ_OPTION_STRING, AT(tracker), 0, GZ_NAME_SIZE, 0, NULL, "",
	  "name or serial number of the tracker, if several are connected; empty: the first one" },
	{ "tracker.corrections", GZ_OPTION_STRING, AT(corrections), 0, GZ_PATH_SIZE, 0, NULL, "",
	  "directory of the corrections that gazectl validate stores; empty: gazecast/corrections "
	  "in the user's and the system's configuration directory; none: use no corrections" },
	{ "network.tcp", GZ_OPTION_CHOICE, AT(tcp), 0, 0, 0, tcp_names, "loopback",
	  "TCP clients; loopback: Pupil clients and all users of this machine; curve: clients "
	  "with a key, also on other machines; off: none, local sockets only" },
	{ "network.address", GZ_OPTION_STRING, AT(address), 0, GZ_NAME_SIZE, 0, NULL, "127.0.0.1",
	  "address of this machine to which TCP is bound, * for all; an address other than "
	  "loopback needs tcp = curve" },
	{ "network.control", GZ_OPTION_STRING, AT(control), 0, GZ_ENDPOINT_SIZE, 0, NULL, "",
	  "endpoint for Pupil Remote requests, tcp://ADDRESS:PORT; empty: port 50020 of "
	  "network.address" },
	{ "network.stream_port", GZ_OPTION_INT, AT(stream_port), 0, 65535, 0, NULL, "0",
	  "TCP port of the stream; 0: the system chooses, and SUB_PORT returns it" },
	{ "network.latest_port", GZ_OPTION_INT, AT(latest_port), 0, 65535, 0, NULL, "0",
	  "TCP port of the latest gaze; 0: the system chooses, and LATEST_PORT returns it" },
	{ "network.inlet_port", GZ_OPTION_INT, AT(inlet_port), 0, 65535, 0, NULL, "0",
	  "TCP port for messages from clients; 0: the system chooses, and PUB_PORT returns it" },
	{ "network.keys", GZ_OPTION_STRING, AT(key_directory), 0, GZ_PATH_SIZE, 0, NULL, "",
	  "directory of server_key and authorized_keys; empty: gazecast in the user's "
	  "configuration directory, else in the system's" },
	{ "network.open_clients", GZ_OPTION_INT, AT(open_clients), 8, 4096, 0, NULL, "256",
	  "most clients of each TCP port without keys; the ports of the stream and of the latest "
	  "gaze count as one" },
	{ "network.trusted_clients", GZ_OPTION_INT, AT(trusted_clients), 8, 4096, 0, NULL, "1024",
	  "the same for each local socket, and for each TCP port with keys" },
	{ "network.trusted_topics", GZ_OPTION_INT, AT(trusted_topics), 256, 1048576, 0, NULL,
	  "16384",
	  "most bytes of topics that the daemon does not send to which all readers at the local "
	  "socket, or all with keys, may subscribe; one may have a quarter of it" },
	{ "daemon.user", GZ_OPTION_STRING, AT(user), 0, GZ_NAME_SIZE, 0, NULL, "",
	  "user that the daemon becomes when root starts it; empty: keep the user that started "
	  "it" },
	{ "stream.surfaces", GZ_OPTION_STRING, AT(surfaces), 0, 256, 0, NULL,
	  "screen psychopy_iohub_surface",
	  "surface names under which the screen is published; at most 8" },
	{ "viewers.still_scene", GZ_OPTION_BOOL, AT(viewers_still_scene), 0, 0, 0, NULL, "true",
	  "a viewer may say that nothing moves in its scene; there is no pursuit then" },
	{ "lsl.outlet", GZ_OPTION_BOOL, AT(lsl), 0, 0, 0, NULL, "false",
	  "offer the gaze and its events as streams of the Lab Streaming Layer, which every "
	  "machine on the network can read" },
	{ "lsl.library", GZ_OPTION_STRING, AT(lsl_library), 0, GZ_PATH_SIZE, 0, NULL, "liblsl.so",
	  "liblsl: a file, or a name that the dynamic linker looks up" },
	{ "lsl.name", GZ_OPTION_STRING, AT(lsl_name), 0, GZ_NAME_SIZE, 0, NULL, "Gazecast",
	  "name of the stream of gaze; that of events is this name and \"events\"" },
	{ "recording.directory", GZ_OPTION_STRING, AT(recording_directory), 0, GZ_PATH_SIZE, 0,
	  NULL, "", "directory for recordings; empty: gazecast in the user's data directory" },
	{ "display.px", GZ_OPTION_SIZE, AT(display_px), 0, 32768, 0, NULL, "0x0",
	  "size of the display, pixels; 0x0: as the tracker reports, else 1920x1080" },
	{ "display.mm", GZ_OPTION_DOUBLE, AT(display_mm), 0, 100000, 2, NULL, "0 0",
	  "width and height of the display, mm; 0 0: as the tracker reports, else 50.4 degrees "
	  "wide" },
	{ "display.distance_mm", GZ_OPTION_DOUBLE, AT(distance_mm), 0, 100000, 0, NULL, "0",
	  "distance from the eyes to the centre of the display, mm; 0: as the tracker reports, "
	  "else 600" },
};

enum { OPTION_COUNT = sizeof options / sizeof *options };
_Static_assert(OPTION_COUNT <= GZ_CONFIG_OPTIONS_MAX, "own_given has a flag for every option");
enum { BINDINGS_MAX = 2 + GZ_CONFIG_DRIVERS_MAX };

/* The tables that make up the configuration, bound to @p config: those of the daemon, of the
 * pipeline and of every driver. @return how many */
static size_t bind_config_tables(struct gz_config *config, bool *own_given, bool *pipeline_given,
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
	size_t count = bind_config_tables(config, NULL, NULL, bindings);
	for (size_t i = 0; i < count; i++) {
		enum gz_result result = gz_options_preset(&bindings[i]);
		if (result != GZ_OK)
			return result;
	}
	return GZ_OK;
}

static bool find_config_file(char *path, size_t size)
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

static enum gz_result read_config_file(struct gz_config *config, const char *chosen,
				       const struct gz_log *log)
{
	struct gz_option_binding bindings[BINDINGS_MAX];
	size_t count = bind_config_tables(config, NULL, NULL, bindings);
	char *path = config->file_read;
	if (chosen[0])
		snprintf(path, sizeof config->file_read, "%s", chosen);
	else if (find_config_file(path, sizeof config->file_read))
		gz_info(log, "reading configuration from %s", path);
	else
		path[0] = '\0';
	return path[0] ? gz_options_read_file(bindings, count, path, log) : GZ_OK;
}

/* Whether the command line gave @p key, one of the daemon's own. */
static bool given_on_command_line(const struct gz_config *config, const char *key)
{
	for (size_t i = 0; i < OPTION_COUNT; i++) {
		if (strcmp(options[i].key, key) == 0)
			return config->own_given[i];
	}
	return false;
}

static void mark_as_given(struct gz_config *config, const char *key)
{
	for (size_t i = 0; i < OPTION_COUNT; i++)
		config->own_given[i] = config->own_given[i] || strcmp(options[i].key, key) == 0;
}

/* What the checks below look at: settings that are each valid but contradict each other. */
struct check {
	struct gz_config *config;
	const struct gz_log *log;
};

/* Log where the setting @p key came from, what is wrong with it, and what to do. */
__attribute__((format(printf, 3, 4))) static enum gz_result refuse_setting(
	const struct check *check, const char *key, const char *format, ...)
{
	char what[768];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(what, sizeof what, format, arguments);
	va_end(arguments);
	const char *file = check->config->file_read;
	bool on_command_line = given_on_command_line(check->config, key);
	int line = file[0] && !on_command_line ? gz_options_file_line(file, key) : 0;
	if (line > 0)
		gz_err(check->log, "%s:%d: %s: %s", file, line, key, what);
	else
		gz_err(check->log, "%s%s: %s", on_command_line ? "--" : "", key, what);
	return GZ_ERR_INVAL;
}

static void list_driver_names(char *text, size_t size)
{
	size_t used = 0;
	for (size_t i = 0; gz_drivers[i] && used < size; i++) {
		int n = snprintf(text + used, size - used, "%s%s", i > 0 ? ", " : "",
				 gz_drivers[i]->name);
		used += n > 0 ? (size_t)n : 0;
	}
}

static enum gz_result check_driver(const struct check *check)
{
	char names[256];
	if (gz_driver_find(check->config->driver))
		return GZ_OK;
	list_driver_names(names, sizeof names);
	return refuse_setting(check, "tracker.driver", "there is no driver %s; allowed: %s",
			      check->config->driver, names);
}

static bool is_surface_name(const char *word, size_t length)
{
	for (size_t i = 0; i < length; i++) {
		if (!isalnum((unsigned char)word[i]) && !strchr("._-", word[i]))
			return false;
	}
	return length > 0 && length < GZ_NAME_SIZE;
}

static enum gz_result add_surface(const struct check *check, const char *word, size_t length)
{
	struct gz_config *config = check->config;
	if (!is_surface_name(word, length))
		return refuse_setting(
			check, "stream.surfaces",
			"%.*s is not a valid name; allowed: letters, digits, . _ -, at most %d "
			"bytes",
			(int)length, word, GZ_NAME_SIZE - 1);
	if (config->surface_count == GZ_SURFACES_MAX)
		return refuse_setting(check, "stream.surfaces", "more than %d names; remove some",
				      GZ_SURFACES_MAX);
	char *name = config->surface[config->surface_count];
	memcpy(name, word, length);
	name[length] = '\0';
	for (size_t i = 0; i < config->surface_count; i++) {
		if (strcmp(config->surface[i], name) == 0)
			return refuse_setting(check, "stream.surfaces",
					      "%s is given twice; keep one", name);
	}
	config->surface_count++;
	return GZ_OK;
}

static enum gz_result split_surfaces(const struct check *check)
{
	enum gz_result result = GZ_OK;
	const char *word = check->config->surfaces;
	check->config->surface_count = 0;
	for (size_t length; result == GZ_OK; word += length) {
		word += strspn(word, " \t");
		length = strcspn(word, " \t");
		if (length == 0)
			break;
		result = add_surface(check, word, length);
	}
	return result;
}

static enum gz_result check_display_sizes(const struct check *check)
{
	const struct gz_config *config = check->config;
	const int *px = config->display_px;
	const double *mm = config->display_mm;
	if ((px[0] > 0) != (px[1] > 0))
		return refuse_setting(
			check, "display.px",
			"%dx%d has one side only; give width and height, or 0x0 for the size "
			"that the tracker reports",
			px[0], px[1]);
	if ((mm[0] > 0) != (mm[1] > 0))
		return refuse_setting(
			check, "display.mm",
			"%g %g has one side only; give width and height, or 0 0 for the size "
			"that the tracker reports",
			mm[0], mm[1]);
	bool both = px[0] > 0 && mm[0] > 0;
	double aspect = both ? mm[0] / px[0] / (mm[1] / px[1]) : 1;
	if (aspect >= 1 / PIXEL_ASPECT_MAX && aspect <= PIXEL_ASPECT_MAX)
		return GZ_OK;
	return refuse_setting(check, "display.mm",
			      "%g x %g mm does not fit %dx%d pixels; are width and height swapped?",
			      mm[0], mm[1], px[0], px[1]);
}

/* The line of the configuration file that gives the pipeline's setting @p key; 0 if it does not, or
 * if the command line gives it too. */
static int pipeline_line(const struct gz_config *config, const char *key)
{
	for (size_t i = 0; i < gz_pipeline_option_count; i++) {
		if (strcmp(gz_pipeline_options[i].key, key) == 0 && config->pipeline_given[i])
			return 0;
	}
	return config->file_read[0] ? gz_options_file_line(config->file_read, key) : 0;
}

static enum gz_result check_pipeline(const struct check *check)
{
	char message[256];
	const struct gz_config *config = check->config;
	if (gz_pipeline_check_params(&config->pipeline, message, sizeof message) == GZ_OK)
		return GZ_OK;
	int line = pipeline_line(config, "pipeline.correction.x");
	if (line == 0)
		line = pipeline_line(config, "pipeline.correction.y");
	if (line > 0)
		gz_err(check->log, "%s:%d: %s", config->file_read, line, message);
	else
		gz_err(check->log, "%s", message);
	return GZ_ERR_INVAL;
}

/* Copy the host of "tcp://HOST:PORT". @return where the port begins; NULL for any other text */
static const char *split_endpoint(const char *endpoint, char *host, size_t size)
{
	static const char scheme[] = "tcp://";
	if (strncmp(endpoint, scheme, sizeof scheme - 1) != 0)
		return NULL;
	endpoint += sizeof scheme - 1;
	const char *colon = strrchr(endpoint, ':');
	if (!colon || colon == endpoint || (size_t)(colon - endpoint) >= size)
		return NULL;
	memcpy(host, endpoint, (size_t)(colon - endpoint));
	host[colon - endpoint] = '\0';
	return colon + 1;
}

/* Whether only this machine can reach a socket bound to @p host. */
static bool is_loopback(const char *host)
{
	struct in_addr address;
	if (strcmp(host, "[::1]") == 0)
		return true;
	return inet_pton(AF_INET, host, &address) == 1 && (ntohl(address.s_addr) >> 24) == 127;
}

static enum gz_result check_ports(const struct check *check, int control_port)
{
	static const char *const keys[] = { "network.control", "network.stream_port",
					    "network.latest_port", "network.inlet_port" };
	const int ports[] = { control_port, check->config->stream_port, check->config->latest_port,
			      check->config->inlet_port };
	for (int i = 1; i < 4; i++) {
		for (int j = 0; j < i; j++) {
			if (ports[i] > 0 && ports[i] == ports[j])
				return refuse_setting(
					check, keys[i],
					"%d is also the port of %s; give each its own port",
					ports[i], keys[j]);
		}
	}
	return GZ_OK;
}

/* Gaze is biometric data: only this machine may reach an endpoint without keys. */
static enum gz_result check_reach(const struct check *check, const char *key, const char *text,
				  const char *host)
{
	if (check->config->tcp == GZ_TCP_CURVE || is_loopback(host))
		return GZ_OK;
	return refuse_setting(
		check, key,
		"%s is not a loopback address, and other machines could listen in; use 127.0.0.1, "
		"or --tcp curve with keys from gazectl keygen, or --tcp off for local sockets only",
		text);
}

static enum gz_result check_network(const struct check *check)
{
	char host[GZ_ENDPOINT_SIZE];
	struct gz_config *config = check->config;
	if (config->tcp == GZ_TCP_OFF)
		return GZ_OK;
	if (!config->address[0])
		return refuse_setting(check, "network.address",
				      "empty; give an address of this machine, such as 127.0.0.1");
	if (config->control[0])
		memcpy(config->control_endpoint, config->control, sizeof config->control);
	else
		snprintf(config->control_endpoint, sizeof config->control_endpoint, "tcp://%s:%d",
			 config->address, CONTROL_PORT);
	const char *port = split_endpoint(config->control_endpoint, host, sizeof host);
	if (!port)
		return refuse_setting(check, "network.control", "%s is not tcp://ADDRESS:PORT",
				      config->control_endpoint);
	enum gz_result result =
		check_reach(check, "network.address", config->address, config->address);
	if (result == GZ_OK)
		result = check_reach(check, "network.control", config->control_endpoint, host);
	return result == GZ_OK ? check_ports(check, atoi(port)) : result;
}

/* Refuse a pupil driver that would read from this daemon itself, and so receive nothing. */
static enum gz_result check_pupil(const struct check *check)
{
	const struct gz_config *config = check->config;
	const void *settings;
	char address[GZ_ENDPOINT_SIZE], host[GZ_ENDPOINT_SIZE], own_host[GZ_ENDPOINT_SIZE];
	const struct gz_driver *driver = gz_config_driver(config, &settings);
	const struct gz_option_binding binding = { driver->options, *driver->option_count,
						   (void *)settings, NULL };
	const struct gz_option *option = gz_options_find(&binding, 1, "pupil.address", NULL);
	if (!option || config->tcp == GZ_TCP_OFF ||
	    gz_option_format(option, settings, address, sizeof address) != GZ_OK)
		return GZ_OK;
	const char *port = split_endpoint(address, host, sizeof host);
	const char *own_port = split_endpoint(config->control_endpoint, own_host, sizeof own_host);
	bool local = is_loopback(host) || strcmp(host, "localhost") == 0;
	if (!port || !own_port || strcmp(port, own_port) != 0 ||
	    (strcmp(host, own_host) != 0 && !local))
		return GZ_OK;
	return refuse_setting(
		check, "pupil.address",
		"%s is this daemon's own control socket; move that with --control "
		"tcp://127.0.0.1:PORT or --tcp off, or give the address of another machine",
		address);
}

static enum gz_result check_lsl(const struct check *check)
{
	if (!check->config->lsl)
		return GZ_OK;
	if (!check->config->lsl_name[0])
		return refuse_setting(check, "lsl.name", "empty; give the stream of gaze a name");
	if (!check->config->lsl_library[0])
		return refuse_setting(check, "lsl.library", "empty; name liblsl");
	return GZ_OK;
}

/* Check all settings, and fill those that follow from others. */
static enum gz_result check_config(struct gz_config *config, const struct gz_log *log)
{
	const struct check check = { config, log };
	enum gz_result result = check_driver(&check);
	if (result == GZ_OK)
		result = check_network(&check);
	if (result == GZ_OK)
		result = check_pupil(&check);
	if (result == GZ_OK)
		result = check_display_sizes(&check);
	if (result == GZ_OK)
		result = check_lsl(&check);
	if (result == GZ_OK)
		result = check_pipeline(&check);
	return result == GZ_OK ? split_surfaces(&check) : result;
}

/* Whether @p argument is "--DRIVER.something". */
static bool is_setting_of(const char *argument, const char *driver)
{
	size_t length = strlen(driver);
	return strncmp(argument, "--", 2) == 0 && strncmp(argument + 2, driver, length) == 0 &&
	       argument[2 + length] == '.';
}

/* Refuse settings of other drivers on the command line; a file may hold those of all drivers. */
static enum gz_result check_driver_arguments(const struct gz_config *config, int argc,
					     char *const *argv, const struct gz_log *log)
{
	if (strcmp(config->driver, "auto") == 0)
		return GZ_OK; /* auto may use any of them */
	for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++) {
		for (size_t d = 0; gz_drivers[d]; d++) {
			const char *driver = gz_drivers[d]->name;
			if (strcmp(driver, config->driver) == 0 || !is_setting_of(argv[i], driver))
				continue;
			gz_err(log,
			       "%.*s: belongs to driver %s, but the driver is %s; leave it out, or "
			       "use --driver %s",
			       (int)strcspn(argv[i], "="), argv[i], driver, config->driver, driver);
			return GZ_ERR_INVAL;
		}
	}
	return GZ_OK;
}
static enum gz_result read_config_arguments(struct gz_config *config, int argc, char *const *argv,
					    const struct gz_log *log)
{
	static const char *const shorts[][2] = { { "driver", "tracker.driver" },
						 { "tracker", "tracker.choice" },
						 { "tcp", "network.tcp" },
						 { "control", "network.control" } };
	struct gz_option_binding bindings[BINDINGS_MAX];
	memset(config->own_given, 0, sizeof config->own_given);
	memset(config->pipeline_given, 0, sizeof config->pipeline_given);
	size_t count =
		bind_config_tables(config, config->own_given, config->pipeline_given, bindings);
	enum gz_result result = gz_options_read_arguments(bindings, count, argc, argv, NULL, log);
	if (result != GZ_OK)
		return result;
	for (size_t i = 0; i < sizeof shorts / sizeof *shorts; i++) {
		if (given_on_command_line(config, shorts[i][0]) &&
		    given_on_command_line(config, shorts[i][1])) {
			gz_err(log, "--%s: given twice, also as --%s; keep one", shorts[i][1],
			       shorts[i][0]);
			return GZ_ERR_INVAL;
		}
		if (given_on_command_line(config, shorts[i][0]))
			mark_as_given(config, shorts[i][1]);
	}
	config->display_given[0] = given_on_command_line(config, "display.px");
	config->display_given[1] = given_on_command_line(config, "display.mm");
	config->display_given[2] = given_on_command_line(config, "display.distance_mm");
	return GZ_OK;
}

enum gz_result gz_config_read(int argc, char *const *argv, const struct gz_log *log,
			      struct gz_config *out_config)
{
	char file[GZ_PATH_SIZE];
	/* The command line is read twice: first to learn which file to read, then again because it
	 * takes precedence over the file. */
	enum gz_result result = set_presets(out_config);
	if (result == GZ_OK)
		result = read_config_arguments(out_config, argc, argv, log);
	if (result != GZ_OK || out_config->help || out_config->version)
		return result;
	memcpy(file, out_config->file, sizeof file);
	result = set_presets(out_config);
	if (result == GZ_OK)
		result = read_config_file(out_config, file, log);
	if (result == GZ_OK)
		result = read_config_arguments(out_config, argc, argv, log);
	if (result == GZ_OK)
		result = check_driver_arguments(out_config, argc, argv, log);
	return result == GZ_OK ? check_config(out_config, log) : result;
}

void gz_config_print_help(struct gz_config *config, FILE *out)
{
	struct gz_option_binding bindings[BINDINGS_MAX];
	fputs("usage: gazed [--key value]...\n\n"
	      "The gaze daemon: reads an eye tracker, publishes where the eye rests, and records.\n"
	      "Keys with a dot can also be set in the configuration file.\n\n",
	      out);
	gz_options_print_help(bindings, bind_config_tables(config, NULL, NULL, bindings), out);
	fputs("\ndrivers:\n", out);
	for (size_t i = 0; gz_drivers[i]; i++)
		fprintf(out, "  %-10s %s\n", gz_drivers[i]->name, gz_drivers[i]->help);
}

void gz_config_print_file(struct gz_config *config, FILE *out)
{
	struct gz_option_binding bindings[BINDINGS_MAX];
	fputs("; Configuration of gazed. The command line takes the same keys as --section.name, "
	      "and "
	      "it overrides this file.\n\n",
	      out);
	gz_options_print_file(bindings, bind_config_tables(config, NULL, NULL, bindings), out);
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
