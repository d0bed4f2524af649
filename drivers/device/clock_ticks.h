/**
 * @file
 * Time stamps of a device as a counter: unwraps it and finds the length of a tick. The unit that a
 * device declares is checked against the times of arrival. If it is wrong or missing, the tick is
 * estimated. Found in HID eye trackers (MSREnable/GazeHid): microseconds as declared, ticks of
 * 100 ns, raw performance counters, and clocks that step by 15.6 ms.
 *
 * Offset and skew are then found by clock_model.h. Pure: no clock, no I/O, no allocation.
 */
#ifndef GZ_DRIVERS_DEVICE_CLOCK_TICKS_H
#define GZ_DRIVERS_DEVICE_CLOCK_TICKS_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/device/clock_model.h"
#include "protocol/gaze.h"

/** Shortest window in which a tick is judged, ns, and the fewest samples in it. Chosen: with 1 ms
 * of jitter at 30 Hz, a slope over 1 s is known to 0.1 %. */
#define GZ_CLOCK_TICKS_WINDOW_NS INT64_C(1000000000)
#define GZ_CLOCK_TICKS_SAMPLES   20

/** Two ticks that differ by less than this share are the same. Chosen: twice GZ_CLOCK_SKEW_MAX; the
 * difference is skew. */
#define GZ_CLOCK_TICKS_NEAR 0.02

/** What was found out at a sample. */
enum gz_clock_finding {
	GZ_CLOCK_FOUND_NOTHING,
	GZ_CLOCK_FOUND_DECLARED,  /**< the declared tick is right */
	GZ_CLOCK_FOUND_ESTIMATED, /**< tick_ns was estimated */
	GZ_CLOCK_FOUND_COARSE, /**< too coarse, or it stands still: times of arrival are better */
	GZ_CLOCK_FOUND_JUMP,   /**< the clock jumped; a new segment begins */
};

/** Sums over a window, relative to its first sample. */
struct gz_clock_ticks_window {
	int64_t first_counter, first_arrival_ns;
	double n, x, y, xx, xy, yy; /**< x in ticks, y in ns */
	uint64_t common;            /**< greatest common divisor of the steps */
	int repeats;                /**< samples with the time of the sample before */
	int64_t last_x;
};

/** State. Call gz_clock_ticks_init() first. */
struct gz_clock_ticks {
	unsigned bits;
	double declared_ns;
	double tick_ns; /**< in use; 0 while unknown */
	enum gz_clock_tick tick;
	bool settled; /**< the tick is known and is not judged again */
	bool started;
	int64_t counter;           /**< unwrapped */
	int64_t origin, origin_ns; /**< a counter and its device time */
	int64_t host_ns;           /**< newest answer */
	int64_t arrival_ns;        /**< arrival of the newest sample */
	double suspect_ns;         /**< tick that the last window measured; 0 for none */
	bool suspect_coarse;       /**< the last window found the clock too coarse */
	struct gz_clock_ticks_window window;
	struct gz_clock_model model;
};

/** Times of one sample. */
struct gz_clock_stamp {
	int64_t device_ns; /**< GZ_NO_DEVICE_TIME while the tick is unknown */
	int64_t host_ns;   /**< not after the arrival, above the last one */
	enum gz_clock_finding finding;
};

/**
 * Start.
 *
 * @param bits         width of the counter, 1 to 64; it wraps beyond
 * @param declared_ns  tick that the device declares, ns; 0 if it declares none
 */
void gz_clock_ticks_init(struct gz_clock_ticks *ticks, unsigned bits, double declared_ns);

/**
 * Map the counter of one sample to device and host time.
 *
 * @param counter     as received; bits beyond the width are ignored
 * @param arrival_ns  host time, above that of the last sample
 *
 * Until the tick is judged, answers rest on the declared one; without a declared one they are times
 * of arrival.
 */
struct gz_clock_stamp gz_clock_ticks_step(struct gz_clock_ticks *ticks, uint64_t counter,
					  int64_t arrival_ns);

/** How the clocks run against each other. tick is GZ_CLOCK_NONE while times of arrival are used. */
struct gz_clock_status gz_clock_ticks_status(const struct gz_clock_ticks *ticks);

#endif
