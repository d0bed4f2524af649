#include "bench/report/page_parts.h"

#include <string.h>

/* style.css, embedded. */
extern const char gz_style_css[];

void gz_page_set_text(json_t *object, const char *key, const char *text)
{
	json_object_set_new(object, key, json_string_nocheck(text));
}

void gz_page_set_style(json_t *page)
{
	gz_page_set_text(page, "style", gz_style_css);
}

json_t *gz_page_figure(const struct gz_charts *charts, const char *name, const char *class_name,
		       const char *caption)
{
	const struct gz_chart *chart = gz_charts_find(charts, name);
	if (!chart || !chart->svg[GZ_CANVAS_WIDE])
		return NULL;
	const bool small = strcmp(class_name, "small") == 0;
	const char *wide = chart->svg[GZ_CANVAS_WIDE];
	const char *narrow = chart->svg[GZ_CANVAS_NARROW]; /* maps are the same on both */
	json_t *figure = json_object();
	gz_page_set_text(figure, "class", class_name);
	gz_page_set_text(figure, "caption", caption);
	gz_page_set_text(figure, "narrow", narrow ? narrow : wide);
	gz_page_set_text(figure, "shown", small && narrow ? narrow : wide);
	json_object_set_new(figure, "small", json_boolean(small));
	return figure;
}

void gz_page_add_fact(json_t *facts, const char *name, const char *text)
{
	json_t *fact = json_object();
	if (text[0]) {
		gz_page_set_text(fact, "name", name);
		gz_page_set_text(fact, "text", text);
		json_array_append(facts, fact);
	}
	json_decref(fact);
}
