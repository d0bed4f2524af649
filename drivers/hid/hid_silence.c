#include "drivers/hid/hid_silence.h"

#include <math.h>

/* Steps until the measured period is believed, and how fast it follows: chosen, as the pipeline's.
 */
enum { STEPS_ENOUGH = 16 };
static const double GAIN = 1.0 / 16;

/* Where nothing is known: the slowest trackers' period, ns. */
static const double SLOWEST_NS = 1e9 / 30;

void gz_hid_silence_sample(struct gz_hid_silence *silence, int64_t host_ns, int64_t arrival_ns)
{
	double step_ns = (double)(host_ns - silence->host_ns);
	/* A step over silence, or of a clock, is no period. */
	if (silence->started && silence->filled == 0 && step_ns > 0) {
		if (silence->steps == 0)
			silence->measured_ns = fmin(step_ns, SLOWEST_NS);
		double change_ns = step_ns - silence->measured_ns;
		silence->measured_ns += GAIN * fmin(change_ns, silence->measured_ns);
		if (silence->steps < STEPS_ENOUGH)
			silence->steps++;
	}
	silence->started = true;
	silence->host_ns = host_ns;
	silence->arrival_ns = arrival_ns;
	silence->filled = 0;
}

double gz_hid_silence_period_ns(const struct gz_hid_silence *silence)
{
	if (silence->steps >= STEPS_ENOUGH)
		return silence->measured_ns;
	return silence->nominal_ns > 0 ? silence->nominal_ns : SLOWEST_NS;
}

int64_t gz_hid_silence_due_ns(const struct gz_hid_silence *silence)
{
	if (!silence->started)
		return INT64_MAX;
	/* The first ones together, then one a period. */
	int64_t periods = silence->filled + 2;
	if (periods < GZ_HID_SILENCE_PERIODS)
		periods = GZ_HID_SILENCE_PERIODS;
	return silence->arrival_ns + (int64_t)((double)periods * gz_hid_silence_period_ns(silence));
}

int64_t gz_hid_silence_fill(struct gz_hid_silence *silence)
{
	silence->filled++;
	return silence->host_ns +
	       (int64_t)((double)silence->filled * gz_hid_silence_period_ns(silence));
}
