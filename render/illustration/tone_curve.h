/**
 * @file
 * Histogram equalisation of a shading map, over the pixels of objects only (Pfisterer 2007, section
 * 2.2.4, eq. 2.9): each brightness becomes the share of object pixels that are no brighter.
 *
 * Threads count bands of rows, each into a histogram of its own. Nothing allocates.
 */
#ifndef GZ_RENDER_ILLUSTRATION_TONE_CURVE_H
#define GZ_RENDER_ILLUSTRATION_TONE_CURVE_H

#include <stddef.h>
#include <stdint.h>

/** Brightnesses that are told apart. Chosen: 16 for each of a picture's 256. */
#define GZ_TONE_BINS 4096

/** How many object pixels have each brightness. Zero-initialised is empty. */
struct gz_tone_histogram {
	uint32_t counts[GZ_TONE_BINS];
};

/** What each brightness becomes. */
struct gz_tone_curve {
	float values[GZ_TONE_BINS];
};

/**
 * Count pixels 0, step, 2 step, ... below @p count.
 *
 * @param map  floats, which may have been stored as words (struct gz_plane): brightness; below 0
 *             counts as 0, above 1 and NaN as 1
 * @param ids  object of each; those of object 0, the background, do not count
 */
void gz_tone_count(const void *map, const uint32_t *ids, size_t count, size_t step,
		   struct gz_tone_histogram *histogram);

/**
 * Make the curve of all histograms together: N_I / N, where N_I pixels are as bright as I or
 * darker, of N in all. Without any pixel the curve changes nothing.
 */
void gz_tone_curve_make(const struct gz_tone_histogram *histograms, size_t count,
			struct gz_tone_curve *out_curve);

/** How much brighter than its tone a pixel gets at most when a tone rises by so much: the steepest
 * rise of a steadied curve. Chosen: scans stay equalised nearly as before. */
#define GZ_TONE_RISE_MOST 7

/**
 * Keep frames alike that differ little. A flat surface has one tone, at which the curve leaps from
 * 0 to 1: whatever changes that tone a little, as another view or another place of the gaze, would
 * make it black or white. So each tone counts for those around it, 1/64 of their range, and where
 * still more than GZ_TONE_RISE_MOST - 1 times the mean share of pixels has a tone, the rest is
 * spread over all tones (contrast limits: Zuiderveld, Graphics Gems IV, 1994). The curve still
 * rises, up to 1.
 */
void gz_tone_curve_steady(struct gz_tone_curve *curve);

/** Mix a curve with the one that changes nothing: @p share of the curve, [0, 1]. */
void gz_tone_curve_soften(float share, struct gz_tone_curve *curve);

/** Change the brightness of pixels of objects by a curve; the background stays as it is. */
void gz_tone_apply(const struct gz_tone_curve *curve, const uint32_t *ids, size_t count,
		   float *map);

#endif
