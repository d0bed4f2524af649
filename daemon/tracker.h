/**
 * @file
 * The tracker as the daemon sees it: a device that may be absent, disappear and return. The daemon
 * looks for it with growing pauses, and sequence numbers and counters continue when a device
 * returns. Also measures the rate of samples.
 */
#ifndef GZ_DAEMON_TRACKER_H
#define GZ_DAEMON_TRACKER_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "drivers/driver.h"

/** Shortest (first) and longest pause before the daemon looks for a lost device again, ms. Chosen:
 * a device that is plugged in again is found at once, and one that stays away costs nothing. */
#define GZ_TRACKER_PAUSE_MIN_MS 250
#define GZ_TRACKER_PAUSE_MAX_MS 4000

/** Pause after something was plugged in, ms, if the device is not there yet: its device node may
 * follow a moment later. Chosen: the kernel and udev take some 10 ms. */
#define GZ_TRACKER_PAUSE_ARRIVAL_MS 20

/** A running device that is silent for this long counts as lost, ms. Chosen: longer than the
 * longest blink, because some trackers send nothing while they see no eye. */
#define GZ_TRACKER_SILENCE_MS 1000

/** If opening the device takes longer than this, ms, gz_tracker_read() returns before it starts the
 * device, so that its caller can do other work. Chosen: far longer than a healthy device takes. */
#define GZ_TRACKER_SLOW_MS 1000

/** A tracker. Zero-initialised: none. After gz_tracker_open() it must not be moved in memory. */
struct gz_tracker {
	const struct gz_driver *driver;
	const void *settings;
	struct gz_driver_host host;
	struct gz_device *device; /**< NULL while there is none */
	bool started;
	bool delivered; /**< the present device has delivered samples */
	bool barren;    /**< the device before was lost without delivering any; this was logged */
	enum gz_tracker_state state;
	char reason[GZ_REASON_SIZE]; /**< why it is not running; empty while it is */
	uint64_t opened;             /**< devices opened so far; info describes the newest */
	struct gz_device_info info;
	int arrivals_fd; /**< see gz_tracker_watch() */
	int64_t pause_ns;
	int64_t retry_ns;      /**< when to look for the device again */
	enum gz_result result; /**< of the last search; logged again when it changes */
	struct gz_log relay;   /**< the log that the driver gets */
	atomic_bool looking;   /**< during a search: the driver's warnings also go into remark */
	atomic_bool silent;    /**< the driver's messages do not go on to host.log */
	char remark[GZ_REASON_SIZE]; /**< last warning of the driver during a search */
	int64_t arrival_ns;          /**< when the newest sample came, or the device started */
	uint64_t seq_base;           /**< added to the device's sequence numbers */
	uint64_t next_seq;
	uint64_t samples;
	struct gz_device_counters counters; /**< over all devices so far */
	struct gz_device_counters base;     /**< over the devices before the present one */
};

/**
 * Search for the device and open it. If it is absent or may not be opened, gz_tracker_read()
 * searches for it again.
 *
 * @param[out] tracker  filled
 * @param settings      borrowed; as the driver's options filled them
 * @param host          copied; what it points to is borrowed
 * @return GZ_OK, also without a device; or the result of the driver's create() for settings that
 *         cannot work, logged
 */
enum gz_result gz_tracker_open(struct gz_tracker *tracker, const struct gz_driver *driver,
			       const void *settings, const struct gz_driver_host *host);

/**
 * Search for a missing device as soon as a USB device arrives, if the driver is for USB devices.
 *
 * @param arrivals_fd  an eventfd that becomes readable then, and is read here; borrowed; -1: none
 */
void gz_tracker_watch(struct gz_tracker *tracker, int arrivals_fd);

/**
 * Wait for the next sample. Opens and starts the device if that is due; otherwise does not
 * allocate.
 *
 * @param timeout_ms       longest wait, ms
 * @param[out] out_sample  written on success only; its seq continues when a device returns
 * @retval GZ_ERR_TIMEOUT  no sample within @p timeout_ms, or there is no device
 * @retval GZ_ERR_END      a recording is over; state is ENDED
 *
 * Threads: one.
 */
enum gz_result gz_tracker_read(struct gz_tracker *tracker, int timeout_ms,
			       struct gz_sample *out_sample);

/** Update counters from the device. */
void gz_tracker_update_counters(struct gz_tracker *tracker);

/** Close the device. */
void gz_tracker_close(struct gz_tracker *tracker);

/**
 * Measures the rate of samples from their own times, so that the result does not depend on when it
 * is asked for. Pure. Zero-initialised is the start state.
 */
struct gz_rate_meter {
	uint64_t count;   /**< samples since the last measurement, the one at first_ns included */
	int64_t first_ns; /**< time of the oldest of them */
	int64_t last_ns;  /**< time of the newest of them */
	double rate_hz;   /**< last measurement */
};

/** Count a sample of host time @p host_ns. A time before the last one starts a new measurement. */
void gz_rate_meter_step(struct gz_rate_meter *meter, int64_t host_ns);

/**
 * Samples per second since the last measurement; 0 if none came. If the samples since then span
 * less than 0.2 s, the last measurement again.
 */
double gz_rate_meter_take(struct gz_rate_meter *meter);

#endif
