/**
 * @file
 * What the picture of a shading map is like: numbers by which settings can be chosen.
 */
#ifndef GZ_RENDER_ILLUSTRATION_SHADING_MEASURES_H
#define GZ_RENDER_ILLUSTRATION_SHADING_MEASURES_H

#include "render/illustration/shading_picture.h"

/** Measures of a frame, before any step of the picture. Those of object pixels are 0 without any.
 */
struct gz_shading_measures {
	double covered;     /**< share of the picture that objects cover */
	double tone_spread; /**< from the darkest tenth of tones to the brightest one */
	/** How much tones differ over 1/400 and over 1/40 of the picture's height, within an object
	 * and without a step of depth: root mean square. */
	double tone_fine, tone_wide;
	double depth_middle; /**< median of depth as a share of the scene's: 0 nearest, 1 farthest
			      */
	double depth_spread; /**< from the nearest tenth of pixels to the farthest one, likewise */
	/** Length of all outlines and steps of depth, in heights of the picture, over the area of
	 *  objects in squared heights. */
	double edges;
};

/**
 * Measure a frame, at 64 000 places or fewer for each height squared of picture. The same frame
 * gives the same bits. Takes about as long as counting the tones of its histogram once more.
 *
 * @param frame  as gz_shading_picture_compose() takes it
 */
void gz_shading_measure(const struct gz_shading_frame *frame,
			struct gz_shading_measures *out_measures);

#endif
