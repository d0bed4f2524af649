/**
 * @file
 * The tracker as the daemon sees it: a device that may be absent, vanish and return. Retries with
 * growing pauses, and keeps numbers that go on where a device begins anew.
 */
#ifndef GZ_DAEMON_TRACKER_H
#define GZ_DAEMON_TRACKER_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "drivers/driver.h"

/** First pause before a lost device is looked for again, ms, and the longest. Chosen: a replug is
 * answered at once, a device left unplugged costs nothing. */
#define GZ_TRACKER_PAUSE_MIN_MS 250
#define GZ_TRACKER_PAUSE_MAX_MS 4000

/** The same once something was plugged in, ms: its device node may follow a moment later. Chosen:
 * the kernel and udev take some 10 ms. */
#define GZ_TRACKER_PAUSE_ARRIVAL_MS 20

/** A running device that is silent for so long counts as lost, ms. Chosen: longer than the longest
 * blink, for trackers that send nothing while no eye is seen. */
#define GZ_TRACKER_SILENCE_MS 1000

/** Opening that takes so long comes alone, ms: the caller has other duties between it and starting.
 * Chosen: far above what a device that is well takes. */
#define GZ_TRACKER_SLOW_MS 1000

/** A tracker. Zero-initialised is none; gz_tracker_open() fills it, and it stays where it is. */
struct gz_tracker {
	const struct gz_driver *driver;
	const void *settings;
	struct gz_driver_host host;
	struct gz_device *device; /**< NULL while there is none */
	bool started;
	bool delivered; /**< this device has */
	bool barren;    /**< the one before had not when it was lost, which was told */
	enum gz_tracker_state state;
	char reason[GZ_REASON_SIZE]; /**< why it does not run; empty while it does */
	uint64_t opened;             /**< devices opened so far: info is of the newest one */
	struct gz_device_info info;
	int arrivals_fd; /**< see gz_tracker_watch() */
	int64_t pause_ns;
	int64_t retry_ns;      /**< when to look for the device again */
	enum gz_result result; /**< of the last look for it; told again where it changes */
	struct gz_log relay;   /**< what the driver logs to */
	atomic_bool looking;   /**< what it logs goes into remark */
	atomic_bool silent;    /**< and not on to host.log */
	char remark[GZ_REASON_SIZE];
	int64_t arrival_ns; /**< newest sample, or start */
	uint64_t seq_base;  /**< added to the device's numbers */
	uint64_t next_seq;
	uint64_t samples;
	struct gz_device_counters counters; /**< over all devices so far */
	struct gz_device_counters base;     /**< of those before the present one */
};

/**
 * Look for the device, before its first use. One that is absent, or not ours to open, is looked for
 * again later.
 *
 * @param settings  borrowed; as the driver's options filled them
 * @param host      copied; what it points to is borrowed
 * @return GZ_OK, or what the driver's create() answers to settings that cannot work; logged
 */
enum gz_result gz_tracker_open(struct gz_tracker *tracker, const struct gz_driver *driver,
			       const void *settings, const struct gz_driver_host *host);

/**
 * Look for a missing device at once when something arrives, if its driver is one for USB.
 *
 * @param arrivals_fd  an eventfd that becomes readable then; borrowed; -1 for none. It is read.
 */
void gz_tracker_watch(struct gz_tracker *tracker, int arrivals_fd);

/**
 * Wait for the next sample; opens and starts the device where that is due. Numbers go on where a
 * device returns. Apart from that does not allocate.
 *
 * @retval GZ_ERR_TIMEOUT  none within @p timeout_ms
 * @retval GZ_ERR_END      a recording is over; state is ENDED
 *
 * Threads: one.
 */
enum gz_result gz_tracker_read(struct gz_tracker *tracker, int timeout_ms,
			       struct gz_sample *out_sample);

/** Bring the counters up to date. */
void gz_tracker_update_counters(struct gz_tracker *tracker);

/** Let the device go. */
void gz_tracker_close(struct gz_tracker *tracker);

#endif
