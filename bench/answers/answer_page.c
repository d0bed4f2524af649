#include "bench/answers/answer_page.h"

#include <math.h>

#include "base/text.h"
#include "bench/report/template.h"

#define GZ_LOG_MODULE "answers"

/* The chart, px, and how far its axis of values goes beyond the values. */
enum { WIDTH = 640, HEIGHT = 360, LEFT = 56, RIGHT = 32, TOP = 16, BOTTOM = 48, STEPS = 120 };

/* Shares drawn side by side at most (chosen: about six trials each in a usual staircase). */
enum { POOLS = 12 };
#define BEYOND 0.1 /* decades */

/* style.css, embedded. */
extern const char gz_style_css[];

/* An end of an interval, or that there is none. */
static const char *print_end(double value, char text[32])
{
	if (isnan(value))
		return "not bounded";
	snprintf(text, 32, "%.3g", value);
	return text;
}

static bool fit_group(const struct gz_answer_group *group,
		      const struct gz_psychometric_params *params, struct gz_psychometric *fit)
{
	return group->key[0] &&
	       gz_psychometric_fit(group->counts, group->count_count, params, fit) == GZ_OK;
}

/* The threshold as a sentence; false: there is none. */
static bool print_fit(const struct gz_answer_group *group,
		      const struct gz_psychometric_params *params, char *text, size_t size)
{
	struct gz_psychometric fit;
	char low[32], high[32];
	if (!fit_group(group, params, &fit))
		return false;
	snprintf(text, size, "%s: %.0f %% right at %.3g (95 %%: %s to %s), slope %.2g", group->key,
		 100 * params->target, fit.threshold, print_end(fit.interval.low, low),
		 print_end(fit.interval.high, high), fit.beta);
	return true;
}

static void print_left_out(const struct gz_answer_table *table, char *text, size_t size)
{
	snprintf(text, size,
		 "%d practice trials, %d without an answer in time and %d without a correct answer "
		 "do not count.",
		 table->practice, table->late, table->unjudged);
}

void gz_answer_table_print(struct gz_answer_table *table,
			   const struct gz_psychometric_params *params, FILE *out)
{
	char text[512];
	fprintf(out, "%-32s %7s %6s  %-22s %s\n", "trial", "trials", "right", "share (95 %)",
		"median response, s");
	for (size_t i = 0; i < table->group_count; i++) {
		struct gz_answer_group *group = &table->groups[i];
		const struct gz_interval share = gz_share_interval(group->right, group->trials);
		fprintf(out, "%-32s %7d %6d  %.3f (%.3f to %.3f)  %.3f\n", group->name,
			group->trials, group->right, (double)group->right / group->trials,
			share.low, share.high, gz_answer_group_median_s(group));
		if (print_fit(group, params, text, sizeof text))
			fprintf(out, "    %s\n", text);
	}
	print_left_out(table, text, sizeof text);
	fprintf(out, "%s\n", text);
}

/* The area of a chart: logarithms of values, and shares from 0 to 1. */
struct chart {
	struct gz_text *page;
	double first, last; /* log10 */
};

static double place_x(const struct chart *chart, double value)
{
	const double share = (log10(value) - chart->first) / (chart->last - chart->first);
	return LEFT + share * (WIDTH - LEFT - RIGHT);
}

static double place_y(double share)
{
	return HEIGHT - BOTTOM - share * (HEIGHT - TOP - BOTTOM);
}

static void draw_axes(const struct chart *chart, const struct gz_answer_group *group)
{
	for (int i = 0; i <= 4; i++)
		gz_text_add(
			chart->page,
			"<path d=\"M%d %.1fH%d\" stroke-opacity=\"0.2\"/><text x=\"%d\" y=\"%.1f\" "
			"text-anchor=\"end\">%.2f</text>\n",
			LEFT, place_y(i / 4.0), WIDTH - RIGHT, LEFT - 6, place_y(i / 4.0) + 4,
			i / 4.0);
	for (int i = 0; i <= 4; i++) {
		const double value = pow(10, chart->first + (chart->last - chart->first) * i / 4);
		gz_text_add(chart->page,
			    "<path d=\"M%.1f %.1fv5\"/><text x=\"%.1f\" y=\"%.1f\" "
			    "text-anchor=\"middle\">%.3g</text>\n",
			    place_x(chart, value), place_y(0), place_x(chart, value),
			    place_y(0) + 19, value);
	}
	gz_text_add(chart->page, "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">", WIDTH / 2,
		    HEIGHT - 8);
	gz_text_add_escaped(chart->page, group->key);
	gz_text_add(chart->page, ", logarithmic</text>\n");
}

/* The values from @p first on that are drawn as one, at their mean logarithm: a staircase shows few
 * twice. @return where the next ones begin */
static size_t pool_values(const struct chart *chart, const struct gz_answer_group *group,
			  size_t first, struct gz_value_count *out_pool)
{
	const double width = (chart->last - chart->first) / POOLS;
	const double limit = group->counts[first].value * pow(10, width);
	double sum = 0;
	size_t next = first;
	*out_pool = (struct gz_value_count) { .value = 0 };
	for (; next < group->count_count && group->counts[next].value < limit; next++) {
		const struct gz_value_count *count = &group->counts[next];
		out_pool->trials += count->trials;
		out_pool->right += count->right;
		sum += count->trials * log10(count->value);
	}
	out_pool->value = pow(10, sum / out_pool->trials);
	return next;
}

/* Shares of right answers with their intervals and, by area, how many trials there were. */
static void draw_shares(const struct chart *chart, const struct gz_answer_group *group)
{
	struct gz_value_count pool;
	for (size_t i = 0; i < group->count_count;) {
		i = pool_values(chart, group, i, &pool);
		const struct gz_interval share = gz_share_interval(pool.right, pool.trials);
		const double x = place_x(chart, pool.value);
		gz_text_add(
			chart->page,
			"<path d=\"M%.1f %.1fV%.1f\" stroke-opacity=\"0.35\"/><circle cx=\"%.1f\" "
			"cy=\"%.1f\" r=\"%.1f\" fill=\"currentColor\"/>\n",
			x, place_y(share.low), place_y(share.high), x,
			place_y((double)pool.right / pool.trials),
			fmin(8, 1.5 * sqrt(pool.trials)) + 0.5);
	}
}

static void draw_function(const struct chart *chart, const struct gz_psychometric *fit,
			  const struct gz_psychometric_params *params)
{
	gz_text_add(chart->page, "<path stroke=\"#0072b2\" stroke-width=\"2\" d=\"");
	for (int i = 0; i <= STEPS; i++) {
		const double value =
			pow(10, chart->first + (chart->last - chart->first) * i / STEPS);
		gz_text_add(chart->page, "%c%.1f %.1f", i ? 'L' : 'M', place_x(chart, value),
			    place_y(gz_psychometric_share(fit, params, value)));
	}
	const double first = pow(10, chart->first), last = pow(10, chart->last);
	const double low = isnan(fit->interval.low) ? first : fmax(first, fit->interval.low);
	const double high = isnan(fit->interval.high) ? last : fmin(last, fit->interval.high);
	gz_text_add(chart->page,
		    "\"/>\n<path stroke=\"#d55e00\" stroke-width=\"3\" d=\"M%.1f %.1fH%.1f\"/>\n",
		    place_x(chart, low), place_y(params->target), place_x(chart, high));
	if (fit->threshold >= first && fit->threshold <= last)
		gz_text_add(chart->page,
			    "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"5\" fill=\"#d55e00\" "
			    "stroke=\"none\"/>\n",
			    place_x(chart, fit->threshold), place_y(params->target));
}

static void add_figure(struct gz_text *page, const struct gz_answer_group *group,
		       const struct gz_psychometric_params *params)
{
	struct gz_psychometric fit;
	char text[512];
	if (!fit_group(group, params, &fit) || !print_fit(group, params, text, sizeof text))
		return;
	const struct chart chart = {
		.page = page,
		.first = log10(group->counts[0].value) - BEYOND,
		.last = log10(group->counts[group->count_count - 1].value) + BEYOND,
	};
	gz_text_add(page, "<h2>");
	gz_text_add_escaped(page, group->name);
	gz_text_add(page,
		    "</h2>\n<figure><svg viewBox=\"0 0 %d %d\" role=\"img\" width=\"%d\" "
		    "style=\"max-width:100%%;height:auto\" font-size=\"13\" fill=\"none\" "
		    "stroke=\"currentColor\">\n<title>Share of right answers</title>\n"
		    "<style>text{fill:currentColor;stroke:none}</style>\n",
		    WIDTH, HEIGHT, WIDTH);
	draw_axes(&chart, group);
	draw_shares(&chart, group);
	draw_function(&chart, &fit, params);
	gz_text_add(page, "</svg><figcaption>Share of right answers. ");
	gz_text_add_escaped(page, text);
	gz_text_add(page, ".</figcaption></figure>\n");
}

static void add_rows(struct gz_text *page, struct gz_answer_table *table)
{
	for (size_t i = 0; i < table->group_count; i++) {
		struct gz_answer_group *group = &table->groups[i];
		const struct gz_interval share = gz_share_interval(group->right, group->trials);
		gz_text_add(page, "<tr><th scope=\"row\">");
		gz_text_add_escaped(page, group->name);
		gz_text_add(page,
			    "</th><td>%d</td><td>%d</td><td>%.3f <small>%.3f to %.3f</small></td>"
			    "<td>%.3f</td></tr>\n",
			    group->trials, group->right, (double)group->right / group->trials,
			    share.low, share.high, gz_answer_group_median_s(group));
	}
}

enum gz_result gz_answer_page_write(struct gz_answer_table *table,
				    const struct gz_psychometric_params *params, const char *path,
				    const struct gz_log *log)
{
	struct gz_text page = { 0 };
	char text[512];
	gz_text_add(&page, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
			   "<meta name=\"viewport\" content=\"width=device-width, "
			   "initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light "
			   "dark\">\n<link rel=\"icon\" href=\"data:,\">\n<title>Answers</title>\n"
			   "<style>\n");
	gz_text_add(&page, "%s", gz_style_css);
	gz_text_add(&page, "</style>\n</head>\n<body>\n<header><h1>Answers</h1>\n<p>");
	print_left_out(table, text, sizeof text);
	gz_text_add_escaped(&page, text);
	gz_text_add(&page, "</p></header>\n<main>\n<div class=\"scroll\"><table>\n"
			   "<caption>Shares of right answers, with 95 %% intervals "
			   "(Wilson)</caption>\n<thead><tr><th scope=\"col\">trial</th>"
			   "<th scope=\"col\">trials</th><th scope=\"col\">right</th>"
			   "<th scope=\"col\">share</th><th scope=\"col\">median response, s</th>"
			   "</tr></thead>\n<tbody>\n");
	add_rows(&page, table);
	gz_text_add(&page, "</tbody></table></div>\n");
	for (size_t i = 0; i < table->group_count; i++)
		add_figure(&page, &table->groups[i], params);
	gz_text_add(&page, "<p>Neighbouring values are drawn as one disc, whose area tells how "
			   "many trials it has; the line through "
			   "it is its 95 %% interval. The curve is a Weibull function fitted by "
			   "maximum likelihood; the bar is the threshold's 95 %% interval by the "
			   "profile likelihood.</p>\n</main>\n</body>\n</html>\n");
	const enum gz_result result = gz_text_write(&page, path, log);
	gz_text_free(&page);
	return result;
}
