/**
 * @file
 * Tobii Eye Tracker 5 and 4C on a USB port: a vendor-specific interface, read with libusb. Written
 * from public descriptions (tobii5_frame.h) and not tried on a tracker.
 */
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "drivers/device/clock_model.h"
#include "drivers/device/device.h"
#include "drivers/tobii5/tobii5_link.h"
#include "drivers/usb/usb_open.h"

#define GZ_LOG_MODULE "tobii5"

/* Longest time to get ready, ns. Chosen: a tracker that works answers in some ms, and takes a
 * display area after the first question or two. */
static const int64_t PREPARE_NS = GZ_NS_PER_S;

/* Their own product name is "EyeChip", which nobody would look for. The first and the last are
 * those of the description; the others are said to speak the same: the IS5 in issue 5 of that
 * repository, the 4C in README.md and sdk/src/webusb.ts of george-wyy/tobiifree. */
static const struct gz_usb_product tobii5_products[] = {
	{ 0x2104, 0x0313, "Tobii Eye Tracker 5", false, NULL },
	{ 0x2104, 0x031e, "Tobii IS5", false, NULL },
	{ 0x2104, 0x0127, "Tobii Eye Tracker 4C", false, NULL },
	{ 0x2104, 0x0102, "Tobii Eye Tracker 5", false,
	  "it waits for its firmware, which only Tobii's software can load; connect it to a "
	  "computer with that software once" },
};

static const struct gz_usb_kind tobii5_kind = {
	.name = "Tobii Eye Tracker 5 or 4C",
	.products = tobii5_products,
	.product_count = sizeof tobii5_products / sizeof *tobii5_products,
	.interface_number = GZ_TOBII5_INTERFACE,
};

struct tobii5_settings {
	struct gz_tobii5_screen_params screen;
};

#define AT(field) offsetof(struct tobii5_settings, field)

static const struct gz_option tobii5_options[] = {
	{ "tobii5.screen_mm", GZ_OPTION_DOUBLE, AT(screen.size_mm), 0, 5000, .count = 2,
	  .preset = "0 0",
	  .help = "width and height of the screen to set in the tracker, mm; 0 0: use what is set "
		  "in it" },
	{ "tobii5.screen_offset_mm", GZ_OPTION_DOUBLE, AT(screen.offset_mm), -5000, 5000,
	  .count = 3, .preset = "0 0 0",
	  .help = "place of the middle of the screen's lower edge relative to the tracker: right, "
		  "up and towards the user, mm; used with tobii5.screen_mm" },
	{ "tobii5.screen_tilt_deg", GZ_OPTION_DOUBLE, AT(screen.tilt_deg), -90, 90, .preset = "0",
	  .help = "how far the screen's upper edge leans back, degrees; used with "
		  "tobii5.screen_mm" },
};

static const size_t tobii5_option_count = sizeof tobii5_options / sizeof *tobii5_options;

/* How the tracker counts its frames. It sends only some of them: the Eye Tracker 5 every fourth
 * (kymotsujason/tobii-gaze-linux, CLAUDE.md). */
struct tobii5_counting {
	uint32_t counter; /* of the newest sample */
	uint32_t advance; /* by which it came */
	uint32_t step;    /* by which it comes if nothing is lost; 0 if not known yet */
};

struct tobii5_device {
	struct gz_device base;
	struct gz_usb_opened opened;
	struct gz_tobii5_link *link;
	bool has_wanted;
	struct gz_tobii5_area wanted;
	struct gz_clock_model clock;
	struct gz_ratelimit jumps;
	int64_t device_ns; /* of the newest sample */
	struct tobii5_counting counting;
	uint64_t seq;
	uint64_t lost;
	uint64_t stale;
};

static struct tobii5_device *tobii5_device_of(struct gz_device *device)
{
	return (struct tobii5_device *)device;
}

/* The display must be known when the device is open, so the conversation about it comes first. A
 * tracker that is slow continues it while it is read. */
static enum gz_result prepare_tobii5(struct tobii5_device *device)
{
	enum gz_result result = gz_tobii5_link_create(device->opened.context, device->opened.handle,
						      device->base.log, &device->link);
	if (result == GZ_OK)
		result = gz_tobii5_link_start(device->link,
					      device->has_wanted ? &device->wanted : NULL);
	if (result == GZ_OK)
		gz_tobii5_link_prepare(device->link, gz_clock_now_ns() + PREPARE_NS);
	return result;
}

/* The first read subscribes. */
static enum gz_result tobii5_start(struct gz_device *base)
{
	(void)base;
	return GZ_OK;
}

/* Whether a sample holds nothing new. */
static bool is_tobii5_gaze_stale(const struct tobii5_device *device,
				 const struct gz_tobii5_gaze *gaze)
{
	return device->seq > 0 && gz_clock_is_behind(gaze->device_ns, device->device_ns);
}

/* Count frames. An advance that comes twice in a row is the step; only multiples of the step are
 * losses. @return samples lost before this one */
static uint32_t count_tobii5_frames(struct tobii5_counting *counting, uint32_t counter, bool first)
{
	uint32_t advance = first ? 0 : counter - counting->counter;
	bool is_step = advance > 0 && advance == counting->advance;
	counting->counter = counter;
	counting->advance = advance;
	if (is_step)
		counting->step = advance;
	if (counting->step == 0 || advance % counting->step != 0 || advance <= counting->step)
		return 0;
	uint32_t lost = advance / counting->step - 1;
	return lost > GZ_LOST_AT_ONCE_MAX ? 0 : lost;
}

/* Points are normalised to the display area, so without one they are not on the screen. */
static void forget_tobii5_points(struct gz_sample *sample)
{
	struct gz_sample nothing = gz_sample_unmeasured();
	sample->point = nothing.point;
	sample->valid = false;
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++) {
		sample->eye[eye].point = nothing.point;
		sample->eye[eye].valid = false;
	}
}

static void tobii5_gaze_to_sample(struct tobii5_device *device,
				  const struct gz_tobii5_arrival *arrival,
				  struct gz_sample *out_sample)
{
	bool jumped;
	const struct gz_tobii5_gaze *gaze = &arrival->gaze;
	struct gz_sample sample = gz_sample_unmeasured();
	sample.device_ns = gaze->device_ns;
	sample.host_ns =
		gz_clock_model_step(&device->clock, sample.device_ns, arrival->arrival_ns, &jumped);
	if (jumped)
		gz_warn_limited(device->base.log, &device->jumps,
				"%s: the clock jumped; the clock fit starts again",
				device->opened.usb.name);
	sample.point = gaze->point;
	sample.valid = gaze->valid;
	memcpy(sample.eye, gaze->eye, sizeof sample.eye);
	if (!gz_tobii5_session_has_screen(gz_tobii5_link_session(device->link)))
		forget_tobii5_points(&sample);
	if (gaze->has_counter)
		sample.lost_before =
			count_tobii5_frames(&device->counting, gaze->counter, device->seq == 0);
	sample.seq = device->seq++;
	device->lost += sample.lost_before;
	device->device_ns = gaze->device_ns;
	*out_sample = sample;
}

static enum gz_result tobii5_read(struct gz_device *base, int timeout_ms,
				  struct gz_sample *out_sample)
{
	struct tobii5_device *device = tobii5_device_of(base);
	int64_t deadline_ns = gz_clock_now_ns() + timeout_ms * GZ_NS_PER_MS;
	for (;;) {
		struct gz_tobii5_arrival arrival;
		enum gz_result result = gz_tobii5_link_next(device->link, deadline_ns, &arrival);
		if (result != GZ_OK)
			return result;
		if (!is_tobii5_gaze_stale(device, &arrival.gaze)) {
			tobii5_gaze_to_sample(device, &arrival, out_sample);
			return GZ_OK;
		}
		device->stale++;
		/* A device that repeats itself endlessly must not hold the caller. */
		if (gz_clock_now_ns() >= deadline_ns)
			return GZ_ERR_TIMEOUT;
	}
}

/* The tracker knows the size of the screen, but not its pixels. */
static void tobii5_info(const struct gz_device *base, struct gz_device_info *out_info)
{
	const struct tobii5_device *device = (const struct tobii5_device *)base;
	*out_info = (struct gz_device_info) { .display = gz_display_default(1920, 1080) };
	memcpy(out_info->name, device->opened.usb.name, sizeof out_info->name);
	memcpy(out_info->serial, device->opened.usb.serial, sizeof out_info->serial);
	const struct gz_tobii5_session *session = gz_tobii5_link_session(device->link);
	out_info->has_display = gz_tobii5_session_has_screen(session);
	if (out_info->has_display)
		gz_tobii5_area_size(&session->area, out_info->display.mm);
}

static void tobii5_counters(const struct gz_device *base, struct gz_device_counters *out_counters)
{
	const struct tobii5_device *device = (const struct tobii5_device *)base;
	*out_counters = (struct gz_device_counters) {
		.lost = device->lost,
		.clock = gz_clock_model_status(&device->clock, GZ_CLOCK_DECLARED),
		.trouble = gz_tobii5_link_session(device->link)->trouble,
	};
	memcpy(out_counters->malformed, gz_tobii5_link_malformed(device->link),
	       sizeof out_counters->malformed);
	out_counters->malformed[GZ_MALFORMED_STALE] = device->stale;
}

static void tobii5_destroy(struct gz_device *base)
{
	struct tobii5_device *device = tobii5_device_of(base);
	gz_tobii5_link_destroy(&device->link);
	gz_usb_close(&device->opened);
	free(device);
}

static const struct gz_device_ops tobii5_ops = {
	.start = tobii5_start,
	.read = tobii5_read,
	.info = tobii5_info,
	.counters = tobii5_counters,
	.destroy = tobii5_destroy,
};

static enum gz_result check_tobii5_screen(const struct gz_tobii5_screen_params *screen,
					  const struct gz_log *log, struct tobii5_device *device)
{
	device->has_wanted = screen->size_mm[0] > 0 || screen->size_mm[1] > 0;
	if (!device->has_wanted)
		return GZ_OK;
	device->wanted = gz_tobii5_area_make(screen);
	if (gz_tobii5_area_is_screen(&device->wanted))
		return GZ_OK;
	gz_err(log, "tobii5.screen_mm %g %g: no screen has this size; both sides are 50 to 5000 mm",
	       screen->size_mm[0], screen->size_mm[1]);
	return GZ_ERR_INVAL;
}

static enum gz_result tobii5_create(const void *settings, const struct gz_driver_host *host,
				    struct gz_device **out_device)
{
	const struct tobii5_settings *wanted = settings;
	struct tobii5_device *device = calloc(1, sizeof *device);
	if (!device)
		return GZ_ERR_NO_MEM;
	device->base = (struct gz_device) { .ops = &tobii5_ops, .log = host->log };
	enum gz_result result = check_tobii5_screen(&wanted->screen, host->log, device);
	if (result == GZ_OK)
		result = gz_usb_open(&tobii5_kind, host->choice, host->log, &device->opened);
	if (result == GZ_OK)
		result = prepare_tobii5(device);
	if (result != GZ_OK) {
		tobii5_destroy(&device->base);
		return result;
	}
	*out_device = &device->base;
	return GZ_OK;
}

static size_t tobii5_list(const void *settings, const struct gz_driver_host *host,
			  struct gz_device_entry *out_entries)
{
	(void)settings;
	return gz_usb_list(&tobii5_kind, host->log, out_entries);
}

_Static_assert(sizeof(struct tobii5_settings) <= GZ_DRIVER_SETTINGS_SIZE, "settings fit");

const struct gz_driver gz_driver_tobii5 = {
	.name = "tobii5",
	.help = "Tobii Eye Tracker 5 and 4C on USB (not tried on a tracker)",
	.options = tobii5_options,
	.option_count = &tobii5_option_count,
	.settings_size = sizeof(struct tobii5_settings),
	.on_usb = true,
	.create = tobii5_create,
	.list = tobii5_list,
};
