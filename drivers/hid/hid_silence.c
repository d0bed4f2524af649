#include "drivers/hid/hid_silence.h"

#include <math.h>

/* Steps until the measured period is believed, and how fast it follows: chosen, as the pipeline's.
 */
enum { STEPS_ENOUGH = 16 };
static const double GAIN = 1.0 / 16;

/* Longer steps, in periods, are never one. Chosen: shorter than blinks at any rate. */
static const double PERIOD_STEPS_MAX = 6;

/* Until it is measured, which takes half a second: the slowest trackers' period, ns. The stated one
 * is too often wrong. */
static const double SLOWEST_NS = 1e9 / 30;

double gz_hid_silence_period_ns(const struct gz_hid_silence *silence)
{
	if (silence->steps >= STEPS_ENOUGH)
		return silence->measured_ns;
	return fmax(silence->nominal_ns, SLOWEST_NS);
}

/* How fast a long gap between arrivals is forgotten, a sample; and the longest that is believed to
 * be the link's, ns. Chosen: a stall counts for some tenths of a second, no link buffers for more
 * than a frame or two of a screen. */
static const double GAP_DECAY = 1 - 1.0 / 32;
static const double GAP_MAX_NS = 40e6;

/* Samples without one missing between them, and yet far apart in arrival, came in bursts. */
static void learn_gap(struct gz_hid_silence *silence, double step_ns, double arrival_step_ns)
{
	silence->gap_ns *= GAP_DECAY;
	if (step_ns < 1.5 * gz_hid_silence_period_ns(silence))
		silence->gap_ns = fmax(silence->gap_ns, fmin(arrival_step_ns, GAP_MAX_NS));
}

void gz_hid_silence_sample(struct gz_hid_silence *silence, int64_t host_ns, int64_t arrival_ns)
{
	double step_ns = (double)(host_ns - silence->host_ns);
	/* A step over a blink, or of a clock, is no period; one over a few fillers may be, of a
	 * tracker that has become slower. */
	if (silence->started && step_ns > 0 &&
	    step_ns < PERIOD_STEPS_MAX * gz_hid_silence_period_ns(silence)) {
		if (silence->steps == 0)
			silence->measured_ns = fmin(step_ns, SLOWEST_NS);
		double change_ns = step_ns - silence->measured_ns;
		silence->measured_ns += GAIN * fmin(change_ns, silence->measured_ns);
		if (silence->steps < STEPS_ENOUGH)
			silence->steps++;
	}
	if (silence->started)
		learn_gap(silence, step_ns, (double)(arrival_ns - silence->arrival_ns));
	silence->started = true;
	silence->host_ns = host_ns;
	silence->arrival_ns = arrival_ns;
	silence->filled = 0;
}

int64_t gz_hid_silence_due_ns(const struct gz_hid_silence *silence)
{
	if (!silence->started)
		return INT64_MAX;
	/* The first ones together, then one a period. */
	double period_ns = gz_hid_silence_period_ns(silence);
	double late_ns = fmax(period_ns, silence->gap_ns);
	double due_ns = (double)(silence->filled + 1) * period_ns + late_ns;
	return silence->arrival_ns + (int64_t)fmax(GZ_HID_SILENCE_PERIODS * period_ns, due_ns);
}

int64_t gz_hid_silence_fill(struct gz_hid_silence *silence)
{
	silence->filled++;
	return silence->host_ns +
	       (int64_t)((double)silence->filled * gz_hid_silence_period_ns(silence));
}
