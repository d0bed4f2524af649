#include "bench/report/filter_chart.h"

#include <math.h>
#include <stdio.h>

#include "bench/report/charts.h"
#include "bench/report/plot.h"

#define GZ_LOG_MODULE "report"

/* Curves, in the order in which they are drawn. */
enum { RAW, ONE_EURO, BEST, PIPELINE, CURVES };

/* Which of the 1 euro filter's points have their setting beside them. */
enum { LABEL_EACH = 6 };

/* A filter that adds noise is of no use, and neither is more of its curve. */
static const double MOST_JITTER = 1.2;

static double most_lag_ms(const struct gz_sweep *pipeline, double interval_ms)
{
	double most_ms = fmax(40, 10 * interval_ms);
	for (size_t i = 0; i < pipeline->count; i++)
		most_ms = fmax(most_ms, pipeline->point[i].stillness.lag_ms * 1.25);
	return most_ms;
}

static void name_curve(struct gz_plot_curve *curve, const char *name, const char *look_of)
{
	const struct gz_method_look look = gz_method_look(look_of);
	snprintf(curve->name, sizeof curve->name, "%s", name);
	curve->colour = look.colour;
	curve->point_type = look.point;
}

static bool add_raw(struct gz_plot_curve *curve)
{
	name_curve(curve, "raw signal", "standard");
	if (!gz_plot_curve_start(curve, 1))
		return false;
	curve->points[0] = (struct gz_plot_point) { .x = 0, .y = 1 };
	return true;
}

static bool shown(const struct gz_stillness *still, double most_ms)
{
	return still->lag_ms <= most_ms && still->jitter <= MOST_JITTER;
}

/* The place where the line to a hidden point leaves the picture. */
static void cut(const struct gz_plot_point *from, double most_ms, struct gz_plot_point *to)
{
	double part = 1;
	if (to->x > most_ms)
		part = fmin(part, (most_ms - from->x) / (to->x - from->x));
	if (to->y > MOST_JITTER)
		part = fmin(part, (MOST_JITTER - from->y) / (to->y - from->y));
	to->x = from->x + part * (to->x - from->x);
	to->y = from->y + part * (to->y - from->y);
}

static void print_one_euro(const struct gz_one_euro_params *params, struct gz_plot_point *point)
{
	snprintf(point->label, sizeof point->label, "%.3g, %.3g Hz, %.2g", params->min_cutoff_hz,
		 params->derivative_cutoff_hz, params->beta);
}

/* From the least lag to the cut. */
static bool add_one_euro(const struct gz_sweep *sweep, double most_ms, struct gz_plot_curve *curve)
{
	name_curve(curve, "1 € filter", "acuity");
	if (!gz_plot_curve_start(curve, sweep->count))
		return false;
	curve->point_count = 0;
	for (size_t i = sweep->count; i-- > 0;) {
		const struct gz_stillness *here = &sweep->point[i].stillness;
		struct gz_plot_point *point = &curve->points[curve->point_count];
		*point = (struct gz_plot_point) { .x = here->lag_ms, .y = here->jitter };
		const bool inside = shown(here, most_ms);
		if (!inside && curve->point_count == 0)
			continue;
		curve->point_count++;
		if (!inside) {
			cut(point - 1, most_ms, point);
			break;
		}
		if (i % LABEL_EACH == 0)
			print_one_euro(&sweep->point[i].one_euro, point);
	}
	return true;
}

static bool add_pipeline(const struct gz_sweep *sweep, struct gz_plot_curve *curve)
{
	name_curve(curve, "pipeline", "ddc");
	if (!gz_plot_curve_start(curve, sweep->count))
		return false;
	for (size_t i = 0; i < sweep->count; i++) {
		const struct gz_sweep_point *from = &sweep->point[i];
		struct gz_plot_point *point = &curve->points[i];
		point->x = from->stillness.lag_ms;
		point->y = from->stillness.jitter;
		point->marked = from->as_given;
		if (from->as_given)
			snprintf(point->label, sizeof point->label, "as set");
	}
	return true;
}

static double last_x(const struct gz_plot_curve *curve)
{
	double last = 0;
	for (size_t i = 0; i < curve->point_count; i++)
		last = fmax(last, curve->points[i].x);
	return last;
}

/* From the pipeline's least jitter to the right: the jitter that more lag would have to beat. */
static bool add_best(struct gz_plot *plot)
{
	const struct gz_plot_curve *pipeline = &plot->curves[PIPELINE];
	struct gz_plot_curve *curve = &plot->curves[BEST];
	name_curve(curve, "the pipeline's least", "");
	curve->point_type = 0;
	if (!gz_plot_curve_start(curve, 2))
		return false;
	struct gz_plot_point *ends = curve->points;
	ends[0] = (struct gz_plot_point) { .x = pipeline->points[0].x, .y = pipeline->points[0].y };
	for (size_t i = 1; i < pipeline->point_count; i++)
		if (pipeline->points[i].y < ends[0].y) {
			ends[0].x = pipeline->points[i].x;
			ends[0].y = pipeline->points[i].y;
		}
	ends[1] = ends[0];
	ends[1].x = fmax(last_x(&plot->curves[ONE_EURO]), last_x(pipeline));
	return true;
}

static bool fill_curve(const struct gz_sweep *pipeline, const struct gz_sweep *one_euro,
		       double interval_ms, struct gz_plot *plot)
{
	const double most_ms = most_lag_ms(pipeline, interval_ms);
	*plot = (struct gz_plot) {
		.title = "jitter in fixations, of the raw signal's, over lag in saccades",
		.x.from_zero = true,
		.y.from_zero = true,
	};
	snprintf(plot->x.title, sizeof plot->x.title, "lag, ms (a sample is %.3g ms)", interval_ms);
	return gz_plot_start(plot, CURVES) && add_raw(&plot->curves[RAW]) &&
	       add_one_euro(one_euro, most_ms, &plot->curves[ONE_EURO]) &&
	       add_pipeline(pipeline, &plot->curves[PIPELINE]) && add_best(plot);
}

enum gz_result gz_filter_chart_draw(const struct gz_sweep *pipeline,
				    const struct gz_sweep *one_euro, double interval_ms,
				    const char *folder, const struct gz_log *log, bool *out_drawn)
{
	struct gz_charts charts = { 0 };
	struct gz_plot plot = { .curve_count = 0 };
	enum gz_result result = gz_charts_open(folder, log, &charts);
	if (result != GZ_OK)
		return result;
	const bool drawn = charts.available;
	result = fill_curve(pipeline, one_euro, interval_ms, &plot) ? GZ_OK : GZ_ERR_NO_MEM;
	if (result == GZ_OK)
		result = gz_plot_draw(&charts, "jitter-over-lag", &plot);
	else
		gz_err(log, "%s: no chart: %s", folder, gz_result_text(result));
	gz_plot_free(&plot);
	gz_charts_close(&charts);
	if (result == GZ_OK)
		*out_drawn = drawn;
	return result;
}
