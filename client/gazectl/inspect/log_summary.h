/**
 * @file
 * What a gaze log holds, in numbers: length, rate, gaps, validity, noise, the spread of its
 * intervals. Works on whole, cut and damaged logs.
 */
#ifndef GZ_CLIENT_GAZECTL_INSPECT_LOG_SUMMARY_H
#define GZ_CLIENT_GAZECTL_INSPECT_LOG_SUMMARY_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/gaze_log.h"

/** Bins of the histogram of intervals; the last one is open. */
#define GZ_LOG_SUMMARY_BINS 10

/** Upper ends of the bins, exclusive, in medians. Chosen: fine round 1, where jitter is, and whole
 * numbers above, where lost samples are. The last bin has no end. */
extern const double gz_log_summary_bin_ends[GZ_LOG_SUMMARY_BINS - 1];

/** Marks kept; more are only counted. */
#define GZ_LOG_SUMMARY_MARKS 100

/** A mark. */
struct gz_log_summary_mark {
	int64_t host_ns;
	char text[GZ_GAZE_LOG_TEXT_SIZE];
};

/** Times between the samples of a log. */
struct gz_log_intervals {
	uint64_t count;    /**< of steps forward; the rest of the fields need at least one */
	uint64_t backward; /**< samples not later than the one before */
	int64_t min_ns, median_ns, p99_ns, max_ns; /**< p99: 99 of 100 are not longer */
	uint64_t bins[GZ_LOG_SUMMARY_BINS];
};

/** The numbers. */
struct gz_log_summary {
	enum gz_gaze_log_ending ending;
	uint64_t samples;
	uint64_t malformed;        /**< lines that could not be read */
	int64_t first_ns, last_ns; /**< host time of the first and last sample */
	double duration_s;         /**< from the first to the last sample */
	double rate_hz;         /**< samples taken by the tracker over time, missing ones too; 0 if
				     fewer than two */
	uint64_t gaps, missing; /**< gap records, and the samples they tell of */
	uint64_t valid;         /**< samples with a valid point of any eye, or of both together */
	bool eye_measured[GZ_EYE_COUNT];
	uint64_t eye_valid[GZ_EYE_COUNT];
	struct gz_log_intervals intervals;

	/* What the pipeline says of it, with the settings in the header. */
	double noise_deg; /**< sample-to-sample RMS within fixations; NaN without fixation */
	uint64_t rejected[GZ_REJECT_COUNT];
	uint64_t fixations, saccades, blinks;

	uint64_t windows; /**< places of a viewer's window told */
	int window_px[4]; /**< the last of them: x y w h */

	uint64_t mark_count;
	struct gz_log_summary_mark marks[GZ_LOG_SUMMARY_MARKS];
};

/**
 * Read @p reader to its end.
 *
 * @param log               takes a warning for settings that cannot be applied; may be NULL
 * @param[out] out_summary  written only on GZ_OK
 * @retval GZ_ERR_NO_MEM  no room for the intervals, 8 bytes a sample
 * @retval GZ_ERR_IO      reading failed; logged by the reader
 */
enum gz_result gz_log_summarize(struct gz_gaze_log_reader *reader, const struct gz_log *log,
				struct gz_log_summary *out_summary);

#endif
