/**
 * @file
 * An open HID eye tracker, shared by the files of its driver: hid_driver.c opens it, hid_setup.c
 * asks and tells it what is not a sample, hid_stream.c reads it.
 */
#ifndef GZ_DRIVERS_HID_DEVICE_H
#define GZ_DRIVERS_HID_DEVICE_H

#include "drivers/clock_ticks.h"
#include "drivers/driver.h"
#include "drivers/hid/hid_port.h"
#include "drivers/hid/hid_silence.h"
#include "drivers/hid/hid_tracker.h"

/** What the user sets. */
struct gz_hid_settings {
	double screen_mm[2]; /**< of the screen it is calibrated to; 0 0: as it says */
	bool eye_positions;  /**< ask for them */
};

/** The device. */
struct gz_hid_device {
	struct gz_device base; /**< first, so that a pointer to it is one to this */
	struct gz_hid_settings settings;
	struct gz_device_entry entry;
	struct gz_hid_tracker tracker;
	struct gz_hid_port *port; /**< NULL while closed */

	/* What it said of itself. */
	double screen_mm[2]; /**< 0 0 while unknown */
	double optimum_mm;   /**< distance; 0 while unknown */
	double rate_hz;      /**< 0 while unknown */
	int state;           /**< enum gz_hid_state, or any number */
	bool slow;           /**< it takes seconds to answer, and is asked nothing more */

	/* Its mode. */
	bool mode_set; /**< mode_before is to be restored */
	unsigned mode_before;
	int64_t suspended_ns;  /**< gz_suspended_ns() when the mode was set */
	int64_t look_after_ns; /**< when to look after it again */
	bool was_set_up;       /**< its screen may be another one now */

	/* Its samples. */
	struct gz_clock_ticks clock;
	struct gz_hid_silence silence;
	int64_t host_ns; /**< newest sample delivered */
	uint64_t seq;
	uint64_t malformed[GZ_MALFORMED_COUNT];
	struct gz_ratelimit complaints; /**< of reports */
	struct gz_ratelimit jumps;
	struct gz_ratelimit changes; /**< of its state */

	size_t report_size;    /**< room in report and last */
	size_t last_size;      /**< of the newest tracking report; 0 before it */
	unsigned char *report; /**< owned, as the next two */
	unsigned char *last;
	size_t feature_size; /**< room in feature */
	unsigned char *feature;
};

/**
 * Ask for configuration, capabilities and status. What the device does not answer stays unknown,
 * and is logged.
 *
 * @param fallback_mm  screen where it states none that can be; 0 0 for none
 */
void gz_hid_setup_ask(struct gz_hid_device *device, const double fallback_mm[2]);

/** Request gaze, and eye positions if they are wanted; keeps what was set before. */
void gz_hid_setup_start(struct gz_hid_device *device);

/**
 * Look after what is not a sample, twice a second; call it often. Requests the mode anew if the
 * machine slept, because the device may have been without power. Asks for the screen again if the
 * device was set up meanwhile.
 *
 * @retval GZ_ERR_NO_DEVICE  it was set up for another screen, and must be opened anew; logged
 */
enum gz_result gz_hid_setup_look_after(struct gz_hid_device *device, int64_t now_ns);

/** Restore the mode. */
void gz_hid_setup_stop(struct gz_hid_device *device);

/** Why the samples are of no use now: static text; NULL while all is well. */
const char *gz_hid_setup_trouble(const struct gz_hid_device *device);

/** The read of struct gz_device_ops. */
enum gz_result gz_hid_stream_read(struct gz_hid_device *device, int timeout_ms,
				  struct gz_sample *out_sample);

#endif
