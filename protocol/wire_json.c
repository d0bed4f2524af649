#include "protocol/wire_json.h"

#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "base/utf8.h"

static const char truncated[] = "\"truncated\":true";

/* JSON being printed. What does not fit is not printed at all. */
struct json_text {
	char *text;
	size_t size; /* usable bytes, without the NUL and what the end of the object needs */
	size_t used;
	bool full;
};

static void append_json_bytes(struct json_text *json, const char *bytes, size_t count)
{
	if (json->full || count > json->size - json->used) {
		json->full = true;
		return;
	}
	memcpy(json->text + json->used, bytes, count);
	json->used += count;
}

static void add_json_text(struct json_text *json, const char *text)
{
	append_json_bytes(json, text, strlen(text));
}

static void add_json_string(struct json_text *json, const msgpack_object_str *string)
{
	const char *bytes = string->ptr;
	char escape[8];
	add_json_text(json, "\"");
	for (size_t i = 0; i < string->size && !json->full;) {
		size_t length = gz_utf8_length(bytes + i, string->size - i);
		if (length == 0)
			add_json_text(json, "?");
		else if (bytes[i] == '"' || bytes[i] == '\\')
			append_json_bytes(json, (char[]) { '\\', bytes[i] }, 2);
		else if ((unsigned char)bytes[i] < ' ')
			append_json_bytes(
				json, escape,
				(size_t)snprintf(escape, sizeof escape, "\\u%04x", bytes[i]));
		else
			append_json_bytes(json, string->ptr + i, length);
		i += length ? length : 1;
	}
	add_json_text(json, "\"");
}

static void add_json_number(struct json_text *json, double value)
{
	char number[32];
	if (!isfinite(value)) {
		add_json_text(json, "null");
		return;
	}
	snprintf(number, sizeof number, "%.15g", value);
	if (strtod(number, NULL) != value)
		snprintf(number, sizeof number, "%.17g", value);
	gz_number_normalise_point(number);
	add_json_text(json, number);
}

/* The depth is that of the message, which gz_wire_check() bounds. */
static void add_json_value(struct json_text *json, const msgpack_object *value);

static void add_json_array(struct json_text *json, const msgpack_object_array *array)
{
	add_json_text(json, "[");
	for (uint32_t i = 0; i < array->size && !json->full; i++) {
		if (i > 0)
			add_json_text(json, ",");
		add_json_value(json, &array->ptr[i]);
	}
	add_json_text(json, "]");
}

static void add_json_pair(struct json_text *json, const msgpack_object_kv *pair, bool first)
{
	if (!first)
		add_json_text(json, ",");
	add_json_string(json, &pair->key.via.str);
	add_json_text(json, ":");
	add_json_value(json, &pair->val);
}

static void add_json_map(struct json_text *json, const msgpack_object_map *map)
{
	bool first = true;
	add_json_text(json, "{");
	for (uint32_t i = 0; i < map->size && !json->full; i++) {
		if (map->ptr[i].key.type != MSGPACK_OBJECT_STR)
			continue;
		add_json_pair(json, &map->ptr[i], first);
		first = false;
	}
	add_json_text(json, "}");
}

static void add_json_value(struct json_text *json, const msgpack_object *value)
{
	char number[32];
	switch (value->type) {
	case MSGPACK_OBJECT_BOOLEAN:
		add_json_text(json, value->via.boolean ? "true" : "false");
		return;
	case MSGPACK_OBJECT_POSITIVE_INTEGER:
		snprintf(number, sizeof number, "%" PRIu64, value->via.u64);
		add_json_text(json, number);
		return;
	case MSGPACK_OBJECT_NEGATIVE_INTEGER:
		snprintf(number, sizeof number, "%" PRId64, value->via.i64);
		add_json_text(json, number);
		return;
	case MSGPACK_OBJECT_FLOAT32:
	case MSGPACK_OBJECT_FLOAT64:
		add_json_number(json, value->via.f64);
		return;
	case MSGPACK_OBJECT_STR:
		add_json_string(json, &value->via.str);
		return;
	case MSGPACK_OBJECT_ARRAY:
		add_json_array(json, &value->via.array);
		return;
	case MSGPACK_OBJECT_MAP:
		add_json_map(json, &value->via.map);
		return;
	default: /* nil, binary, extension */
		add_json_text(json, "null");
	}
}

static bool is_known_key(const msgpack_object *key, const char *const *known)
{
	for (; *known; known++) {
		if (key->via.str.size == strlen(*known) &&
		    memcmp(key->via.str.ptr, *known, key->via.str.size) == 0)
			return true;
	}
	return false;
}

void gz_wire_print_json(const msgpack_object *map, const char *const *known, char *text,
			size_t size)
{
	const size_t end_size = sizeof "," + sizeof truncated + sizeof "}";
	struct json_text json = { .text = text, .size = size - end_size, .used = 0 };
	bool some_left_out = false;
	add_json_text(&json, "{");
	for (uint32_t i = 0; i < map->via.map.size; i++) {
		const msgpack_object_kv *pair = &map->via.map.ptr[i];
		size_t before = json.used;
		if (pair->key.type != MSGPACK_OBJECT_STR || is_known_key(&pair->key, known))
			continue;
		add_json_pair(&json, pair, before == 1);
		if (json.full)
			json.used = before;
		some_left_out |= json.full;
		json.full = false;
	}
	json.size += end_size - 1;
	if (some_left_out) {
		add_json_text(&json, json.used > 1 ? "," : "");
		add_json_text(&json, truncated);
	}
	add_json_text(&json, "}");
	text[json.used > sizeof "{}" - 1 ? json.used : 0] = '\0';
}
