#include "drivers/tobii/tobii_driver.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "drivers/clock_model.h"
#include "drivers/tobii/tobii_find.h"
#include "drivers/tobii/tobii_library.h"
#include "drivers/tobii/tobii_ring.h"
#include "drivers/tobii/tobii_sample.h"

#define GZ_LOG_MODULE "tobii"

/* How often the library's clock is compared to the host's. Chosen: both count the same crystal, and
 * where the library's is set instead, a second is soon enough. */
#define COMPARE_NS GZ_NS_PER_S

/* Readings of which the closest counts: the others were interrupted. */
enum { READINGS = 5 };

/* How long a callback that is still running is waited for. Chosen: it copies 136 bytes. */
#define CALLBACK_PATIENCE_NS GZ_NS_PER_S

struct tobii_settings {
	char library[GZ_PATH_SIZE];
	double rate_hz;
};

#define AT(field) offsetof(struct tobii_settings, field)

static const struct gz_option tobii_options[] = {
	{ "tobii.library", GZ_OPTION_STRING, AT(library), 0, GZ_PATH_SIZE, 0, NULL,
	  "libtobii_research.so",
	  "the Tobii Pro SDK's library: a file, or a name that is looked up" },
	{ "tobii.rate_hz", GZ_OPTION_DOUBLE, AT(rate_hz), 0, 5000, 0, NULL, "0",
	  "gaze output frequency to set, Hz, one of the tracker's own; 0 leaves it as it is" },
};

static const size_t tobii_option_count = sizeof tobii_options / sizeof *tobii_options;

/* What the SDK's thread uses; it may outlive the device by a callback that hangs. */
struct tobii_mail {
	const struct gz_log *log;
	struct gz_tobii_ring *ring;
	double rate_hz; /* as known when it was subscribed to; 0 if unknown */
	double display_mm[2];
	atomic_int running;  /* callbacks */
	atomic_bool closed;  /* nothing more is taken */
	atomic_bool gone;    /* the connection is lost */
	atomic_bool changed; /* the display area or the frequency is another one */
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
	int64_t compare_ns; /* when to compare the clocks again */
	struct gz_clock_model clock;
	struct gz_ratelimit jumps;
	int64_t host_ns; /* newest sample's */
	uint64_t seq;
	uint64_t lost;
};

static struct tobii_device *of(struct gz_device *device)
{
	return (struct tobii_device *)device;
}

/* On the SDK's thread. */
static void take_gaze(struct gz_tobii_gaze *gaze, void *user)
{
	struct tobii_mail *mail = user;
	atomic_fetch_add(&mail->running, 1);
	if (gaze && !atomic_load(&mail->closed))
		gz_tobii_ring_put(mail->ring, gaze, gz_clock_now_ns());
	atomic_fetch_sub(&mail->running, 1);
}

/* Whoever sets what is set already, as this driver itself, changes nothing. */
static bool tells_news(const struct tobii_mail *mail,
		       const struct gz_tobii_notification *notification)
{
	const struct gz_tobii_display_area *area = &notification->value.display_area;
	if (notification->type == GZ_TOBII_FREQUENCY_CHANGED)
		return notification->value.frequency_hz != (float)mail->rate_hz;
	return area->width_mm != (float)mail->display_mm[0] ||
	       area->height_mm != (float)mail->display_mm[1];
}

static void obey_notification(struct tobii_mail *mail,
			      const struct gz_tobii_notification *notification)
{
	switch (notification->type) {
	case GZ_TOBII_CONNECTION_LOST:
		atomic_store(&mail->gone, true);
		gz_tobii_ring_wake(mail->ring);
		return;
	case GZ_TOBII_DISPLAY_AREA_CHANGED:
	case GZ_TOBII_FREQUENCY_CHANGED:
		if (!tells_news(mail, notification))
			return;
		atomic_store(&mail->changed, true);
		gz_tobii_ring_wake(mail->ring);
		return;
	case GZ_TOBII_DEVICE_FAULTS:
		gz_warn(mail->log, "the tracker reports a fault: %.200s", notification->value.text);
		return;
	case GZ_TOBII_DEVICE_WARNINGS:
		gz_warn(mail->log, "the tracker warns: %.200s", notification->value.text);
		return;
	default:
		return;
	}
}

/* On the SDK's thread. */
static void take_notification(struct gz_tobii_notification *notification, void *user)
{
	struct tobii_mail *mail = user;
	atomic_fetch_add(&mail->running, 1);
	if (notification && !atomic_load(&mail->closed))
		obey_notification(mail, notification);
	atomic_fetch_sub(&mail->running, 1);
}

static enum gz_result make_mail(const struct gz_log *log, struct tobii_mail **out_mail)
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

/* Where a callback hangs, its memory is left to it: better lost than used after it is freed. */
static void free_mail(struct tobii_mail **mail)
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

/* The closest of several readings of the library's clock. */
static void compare_clocks(struct tobii_device *device, int64_t now_ns)
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
	struct tobii_device *device = of(base);
	struct gz_tobii_library *library = &device->library;
	compare_clocks(device, gz_clock_now_ns());
	device->mail->rate_hz = device->info.rate_hz;
	memcpy(device->mail->display_mm, device->info.display.mm, sizeof device->mail->display_mm);
	if (library->subscribe_to_notifications && library->unsubscribe_from_notifications)
		device->notified =
			library->subscribe_to_notifications(device->tracker, take_notification,
							    device->mail) == GZ_TOBII_OK;
	gz_tobii_status status =
		library->subscribe_to_gaze_data(device->tracker, take_gaze, device->mail);
	device->subscribed = status == GZ_TOBII_OK;
	if (device->subscribed)
		return GZ_OK;
	gz_err(base->log,
	       "%s gives no gaze data: the SDK's status is %d; set it up with Tobii's Eye Tracker "
	       "Manager",
	       device->info.name, status);
	return GZ_ERR_NO_DEVICE;
}

/* The SDK's own comparison of the clocks says when a sample was taken; the model makes of that a
 * time that runs evenly, and of a jump a new beginning. */
static void stamp(struct tobii_device *device, const struct gz_tobii_delivery *delivery,
		  struct gz_sample *sample)
{
	uint64_t held_back;
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
	if (jumped &&
	    gz_ratelimit_pass(&device->jumps, delivery->arrival_ns, GZ_NS_PER_S, &held_back))
		gz_warn(device->base.log,
			"the tracker's clock jumped; its fit begins again (%llu more since last "
			"told)",
			(unsigned long long)held_back);
	device->host_ns = sample->host_ns;
}

static void deliver(struct tobii_device *device, const struct gz_tobii_delivery *delivery,
		    struct gz_sample *out_sample)
{
	struct gz_sample sample = gz_tobii_sample(&delivery->gaze);
	stamp(device, delivery, &sample);
	sample.lost_before = delivery->lost_before;
	device->lost += delivery->lost_before;
	sample.seq = device->seq++;
	*out_sample = sample;
}

/* Whether the device must be opened anew. */
static bool is_over(struct tobii_device *device)
{
	const char *name = device->info.name;
	if (atomic_load(&device->mail->gone)) {
		gz_warn(device->base.log, "%s has gone: the connection is lost", name);
		return true;
	}
	if (atomic_load(&device->mail->changed)) {
		gz_warn(device->base.log, "%s was set up anew; it is opened again", name);
		return true;
	}
	return false;
}

/* No allocation, no lock. */
static enum gz_result tobii_read(struct gz_device *base, int timeout_ms,
				 struct gz_sample *out_sample)
{
	struct tobii_device *device = of(base);
	struct gz_tobii_delivery delivery;
	int64_t now_ns = gz_clock_now_ns();
	int64_t deadline_ns = now_ns + timeout_ms * GZ_NS_PER_MS;
	if (now_ns >= device->compare_ns)
		compare_clocks(device, now_ns);
	while (!gz_tobii_ring_take(device->mail->ring, &delivery)) {
		if (is_over(device))
			return GZ_ERR_NO_DEVICE;
		if (gz_clock_now_ns() >= deadline_ns)
			return GZ_ERR_TIMEOUT;
		gz_tobii_ring_wait(device->mail->ring, deadline_ns);
	}
	deliver(device, &delivery, out_sample);
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
	struct tobii_device *device = of(base);
	if (device->subscribed)
		device->library.unsubscribe_from_gaze_data(device->tracker, take_gaze);
	if (device->notified)
		device->library.unsubscribe_from_notifications(device->tracker, take_notification);
	free_mail(&device->mail);
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

/* The size of the display is what its area says; its pixels the SDK does not know. */
static void ask_display(struct tobii_device *device)
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
			"%s has no display area (the SDK's status is %d); set it with Tobii's Eye "
			"Tracker Manager, or give display.mm",
			device->info.name, status);
}

static enum gz_result set_rate(struct tobii_device *device, double rate_hz)
{
	float frequency_hz = 0;
	struct gz_tobii_library *library = &device->library;
	if (rate_hz > 0) {
		gz_tobii_status status =
			library->set_gaze_output_frequency(device->tracker, (float)rate_hz);
		if (status != GZ_TOBII_OK) {
			gz_err(device->base.log,
			       "tobii.rate_hz %g: %s refuses it (the SDK's status is %d); give one "
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

static enum gz_result open_library(struct tobii_device *device,
				   const struct tobii_settings *settings)
{
	char reason[GZ_TOBII_REASON_SIZE];
	enum gz_result result = gz_tobii_library_open(settings->library, &device->library, reason);
	if (result != GZ_OK)
		gz_err(device->base.log, "%s", reason);
	return result;
}

static enum gz_result open_tracker(struct tobii_device *device,
				   const struct tobii_settings *settings, const char *choice)
{
	struct gz_tobii_tracker *trackers[GZ_DEVICE_ENTRIES_MAX];
	struct gz_device_entry entries[GZ_DEVICE_ENTRIES_MAX];
	size_t count;
	const struct gz_log *log = device->base.log;
	enum gz_result result = gz_tobii_find(&device->library, log, trackers, entries, &count);
	if (result != GZ_OK)
		return result;
	size_t chosen = gz_tobii_choose(&device->library, trackers, entries, count, choice, log);
	if (chosen == count)
		return GZ_ERR_NO_DEVICE;
	device->tracker = trackers[chosen];
	memcpy(device->info.name, entries[chosen].name, sizeof device->info.name);
	memcpy(device->info.serial, entries[chosen].serial, sizeof device->info.serial);
	result = set_rate(device, settings->rate_hz);
	if (result == GZ_OK)
		ask_display(device);
	return result;
}

static enum gz_result tobii_create(const void *settings, const struct gz_driver_host *host,
				   struct gz_device **out_device)
{
	struct tobii_device *device = calloc(1, sizeof *device);
	if (!device)
		return GZ_ERR_NO_MEM;
	device->base = (struct gz_device) { .ops = &tobii_ops, .log = host->log };
	enum gz_result result = make_mail(host->log, &device->mail);
	if (result == GZ_OK)
		result = open_library(device, settings);
	if (result == GZ_OK)
		result = open_tracker(device, settings, host->choice);
	if (result != GZ_OK) {
		tobii_destroy(&device->base);
		return result;
	}
	*out_device = &device->base;
	return GZ_OK;
}

/* Without the library nothing can be said of what is there. */
static size_t tobii_list(const void *settings, const struct gz_driver_host *host,
			 struct gz_device_entry *out_entries)
{
	struct gz_tobii_tracker *trackers[GZ_DEVICE_ENTRIES_MAX];
	struct gz_tobii_library library;
	char reason[GZ_TOBII_REASON_SIZE];
	size_t count = 0;
	(void)host;
	const struct tobii_settings *wanted = settings;
	if (gz_tobii_library_open(wanted->library, &library, reason) != GZ_OK)
		return 0;
	if (gz_tobii_find(&library, NULL, trackers, out_entries, &count) != GZ_OK)
		count = 0;
	gz_tobii_library_close(&library);
	return count;
}

_Static_assert(sizeof(struct tobii_settings) <= GZ_DRIVER_SETTINGS_SIZE, "settings fit");

const struct gz_driver gz_driver_tobii = {
	.name = "tobii",
	.help = "Tobii Pro eye trackers, by the Tobii Pro SDK's library that is installed here",
	.options = tobii_options,
	.option_count = &tobii_option_count,
	.settings_size = sizeof(struct tobii_settings),
	.create = tobii_create,
	.list = tobii_list,
};
