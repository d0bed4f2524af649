/**
 * @file
 * What the last frames cost, part by part: for the plot of frame times.
 */
#ifndef GZ_VIEW_FRAME_FRAME_HISTORY_H
#define GZ_VIEW_FRAME_FRAME_HISTORY_H

#include <stddef.h>
#include <stdint.h>

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
