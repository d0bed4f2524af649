#include "drivers/device/clock_ticks.h"

#include <math.h>

#include "base/clock.h"

/* A window whose points lie farther from their line says nothing about the tick, ns RMS. Chosen: a
 * busy host is late by some ms; a jump or a stall scatters more. */
static const double SCATTER_MAX_NS = 30e6;

/* Smaller steps never make a clock coarse, ns. Chosen: the fit smooths them out. */
static const double COARSE_STEP_NS = 2e6;

/* A clock that steps by g is wrong by up to g, evenly distributed: RMS g / sqrt(12). This is half
 * of that. */
static const double COARSE_SCATTER = 1.0 / 7;

/* If more than one sample in this many repeats the time of the one before, the clock is coarse.
 * Chosen. */
static const double REPEATS = 20;

/* Device times farther from their origin move the origin, ns: leaves room for sums. */
static const double FAR_NS = 4e18;

/* Longest window, ns, if too few samples come. */
static const int64_t WINDOW_MAX_NS = 20 * GZ_CLOCK_TICKS_WINDOW_NS;

void gz_clock_ticks_init(struct gz_clock_ticks *ticks, unsigned bits, double declared_ns)
{
	*ticks = (struct gz_clock_ticks) {
		.bits = bits,
		.declared_ns = declared_ns,
		.tick_ns = declared_ns,
		.tick = declared_ns > 0 ? GZ_CLOCK_DECLARED : GZ_CLOCK_NONE,
	};
}

static uint64_t counter_bits(const struct gz_clock_ticks *ticks, uint64_t counter)
{
	return ticks->bits < 64 ? counter & ((UINT64_C(1) << ticks->bits) - 1) : counter;
}

/* Ticks since the last sample, the shorter way round. */
static int64_t ticks_since_last(const struct gz_clock_ticks *ticks, uint64_t counter)
{
	uint64_t step = counter_bits(ticks, counter - (uint64_t)ticks->counter);
	if (ticks->bits < 64 && step >> (ticks->bits - 1))
		step |= UINT64_MAX << ticks->bits;
	return (int64_t)step;
}

/* Count device time from the present counter on. */
static void set_tick_origin(struct gz_clock_ticks *ticks)
{
	double ns = (double)ticks->counter * ticks->tick_ns;
	ticks->origin = ticks->counter;
	ticks->origin_ns = fabs(ns) < FAR_NS ? (int64_t)ns : 0;
}

static int64_t ticks_device_time(struct gz_clock_ticks *ticks)
{
	if (ticks->tick_ns <= 0)
		return GZ_NO_DEVICE_TIME;
	int64_t since = (int64_t)((uint64_t)ticks->counter - (uint64_t)ticks->origin);
	double ns = (double)since * ticks->tick_ns;
	if (fabs(ns) >= FAR_NS) {
		set_tick_origin(ticks);
		return ticks->origin_ns;
	}
	return ticks->origin_ns + (int64_t)llround(ns);
}

static uint64_t common_divisor(uint64_t a, uint64_t b)
{
	while (b != 0) {
		uint64_t rest = a % b;
		a = b;
		b = rest;
	}
	return a;
}

static void begin_tick_window(struct gz_clock_ticks *ticks, int64_t arrival_ns)
{
	ticks->window = (struct gz_clock_ticks_window) {
		.first_counter = ticks->counter,
		.first_arrival_ns = arrival_ns,
		.n = 1,
	};
}

static void add_to_tick_window(struct gz_clock_ticks *ticks, int64_t arrival_ns)
{
	struct gz_clock_ticks_window *window = &ticks->window;
	int64_t counted = (int64_t)((uint64_t)ticks->counter - (uint64_t)window->first_counter);
	double x = (double)counted;
	double y = (double)(arrival_ns - window->first_arrival_ns);
	window->repeats += counted == window->last_x;
	uint64_t step = (uint64_t)counted - (uint64_t)window->last_x;
	window->common = common_divisor(step, window->common);
	window->last_x = counted;
	window->n++;
	window->x += x;
	window->y += y;
	window->xx += x * x;
	window->xy += x * y;
	window->yy += y * y;
}

/* The line through the points of a window. */
struct line {
	bool usable;
	double tick_ns, scatter_ns;
};

static struct line fit_tick_line(const struct gz_clock_ticks_window *w)
{
	double var_x = w->xx - w->x * w->x / w->n;
	double cov = w->xy - w->x * w->y / w->n;
	double var_y = w->yy - w->y * w->y / w->n;
	if (!(var_x > 0) || !(cov > 0))
		return (struct line) { 0 };
	double slope = cov / var_x;
	double rest = fmax(0, var_y - slope * cov);
	return (struct line) { true, slope, sqrt(rest / w->n) };
}

/* A clock whose steps are longer than the sample period repeats times; one with slightly shorter
 * steps is wrong by up to a step. A device that counts its own samples does neither. */
static bool is_coarse_clock(const struct gz_clock_ticks_window *window, const struct line *line)
{
	double step_ns = (double)window->common * line->tick_ns;
	double samples = (double)window->last_x / (double)window->common + 1;
	if (window->repeats > window->n / REPEATS)
		return true;
	return step_ns >= COARSE_STEP_NS && line->scatter_ns >= step_ns * COARSE_SCATTER &&
	       fabs(samples - window->n) > GZ_CLOCK_TICKS_NEAR * window->n;
}

static bool is_near_tick(double a, double b)
{
	return fabs(a - b) <= GZ_CLOCK_TICKS_NEAR * b;
}

/* Most clocks count in powers of ten ns. If one is near, the rest of the slope is skew. */
static double rounded_tick(double tick_ns)
{
	double power = pow(10, round(log10(tick_ns)));
	return is_near_tick(tick_ns, power) ? power : tick_ns;
}

/* If the tick changes, device time starts again and host time continues. */
static void adopt_tick(struct gz_clock_ticks *ticks, double tick_ns, enum gz_clock_tick tick)
{
	ticks->settled = true;
	ticks->tick = tick;
	if (tick_ns == ticks->tick_ns)
		return;
	ticks->tick_ns = tick_ns;
	set_tick_origin(ticks);
	gz_clock_model_restart(&ticks->model);
}

static enum gz_clock_finding judge_coarse_clock(struct gz_clock_ticks *ticks, double tick_ns)
{
	bool sure = ticks->suspect_coarse;
	ticks->suspect_coarse = true;
	if (!sure)
		return GZ_CLOCK_FOUND_NOTHING;
	if (ticks->tick_ns <= 0 && tick_ns > 0)
		ticks->tick_ns = rounded_tick(tick_ns);
	set_tick_origin(ticks);
	ticks->settled = true;
	ticks->tick = GZ_CLOCK_NONE;
	return GZ_CLOCK_FOUND_COARSE;
}

/* Judge a complete window. Contradicting the declaration takes two windows that agree. */
static enum gz_clock_finding judge_tick_window(struct gz_clock_ticks *ticks)
{
	struct line line = fit_tick_line(&ticks->window);
	if (!line.usable)
		return judge_coarse_clock(ticks, 0);
	if (line.scatter_ns > SCATTER_MAX_NS)
		return GZ_CLOCK_FOUND_NOTHING;
	if (is_coarse_clock(&ticks->window, &line))
		return judge_coarse_clock(ticks, line.tick_ns);
	ticks->suspect_coarse = false;
	if (ticks->declared_ns > 0 && is_near_tick(line.tick_ns, ticks->declared_ns)) {
		adopt_tick(ticks, ticks->declared_ns, GZ_CLOCK_DECLARED);
		return GZ_CLOCK_FOUND_DECLARED;
	}
	if (ticks->suspect_ns > 0 && is_near_tick(line.tick_ns, ticks->suspect_ns)) {
		adopt_tick(ticks, rounded_tick(line.tick_ns), GZ_CLOCK_ESTIMATED);
		return GZ_CLOCK_FOUND_ESTIMATED;
	}
	ticks->suspect_ns = line.tick_ns;
	return GZ_CLOCK_FOUND_NOTHING;
}

static enum gz_clock_finding observe_tick(struct gz_clock_ticks *ticks, int64_t step,
					  int64_t arrival_ns)
{
	const struct gz_clock_ticks_window *window = &ticks->window;
	if (ticks->settled)
		return GZ_CLOCK_FOUND_NOTHING;
	if (step < 0 || window->n < 1) {
		begin_tick_window(ticks, arrival_ns);
		return GZ_CLOCK_FOUND_NOTHING;
	}
	add_to_tick_window(ticks, arrival_ns);
	int64_t length_ns = arrival_ns - window->first_arrival_ns;
	if (length_ns < GZ_CLOCK_TICKS_WINDOW_NS ||
	    (window->n < GZ_CLOCK_TICKS_SAMPLES && length_ns < WINDOW_MAX_NS))
		return GZ_CLOCK_FOUND_NOTHING;
	enum gz_clock_finding finding = window->n < GZ_CLOCK_TICKS_SAMPLES
						? GZ_CLOCK_FOUND_NOTHING
						: judge_tick_window(ticks);
	begin_tick_window(ticks, arrival_ns);
	return finding;
}

/* Host time without the device clock: as long before the arrival as the last one was. */
static int64_t host_time_by_arrival(const struct gz_clock_ticks *ticks, int64_t arrival_ns)
{
	int64_t host_ns = arrival_ns;
	if (ticks->tick != GZ_CLOCK_NONE)
		host_ns -= ticks->arrival_ns - ticks->host_ns;
	return host_ns;
}

struct gz_clock_stamp gz_clock_ticks_step(struct gz_clock_ticks *ticks, uint64_t counter,
					  int64_t arrival_ns)
{
	int64_t step = ticks->started ? ticks_since_last(ticks, counter) : 0;
	bool repeated = ticks->started && step == 0;
	bool first = !ticks->started;
	if (first || step < 0) {
		ticks->counter = (int64_t)counter_bits(ticks, counter);
		set_tick_origin(ticks);
	} else {
		ticks->counter = (int64_t)((uint64_t)ticks->counter + (uint64_t)step);
	}
	bool judged = ticks->settled;
	ticks->started = true;
	struct gz_clock_stamp stamp = { .finding = observe_tick(ticks, step, arrival_ns) };
	stamp.device_ns = ticks_device_time(ticks);
	if (ticks->tick == GZ_CLOCK_NONE || repeated) {
		stamp.host_ns = first ? arrival_ns : host_time_by_arrival(ticks, arrival_ns);
	} else {
		bool jumped;
		stamp.host_ns =
			gz_clock_model_step(&ticks->model, stamp.device_ns, arrival_ns, &jumped);
		if (jumped && judged)
			stamp.finding = GZ_CLOCK_FOUND_JUMP;
	}
	if (!first && stamp.host_ns <= ticks->host_ns)
		stamp.host_ns = ticks->host_ns + 1;
	ticks->model.host_ns = ticks->host_ns = stamp.host_ns;
	ticks->arrival_ns = arrival_ns;
	return stamp;
}

struct gz_clock_status gz_clock_ticks_status(const struct gz_clock_ticks *ticks)
{
	if (ticks->tick == GZ_CLOCK_NONE)
		return (struct gz_clock_status) { .tick = GZ_CLOCK_NONE };
	return gz_clock_model_status(&ticks->model, ticks->tick);
}
