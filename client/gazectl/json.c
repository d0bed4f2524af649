#include "client/gazectl/json.h"

#include <inttypes.h>
#include <math.h>

/* Bytes of the UTF-8 sequence at @p s, 0 where it is none (RFC 3629, section 4). */
static int utf8_length(const unsigned char *s)
{
	static const struct {
		unsigned char first, last; /* of the first byte */
		unsigned char low, high;   /* of the second */
		int length;
	} rows[] = {
		{ 0xC2, 0xDF, 0x80, 0xBF, 2 }, { 0xE0, 0xE0, 0xA0, 0xBF, 3 },
		{ 0xE1, 0xEC, 0x80, 0xBF, 3 }, { 0xED, 0xED, 0x80, 0x9F, 3 },
		{ 0xEE, 0xEF, 0x80, 0xBF, 3 }, { 0xF0, 0xF0, 0x90, 0xBF, 4 },
		{ 0xF1, 0xF3, 0x80, 0xBF, 4 }, { 0xF4, 0xF4, 0x80, 0x8F, 4 },
	};
	if (s[0] < 0x80)
		return 1;
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		if (s[0] < rows[i].first || s[0] > rows[i].last)
			continue;
		if (s[1] < rows[i].low || s[1] > rows[i].high)
			return 0;
		for (int k = 2; k < rows[i].length; k++)
			if ((s[k] & 0xC0) != 0x80)
				return 0;
		return rows[i].length;
	}
	return 0;
}

static void put_text(FILE *out, const char *text)
{
	const unsigned char *s = (const unsigned char *)text;
	fputc('"', out);
	while (*s) {
		int length = utf8_length(s);
		if (length == 0)
			fputs("\\ufffd", out);
		else if (*s == '"' || *s == '\\')
			fprintf(out, "\\%c", *s);
		else if (*s < 0x20 || *s == 0x7F)
			fprintf(out, "\\u%04x", *s);
		else
			fwrite(s, 1, (size_t)length, out);
		s += length ? length : 1;
	}
	fputc('"', out);
}

static void new_line(struct gz_json *json)
{
	fprintf(json->out, "\n%*s", 2 * json->depth, "");
}

static void begin_value(struct gz_json *json, const char *key)
{
	if (json->continued)
		fputc(',', json->out);
	if (json->depth > 0)
		new_line(json);
	if (key) {
		put_text(json->out, key);
		fputs(": ", json->out);
	}
	json->continued = true;
}

static void begin_level(struct gz_json *json, const char *key, char bracket)
{
	begin_value(json, key);
	fputc(bracket, json->out);
	json->depth++;
	json->continued = false;
}

static void end_level(struct gz_json *json, char bracket)
{
	json->depth--;
	if (json->continued)
		new_line(json);
	fputc(bracket, json->out);
	json->continued = true;
	if (json->depth == 0)
		fputc('\n', json->out);
}

void gz_json_begin(struct gz_json *json, const char *key)
{
	begin_level(json, key, '{');
}

void gz_json_end(struct gz_json *json)
{
	end_level(json, '}');
}

void gz_json_begin_list(struct gz_json *json, const char *key)
{
	begin_level(json, key, '[');
}

void gz_json_end_list(struct gz_json *json)
{
	end_level(json, ']');
}

void gz_json_text(struct gz_json *json, const char *key, const char *text)
{
	begin_value(json, key);
	put_text(json->out, text);
}

void gz_json_double(struct gz_json *json, const char *key, double value)
{
	begin_value(json, key);
	if (isfinite(value))
		fprintf(json->out, "%.12g", value);
	else
		fputs("null", json->out);
}

void gz_json_int(struct gz_json *json, const char *key, int64_t value)
{
	begin_value(json, key);
	fprintf(json->out, "%" PRId64, value);
}

void gz_json_uint(struct gz_json *json, const char *key, uint64_t value)
{
	begin_value(json, key);
	fprintf(json->out, "%" PRIu64, value);
}

void gz_json_bool(struct gz_json *json, const char *key, bool value)
{
	begin_value(json, key);
	fputs(value ? "true" : "false", json->out);
}

void gz_json_display(struct gz_json *json, const char *key, const struct gz_display *display)
{
	gz_json_begin(json, key);
	gz_json_begin_list(json, "px");
	gz_json_int(json, NULL, display->px[0]);
	gz_json_int(json, NULL, display->px[1]);
	gz_json_end_list(json);
	gz_json_begin_list(json, "mm");
	gz_json_double(json, NULL, display->mm[0]);
	gz_json_double(json, NULL, display->mm[1]);
	gz_json_end_list(json);
	gz_json_double(json, "distance_mm", display->distance_mm);
	gz_json_end(json);
}
