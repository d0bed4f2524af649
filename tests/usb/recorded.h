/**
 * @file
 * What a recording holds, for tests.
 */
#ifndef GZ_TESTS_USB_RECORDED_H
#define GZ_TESTS_USB_RECORDED_H

#include <stdint.h>

#include "protocol/gaze_log.h"

/** A gaze log, counted. */
struct recorded {
	uint64_t samples;
	uint64_t first_seq, last_seq;
	uint64_t outages;   /**< gap records without a number of samples: the tracker was gone */
	uint64_t missing;   /**< samples that gap records tell of */
	int64_t longest_ns; /**< longest time between two samples, host time */
	int64_t backwards;  /**< samples whose host time is not after the one before */
	uint64_t malformed; /**< lines */
	enum gz_gaze_log_ending ending;
};

/** Read @p name of the folder @p recordings; fails the test where that is no gaze log. */
struct recorded recorded_read(const char *recordings, const char *name);

#endif
