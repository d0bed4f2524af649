/**
 * @file
 * Filling an HTML template from JSON: a part of Mustache (mustache(5)), with formats for numbers.
 *
 *   {{key}}          a text, escaped; "a.b" goes into objects, "." is the item itself
 *   {{key|format}}   a number, by one of the formats below; "–" where it is missing or null
 *   {{#key}}…{{/key}}  once for each item of a list; once, within it, for an object; once for
 *                      anything else but null, false, "" and what is missing
 *   {{^key}}…{{/key}}  where {{#key}} would write nothing
 *   {{<name}}…{{/name}}  a fragment: nothing here
 *   {{>name}}        the fragment of that name
 *
 * Formats: "number" (three digits that count), "percent" (of a share), "times", "millions",
 * "similarity" (four digits behind the point), "svg" (a text in base64 for a data URL) and "html"
 * (a text as it is).
 *
 * A key that the innermost object lacks is looked for in those around it.
 */
#ifndef GZ_BENCH_REPORT_TEMPLATE_H
#define GZ_BENCH_REPORT_TEMPLATE_H

#include <jansson.h>
#include <stdbool.h>

#include "base/text.h"

/** Bytes of a number that gz_template_number() prints, with its NUL. */
#define GZ_TEMPLATE_NUMBER_SIZE 64

/**
 * Fill a template.
 *
 * @param page  the template, NUL-terminated UTF-8
 * @param data  an object
 * @param out   appended to; failed is set where memory runs out
 * @return false where the template itself is wrong: a tag does not end, a section is not closed, a
 *         format or fragment is unknown
 */
bool gz_template_fill(const char *page, const json_t *data, struct gz_text *out);

/** Print a number with three digits that count and @p unit behind it; "–" for NaN, "∞" for
 *  infinity. From 999.5 to 1e9 it has no power of ten. */
void gz_template_number(double value, const char *unit, char out_text[GZ_TEMPLATE_NUMBER_SIZE]);

/** Append @p plain for HTML and XML: & < > " ' are escaped, and control characters are left out. */
void gz_text_add_escaped(struct gz_text *text, const char *plain);

/** Append @p size bytes in base64 (RFC 4648, section 4). */
void gz_text_add_base64(struct gz_text *text, const void *bytes, size_t size);

#endif
