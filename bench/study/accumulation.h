/**
 * @file
 * What keeping earlier frames gains (temporal.accumulate): the errors of a method's picture after
 * more and more of them, beside one that keeps nothing. Studies measure without it.
 */
#ifndef GZ_BENCH_STUDY_ACCUMULATION_H
#define GZ_BENCH_STUDY_ACCUMULATION_H

#include "base/log.h"
#include "base/result.h"
#include "bench/study/stage.h"
#include "bench/study/study.h"

/** Frames after which a picture is compared, while gaze and camera are still. Chosen: of each 4^k
 *  frames every shift below 2^k px comes once. */
#define GZ_ACCUMULATION_STILL_ROWS 4
extern const int gz_accumulation_still_frames[GZ_ACCUMULATION_STILL_ROWS];

/** Frames of a camera that turns, after which its picture is compared. Chosen: what is older has
 *  next to no share left (.9^16 = .19, and rays take its place). */
#define GZ_ACCUMULATION_TURNING_FRAMES 16

/** Rows of one variant: still and turning, each without and with earlier frames. */
#define GZ_ACCUMULATION_ROWS (1 + GZ_ACCUMULATION_STILL_ROWS + 2)

/** One picture. */
struct gz_accumulation_row {
	bool turning;    /**< the camera turns from frame to frame */
	int frames;      /**< that are in it; 0: a frame by itself, as temporal.accumulate = no */
	double frame_ms; /**< median of the frames since the row before */
	struct gz_study_errors errors; /**< against the converged picture of the same camera */
};

/** What is measured. */
struct gz_accumulation_request {
	const struct gz_study *study; /**< asked for, without rows: gz_study_ask() */
	size_t scene, size, backend, variant, point;
	double turn_deg;   /**< of the camera that turns, a frame */
	const char *cache; /**< folder of converged pictures; NULL: none are kept */
};

/**
 * Measure a variant. The scene's temporal.weight holds; temporal.accumulate does not count.
 *
 * @param stage  where scenes are shown
 * @param[out] out_rows  the still ones first, each group by its number of frames
 * @retval GZ_ERR_UNSUPPORTED  the scene is a file of bricks; logged
 * @retval GZ_ERR_CANCELLED    SIGINT or SIGTERM has arrived; not logged
 * @return else what gz_stage_enter() and gz_picture_make() return; logged
 */
enum gz_result gz_accumulation_measure(const struct gz_accumulation_request *request,
				       struct gz_stage *stage, const struct gz_log *log,
				       struct gz_accumulation_row out_rows[GZ_ACCUMULATION_ROWS]);

#endif
