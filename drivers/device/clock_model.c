#include "drivers/device/clock_model.h"

#include <math.h>
#include <string.h>

#include "base/clock.h"

/* Bins that a line needs before its slope means anything: 2 s. Chosen: a delay that scatters by 0.1
 * ms then tilts the line by 50 ppm at most, which is 0.1 ms over the window. */
enum { BINS_FOR_SLOPE = 4 };

/* Delay of an undelayed sample of device time @p x, by the line of the segment. */
static double expected_delay_ns(const struct gz_clock_model *model, double x)
{
	return model->delay_ns + model->slope * x;
}

static void begin_clock_segment(struct gz_clock_model *model, int64_t device_ns, int64_t arrival_ns)
{
	*model = (struct gz_clock_model) {
		.started = true,
		.host_ns = model->host_ns,
		.device_ns = device_ns,
		.first_device_ns = device_ns,
		.first_arrival_ns = arrival_ns,
		.count = 1,
	};
}

/* Whether @p c lies on or below the line from @p a to @p b, so that @p b is not on the hull. */
static bool is_above_hull(const struct gz_clock_bin *a, const struct gz_clock_bin *b,
			  const struct gz_clock_bin *c)
{
	double to_b = (b->delay_ns - a->delay_ns) * (c->device_ns - a->device_ns);
	double to_c = (c->delay_ns - a->delay_ns) * (b->device_ns - a->device_ns);
	return to_b >= to_c;
}

/* Lower convex hull, left to right (Andrew's monotone chain). The bins are sorted by device time.
 */
static int lower_hull(const struct gz_clock_model *model, const struct gz_clock_bin **hull)
{
	int n = 0;
	for (int i = 0; i < model->count; i++) {
		while (n >= 2 && is_above_hull(hull[n - 2], hull[n - 1], &model->bins[i]))
			n--;
		hull[n++] = &model->bins[i];
	}
	return n;
}

static double mean_device_ns(const struct gz_clock_model *model)
{
	double sum = 0;
	for (int i = 0; i < model->count; i++)
		sum += model->bins[i].device_ns;
	return sum / model->count;
}

static double rms_above_line(const struct gz_clock_model *model)
{
	double sum = 0;
	for (int i = 0; i < model->count; i++) {
		const struct gz_clock_bin *bin = &model->bins[i];
		double above = bin->delay_ns - expected_delay_ns(model, bin->device_ns);
		sum += above * above;
	}
	return sqrt(sum / model->count);
}

/* Of the lines below all points, the nearest one contains the hull edge above which the mean of the
 * points lies (Moon 1999, section IV). */
static void fit_lower_line(struct gz_clock_model *model)
{
	const struct gz_clock_bin *hull[GZ_CLOCK_BINS];
	int n = lower_hull(model, hull);
	double mean = mean_device_ns(model);
	int edge = 0;
	while (edge + 2 < n && hull[edge + 1]->device_ns < mean)
		edge++;
	double slope = 0;
	if (n >= 2 && model->count >= BINS_FOR_SLOPE)
		slope = (hull[edge + 1]->delay_ns - hull[edge]->delay_ns) /
			(hull[edge + 1]->device_ns - hull[edge]->device_ns);
	model->slope = fmax(-GZ_CLOCK_SKEW_MAX, fmin(GZ_CLOCK_SKEW_MAX, slope));

	/* Keep the line below all points even if the slope was limited or is 0. */
	model->delay_ns = INFINITY;
	for (int i = 0; i < model->count; i++) {
		const struct gz_clock_bin *bin = &model->bins[i];
		double here = bin->delay_ns - model->slope * bin->device_ns;
		model->delay_ns = fmin(model->delay_ns, here);
	}
	model->sigma_ns = rms_above_line(model);
}

static void begin_clock_bin(struct gz_clock_model *model, double x, double delay_ns)
{
	if (model->count == GZ_CLOCK_BINS) {
		memmove(model->bins, model->bins + 1, sizeof *model->bins * (GZ_CLOCK_BINS - 1));
		model->count--;
	}
	model->bins[model->count++] = (struct gz_clock_bin) { x, delay_ns };
}

/* Put the sample into its bin. Fit again when a bin is complete, or when the sample was delayed
 * less than the line says. */
static void add_to_bins(struct gz_clock_model *model, double x, double delay_ns)
{
	int64_t bin = (int64_t)x / GZ_CLOCK_BIN_NS;
	struct gz_clock_bin *newest = &model->bins[model->count - 1];
	if (bin != model->bin) {
		fit_lower_line(model);
		model->bin = bin;
		begin_clock_bin(model, x, delay_ns);
	} else if (delay_ns < newest->delay_ns) {
		*newest = (struct gz_clock_bin) { x, delay_ns };
	}
	if (delay_ns < expected_delay_ns(model, x))
		fit_lower_line(model);
}

/* Whether the device clock jumped: a sample that is too early proves it, samples that are too late
 * only if that lasts. */
static bool clock_jumped(struct gz_clock_model *model, double delay_ns, double expected_ns,
			 int64_t arrival_ns)
{
	if (delay_ns < expected_ns - (double)GZ_CLOCK_EARLY_NS)
		return true;
	if (delay_ns < expected_ns + (double)GZ_CLOCK_LATE_NS) {
		model->late = false;
		return false;
	}
	if (!model->late)
		model->late_ns = arrival_ns;
	model->late = true;
	return arrival_ns - model->late_ns > GZ_CLOCK_BIN_NS;
}

static int64_t answer_in_order(struct gz_clock_model *model, bool first, int64_t host_ns,
			       int64_t arrival_ns)
{
	model->host_ns = gz_clock_in_order(host_ns, arrival_ns, first ? NULL : &model->host_ns);
	return model->host_ns;
}

bool gz_clock_is_behind(int64_t device_ns, int64_t newest_ns)
{
	int64_t back_ns;
	return !__builtin_sub_overflow(newest_ns, device_ns, &back_ns) && back_ns >= 0 &&
	       back_ns < GZ_NS_PER_S;
}

int64_t gz_clock_model_step(struct gz_clock_model *model, int64_t device_ns, int64_t arrival_ns,
			    bool *out_jumped)
{
	int64_t x = 0, elapsed = 0, delay = 0;
	bool follows = model->started && device_ns > model->device_ns &&
		       !__builtin_sub_overflow(device_ns, model->first_device_ns, &x) &&
		       !__builtin_sub_overflow(arrival_ns, model->first_arrival_ns, &elapsed) &&
		       !__builtin_sub_overflow(elapsed, x, &delay) &&
		       !clock_jumped(model, (double)delay, expected_delay_ns(model, (double)x),
				     arrival_ns);
	bool first = !model->started;
	if (out_jumped)
		*out_jumped = !first && !follows;
	if (!follows) {
		begin_clock_segment(model, device_ns, arrival_ns);
		return answer_in_order(model, first, arrival_ns, arrival_ns);
	}
	model->device_ns = device_ns;
	add_to_bins(model, (double)x, (double)delay);
	double after = (double)x + expected_delay_ns(model, (double)x);
	return answer_in_order(model, first, model->first_arrival_ns + (int64_t)after, arrival_ns);
}

void gz_clock_model_restart(struct gz_clock_model *model)
{
	/* No device time is newer than this one. */
	model->device_ns = INT64_MAX;
}

struct gz_clock_status gz_clock_model_status(const struct gz_clock_model *model,
					     enum gz_clock_tick tick)
{
	/* In unsigned numbers: a device may send any time, and the difference may not fit. */
	uint64_t offset = (uint64_t)model->host_ns - (uint64_t)model->device_ns;
	return (struct gz_clock_status) {
		.offset_ns = model->started ? (int64_t)offset : 0,
		.skew_ppm = (0 - model->slope) / (1 + model->slope) * 1e6,
		.sigma_ns = model->sigma_ns,
		.tick = tick,
	};
}

int64_t gz_clock_in_order(int64_t host_ns, int64_t arrival_ns, const int64_t *last_ns)
{
	if (host_ns > arrival_ns)
		host_ns = arrival_ns;
	if (last_ns && host_ns <= *last_ns)
		host_ns = *last_ns + 1;
	return host_ns;
}

int64_t gz_clock_unwrap32(int64_t last, uint32_t counter)
{
	int32_t step = (int32_t)(counter - (uint32_t)last);
	int64_t next = last + step;
	return next < 0 ? (int64_t)counter : next;
}
