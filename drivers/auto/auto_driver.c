/**
 * @file
 * The driver "auto": opens whatever tracker is present. It asks the other drivers for their
 * devices, those on USB first, in the order of gz_drivers[], and opens the first tracker that can
 * be used. If there is none, the daemon waits for one to be plugged in.
 */
#include <string.h>

#include "drivers/driver.h"

#define GZ_LOG_MODULE "auto"

/* A search through all drivers. */
struct tracker_search {
	const struct gz_driver_host *host;
	struct gz_device *device;
	enum gz_result result; /* failure of the first device that could not be opened */
	bool told;             /* the log says why a tracker on USB cannot be used */
};

/* Another daemon's gaze is taken only on request: pupil is left out, because gazed itself may be
 * what answers at the address of Pupil Capture. */
static bool is_searched_driver(const struct gz_driver *driver, bool on_usb)
{
	return driver->list && driver != &gz_driver_auto && driver->on_usb == on_usb &&
	       strcmp(driver->name, "pupil") != 0;
}

static void open_tracker_entry(struct tracker_search *search, const struct gz_driver *driver,
			       const void *settings, const struct gz_device_entry *entry)
{
	const struct gz_log *log = search->host->log;
	struct gz_driver_host host = *search->host;
	host.choice = entry->serial[0] ? entry->serial : entry->name;
	enum gz_result result = driver->create(settings, &host, &search->device);
	if (result == GZ_OK)
		gz_info(log, "using %s %s at %s, driver %s", entry->name, entry->serial,
			entry->place, driver->name);
	else if (search->result == GZ_ERR_NO_DEVICE)
		search->result = result;
}

static void consider_tracker(struct tracker_search *search, const struct gz_driver *driver,
			     const void *settings, const struct gz_device_entry *entry)
{
	const struct gz_log *log = search->host->log;
	if (search->device ||
	    !gz_device_is_chosen(search->host->choice, entry->name, entry->serial)) {
		if (entry->usable)
			gz_info(log, "not used: %s %s at %s, driver %s", entry->name, entry->serial,
				entry->place, driver->name);
		return;
	}
	if (entry->usable) {
		open_tracker_entry(search, driver, settings, entry);
	} else if (driver->on_usb) {
		/* Drivers that are not on USB list an address that may have no tracker. */
		gz_err(log, "%s at %s: %s", entry->name, entry->place, entry->reason);
		search->told = true;
	}
}

static void search_drivers(struct tracker_search *search, bool on_usb)
{
	struct gz_device_entry entries[GZ_DEVICE_ENTRIES_MAX];
	for (size_t i = 0; gz_drivers[i]; i++) {
		const void *settings = search->host->settings[i];
		if (!is_searched_driver(gz_drivers[i], on_usb))
			continue;
		size_t count = gz_drivers[i]->list(settings, search->host, entries);
		for (size_t j = 0; j < count; j++)
			consider_tracker(search, gz_drivers[i], settings, &entries[j]);
	}
}

static enum gz_result auto_create(const void *settings, const struct gz_driver_host *host,
				  struct gz_device **out_device)
{
	struct tracker_search search = { .host = host, .result = GZ_ERR_NO_DEVICE };
	(void)settings;
	if (!host->settings) {
		gz_err(host->log, "the settings of the other drivers are missing; choose a driver "
				  "by its name");
		return GZ_ERR_INVAL;
	}
	search_drivers(&search, true);
	if (!search.device)
		search_drivers(&search, false);
	if (search.device) {
		*out_device = search.device;
		return GZ_OK;
	}
	if (search.told)
		return GZ_ERR_ACCESS;
	if (search.result == GZ_ERR_NO_DEVICE && host->choice && host->choice[0])
		gz_err(host->log, "no tracker is called %s; see gazectl devices", host->choice);
	else if (search.result == GZ_ERR_NO_DEVICE)
		gz_err(host->log, "no tracker found; plug one in (gazectl devices shows what is "
				  "connected), or use --driver sim");
	return search.result;
}

static const size_t no_options;

const struct gz_driver gz_driver_auto = {
	.name = "auto",
	.help = "the first usable tracker, those on USB first; waits for one to be plugged in",
	.option_count = &no_options,
	.on_usb = true,
	.create = auto_create,
};
