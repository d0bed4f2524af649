/**
 * @file
 * The eye tracker of a PlayStation VR2 on a USB port: a vendor-specific interface, read with
 * libusb. Its gaze is relative to the head; the configuration says where the screen is.
 */
#include <libusb.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "drivers/device/clock_model.h"
#include "drivers/device/device.h"
#include "drivers/psvr2/psvr2_link.h"
#include "drivers/psvr2/psvr2_packet.h"
#include "drivers/usb/usb_device.h"

#define GZ_LOG_MODULE "psvr2"

static const char fallback_name[] = "PlayStation VR2";

struct psvr2_settings {
	struct gz_psvr2_screen_params screen;
	int screen_px[2];
};

#define AT(field) offsetof(struct psvr2_settings, field)

/* The preset distance is that of gz_display_default(). */
static const struct gz_option psvr2_options[] = {
	{ "psvr2.screen_distance_mm", GZ_OPTION_DOUBLE, AT(screen.distance_mm), 10, 100000,
	  .preset = "600",
	  .help = "distance of the centre of the screen from the point between the lenses, "
		  "straight ahead, mm" },
	{ "psvr2.screen_offset_mm", GZ_OPTION_DOUBLE, AT(screen.offset_mm), -100000, 100000,
	  .count = 2, .preset = "0 0",
	  .help = "offset of the centre of the screen from straight ahead, right and down, mm" },
	{ "psvr2.screen_mm", GZ_OPTION_DOUBLE, AT(screen.size_mm), 0, 100000, .count = 2,
	  .preset = "0 0",
	  .help = "width and height of the screen, mm; 0 0: display.mm, or 50.4 degrees wide at "
		  "600 mm if that is not set" },
	{ "psvr2.screen_turn_deg", GZ_OPTION_DOUBLE, AT(screen.turn_deg), -180, 180, .count = 3,
	  .preset = "0 0 0",
	  .help = "rotation of the screen about its centre, degrees: right side nearer, lower edge "
		  "nearer, clockwise" },
	{ "psvr2.screen_px", GZ_OPTION_SIZE, AT(screen_px), 1, 32768, .preset = "1920x1080",
	  .help = "resolution of the screen, pixels" },
};

static const size_t psvr2_option_count = sizeof psvr2_options / sizeof *psvr2_options;

struct psvr2_device {
	struct gz_device base;
	libusb_context *context;
	libusb_device_handle *handle;
	bool claimed;
	struct gz_psvr2_link *link;
	struct gz_psvr2_screen screen;
	struct gz_display display;
	struct gz_usb_device usb;
	struct gz_clock_model clock;
	struct gz_ratelimit jumps;
	int64_t device_ns; /* of the newest packet */
	uint32_t frame;
	uint64_t seq;
	uint64_t lost;
	uint64_t stale;
};

static struct psvr2_device *psvr2_device_of(struct gz_device *device)
{
	return (struct psvr2_device *)device;
}

static enum gz_result psvr2_start(struct gz_device *base)
{
	struct psvr2_device *device = psvr2_device_of(base);
	enum gz_result result =
		gz_psvr2_link_create(device->context, device->handle, base->log, &device->link);
	return result == GZ_OK ? gz_psvr2_link_start(device->link) : result;
}

/* Whether a packet holds nothing new: the same frame again, or an earlier one. A frame counter that
 * restarted comes with a clock that restarted too, or that runs on. */
static bool is_psvr2_packet_stale(const struct psvr2_device *device,
				  const struct gz_psvr2_packet *packet)
{
	uint32_t ahead = packet->frame - device->frame;
	if (device->seq == 0)
		return false;
	if (ahead == 0)
		return true;
	int64_t back_ns = device->device_ns - packet->device_ns;
	return ahead > INT32_MAX && back_ns >= 0 && back_ns < GZ_NS_PER_S;
}

static uint32_t psvr2_frames_lost(const struct psvr2_device *device, uint32_t frame)
{
	uint32_t between = frame - device->frame - 1;
	return device->seq == 0 || between > GZ_LOST_AT_ONCE_MAX ? 0 : between;
}

static void fill_psvr2_eye(const struct psvr2_device *device, const struct gz_psvr2_eye *measured,
			   struct gz_eye_sample *eye)
{
	struct gz_point point;
	if (measured->has_pupil)
		eye->pupil_mm = measured->pupil_mm;
	if (measured->ray.has_origin)
		memcpy(eye->origin_mm, measured->ray.origin_mm, sizeof eye->origin_mm);
	if (measured->ray.has_direction)
		memcpy(eye->direction, measured->ray.direction, sizeof eye->direction);
	if (!gz_psvr2_screen_meet(&device->screen, &measured->ray, &point))
		return;
	eye->point = point;
	eye->valid = !measured->blink;
}

static void psvr2_packet_to_sample(struct psvr2_device *device,
				   const struct gz_psvr2_arrival *arrival,
				   struct gz_sample *out_sample)
{
	bool jumped;
	const struct gz_psvr2_packet *packet = &arrival->packet;
	struct gz_sample sample = gz_sample_unmeasured();
	sample.device_ns = packet->device_ns;
	sample.host_ns =
		gz_clock_model_step(&device->clock, sample.device_ns, arrival->arrival_ns, &jumped);
	if (jumped)
		gz_warn_limited(device->base.log, &device->jumps,
				"%s: the clock jumped; the clock fit starts again",
				device->usb.name);
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++)
		fill_psvr2_eye(device, &packet->eye[eye], &sample.eye[eye]);
	bool both_shut = packet->eye[0].blink && packet->eye[1].blink;
	if (gz_psvr2_screen_meet(&device->screen, &packet->combined, &sample.point))
		sample.valid = !both_shut;
	sample.lost_before = psvr2_frames_lost(device, packet->frame);
	sample.seq = device->seq++;
	device->lost += sample.lost_before;
	device->frame = packet->frame;
	device->device_ns = packet->device_ns;
	*out_sample = sample;
}

static enum gz_result psvr2_read(struct gz_device *base, int timeout_ms,
				 struct gz_sample *out_sample)
{
	struct psvr2_device *device = psvr2_device_of(base);
	int64_t deadline_ns = gz_clock_now_ns() + timeout_ms * GZ_NS_PER_MS;
	for (;;) {
		struct gz_psvr2_arrival arrival;
		enum gz_result result = gz_psvr2_link_next(device->link, deadline_ns, &arrival);
		if (result != GZ_OK)
			return result;
		if (!is_psvr2_packet_stale(device, &arrival.packet)) {
			psvr2_packet_to_sample(device, &arrival, out_sample);
			return GZ_OK;
		}
		device->stale++;
		/* A device that repeats itself endlessly must not hold the caller. */
		if (gz_clock_now_ns() >= deadline_ns)
			return GZ_ERR_TIMEOUT;
	}
}

static void psvr2_info(const struct gz_device *base, struct gz_device_info *out_info)
{
	const struct psvr2_device *device = (const struct psvr2_device *)base;
	*out_info = (struct gz_device_info) { .has_display = true, .display = device->display };
	memcpy(out_info->name, device->usb.name, sizeof out_info->name);
	memcpy(out_info->serial, device->usb.serial, sizeof out_info->serial);
}

static void psvr2_counters(const struct gz_device *base, struct gz_device_counters *out_counters)
{
	const struct psvr2_device *device = (const struct psvr2_device *)base;
	*out_counters = (struct gz_device_counters) {
		.lost = device->lost,
		.clock = gz_clock_model_status(&device->clock, GZ_CLOCK_DECLARED),
	};
	if (device->link)
		memcpy(out_counters->malformed, gz_psvr2_link_malformed(device->link),
		       sizeof out_counters->malformed);
	out_counters->malformed[GZ_MALFORMED_STALE] = device->stale;
}

static void close_psvr2_handle(struct psvr2_device *device)
{
	if (device->claimed)
		libusb_release_interface(device->handle, GZ_PSVR2_INTERFACE);
	if (device->handle)
		libusb_close(device->handle);
	device->claimed = false;
	device->handle = NULL;
}

static void psvr2_destroy(struct gz_device *base)
{
	struct psvr2_device *device = psvr2_device_of(base);
	gz_psvr2_link_destroy(&device->link);
	close_psvr2_handle(device);
	if (device->context)
		libusb_exit(device->context);
	free(device);
}

static const struct gz_device_ops psvr2_ops = {
	.start = psvr2_start,
	.read = psvr2_read,
	.info = psvr2_info,
	.counters = psvr2_counters,
	.destroy = psvr2_destroy,
};

static void describe_psvr2(libusb_device *usb, struct gz_usb_device *out_device)
{
	gz_usb_describe(usb, out_device);
	if (!out_device->name[0])
		snprintf(out_device->name, sizeof out_device->name, "%s", fallback_name);
}

static bool is_psvr2(const struct gz_usb_device *usb)
{
	return usb->vendor == GZ_PSVR2_VENDOR && usb->product == GZ_PSVR2_PRODUCT;
}

static enum gz_result refuse_psvr2(const struct psvr2_device *device, const char *what, int error)
{
	const struct gz_log *log = device->base.log;
	enum gz_result result = gz_usb_result(error);
	switch (result) {
	case GZ_ERR_ACCESS:
		gz_err(log, "%s at %s: no permission for %s; %s", device->usb.name,
		       device->usb.place, device->usb.node, GZ_DEVICE_PERMISSION_REMEDY);
		return result;
	case GZ_ERR_BUSY:
		gz_err(log, "%s at %s: another program uses its eye tracker; close that program",
		       device->usb.name, device->usb.place);
		return result;
	default:
		gz_err(log, "%s at %s: cannot %s: %s; plug it in again", device->usb.name,
		       device->usb.place, what, libusb_error_name(error));
		return result;
	}
}

static enum gz_result open_psvr2_device(struct psvr2_device *device, libusb_device *usb)
{
	int error = libusb_open(usb, &device->handle);
	if (error != LIBUSB_SUCCESS) {
		device->handle = NULL;
		return refuse_psvr2(device, "open it", error);
	}
	/* Not supported everywhere, and needed only if a kernel driver uses the interface. */
	libusb_set_auto_detach_kernel_driver(device->handle, 1);
	error = libusb_claim_interface(device->handle, GZ_PSVR2_INTERFACE);
	if (error == LIBUSB_SUCCESS) {
		device->claimed = true;
		return GZ_OK;
	}
	enum gz_result result = refuse_psvr2(device, "claim its interface", error);
	close_psvr2_handle(device);
	return result;
}

/* Open the first headset that can be opened. Log the others, so that the user knows what to choose
 * from. */
static enum gz_result open_first_psvr2(struct psvr2_device *device, libusb_device *const *list,
				       const char *choice)
{
	const struct gz_log *log = device->base.log;
	enum gz_result first = GZ_ERR_NO_DEVICE;
	struct gz_usb_device other;
	int seen = 0;
	for (size_t i = 0; list[i]; i++) {
		describe_psvr2(list[i], &other);
		if (!is_psvr2(&other))
			continue;
		seen++;
		if (device->handle || !gz_device_is_chosen(choice, other.name, other.serial)) {
			gz_info(log, "not used: %s %s at %s", other.name, other.serial,
				other.place);
			continue;
		}
		device->usb = other;
		enum gz_result result = open_psvr2_device(device, list[i]);
		if (result != GZ_OK && first == GZ_ERR_NO_DEVICE)
			first = result;
	}
	if (device->handle)
		return GZ_OK;
	if (seen == 0)
		gz_err(log, "no %s on USB; plug one in", fallback_name);
	else if (first == GZ_ERR_NO_DEVICE)
		gz_err(log, "no %s is called %s; see gazectl devices", fallback_name,
		       choice ? choice : "");
	return first;
}

static enum gz_result find_and_open_psvr2(struct psvr2_device *device, const char *choice)
{
	libusb_device **list;
	int error = libusb_init(&device->context);
	if (error != LIBUSB_SUCCESS) {
		device->context = NULL;
		gz_err(device->base.log, "cannot access USB: %s", libusb_error_name(error));
		return gz_usb_result(error);
	}
	ssize_t count = libusb_get_device_list(device->context, &list);
	if (count < 0) {
		gz_err(device->base.log, "cannot list USB devices: %s",
		       libusb_error_name((int)count));
		return gz_usb_result((int)count);
	}
	enum gz_result result = open_first_psvr2(device, list, choice);
	libusb_free_device_list(list, 1);
	return result;
}

/* The screen: from its own settings, else the configured display, else the default display. */
static struct gz_psvr2_screen_params psvr2_screen_params(const struct psvr2_settings *wanted,
							 const struct gz_driver_host *host)
{
	struct gz_psvr2_screen_params screen = wanted->screen;
	struct gz_display assumed = gz_display_default(wanted->screen_px[0], wanted->screen_px[1]);
	if (screen.size_mm[0] > 0 && screen.size_mm[1] > 0)
		return screen;
	bool configured = host->display_mm[0] > 0 && host->display_mm[1] > 0;
	memcpy(screen.size_mm, configured ? host->display_mm : assumed.mm, sizeof screen.size_mm);
	return screen;
}

static enum gz_result psvr2_create(const void *settings, const struct gz_driver_host *host,
				   struct gz_device **out_device)
{
	const struct psvr2_settings *wanted = settings;
	struct psvr2_device *device = calloc(1, sizeof *device);
	if (!device)
		return GZ_ERR_NO_MEM;
	device->base = (struct gz_device) { .ops = &psvr2_ops, .log = host->log };
	struct gz_psvr2_screen_params screen = psvr2_screen_params(wanted, host);
	device->screen = gz_psvr2_screen_make(&screen);
	device->display = (struct gz_display) {
		.px = { wanted->screen_px[0], wanted->screen_px[1] },
		.mm = { screen.size_mm[0], screen.size_mm[1] },
		.distance_mm = screen.distance_mm,
	};
	enum gz_result result = find_and_open_psvr2(device, host->choice);
	if (result != GZ_OK) {
		psvr2_destroy(&device->base);
		return result;
	}
	*out_device = &device->base;
	return GZ_OK;
}

static size_t psvr2_list(const void *settings, const struct gz_driver_host *host,
			 struct gz_device_entry *out_entries)
{
	libusb_context *context;
	libusb_device **list;
	struct gz_usb_device usb;
	size_t count = 0;
	(void)settings;
	int error = libusb_init(&context);
	if (error != LIBUSB_SUCCESS) {
		gz_warn(host->log, "cannot access USB: %s", libusb_error_name(error));
		return 0;
	}
	if (libusb_get_device_list(context, &list) >= 0) {
		for (size_t i = 0; list[i] && count < GZ_DEVICE_ENTRIES_MAX; i++) {
			describe_psvr2(list[i], &usb);
			if (is_psvr2(&usb))
				gz_usb_list_entry(&usb, GZ_PSVR2_INTERFACE, &out_entries[count++]);
		}
		libusb_free_device_list(list, 1);
	}
	libusb_exit(context);
	return count;
}

_Static_assert(sizeof(struct psvr2_settings) <= GZ_DRIVER_SETTINGS_SIZE, "settings fit");

const struct gz_driver gz_driver_psvr2 = {
	.name = "psvr2",
	.help = "the eye tracker of a PlayStation VR2 on USB",
	.options = psvr2_options,
	.option_count = &psvr2_option_count,
	.settings_size = sizeof(struct psvr2_settings),
	.on_usb = true,
	.create = psvr2_create,
	.list = psvr2_list,
};
