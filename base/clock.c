#include "base/clock.h"

#include <errno.h>
#include <time.h>

int64_t gz_clock_now_ns(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (int64_t)t.tv_sec * GZ_NS_PER_S + t.tv_nsec;
}

void gz_clock_sleep_until_ns(int64_t deadline_ns)
{
	if (deadline_ns <= 0)
		return;
	const struct timespec t = {
		.tv_sec = (time_t)(deadline_ns / GZ_NS_PER_S),
		.tv_nsec = (long)(deadline_ns % GZ_NS_PER_S),
	};
	while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, NULL) == EINTR)
		;
}
