#include "base/suspend.h"

#include <time.h>

#include "base/clock.h"

int64_t gz_suspended_ns(void)
{
	struct timespec t;
	int64_t before_ns = gz_clock_now_ns();
	clock_gettime(CLOCK_BOOTTIME, &t);
	return (int64_t)t.tv_sec * GZ_NS_PER_S + t.tv_nsec - before_ns;
}
