/**
 * @file
 * The times of a video's pictures, which are even, against those of the pictures shown, which are
 * not. Pure arithmetic.
 */
#ifndef GZ_VIEW_CAPTURE_VIDEO_CLOCK_H
#define GZ_VIEW_CAPTURE_VIDEO_CLOCK_H

#include <stdint.h>

/** Picture k of the video shows what was shown at start_ns + k / fps. */
struct gz_video_clock {
	double fps; /**< above 0 */
	int64_t start_ns;
	uint64_t passed; /**< pictures that gz_video_clock_pass() has counted so far */
};

/** Start at @p start_ns. */
void gz_video_clock_start(struct gz_video_clock *clock, double fps, int64_t start_ns);

/**
 * What was shown last has been shown until @p time_ns.
 *
 * @return how many pictures of the video show it: those before @p time_ns that none has shown yet
 */
uint64_t gz_video_clock_pass(struct gz_video_clock *clock, int64_t time_ns);

#endif
