/**
 * @file
 * What frames cost: the record of one frame, as a line of text and as an entry of the statistics
 * file, and the last frames for the plot of frame times.
 */
#ifndef GZ_VIEW_FRAME_STATS_H
#define GZ_VIEW_FRAME_STATS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/display.h"
#include "render/attention/attention.h"

/** One frame. Strings are static or outlive the record. */
struct gz_frame_record {
	const char *method;
	const char *backend;
	int width, height;
	uint64_t rays;
	uint64_t kept_rays; /**< of them, those that an earlier frame cast: temporal.keep_rays */
	uint64_t bricks_coming; /**< see struct gz_frame_stats */
	uint64_t samples;
	double plan_ms;
	double cast_ms;
	double reconstruct_ms; /**< with the resampling for image_sampling_rate */
	double total_ms;       /**< wall time from the gaze to the finished picture */
	double prepare_ms;     /**< of it, what later frames reuse, such as a new surface */
	bool gaze_known;
	struct gz_point gaze;
	bool age_known;
	double gaze_age_ms;    /**< age when the plan was made */
	const char *attention; /**< state the plan followed: gz_attention_state_name() */
	struct gz_focus focus; /**< the plan was made for it */
	double budget_ms;      /**< 0: none */
	bool kept;             /**< earlier frames contributed: temporal.accumulate */
	const char *budget;    /**< state of the budget: gz_budget_state_name() */
};

/**
 * Print the frame as one line without newline, such as
 * "acuity 1920x1080 rays 216440 kept 0 samples 9631187 plan 0.21 cast 68.10 reconstruct 4.90 total
 * 73.30 ms gaze age 3.1 ms". An unknown age is "-". The text is cut to @p size bytes.
 */
void gz_frame_record_print(const struct gz_frame_record *record, char *text, size_t size);

/**
 * A statistics file: {"frames": [ ... ]}, one object per frame. The file is complete JSON after
 * every call: an error or signal between two frames leaves a file that parses.
 */
struct gz_stats_file;

/**
 * Create the file, or empty an existing one.
 *
 * @param[out] out_file  owned by the caller: gz_stats_close()
 * @retval GZ_ERR_IO      the file cannot be written or is not a regular file; logged
 * @retval GZ_ERR_NO_MEM  out of memory
 */
enum gz_result gz_stats_open(const char *path, const struct gz_log *log,
			     struct gz_stats_file **out_file);

/**
 * Append one frame.
 *
 * @retval GZ_ERR_IO     the file cannot be written; logged; earlier frames stay in it
 * @retval GZ_ERR_INVAL  the entry is too long, or out of memory
 */
enum gz_result gz_stats_add(struct gz_stats_file *file, const struct gz_frame_record *record);

/** Close the file and set the pointer to NULL. Accepts NULL and a pointer to NULL. */
void gz_stats_close(struct gz_stats_file **file);

/** The parts of a frame's time, in the order of the work. */
enum gz_frame_part {
	GZ_FRAME_PLAN,
	GZ_FRAME_CAST,
	GZ_FRAME_RECONSTRUCT,
	GZ_FRAME_REST, /**< the rest until the frame is shown: upload, panels, swap */
	GZ_FRAME_PARTS,
};

/** Number of frames kept. Chosen: some seconds, two to four px per frame in the plot. */
#define GZ_FRAME_HISTORY_SIZE 256

/** The cost of one frame. */
struct gz_frame_cost {
	int64_t shown_ns;          /**< time it was shown, CLOCK_MONOTONIC */
	double ms[GZ_FRAME_PARTS]; /**< 0 or more each */
};

/** The last frames. Zero-initialised: none. */
struct gz_frame_history {
	struct gz_frame_cost costs[GZ_FRAME_HISTORY_SIZE];
	size_t count; /**< number of frames kept */
	size_t next;  /**< index for the next frame */
};

/** Add a frame, which replaces the oldest. Parts that are negative or NaN count as 0. */
void gz_frame_history_add(struct gz_frame_history *history, const struct gz_frame_cost *cost);

/** The frame @p back frames before the newest (0: the newest); NULL if there is none. */
const struct gz_frame_cost *gz_frame_history_at(const struct gz_frame_history *history,
						size_t back);

/** The sum of a frame's parts, ms. */
double gz_frame_cost_total_ms(const struct gz_frame_cost *cost);

/**
 * A quantile of the frames' costs by nearest rank: the smallest value that has at least @p share of
 * the values at or below it.
 *
 * @param part   GZ_FRAME_PARTS for the total
 * @param share  (0, 1]; 0.5 for the median
 * @return ms; 0 without a frame
 */
double gz_frame_history_quantile_ms(const struct gz_frame_history *history, enum gz_frame_part part,
				    double share);

#endif
