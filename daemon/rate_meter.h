/**
 * @file
 * How often samples come: measured on their own times, so that it does not depend on when anybody
 * looks. Pure.
 */
#ifndef GZ_DAEMON_RATE_METER_H
#define GZ_DAEMON_RATE_METER_H

#include <stdint.h>

/** Zero-initialised is the start state. */
struct gz_rate_meter {
	uint64_t count;   /**< samples since the last answer, the one at first_ns among them */
	int64_t first_ns; /**< oldest of them */
	int64_t last_ns;  /**< newest of them */
	double rate_hz;   /**< last answer */
};

/** Take note of a sample's time, host ns. One before the last begins anew. */
void gz_rate_meter_step(struct gz_rate_meter *meter, int64_t host_ns);

/**
 * Samples a second since the last answer that was longer ago than 0.2 s of their time; 0 where
 * nothing came. The last answer again where less than that has come.
 */
double gz_rate_meter_take(struct gz_rate_meter *meter);

#endif
