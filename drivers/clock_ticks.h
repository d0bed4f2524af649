/**
 * @file
 * A device's time stamps as counters: unwrapped, and what a tick is worth. The unit that a device
 * declares is checked against the times of arrival; where it cannot be, or there is none, the tick
 * is estimated. Seen in the field of HID eye trackers (MSREnable/GazeHid): microseconds as
 * declared, ticks of 100 ns, raw performance counters, and clocks that step by 15.6 ms.
 *
 * On top of it runs the model of offset and skew (clock_model.h). Pure: no clock, no I/O, no
 * allocation.
 */
#ifndef GZ_DRIVERS_CLOCK_TICKS_H
#define GZ_DRIVERS_CLOCK_TICKS_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/clock_model.h"
#include "protocol/gaze.h"

/** A tick is judged over windows of at least so long, ns, and so many samples. Chosen: with 1 ms of
 * jitter at 30 Hz a slope over 1 s is known to 0.1 %. */
#define GZ_CLOCK_TICKS_WINDOW_NS INT64_C(1000000000)
#define GZ_CLOCK_TICKS_SAMPLES   20

/** A tick this near to the declared one is that one, no unit. Chosen: twice GZ_CLOCK_SKEW_MAX, what
 * is left over is skew. */
#define GZ_CLOCK_TICKS_NEAR 0.02

/** What was found out at a sample. */
enum gz_clock_finding {
	GZ_CLOCK_FOUND_NOTHING,
	GZ_CLOCK_FOUND_DECLARED,  /**< the declared tick is believable */
	GZ_CLOCK_FOUND_ESTIMATED, /**< tick_ns was estimated */
	GZ_CLOCK_FOUND_COARSE,    /**< too coarse, or it stands: the time of arrival is better */
	GZ_CLOCK_FOUND_JUMP,      /**< the clock jumped; a new segment begins */
};

/** Sums over a window, relative to its first sample. */
struct gz_clock_ticks_window {
	int64_t first_counter, first_arrival_ns;
	double n, x, y, xx, xy, yy; /**< x in ticks, y in ns */
	uint64_t common;            /**< greatest common divisor of the steps */
	int repeats;                /**< samples with the time of the one before */
	int64_t last_x;
};

/** State. gz_clock_ticks_init() first. */
struct gz_clock_ticks {
	unsigned bits;
	double declared_ns;
	double tick_ns; /**< in use; 0 while unknown */
	enum gz_clock_tick tick;
	bool settled; /**< nothing more is found out */
	bool started;
	int64_t counter;           /**< unwrapped */
	int64_t origin, origin_ns; /**< device time of a counter */
	int64_t host_ns;           /**< newest answer */
	int64_t arrival_ns;        /**< of it */
	double suspect_ns;         /**< tick that the last window spoke for; 0 for none */
	bool suspect_coarse;       /**< or that it is too coarse */
	struct gz_clock_ticks_window window;
	struct gz_clock_model model;
};

/** One sample's times. */
struct gz_clock_stamp {
	int64_t device_ns; /**< GZ_NO_DEVICE_TIME while the tick is unknown */
	int64_t host_ns;   /**< not after the arrival, above the last one */
	enum gz_clock_finding finding;
};

/**
 * Begin.
 *
 * @param bits         of the counter, 1 to 64; it wraps beyond
 * @param declared_ns  the tick that the device declares, ns; 0 for none
 */
void gz_clock_ticks_init(struct gz_clock_ticks *ticks, unsigned bits, double declared_ns);

/**
 * Map one sample's counter to device and host time.
 *
 * @param counter     as received; bits beyond are not looked at
 * @param arrival_ns  host time, above that of the last sample
 *
 * The first answers of a tick that is not yet judged rest on the declared one; without it they are
 * times of arrival.
 */
struct gz_clock_stamp gz_clock_ticks_step(struct gz_clock_ticks *ticks, uint64_t counter,
					  int64_t arrival_ns);

/** How the clocks run against each other; tick is NONE while times of arrival are used. */
struct gz_clock_status gz_clock_ticks_status(const struct gz_clock_ticks *ticks);

#endif
