/**
 * @file
 * How far two pictures are apart: PSNR, SSIM and FLIP, over the whole picture or weighted by what
 * the eye sees at each place.
 *
 * A test picture is held against a reference of the same size. Alpha is not looked at.
 */
#ifndef GZ_BENCH_METRICS_METRICS_H
#define GZ_BENCH_METRICS_METRICS_H

#include <stddef.h>

#include "base/result.h"
#include "base/workers.h"
#include "protocol/display.h"
#include "render/picture/image.h"

/** One number a pixel, row by row from the top. Zero-initialised is empty. */
struct gz_map {
	int width, height;
	float *values;
};

/** Make room for a map, keeping the buffer where it already fits; contents are undefined.
 *  GZ_ERR_INVAL for sides out of 1 to GZ_IMAGE_SIDE_MAX, GZ_ERR_NO_MEM. */
enum gz_result gz_map_resize(struct gz_map *map, int width, int height);

/** Free the values and zero the struct. */
void gz_map_free(struct gz_map *map);

/** Mean of all values. */
double gz_map_mean(const struct gz_map *map);

/** Sum of values times weights over the sum of weights; 0 where that is 0. Maps of one size. */
double gz_map_weighted_mean(const struct gz_map *map, const struct gz_map *weights);

/**
 * Squared error of each pixel, mean over R, G and B, channels in [0, 1].
 *
 * @param[in,out] out_map  resized to the pictures' size
 * @retval GZ_ERR_INVAL   the sizes differ
 * @retval GZ_ERR_NO_MEM  no room
 */
enum gz_result gz_squared_error(const struct gz_image *reference, const struct gz_image *test,
				struct gz_map *out_map);

/** Peak signal-to-noise ratio of a mean squared error, dB: -10 log10(mse), infinite for 0. */
double gz_psnr_db(double mean_squared_error);

/** Over which pixels SSIM compares. */
enum gz_ssim_window {
	GZ_SSIM_GAUSSIAN, /**< 11 x 11, sigma 1.5, population covariance (Wang et al. 2004) */
	GZ_SSIM_UNIFORM,  /**< 7 x 7, every pixel alike, sample covariance */
};

/**
 * Structural similarity (Wang, Bovik, Sheikh and Simoncelli 2004, K1 = .01, K2 = .03), mean over R,
 * G and B.
 *
 * @param[in,out] out_map  of every place where the window fits: its radius (5 or 3) less on each
 * side than the pictures
 * @param workers  share the work
 * @retval GZ_ERR_INVAL   the sizes differ, or the window does not fit
 * @retval GZ_ERR_NO_MEM  no room
 */
enum gz_result gz_ssim(const struct gz_image *reference, const struct gz_image *test,
		       enum gz_ssim_window window, struct gz_workers *workers,
		       struct gz_map *out_map);

/**
 * LDR-FLIP: the difference that is seen when one picture follows the other in the same place, 0 to
 * 1 (Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom and Fairchild 2020).
 *
 * @param px_per_deg  pixels a degree of visual angle, 1 to 1000
 * @param workers     share the work
 * @param[in,out] out_map  resized to the pictures' size
 * @retval GZ_ERR_INVAL   the sizes differ, or @p px_per_deg is out of range
 * @retval GZ_ERR_NO_MEM  no room
 */
enum gz_result gz_flip(const struct gz_image *reference, const struct gz_image *test,
		       double px_per_deg, struct gz_workers *workers, struct gz_map *out_map);

/** The fovea of every metric: this far round the gaze, degrees. */
#define GZ_FOVEA_DEG 2.5

/**
 * Weight 1 for pixels whose centre is between two eccentricities, 0 elsewhere.
 *
 * @param display  geometry of the picture, which fills it
 * @param gaze     normalised
 * @param ring_deg  least (included) and greatest (excluded) eccentricity, degrees
 */
enum gz_result gz_weights_ring(const struct gz_display *display, struct gz_point gaze, int width,
			       int height, const double ring_deg[2], struct gz_map *out_map);

/**
 * What a pixel counts for the eye: f_c(e)^2, f_c the highest frequency that is seen at its
 * eccentricity e, as a share of that at the gaze: e2 / (e + e2) by f_c = e2 ln(1/CT0) / (alpha (e +
 * e2)), e2 = 2.3 degrees (Geisler and Perry 1998; CT0 and alpha cancel).
 */
enum gz_result gz_weights_acuity(const struct gz_display *display, struct gz_point gaze, int width,
				 int height, struct gz_map *out_map);

#endif
