/**
 * @file
 * The eye tracker of a PlayStation VR2 on a USB port: a vendor-specific interface, read with
 * libusb. Its gaze is relative to the head; the configuration says where the screen is.
 */
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "drivers/device/clock_model.h"
#include "drivers/device/device.h"
#include "drivers/psvr2/psvr2_link.h"
#include "drivers/psvr2/psvr2_packet.h"
#include "drivers/usb/usb_open.h"

#define GZ_LOG_MODULE "psvr2"

static const struct gz_usb_product psvr2_product = {
	.vendor = GZ_PSVR2_VENDOR,
	.product = GZ_PSVR2_PRODUCT,
	.name = "PlayStation VR2",
	.is_named = true,
};

static const struct gz_usb_kind psvr2_kind = {
	.name = "PlayStation VR2",
	.products = &psvr2_product,
	.product_count = 1,
	.interface_number = GZ_PSVR2_INTERFACE,
};

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
	struct gz_usb_opened opened;
	struct gz_psvr2_link *link;
	struct gz_psvr2_screen screen;
	struct gz_display display;
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
	enum gz_result result = gz_psvr2_link_create(device->opened.context, device->opened.handle,
						     base->log, &device->link);
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
	return ahead > INT32_MAX && gz_clock_is_behind(packet->device_ns, device->device_ns);
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
				device->opened.usb.name);
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
	memcpy(out_info->name, device->opened.usb.name, sizeof out_info->name);
	memcpy(out_info->serial, device->opened.usb.serial, sizeof out_info->serial);
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

static void psvr2_destroy(struct gz_device *base)
{
	struct psvr2_device *device = psvr2_device_of(base);
	gz_psvr2_link_destroy(&device->link);
	gz_usb_close(&device->opened);
	free(device);
}

static const struct gz_device_ops psvr2_ops = {
	.start = psvr2_start,
	.read = psvr2_read,
	.info = psvr2_info,
	.counters = psvr2_counters,
	.destroy = psvr2_destroy,
};

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
	enum gz_result result = gz_usb_open(&psvr2_kind, host->choice, host->log, &device->opened);
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
	(void)settings;
	return gz_usb_list(&psvr2_kind, host->log, out_entries);
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
