#include "drivers/clock_model.h"

#include <math.h>
#include <string.h>

/* A line needs some length before its slope says anything: 2 s. Chosen: a delay's scatter of 0.1 ms
 * then tilts it by 50 ppm at most, which is 0.1 ms over the window. */
enum { BINS_FOR_SLOPE = 4 };

/* Where the segment's line says an undelayed sample of device time @p x arrives, less @p x. */
static double line_at(const struct gz_clock_model *model, double x)
{
	return model->delay_ns + model->slope * x;
}

static void begin_segment(struct gz_clock_model *model, int64_t device_ns, int64_t arrival_ns)
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

/* Whether @p c lies below the line from @p a to @p b or on it, so that @p b is not on the hull. */
static bool hides(const struct gz_clock_bin *a, const struct gz_clock_bin *b,
		  const struct gz_clock_bin *c)
{
	double to_b = (b->delay_ns - a->delay_ns) * (c->device_ns - a->device_ns);
	double to_c = (c->delay_ns - a->delay_ns) * (b->device_ns - a->device_ns);
	return to_b >= to_c;
}

/* Lower convex hull, left to right (Andrew's monotone chain); the bins are in order of device time.
 */
static int lower_hull(const struct gz_clock_model *model, const struct gz_clock_bin **hull)
{
	int n = 0;
	for (int i = 0; i < model->count; i++) {
		while (n >= 2 && hides(hull[n - 2], hull[n - 1], &model->bins[i]))
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
		double above = bin->delay_ns - line_at(model, bin->device_ns);
		sum += above * above;
	}
	return sqrt(sum / model->count);
}

/* Of the lines below all points the nearest one goes through the hull's edge above which their mean
 * lies (Moon 1999, section IV). */
static void fit(struct gz_clock_model *model)
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

	/* Below all points also where the slope is not the edge's. */
	model->delay_ns = INFINITY;
	for (int i = 0; i < model->count; i++) {
		const struct gz_clock_bin *bin = &model->bins[i];
		double here = bin->delay_ns - model->slope * bin->device_ns;
		model->delay_ns = fmin(model->delay_ns, here);
	}
	model->sigma_ns = rms_above_line(model);
}

static void begin_bin(struct gz_clock_model *model, double x, double delay_ns)
{
	if (model->count == GZ_CLOCK_BINS) {
		memmove(model->bins, model->bins + 1, sizeof *model->bins * (GZ_CLOCK_BINS - 1));
		model->count--;
	}
	model->bins[model->count++] = (struct gz_clock_bin) { x, delay_ns };
}

/* Take the sample into its bin; fit where a bin is complete, or its sample was less delayed than
 * any before. */
static void learn(struct gz_clock_model *model, double x, double delay_ns)
{
	int64_t bin = (int64_t)x / GZ_CLOCK_BIN_NS;
	struct gz_clock_bin *newest = &model->bins[model->count - 1];
	if (bin != model->bin) {
		fit(model);
		model->bin = bin;
		begin_bin(model, x, delay_ns);
	} else if (delay_ns < newest->delay_ns) {
		*newest = (struct gz_clock_bin) { x, delay_ns };
	}
	if (delay_ns < line_at(model, x))
		fit(model);
}

/* Whether the device's clock leapt: too early is proof, too late only if it lasts. */
static bool leapt(struct gz_clock_model *model, double delay_ns, double expected_ns,
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

/* Later than the last answer comes before not later than the arrival. */
static int64_t answer(struct gz_clock_model *model, bool first, int64_t host_ns, int64_t arrival_ns)
{
	if (host_ns > arrival_ns)
		host_ns = arrival_ns;
	if (!first && host_ns <= model->host_ns)
		host_ns = model->host_ns + 1;
	model->host_ns = host_ns;
	return host_ns;
}

int64_t gz_clock_model_step(struct gz_clock_model *model, int64_t device_ns, int64_t arrival_ns,
			    bool *out_jumped)
{
	int64_t x = 0, elapsed = 0, delay = 0;
	bool follows = model->started && device_ns > model->device_ns &&
		       !__builtin_sub_overflow(device_ns, model->first_device_ns, &x) &&
		       !__builtin_sub_overflow(arrival_ns, model->first_arrival_ns, &elapsed) &&
		       !__builtin_sub_overflow(elapsed, x, &delay) &&
		       !leapt(model, (double)delay, line_at(model, (double)x), arrival_ns);
	bool first = !model->started;
	if (out_jumped)
		*out_jumped = !first && !follows;
	if (!follows) {
		begin_segment(model, device_ns, arrival_ns);
		return answer(model, first, arrival_ns, arrival_ns);
	}
	model->device_ns = device_ns;
	learn(model, (double)x, (double)delay);
	double after = (double)x + line_at(model, (double)x);
	return answer(model, first, model->first_arrival_ns + (int64_t)after, arrival_ns);
}

void gz_clock_model_restart(struct gz_clock_model *model)
{
	/* Nothing is newer than this. */
	model->device_ns = INT64_MAX;
}

struct gz_clock_status gz_clock_model_status(const struct gz_clock_model *model,
					     enum gz_clock_tick tick)
{
	/* By unsigned numbers: a device may say any time, and its difference may not fit. */
	uint64_t offset = (uint64_t)model->host_ns - (uint64_t)model->device_ns;
	return (struct gz_clock_status) {
		.offset_ns = model->started ? (int64_t)offset : 0,
		.skew_ppm = (0 - model->slope) / (1 + model->slope) * 1e6,
		.sigma_ns = model->sigma_ns,
		.tick = tick,
	};
}

int64_t gz_clock_unwrap32(int64_t last, uint32_t counter)
{
	int32_t step = (int32_t)(counter - (uint32_t)last);
	int64_t next = last + step;
	return next < 0 ? (int64_t)counter : next;
}
