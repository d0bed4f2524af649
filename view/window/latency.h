/**
 * @file
 * The part of the window that measures the time from a gaze to light on the display, and switches
 * V-sync.
 *
 * Measured are the age of the gaze sample when it was taken; the frame from then to the swap (plan,
 * rays, panels); and the time from the swap until the graphics device has finished, by a fence
 * behind the swap that is polled each millisecond. Estimated is half a refresh of the monitor, for
 * the scan-out from the top of the display to its middle. A program cannot know the delay of the
 * display itself. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_LATENCY_H
#define GZ_VIEW_WINDOW_LATENCY_H

#include <stdbool.h>

struct gz_window;

/** Frames in a median. */
enum { GZ_LATENCY_FRAMES = 64 };

/** Medians over the last frames that had a new picture, ms. */
struct gz_latency {
	int frames;        /**< number of frames, 1 to GZ_LATENCY_FRAMES */
	bool age_known;    /**< the source tells the age of its samples */
	double age_ms;     /**< of the sample when it was taken; 0: not known */
	double frame_ms;   /**< from then to the swap */
	double present_ms; /**< from the swap until the device has finished */
	double scanout_ms; /**< estimated; 0: the refresh rate is not known */
	double total_ms;   /**< the sum of these four */
};

/** The latency measured so far. @return false before the first frame */
bool gz_window_latency(const struct gz_window *window, struct gz_latency *out_latency);

/** The median of @p count values, at least one, which are sorted. */
double gz_latency_median_ms(double *values_ms, int count);

#endif
