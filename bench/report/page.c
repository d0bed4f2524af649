#include "bench/report/page.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/report/advice.h"
#include "bench/report/names.h"
#include "bench/report/page_parts.h"
#include "bench/report/study_charts.h"

/* report.css, embedded. */
extern const char gz_report_css[];

void gz_page_figure(const struct gz_charts *charts, const char *name, const char *class_name,
		    const char *caption, struct gz_text *out)
{
	const struct gz_chart *chart = gz_charts_find(charts, name);
	if (!chart || !chart->svg[GZ_CANVAS_WIDE])
		return;
	const bool small = strcmp(class_name, "small") == 0;
	const char *narrow = chart->svg[GZ_CANVAS_NARROW]; /* maps are the same on both */
	narrow = narrow ? narrow : chart->svg[GZ_CANVAS_WIDE];
	const char *wide = small ? narrow : chart->svg[GZ_CANVAS_WIDE];
	gz_text_add(out, "<figure class=\"%s\"><picture>", class_name);
	if (!small) {
		gz_text_add(out, "<source media=\"(max-width: 700px)\" "
				 "srcset=\"data:image/svg+xml;base64,");
		gz_text_add_base64(out, narrow, strlen(narrow));
		gz_text_add(out, "\">");
	}
	gz_text_add(out, "<img src=\"data:image/svg+xml;base64,");
	gz_text_add_base64(out, wide, strlen(wide));
	gz_text_add(out, "\" alt=\"");
	gz_text_add_escaped(out, caption);
	gz_text_add(out, "\"></picture>");
	if (!small) { /* those say it in their titles */
		gz_text_add(out, "<figcaption>");
		gz_text_add_escaped(out, caption);
		gz_text_add(out, "</figcaption>");
	}
	gz_text_add(out, "</figure>\n");
}

static void add_pareto(const struct gz_summary *summary, const struct gz_group *group,
		       const struct gz_charts *charts, enum gz_error_measure measure,
		       const char *class_name, struct gz_text *out)
{
	char name[GZ_NAMES_SIZE], caption[2 * GZ_NAMES_SIZE];
	const bool first = strcmp(class_name, "first") == 0;
	gz_pareto_chart_name(summary, group, measure, name);
	snprintf(caption, sizeof caption, "%s over the time of a frame%s",
		 gz_error_metrics[measure].title,
		 first ? ": the lower and the farther left, the better. Ringed, and joined by the "
			 "broad line: the front, which nothing beats in both. Dashed: the time of "
			 "the rays that the eye can resolve, if each cost what it costs standard."
		       : "");
	gz_page_figure(charts, name, class_name, caption, out);
}

static void add_boxes(const struct gz_summary *summary, const struct gz_group *group,
		      const struct gz_charts *charts, const char *class_name, struct gz_text *out)
{
	char name[GZ_NAMES_SIZE];
	gz_chart_name(summary, "boxes", group, name);
	gz_page_figure(charts, name, class_name,
		       "Times of frames. The box holds the middle half of them, the bar is the "
		       "median, the line goes from the least to the 99th of 100.",
		       out);
}

static void add_answer(const struct gz_summary *summary, const struct gz_group *group,
		       const struct gz_charts *charts, struct gz_text *out)
{
	const struct gz_advice_question question = gz_advice_preset(group);
	enum gz_error_measure measure;
	gz_text_add(out, "<p class=\"answer\">");
	gz_advice_tell(summary->study, group, &question, gz_advice_find(group, &question), true,
		       out);
	gz_text_add(out, "</p>\n");
	if (gz_group_measure(group, &measure))
		add_pareto(summary, group, charts, measure, "first", out);
	else
		add_boxes(summary, group, charts, "first", out);
}

static void add_banners(const struct gz_summary *summary, const struct gz_charts *charts,
			struct gz_text *out)
{
	const struct gz_study *study = summary->study;
	if (!study->complete)
		gz_text_add(out,
			    "<p class=\"banner\" role=\"note\"><strong>Partial study.</strong> "
			    "It was interrupted, or its disk was full: %zu frames were measured so "
			    "far, and what follows is of those alone. The command at the end "
			    "resumes it.</p>\n",
			    study->row_count);
	if (study->shard_count > 1)
		gz_text_add(out,
			    "<p class=\"banner\" role=\"note\"><strong>One part of %d.</strong> "
			    "This folder holds shard %d; <code>gazebench merge</code> joins it "
			    "with the others.</p>\n",
			    study->shard_count, study->shard + 1);
	if (!charts->available)
		gz_text_add(out, "<p class=\"banner\" role=\"note\"><strong>No charts.</strong> "
				 "gnuplot was not found when this report was made; every number is "
				 "in the tables.</p>\n");
}

static void add_other_charts(const struct gz_summary *summary, const struct gz_group *group,
			     const struct gz_charts *charts, struct gz_text *out)
{
	enum gz_error_measure first;
	if (!charts->available || !gz_group_measure(group, &first))
		return;
	gz_text_add(out, "<h3>The same by other measures of error</h3>\n<div class=\"grid\">\n");
	for (int measure = 0; measure < GZ_ERROR_MEASURES; measure++)
		if (measure != (int)first)
			add_pareto(summary, group, charts, measure, "small", out);
	gz_text_add(out, "</div>\n");
}

static void add_maps_of(const struct gz_summary *summary, const struct gz_group *group,
			const struct gz_charts *charts, size_t series, struct gz_text *out)
{
	char name[GZ_NAMES_SIZE], words[GZ_NAMES_SIZE], caption[2 * GZ_NAMES_SIZE];
	gz_variant_words(&summary->study->variants[group->series[series].variant], words);
	for (int of_error = 0; of_error < 2; of_error++) {
		gz_map_chart_name(summary, group, series, of_error, name);
		snprintf(caption, sizeof caption, "%s: %s over the gaze", words,
			 of_error ? "error" : "time");
		gz_page_figure(charts, name, "small", caption, out);
	}
}

/* Those of what is advised and of standard are seen at once, the others on demand. */
static void add_maps(const struct gz_summary *summary, const struct gz_group *group,
		     const struct gz_charts *charts, struct gz_text *out)
{
	const struct gz_advice_question question = gz_advice_preset(group);
	const size_t advised = gz_advice_find(group, &question);
	if (!charts->available)
		return;
	gz_text_add(out, "<h3>Where the gaze makes it dear, and where wrong</h3>\n"
			 "<p>Each point is a place of the gaze, over the picture; yellow is the "
			 "slowest, and the farthest from the reference, of its own map.</p>\n"
			 "<div class=\"grid maps\">\n");
	if (advised != GZ_SERIES_NONE && advised != group->standard)
		add_maps_of(summary, group, charts, advised, out);
	if (group->standard != GZ_SERIES_NONE)
		add_maps_of(summary, group, charts, group->standard, out);
	gz_text_add(out, "</div>\n<details><summary>Maps of the other variants</summary>\n"
			 "<div class=\"grid maps\">\n");
	for (size_t i = 0; i < group->series_count; i++)
		if (i != advised && i != group->standard)
			add_maps_of(summary, group, charts, i, out);
	gz_text_add(out, "</div></details>\n");
}

static void add_errors(const struct gz_summary *summary, const struct gz_group *group,
		       const struct gz_charts *charts, struct gz_text *out)
{
	gz_page_equal_tables(summary, group, out);
	add_other_charts(summary, group, charts, out);
	gz_text_add(out, "<h3>All measures of error</h3>\n<p>PSNR in decibels is that of the mean "
			 "squared error over all points; decibels themselves are never "
			 "averaged.");
	if (!isnan(group->reference_db))
		gz_text_add(out,
			    " The converged picture and one of half its step are %.3g dB apart at "
			    "the worst point.",
			    group->reference_db);
	gz_text_add(out, "</p>\n");
	gz_page_error_table(summary, group, GZ_AGAINST_CONVERGED, out);
	gz_page_error_table(summary, group, GZ_AGAINST_STANDARD, out);
}

static void add_details(const struct gz_summary *summary, const struct gz_group *group,
			const struct gz_charts *charts, struct gz_text *out)
{
	enum gz_error_measure measure;
	const bool has_errors = gz_group_measure(group, &measure);
	gz_page_gain_table(summary, group, out);
	if (has_errors)
		add_errors(summary, group, charts, out);
	gz_page_time_table(summary, group, out);
	if (has_errors) /* else they are the first chart */
		add_boxes(summary, group, charts, "wide", out);
	gz_page_cast_table(summary, group, out);
	add_maps(summary, group, charts, out);
}

static void add_growth(const struct gz_summary *summary, const struct gz_charts *charts,
		       struct gz_text *out)
{
	char name[GZ_NAMES_SIZE];
	if (summary->scaling_count == 0)
		return;
	gz_text_add(out, "<section id=\"growth\">\n<h2>How cost grows</h2>\n");
	for (size_t i = 0; i < summary->scaling_count; i++) {
		if (gz_growth_chart_name(summary, i, name))
			gz_page_figure(charts, name, "wide",
				       "How the time of a frame grows, both axes logarithmic. "
				       "Before each name its exponent.",
				       out);
	}
	gz_page_growth_table(summary, out);
	gz_text_add(out, "</section>\n");
}

static void add_head(const struct gz_summary *summary, struct gz_text *out)
{
	char words[GZ_NAMES_SIZE];
	gz_group_words(summary->study, &summary->groups[0], words);
	gz_text_add(out, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
			 "<meta name=\"viewport\" content=\"width=device-width, "
			 "initial-scale=1\">\n"
			 "<meta name=\"color-scheme\" content=\"light dark\">\n"
			 "<meta name=\"generator\" content=\"");
	gz_text_add_escaped(out, summary->study->machine.program);
	gz_text_add(out, "\">\n<link rel=\"icon\" href=\"data:,\">\n<title>");
	gz_text_add_escaped(out, words);
	gz_text_add(out, ": what each saving costs</title>\n<style>\n%s</style>\n</head>\n<body>\n",
		    gz_report_css);
}

static void add_contents(const struct gz_summary *summary, struct gz_text *out)
{
	char words[GZ_NAMES_SIZE];
	if (summary->group_count < 2)
		return;
	gz_text_add(out, "<nav aria-label=\"sections\"><ul>\n");
	for (size_t i = 0; i < summary->group_count; i++) {
		gz_group_words(summary->study, &summary->groups[i], words);
		gz_text_add(out, "<li><a href=\"#group-%zu\">", i + 1);
		gz_text_add_escaped(out, words);
		gz_text_add(out, "</a></li>\n");
	}
	if (summary->scaling_count > 0)
		gz_text_add(out, "<li><a href=\"#growth\">How cost grows</a></li>\n");
	gz_text_add(out, "<li><a href=\"#origin\">What it ran on</a></li>\n</ul></nav>\n");
}

static void add_group(const struct gz_summary *summary, size_t place,
		      const struct gz_charts *charts, struct gz_text *out)
{
	char words[GZ_NAMES_SIZE];
	const struct gz_group *group = &summary->groups[place];
	gz_group_words(summary->study, group, words);
	gz_text_add(out, "<section id=\"group-%zu\">\n", place + 1);
	if (place > 0) { /* the first is the page's own head */
		gz_text_add(out, "<h2>");
		gz_text_add_escaped(out, words);
		gz_text_add(out, "</h2>\n");
		add_answer(summary, group, charts, out);
	}
	add_details(summary, group, charts, out);
	gz_text_add(out, "</section>\n");
}

void gz_page_write(const struct gz_summary *summary, const struct gz_charts *charts,
		   struct gz_text *out)
{
	char words[GZ_NAMES_SIZE];
	gz_group_words(summary->study, &summary->groups[0], words);
	add_head(summary, out);
	gz_text_add(out, "<header>\n");
	add_banners(summary, charts, out);
	gz_text_add(out, "<h1>");
	gz_text_add_escaped(out, words);
	gz_text_add(out, "</h1>\n");
	add_answer(summary, &summary->groups[0], charts, out);
	gz_text_add(out, "</header>\n<main>\n");
	add_contents(summary, out);
	for (size_t i = 0; i < summary->group_count; i++)
		add_group(summary, i, charts, out);
	add_growth(summary, charts, out);
	gz_page_origin(summary, out);
	gz_text_add(out, "</main>\n</body>\n</html>\n");
}
