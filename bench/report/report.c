#include "bench/report/report.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"
#include "bench/report/advice.h"
#include "bench/report/names.h"
#include "bench/report/page_parts.h"
#include "bench/report/study_charts.h"
#include "bench/report/summary_json.h"
#include "bench/report/template.h"

#define GZ_LOG_MODULE "report"

/* report.html, embedded. */
extern const char gz_report_html[];

/*
 * The page is report.html filled from summary.json, to which what follows adds: names that people
 * read, charts, tables that are turned round, and the answer. Names may be cut within a character,
 * so texts are not checked for UTF-8.
 */

static json_t *member(const json_t *object, const char *key, const char *inner)
{
	return json_object_get(json_object_get(object, key), inner);
}

/* ---- figures ---- */

static void append_figure(json_t *list, json_t *figure)
{
	if (figure)
		json_array_append_new(list, figure);
}

static json_t *make_pareto(const struct gz_summary *summary, const struct gz_group *group,
			   const struct gz_charts *charts, enum gz_error_measure measure,
			   const char *class_name)
{
	char name[GZ_NAMES_SIZE], caption[2 * GZ_NAMES_SIZE];
	const bool first = strcmp(class_name, "first") == 0;
	gz_pareto_chart_name(summary, group, measure, name);
	snprintf(
		caption, sizeof caption, "%s over the time of a frame%s",
		gz_error_metrics[measure].title,
		first ? ": the lower and the farther left, the better. Ringed, and joined by the "
			"broad line: the front, which no variant beats in both. Dashed: the time "
			"of the rays that the eye can resolve, if each cost what it costs standard."
		      : "");
	return gz_page_figure(charts, name, class_name, caption);
}

/* The chart of JOD that somebody has entered; NULL without. */
static json_t *make_jod(const struct gz_summary *summary, const struct gz_group *group,
			const struct gz_charts *charts)
{
	char name[GZ_NAMES_SIZE], source[GZ_NAMES_SIZE], caption[4 * GZ_NAMES_SIZE];
	gz_jod_source(summary, group, source);
	if (!source[0])
		return NULL;
	gz_jod_chart_name(summary, group, name);
	snprintf(caption, sizeof caption,
		 "Quality in JOD over the time of a frame: 10 is no visible difference, and of two "
		 "that are 1 apart three of four people prefer the better one. The values were not "
		 "measured by this study: they were entered from %.200s (%.200s).",
		 source, summary->jods->path);
	return gz_page_figure(charts, name, "wide", caption);
}

static json_t *make_boxes(const struct gz_summary *summary, const struct gz_group *group,
			  const struct gz_charts *charts, const char *class_name)
{
	char name[GZ_NAMES_SIZE];
	gz_chart_name(summary, "boxes", group, name);
	return gz_page_figure(
		charts, name, class_name,
		"Times of frames. The box holds the middle half of them, the bar is the "
		"median, the line goes from the least to the 99th of 100.");
}

/* The maps of time and of error of one series. */
static void append_maps(const struct gz_summary *summary, const struct gz_group *group,
			const struct gz_charts *charts, size_t series, json_t *list)
{
	char name[GZ_NAMES_SIZE], words[GZ_NAMES_SIZE], caption[2 * GZ_NAMES_SIZE];
	gz_variant_words(&summary->study->variants[group->series[series].variant], words);
	for (int of_error = 0; of_error < 2; of_error++) {
		gz_map_chart_name(summary, group, series, of_error, name);
		snprintf(caption, sizeof caption, "%s: %s over the gaze", words,
			 of_error ? "error" : "time");
		append_figure(list, gz_page_figure(charts, name, "small", caption));
	}
}

/* The maps of the advised variant and of standard are visible, the others folded away. */
static json_t *make_maps(const struct gz_summary *summary, const struct gz_group *group,
			 const struct gz_charts *charts)
{
	const struct gz_advice_question question = gz_advice_preset(group);
	const size_t advised = gz_advice_find(group, &question);
	json_t *shown = json_array(), *others = json_array();
	if (advised != GZ_SERIES_NONE && advised != group->standard)
		append_maps(summary, group, charts, advised, shown);
	if (group->standard != GZ_SERIES_NONE)
		append_maps(summary, group, charts, group->standard, shown);
	for (size_t i = 0; i < group->series_count; i++)
		if (i != advised && i != group->standard)
			append_maps(summary, group, charts, i, others);
	return json_pack("{s:o, s:o}", "shown_maps", shown, "other_maps", others);
}

/* ---- tables ---- */

static json_t *make_report_table(const char *caption)
{
	json_t *table = json_object(), *rows = json_array(), *headings = json_array();
	gz_page_set_text(table, "caption", caption);
	json_object_set_new(table, "headings", headings);
	json_object_set_new(table, "rows", rows);
	return table;
}

static void add_heading(json_t *table, const char *text)
{
	json_array_append_new(json_object_get(table, "headings"), json_string_nocheck(text));
}

/* Its cells, to be filled. */
static json_t *add_table_row(json_t *table, const char *name)
{
	json_t *row = json_object(), *cells = json_array();
	gz_page_set_text(row, "name", name);
	json_object_set_new(row, "cells", cells);
	json_array_append_new(json_object_get(table, "rows"), row);
	return cells;
}

/* @p near: in small print behind it; NULL: nothing is. */
static void add_cell(json_t *cells, const char *text, const char *near)
{
	json_t *cell = json_object();
	gz_page_set_text(cell, "text", text);
	gz_page_set_text(cell, "near", near ? near : "");
	json_array_append_new(cells, cell);
}

static void add_number_cell(json_t *cells, double value)
{
	char text[GZ_TEMPLATE_NUMBER_SIZE];
	gz_template_number(value, "", text);
	add_cell(cells, text, NULL);
}

/* Similarities lie near 1: their digits that count are behind the nines. */
static void add_error_cell(json_t *cells, enum gz_error_kind kind, double value)
{
	char text[GZ_TEMPLATE_NUMBER_SIZE];
	if (kind == GZ_ERROR_SSIM && !isnan(value)) {
		snprintf(text, sizeof text, "%.4f", value);
		add_cell(cells, text, NULL);
	} else {
		add_number_cell(cells, value);
	}
}

/* An interpolated value, and the variant next to it. */
static void add_near_cell(json_t *cells, const struct gz_study *study, const struct gz_group *group,
			  double value, size_t series)
{
	char text[GZ_TEMPLATE_NUMBER_SIZE], words[GZ_NAMES_SIZE];
	if (isnan(value)) {
		add_cell(cells, "not reached", NULL);
		return;
	}
	gz_variant_words(&study->variants[group->series[series].variant], words);
	snprintf(text, sizeof text, "%.3g", value);
	add_cell(cells, text, words);
}

static bool was_measured(const struct gz_group *group, enum gz_error_reference reference)
{
	for (size_t i = 0; i < group->series_count; i++)
		for (int measure = 0; measure < GZ_ERROR_MEASURES; measure++)
			if (group->series[i].errors[reference][measure].count > 0)
				return true;
	return false;
}

/* All measures of error against one reference. */
static json_t *make_error_table(const struct gz_study *study, const struct gz_group *group,
				enum gz_error_reference reference)
{
	char caption[GZ_NAMES_SIZE], words[GZ_NAMES_SIZE];
	snprintf(caption, sizeof caption, "Errors against %s%s",
		 gz_error_reference_names[reference],
		 reference == GZ_AGAINST_CONVERGED ? ", the picture of very short steps" : "");
	json_t *table = make_report_table(caption);
	add_heading(table, "variant");
	for (int measure = 0; measure < GZ_ERROR_MEASURES; measure++) {
		add_heading(table, gz_error_metrics[measure].title);
		add_heading(table, "worst");
	}
	for (size_t i = 0; i < group->curve_count; i++)
		for (size_t k = 0; k < group->curves[i].count; k++) {
			const struct gz_series *series = &group->series[group->curves[i].series[k]];
			gz_variant_words(&study->variants[series->variant], words);
			json_t *cells = add_table_row(table, words);
			for (int measure = 0; measure < GZ_ERROR_MEASURES; measure++) {
				const enum gz_error_kind kind = gz_error_metrics[measure].kind;
				const struct gz_error_summary *errors =
					&series->errors[reference][measure];
				add_error_cell(cells, kind, errors->mean);
				add_error_cell(cells, kind, errors->worst);
			}
		}
	return table;
}

static json_t *make_error_tables(const struct gz_study *study, const struct gz_group *group)
{
	json_t *tables = json_array();
	for (int reference = 0; reference < GZ_ERROR_REFERENCES; reference++)
		if (was_measured(group, reference))
			json_array_append_new(tables, make_error_table(study, group, reference));
	return tables;
}

static json_t *make_equal_error_table(const struct gz_study *study, const struct gz_group *group)
{
	char caption[GZ_NAMES_SIZE];
	snprintf(caption, sizeof caption, "Time at foveal FLIP of %g or less",
		 GZ_EQUAL_FOVEAL_FLIP);
	json_t *table = make_report_table(caption);
	add_heading(table, "method");
	add_heading(table, "against converged, ms");
	add_heading(table, "against standard, ms");
	for (size_t i = 0; i < group->curve_count; i++) {
		json_t *cells = add_table_row(table, group->curves[i].method);
		for (int reference = 0; reference < GZ_ERROR_REFERENCES; reference++) {
			size_t series = 0;
			const double ms = gz_curve_time_at_cost(group, &group->curves[i], reference,
								GZ_FOVEAL_FLIP,
								GZ_EQUAL_FOVEAL_FLIP, &series);
			if (was_measured(group, reference))
				add_near_cell(cells, study, group, ms, series);
			else
				add_cell(cells, "not measured", NULL);
		}
	}
	return table;
}

static json_t *make_equal_time_table(const struct gz_study *study, const struct gz_group *group)
{
	char heading[64];
	const enum gz_error_reference reference = gz_group_reference(group);
	const double standard_ms = group->series[group->standard].typical_ms;
	json_t *table = make_report_table("Least perceived FLIP in a given time");
	add_heading(table, "method");
	for (int k = 0; k < GZ_EQUAL_TIMES; k++) {
		snprintf(heading, sizeof heading, "in %.3g ms (1/%g of standard)",
			 gz_equal_time_shares[k] * standard_ms, 1 / gz_equal_time_shares[k]);
		add_heading(table, heading);
	}
	for (size_t i = 0; i < group->curve_count; i++) {
		if (strcmp(group->curves[i].method, "standard") == 0)
			continue;
		json_t *cells = add_table_row(table, group->curves[i].method);
		for (int k = 0; k < GZ_EQUAL_TIMES; k++) {
			size_t series = 0;
			const double cost = gz_curve_cost_at_time(
				group, &group->curves[i], reference, GZ_PERCEIVED_FLIP,
				gz_equal_time_shares[k] * standard_ms, &series);
			add_near_cell(cells, study, group, cost, series);
		}
	}
	return table;
}

static json_t *make_equal_tables(const struct gz_study *study, const struct gz_group *group)
{
	json_t *tables = json_array();
	json_array_append_new(tables, make_equal_error_table(study, group));
	if (group->standard != GZ_SERIES_NONE && was_measured(group, gz_group_reference(group)))
		json_array_append_new(tables, make_equal_time_table(study, group));
	return tables;
}

/* How cost grows: the charts, and the table of exponents. */
static json_t *make_growth(const struct gz_summary *summary, const struct gz_charts *charts)
{
	static const char *const headings[] = { "variant",  "over", "of what",
						"exponent", "r²",   "points" };
	static const char *const kinds[] = { "pixels", "voxels", "threads" };
	char name[GZ_NAMES_SIZE], words[GZ_NAMES_SIZE];
	json_t *growth = make_report_table("Growth, t = a·xᵏ by least squares in logarithms");
	json_t *figures = json_array();
	for (size_t i = 0; i < sizeof headings / sizeof headings[0]; i++)
		add_heading(growth, headings[i]);
	for (size_t i = 0; i < summary->scaling_count; i++) {
		const struct gz_scaling *scaling = &summary->scalings[i];
		if (gz_growth_chart_name(summary, i, name))
			append_figure(
				figures,
				gz_page_figure(charts, name, "wide",
					       "How the time of a frame grows. Before each name "
					       "its exponent."));
		gz_variant_words(&summary->study->variants[scaling->variant], words);
		json_t *cells = add_table_row(growth, words);
		add_cell(cells, kinds[scaling->kind], NULL);
		gz_growth_words(summary->study, scaling, words);
		add_cell(cells, words, NULL);
		add_number_cell(cells, scaling->exponent);
		add_number_cell(cells, scaling->r2);
		add_number_cell(cells, (double)scaling->point_count);
	}
	json_object_set_new(growth, "charts", figures);
	return growth;
}

/* ---- groups ---- */

static void add_interval(const struct gz_interval *interval, json_t *variant)
{
	char text[64] = "";
	if (interval->low < interval->high) /* not of standard itself, nor NaN */
		snprintf(text, sizeof text, "%.3g to %.3g", interval->low, interval->high);
	gz_page_set_text(variant, "ratio_interval", text);
}

/* Add to a variant of summary.json the further values of its table rows. */
static void add_series(const struct gz_summary *summary, const struct gz_group *group,
		       const struct gz_series *series, json_t *variant)
{
	const int *size = summary->study->sizes[group->size];
	const char *reference = gz_error_reference_names[gz_group_reference(group)];
	const json_t *errors = member(variant, "errors", reference);
	json_t *means = json_array();
	char words[GZ_NAMES_SIZE];
	gz_variant_words(&summary->study->variants[series->variant], words);
	gz_page_set_text(variant, "words", words);
	add_interval(&series->ratio_interval, variant);
	json_object_set(variant, "perceived",
			json_object_get(errors, gz_error_metrics[GZ_PERCEIVED_FLIP].key));
	json_object_set_new(variant, "rays_share",
			    json_real(series->rays / ((double)size[0] * size[1])));
	for (int id = 0; id < GZ_STUDY_COLUMNS; id++)
		if (gz_study_columns[id].title)
			json_array_append_new(means, series->columns[id].count > 0
							     ? json_real(series->columns[id].mean)
							     : json_null());
	json_object_set_new(variant, "time_means", means);
}

/* The answer and the chart that shows it. */
static void add_answer(const struct gz_summary *summary, const struct gz_group *group,
		       const struct gz_charts *charts, json_t *out)
{
	const struct gz_advice_question question = gz_advice_preset(group);
	enum gz_error_measure measure;
	struct gz_text text = { 0 };
	gz_advice_tell(summary->study, group, &question, gz_advice_find(group, &question), true,
		       &text);
	gz_page_set_text(out, "answer", text.bytes ? text.bytes : "");
	gz_text_free(&text);
	json_object_set_new(out, "first_chart",
			    gz_group_measure(group, &measure)
				    ? make_pareto(summary, group, charts, measure, "first")
				    : make_boxes(summary, group, charts, "first"));
}

static void add_errors(const struct gz_summary *summary, const struct gz_group *group,
		       const struct gz_charts *charts, enum gz_error_measure first, json_t *out)
{
	json_t *others = json_array();
	json_object_set_new(out, "measured", json_true());
	json_object_set_new(out, "equal_tables", make_equal_tables(summary->study, group));
	json_object_set_new(out, "error_tables", make_error_tables(summary->study, group));
	json_object_set_new(out, "boxes", make_boxes(summary, group, charts, "wide"));
	for (int measure = 0; measure < GZ_ERROR_MEASURES; measure++)
		if (measure != (int)first)
			append_figure(others,
				      make_pareto(summary, group, charts, measure, "small"));
	if (charts->available)
		json_object_set_new(out, "other_charts", json_pack("{s:O}", "list", others));
	json_decref(others);
}

/* The bytes of a file in base64; NULL if it cannot be read. */
static json_t *embedded_file(const char *path)
{
	struct gz_text bytes = { 0 }, text = { 0 };
	json_t *json = NULL;
	if (gz_text_add_file(&bytes, path) == GZ_OK) {
		gz_text_add_base64(&text, bytes.bytes, bytes.length);
		json = text.failed ? NULL : json_string(text.bytes);
	}
	gz_text_free(&bytes);
	gz_text_free(&text);
	return json;
}

static json_t *make_crop_figure(const struct gz_summary *summary, const struct gz_crop *crop)
{
	char words[GZ_NAMES_SIZE], caption[2 * GZ_NAMES_SIZE];
	const struct gz_group *group = &summary->groups[crop->group];
	enum gz_error_measure measure = GZ_PERCEIVED_FLIP;
	gz_group_measure(group, &measure);
	gz_variant_words(&summary->study->variants[group->series[crop->series].variant], words);
	snprintf(caption, sizeof caption,
		 "%s, %s gaze (%.2f, %.2f): %s against standard %.3g. The crop is %.1f° "
		 "from the gaze.",
		 words, crop->worst ? "worst" : "median", (double)crop->gaze.x,
		 (double)crop->gaze.y, gz_error_metrics[measure].title, crop->error,
		 crop->away_deg);
	json_t *figure = json_object();
	gz_page_set_text(figure, "caption", caption);
	json_object_set_new(figure, "png", embedded_file(crop->path));
	return figure;
}

static void add_crop_figures(const struct gz_summary *summary, size_t group,
			     const struct gz_crops *crops, json_t *out)
{
	json_t *figures = json_array();
	for (size_t i = 0; crops && i < crops->count; i++)
		if (crops->items[i].group == group)
			json_array_append_new(figures, make_crop_figure(summary, &crops->items[i]));
	if (json_array_size(figures) > 0)
		json_object_set_new(out, "crops", json_pack("{s:O}", "list", figures));
	json_decref(figures);
}

static void add_group(const struct gz_summary *summary, size_t place,
		      const struct gz_charts *charts, const struct gz_crops *crops, json_t *out)
{
	const struct gz_group *group = &summary->groups[place];
	json_t *variants = json_object_get(out, "variants"), *series = json_array();
	enum gz_error_measure measure;
	char words[GZ_NAMES_SIZE];
	gz_group_words(summary->study, group, words);
	gz_page_set_text(out, "title", words);
	json_object_set_new(out, "number", json_integer((json_int_t)place + 1));
	json_object_set_new(out, "is_first", json_boolean(place == 0)); /* in the page's header */
	add_answer(summary, group, charts, out);
	for (size_t i = 0; i < group->curve_count; i++)
		for (size_t k = 0; k < group->curves[i].count; k++) {
			const size_t at = group->curves[i].series[k];
			json_t *variant = json_array_get(variants, at);
			add_series(summary, group, &group->series[at], variant);
			json_array_append(series, variant);
		}
	json_object_set_new(out, "series", series);
	if (gz_group_measure(group, &measure))
		add_errors(summary, group, charts, measure, out);
	if (charts->available)
		json_object_set_new(out, "maps", make_maps(summary, group, charts));
	json_t *jod = make_jod(summary, group, charts);
	if (jod)
		json_object_set_new(out, "jod_chart", jod);
	add_crop_figures(summary, place, crops, out);
}

/* ---- the machine and the command ---- */

static void add_number_fact(json_t *facts, const char *name, unsigned long long number)
{
	char text[32];
	snprintf(text, sizeof text, "%llu", number);
	gz_page_add_fact(facts, name, text);
}

static void add_scene_fact(json_t *facts, const struct gz_study_scene *scene)
{
	char words[GZ_NAMES_SIZE], text[3 * GZ_NAMES_SIZE];
	gz_scene_words(scene, words);
	snprintf(text, sizeof text,
		 "%s: %d×%d×%d voxels, %dx%d px of %.4g×%.4g mm seen from %g mm, "
		 "SHA-256 %s",
		 words, scene->dims[0], scene->dims[1], scene->dims[2], scene->display.px[0],
		 scene->display.px[1], scene->display.mm[0], scene->display.mm[1],
		 scene->display.distance_mm, scene->hash);
	gz_page_add_fact(facts, "scene", text);
}

static json_t *make_facts(const struct gz_study *study)
{
	const struct gz_study_machine *machine = &study->machine;
	json_t *facts = json_array();
	gz_page_add_fact(facts, "processor", machine->host_cpu);
	gz_page_add_fact(facts, "memory", machine->memory);
	gz_page_add_fact(facts, "system", machine->system);
	for (size_t i = 0; i < study->backend_count; i++) {
		char name[GZ_NAMES_SIZE];
		snprintf(name, sizeof name, "backend %.100s", study->backends[i]);
		gz_page_add_fact(facts, name, machine->backends[i]);
	}
	gz_page_add_fact(facts, "compiler", machine->compiler);
	gz_page_add_fact(facts, "program", machine->program);
	gz_page_add_fact(facts, "commit", machine->commit);
	for (size_t i = 0; i < study->scene_count; i++)
		add_scene_fact(facts, &study->scenes[i]);
	gz_page_add_fact(facts, "path of the gaze", study->path);
	gz_page_add_fact(facts, "its points, SHA-256", study->path_hash);
	add_number_fact(facts, "points", study->point_count);
	add_number_fact(facts, "frames counted at each",
			(unsigned long long)study->frames_per_point);
	add_number_fact(facts, "frames before, not counted",
			(unsigned long long)study->warm_up_frames);
	add_number_fact(facts, "seed", study->seed);
	return facts;
}

/* An argument as a shell takes it back. */
static void add_argument(const char *text, struct gz_text *out)
{
	static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
				    "_-./:=,+@%";
	if (text[0] && strspn(text, plain) == strlen(text)) {
		gz_text_add(out, "%s", text);
		return;
	}
	gz_text_add(out, "'");
	for (; *text; text++) {
		if (*text == '\'')
			gz_text_add(out, "'\\''");
		else
			gz_text_add_bytes(out, text, 1);
	}
	gz_text_add(out, "'");
}

static bool path_is_new(const struct gz_study *study, size_t place)
{
	for (size_t i = 0; i < place; i++)
		if (strcmp(study->scenes[i].path, study->scenes[place].path) == 0)
			return false;
	return true;
}

/* The display, where it is known and the same for all scenes. */
static void add_display(const struct gz_study *study, struct gz_text *out)
{
	const struct gz_display *first = &study->scenes[0].display;
	for (size_t i = 0; i < study->scene_count; i++) {
		const struct gz_display *display = &study->scenes[i].display;
		if (!study->scenes[i].display_known || display->mm[0] != first->mm[0] ||
		    display->mm[1] != first->mm[1] || display->distance_mm != first->distance_mm)
			return;
	}
	char numbers[3][GZ_NUMBER_SIZE];
	gz_number_print(first->mm[0], numbers[0]);
	gz_number_print(first->mm[1], numbers[1]);
	gz_number_print(first->distance_mm, numbers[2]);
	gz_text_add(out, " \\\n  --display-mm '%s %s' --distance-mm %s", numbers[0], numbers[1],
		    numbers[2]);
}

/* The command that makes or resumes the study. */
static void add_command(const struct gz_study *study, struct gz_text *out)
{
	gz_text_add(out, "gazebench run");
	for (size_t i = 0; i < study->scene_count; i++)
		if (path_is_new(study, i)) {
			gz_text_add(out, " ");
			add_argument(study->scenes[i].path, out);
		}
	gz_text_add(out, " --path ");
	add_argument(study->path, out);
	gz_text_add(out, " \\\n  --methods ");
	/* Standard is always measured. */
	const bool skip =
		study->variant_count > 1 && strcmp(study->variants[0].text, "standard") == 0;
	for (size_t i = skip; i < study->variant_count; i++) {
		gz_text_add(out, i > skip ? "," : "");
		add_argument(study->variants[i].text, out);
	}
	gz_text_add(out, " \\\n  --size ");
	for (size_t i = 0; i < study->size_count; i++)
		gz_text_add(out, "%s%dx%d", i > 0 ? "," : "", study->sizes[i][0],
			    study->sizes[i][1]);
	gz_text_add(out, " --backend ");
	for (size_t i = 0; i < study->backend_count; i++) {
		gz_text_add(out, i > 0 ? "," : "");
		add_argument(study->backends[i], out);
	}
	if (study->camera_path[0]) {
		gz_text_add(out, " --camera-path ");
		add_argument(study->camera_path, out);
	}
	if (study->camera_count > 0)
		gz_text_add(out, " --cameras %u", study->camera_count);
	if (study->min_move_px > 0)
		gz_text_add(out, " --min-move %.10g", study->min_move_px);
	if (study->per_cell)
		gz_text_add(out, " --per-cell");
	gz_text_add(out, " \\\n  --frames %d --warm-up %d --seed %llu --errors %s",
		    study->frames_per_point, study->warm_up_frames, (unsigned long long)study->seed,
		    gz_study_accuracy_names[study->accuracy]);
	add_display(study, out);
	if (study->shard_count > 1)
		gz_text_add(out, " --shard %d/%d", study->shard + 1, study->shard_count);
	gz_text_add(out, " --out DIR");
}

/* ---- the page ---- */

static void add_banners(const struct gz_study *study, const struct gz_charts *charts, json_t *page)
{
	json_object_set_new(page, "partial", json_boolean(!study->complete));
	json_object_set_new(page, "no_charts", json_boolean(!charts->available));
	if (study->shard_count > 1)
		json_object_set_new(page, "shards",
				    json_pack("{s:i, s:i}", "count", study->shard_count, "number",
					      study->shard + 1));
}

static void add_time_titles(json_t *page)
{
	json_t *titles = json_array();
	for (int id = 0; id < GZ_STUDY_COLUMNS; id++)
		if (gz_study_columns[id].title)
			json_array_append_new(titles, json_string(gz_study_columns[id].title));
	json_object_set_new(page, "time_titles", titles);
}

void gz_page_write(const struct gz_summary *summary, const struct gz_charts *charts,
		   const struct gz_crops *crops, struct gz_text *out)
{
	json_t *page = gz_summary_to_json(summary), *groups = json_object_get(page, "groups");
	struct gz_text command = { 0 };
	gz_page_set_style(page);
	add_banners(summary->study, charts, page);
	add_time_titles(page);
	for (size_t i = 0; i < summary->group_count; i++)
		add_group(summary, i, charts, crops, json_array_get(groups, i));
	json_object_set(page, "header", json_array_get(groups, 0));
	json_object_set(page, "title", member(page, "header", "title"));
	json_object_set_new(page, "contents", json_boolean(summary->group_count > 1));
	if (summary->scaling_count > 0)
		json_object_set_new(page, "growth", make_growth(summary, charts));
	json_object_set_new(page, "facts", make_facts(summary->study));
	add_command(summary->study, &command);
	gz_page_set_text(page, "command", command.bytes ? command.bytes : "");
	if (!page || !gz_template_fill(gz_report_html, page, out) || command.failed)
		out->failed = true;
	gz_text_free(&command);
	json_decref(page);
}

static enum gz_result write_summary(const struct gz_summary *summary, const char *folder,
				    const struct gz_log *log)
{
	char path[GZ_PATH_SIZE + 32];
	json_t *json = gz_summary_to_json(summary);
	if (!json) {
		gz_err(log, "%s: no summary: %s", folder, gz_result_text(GZ_ERR_NO_MEM));
		return GZ_ERR_NO_MEM;
	}
	snprintf(path, sizeof path, "%s/summary.json", folder);
	const enum gz_result result = gz_json_write(json, path, log);
	json_decref(json);
	return result;
}

static enum gz_result write_page(const struct gz_summary *summary, const struct gz_charts *charts,
				 const struct gz_crops *crops, const char *folder,
				 const struct gz_log *log)
{
	char path[GZ_PATH_SIZE + 32];
	struct gz_text page = { 0 };
	gz_page_write(summary, charts, crops, &page);
	snprintf(path, sizeof path, "%s/report.html", folder);
	const enum gz_result result = gz_text_write(&page, path, log);
	gz_text_free(&page);
	return result;
}

enum gz_result gz_report_write(const struct gz_summary *summary, const char *folder,
			       const struct gz_log *log)
{
	struct gz_charts charts = { 0 };
	struct gz_crops crops = { 0 };
	enum gz_result result = write_summary(summary, folder, log);
	if (result == GZ_OK)
		result = gz_charts_open(folder, log, &charts);
	if (result == GZ_OK)
		result = gz_study_charts_draw(summary, &charts);
	if (result == GZ_OK)
		result = gz_crops_make(summary, folder, log, &crops);
	if (result == GZ_OK)
		result = write_page(summary, &charts, &crops, folder, log);
	gz_crops_free(&crops);
	gz_charts_close(&charts);
	return result;
}
