#include "bench/report/comparison_charts.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/report/comparison_report.h"
#include "bench/report/plot.h"
#include "bench/report/published_times.h"
#include "render/plan/method.h"
#include "render/scene/techniques.h"

#define GZ_LOG_MODULE "report"

/* Height of a row of times, px. */
enum { TIMES_ROW_PX = 24, TIMES_NARROW_ROW_PX = 42, TIMES_NAME_CHARACTERS = 42 };

void gz_comparison_chart_name(const struct gz_comparison *comparison, const char *kind,
			      size_t scene, char out_name[GZ_NAMES_SIZE])
{
	if (comparison->scene_count == 1)
		snprintf(out_name, GZ_NAMES_SIZE, "%s", kind);
	else
		snprintf(out_name, GZ_NAMES_SIZE, "%s-%.100s", kind,
			 comparison->scenes[scene].name);
	for (char *c = out_name; *c; c++)
		if (!isalnum((unsigned char)*c) && !strchr("._-", *c))
			*c = '-';
}

/* Techniques have the colours of methods, by their places: those of methods but the first. */
static uint32_t colour_of(const struct gz_technique *technique)
{
	size_t place = 0;
	while (gz_techniques[place] && gz_techniques[place] != technique)
		place++;
	return gz_method_look(gz_method_names[1 + place % (GZ_METHOD_COUNT - 1)]).colour;
}

static const char *method_of_row(const struct gz_comparison *comparison,
				 const struct gz_comparison_row *row, char out_name[GZ_NAME_SIZE])
{
	const char *text = comparison->methods[row->method];
	snprintf(out_name, GZ_NAME_SIZE, "%.*s", (int)strcspn(text, ":"), text);
	return out_name;
}

/* ---- error over time ---- */

/* Rows of one curve: they differ in slices alone, or in the method if there are none. */
static bool same_curve(const struct gz_comparison_row *a, const struct gz_comparison_row *b)
{
	return a->scene == b->scene && a->technique == b->technique && a->effect == b->effect &&
	       (a->slices == 0 || a->method == b->method) && strcmp(a->backend, b->backend) == 0;
}

/* Without an effect, every technique has a reference. */
static bool is_charted(const struct gz_comparison_row *row, size_t scene)
{
	return row->scene == scene && row->effect == &gz_effects[0] &&
	       row->reference != GZ_REFERENCE_NONE;
}

static struct gz_plot_curve *find_curve(const struct gz_comparison *comparison, size_t index,
					struct gz_plot *plot, const size_t *first_rows)
{
	for (size_t i = 0; i < plot->curve_count; i++)
		if (same_curve(&comparison->rows[first_rows[i]], &comparison->rows[index]))
			return &plot->curves[i];
	return NULL;
}

static bool begin_curve(const struct gz_comparison *comparison, size_t index,
			struct gz_plot_curve *curve)
{
	const struct gz_comparison_row *row = &comparison->rows[index];
	char method[GZ_NAME_SIZE];
	snprintf(curve->name, sizeof curve->name, "%s %s%s%.40s", row->technique->name,
		 row->backend, row->slices > 0 ? ", " : "",
		 row->slices > 0 ? comparison->methods[row->method] : "");
	curve->colour = colour_of(row->technique);
	curve->point_type = gz_method_look(method_of_row(comparison, row, method)).point;
	if (!gz_plot_curve_start(curve, comparison->row_count))
		return false;
	curve->point_count = 0;
	return true;
}

static void add_curve_point(const struct gz_comparison *comparison, size_t index,
			    struct gz_plot_curve *curve)
{
	const struct gz_comparison_row *row = &comparison->rows[index];
	struct gz_plot_point *point = &curve->points[curve->point_count++];
	point->x = gz_comparison_sum(comparison, row).frame_ms.mean;
	point->y = row->converged.flip;
	if (row->slices > 0)
		snprintf(point->label, sizeof point->label, "%d", row->slices);
	else
		snprintf(point->label, sizeof point->label, "%.40s",
			 comparison->methods[row->method]);
}

static enum gz_result fill_plot(const struct gz_comparison *comparison, size_t scene,
				size_t *first_rows, struct gz_plot *plot)
{
	if (!gz_plot_start(plot, comparison->row_count))
		return GZ_ERR_NO_MEM;
	plot->curve_count = 0;
	for (size_t i = 0; i < comparison->row_count; i++) {
		if (!is_charted(&comparison->rows[i], scene))
			continue;
		struct gz_plot_curve *curve = find_curve(comparison, i, plot, first_rows);
		if (!curve) {
			first_rows[plot->curve_count] = i;
			curve = &plot->curves[plot->curve_count++];
			if (!begin_curve(comparison, i, curve))
				return GZ_ERR_NO_MEM;
		}
		add_curve_point(comparison, i, curve);
	}
	return GZ_OK;
}

static enum gz_result draw_error(const struct gz_comparison *comparison, size_t scene,
				 struct gz_charts *charts)
{
	char name[GZ_NAMES_SIZE];
	struct gz_plot plot = {
		.title = "FLIP against the converged ray cast, over the mean time of a frame",
		.x = { .title = "ms a frame", .logarithmic = true, .name_room = 0.2 },
		.y = { .from_zero = true },
	};
	size_t *first_rows = calloc(comparison->row_count + 1, sizeof *first_rows);
	enum gz_result result =
		first_rows ? fill_plot(comparison, scene, first_rows, &plot) : GZ_ERR_NO_MEM;
	gz_comparison_chart_name(comparison, "error", scene, name);
	if (result == GZ_OK)
		result = gz_plot_draw(charts, name, &plot);
	else
		gz_err(charts->log, "%s: no chart: %s", charts->folder, gz_result_text(result));
	gz_plot_free(&plot);
	free(first_rows);
	return result;
}

/* ---- times beside printed ones ---- */

/* Rows of the chart so far. */
struct times {
	struct gz_text table;
	size_t rows;
	double least, greatest;
};

static void add_times_row(struct times *times, const char *name, const struct gz_distribution *ms,
			  uint32_t colour)
{
	gz_text_add(&times->table, "%zu\t", times->rows++);
	gz_chart_add_cell(&times->table, name);
	gz_text_add(&times->table, "\t%.9g\t%.9g\t%.9g\t%.9g\t%.9g\t%u\n", ms->least, ms->p25,
		    ms->median, ms->p75, ms->p99, (unsigned)colour);
	times->least = fmin(times->least, ms->least);
	times->greatest = fmax(times->greatest, ms->p99);
}

static void add_printed_row(struct times *times, const struct gz_technique *technique,
			    const json_t *source, size_t machine, int slices)
{
	const json_t *described = json_array_get(json_object_get(source, "machines"), machine);
	char name[GZ_NAMES_SIZE], with[GZ_NAME_SIZE] = "";
	double ms = gz_published_ms(source, machine, technique->name, gz_effects[0].name, slices);
	if (isnan(ms))
		return;
	if (slices > 0)
		snprintf(with, sizeof with, ", %d", slices);
	snprintf(name, sizeof name, "%s%s: %s", technique->name, with,
		 json_string_value(json_object_get(described, "name")));
	const struct gz_distribution one = gz_distribution_of(&ms, 1);
	add_times_row(times, name, &one, GZ_COLOUR_MUTE);
}

static void add_printed_rows(struct times *times, const struct gz_technique *technique,
			     const json_t *sources, int slices)
{
	for (size_t i = 0; i < json_array_size(sources); i++) {
		const json_t *source = json_array_get(sources, i);
		const size_t machines = json_array_size(json_object_get(source, "machines"));
		for (size_t k = 0; k < machines; k++)
			add_printed_row(times, technique, source, k, slices);
	}
}

/* Of a scene and a technique, without effects; then what others printed. */
static void add_technique_rows(const struct gz_comparison *comparison, size_t scene,
			       const struct gz_technique *technique, const json_t *sources,
			       struct times *times)
{
	int most_slices = 0;
	for (size_t i = 0; i < comparison->row_count; i++) {
		const struct gz_comparison_row *row = &comparison->rows[i];
		char name[GZ_NAMES_SIZE], with[GZ_NAME_SIZE] = "";
		if (row->scene != scene || row->technique != technique ||
		    row->effect != &gz_effects[0])
			continue;
		if (row->slices > 0)
			snprintf(with, sizeof with, ", %d", row->slices);
		most_slices = row->slices > most_slices ? row->slices : most_slices;
		snprintf(name, sizeof name, "%s%s: here, %s, %.30s", technique->name, with,
			 row->backend, comparison->methods[row->method]);
		const struct gz_comparison_summary sum = gz_comparison_sum(comparison, row);
		add_times_row(times, name, &sum.frame_ms, colour_of(technique));
	}
	add_printed_rows(times, technique, sources, 0);
	if (most_slices > 0)
		add_printed_rows(times, technique, sources, most_slices);
}

static enum gz_result draw_times_on(const struct gz_comparison *comparison, size_t scene,
				    enum gz_canvas_kind kind, struct gz_charts *charts)
{
	char name[GZ_NAMES_SIZE];
	struct gz_canvas canvas = gz_canvas_of(kind);
	struct gz_text settings = { 0 };
	struct times times = { .least = INFINITY };
	const bool names_above = kind == GZ_CANVAS_NARROW;
	json_t *sources = gz_published_times();
	for (size_t i = 0; gz_techniques[i]; i++)
		add_technique_rows(comparison, scene, gz_techniques[i], sources, &times);
	json_decref(sources);
	canvas.left = names_above ? 14 : (int)(TIMES_NAME_CHARACTERS * canvas.font_px * 0.58);
	canvas.height = canvas.top + canvas.bottom +
			(int)times.rows * (names_above ? TIMES_NARROW_ROW_PX : TIMES_ROW_PX);
	gz_chart_set_text(&settings, "title_text",
			  "time of a frame without effects, ms; grey: as others printed it");
	gz_chart_set_text(&settings, "x_title", "box: half of all frames; line: 99 of 100");
	const double first = fmax(times.least, 1e-4) / 1.3;
	const double last = fmax(times.greatest, 2e-4) * 1.3;
	gz_text_add(&settings,
		    "x_first = %.9g\nx_last = %.9g\nx_decades = %.9g\nrows = %zu\n"
		    "names_above = %d\n",
		    first, last, log10(last / first) * (names_above ? 2 : 1), times.rows,
		    names_above);
	gz_comparison_chart_name(comparison, "times", scene, name);
	const enum gz_result result =
		gz_charts_draw(charts, "boxes.gp", name, &canvas, &settings, &times.table);
	gz_text_free(&settings);
	gz_text_free(&times.table);
	return result;
}

static enum gz_result draw_times(const struct gz_comparison *comparison, size_t scene,
				 struct gz_charts *charts)
{
	enum gz_result result = GZ_OK;
	for (int kind = 0; kind < GZ_CANVAS_KINDS && result == GZ_OK; kind++)
		result = draw_times_on(comparison, scene, kind, charts);
	return result;
}

enum gz_result gz_comparison_charts_draw(const struct gz_comparison *comparison,
					 struct gz_charts *charts)
{
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < comparison->scene_count && result == GZ_OK; i++) {
		result = draw_error(comparison, i, charts);
		if (result == GZ_OK)
			result = draw_times(comparison, i, charts);
	}
	return result;
}
