/**
 * @file
 * Depth blurred by a Gaussian, which tells edges of near objects from what lies behind them (Luft,
 * Colditz and Deussen, "Image enhancement by unsharp masking the depth buffer", SIGGRAPH 2006).
 *
 * The Gaussian is separable: a pass over rows, then one over columns. Both take a band of rows, so
 * that threads share a plane; all of the first pass ends before the second begins. They do not
 * allocate. Beyond the picture its border repeats.
 *
 * A wide Gaussian runs on a picture of fewer cells, each the mean of a square of pixels, and is
 * enlarged bilinearly (the pyramid of Burt, "Fast filter transforms for image processing", 1981).
 * Both steps blur a little themselves; the Gaussian of the cells is as much narrower. Against the
 * Gaussian of the pixels, a step from 0 to 1 is wrong by at most 0.01, and by 0.04 within a cell of
 * the border (measured).
 */
#ifndef GZ_RENDER_ILLUSTRATION_DEPTH_BLUR_H
#define GZ_RENDER_ILLUSTRATION_DEPTH_BLUR_H

#include <stdint.h>

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

/** Most times that a picture is halved. */
#define GZ_BLUR_LEVELS_MAX 5

/** Pixels that gz_depth_enlarge() makes at once, and that a row of cells begins at multiples of. */
#define GZ_BLUR_COLUMNS 64

/** A Gaussian, and the level of cells that it runs on: cells of level k have 2^k by 2^k pixels, so
 *  that level 0 is the picture. */
struct gz_depth_blur {
	int level; /**< 0 to GZ_BLUR_LEVELS_MAX */
	struct gz_gaussian gaussian;
};

/** Make the blur of a standard deviation in pixels, 0 or more. */
void gz_depth_blur_make(double deviation_px, struct gz_depth_blur *out_blur);

/** How many cells of a level a side of @p pixels has; the last one may reach beyond it. */
static inline int gz_blur_cells(int pixels, int level)
{
	return (pixels + (1 << level) - 1) >> level;
}

/** Where depth lies between the ends of a scene. */
struct gz_depth_range {
	float near, far; /**< in the unit of depth; near < far */
};

/**
 * Depth as a share of the scene's: (z - near) / (far - near), cut to [0, 1]; 1 where @p ids are 0
 * and where depth is not a number.
 *
 * @param depth  @p count floats, which may have been stored as words (struct gz_plane)
 */
void gz_depth_share(const void *depth, const uint32_t *ids, int count,
		    const struct gz_depth_range *range, float *out_shares);

/** Make a row of the next level from two rows of @p width cells; of an odd width the last cell
 *  counts twice. @param[out] out_cells  (width + 1) / 2 */
void gz_depth_halve(const float *upper, const float *lower, int width, float *out_cells);

/** Enlarge cells of a level bilinearly: GZ_BLUR_COLUMNS pixels of row @p y from column @p x on,
 *  which is a multiple of that. Beyond the cells their border repeats.
 *  @param width, height  of the plane of cells */
void gz_depth_enlarge(const float *cells, int width, int height, int level, int x, int y,
		      float *out_pixels);

#endif
