/**
 * @file
 * The part of the window that measures how long it takes from a gaze to light on the display, and
 * waits for the display's refresh or not.
 *
 * Measured: the age of the gaze's sample when it was taken; from then to the picture's hand-over
 * (plan, rays, panels); from there until the graphics device is done with it, by a fence behind the
 * swap that is looked at each millisecond and waited for by nobody. Estimated: half a refresh of
 * the monitor, for the way from the top of the display to the middle. What the display itself takes
 * is not known to a program. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_LATENCY_H
#define GZ_VIEW_WINDOW_LATENCY_H

#include <stdbool.h>

#include "view/window/part.h"

/** Frames that medians are of. */
enum { GZ_LATENCY_FRAMES = 64 };

/** Medians over the last frames with a new picture, ms. */
struct gz_latency {
	int frames;        /**< that they are of, 1 to GZ_LATENCY_FRAMES */
	bool age_known;    /**< the source tells when its samples were taken */
	double age_ms;     /**< of the sample, when it was taken; 0 where not known */
	double frame_ms;   /**< from then to the hand-over of the picture */
	double present_ms; /**< from there until the device is done: swap to fence */
	double scanout_ms; /**< estimated; 0 where the refresh is not known */
	double total_ms;   /**< the sum of these four */
};

/** The part. */
extern const struct gz_window_part gz_window_latency_part;

/** What was measured so far. @return false before the first frame */
bool gz_window_latency(const struct gz_window *window, struct gz_latency *out_latency);

#endif
