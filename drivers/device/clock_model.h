/**
 * @file
 * Maps a device clock to the host clock, for devices that stamp their samples.
 *
 * A sample arrives some time after its stamp: never less than the constant delay of the link, often
 * more. The least delayed arrivals within a sliding window show how the two clocks run against each
 * other. A line below all of them gives offset and skew: of all lines below the points the one
 * nearest to them, found on their convex hull (Moon, Skelly and Towsley, "Estimation and removal of
 * clock skew from network delay measurements", IEEE INFOCOM 1999).
 *
 * The constant part of the delay cannot be seen from one side; a driver that knows it subtracts it.
 * Pure: no clock, no I/O, no allocation.
 */
#ifndef GZ_DRIVERS_DEVICE_CLOCK_MODEL_H
#define GZ_DRIVERS_DEVICE_CLOCK_MODEL_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol/gaze.h"

/** Bins of the window. The least delayed sample of each bin counts. */
#define GZ_CLOCK_BINS 20

/** Width of a bin, ns of device time. Chosen: half a second holds some undelayed samples at 30 Hz,
 * and 20 bins follow a warming crystal within 10 s. */
#define GZ_CLOCK_BIN_NS INT64_C(500000000)

/** Largest skew that is believed, no unit. Chosen: crystals stay within 1e-4; 1e-2 leaves room for
 * devices that count a nominal sample period. */
#define GZ_CLOCK_SKEW_MAX 1e-2

/** A sample that arrives this long before the fit expects it, ns, shows that a clock jumped.
 * Chosen: far above any error of the fit, far below the jump that a replug causes. */
#define GZ_CLOCK_EARLY_NS INT64_C(50000000)

/** Samples that arrive this long after the fit expects them, ns, for at least GZ_CLOCK_BIN_NS, show
 * that a clock jumped. They must last because a busy host is late, too. */
#define GZ_CLOCK_LATE_NS INT64_C(200000000)

/** The least delayed sample of a bin, relative to the first sample of the segment. */
struct gz_clock_bin {
	double device_ns;
	double delay_ns; /**< arrival - device time */
};

/** State of the model. A segment lasts from one clock jump to the next. Zero-initialised is the
 * start state. */
struct gz_clock_model {
	bool started;
	int64_t device_ns;       /**< newest device time */
	int64_t host_ns;         /**< newest answer */
	int64_t first_device_ns; /**< device time of the segment's first sample, the origin below */
	int64_t first_arrival_ns;
	int64_t bin; /**< number of the newest bin, from the start of the segment */
	int count;   /**< filled bins */
	struct gz_clock_bin bins[GZ_CLOCK_BINS]; /**< oldest first */
	double delay_ns;                         /**< the line at the start of the segment */
	double slope;                            /**< slope of the line: -skew / (1 + skew) */
	double sigma_ns;                         /**< RMS distance of the bins from the line */
	bool late;                               /**< samples have been late since late_ns */
	int64_t late_ns;
};

/**
 * Map the device time of one sample to host time.
 *
 * @param device_ns   any value. One that is not newer than the last one, or far from what the fit
 *                    expects, begins a new segment.
 * @param arrival_ns  when the sample was received, host time, not before the last one
 * @param[out] out_jumped  whether a new segment begins here, the first one not counted; may be NULL
 * @return host time of the device time, plus the constant delay of the link; ordered as by
 *         gz_clock_in_order()
 */
int64_t gz_clock_model_step(struct gz_clock_model *model, int64_t device_ns, int64_t arrival_ns,
			    bool *out_jumped);

/** Whether device time @p device_ns is that of the newest sample or up to a second before it, so
 * that its sample is an old one. A clock that goes back further has restarted. Takes any values. */
bool gz_clock_is_behind(int64_t device_ns, int64_t newest_ns);

/** Begin a new segment with the next sample, because device times have a new meaning. Host times
 * continue. */
void gz_clock_model_restart(struct gz_clock_model *model);

/**
 * The fit at the newest sample. sigma_ns is the RMS distance of the least delayed samples of the
 * window from the line. @p tick is passed on.
 */
struct gz_clock_status gz_clock_model_status(const struct gz_clock_model *model,
					     enum gz_clock_tick tick);

/**
 * Put a sample's host time in order: not after its arrival, and above the last host time. The
 * second rule wins if they contradict each other.
 *
 * @param last_ns  the last host time; NULL if there is none
 */
int64_t gz_clock_in_order(int64_t host_ns, int64_t arrival_ns, const int64_t *last_ns);

/**
 * Unwrap a 32-bit counter that counts up and wraps: the 64-bit value nearest to @p last whose low
 * 32 bits are @p counter, at least 0.
 */
int64_t gz_clock_unwrap32(int64_t last, uint32_t counter);

#endif
