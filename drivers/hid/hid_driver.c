#include "drivers/hid/hid_driver.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "drivers/hid/hid_device.h"
#include "drivers/hid/hid_find.h"

#define GZ_LOG_MODULE "hid"

/* Room beyond the longest report, so that a longer one is seen to be longer. */
enum { REPORT_SPARE = 8 };

/* Pixels of a display that only its size is known of, as elsewhere in the daemon. */
enum { WIDTH_PX = 1920, HEIGHT_PX = 1080 };

#define AT(field) offsetof(struct gz_hid_settings, field)

static const struct gz_option hid_options[] = {
	{ "hid.screen_mm", GZ_OPTION_DOUBLE, AT(screen_mm), 0, 100000, 2, NULL, "0 0",
	  "width and height of the screen it is calibrated to, mm; 0 0: as it says, else "
	  "display.mm" },
	{ "hid.eye_positions", GZ_OPTION_BOOL, AT(eye_positions), 0, 0, 0, NULL, "yes",
	  "ask for the eyes' positions beside the gaze point" },
};

static const size_t hid_option_count = sizeof hid_options / sizeof *hid_options;

static struct gz_hid_device *of(struct gz_device *device)
{
	return (struct gz_hid_device *)device;
}

static enum gz_result hid_start(struct gz_device *base)
{
	gz_hid_setup_start(of(base));
	return GZ_OK;
}

static enum gz_result hid_read_sample(struct gz_device *base, int timeout_ms,
				      struct gz_sample *out_sample)
{
	return gz_hid_stream_read(of(base), timeout_ms, out_sample);
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

/* Also right for a device that create() gave up half-way. */
static void hid_destroy(struct gz_device *base)
{
	struct gz_hid_device *device = of(base);
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

/* All that a device needs, but the open interface. */
static struct gz_hid_device *new_device(const struct gz_hid_settings *settings,
					const struct gz_hid_found *found, const struct gz_log *log)
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

static enum gz_result refuse(const struct gz_hid_found *found, const struct gz_driver_host *host)
{
	const char *choice = host->choice;
	if (found) {
		gz_err(host->log, "%s (%s) is not usable: %s", found->entry.name,
		       found->entry.place, found->entry.reason);
		/* A descriptor does not get better, but another tracker may be plugged in. */
		return found->result == GZ_ERR_ACCESS ? GZ_ERR_ACCESS : GZ_ERR_NO_DEVICE;
	}
	if (choice && choice[0])
		gz_err(host->log,
		       "no HID eye tracker has the name or serial number %s; gazectl devices lists "
		       "what is there",
		       choice);
	else
		gz_err(host->log, "no HID eye tracker (usage page 0x12) is there; plug one in");
	return GZ_ERR_NO_DEVICE;
}

static void begin_clock(struct gz_hid_device *device)
{
	const struct gz_hid_value *ticks = &device->tracker.values[GZ_HID_TICKS];
	if (device->tracker.time_refused)
		gz_warn(device->base.log,
			"%s: its time stamps have more than 64 bits, or no unit of time; times of "
			"arrival are used",
			device->entry.name);
	if (ticks->present)
		gz_clock_ticks_init(&device->clock, ticks->bits, ticks->scale);
	device->silence.nominal_ns = device->rate_hz > 0 ? 1e9 / device->rate_hz : 0;
}

static enum gz_result open_found(const struct gz_hid_settings *settings,
				 const struct gz_hid_found *found,
				 const struct gz_driver_host *host, struct gz_device **out_device)
{
	struct gz_hid_device *device = new_device(settings, found, host->log);
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
	begin_clock(device);
	*out_device = &device->base;
	return GZ_OK;
}

static enum gz_result hid_create(const void *settings, const struct gz_driver_host *host,
				 struct gz_device **out_device)
{
	size_t count = 0;
	struct gz_hid_found *all = calloc(GZ_DEVICE_ENTRIES_MAX, sizeof *all);
	if (!all)
		return GZ_ERR_NO_MEM;
	enum gz_result result = gz_hid_find(all, &count);
	if (result == GZ_OK) {
		const struct gz_hid_found *found = gz_hid_choose(all, count, host->choice);
		result = found && found->result == GZ_OK
				 ? open_found(settings, found, host, out_device)
				 : refuse(found, host);
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
	struct gz_hid_found *all = calloc(GZ_DEVICE_ENTRIES_MAX, sizeof *all);
	if (!all || gz_hid_find(all, &count) != GZ_OK)
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
