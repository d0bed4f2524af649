#include "bench/report/template.h"

#include <limits.h>
#include <math.h>
#include <openssl/evp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Deepest nesting of sections, and longest name in a tag. Chosen: more than a page needs. */
enum { DEPTH_MAX = 16, NAME_SIZE = 96 };

/* ---- text ---- */

void gz_text_add_escaped(struct gz_text *text, const char *plain)
{
	for (; *plain; plain++) {
		switch (*plain) {
		case '&':
			gz_text_add(text, "&amp;");
			break;
		case '<':
			gz_text_add(text, "&lt;");
			break;
		case '>':
			gz_text_add(text, "&gt;");
			break;
		case '"':
			gz_text_add(text, "&quot;");
			break;
		case '\'':
			gz_text_add(text, "&#39;");
			break;
		default:
			if ((unsigned char)*plain >= ' ' || *plain == '\n' || *plain == '\t')
				gz_text_add_bytes(text, plain, 1);
		}
	}
}

void gz_text_add_base64(struct gz_text *text, const void *bytes, size_t size)
{
	const size_t room = 4 * ((size + 2) / 3) + 1;
	unsigned char *digits = size < INT_MAX / 2 ? malloc(room) : NULL;
	if (!digits) {
		text->failed = true;
		return;
	}
	const int length = EVP_EncodeBlock(digits, bytes, (int)size);
	gz_text_add_bytes(text, (const char *)digits, (size_t)length);
	free(digits);
}

void gz_template_number(double value, const char *unit, char out_text[GZ_TEMPLATE_NUMBER_SIZE])
{
	if (isnan(value))
		snprintf(out_text, GZ_TEMPLATE_NUMBER_SIZE, "–");
	else if (isinf(value))
		snprintf(out_text, GZ_TEMPLATE_NUMBER_SIZE, "∞");
	else if (fabs(value) >= 999.5 && fabs(value) < 1e9)
		snprintf(out_text, GZ_TEMPLATE_NUMBER_SIZE, "%.0f%s", value, unit);
	else
		snprintf(out_text, GZ_TEMPLATE_NUMBER_SIZE, "%.3g%s", value, unit);
}

/* ---- values ---- */

/* State while a template is filled: the enclosing objects, the innermost last. */
struct filling {
	const char *page; /* whole, for fragments */
	const json_t *scopes[DEPTH_MAX];
	size_t depth;
	struct gz_text *out;
};

/* The member of @p scope that a path names; NULL: there is none. */
static const json_t *find_member(const json_t *scope, const char *path)
{
	char key[NAME_SIZE];
	while (scope && *path) {
		const size_t length = strcspn(path, ".");
		snprintf(key, sizeof key, "%.*s", (int)length, path);
		scope = json_object_get(scope, key);
		path += length + (path[length] == '.');
	}
	return scope;
}

static const json_t *find_value(const struct filling *filling, const char *path)
{
	const json_t *value = NULL;
	if (strcmp(path, ".") == 0)
		return filling->scopes[filling->depth - 1];
	for (size_t i = filling->depth; i > 0 && !value; i--)
		value = find_member(filling->scopes[i - 1], path);
	return value;
}

/* Numbers as summaries write them: null for not measured, "inf" for infinity. */
static double number_of(const json_t *value)
{
	if (json_is_number(value))
		return json_number_value(value);
	return json_is_string(value) && strcmp(json_string_value(value), "inf") == 0 ? INFINITY
										     : NAN;
}

static void add_plain(const json_t *value, struct gz_text *out)
{
	if (json_is_string(value))
		gz_text_add_escaped(out, json_string_value(value));
	else if (json_is_integer(value))
		gz_text_add(out, "%lld", (long long)json_integer_value(value));
	else if (json_is_real(value))
		gz_text_add(out, "%.10g", json_real_value(value));
}

/* False: there is no such format. */
static bool add_formatted(const json_t *value, const char *format, struct gz_text *out)
{
	static const struct {
		const char *name, *unit;
		double factor;
	} formats[] = {
		{ "number", "", 1 },
		{ "percent", " %", 100 },
		{ "times", "×", 1 },
		{ "millions", "", 1e-6 },
	};
	char text[GZ_TEMPLATE_NUMBER_SIZE];
	const char *string = json_is_string(value) ? json_string_value(value) : "";
	for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++)
		if (strcmp(formats[i].name, format) == 0) {
			gz_template_number(number_of(value) * formats[i].factor, formats[i].unit,
					   text);
			gz_text_add(out, "%s", text);
			return true;
		}
	if (strcmp(format, "similarity") == 0) {
		if (json_is_number(value))
			gz_text_add(out, "%.4f", json_number_value(value));
		else
			gz_text_add(out, "–");
		return true;
	}
	if (strcmp(format, "svg") == 0) {
		gz_text_add_base64(out, string, strlen(string));
		return true;
	}
	gz_text_add_bytes(out, string, strlen(string));
	return strcmp(format, "html") == 0;
}

static bool add_value(const struct filling *filling, const char *tag)
{
	char path[NAME_SIZE];
	const char *bar = strchr(tag, '|');
	snprintf(path, sizeof path, "%.*s", (int)(bar ? bar - tag : NAME_SIZE - 1), tag);
	const json_t *value = find_value(filling, path);
	if (bar)
		return add_formatted(value, bar + 1, filling->out);
	add_plain(value, filling->out);
	return true;
}

/* ---- tags ---- */

/* The next tag from @p at on: where it begins and ends, its kind (one of "#^/<>", or 0) and its
 * name. False: there is none; a tag that does not end has an empty name. */
static bool next_tag(const char *at, const char **out_begin, const char **out_end, char *out_kind,
		     char out_name[NAME_SIZE])
{
	const char *begin = strstr(at, "{{");
	if (!begin)
		return false;
	const char *end = strstr(begin, "}}");
	const char *name = begin + 2 + (begin[2] && strchr("#^/<>", begin[2]) ? 1 : 0);
	*out_begin = begin;
	*out_kind = name > begin + 2 ? begin[2] : '\0';
	*out_end = end ? end + 2 : begin + strlen(begin);
	out_name[0] = '\0';
	if (end && end - name < NAME_SIZE)
		snprintf(out_name, NAME_SIZE, "%.*s", (int)(end - name), name);
	return true;
}

/* The closing tag of the section that begins before @p at: its begin, and the text after it. */
static const char *find_close(const char *at, const char *name, const char **out_behind)
{
	const char *begin, *end;
	char kind, here[NAME_SIZE];
	int open = 1;
	for (; next_tag(at, &begin, &end, &kind, here); at = end) {
		if (strcmp(here, name) != 0)
			continue;
		open += kind == '#' || kind == '^' || kind == '<';
		open -= kind == '/';
		if (open == 0) {
			*out_behind = end;
			return begin;
		}
	}
	return NULL;
}

static bool fill_range(struct filling *filling, const char *at, const char *stop);

static bool fill_within(struct filling *filling, const json_t *scope, const char *at,
			const char *stop)
{
	if (filling->depth == DEPTH_MAX)
		return false;
	filling->scopes[filling->depth++] = scope;
	const bool sound = fill_range(filling, at, stop);
	filling->depth--;
	return sound;
}

static bool has_something(const json_t *value)
{
	return value && !json_is_null(value) && !json_is_false(value) &&
	       (!json_is_array(value) || json_array_size(value) > 0) &&
	       (!json_is_string(value) || json_string_length(value) > 0);
}

static bool fill_section(struct filling *filling, char kind, const char *name, const char *at,
			 const char *stop)
{
	const json_t *value = find_value(filling, name);
	bool sound = true;
	if (kind == '<' || has_something(value) != (kind == '#'))
		return true;
	if (kind == '^' || !json_is_array(value))
		return fill_within(filling,
				   json_is_object(value) ? value
							 : filling->scopes[filling->depth - 1],
				   at, stop);
	for (size_t i = 0; i < json_array_size(value) && sound; i++)
		sound = fill_within(filling, json_array_get(value, i), at, stop);
	return sound;
}

static bool fill_fragment(struct filling *filling, const char *name)
{
	const char *begin, *end, *behind;
	char kind, here[NAME_SIZE];
	for (const char *at = filling->page; next_tag(at, &begin, &end, &kind, here); at = end) {
		if (kind != '<' || strcmp(here, name) != 0)
			continue;
		const char *close = find_close(end, name, &behind);
		return close &&
		       fill_within(filling, filling->scopes[filling->depth - 1], end, close);
	}
	return false;
}

static bool fill_range(struct filling *filling, const char *at, const char *stop)
{
	const char *begin, *end;
	char kind, name[NAME_SIZE];
	bool sound = true;
	while (sound && next_tag(at, &begin, &end, &kind, name) && begin < stop) {
		gz_text_add_bytes(filling->out, at, (size_t)(begin - at));
		at = end;
		if (!name[0] || kind == '/') {
			sound = false;
		} else if (kind == '>') {
			sound = fill_fragment(filling, name);
		} else if (!kind) {
			sound = add_value(filling, name);
		} else {
			const char *close = find_close(end, name, &at);
			sound = close && fill_section(filling, kind, name, end, close);
		}
	}
	if (sound)
		gz_text_add_bytes(filling->out, at, (size_t)(stop - at));
	return sound;
}

bool gz_template_fill(const char *page, const json_t *data, struct gz_text *out)
{
	struct filling filling = { .page = page, .scopes = { data }, .depth = 1, .out = out };
	return fill_range(&filling, page, page + strlen(page));
}
