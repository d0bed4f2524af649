/**
 * @file
 * Inspecting an encoded message with msgpack-c alone, without the decoders of protocol/.
 */
#ifndef GZ_TESTS_PROTOCOL_UNPACKED_H
#define GZ_TESTS_PROTOCOL_UNPACKED_H

#include <math.h>
#include <msgpack.h>
#include <stdio.h>
#include <string.h>

#include "protocol/wire.h"

/** Unpack a whole message, which must be one map. msgpack_unpacked_destroy() frees it. */
static inline const msgpack_object *unpack_map(const struct gz_wire_message *message,
					       msgpack_unpacked *unpacked)
{
	size_t offset = 0;
	msgpack_unpacked_init(unpacked);
	assert_int_equal(gz_wire_check(message->bytes, message->size), GZ_OK);
	assert_int_equal(
		msgpack_unpack_next(unpacked, (const char *)message->bytes, message->size, &offset),
		MSGPACK_UNPACK_SUCCESS);
	assert_int_equal(offset, message->size);
	assert_int_equal(unpacked->data.type, MSGPACK_OBJECT_MAP);
	return &unpacked->data;
}

/** The value of @p key, which must exist. */
static inline const msgpack_object *value_of(const msgpack_object *map, const char *key)
{
	assert_int_equal(map->type, MSGPACK_OBJECT_MAP);
	for (uint32_t i = 0; i < map->via.map.size; i++) {
		const msgpack_object *name = &map->via.map.ptr[i].key;
		if (name->via.str.size == strlen(key) &&
		    memcmp(name->via.str.ptr, key, strlen(key)) == 0)
			return &map->via.map.ptr[i].val;
	}
	fail_msg("no key %s", key);
	return NULL;
}

static inline bool has_key(const msgpack_object *map, const char *key)
{
	assert_int_equal(map->type, MSGPACK_OBJECT_MAP);
	for (uint32_t i = 0; i < map->via.map.size; i++) {
		const msgpack_object *name = &map->via.map.ptr[i].key;
		if (name->via.str.size == strlen(key) &&
		    memcmp(name->via.str.ptr, key, strlen(key)) == 0)
			return true;
	}
	return false;
}

/** Check that the keys in order, separated by blanks, are @p expected. */
static inline void assert_keys(const msgpack_object *map, const char *expected)
{
	char keys[1024] = "";
	size_t length = 0;
	assert_int_equal(map->type, MSGPACK_OBJECT_MAP);
	for (uint32_t i = 0; i < map->via.map.size; i++) {
		const msgpack_object *key = &map->via.map.ptr[i].key;
		assert_int_equal(key->type, MSGPACK_OBJECT_STR);
		length += (size_t)snprintf(keys + length, sizeof keys - length, "%s%.*s",
					   i ? " " : "", (int)key->via.str.size, key->via.str.ptr);
	}
	assert_string_equal(keys, expected);
}

static inline void assert_text(const msgpack_object *object, const char *expected)
{
	char text[GZ_WIRE_MESSAGE_SIZE];
	assert_int_equal(object->type, MSGPACK_OBJECT_STR);
	snprintf(text, sizeof text, "%.*s", (int)object->via.str.size, object->via.str.ptr);
	assert_string_equal(text, expected);
}

static inline void assert_number(const msgpack_object *object, double expected)
{
	double number = NAN;
	if (object->type == MSGPACK_OBJECT_POSITIVE_INTEGER)
		number = (double)object->via.u64;
	else if (object->type == MSGPACK_OBJECT_NEGATIVE_INTEGER)
		number = (double)object->via.i64;
	else if (object->type == MSGPACK_OBJECT_FLOAT32 || object->type == MSGPACK_OBJECT_FLOAT64)
		number = object->via.f64;
	if (!(number == expected))
		fail_msg("%.17g (type %d) is not %.17g", number, (int)object->type, expected);
}

static inline void assert_numbers(const msgpack_object *object, const double *expected,
				  size_t count)
{
	assert_int_equal(object->type, MSGPACK_OBJECT_ARRAY);
	assert_int_equal(object->via.array.size, count);
	for (size_t i = 0; i < count; i++)
		assert_number(&object->via.array.ptr[i], expected[i]);
}

static inline void assert_nil(const msgpack_object *object)
{
	assert_int_equal(object->type, MSGPACK_OBJECT_NIL);
}

/** Check that every real in it, at any depth, is finite. */
static inline void assert_all_finite(const msgpack_object *object)
{
	if (object->type == MSGPACK_OBJECT_FLOAT32 || object->type == MSGPACK_OBJECT_FLOAT64)
		assert_true(isfinite(object->via.f64));
	for (uint32_t i = 0; object->type == MSGPACK_OBJECT_ARRAY && i < object->via.array.size;
	     i++)
		assert_all_finite(&object->via.array.ptr[i]);
	for (uint32_t i = 0; object->type == MSGPACK_OBJECT_MAP && i < object->via.map.size; i++)
		assert_all_finite(&object->via.map.ptr[i].val);
}

#endif
