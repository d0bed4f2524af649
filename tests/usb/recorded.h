/**
 * @file
 * Reads the contents of a recording.
 */
#ifndef GZ_TESTS_USB_RECORDED_H
#define GZ_TESTS_USB_RECORDED_H

#include <stdint.h>

#include "protocol/gaze_log.h"

/** What a gaze log contains. */
struct recorded {
	uint64_t samples;
	uint64_t first_seq, last_seq;
	uint64_t outages;   /**< gap records without a number of samples: the tracker was gone */
	uint64_t missing;   /**< samples that gap records behind the first sample report missing */
	int64_t longest_ns; /**< longest time between two samples, host time */
	int64_t backwards;  /**< samples whose host time is not after that of the last one */
	uint64_t malformed; /**< malformed lines */
	enum gz_gaze_log_ending ending;
};

/** Read the file @p name in the folder @p recordings; fails the test if it is not a gaze log. */
struct recorded recorded_read(const char *recordings, const char *name);

#endif
