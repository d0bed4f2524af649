/**
 * @file
 * Measuring one unit of a study: the frames of all variants in turn at one point, then the errors
 * of their pictures.
 */
#ifndef GZ_BENCH_STUDY_MEASURE_H
#define GZ_BENCH_STUDY_MEASURE_H

#include "base/log.h"
#include "base/result.h"
#include "bench/study/stage.h"
#include "bench/study/study.h"

/** Degrees that the camera turns between two rounds of frames, so that nothing is the same by
 *  accident. */
#define GZ_MEASURE_TURN_DEG 0.01

/** What is kept from unit to unit. */
struct gz_measurer;

/**
 * Make a measurer.
 *
 * @param study  borrowed, outlives it
 * @param stage  borrowed, outlives it: where scenes are shown
 * @param cache  folder of references, borrowed; NULL: none are kept
 * @param[out] out_measurer  the caller's: gz_measurer_destroy()
 * @retval GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_measurer_create(const struct gz_study *study, struct gz_stage *stage,
				  const char *cache, const struct gz_log *log,
				  struct gz_measurer **out_measurer);

/**
 * Measure a unit.
 *
 * Warm-up rounds come first, then counted ones. In a round each variant renders one frame, and the
 * camera turns by GZ_MEASURE_TURN_DEG before the next. A plan is made anew for each frame unless
 * its method does not ask for the gaze; nothing is accumulated. Where a backend can leave the
 * picture on its device, it does. Errors are those of one more frame of each variant with the
 * camera not turned.
 *
 * @param[out] out_rows  gz_study_unit_rows() of them
 * @retval GZ_ERR_CANCELLED  SIGINT or SIGTERM has arrived (gz_command_catch_signals()); not logged
 * @return else what gz_stage_enter() and gz_picture_make() return; logged
 */
enum gz_result gz_measurer_measure(struct gz_measurer *measurer, size_t unit,
				   struct gz_study_row *out_rows);

/** Free and set to NULL. Accepts a pointer to NULL. */
void gz_measurer_destroy(struct gz_measurer **measurer);

#endif
