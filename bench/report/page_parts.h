/**
 * @file
 * What the pages of reports have in common: their style, and figures of charts.
 */
#ifndef GZ_BENCH_REPORT_PAGE_PARTS_H
#define GZ_BENCH_REPORT_PAGE_PARTS_H

#include <jansson.h>

#include "bench/report/charts.h"

/** Set a text. It may be cut within a character, so it is not checked for UTF-8. */
void gz_page_set_text(json_t *object, const char *key, const char *text);

/** Set the member "style" of a page: the rules of style.css. */
void gz_page_set_style(json_t *page);

/** A chart as the figure of a page; NULL if it was not drawn. @p class_name is one of the page:
 *  "small" ones say their caption in their title. The caller's: json_decref(). */
json_t *gz_page_figure(const struct gz_charts *charts, const char *name, const char *class_name,
		       const char *caption);

/** Append a fact, {name, text}, to a list; an empty text adds nothing. */
void gz_page_add_fact(json_t *facts, const char *name, const char *text);

#endif
