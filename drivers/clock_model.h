/**
 * @file
 * A device's clock on the host's: for drivers whose device stamps its samples.
 *
 * A sample arrives some time after its stamp: never less than the link's constant delay, often
 * more. The arrivals least delayed within a sliding window show how the two clocks run against each
 * other, and a line below all of them gives offset and skew (Moon, Skelly and Towsley, "Estimation
 * and removal of clock skew from network delay measurements", IEEE INFOCOM 1999: of the lines below
 * all points, the one nearest to them, found on their convex hull).
 *
 * The constant part of the delay cannot be seen from one side; a driver that knows it takes it off.
 * Pure: no clock, no I/O, no allocation.
 */
#ifndef GZ_DRIVERS_CLOCK_MODEL_H
#define GZ_DRIVERS_CLOCK_MODEL_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol/gaze.h"

/** The window: so many bins, of each of which the least delayed sample counts. */
#define GZ_CLOCK_BINS 20

/** Width of a bin, ns of device time. Chosen: half a second holds some undelayed samples at 30 Hz,
 * and 20 bins follow a crystal's warming within 10 s. */
#define GZ_CLOCK_BIN_NS INT64_C(500000000)

/** Largest skew believed, no unit. Chosen: crystals stay within 1e-4; 1e-2 leaves room for devices
 * that count a nominal sample period. */
#define GZ_CLOCK_SKEW_MAX 1e-2

/** A sample that arrives this long before its device time says began the jump of a clock, ns.
 * Chosen: far above what the fit is ever wrong by, far below what a replug leaps. */
#define GZ_CLOCK_EARLY_NS INT64_C(50000000)

/** And so does this long after, ns, once it lasted for GZ_CLOCK_BIN_NS: a busy host is late, too.
 */
#define GZ_CLOCK_LATE_NS INT64_C(200000000)

/** The least delayed sample of a bin, relative to the segment's first sample. */
struct gz_clock_bin {
	double device_ns;
	double delay_ns; /**< arrival less device time */
};

/** Zero-initialised is the start state. */
struct gz_clock_model {
	bool started;
	int64_t device_ns;       /**< newest device time */
	int64_t host_ns;         /**< newest answer */
	int64_t first_device_ns; /**< the segment's first sample: origin of all that follows */
	int64_t first_arrival_ns;
	int64_t bin; /**< number of the newest bin, from the segment's start */
	int count;   /**< bins that hold something */
	struct gz_clock_bin bins[GZ_CLOCK_BINS]; /**< oldest first */
	double delay_ns;                         /**< the line at the segment's start */
	double slope;                            /**< and its slope: -skew / (1 + skew) */
	double sigma_ns;
	bool late; /**< samples have been late since late_ns */
	int64_t late_ns;
};

/**
 * Map one sample's device time to host time.
 *
 * @param device_ns   any value; not newer than the last one, or far from where the fit expects it,
 *                    begins a new segment
 * @param arrival_ns  when it was received, host time, not before the last one
 * @param[out] out_jumped  whether a new segment began here, the first one not counted; may be NULL
 * @return host time of the device time plus the link's constant delay; above the last answer, and
 * not after @p arrival_ns where that is above the last answer
 */
int64_t gz_clock_model_step(struct gz_clock_model *model, int64_t device_ns, int64_t arrival_ns,
			    bool *out_jumped);

/** Begin a new segment with the next sample, because what device times mean has changed. Host times
 * go on. */
void gz_clock_model_restart(struct gz_clock_model *model);

/**
 * The fit at the newest sample. sigma_ns is the RMS distance of the window's least delayed samples
 * from the line. @p tick is passed on.
 */
struct gz_clock_status gz_clock_model_status(const struct gz_clock_model *model,
					     enum gz_clock_tick tick);

/**
 * Unwrap a counter of 32 bits that counts up and wraps: the 64-bit value nearest to @p last whose
 * low 32 bits are @p counter, at least 0.
 */
int64_t gz_clock_unwrap32(int64_t last, uint32_t counter);

#endif
