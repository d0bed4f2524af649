/**
 * @file
 * Maps Pupil time to host time. As Pupil's own followers do, the driver asks Pupil Capture for its
 * time (request "t") in rounds of GZ_PUPIL_EXCHANGES exchanges, one round every 10 s. The slowest
 * 30 % of a round are dropped and the rest averaged; a line through the newest rounds follows the
 * drift of the two clocks.
 *
 * An exchange sent at t0 and answered at t2, both host time, with Pupil time t1, means that the
 * clocks differ by (t0 + t2)/2 - t1: if both ways take equally long, the answer was made in the
 * middle (NTP, RFC 5905 section 8; Pupil Labs' pupil-helpers, simple_realtime_time_sync.py).
 *
 * Pure: no clock, no I/O, no allocation.
 */
#ifndef GZ_DRIVERS_PUPIL_CLOCK_H
#define GZ_DRIVERS_PUPIL_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol/gaze.h"

/** Exchanges of a round (Pupil's network_time_sync.py). */
#define GZ_PUPIL_EXCHANGES 60

/** Exchanges of a round that count: the fastest 70 %. */
#define GZ_PUPIL_EXCHANGES_KEPT 42

/** Rounds that the line goes through. Chosen: a minute follows a warming crystal. */
#define GZ_PUPIL_ROUNDS 6

/** A round that differs by more than this from what the earlier ones predict means that a clock was
 * set, ns. Pupil's own followers use 10 ms, too. */
#define GZ_PUPIL_JUMP_NS INT64_C(10000000)

/** Largest skew that is believed, no unit. Chosen: crystals stay within 1e-4. */
#define GZ_PUPIL_SKEW_MAX 1e-3

/** A sample whose time is further than this ahead of its arrival, ns, is stamped by another clock.
 */
#define GZ_PUPIL_EARLY_NS INT64_C(20000000)

/** A sample that is older than this at its arrival, ns, is stamped by another clock. Chosen: longer
 * than any queue holds samples. */
#define GZ_PUPIL_LATE_NS INT64_C(5000000000)

/** One exchange. */
struct gz_pupil_exchange {
	double delay_ns;  /**< round trip */
	double offset_ns; /**< host - Pupil time - base_ns */
};

/** Result of a round. */
struct gz_pupil_round {
	double at_ns;     /**< Pupil time - first_ns */
	double offset_ns; /**< host - Pupil time - base_ns */
};

/** State. Zero-initialised is the start state. */
struct gz_pupil_clock {
	bool begun;       /**< the next two fields are set */
	int64_t base_ns;  /**< host - Pupil time of the first exchange */
	int64_t first_ns; /**< Pupil time of the first exchange */
	int exchange_count;
	struct gz_pupil_exchange exchanges[GZ_PUPIL_EXCHANGES];
	int round_count;
	struct gz_pupil_round rounds[GZ_PUPIL_ROUNDS]; /**< oldest first */
	double offset_ns;                              /**< the line: at first_ns, less base_ns */
	double slope;                                  /**< slope of the line */
	double sigma_ns; /**< scatter of the exchanges kept in the newest round, RMS */
	bool set;        /**< Pupil's clock was set since the last round */
	bool mapped;     /**< the next two fields are set */
	int64_t host_ns; /**< newest answer */
	int64_t pupil_ns;
};

/** What an exchange led to. */
enum gz_pupil_sync {
	GZ_PUPIL_SYNC_MORE,   /**< the round needs more exchanges */
	GZ_PUPIL_SYNC_DONE,   /**< a round is complete and the line is new */
	GZ_PUPIL_SYNC_JUMPED, /**< a round is complete and Pupil's clock was set: the line restarts
			       */
};

/**
 * Add one exchange.
 *
 * @param sent_ns, received_ns  host time
 * @param pupil_ns              Pupil time, any value
 */
enum gz_pupil_sync gz_pupil_clock_exchange(struct gz_pupil_clock *clock, int64_t sent_ns,
					   int64_t pupil_ns, int64_t received_ns);

/**
 * Map the Pupil time of a sample to host time.
 *
 * @param pupil_ns    any value
 * @param arrival_ns  when it was received, host time, not before the last one
 * @param[out] out_believed  false if the two clocks do not fit: the answer is then the arrival, and
 *                           a new round is due
 * @return host time, ordered as by gz_clock_in_order() (drivers/device/clock_model.h)
 */
int64_t gz_pupil_clock_map(struct gz_pupil_clock *clock, int64_t pupil_ns, int64_t arrival_ns,
			   bool *out_believed);

/** The line at the newest sample. */
struct gz_clock_status gz_pupil_clock_status(const struct gz_pupil_clock *clock);

#endif
