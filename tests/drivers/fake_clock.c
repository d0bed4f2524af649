/* base/clock.h with a clock that only sleeping advances: tests that link this file take no time. */
#include "base/clock.h"

static int64_t now_ns = 1000 * GZ_NS_PER_S;

int64_t gz_clock_now_ns(void)
{
	/* Advances a little, so that a caller that polls makes progress. */
	return now_ns++;
}

void gz_clock_sleep_until_ns(int64_t deadline_ns)
{
	if (deadline_ns > now_ns)
		now_ns = deadline_ns;
}
