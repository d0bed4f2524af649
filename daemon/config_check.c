#include "daemon/config_check.h"

#include <arpa/inet.h>
#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GZ_LOG_MODULE "config"

/* Port of the control socket where none is given: Pupil Remote's. */
enum { CONTROL_PORT = 50020 };

/* Chosen: no display's pixels are twice as wide as high, nor twice as high as wide. */
#define PIXEL_ASPECT_MAX 2.0

/* A check in progress. */
struct check {
	struct gz_config *config;
	const struct gz_log *log;
};

/* One line: where the setting @p key came from, what is wrong, what to do. */
__attribute__((format(printf, 3, 4))) static enum gz_result refuse(const struct check *check,
								   const char *key,
								   const char *format, ...)
{
	char what[768];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(what, sizeof what, format, arguments);
	va_end(arguments);
	const char *file = check->config->file_read;
	bool on_command_line = gz_config_given(check->config, key);
	int line = file[0] && !on_command_line ? gz_options_file_line(file, key) : 0;
	if (line > 0)
		gz_err(check->log, "%s:%d: %s: %s", file, line, key, what);
	else
		gz_err(check->log, "%s%s: %s", on_command_line ? "--" : "", key, what);
	return GZ_ERR_INVAL;
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

static enum gz_result check_driver(const struct check *check)
{
	char names[256];
	if (gz_driver_find(check->config->driver))
		return GZ_OK;
	list_drivers(names, sizeof names);
	return refuse(check, "tracker.driver", "no driver %s; allowed: %s", check->config->driver,
		      names);
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
		return refuse(check, "stream.surfaces",
			      "%.*s is no name; allowed: letters, digits, . _ -, at most %d bytes",
			      (int)length, word, GZ_NAME_SIZE - 1);
	if (config->surface_count == GZ_SURFACES_MAX)
		return refuse(check, "stream.surfaces", "more than %d names; leave some out",
			      GZ_SURFACES_MAX);
	char *name = config->surface[config->surface_count];
	memcpy(name, word, length);
	name[length] = '\0';
	for (size_t i = 0; i < config->surface_count; i++) {
		if (strcmp(config->surface[i], name) == 0)
			return refuse(check, "stream.surfaces", "%s is there twice; keep one",
				      name);
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

static enum gz_result check_display(const struct check *check)
{
	const struct gz_config *config = check->config;
	const int *px = config->display_px;
	const double *mm = config->display_mm;
	if ((px[0] > 0) != (px[1] > 0))
		return refuse(check, "display.px",
			      "%dx%d is half a display; give width and height, or 0x0 for the "
			      "tracker's",
			      px[0], px[1]);
	if ((mm[0] > 0) != (mm[1] > 0))
		return refuse(check, "display.mm",
			      "%g %g is half a display; give width and height, or 0 0 for the "
			      "tracker's",
			      mm[0], mm[1]);
	bool both = px[0] > 0 && mm[0] > 0;
	double aspect = both ? mm[0] / px[0] / (mm[1] / px[1]) : 1;
	if (aspect >= 1 / PIXEL_ASPECT_MAX && aspect <= PIXEL_ASPECT_MAX)
		return GZ_OK;
	return refuse(check, "display.mm",
		      "%g x %g mm is no display of %dx%d pixels; are width and height swapped?",
		      mm[0], mm[1], px[0], px[1]);
}

/* The line of the file that gives the pipeline's setting @p key, where the command line does not;
 * else 0. */
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

/* The host of "tcp://HOST:PORT" and where its port begins; NULL if it is something else. */
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

/* Whether nothing but this machine can reach what is bound there. */
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
				return refuse(check, keys[i],
					      "%d is the port of %s, too; give each its own",
					      ports[i], keys[j]);
		}
	}
	return GZ_OK;
}

/* Gaze is biometric data: nothing but this machine may reach an endpoint without keys. */
static enum gz_result check_reach(const struct check *check, const char *key, const char *text,
				  const char *host)
{
	if (check->config->tcp == GZ_TCP_CURVE || is_loopback(host))
		return GZ_OK;
	return refuse(
		check, key,
		"%s is no loopback address, and others may not listen in; use 127.0.0.1, or "
		"--tcp curve with keys by gazectl keygen, or --tcp off for local sockets only",
		text);
}

static enum gz_result check_network(const struct check *check)
{
	char host[GZ_ENDPOINT_SIZE];
	struct gz_config *config = check->config;
	if (config->tcp == GZ_TCP_OFF)
		return GZ_OK;
	if (!config->address[0])
		return refuse(check, "network.address",
			      "empty; give an address of this machine, as 127.0.0.1");
	if (config->control[0])
		memcpy(config->control_endpoint, config->control, sizeof config->control);
	else
		snprintf(config->control_endpoint, sizeof config->control_endpoint, "tcp://%s:%d",
			 config->address, CONTROL_PORT);
	const char *port = split_endpoint(config->control_endpoint, host, sizeof host);
	if (!port)
		return refuse(check, "network.control", "%s is no tcp://ADDRESS:PORT",
			      config->control_endpoint);
	enum gz_result result =
		check_reach(check, "network.address", config->address, config->address);
	if (result == GZ_OK)
		result = check_reach(check, "network.control", config->control_endpoint, host);
	return result == GZ_OK ? check_ports(check, atoi(port)) : result;
}

/* Whether the driver pupil would listen to this daemon itself, which says nothing then. */
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
	return refuse(check, "pupil.address",
		      "%s is where this daemon's own requests are; move those with --control "
		      "tcp://127.0.0.1:PORT or --tcp off, or give another machine's address",
		      address);
}

enum gz_result gz_config_check(struct gz_config *config, const struct gz_log *log)
{
	const struct check check = { config, log };
	enum gz_result result = check_driver(&check);
	if (result == GZ_OK)
		result = check_network(&check);
	if (result == GZ_OK)
		result = check_pupil(&check);
	if (result == GZ_OK)
		result = check_display(&check);
	if (result == GZ_OK)
		result = check_pipeline(&check);
	return result == GZ_OK ? split_surfaces(&check) : result;
}

/* Whether @p argument is "--NAME.something". */
static bool is_setting_of(const char *argument, const char *driver)
{
	size_t length = strlen(driver);
	return strncmp(argument, "--", 2) == 0 && strncmp(argument + 2, driver, length) == 0 &&
	       argument[2 + length] == '.';
}

enum gz_result gz_config_check_arguments(const struct gz_config *config, int argc,
					 char *const *argv, const struct gz_log *log)
{
	if (strcmp(config->driver, "auto") == 0)
		return GZ_OK; /* it may come to use any of them */
	for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++) {
		for (size_t d = 0; gz_drivers[d]; d++) {
			const char *driver = gz_drivers[d]->name;
			if (strcmp(driver, config->driver) == 0 || !is_setting_of(argv[i], driver))
				continue;
			gz_err(log,
			       "%.*s: a setting of driver %s, and the driver is %s; leave it out, "
			       "or use --driver %s",
			       (int)strcspn(argv[i], "="), argv[i], driver, config->driver, driver);
			return GZ_ERR_INVAL;
		}
	}
	return GZ_OK;
}
