#include "bench/report/study_charts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/report/charts.h"
#include "bench/report/names.h"
#include "bench/report/plot.h"

bool gz_group_measure(const struct gz_group *group, enum gz_error_measure *out_measure)
{
	const enum gz_error_reference reference = gz_group_reference(group);
	for (int measure = 0; measure < GZ_ERROR_MEASURES; measure++)
		for (size_t i = 0; i < group->series_count; i++)
			if (group->series[i].errors[reference][measure].count > 0) {
				*out_measure = (enum gz_error_measure)measure;
				return true;
			}
	return false;
}

void gz_pareto_chart_name(const struct gz_summary *summary, const struct gz_group *group,
			  enum gz_error_measure measure, char out_name[256])
{
	char kind[64];
	snprintf(kind, sizeof kind, "pareto-%s", gz_error_metrics[measure].key);
	gz_chart_name(summary, kind, group, out_name);
}

static void set_error_axis(struct gz_plot *plot, enum gz_error_measure measure,
			   enum gz_error_reference reference)
{
	const struct gz_error_metric *metric = &gz_error_metrics[measure];
	const char *best = metric->kind == GZ_ERROR_FLIP   ? "0 = same"
			   : metric->kind == GZ_ERROR_SSIM ? "1 = same"
							   : "dB";
	plot->y.from_zero = metric->kind == GZ_ERROR_FLIP;
	plot->y.falls = gz_error_rises(metric->kind);
	snprintf(plot->title, sizeof plot->title, "%s against %s (%s)", metric->title,
		 gz_error_reference_names[reference], best);
}

/* The position of an infinite value: a little beyond the best finite one. */
static double beyond_finite(const struct gz_group *group, enum gz_error_reference reference,
			    enum gz_error_measure measure)
{
	double least = INFINITY, best = -INFINITY;
	for (size_t i = 0; i < group->series_count; i++) {
		const double value = group->series[i].errors[reference][measure].mean;
		if (isfinite(value)) {
			least = fmin(least, value);
			best = fmax(best, value);
		}
	}
	return isfinite(best) ? best + 0.15 * (best - least) + 1 : 100;
}

static bool add_curve(const struct gz_study *study, const struct gz_group *group,
		      const struct gz_curve *curve, enum gz_error_reference reference,
		      enum gz_error_measure measure, struct gz_plot_curve *out)
{
	char text[GZ_NAMES_SIZE];
	const struct gz_method_look look = gz_method_look(curve->method);
	const double stand_in = beyond_finite(group, reference, measure);
	if (!gz_plot_curve_start(out, curve->count))
		return false;
	gz_curve_name(study, group, curve, text);
	snprintf(out->name, sizeof out->name, "%.*s", GZ_PLOT_LABEL_SIZE - 1, text);
	out->colour = look.colour;
	out->point_type = look.point;
	for (size_t i = 0; i < curve->count; i++) {
		const struct gz_series *series = &group->series[curve->series[i]];
		struct gz_plot_point *point = &out->points[i];
		point->x = series->typical_ms;
		point->y = series->errors[reference][measure].mean;
		point->marked = series->front[reference][measure];
		const bool infinite = isinf(point->y);
		if (infinite)
			point->y = stand_in;
		gz_variant_label(study, group, curve, curve->series[i], text);
		snprintf(point->label, sizeof point->label, "%.80s%s%s", text,
			 infinite && text[0] ? ", " : "", infinite ? "∞ dB" : "");
	}
	return true;
}

static enum gz_result draw_pareto(const struct gz_summary *summary, const struct gz_group *group,
				  enum gz_error_measure measure, struct gz_charts *charts)
{
	char name[GZ_NAMES_SIZE];
	const enum gz_error_reference reference = gz_group_reference(group);
	struct gz_plot plot = { .x = { .title = "time of a frame, ms", .logarithmic = true },
				.join_marked = true,
				.bound = group->bound_ms > 0 ? group->bound_ms : 0 };
	set_error_axis(&plot, measure, reference);
	snprintf(plot.bound_text, sizeof plot.bound_text, "acuity bound: %.3g %% of the rays",
		 group->bound_share * 100);
	bool sound = gz_plot_start(&plot, group->curve_count);
	for (size_t i = 0; i < group->curve_count && sound; i++)
		sound = add_curve(summary->study, group, &group->curves[i], reference, measure,
				  &plot.curves[i]);
	gz_pareto_chart_name(summary, group, measure, name);
	const enum gz_result result = sound ? gz_plot_draw(charts, name, &plot) : GZ_ERR_NO_MEM;
	gz_plot_free(&plot);
	return result;
}

/* ---- entered JOD ---- */

void gz_jod_chart_name(const struct gz_summary *summary, const struct gz_group *group,
		       char out_name[256])
{
	gz_chart_name(summary, "pareto-jod", group, out_name);
}

void gz_jod_source(const struct gz_summary *summary, const struct gz_group *group,
		   char out_text[256])
{
	const struct gz_jod_value *first = NULL;
	bool others = false;
	for (size_t i = 0; i < group->series_count; i++) {
		const struct gz_jod_value *value = gz_summary_jod(summary, group, i);
		others = others || (first && value && strcmp(first->how, value->how) != 0);
		first = first ? first : value;
	}
	snprintf(out_text, 256, "%.230s%s", first ? first->how : "", others ? " and others" : "");
}

/* Whether no other series with a value is as fast and as good, and better in one. */
static bool on_jod_front(const struct gz_summary *summary, const struct gz_group *group,
			 size_t series)
{
	const double ms = group->series[series].typical_ms;
	const double jod = gz_summary_jod(summary, group, series)->jod;
	for (size_t i = 0; i < group->series_count; i++) {
		const struct gz_jod_value *other = gz_summary_jod(summary, group, i);
		const double other_ms = group->series[i].typical_ms;
		if (other && other_ms <= ms && other->jod >= jod &&
		    (other_ms < ms || other->jod > jod))
			return false;
	}
	return true;
}

static bool add_jod_curve(const struct gz_summary *summary, const struct gz_group *group,
			  const struct gz_curve *curve, struct gz_plot_curve *out)
{
	char text[GZ_NAMES_SIZE];
	const struct gz_method_look look = gz_method_look(curve->method);
	if (!gz_plot_curve_start(out, curve->count))
		return false;
	gz_curve_name(summary->study, group, curve, text);
	snprintf(out->name, sizeof out->name, "%.*s", GZ_PLOT_LABEL_SIZE - 1, text);
	out->colour = look.colour;
	out->point_type = look.point;
	for (size_t i = 0; i < curve->count; i++) {
		const struct gz_jod_value *value = gz_summary_jod(summary, group, curve->series[i]);
		struct gz_plot_point *point = &out->points[i];
		point->x = group->series[curve->series[i]].typical_ms;
		point->y = value ? value->jod : NAN;
		point->marked = value && on_jod_front(summary, group, curve->series[i]);
		gz_variant_label(summary->study, group, curve, curve->series[i], text);
		snprintf(point->label, sizeof point->label, "%.*s", GZ_PLOT_LABEL_SIZE - 1, text);
	}
	return true;
}

static enum gz_result draw_jod(const struct gz_summary *summary, const struct gz_group *group,
			       struct gz_charts *charts)
{
	char name[GZ_NAMES_SIZE], source[GZ_NAMES_SIZE];
	struct gz_plot plot = { .x = { .title = "time of a frame, ms", .logarithmic = true },
				.y = { .falls = true },
				.join_marked = true };
	gz_jod_source(summary, group, source);
	if (!source[0])
		return GZ_OK;
	snprintf(plot.title, sizeof plot.title, "JOD (10 = same), entered from: %.150s", source);
	bool sound = gz_plot_start(&plot, group->curve_count);
	for (size_t i = 0; i < group->curve_count && sound; i++)
		sound = add_jod_curve(summary, group, &group->curves[i], &plot.curves[i]);
	gz_jod_chart_name(summary, group, name);
	const enum gz_result result = sound ? gz_plot_draw(charts, name, &plot) : GZ_ERR_NO_MEM;
	gz_plot_free(&plot);
	return result;
}

/* ---- growth ---- */

/* Whether two fits are shown in one chart: they differ in the variant only. */
static bool share_chart(const struct gz_scaling *a, const struct gz_scaling *b)
{
	return a->kind == b->kind && a->scene == b->scene && a->size == b->size &&
	       a->backend == b->backend;
}

static bool is_first_in_chart(const struct gz_summary *summary, size_t place)
{
	for (size_t i = 0; i < place; i++)
		if (share_chart(&summary->scalings[i], &summary->scalings[place]))
			return false;
	return true;
}

bool gz_growth_chart_name(const struct gz_summary *summary, size_t scaling, char out_name[256])
{
	static const char *const kinds[] = { "pixels", "voxels", "threads" };
	const enum gz_scaling_kind kind = summary->scalings[scaling].kind;
	size_t number = 1;
	if (!is_first_in_chart(summary, scaling))
		return false;
	for (size_t i = 0; i < scaling; i++)
		number += summary->scalings[i].kind == kind && is_first_in_chart(summary, i);
	snprintf(out_name, 256, "growth-%s-%zu", kinds[kind], number);
	return true;
}

static bool add_growth_curve(const struct gz_study *study, const struct gz_scaling *scaling,
			     struct gz_plot_curve *out)
{
	char words[GZ_NAMES_SIZE];
	const struct gz_study_variant *variant = &study->variants[scaling->variant];
	const struct gz_method_look look = gz_method_look(variant->method);
	if (!gz_plot_curve_start(out, scaling->point_count))
		return false;
	const double unit = scaling->kind == GZ_SCALING_THREADS ? 1 : 1e6;
	gz_variant_words(variant, words);
	snprintf(out->name, sizeof out->name, "%.2f  %.80s", scaling->exponent, words);
	out->colour = look.colour;
	out->point_type = look.point;
	for (size_t i = 0; i < scaling->point_count; i++) {
		out->points[i].x = scaling->points[i].x / unit;
		out->points[i].y = scaling->points[i].ms;
	}
	return true;
}

static size_t shared_count(const struct gz_summary *summary, size_t first)
{
	size_t count = 0;
	for (size_t i = first; i < summary->scaling_count; i++)
		count += share_chart(&summary->scalings[first], &summary->scalings[i]);
	return count;
}

static enum gz_result draw_growth(const struct gz_summary *summary, size_t first,
				  struct gz_charts *charts)
{
	static const char *const titles[] = { "million pixels of the picture",
					      "million voxels of the volume", "threads" };
	char name[GZ_NAMES_SIZE], words[GZ_NAMES_SIZE];
	struct gz_plot plot = { .x = { .logarithmic = true, .name_room = 0.4 },
				.y = { .logarithmic = true } };
	if (!gz_growth_chart_name(summary, first, name))
		return GZ_OK;
	snprintf(plot.x.title, sizeof plot.x.title, "%s", titles[summary->scalings[first].kind]);
	gz_growth_words(summary->study, &summary->scalings[first], words);
	snprintf(plot.title, sizeof plot.title, "%.120s: ms a frame", words);
	bool sound = gz_plot_start(&plot, shared_count(summary, first));
	for (size_t i = first, k = 0; i < summary->scaling_count && sound; i++)
		if (share_chart(&summary->scalings[first], &summary->scalings[i]))
			sound = add_growth_curve(summary->study, &summary->scalings[i],
						 &plot.curves[k++]);
	const enum gz_result result = sound ? gz_plot_draw(charts, name, &plot) : GZ_ERR_NO_MEM;
	gz_plot_free(&plot);
	return result;
}

/* ---- boxes of frame times ---- */

/* A row's height, px: on a narrow canvas a name and, below it, a box. */
static int row_px(const struct gz_canvas *canvas)
{
	return canvas->kind == GZ_CANVAS_NARROW ? 42 : 30;
}

static void add_box_row(const struct gz_study *study, const struct gz_series *series, size_t row,
			int characters, struct gz_text *table)
{
	char words[GZ_NAMES_SIZE], cut[GZ_NAMES_SIZE];
	const struct gz_study_variant *variant = &study->variants[series->variant];
	const struct gz_distribution *ms = &series->columns[GZ_COLUMN_FRAME];
	gz_variant_words(variant, words);
	snprintf(cut, sizeof cut, "%.*s%s", characters, words,
		 strlen(words) > (size_t)characters ? "…" : "");
	gz_text_add(table, "%zu\t", row);
	gz_chart_add_cell(table, cut);
	gz_text_add(table, "\t%.9g\t%.9g\t%.9g\t%.9g\t%.9g\t%u\n", ms->least, ms->p25, ms->median,
		    ms->p75, ms->p99, (unsigned)gz_method_look(variant->method).colour);
}

/* Length of the longest name, at most the room on the canvas. */
static int characters_for(const struct gz_study *study, const struct gz_group *group,
			  enum gz_canvas_kind kind)
{
	const int most = kind == GZ_CANVAS_NARROW ? 48 : 40;
	int longest = 8;
	for (size_t i = 0; i < group->series_count; i++) {
		char words[GZ_NAMES_SIZE];
		gz_variant_words(&study->variants[group->series[i].variant], words);
		longest = (int)fmax(longest, (double)strlen(words));
	}
	return longest < most ? longest : most;
}

static enum gz_result draw_boxes_on(const struct gz_summary *summary, const struct gz_group *group,
				    enum gz_canvas_kind kind, struct gz_charts *charts)
{
	char name[GZ_NAMES_SIZE];
	struct gz_canvas canvas = gz_canvas_of(kind);
	struct gz_text settings = { 0 }, table = { 0 };
	const int characters = characters_for(summary->study, group, kind);
	double least = INFINITY, greatest = 0;
	size_t rows = 0;
	for (size_t i = 0; i < group->curve_count; i++)
		for (size_t k = 0; k < group->curves[i].count; k++) {
			const struct gz_series *series = &group->series[group->curves[i].series[k]];
			least = fmin(least, series->columns[GZ_COLUMN_FRAME].least);
			greatest = fmax(greatest, series->columns[GZ_COLUMN_FRAME].p99);
			add_box_row(summary->study, series, rows++, characters, &table);
		}
	const bool names_above = kind == GZ_CANVAS_NARROW;
	canvas.left = names_above ? 14 : (int)((characters + 2) * canvas.font_px * 0.58);
	canvas.height = canvas.top + canvas.bottom + (int)rows * row_px(&canvas);
	gz_chart_set_text(&settings, "title_text", "time of a frame, ms, logarithmic");
	gz_chart_set_text(&settings, "x_title", "box: half of all frames; line: 99 of 100");
	const double first = fmax(least, 1e-4) / 1.15, last = fmax(greatest, 2e-4) * 1.15;
	gz_text_add(&settings,
		    "x_first = %.9g\nx_last = %.9g\nx_decades = %.9g\nrows = %zu\n"
		    "names_above = %d\n",
		    first, last, log10(last / first) * (names_above ? 2 : 1), rows, names_above);
	gz_chart_name(summary, "boxes", group, name);
	const enum gz_result result =
		gz_charts_draw(charts, "boxes.gp", name, &canvas, &settings, &table);
	gz_text_free(&settings);
	gz_text_free(&table);
	return result;
}

static enum gz_result draw_boxes(const struct gz_summary *summary, const struct gz_group *group,
				 struct gz_charts *charts)
{
	enum gz_result result = GZ_OK;
	for (int kind = 0; kind < GZ_CANVAS_KINDS && result == GZ_OK; kind++)
		result = draw_boxes_on(summary, group, kind, charts);
	return result;
}

static enum gz_result draw_group(const struct gz_summary *summary, const struct gz_group *group,
				 struct gz_charts *charts)
{
	enum gz_result result = GZ_OK;
	for (int measure = 0; measure < GZ_ERROR_MEASURES && result == GZ_OK; measure++)
		result = draw_pareto(summary, group, measure, charts);
	if (result == GZ_OK)
		result = draw_jod(summary, group, charts);
	if (result == GZ_OK)
		result = draw_boxes(summary, group, charts);
	if (result == GZ_OK)
		result = gz_maps_draw(summary, group, charts);
	return result;
}

enum gz_result gz_study_charts_draw(const struct gz_summary *summary, struct gz_charts *charts)
{
	enum gz_result result = GZ_OK;
	if (!charts->available)
		return GZ_OK;
	for (size_t i = 0; i < summary->group_count && result == GZ_OK; i++)
		result = draw_group(summary, &summary->groups[i], charts);
	for (size_t i = 0; i < summary->scaling_count && result == GZ_OK; i++)
		result = draw_growth(summary, i, charts);
	return result;
}
