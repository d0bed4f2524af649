/* Feature reports: what the device reports about itself, and its mode. */
#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "base/suspend.h"
#include "drivers/hid/hid_device.h"

#define GZ_LOG_MODULE "hid"

/* Time between two checks of the device. Chosen: soon enough, and free. */
static const int64_t LOOK_AFTER_NS = 500 * GZ_NS_PER_MS;

/* Shortest suspension that counts, ns; a real one takes longer. */
static const int64_t SLEEP_NS = 10 * GZ_NS_PER_MS;

/* Longest time for an answer, ns. Chosen: a control transfer takes milliseconds. */
static const int64_t SLOW_NS = GZ_NS_PER_S;

/* Sizes that differ by less belong to the same screen, mm. */
static const double SAME_MM = 0.5;

/* Request a feature report. A device that hangs would block each request until the system gives up
 * after 5 s, so it is asked nothing more. */
static enum gz_result request_feature(struct gz_hid_device *device, uint8_t id, size_t *out_size)
{
	if (device->slow)
		return GZ_ERR_IO;
	int64_t begin_ns = gz_clock_now_ns();
	enum gz_result result = gz_hid_port_get_feature(device->port, id, device->feature,
							device->feature_size, out_size);
	device->slow = gz_clock_now_ns() - begin_ns > SLOW_NS;
	if (device->slow)
		gz_warn(device->base.log,
			"%s: it takes seconds to answer; no more requests are sent",
			device->entry.name);
	return result;
}

/* Request the report that holds a quantity. @return bytes behind its ID, 0 if there is none */
static size_t request_quantity(struct gz_hid_device *device, enum gz_hid_quantity quantity)
{
	size_t size;
	uint8_t id = device->tracker.values[quantity].report_id;
	if (gz_hid_tracker_bytes(&device->tracker, quantity) == 0)
		return 0;
	if (request_feature(device, id, &size) != GZ_OK || device->feature[0] != id) {
		gz_debug(device->base.log, "%s: no answer to the request for feature report %u",
			 device->entry.name, id);
		return 0;
	}
	return size - 1;
}

static struct gz_hid_screen request_screen(struct gz_hid_device *device)
{
	size_t size = request_quantity(device, GZ_HID_WIDTH);
	if (size == 0)
		return (struct gz_hid_screen) { 0 };
	return gz_hid_tracker_screen(&device->tracker, device->feature + 1, size);
}

static bool is_same_screen(const double a[2], const double b[2])
{
	return fabs(a[0] - b[0]) < SAME_MM && fabs(a[1] - b[1]) < SAME_MM;
}

static void set_hid_screen(struct gz_hid_device *device, const double fallback_mm[2])
{
	const struct gz_log *log = device->base.log;
	struct gz_hid_screen screen = request_screen(device);
	const double *mm = device->settings.screen_mm;
	if (mm[0] <= 0 || mm[1] <= 0)
		mm = screen.believed ? screen.mm : fallback_mm;
	if (screen.stated && !screen.believed)
		gz_warn(log, "%s: it reports an impossible screen size, %g by %g mm",
			device->entry.name, screen.mm[0], screen.mm[1]);
	device->screen_mm[0] = device->screen_mm[1] = 0;
	if (mm[0] <= 0 || mm[1] <= 0) {
		gz_warn(log, "%s: its screen size is unknown; set --display.mm",
			device->entry.name);
		return;
	}
	memcpy(device->screen_mm, mm, sizeof device->screen_mm);
	if (screen.believed && fallback_mm[0] > 0 && fallback_mm[1] > 0 &&
	    !is_same_screen(mm, fallback_mm))
		gz_warn(log,
			"%s: it is calibrated to a screen of %g by %g mm, but display.mm is %g by "
			"%g; calibrate it again, or correct display.mm",
			device->entry.name, mm[0], mm[1], fallback_mm[0], fallback_mm[1]);
}

static void request_distances(struct gz_hid_device *device)
{
	size_t size = request_quantity(device, GZ_HID_OPTIMUM);
	if (size == 0)
		return;
	struct gz_hid_distances distances =
		gz_hid_tracker_distances(&device->tracker, device->feature + 1, size);
	if (distances.corrected)
		gz_info(device->base.log,
			"%s: it reports a tenth of its viewing distance; using %g mm",
			device->entry.name, distances.optimum_mm);
	else if (distances.stated && !distances.believed)
		gz_info(device->base.log, "%s: it reports an impossible viewing distance, %g mm",
			device->entry.name, distances.optimum_mm);
	device->optimum_mm = distances.believed ? distances.optimum_mm : 0;
}

static void request_status(struct gz_hid_device *device)
{
	const struct gz_hid_value *values = device->tracker.values;
	double rate_hz = 0;
	int64_t state = GZ_HID_STATE_UNKNOWN;
	size_t size = request_quantity(device, GZ_HID_STATE);
	if (size > 0 && gz_hid_value_raw(&values[GZ_HID_STATE], device->feature + 1, size,
					 &state) == GZ_HID_READ)
		device->state = state >= 0 && state <= INT32_MAX ? (int)state : 0;
	if (device->state >= GZ_HID_STATE_CONFIGURING)
		gz_warn(device->base.log, "%s: %s", device->entry.name,
			gz_hid_setup_trouble(device));
	size = request_quantity(device, GZ_HID_RATE);
	if (size > 0 && gz_hid_value_read(&values[GZ_HID_RATE], device->feature + 1, size,
					  &rate_hz) == GZ_HID_READ)
		device->rate_hz = gz_hid_believed_rate(rate_hz);
}

void gz_hid_setup_ask(struct gz_hid_device *device, const double fallback_mm[2])
{
	set_hid_screen(device, fallback_mm);
	request_distances(device);
	request_status(device);
}

static bool has_screen_changed(struct gz_hid_device *device)
{
	if (device->settings.screen_mm[0] > 0 && device->settings.screen_mm[1] > 0)
		return false;
	struct gz_hid_screen screen = request_screen(device);
	return screen.believed && !is_same_screen(screen.mm, device->screen_mm);
}

static unsigned wanted_hid_mode(const struct gz_hid_device *device)
{
	bool eyes = device->settings.eye_positions && device->tracker.has_eyes;
	return GZ_HID_MODE_GAZE | (eyes ? GZ_HID_MODE_EYES : 0u);
}

/* Send the Control report with the mode. The rest of the report does not change; it is 0 if the
 * report cannot be read. */
static enum gz_result send_hid_mode(struct gz_hid_device *device, unsigned mode,
				    unsigned *out_before)
{
	const struct gz_hid_value *value = &device->tracker.values[GZ_HID_MODE];
	size_t bytes = gz_hid_tracker_bytes(&device->tracker, GZ_HID_MODE);
	int64_t before = 0;
	if (bytes == 0)
		return GZ_ERR_NOT_FOUND;
	size_t payload = bytes - device->tracker.numbered;
	size_t got = request_quantity(device, GZ_HID_MODE);
	if (got < payload)
		memset(device->feature, 0, payload + 1);
	else if (gz_hid_value_raw(value, device->feature + 1, got, &before) != GZ_HID_READ)
		before = 0;
	device->feature[0] = value->report_id;
	enum gz_result result =
		gz_hid_tracker_set_mode(&device->tracker, device->feature + 1, payload, mode);
	if (result == GZ_OK)
		result = gz_hid_port_set_feature(device->port, device->feature, payload + 1);
	if (result == GZ_OK && out_before)
		*out_before = (unsigned)before;
	return result;
}

void gz_hid_setup_start(struct gz_hid_device *device)
{
	unsigned before = 0;
	device->suspended_ns = gz_suspended_ns();
	switch (send_hid_mode(device, wanted_hid_mode(device), &before)) {
	case GZ_OK:
		if (!device->mode_set)
			device->mode_before = before;
		device->mode_set = true;
		return;
	case GZ_ERR_NOT_FOUND: /* the device has a single mode */
		return;
	default:
		gz_warn(device->base.log, "%s: it rejects the request for gaze; it may send none",
			device->entry.name);
	}
}

enum gz_result gz_hid_setup_look_after(struct gz_hid_device *device, int64_t now_ns)
{
	if (now_ns < device->look_after_ns)
		return GZ_OK;
	device->look_after_ns = now_ns + LOOK_AFTER_NS;
	if (gz_suspended_ns() - device->suspended_ns >= SLEEP_NS) {
		gz_info(device->base.log, "%s: the machine was suspended; its mode is set again",
			device->entry.name);
		gz_hid_setup_start(device);
	}
	if (!device->was_set_up)
		return GZ_OK;
	device->was_set_up = false;
	if (!has_screen_changed(device))
		return GZ_OK;
	gz_warn(device->base.log, "%s: it was set up for another screen; reopening it",
		device->entry.name);
	return GZ_ERR_NO_DEVICE;
}

void gz_hid_setup_stop(struct gz_hid_device *device)
{
	if (device->mode_set)
		send_hid_mode(device, device->mode_before, NULL);
	device->mode_set = false;
}

const char *gz_hid_setup_trouble(const struct gz_hid_device *device)
{
	switch (device->state) {
	case GZ_HID_STATE_CONFIGURING:
		return "it is being configured or calibrated";
	case GZ_HID_STATE_SCREEN_SETUP:
		return "set it up for its screen with its maker's program";
	case GZ_HID_STATE_USER_CALIBRATION:
		return "calibrate it for the user with its maker's program";
	default:
		break;
	}
	if (device->screen_mm[0] <= 0)
		return "its screen size is unknown; set display.mm";
	if (device->seq == 0)
		return "it has sent nothing yet: it sees no eyes, or it is not calibrated";
	return NULL;
}
