/* The tables of the report. Each scrolls within its own box where the page is narrow. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "bench/report/names.h"
#include "bench/report/page_parts.h"
#include "bench/report/summary_json.h"

/* Headings, NULL behind the last; the first is that of the rows' names. */
static void begin_table(const char *caption, const char *const *headings, struct gz_text *out)
{
	gz_text_add(out, "<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"");
	gz_text_add_escaped(out, caption);
	gz_text_add(out, "\"><table>\n<caption>");
	gz_text_add_escaped(out, caption);
	gz_text_add(out, "</caption>\n<thead><tr>");
	for (; *headings; headings++) {
		gz_text_add(out, "<th scope=\"col\">");
		gz_text_add_escaped(out, *headings);
		gz_text_add(out, "</th>");
	}
	gz_text_add(out, "</tr></thead>\n<tbody>\n");
}

static void end_table(struct gz_text *out)
{
	gz_text_add(out, "</tbody></table></div>\n");
}

static void begin_row(const char *name, bool stressed, struct gz_text *out)
{
	gz_text_add(out, "<tr%s><th scope=\"row\">", stressed ? " class=\"best\"" : "");
	gz_text_add_escaped(out, name);
	gz_text_add(out, "</th>");
}

static void end_row(struct gz_text *out)
{
	gz_text_add(out, "</tr>\n");
}

static void add_cell_text(const char *text, struct gz_text *out)
{
	gz_text_add(out, "<td>");
	gz_text_add_escaped(out, text);
	gz_text_add(out, "</td>");
}

/* Three digits that count, without powers of ten where people read none. */
static void add_number(double value, const char *unit, struct gz_text *out)
{
	char text[64];
	if (isnan(value))
		snprintf(text, sizeof text, "–");
	else if (isinf(value))
		snprintf(text, sizeof text, "∞");
	else if (fabs(value) >= 999.5 && fabs(value) < 1e9)
		snprintf(text, sizeof text, "%.0f%s", value, unit);
	else
		snprintf(text, sizeof text, "%.3g%s", value, unit);
	add_cell_text(text, out);
}

/* The group's series in the order of its curves. */
static void each_series(const struct gz_summary *summary, const struct gz_group *group,
			void (*add)(const struct gz_summary *, const struct gz_group *,
				    const struct gz_series *, const char *, struct gz_text *),
			struct gz_text *out)
{
	for (size_t i = 0; i < group->curve_count; i++)
		for (size_t k = 0; k < group->curves[i].count; k++) {
			char words[GZ_NAMES_SIZE];
			const struct gz_series *series = &group->series[group->curves[i].series[k]];
			gz_variant_words(&summary->study->variants[series->variant], words);
			add(summary, group, series, words, out);
		}
}

static void add_gain(const struct gz_summary *summary, const struct gz_group *group,
		     const struct gz_series *series, const char *words, struct gz_text *out)
{
	const int *size = summary->study->sizes[group->size];
	const struct gz_error_summary *flip =
		&series->errors[gz_group_reference(group)][GZ_PERCEIVED_FLIP];
	begin_row(words, series->front[gz_group_reference(group)][GZ_PERCEIVED_FLIP], out);
	add_number(series->typical_ms, "", out);
	add_number(series->ratio_of_means, "×", out);
	add_number(series->mean_ratio, "×", out);
	add_number(series->least_ratio, "×", out);
	add_number(100 * series->rays / ((double)size[0] * size[1]), " %", out);
	add_number(100 * series->bound_share, " %", out);
	add_number(flip->mean, "", out);
	add_number(flip->p95, "", out);
	add_number(flip->worst, "", out);
	add_number(series->flicker.mean, "", out);
	end_row(out);
}

void gz_page_gain_table(const struct gz_summary *summary, const struct gz_group *group,
			struct gz_text *out)
{
	static const char *const headings[] = { "variant",
						"ms a frame",
						"faster, of means",
						"faster, mean",
						"faster, least",
						"rays",
						"of bound’s rays",
						"perceived FLIP, mean",
						"95 of 100 points below",
						"at the worst point",
						"flicker, of 255",
						NULL };
	gz_text_add(out, "<h3>What each variant gains and costs</h3>\n<p>“ms a frame” is the "
			 "median of each point’s frames, averaged over the points; how much faster "
			 "than <code>standard</code> is told as the ratio of those means, as the "
			 "mean of the points’ own ratios, and as the least of them. Rows in bold "
			 "are on the front.</p>\n");
	begin_table("Gain and error", headings, out);
	each_series(summary, group, add_gain, out);
	end_table(out);
}

/* Similarities lie near 1: what counts of them is behind the nines. */
static void add_error(enum gz_error_kind kind, double value, struct gz_text *out)
{
	char text[64];
	if (kind != GZ_ERROR_SSIM || isnan(value)) {
		add_number(value, "", out);
		return;
	}
	snprintf(text, sizeof text, "%.4f", value);
	add_cell_text(text, out);
}

static void add_errors(const struct gz_series *series, enum gz_error_reference reference,
		       const char *words, struct gz_text *out)
{
	begin_row(words, false, out);
	for (int measure = 0; measure < GZ_ERROR_MEASURES; measure++) {
		const struct gz_error_summary *errors = &series->errors[reference][measure];
		add_error(gz_error_metrics[measure].kind, errors->mean, out);
		add_error(gz_error_metrics[measure].kind, errors->worst, out);
	}
	end_row(out);
}

static bool was_measured(const struct gz_group *group, enum gz_error_reference reference)
{
	for (size_t i = 0; i < group->series_count; i++)
		for (int measure = 0; measure < GZ_ERROR_MEASURES; measure++)
			if (group->series[i].errors[reference][measure].count > 0)
				return true;
	return false;
}

void gz_page_error_table(const struct gz_summary *summary, const struct gz_group *group,
			 enum gz_error_reference reference, struct gz_text *out)
{
	const char *headings[2 * GZ_ERROR_MEASURES + 2] = { "variant" };
	char caption[GZ_NAMES_SIZE];
	if (!was_measured(group, reference))
		return;
	for (int measure = 0; measure < GZ_ERROR_MEASURES; measure++) {
		headings[1 + 2 * measure] = gz_error_metrics[measure].title;
		headings[2 + 2 * measure] = "worst";
	}
	snprintf(caption, sizeof caption, "Errors against %s%s",
		 gz_error_reference_names[reference],
		 reference == GZ_AGAINST_CONVERGED ? ", the picture of very short steps" : "");
	begin_table(caption, headings, out);
	for (size_t i = 0; i < group->curve_count; i++)
		for (size_t k = 0; k < group->curves[i].count; k++) {
			char words[GZ_NAMES_SIZE];
			const struct gz_series *series = &group->series[group->curves[i].series[k]];
			gz_variant_words(&summary->study->variants[series->variant], words);
			add_errors(series, reference, words, out);
		}
	end_table(out);
}

static void add_times(const struct gz_summary *summary, const struct gz_group *group,
		      const struct gz_series *series, const char *words, struct gz_text *out)
{
	(void)summary;
	(void)group;
	const struct gz_distribution *frame = &series->columns[GZ_COLUMN_FRAME];
	begin_row(words, false, out);
	add_number(frame->mean, "", out);
	add_number(frame->median, "", out);
	add_number(frame->p90, "", out);
	add_number(frame->p99, "", out);
	add_number(frame->perceived, "", out);
	for (int id = 0; id < GZ_STUDY_COLUMNS; id++)
		if (gz_study_columns[id].title)
			add_number(series->columns[id].mean, "", out);
	add_number(series->rays, "", out);
	add_number(series->samples / 1e6, "", out);
	end_row(out);
}

void gz_page_time_table(const struct gz_summary *summary, const struct gz_group *group,
			struct gz_text *out)
{
	const char *headings[GZ_STUDY_COLUMNS + 9] = {
		"variant", "mean, ms", "p50", "p90", "p99", "time-weighted mean"
	};
	size_t count = 6;
	for (int id = 0; id < GZ_STUDY_COLUMNS; id++)
		if (gz_study_columns[id].title)
			headings[count++] = gz_study_columns[id].title;
	headings[count++] = "rays a frame";
	headings[count] = "million samples a frame";
	gz_text_add(out, "<h3>Times of frames</h3>\n<p>The time-weighted mean, Σt²/Σt, is what is "
			 "on screen at a moment picked at random: long frames stay longer. The "
			 "parts of a frame are means, ms.</p>\n");
	begin_table("Times of frames", headings, out);
	each_series(summary, group, add_times, out);
	end_table(out);
}

static void add_cast(const struct gz_summary *summary, const struct gz_group *group,
		     const struct gz_series *series, const char *words, struct gz_text *out)
{
	(void)summary;
	(void)group;
	begin_row(words, false, out);
	add_number(series->columns[GZ_COLUMN_CAST].mean, "", out);
	add_number(series->columns[GZ_COLUMN_CAST].variance, "", out);
	add_number(series->overhead_ms.mean, "", out);
	add_number(series->columns[GZ_COLUMN_FRAME].sum, "", out);
	end_row(out);
}

void gz_page_cast_table(const struct gz_summary *summary, const struct gz_group *group,
			struct gz_text *out)
{
	static const char *const headings[] = { "variant",
						"cast, mean, ms",
						"cast, variance, ms²",
						"overhead, mean, ms",
						"sum of frames, ms",
						NULL };
	begin_table("As table 5.1 of Bauer 2018", headings, out);
	each_series(summary, group, add_cast, out);
	end_table(out);
	gz_text_add(out, "<p class=\"note\">Overhead is what a frame takes beside casting.</p>\n");
}

static void add_near(const struct gz_study *study, const struct gz_group *group, size_t series,
		     struct gz_text *out)
{
	char words[GZ_NAMES_SIZE];
	gz_variant_words(&study->variants[group->series[series].variant], words);
	gz_text_add(out, " <small>");
	gz_text_add_escaped(out, words);
	gz_text_add(out, "</small></td>");
}

static void add_equal_error(const struct gz_study *study, const struct gz_group *group,
			    struct gz_text *out)
{
	static const char *const headings[] = { "method", "against converged, ms",
						"against standard, ms", NULL };
	char caption[GZ_NAMES_SIZE];
	snprintf(caption, sizeof caption, "Time at foveal FLIP of %g or less",
		 GZ_EQUAL_FOVEAL_FLIP);
	begin_table(caption, headings, out);
	for (size_t i = 0; i < group->curve_count; i++) {
		begin_row(group->curves[i].method, false, out);
		for (int reference = 0; reference < GZ_ERROR_REFERENCES; reference++) {
			size_t series;
			const double ms = gz_curve_time_at_cost(group, &group->curves[i], reference,
								GZ_FOVEAL_FLIP,
								GZ_EQUAL_FOVEAL_FLIP, &series);
			if (!was_measured(group, reference)) {
				add_cell_text("not measured", out);
			} else if (isnan(ms)) {
				add_cell_text("not reached", out);
			} else {
				gz_text_add(out, "<td>%.3g", ms);
				add_near(study, group, series, out);
			}
		}
		end_row(out);
	}
	end_table(out);
}

static void add_equal_time(const struct gz_study *study, const struct gz_group *group,
			   struct gz_text *out)
{
	char heads[GZ_EQUAL_TIMES][64];
	const char *headings[GZ_EQUAL_TIMES + 2] = { "method" };
	const enum gz_error_reference reference = gz_group_reference(group);
	if (group->standard == GZ_SERIES_NONE || !was_measured(group, reference))
		return;
	const double standard_ms = group->series[group->standard].typical_ms;
	for (int k = 0; k < GZ_EQUAL_TIMES; k++) {
		snprintf(heads[k], sizeof heads[k], "in %.3g ms (1/%g of standard)",
			 gz_equal_time_shares[k] * standard_ms, 1 / gz_equal_time_shares[k]);
		headings[k + 1] = heads[k];
	}
	begin_table("Least perceived FLIP in a given time", headings, out);
	for (size_t i = 0; i < group->curve_count; i++) {
		if (strcmp(group->curves[i].method, "standard") == 0)
			continue;
		begin_row(group->curves[i].method, false, out);
		for (int k = 0; k < GZ_EQUAL_TIMES; k++) {
			size_t series;
			const double cost = gz_curve_cost_at_time(
				group, &group->curves[i], reference, GZ_PERCEIVED_FLIP,
				gz_equal_time_shares[k] * standard_ms, &series);
			if (isnan(cost)) {
				add_cell_text("not reached", out);
				continue;
			}
			gz_text_add(out, "<td>%.3g", cost);
			add_near(study, group, series, out);
		}
		end_row(out);
	}
	end_table(out);
}

void gz_page_equal_tables(const struct gz_summary *summary, const struct gz_group *group,
			  struct gz_text *out)
{
	gz_text_add(out,
		    "<h3>At equal error, and in equal time</h3>\n<p>Between the variants of a "
		    "method that were measured, time and error are taken to go in a straight "
		    "line; small print names the variant that is at the place, or finer.</p>\n");
	add_equal_error(summary->study, group, out);
	add_equal_time(summary->study, group, out);
}

void gz_page_growth_table(const struct gz_summary *summary, struct gz_text *out)
{
	static const char *const headings[] = { "variant", "over",   "of what", "exponent",
						"r²",      "points", NULL };
	static const char *const kinds[] = { "pixels", "voxels", "threads" };
	const struct gz_study *study = summary->study;
	if (summary->scaling_count == 0)
		return;
	begin_table("Growth, t = a·xᵏ by least squares in logarithms", headings, out);
	for (size_t i = 0; i < summary->scaling_count; i++) {
		char words[GZ_NAMES_SIZE], what[GZ_NAMES_SIZE];
		const struct gz_scaling *scaling = &summary->scalings[i];
		gz_variant_words(&study->variants[scaling->variant], words);
		begin_row(words, false, out);
		add_cell_text(kinds[scaling->kind], out);
		gz_growth_words(study, scaling, what);
		add_cell_text(what, out);
		add_number(scaling->exponent, "", out);
		add_number(scaling->r2, "", out);
		add_number((double)scaling->point_count, "", out);
		end_row(out);
	}
	end_table(out);
}
