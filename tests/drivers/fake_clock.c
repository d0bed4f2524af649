/* base/clock.h with a clock that stands still but for sleeping: tests that link this take no time.
 */
#include "base/clock.h"

static int64_t now_ns = 1000 * GZ_NS_PER_S;

int64_t gz_clock_now_ns(void)
{
	/* Never twice the same, so that who polls gets on. */
	return now_ns++;
}

void gz_clock_sleep_until_ns(int64_t deadline_ns)
{
	if (deadline_ns > now_ns)
		now_ns = deadline_ns;
}
