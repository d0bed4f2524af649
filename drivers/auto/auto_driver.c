#include "drivers/auto/auto_driver.h"

#include <string.h>

#define GZ_LOG_MODULE "auto"

/* A look at all drivers. */
struct search {
	const struct gz_driver_host *host;
	struct gz_device *device;
	enum gz_result result; /* of the first device that could not be opened */
	bool told;             /* why one on USB cannot be used */
};

static bool is_chosen(const struct gz_device_entry *entry, const char *choice)
{
	return !choice || !choice[0] || strcmp(choice, entry->serial) == 0 ||
	       strcmp(choice, entry->name) == 0;
}

/* Another daemon's gaze is not taken unasked; and at the address of Pupil Capture gazed may be the
 * one that answers. */
static bool is_asked(const struct gz_driver *driver, bool on_usb)
{
	return driver->list && driver != &gz_driver_auto && driver->on_usb == on_usb &&
	       strcmp(driver->name, "pupil") != 0;
}

static void open_entry(struct search *search, const struct gz_driver *driver, const void *settings,
		       const struct gz_device_entry *entry)
{
	const struct gz_log *log = search->host->log;
	struct gz_driver_host host = *search->host;
	host.choice = entry->serial[0] ? entry->serial : entry->name;
	enum gz_result result = driver->create(settings, &host, &search->device);
	if (result == GZ_OK)
		gz_info(log, "%s %s at %s, by driver %s", entry->name, entry->serial, entry->place,
			driver->name);
	else if (search->result == GZ_ERR_NO_DEVICE)
		search->result = result;
}

static void consider(struct search *search, const struct gz_driver *driver, const void *settings,
		     const struct gz_device_entry *entry)
{
	const struct gz_log *log = search->host->log;
	if (search->device || !is_chosen(entry, search->host->choice)) {
		if (entry->usable)
			gz_info(log, "not used: %s %s at %s, of driver %s", entry->name,
				entry->serial, entry->place, driver->name);
		return;
	}
	if (entry->usable) {
		open_entry(search, driver, settings, entry);
	} else if (driver->on_usb) {
		/* Others list an address where nobody needs to be. */
		gz_err(log, "%s at %s: %s", entry->name, entry->place, entry->reason);
		search->told = true;
	}
}

static void ask(struct search *search, bool on_usb)
{
	struct gz_device_entry entries[GZ_DEVICE_ENTRIES_MAX];
	for (size_t i = 0; gz_drivers[i]; i++) {
		const void *settings = search->host->settings[i];
		if (!is_asked(gz_drivers[i], on_usb))
			continue;
		size_t count = gz_drivers[i]->list(settings, search->host, entries);
		for (size_t j = 0; j < count; j++)
			consider(search, gz_drivers[i], settings, &entries[j]);
	}
}

static enum gz_result auto_create(const void *settings, const struct gz_driver_host *host,
				  struct gz_device **out_device)
{
	struct search search = { .host = host, .result = GZ_ERR_NO_DEVICE };
	(void)settings;
	if (!host->settings) {
		gz_err(host->log, "the other drivers' settings are missing; choose one of them");
		return GZ_ERR_INVAL;
	}
	ask(&search, true);
	if (!search.device)
		ask(&search, false);
	if (search.device) {
		*out_device = search.device;
		return GZ_OK;
	}
	if (search.told)
		return GZ_ERR_ACCESS;
	if (search.result == GZ_ERR_NO_DEVICE && host->choice && host->choice[0])
		gz_err(host->log, "no tracker is called %s; `gazectl devices` lists them",
		       host->choice);
	else if (search.result == GZ_ERR_NO_DEVICE)
		gz_err(host->log, "no tracker found; plug one in (`gazectl devices` tells what is "
				  "seen), or let --driver sim play one");
	return search.result;
}

static const size_t no_options;

const struct gz_driver gz_driver_auto = {
	.name = "auto",
	.help = "whatever tracker is there, those on USB first; waits for one to be plugged in",
	.option_count = &no_options,
	.on_usb = true,
	.create = auto_create,
};
