/**
 * @file
 * What errors look like: pictures of each variant where its error is worst and where it is usual,
 * cut out where the eye would see most of the difference from standard.
 */
#ifndef GZ_BENCH_REPORT_CROPS_H
#define GZ_BENCH_REPORT_CROPS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "base/sizes.h"
#include "bench/report/summary.h"

/** Side of a crop, px of the picture; less where the picture is smaller. */
#define GZ_CROP_PX 64

/** One crop. Its file holds three squares side by side: the variant, standard, and their difference
 *  four times as strong. */
struct gz_crop {
	size_t group, series;    /**< places in the summary's list, and in the group's */
	bool worst;              /**< at the point of the greatest error against standard, else of
				  *   the median one */
	struct gz_point gaze;    /**< there; normalised */
	double error;            /**< there, in the metric's own unit */
	double away_deg;         /**< from the gaze to the middle of the crop */
	char path[GZ_PATH_SIZE]; /**< FOLDER/crop-worst-N.png, N the variant's number from 1 */
};

/** The crops of a study, in the order of its groups. Zero-initialised is empty. */
struct gz_crops {
	struct gz_crop *items;
	size_t count;
};

/**
 * Render crops and write their files. The variants are drawn as they were measured, by the group's
 * backend at the group's size. A group has none without errors or standard in the study, if a
 * backend of the study does not run here, or if the scene is not there or shows something else than
 * was measured. At most 16 variants of a group get crops.
 *
 * @param[out] out_crops  the caller frees it with gz_crops_free()
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged; nothing is held
 */
enum gz_result gz_crops_make(const struct gz_summary *summary, const char *folder,
			     const struct gz_log *log, struct gz_crops *out_crops);

/** Free what it holds and zero it. The files stay. */
void gz_crops_free(struct gz_crops *crops);

#endif
