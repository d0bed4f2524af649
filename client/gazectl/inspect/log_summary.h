/**
 * @file
 * The content of a gaze log in numbers: length, rate, gaps, validity, noise, intervals between
 * samples. Works on whole, cut and damaged logs.
 */
#ifndef GZ_CLIENT_GAZECTL_INSPECT_LOG_SUMMARY_H
#define GZ_CLIENT_GAZECTL_INSPECT_LOG_SUMMARY_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "filter/pipeline.h"
#include "protocol/gaze_log.h"

/**
 * Put a pipeline into its start state with the settings and the display in the header of a log:
 * the pipeline as it was when the log was recorded. Missing settings keep their presets; a missing
 * display is gz_display_default().
 *
 * @param[out] pipeline  filled
 * @param log            takes a warning for each setting that cannot be applied; may be NULL
 */
void gz_log_pipeline_init(struct gz_pipeline *pipeline, const struct gz_gaze_log_header *header,
			  const struct gz_log *log);

/** Bins of the histogram of intervals; the last one has no upper end. */
#define GZ_LOG_SUMMARY_BINS 10

/** Upper ends of the bins, exclusive, in medians. Chosen: narrow around 1, for jitter, and wide
 * above, between whole numbers, for lost samples. */
extern const double gz_log_summary_bin_ends[GZ_LOG_SUMMARY_BINS - 1];

/** Most marks kept; further ones are only counted. */
#define GZ_LOG_SUMMARY_MARKS 100

/** A mark. */
struct gz_log_summary_mark {
	int64_t host_ns;
	char text[GZ_GAZE_LOG_TEXT_SIZE];
};

/** Times between the samples of a log. */
struct gz_log_intervals {
	uint64_t count;    /**< intervals above 0; the fields below need at least one */
	uint64_t backward; /**< samples that are not later than the one before */
	int64_t min_ns, median_ns, p99_ns, max_ns; /**< p99: 99 % are not longer */
	uint64_t bins[GZ_LOG_SUMMARY_BINS];
};

/** The content of a log. */
struct gz_log_summary {
	enum gz_gaze_log_ending ending;
	uint64_t samples;
	uint64_t malformed;        /**< lines that could not be read */
	int64_t first_ns, last_ns; /**< host time of the first and last sample */
	double duration_s;         /**< from the first to the last sample */
	double rate_hz;         /**< samples a second, missing ones included; 0 if there are fewer
				     than two */
	uint64_t gaps, missing; /**< gap records, and the sum of their missing samples */
	uint64_t valid; /**< samples with a valid point of either eye, or of both together */
	bool eye_measured[GZ_EYE_COUNT];
	uint64_t eye_valid[GZ_EYE_COUNT];
	struct gz_log_intervals intervals;

	/* Results of the pipeline with the settings in the header. */
	double noise_deg; /**< sample-to-sample RMS within fixations; NaN without fixations */
	uint64_t rejected[GZ_REJECT_COUNT];
	uint64_t fixations, saccades, blinks;

	uint64_t windows; /**< window records */
	int window_px[4]; /**< the last one: x y w h on the display */

	uint64_t mark_count;
	struct gz_log_summary_mark marks[GZ_LOG_SUMMARY_MARKS];
};

/**
 * Read @p reader to its end and summarise it.
 *
 * @param log               takes a warning for settings that cannot be applied; may be NULL
 * @param[out] out_summary  written only on GZ_OK
 * @retval GZ_ERR_NO_MEM  no memory for the intervals, 8 bytes a sample
 * @retval GZ_ERR_IO      reading failed; logged by the reader
 */
enum gz_result gz_log_summarize(struct gz_gaze_log_reader *reader, const struct gz_log *log,
				struct gz_log_summary *out_summary);

#endif
