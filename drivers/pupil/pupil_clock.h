/**
 * @file
 * Pupil time on the host's clock. Pupil Capture's clock is asked for its time over and over
 * (request "t"), as Pupil's own followers do: rounds of GZ_PUPIL_EXCHANGES exchanges, of which the
 * slowest 30 % are dropped and the rest averaged, a round every 10 s; a line through the newest
 * rounds follows the drift of the two clocks.
 *
 * An exchange sent at t0 and answered at t2, both host time, with Pupil time t1, says that the
 * clocks differ by (t0 + t2)/2 - t1: the answer was given in the middle, if both ways take equally
 * long (NTP, RFC 5905 section 8; Pupil Labs' pupil-helpers, simple_realtime_time_sync.py).
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

/** Those of them that count: the fastest 70 %. */
#define GZ_PUPIL_EXCHANGES_KEPT 42

/** Rounds that the line goes through. Chosen: a minute follows a warming crystal. */
#define GZ_PUPIL_ROUNDS 6

/** A round that differs so much from what the ones before it predict is a clock that was set, ns.
 * Pupil's own followers jump at 10 ms, too. */
#define GZ_PUPIL_JUMP_NS INT64_C(10000000)

/** Largest skew believed, no unit. Chosen: crystals stay within 1e-4. */
#define GZ_PUPIL_SKEW_MAX 1e-3

/** A sample said to be so far ahead of its arrival, ns, has a time of another clock. */
#define GZ_PUPIL_EARLY_NS INT64_C(20000000)

/** And so has one said to be so old, ns. Chosen: longer than any queue holds. */
#define GZ_PUPIL_LATE_NS INT64_C(5000000000)

/** One exchange. */
struct gz_pupil_exchange {
	double delay_ns;  /**< there and back */
	double offset_ns; /**< host less Pupil time, less base_ns */
};

/** What a round found. */
struct gz_pupil_round {
	double at_ns;     /**< Pupil time, less first_ns */
	double offset_ns; /**< host less Pupil time, less base_ns */
};

/** Zero-initialised is the start state. */
struct gz_pupil_clock {
	bool begun;       /**< the next two hold something */
	int64_t base_ns;  /**< host less Pupil time, of the first exchange */
	int64_t first_ns; /**< Pupil time of it */
	int exchange_count;
	struct gz_pupil_exchange exchanges[GZ_PUPIL_EXCHANGES];
	int round_count;
	struct gz_pupil_round rounds[GZ_PUPIL_ROUNDS]; /**< oldest first */
	double offset_ns;                              /**< the line: at first_ns, less base_ns */
	double slope;                                  /**< and its rise */
	double sigma_ns; /**< scatter of the newest round's kept exchanges, RMS */
	bool set;        /**< Pupil's clock was set since the last round */
	bool mapped;     /**< the next two hold something */
	int64_t host_ns; /**< newest answer */
	int64_t pupil_ns;
};

/** What an exchange led to. */
enum gz_pupil_sync {
	GZ_PUPIL_SYNC_MORE,   /**< the round needs more exchanges */
	GZ_PUPIL_SYNC_DONE,   /**< a round is complete and the line through the rounds is new */
	GZ_PUPIL_SYNC_JUMPED, /**< the same, but Pupil's clock was set: the line begins anew */
};

/**
 * Take one exchange.
 *
 * @param sent_ns, received_ns  host time
 * @param pupil_ns              Pupil time, any value
 */
enum gz_pupil_sync gz_pupil_clock_exchange(struct gz_pupil_clock *clock, int64_t sent_ns,
					   int64_t pupil_ns, int64_t received_ns);

/**
 * Map a sample's Pupil time to host time.
 *
 * @param pupil_ns    any value
 * @param arrival_ns  when it was received, host time, not before the last one
 * @param[out] out_believed  false where the two clocks do not fit: the answer is then the arrival,
 *                           and a new round is due
 * @return host time, above the last answer, and not after @p arrival_ns where that is above the
 * last answer
 */
int64_t gz_pupil_clock_map(struct gz_pupil_clock *clock, int64_t pupil_ns, int64_t arrival_ns,
			   bool *out_believed);

/** The line at the newest sample. */
struct gz_clock_status gz_pupil_clock_status(const struct gz_pupil_clock *clock);

#endif
