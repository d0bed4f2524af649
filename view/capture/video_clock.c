#include "view/capture/video_clock.h"

#include <math.h>

#include "base/clock.h"

void gz_video_clock_start(struct gz_video_clock *clock, double fps, int64_t start_ns)
{
	*clock = (struct gz_video_clock) { .fps = fps, .start_ns = start_ns };
}

uint64_t gz_video_clock_pass(struct gz_video_clock *clock, int64_t time_ns)
{
	if (time_ns <= clock->start_ns)
		return 0;
	/* Dividing last keeps whole results exact: the time of picture k, floored to ns, is not
	 * beyond k. */
	const double elapsed_ns = (double)(time_ns - clock->start_ns);
	const double reached = ceil(elapsed_ns * clock->fps / (double)GZ_NS_PER_S);
	/* Chosen: what no double counts exactly is no time of a video. */
	if (!(reached < 0x1p53))
		return 0;
	const uint64_t count = (uint64_t)reached;
	const uint64_t due = count > clock->passed ? count - clock->passed : 0;
	clock->passed += due;
	return due;
}
