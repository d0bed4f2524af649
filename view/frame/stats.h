/**
 * @file
 * What each frame cost: a line of text and an entry in the statistics file.
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
	uint64_t bricks_coming; /**< see struct gz_frame_stats */
	uint64_t samples;
	double plan_ms;
	double cast_ms;
	double reconstruct_ms; /**< with the resampling of image_sampling_rate */
	double total_ms;       /**< wall time from the gaze to the finished picture */
	bool gaze_known;
	struct gz_point gaze;
	bool age_known;
	double gaze_age_ms;    /**< when the plan was made */
	const char *attention; /**< what the plan went by: gz_attention_state_name() */
	struct gz_focus focus; /**< what the plan was made of */
	double budget_ms;      /**< 0: none */
	bool kept;             /**< what earlier frames saw is in it: temporal.accumulate */
	const char *budget;    /**< how that went: gz_budget_state_name() */
};

/**
 * The frame as one line without newline, as in
 * "acuity 1920x1080 rays 216440 samples 9631187 plan 0.21 cast 68.10 reconstruct 4.90 total 73.30
 * ms gaze age 3.1 ms"; "-" stands for an age that there is none of. Cut to @p size.
 */
void gz_frame_record_print(const struct gz_frame_record *record, char *text, size_t size);

/**
 * A statistics file: {"frames": [ ... ]}. It is whole JSON after every call, so that an error or a
 * signal between two frames leaves a file that parses.
 */
struct gz_stats_file;

/**
 * Create or empty the file.
 *
 * @param[out] out_file  owned by the caller: gz_stats_close()
 * @retval GZ_ERR_IO      cannot be written, or is no plain file; logged
 * @retval GZ_ERR_NO_MEM  no room
 */
enum gz_result gz_stats_open(const char *path, const struct gz_log *log,
			     struct gz_stats_file **out_file);

/** Append one frame. GZ_ERR_IO: disk full; logged; earlier frames stay. */
enum gz_result gz_stats_add(struct gz_stats_file *file, const struct gz_frame_record *record);

/** Close and set to NULL. Accepts a pointer to NULL. */
void gz_stats_close(struct gz_stats_file **file);

/** What a frame's time goes to, in the order of the work. */
enum gz_frame_part {
	GZ_FRAME_PLAN,
	GZ_FRAME_CAST,
	GZ_FRAME_RECONSTRUCT,
	GZ_FRAME_REST, /**< what is left until it is on the screen: upload, panels, swap */
	GZ_FRAME_PARTS,
};

/** Frames that are kept: some seconds of them (chosen: two or four px each in the plot). */
#define GZ_FRAME_HISTORY_SIZE 256

/** One frame. */
struct gz_frame_cost {
	int64_t shown_ns;          /**< when it was on the screen, CLOCK_MONOTONIC */
	double ms[GZ_FRAME_PARTS]; /**< 0 or more each */
};

/** Zero-initialised has no frame. */
struct gz_frame_history {
	struct gz_frame_cost costs[GZ_FRAME_HISTORY_SIZE];
	size_t count; /**< frames in it */
	size_t next;  /**< where the next goes */
};

/** Keep a frame in the place of the oldest; parts below 0 or no number count as 0. */
void gz_frame_history_add(struct gz_frame_history *history, const struct gz_frame_cost *cost);

/** The frame @p back frames before the newest, which is 0. @return NULL if there is none */
const struct gz_frame_cost *gz_frame_history_at(const struct gz_frame_history *history,
						size_t back);

/** All parts of a frame, ms. */
double gz_frame_cost_total_ms(const struct gz_frame_cost *cost);

/**
 * The value that a share of the frames do not exceed: the least one of the sorted values that has
 * that share of them at or below it (nearest rank).
 *
 * @param part   GZ_FRAME_PARTS for the total
 * @param share  (0, 1]; 0.5 for the median
 * @return ms; 0 without a frame
 */
double gz_frame_history_quantile_ms(const struct gz_frame_history *history, enum gz_frame_part part,
				    double share);

#endif
