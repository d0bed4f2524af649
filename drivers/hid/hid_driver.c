/**
 * @file
 * Eye trackers of the HID class: usage page 0x12 of the HID Usage Tables 1.2 (request HUTRR74),
 * found by their report descriptors, whatever the layout of their reports, through the hidraw
 * backend of hidapi.
 *
 * The class sends one gaze point and, on request, the positions of the eyes. A tracker that sends
 * only the point leaves both eyes unmeasured. One that sends positions fills in, for each eye that
 * it sees, the gaze point, origin_mm and direction: mm from the upper left corner of the screen,
 * right, down and towards the viewer (hid_tracker.h gives the source of this frame).
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "drivers/device/device.h"
#include "drivers/hid/hid_device.h"

#define GZ_LOG_MODULE "hid"

/* Room beyond the longest report, bytes, so that a longer one is recognised. */
enum { REPORT_SPARE = 8 };

/* Pixels of a display of which only the size is known; the default of the daemon. */
enum { WIDTH_PX = 1920, HEIGHT_PX = 1080 };

#define AT(field) offsetof(struct gz_hid_settings, field)

static const struct gz_option hid_options[] = {
	{ "hid.screen_mm", GZ_OPTION_DOUBLE, AT(screen_mm), 0, 100000, .count = 2, .preset = "0 0",
	  .help = "width and height of the screen that the tracker is calibrated to, mm; 0 0: as "
		  "the tracker states, or display.mm if it states none" },
	{ "hid.eye_positions", GZ_OPTION_BOOL, AT(eye_positions), 0, 0, .preset = "yes",
	  .help = "request eye positions in addition to the gaze point" },
};

static const size_t hid_option_count = sizeof hid_options / sizeof *hid_options;

static struct gz_hid_device *hid_device_of(struct gz_device *device)
{
	return (struct gz_hid_device *)device;
}

static enum gz_result hid_start(struct gz_device *base)
{
	gz_hid_setup_start(hid_device_of(base));
	return GZ_OK;
}

static enum gz_result hid_read_sample(struct gz_device *base, int timeout_ms,
				      struct gz_sample *out_sample)
{
	return gz_hid_stream_read(hid_device_of(base), timeout_ms, out_sample);
}

static void hid_info(const struct gz_device *base, struct gz_device_info *out_info)
{
	const struct gz_hid_device *device = (const struct gz_hid_device *)base;
	*out_info = (struct gz_device_info) {
		.rate_hz = device->rate_hz,
		.has_display = device->screen_mm[0] > 0,
	};
	snprintf(out_info->name, sizeof out_info->name, "%s", device->entry.name);
	snprintf(out_info->serial, sizeof out_info->serial, "%s", device->entry.serial);
	out_info->display = gz_display_default(WIDTH_PX, HEIGHT_PX);
	if (!out_info->has_display)
		return;
	memcpy(out_info->display.mm, device->screen_mm, sizeof out_info->display.mm);
	if (device->optimum_mm > 0)
		out_info->display.distance_mm = device->optimum_mm;
}

static void hid_counters(const struct gz_device *base, struct gz_device_counters *out_counters)
{
	const struct gz_hid_device *device = (const struct gz_hid_device *)base;
	*out_counters = (struct gz_device_counters) {
		.clock = gz_clock_ticks_status(&device->clock),
		.trouble = gz_hid_setup_trouble(device),
	};
	memcpy(out_counters->malformed, device->malformed, sizeof out_counters->malformed);
}

/* Also works on a device that create() could not finish. */
static void hid_destroy(struct gz_device *base)
{
	struct gz_hid_device *device = hid_device_of(base);
	if (device->port)
		gz_hid_setup_stop(device);
	gz_hid_port_close(&device->port);
	free(device->report);
	free(device->last);
	free(device->feature);
	free(device);
}

static const struct gz_device_ops hid_ops = {
	.start = hid_start,
	.read = hid_read_sample,
	.info = hid_info,
	.counters = hid_counters,
	.destroy = hid_destroy,
};

/* An eye tracker that was found; a device may hold several. */
struct hid_found {
	struct gz_device_entry entry;  /* name "Product", for the second one "Product #2" */
	enum gz_result result;         /* GZ_OK, or why it is not usable, as entry.reason says */
	size_t index;                  /* for gz_hid_tracker_find() */
	struct gz_hid_tracker tracker; /* filled if its descriptor can be read */
};

/* State of a search. */
struct hid_search {
	struct hid_found *found;
	size_t count;
	struct gz_hid_port_entry entries[GZ_HID_PORT_ENTRIES_MAX];
	unsigned char bytes[GZ_HID_DESCRIPTOR_SIZE];
	struct gz_hid_descriptor descriptor;
};

static struct hid_found *add_hid_tracker(struct hid_search *search,
					 const struct gz_hid_port_entry *entry)
{
	if (search->count == GZ_DEVICE_ENTRIES_MAX)
		return NULL;
	struct hid_found *found = &search->found[search->count++];
	*found = (struct hid_found) { .result = GZ_OK };
	snprintf(found->entry.name, sizeof found->entry.name, "%s", entry->name);
	snprintf(found->entry.serial, sizeof found->entry.serial, "%s", entry->serial);
	snprintf(found->entry.place, sizeof found->entry.place, "%s", entry->path);
	return found;
}

static void set_hid_unusable(struct hid_found *found, enum gz_result result, const char *reason)
{
	found->result = result;
	snprintf(found->entry.reason, sizeof found->entry.reason, "%s", reason);
}

static void add_malformed_device(struct hid_search *search, const struct gz_hid_port_entry *entry,
				 const struct gz_hid_fault *fault)
{
	struct hid_found *found = add_hid_tracker(search, entry);
	if (!found)
		return;
	found->result = GZ_ERR_FORMAT;
	snprintf(found->entry.reason, sizeof found->entry.reason,
		 "its report descriptor is malformed: %s, byte %zu; ask its maker for other "
		 "firmware",
		 fault->text, fault->at);
}

static void check_hid_access(struct hid_found *found)
{
	switch (gz_hid_port_may_open(found->entry.place)) {
	case GZ_OK:
		found->entry.usable = true;
		return;
	case GZ_ERR_ACCESS:
		set_hid_unusable(found, GZ_ERR_ACCESS,
				 "no permission; " GZ_DEVICE_PERMISSION_REMEDY);
		return;
	default:
		set_hid_unusable(found, GZ_ERR_NO_DEVICE, "it has just been unplugged");
	}
}

static void add_hid_trackers(struct hid_search *search, const struct gz_hid_port_entry *entry)
{
	size_t trackers = gz_hid_tracker_count(&search->descriptor);
	for (size_t i = 0; i < trackers; i++) {
		struct hid_found *found = add_hid_tracker(search, entry);
		const char *reason;
		if (!found)
			return;
		found->index = i;
		if (i > 0)
			snprintf(found->entry.name, sizeof found->entry.name, "%.*s #%u",
				 GZ_NAME_SIZE - 8, entry->name, (uint8_t)(i + 1));
		if (gz_hid_tracker_find(&search->descriptor, i, &found->tracker, &reason) != GZ_OK)
			set_hid_unusable(found, GZ_ERR_FORMAT, reason);
		else
			check_hid_access(found);
	}
}

static void examine_hid_interface(struct hid_search *search, const struct gz_hid_port_entry *entry)
{
	size_t size;
	struct gz_hid_fault fault;
	if (gz_hid_port_descriptor(entry->path, search->bytes, &size) != GZ_OK ||
	    !gz_hid_descriptor_mentions(search->bytes, size, GZ_HID_PAGE_TRACKERS))
		return;
	if (gz_hid_descriptor_parse(search->bytes, size, &search->descriptor, &fault) == GZ_OK)
		add_hid_trackers(search, entry);
	else
		add_malformed_device(search, entry, &fault);
}

/* Find all trackers without opening them. @retval GZ_ERR_NO_MEM  nothing is written */
static enum gz_result find_hid_trackers(struct hid_found *out_found, size_t *out_count)
{
	struct hid_search *search = malloc(sizeof *search);
	if (!search)
		return GZ_ERR_NO_MEM;
	search->found = out_found;
	search->count = 0;
	size_t entries = gz_hid_port_list(search->entries);
	for (size_t i = 0; i < entries; i++)
		examine_hid_interface(search, &search->entries[i]);
	*out_count = search->count;
	free(search);
	return GZ_OK;
}

/* The tracker with the chosen name, serial number or place. Without a choice, the first usable one,
 * or the first one if none is usable. NULL if there is none. */
static const struct hid_found *choose_hid_tracker(const struct hid_found *found, size_t count,
						  const char *choice)
{
	const struct hid_found *first = NULL;
	for (size_t i = 0; i < count; i++) {
		const struct gz_device_entry *entry = &found[i].entry;
		if (!gz_device_is_chosen(choice, entry->name, entry->serial) &&
		    strcmp(choice, entry->place) != 0)
			continue;
		if (found[i].result == GZ_OK)
			return &found[i];
		if (!first)
			first = &found[i];
	}
	return first;
}

/* Allocate everything that a device needs, except the open interface. */
static struct gz_hid_device *allocate_hid_device(const struct gz_hid_settings *settings,
						 const struct hid_found *found,
						 const struct gz_log *log)
{
	struct gz_hid_device *device = calloc(1, sizeof *device);
	if (!device)
		return NULL;
	device->base = (struct gz_device) { .ops = &hid_ops, .log = log };
	device->settings = *settings;
	device->entry = found->entry;
	device->tracker = found->tracker;
	device->report_size = found->tracker.longest[GZ_HID_INPUT] + REPORT_SPARE;
	device->feature_size = found->tracker.longest[GZ_HID_FEATURE] + REPORT_SPARE;
	device->report = calloc(1, device->report_size);
	device->last = calloc(1, device->report_size);
	device->feature = calloc(1, device->feature_size);
	if (device->report && device->last && device->feature)
		return device;
	hid_destroy(&device->base);
	return NULL;
}

static enum gz_result refuse_hid_tracker(const struct hid_found *found,
					 const struct gz_driver_host *host)
{
	const char *choice = host->choice;
	if (found) {
		gz_err(host->log, "%s (%s) is not usable: %s", found->entry.name,
		       found->entry.place, found->entry.reason);
		/* A malformed descriptor will not change, but another tracker may be plugged in. */
		return found->result == GZ_ERR_ACCESS ? GZ_ERR_ACCESS : GZ_ERR_NO_DEVICE;
	}
	if (choice && choice[0])
		gz_err(host->log,
		       "no HID eye tracker has the name, serial number or place %s; see gazectl "
		       "devices",
		       choice);
	else
		gz_err(host->log, "no HID eye tracker (usage page 0x12) found; plug one in");
	return GZ_ERR_NO_DEVICE;
}

static void init_hid_clock(struct gz_hid_device *device)
{
	const struct gz_hid_value *ticks = &device->tracker.values[GZ_HID_TICKS];
	if (device->tracker.time_refused)
		gz_warn(device->base.log,
			"%s: its time stamps have more than 64 bits or no unit of time; times of "
			"arrival are used",
			device->entry.name);
	if (ticks->present)
		gz_clock_ticks_init(&device->clock, ticks->bits, ticks->scale);
	device->silence.nominal_ns = device->rate_hz > 0 ? 1e9 / device->rate_hz : 0;
}

static enum gz_result open_hid_tracker(const struct gz_hid_settings *settings,
				       const struct hid_found *found,
				       const struct gz_driver_host *host,
				       struct gz_device **out_device)
{
	struct gz_hid_device *device = allocate_hid_device(settings, found, host->log);
	if (!device)
		return GZ_ERR_NO_MEM;
	enum gz_result result = gz_hid_port_open(found->entry.place, &device->port);
	if (result != GZ_OK) {
		gz_err(host->log, "cannot open %s (%s): %s", found->entry.name, found->entry.place,
		       gz_result_text(result));
		hid_destroy(&device->base);
		return result;
	}
	gz_hid_setup_ask(device, host->display_mm);
	init_hid_clock(device);
	*out_device = &device->base;
	return GZ_OK;
}

static enum gz_result hid_create(const void *settings, const struct gz_driver_host *host,
				 struct gz_device **out_device)
{
	size_t count = 0;
	struct hid_found *all = calloc(GZ_DEVICE_ENTRIES_MAX, sizeof *all);
	if (!all)
		return GZ_ERR_NO_MEM;
	enum gz_result result = find_hid_trackers(all, &count);
	if (result == GZ_OK) {
		const struct hid_found *found = choose_hid_tracker(all, count, host->choice);
		result = found && found->result == GZ_OK
				 ? open_hid_tracker(settings, found, host, out_device)
				 : refuse_hid_tracker(found, host);
	}
	free(all);
	return result;
}

static size_t hid_list(const void *settings, const struct gz_driver_host *host,
		       struct gz_device_entry *out_entries)
{
	size_t count = 0;
	(void)settings;
	(void)host;
	struct hid_found *all = calloc(GZ_DEVICE_ENTRIES_MAX, sizeof *all);
	if (!all || find_hid_trackers(all, &count) != GZ_OK)
		count = 0;
	for (size_t i = 0; i < count; i++)
		out_entries[i] = all[i].entry;
	free(all);
	return count;
}

_Static_assert(sizeof(struct gz_hid_settings) <= GZ_DRIVER_SETTINGS_SIZE, "settings fit");

const struct gz_driver gz_driver_hid = {
	.name = "hid",
	.help = "any eye tracker of the HID class (usage page 0x12)",
	.options = hid_options,
	.option_count = &hid_option_count,
	.settings_size = sizeof(struct gz_hid_settings),
	.on_usb = true,
	.create = hid_create,
	.list = hid_list,
};
