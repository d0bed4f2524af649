/**
 * @file
 * Depth blurred by a Gaussian, which tells edges of near objects from what lies behind them (Luft,
 * Colditz and Deussen, "Image enhancement by unsharp masking the depth buffer", SIGGRAPH 2006).
 *
 * The Gaussian is separable: a pass over rows, then one over columns. Both take a band of rows, so
 * that threads share a plane; all of the first pass ends before the second begins. They do not
 * allocate. Beyond the picture its border repeats.
 */
#ifndef GZ_RENDER_ILLUSTRATION_DEPTH_BLUR_H
#define GZ_RENDER_ILLUSTRATION_DEPTH_BLUR_H

/** Most pixels that a Gaussian reaches to either side. Chosen: 3 standard deviations of 1/50 of
 *  2160 rows. */
#define GZ_GAUSSIAN_RADIUS_MAX 130

/** A Gaussian in pixels, whose weights add up to 1. */
struct gz_gaussian {
	int radius;                                /**< 0: leaves everything as it is */
	float weights[GZ_GAUSSIAN_RADIUS_MAX + 1]; /**< at distance 0 to radius */
};

/**
 * Make a Gaussian that ends at 3 standard deviations.
 *
 * @param deviation_px  standard deviation, pixels, 0 or more; beyond GZ_GAUSSIAN_RADIUS_MAX / 3 the
 *                      tails are cut off
 */
void gz_gaussian_make(double deviation_px, struct gz_gaussian *out_gaussian);

/** A band of rows of a plane, from first to before end. */
struct gz_plane_band {
	int width, height; /**< of the plane, 1 or more */
	int first, end;    /**< 0 <= first <= end <= height */
};

/** Blur along rows: the band's rows of @p out from those of @p in, which is another plane. */
void gz_blur_along_rows(const struct gz_gaussian *gaussian, const struct gz_plane_band *band,
			const float *in, float *out);

/** Blur along columns: the band's rows of @p out from any rows of @p in, which is another plane. */
void gz_blur_along_columns(const struct gz_gaussian *gaussian, const struct gz_plane_band *band,
			   const float *in, float *out);

#endif
