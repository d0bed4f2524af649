/* gazectl devices: the trackers that the drivers of this build see, and why one cannot be used. */
#include "client/gazectl/gazectl.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/config.h"
#include "drivers/driver.h"
#include "drivers/usb/usb_refused.h"

#define GZ_LOG_MODULE "gazectl"

/* Room for all drivers' devices, and for those that have none. */
enum { DEVICES_MAX = GZ_CONFIG_DRIVERS_MAX * GZ_DEVICE_ENTRIES_MAX };

struct devices_settings {
	struct gz_command_common common;
	bool json;
};

static const struct gz_option devices_options[] = {
	GZ_COMMAND_HELP_OPTION,
	{ .key = "json",
	  .type = GZ_OPTION_BOOL,
	  .offset = offsetof(struct devices_settings, json),
	  .preset = "false",
	  .help = "print JSON" },
};

struct found {
	const char *driver;
	struct gz_device_entry entry;
};

struct devices {
	struct gz_config config;
	int count;
	struct found items[DEVICES_MAX];
};

static void add(struct devices *devices, const char *driver, const struct gz_device_entry *entry)
{
	if (devices->count == DEVICES_MAX)
		return;
	struct found *found = &devices->items[devices->count++];
	found->driver = driver;
	found->entry = *entry;
	gazectl_make_printable(found->entry.name);
	gazectl_make_printable(found->entry.serial);
	gazectl_make_printable(found->entry.place);
	gazectl_make_printable(found->entry.reason);
}

/* The settings that gazed would have, or its presets where they cannot be read. */
static enum gz_result read_settings(struct gz_config *config, const struct gz_log *log)
{
	static char program[] = "gazectl", option[] = "--config", none[] = "/dev/null";
	char *plain[] = { program, NULL };
	char *preset[] = { program, option, none, NULL };
	if (gz_config_read(1, plain, log, config) == GZ_OK)
		return GZ_OK;
	gz_warn(log, "the drivers are asked with their presets");
	return gz_config_read(3, preset, log, config);
}

static void ask_drivers(struct devices *devices, const struct gz_log *log)
{
	struct gz_device_entry entries[GZ_DEVICE_ENTRIES_MAX];
	const void *settings[GZ_CONFIG_DRIVERS_MAX];
	const struct gz_driver_host host = { .log = log, .settings = settings };
	gz_config_all_settings(&devices->config, settings);
	for (int i = 0; i < GZ_CONFIG_DRIVERS_MAX && gz_drivers[i]; i++) {
		if (!gz_drivers[i]->list)
			continue;
		size_t count = gz_drivers[i]->list(settings[i], &host, entries);
		for (size_t j = 0; j < count; j++)
			add(devices, gz_drivers[i]->name, &entries[j]);
	}
	size_t count = gz_usb_list_refused(GZ_SYSFS, entries, GZ_DEVICE_ENTRIES_MAX);
	for (size_t j = 0; j < count; j++)
		add(devices, "hid", &entries[j]);
}

static bool is_plain_word(const char *text)
{
	for (; *text; text++)
		if (!isalnum((unsigned char)*text) && !strchr("._:-", *text))
			return false;
	return true;
}

/* What to type for this one: by serial, by name where that is all it has. A name that a shell would
 * not pass on is put in quotes; one that has quotes itself is left out. */
static void print_choice(const struct found *found, char *text, size_t size)
{
	const char *choice = found->entry.serial[0] ? found->entry.serial : found->entry.name;
	if (!choice[0] || strchr(choice, '\''))
		snprintf(text, size, "gazed --driver %s", found->driver);
	else if (is_plain_word(choice))
		snprintf(text, size, "gazed --driver %s --tracker %s", found->driver, choice);
	else
		snprintf(text, size, "gazed --driver %s --tracker '%s'", found->driver, choice);
}

static void print_text(const struct devices *devices)
{
	char choice[3 * GZ_NAME_SIZE];
	for (int i = 0; i < devices->count; i++) {
		const struct found *found = &devices->items[i];
		const struct gz_device_entry *entry = &found->entry;
		printf("%s%s%s at %s, driver %s\n", entry->name[0] ? entry->name : "unnamed",
		       entry->serial[0] ? ", serial " : "", entry->serial, entry->place,
		       found->driver);
		print_choice(found, choice, sizeof choice);
		if (entry->usable)
			printf("    usable: %s\n", choice);
		else
			printf("    not usable: %s\n", entry->reason);
	}
}

static void print_json(const struct devices *devices)
{
	struct gz_json json = { .out = stdout };
	char choice[3 * GZ_NAME_SIZE];
	gz_json_begin(&json, NULL);
	gz_json_begin_list(&json, "devices");
	for (int i = 0; i < devices->count; i++) {
		const struct found *found = &devices->items[i];
		print_choice(found, choice, sizeof choice);
		gz_json_begin(&json, NULL);
		gz_json_text(&json, "driver", found->driver);
		gz_json_text(&json, "name", found->entry.name);
		gz_json_text(&json, "serial", found->entry.serial);
		gz_json_text(&json, "place", found->entry.place);
		gz_json_bool(&json, "usable", found->entry.usable);
		gz_json_text(&json, "reason", found->entry.reason);
		gz_json_text(&json, "command", found->entry.usable ? choice : "");
		gz_json_end(&json);
	}
	gz_json_end_list(&json);
	gz_json_end(&json);
}

static enum gazectl_exit show(const struct devices_settings *settings,
			      const struct devices *devices, const struct gz_log *log)
{
	if (settings->json)
		print_json(devices);
	else
		print_text(devices);
	fflush(stdout); /* what is said of the list comes behind it, also in a file */
	for (int i = 0; i < devices->count; i++)
		if (devices->items[i].entry.usable)
			return GAZECTL_DONE;
	if (devices->count == 0)
		gz_err(log, "no tracker found: plug one in; gazed --driver sim plays one");
	else
		gz_err(log, "no tracker can be used; the list says what to do, and gazed --driver "
			    "sim plays one");
	return GAZECTL_FAILED;
}

static int run(int argc, char *const *argv, const struct gz_log *log)
{
	struct devices_settings settings;
	struct gz_operands operands;
	int exit_status;
	if (!gz_command_read_arguments(&gazectl_devices, argc, argv, log, &settings, &operands,
				       &exit_status))
		return exit_status;
	struct devices *devices = calloc(1, sizeof *devices);
	if (!devices) {
		gz_err(log, "out of memory");
		return GAZECTL_FAILED;
	}
	exit_status = GAZECTL_FAILED;
	if (read_settings(&devices->config, log) == GZ_OK) {
		ask_drivers(devices, log);
		exit_status = show(&settings, devices, log);
	}
	free(devices);
	return exit_status;
}

const struct gz_command gazectl_devices = {
	.program = "gazectl",
	.name = "devices",
	.operands = "",
	.summary = "list the trackers that are there",
	.details = "Asks every driver, with the settings that gazed would have; needs no daemon. "
		   "Says of each\ntracker how to choose it, or why it cannot be used and what to "
		   "do.\n",
	.options = devices_options,
	.option_count = sizeof devices_options / sizeof *devices_options,
	.run = run,
};
