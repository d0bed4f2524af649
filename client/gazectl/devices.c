/* gazectl devices: the trackers that the drivers of this build find, and why one cannot be used. */
#include "client/gazectl/gazectl.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/utf8.h"
#include "client/gazectl/output.h"
#include "daemon/config.h"
#include "drivers/driver.h"
#include "drivers/usb/usb_device.h"

#define GZ_LOG_MODULE "gazectl"

/* Room for the devices of all drivers and for USB trackers that may not be opened. */
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

static void add_device(struct devices *devices, const char *driver,
		       const struct gz_device_entry *entry)
{
	if (devices->count == DEVICES_MAX)
		return;
	struct found *found = &devices->items[devices->count++];
	found->driver = driver;
	found->entry = *entry;
	gz_utf8_clean(found->entry.name);
	gz_utf8_clean(found->entry.serial);
	gz_utf8_clean(found->entry.place);
	gz_utf8_clean(found->entry.reason);
}

/* Read the settings that gazed would have; its presets if they cannot be read. */
static enum gz_result read_daemon_settings(struct gz_config *config, const struct gz_log *log)
{
	static char program[] = "gazectl", option[] = "--config", none[] = "/dev/null";
	char *plain[] = { program, NULL };
	char *preset[] = { program, option, none, NULL };
	if (gz_config_read(1, plain, log, config) == GZ_OK)
		return GZ_OK;
	gz_warn(log, "the drivers search with their default settings");
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
			add_device(devices, gz_drivers[i]->name, &entries[j]);
	}
	size_t count = gz_usb_list_refused(GZ_SYSFS, entries, GZ_DEVICE_ENTRIES_MAX);
	for (size_t j = 0; j < count; j++)
		add_device(devices, "hid", &entries[j]);
}

static bool is_plain_word(const char *text)
{
	for (; *text; text++)
		if (!isalnum((unsigned char)*text) && !strchr("._:-", *text))
			return false;
	return true;
}

/* The command that uses this tracker, by its serial number, or by its name if it has none. A name
 * that a shell would split is quoted; one that contains quotes is left out. */
static void format_command(const struct found *found, char *text, size_t size)
{
	const char *choice = found->entry.serial[0] ? found->entry.serial : found->entry.name;
	if (!choice[0] || strchr(choice, '\''))
		snprintf(text, size, "gazed --driver %s", found->driver);
	else if (is_plain_word(choice))
		snprintf(text, size, "gazed --driver %s --tracker %s", found->driver, choice);
	else
		snprintf(text, size, "gazed --driver %s --tracker '%s'", found->driver, choice);
}

static void print_device_list(const struct devices *devices)
{
	char command[3 * GZ_NAME_SIZE];
	for (int i = 0; i < devices->count; i++) {
		const struct found *found = &devices->items[i];
		const struct gz_device_entry *entry = &found->entry;
		printf("%s%s%s at %s, driver %s\n", entry->name[0] ? entry->name : "unnamed",
		       entry->serial[0] ? ", serial " : "", entry->serial, entry->place,
		       found->driver);
		format_command(found, command, sizeof command);
		if (entry->usable)
			printf("    usable: %s\n", command);
		else
			printf("    not usable: %s\n", entry->reason);
	}
}

static json_t *json_devices(const struct devices *devices)
{
	char command[3 * GZ_NAME_SIZE];
	json_t *list = json_array();
	for (int i = 0; i < devices->count; i++) {
		const struct found *found = &devices->items[i];
		const struct gz_device_entry *entry = &found->entry;
		format_command(found, command, sizeof command);
		json_array_append_new(
			list, json_pack("{ss so so so sb so so}", "driver", found->driver, "name",
					gz_output_json_text(entry->name), "serial",
					gz_output_json_text(entry->serial), "place",
					gz_output_json_text(entry->place), "usable", entry->usable,
					"reason", gz_output_json_text(entry->reason), "command",
					gz_output_json_text(entry->usable ? command : "")));
	}
	return json_pack("{so}", "devices", list);
}

static enum gazectl_exit show_devices(const struct devices_settings *settings,
				      const struct devices *devices, const struct gz_log *log)
{
	if (settings->json && gz_output_json_print(json_devices(devices), stdout, log) != GZ_OK)
		return GAZECTL_FAILED;
	if (!settings->json)
		print_device_list(devices);
	fflush(stdout); /* messages come after the list, also if both go to one file */
	for (int i = 0; i < devices->count; i++)
		if (devices->items[i].entry.usable)
			return GAZECTL_DONE;
	if (devices->count == 0)
		gz_err(log, "no tracker found: connect one, or simulate one with gazed --driver "
			    "sim");
	else
		gz_err(log, "no tracker can be used: the list says what to do; gazed --driver sim "
			    "simulates one");
	return GAZECTL_FAILED;
}

static int devices_run(int argc, char *const *argv, const struct gz_log *log)
{
	struct devices_settings settings;
	struct gz_operands operands;
	int exit_status =
		gz_command_read_arguments(&gazectl_devices, argc, argv, log, &settings, &operands);
	if (exit_status != GZ_COMMAND_GO_ON)
		return exit_status;
	struct devices *devices = calloc(1, sizeof *devices);
	if (!devices) {
		gz_err(log, "out of memory");
		return GAZECTL_FAILED;
	}
	exit_status = GAZECTL_FAILED;
	if (read_daemon_settings(&devices->config, log) == GZ_OK) {
		ask_drivers(devices, log);
		exit_status = show_devices(&settings, devices, log);
	}
	free(devices);
	return exit_status;
}

const struct gz_command gazectl_devices = {
	.program = "gazectl",
	.name = "devices",
	.operands = "",
	.summary = "list the trackers that are connected",
	.details = "Every driver searches with the settings that gazed would use; no daemon is "
		   "needed. For each\ntracker the list gives the command that uses it, or the "
		   "reason why it cannot be used and\nwhat to do.\n",
	.options = devices_options,
	.option_count = sizeof devices_options / sizeof *devices_options,
	.run = devices_run,
};
