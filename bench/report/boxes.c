/* Boxes of frame times, a variant a row. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/report/chart_parts.h"
#include "bench/report/names.h"
#include "bench/report/palette.h"

/* A row's height, px: on a narrow canvas a name and, below it, a box. */
static int row_px(const struct gz_canvas *canvas)
{
	return canvas->kind == GZ_CANVAS_NARROW ? 42 : 30;
}

static void add_row(const struct gz_study *study, const struct gz_series *series, size_t row,
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

/* As many as the longest name has, or the canvas has room for. */
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

static enum gz_result draw_on(const struct gz_summary *summary, const struct gz_group *group,
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
			add_row(summary->study, series, rows++, characters, &table);
		}
	const bool names_above = kind == GZ_CANVAS_NARROW;
	canvas.left = names_above ? 14 : (int)((characters + 2) * canvas.font_px * 0.58);
	canvas.height = canvas.top + canvas.bottom + (int)rows * row_px(&canvas);
	gz_chart_set_text(&settings, "title_text", "time of a frame, ms");
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

enum gz_result gz_boxes_draw(const struct gz_summary *summary, const struct gz_group *group,
			     struct gz_charts *charts)
{
	enum gz_result result = GZ_OK;
	for (int kind = 0; kind < GZ_CANVAS_KINDS && result == GZ_OK; kind++)
		result = draw_on(summary, group, kind, charts);
	return result;
}
