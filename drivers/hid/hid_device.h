/**
 * @file
 * An open HID eye tracker, shared by the files of its driver: hid_driver.c finds and opens it,
 * hid_setup.c handles its feature reports, hid_stream.c its input reports.
 */
#ifndef GZ_DRIVERS_HID_DEVICE_H
#define GZ_DRIVERS_HID_DEVICE_H

#include "drivers/device/clock_ticks.h"
#include "drivers/device/device.h"
#include "drivers/hid/hid_port.h"
#include "drivers/hid/hid_tracker.h"

/** Periods without a sample that count as silence. */
#define GZ_HID_SILENCE_PERIODS 3

/**
 * Fills in the samples that a tracker omits while it sees no eye. The class cannot mark a sample as
 * invalid and its devices omit invalid samples, so silence is the sign of a blink. But the
 * pipeline, and a replay, run on sample times and do not notice silence.
 *
 * After three sample periods without a sample, each missing sample is filled in with one that
 * measured nothing. It gets the time of the missing sample and comes at least one period late, so
 * that a sample that is merely late still finds its time free. If the link delivers samples in
 * bursts, the usual gap between bursts is waited for as well. Fillers are samples like any other:
 * numbered, judged, recorded. Pure. Zero-initialised is the start state: nothing is filled in
 * before the first sample.
 */
struct gz_hid_silence {
	bool started;
	double nominal_ns;  /**< period that the device states, set by the owner; 0 if none */
	double measured_ns; /**< period from sample to sample */
	int steps;          /**< steps from which measured_ns was learnt */
	double gap_ns;      /**< longest usual time from arrival to arrival */
	int64_t host_ns;    /**< of the newest sample of the device */
	int64_t arrival_ns; /**< when it arrived */
	int64_t filled;     /**< fillers since then */
};

/** Note a sample of the device. @param host_ns, arrival_ns  host time */
void gz_hid_silence_sample(struct gz_hid_silence *silence, int64_t host_ns, int64_t arrival_ns);

/** When the next filler is due, host time; INT64_MAX before the first sample. */
int64_t gz_hid_silence_due_ns(const struct gz_hid_silence *silence);

/** Fill in the next sample. @return its host time */
int64_t gz_hid_silence_fill(struct gz_hid_silence *silence);

/** The sample period, ns: as measured. Before enough samples, 1/30 s, or the stated period if that
 * is longer. */
double gz_hid_silence_period_ns(const struct gz_hid_silence *silence);

/** User settings. */
struct gz_hid_settings {
	double screen_mm[2]; /**< of the screen that it is calibrated to; 0 0: as the device states
			      */
	bool eye_positions;  /**< request them */
};

/** The device. */
struct gz_hid_device {
	struct gz_device
		base; /**< first, so that a pointer to it also points to the whole device */
	struct gz_hid_settings settings;
	struct gz_device_entry entry;
	struct gz_hid_tracker tracker;
	struct gz_hid_port *port; /**< NULL while closed */

	/* What it reported about itself. */
	double screen_mm[2]; /**< 0 0 while unknown */
	double optimum_mm;   /**< viewing distance; 0 while unknown */
	double rate_hz;      /**< 0 while unknown */
	int state;           /**< enum gz_hid_state, or any number */
	bool slow;           /**< it takes seconds to answer and is asked nothing more */

	/* Its mode. */
	bool mode_set; /**< mode_before must be restored */
	unsigned mode_before;
	int64_t suspended_ns;  /**< gz_suspended_ns() when the mode was set */
	int64_t look_after_ns; /**< when to check the device again, host time */
	bool was_set_up;       /**< its screen may have changed */

	/* Its samples. */
	struct gz_clock_ticks clock;
	struct gz_hid_silence silence;
	int64_t host_ns; /**< newest sample delivered */
	uint64_t seq;
	uint64_t malformed[GZ_MALFORMED_COUNT];
	struct gz_ratelimit complaints; /**< about reports */
	struct gz_ratelimit jumps;
	struct gz_ratelimit changes; /**< of its state */

	size_t report_size;    /**< room in report and last, bytes */
	size_t last_size;      /**< of the newest tracking report; 0 before it */
	unsigned char *report; /**< owned, like the next two */
	unsigned char *last;
	size_t feature_size; /**< room in feature, bytes */
	unsigned char *feature;
};

/**
 * Read configuration, capabilities and status. What the device does not answer stays unknown and is
 * logged.
 *
 * @param fallback_mm  screen size to use if the device states none that is possible; 0 0 for none
 */
void gz_hid_setup_ask(struct gz_hid_device *device, const double fallback_mm[2]);

/** Request gaze, and eye positions if they are wanted; keep the previous mode. */
void gz_hid_setup_start(struct gz_hid_device *device);

/**
 * Check the device twice a second; may be called as often as you like. Requests the mode again if
 * the machine was suspended, because the device may have lost power. Reads the screen size again if
 * the device has been set up.
 *
 * @retval GZ_ERR_NO_DEVICE  it was set up for another screen and must be reopened; logged
 */
enum gz_result gz_hid_setup_look_after(struct gz_hid_device *device, int64_t now_ns);

/** Restore the mode. */
void gz_hid_setup_stop(struct gz_hid_device *device);

/** Why the samples are useless now: static text; NULL if all is well. */
const char *gz_hid_setup_trouble(const struct gz_hid_device *device);

/** The read of struct gz_device_ops. */
enum gz_result gz_hid_stream_read(struct gz_hid_device *device, int timeout_ms,
				  struct gz_sample *out_sample);

#endif
