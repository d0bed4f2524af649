/**
 * @file
 * How far the picture of a variant is from a reference, as studies keep it.
 */
#ifndef GZ_BENCH_STUDY_ERRORS_H
#define GZ_BENCH_STUDY_ERRORS_H

#include "bench/metrics/metrics.h"
#include "bench/study/study.h"

/** The error of each pixel, by each metric. Zero-initialised is empty. */
struct gz_error_maps {
	struct gz_map squared, ssim, flip;
	bool has_ssim; /**< no: the picture is smaller than the window */
};

/** What pixels count round one place of the gaze. Zero-initialised is empty; keep it, so that its
 *  buffers are reused. */
struct gz_error_weights {
	struct gz_map foveal, perceived;           /**< of every pixel */
	struct gz_map foveal_ssim, perceived_ssim; /**< of those that SSIM has a value for */
	bool any_foveal;                           /**< some of the fovea lies in the picture */
};

/**
 * Weigh the pixels of a picture.
 *
 * @param display  geometry of the picture, which fills it
 * @retval GZ_ERR_INVAL, GZ_ERR_NO_MEM
 */
enum gz_result gz_error_weights_make(struct gz_error_weights *weights,
				     const struct gz_display *display, struct gz_point gaze,
				     int width, int height, struct gz_workers *workers);

/** Compare two pictures of one size. @p px_per_deg: 1 to 1000, for FLIP. GZ_ERR_INVAL,
 *  GZ_ERR_NO_MEM. */
enum gz_result gz_error_maps_make(struct gz_error_maps *maps, const struct gz_image *reference,
				  const struct gz_image *test, double px_per_deg,
				  struct gz_workers *workers);

/** The errors of a picture, by weights of its size. Foveal ones are NaN where no pixel lies in the
 *  fovea. */
struct gz_study_errors gz_error_maps_weigh(const struct gz_error_maps *maps,
					   const struct gz_error_weights *weights);

/** The errors of a picture against itself, with the same NaN. */
struct gz_study_errors gz_errors_none(const struct gz_error_weights *weights, bool has_ssim);

/**
 * How much a picture changes: the mean of its channels' absolute differences in levels of 255,
 * weighted as perceived errors are.
 *
 * @param scratch  overwritten
 * @retval GZ_ERR_INVAL   the sizes differ
 * @retval GZ_ERR_NO_MEM  no room
 */
enum gz_result gz_errors_change(const struct gz_image *before, const struct gz_image *after,
				const struct gz_error_weights *weights, struct gz_map *scratch,
				double *out_change);

/** Free and zero. */
void gz_error_maps_free(struct gz_error_maps *maps);
void gz_error_weights_free(struct gz_error_weights *weights);

#endif
