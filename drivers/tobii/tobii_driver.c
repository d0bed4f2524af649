/**
 * @file
 * Tobii Pro eye trackers, by the Tobii Pro SDK that the user has installed (tobii_library.h). The
 * SDK calls back on a thread of its own; a ring without locks passes its data to the reading
 * thread.
 *
 * If the connection is lost, or the display area or the frequency is set to another value, the
 * tracker counts as unplugged: the daemon closes it and searches for it again.
 */
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "drivers/device/clock_model.h"
#include "drivers/device/device.h"
#include "drivers/tobii/tobii_gaze.h"
#include "drivers/tobii/tobii_library.h"

#define GZ_LOG_MODULE "tobii"

/* Time between two comparisons of the clock of the library with the host clock, ns. Chosen: both
 * count the same crystal; if the clock of the library is set, a second is soon enough. */
#define COMPARE_NS GZ_NS_PER_S

/* Readings for one comparison. The tightest one counts, because the others were interrupted. */
enum { READINGS = 5 };

/* Longest wait for a callback that is still running, ns. Chosen: it copies 136 bytes. */
#define CALLBACK_PATIENCE_NS GZ_NS_PER_S

struct tobii_settings {
	char library[GZ_PATH_SIZE];
	double rate_hz;
};

#define AT(field) offsetof(struct tobii_settings, field)

static const struct gz_option tobii_options[] = {
	{ "tobii.library", GZ_OPTION_STRING, AT(library), 0, GZ_PATH_SIZE,
	  .preset = "libtobii_research.so",
	  .help = "library of the Tobii Pro SDK: a file, or a name that the dynamic linker looks "
		  "up" },
	{ "tobii.rate_hz", GZ_OPTION_DOUBLE, AT(rate_hz), 0, 5000, .preset = "0",
	  .help = "gaze output frequency to set, Hz, one that the tracker offers; 0 does not "
		  "change it" },
};

static const size_t tobii_option_count = sizeof tobii_options / sizeof *tobii_options;

/* What the thread of the SDK uses. It outlives the device if a callback hangs. */
struct tobii_mail {
	const struct gz_log *log;
	struct gz_tobii_ring *ring;
	double rate_hz; /* at the time of the subscription; 0 if unknown */
	double display_mm[2];
	atomic_int running;  /* callbacks that are running */
	atomic_bool closed;  /* nothing more is accepted */
	atomic_bool gone;    /* the connection is lost */
	atomic_bool changed; /* the display area or the frequency has changed */
};

struct tobii_device {
	struct gz_device base;
	struct gz_tobii_library library;
	struct gz_tobii_tracker *tracker;
	struct gz_device_info info;
	struct tobii_mail *mail;
	bool subscribed;
	bool notified;
	struct gz_tobii_time time;
	int64_t compare_ns; /* when to compare the clocks again, host time */
	struct gz_clock_model clock;
	struct gz_ratelimit jumps;
	int64_t host_ns; /* of the newest sample */
	uint64_t seq;
	uint64_t lost;
};

static struct tobii_device *tobii_device_of(struct gz_device *device)
{
	return (struct tobii_device *)device;
}

/* Called on the thread of the SDK. */
static void on_tobii_gaze(struct gz_tobii_gaze *gaze, void *user)
{
	struct tobii_mail *mail = user;
	atomic_fetch_add(&mail->running, 1);
	if (gaze && !atomic_load(&mail->closed))
		gz_tobii_ring_put(mail->ring, gaze, gz_clock_now_ns());
	atomic_fetch_sub(&mail->running, 1);
}

/* Whether a notification reports a new value. Setting the present value again, as this driver
 * itself may do, changes nothing. */
static bool reports_new_value(const struct tobii_mail *mail,
			      const struct gz_tobii_notification *notification)
{
	const struct gz_tobii_display_area *area = &notification->value.display_area;
	if (notification->type == GZ_TOBII_FREQUENCY_CHANGED)
		return notification->value.frequency_hz != (float)mail->rate_hz;
	return area->width_mm != (float)mail->display_mm[0] ||
	       area->height_mm != (float)mail->display_mm[1];
}

static void handle_notification(struct tobii_mail *mail,
				const struct gz_tobii_notification *notification)
{
	switch (notification->type) {
	case GZ_TOBII_CONNECTION_LOST:
		atomic_store(&mail->gone, true);
		gz_tobii_ring_wake(mail->ring);
		return;
	case GZ_TOBII_DISPLAY_AREA_CHANGED:
	case GZ_TOBII_FREQUENCY_CHANGED:
		if (!reports_new_value(mail, notification))
			return;
		atomic_store(&mail->changed, true);
		gz_tobii_ring_wake(mail->ring);
		return;
	case GZ_TOBII_DEVICE_FAULTS:
		gz_warn(mail->log, "the tracker reports a fault: %.200s", notification->value.text);
		return;
	case GZ_TOBII_DEVICE_WARNINGS:
		gz_warn(mail->log, "the tracker reports a warning: %.200s",
			notification->value.text);
		return;
	default:
		return;
	}
}

/* Called on the thread of the SDK. */
static void on_tobii_notification(struct gz_tobii_notification *notification, void *user)
{
	struct tobii_mail *mail = user;
	atomic_fetch_add(&mail->running, 1);
	if (notification && !atomic_load(&mail->closed))
		handle_notification(mail, notification);
	atomic_fetch_sub(&mail->running, 1);
}

static enum gz_result create_tobii_mail(const struct gz_log *log, struct tobii_mail **out_mail)
{
	struct tobii_mail *mail = calloc(1, sizeof *mail);
	if (!mail)
		return GZ_ERR_NO_MEM;
	mail->log = log;
	enum gz_result result = gz_tobii_ring_create(&mail->ring);
	if (result != GZ_OK) {
		free(mail);
		return result;
	}
	*out_mail = mail;
	return GZ_OK;
}

/* If a callback hangs, keep its memory: a leak is better than use after free. */
static void destroy_tobii_mail(struct tobii_mail **mail)
{
	if (!*mail)
		return;
	int64_t deadline_ns = gz_clock_now_ns() + CALLBACK_PATIENCE_NS;
	atomic_store(&(*mail)->closed, true);
	while (atomic_load(&(*mail)->running) > 0 && gz_clock_now_ns() < deadline_ns)
		gz_clock_sleep_until_ns(gz_clock_now_ns() + GZ_NS_PER_MS);
	if (atomic_load(&(*mail)->running) == 0) {
		gz_tobii_ring_destroy(&(*mail)->ring);
		free(*mail);
	}
	*mail = NULL;
}

/* Take several readings of the clock of the library and keep the tightest. */
static void compare_tobii_clocks(struct tobii_device *device, int64_t now_ns)
{
	struct gz_tobii_time best = { 0 };
	for (int i = 0; i < READINGS; i++) {
		int64_t system_us;
		struct gz_tobii_time time;
		int64_t before_ns = gz_clock_now_ns();
		gz_tobii_status status = device->library.get_system_time_stamp(&system_us);
		int64_t after_ns = gz_clock_now_ns();
		if (status != GZ_TOBII_OK ||
		    !gz_tobii_time_read(&time, before_ns, system_us, after_ns))
			continue;
		if (!best.known || time.error_ns < best.error_ns)
			best = time;
	}
	device->time = best;
	device->compare_ns = now_ns + COMPARE_NS;
}

static enum gz_result tobii_start(struct gz_device *base)
{
	struct tobii_device *device = tobii_device_of(base);
	struct gz_tobii_library *library = &device->library;
	compare_tobii_clocks(device, gz_clock_now_ns());
	device->mail->rate_hz = device->info.rate_hz;
	memcpy(device->mail->display_mm, device->info.display.mm, sizeof device->mail->display_mm);
	if (library->subscribe_to_notifications && library->unsubscribe_from_notifications)
		device->notified =
			library->subscribe_to_notifications(device->tracker, on_tobii_notification,
							    device->mail) == GZ_TOBII_OK;
	gz_tobii_status status =
		library->subscribe_to_gaze_data(device->tracker, on_tobii_gaze, device->mail);
	device->subscribed = status == GZ_TOBII_OK;
	if (device->subscribed)
		return GZ_OK;
	gz_err(base->log,
	       "%s cannot send gaze data: SDK status %d; set it up with Tobii's Eye Tracker "
	       "Manager",
	       device->info.name, status);
	return GZ_ERR_NO_DEVICE;
}

/* The system time stamp, which the SDK derives by its own clock comparison, says when a sample was
 * taken. The clock model makes it run evenly and detects jumps. */
static void stamp_tobii_sample(struct tobii_device *device,
			       const struct gz_tobii_delivery *delivery, struct gz_sample *sample)
{
	bool jumped = false;
	int64_t taken_ns =
		gz_tobii_time_of(&device->time, delivery->gaze.system_us, delivery->arrival_ns);
	if (taken_ns < device->host_ns)
		taken_ns = device->host_ns;
	sample->device_ns = gz_tobii_device_ns(delivery->gaze.device_us);
	sample->host_ns = taken_ns;
	if (sample->device_ns != GZ_NO_DEVICE_TIME)
		sample->host_ns =
			gz_clock_model_step(&device->clock, sample->device_ns, taken_ns, &jumped);
	if (jumped)
		gz_warn_limited(device->base.log, &device->jumps,
				"%s: the clock jumped; the clock fit starts again",
				device->info.name);
	device->host_ns = sample->host_ns;
}

static void deliver_tobii_sample(struct tobii_device *device,
				 const struct gz_tobii_delivery *delivery,
				 struct gz_sample *out_sample)
{
	struct gz_sample sample = gz_tobii_sample(&delivery->gaze);
	stamp_tobii_sample(device, delivery, &sample);
	sample.lost_before = delivery->lost_before;
	device->lost += delivery->lost_before;
	sample.seq = device->seq++;
	*out_sample = sample;
}

/* Whether the device must be reopened. */
static bool must_reopen_tobii(struct tobii_device *device)
{
	const char *name = device->info.name;
	if (atomic_load(&device->mail->gone)) {
		gz_warn(device->base.log, "%s is gone: the connection is lost", name);
		return true;
	}
	if (atomic_load(&device->mail->changed)) {
		gz_warn(device->base.log, "%s has new settings; reopening it", name);
		return true;
	}
	return false;
}

/* No allocation, no lock. */
static enum gz_result tobii_read(struct gz_device *base, int timeout_ms,
				 struct gz_sample *out_sample)
{
	struct tobii_device *device = tobii_device_of(base);
	struct gz_tobii_delivery delivery;
	int64_t now_ns = gz_clock_now_ns();
	int64_t deadline_ns = now_ns + timeout_ms * GZ_NS_PER_MS;
	if (now_ns >= device->compare_ns)
		compare_tobii_clocks(device, now_ns);
	while (!gz_tobii_ring_take(device->mail->ring, &delivery)) {
		if (must_reopen_tobii(device))
			return GZ_ERR_NO_DEVICE;
		if (gz_clock_now_ns() >= deadline_ns)
			return GZ_ERR_TIMEOUT;
		gz_tobii_ring_wait(device->mail->ring, deadline_ns);
	}
	deliver_tobii_sample(device, &delivery, out_sample);
	return GZ_OK;
}

static void tobii_info(const struct gz_device *base, struct gz_device_info *out_info)
{
	*out_info = ((const struct tobii_device *)base)->info;
}

static void tobii_counters(const struct gz_device *base, struct gz_device_counters *out_counters)
{
	const struct tobii_device *device = (const struct tobii_device *)base;
	*out_counters = (struct gz_device_counters) {
		.lost = device->lost,
		.clock = gz_clock_model_status(&device->clock, GZ_CLOCK_DECLARED),
	};
}

static void tobii_destroy(struct gz_device *base)
{
	struct tobii_device *device = tobii_device_of(base);
	if (device->subscribed)
		device->library.unsubscribe_from_gaze_data(device->tracker, on_tobii_gaze);
	if (device->notified)
		device->library.unsubscribe_from_notifications(device->tracker,
							       on_tobii_notification);
	destroy_tobii_mail(&device->mail);
	gz_tobii_library_close(&device->library);
	free(device);
}

static const struct gz_device_ops tobii_ops = {
	.start = tobii_start,
	.read = tobii_read,
	.info = tobii_info,
	.counters = tobii_counters,
	.destroy = tobii_destroy,
};

/* Get the display size from the display area. The SDK does not know its pixels. */
static void get_tobii_display(struct tobii_device *device)
{
	struct gz_tobii_display_area area = { 0 };
	gz_tobii_status status = device->library.get_display_area(device->tracker, &area);
	struct gz_display display = gz_display_default(1920, 1080);
	display.mm[0] = area.width_mm;
	display.mm[1] = area.height_mm;
	device->info.has_display = status == GZ_TOBII_OK && gz_display_valid(&display);
	device->info.display = display;
	if (!device->info.has_display)
		gz_warn(device->base.log,
			"%s has no display area (SDK status %d); set it with Tobii's Eye Tracker "
			"Manager, or set display.mm",
			device->info.name, status);
}

static enum gz_result set_tobii_rate(struct tobii_device *device, double rate_hz)
{
	float frequency_hz = 0;
	struct gz_tobii_library *library = &device->library;
	if (rate_hz > 0) {
		gz_tobii_status status =
			library->set_gaze_output_frequency(device->tracker, (float)rate_hz);
		if (status != GZ_TOBII_OK) {
			gz_err(device->base.log,
			       "tobii.rate_hz %g: %s rejects it (SDK status %d); use a frequency "
			       "that Tobii's Eye Tracker Manager offers, or 0",
			       rate_hz, device->info.name, status);
			return GZ_ERR_INVAL;
		}
		device->info.rate_hz = rate_hz;
	}
	if (library->get_gaze_output_frequency &&
	    library->get_gaze_output_frequency(device->tracker, &frequency_hz) == GZ_TOBII_OK &&
	    frequency_hz > 0 && isfinite(frequency_hz))
		device->info.rate_hz = (double)frequency_hz;
	return GZ_OK;
}

static enum gz_result open_tobii_library(struct tobii_device *device,
					 const struct tobii_settings *settings)
{
	char reason[GZ_TOBII_REASON_SIZE];
	enum gz_result result = gz_tobii_library_open(settings->library, &device->library, reason);
	if (result != GZ_OK)
		gz_err(device->base.log, "%s", reason);
	return result;
}

static enum gz_result open_tobii_tracker(struct tobii_device *device,
					 const struct tobii_settings *settings, const char *choice)
{
	struct gz_tobii_found found;
	const struct gz_log *log = device->base.log;
	enum gz_result result = gz_tobii_find(&device->library, log, &found);
	if (result != GZ_OK)
		return result;
	size_t chosen = gz_tobii_choose(&device->library, &found, choice, log);
	if (chosen == found.count)
		return GZ_ERR_NO_DEVICE;
	const struct gz_device_entry *entry = &found.entries[chosen];
	device->tracker = found.trackers[chosen];
	memcpy(device->info.name, entry->name, sizeof device->info.name);
	memcpy(device->info.serial, entry->serial, sizeof device->info.serial);
	result = set_tobii_rate(device, settings->rate_hz);
	if (result == GZ_OK)
		get_tobii_display(device);
	return result;
}

static enum gz_result tobii_create(const void *settings, const struct gz_driver_host *host,
				   struct gz_device **out_device)
{
	struct tobii_device *device = calloc(1, sizeof *device);
	if (!device)
		return GZ_ERR_NO_MEM;
	device->base = (struct gz_device) { .ops = &tobii_ops, .log = host->log };
	enum gz_result result = create_tobii_mail(host->log, &device->mail);
	if (result == GZ_OK)
		result = open_tobii_library(device, settings);
	if (result == GZ_OK)
		result = open_tobii_tracker(device, settings, host->choice);
	if (result != GZ_OK) {
		tobii_destroy(&device->base);
		return result;
	}
	*out_device = &device->base;
	return GZ_OK;
}

/* Without the library nothing can be listed. */
static size_t tobii_list(const void *settings, const struct gz_driver_host *host,
			 struct gz_device_entry *out_entries)
{
	const struct tobii_settings *wanted = settings;
	struct gz_tobii_library library;
	struct gz_tobii_found found;
	char reason[GZ_TOBII_REASON_SIZE];
	(void)host;
	if (gz_tobii_library_open(wanted->library, &library, reason) != GZ_OK)
		return 0;
	gz_tobii_find(&library, NULL, &found);
	memcpy(out_entries, found.entries, found.count * sizeof *out_entries);
	gz_tobii_library_close(&library);
	return found.count;
}

_Static_assert(sizeof(struct tobii_settings) <= GZ_DRIVER_SETTINGS_SIZE, "settings fit");

const struct gz_driver gz_driver_tobii = {
	.name = "tobii",
	.help = "Tobii Pro eye trackers, by the library of the Tobii Pro SDK that is installed "
		"here",
	.options = tobii_options,
	.option_count = &tobii_option_count,
	.settings_size = sizeof(struct tobii_settings),
	.create = tobii_create,
	.list = tobii_list,
};
