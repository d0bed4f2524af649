#include "protocol/wire_unpack.h"

#include <float.h>
#include <math.h>
#include <string.h>

void gz_unpack_begin(struct gz_unpack *unpack, const void *bytes, size_t size)
{
	*unpack = (struct gz_unpack) { .refused = true };
	msgpack_unpacked_init(&unpack->unpacked);
	if (gz_wire_check(bytes, size) != GZ_OK)
		return;
	size_t offset = 0;
	if (msgpack_unpack_next(&unpack->unpacked, bytes, size, &offset) != MSGPACK_UNPACK_SUCCESS)
		return;
	if (unpack->unpacked.data.type != MSGPACK_OBJECT_MAP)
		return;
	unpack->map = &unpack->unpacked.data;
	unpack->refused = false;
}

enum gz_result gz_unpack_end(struct gz_unpack *unpack)
{
	msgpack_unpacked_destroy(&unpack->unpacked);
	unpack->map = NULL;
	return unpack->refused ? GZ_ERR_PROTOCOL : GZ_OK;
}

static bool text_equals(const msgpack_object *object, const char *text)
{
	return object->type == MSGPACK_OBJECT_STR && object->via.str.size == strlen(text) &&
	       memcmp(object->via.str.ptr, text, object->via.str.size) == 0;
}

/* A whole number of one digit is as good as its text: Pupil Capture before 2.0 numbers eyes so. */
static bool key_equals(const msgpack_object *object, const char *key)
{
	if (object->type == MSGPACK_OBJECT_POSITIVE_INTEGER)
		return object->via.u64 <= 9 && key[0] == '0' + (char)object->via.u64 &&
		       key[1] == '\0';
	return text_equals(object, key);
}

const msgpack_object *gz_unpack_find(const msgpack_object *map, const char *key)
{
	if (!map)
		return NULL;
	for (uint32_t i = 0; i < map->via.map.size; i++) {
		const msgpack_object_kv *pair = &map->via.map.ptr[i];
		if (key_equals(&pair->key, key))
			return pair->val.type == MSGPACK_OBJECT_NIL ? NULL : &pair->val;
	}
	return NULL;
}

static const msgpack_object *find_type(struct gz_unpack *unpack, const msgpack_object *map,
				       const char *key, msgpack_object_type type)
{
	const msgpack_object *value = gz_unpack_find(map, key);
	if (value && value->type != type) {
		unpack->refused = true;
		return NULL;
	}
	return value;
}

const msgpack_object *gz_unpack_map(struct gz_unpack *unpack, const msgpack_object *map,
				    const char *key)
{
	return find_type(unpack, map, key, MSGPACK_OBJECT_MAP);
}

const msgpack_object *gz_unpack_array(struct gz_unpack *unpack, const msgpack_object *map,
				      const char *key)
{
	return find_type(unpack, map, key, MSGPACK_OBJECT_ARRAY);
}

void gz_unpack_text(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		    char *out_text, size_t size)
{
	const msgpack_object *value = find_type(unpack, map, key, MSGPACK_OBJECT_STR);
	if (!value)
		return;
	size_t length = value->via.str.size;
	if (length >= size || (length > 0 && memchr(value->via.str.ptr, '\0', length))) {
		unpack->refused = true;
		return;
	}
	if (length > 0)
		memcpy(out_text, value->via.str.ptr, length);
	out_text[length] = '\0';
}

void gz_unpack_bool(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		    bool *out_value)
{
	const msgpack_object *value = find_type(unpack, map, key, MSGPACK_OBJECT_BOOLEAN);
	if (value)
		*out_value = value->via.boolean;
}

void gz_unpack_int64(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		     int64_t *out_value)
{
	const msgpack_object *value = gz_unpack_find(map, key);
	if (!value)
		return;
	if (value->type == MSGPACK_OBJECT_NEGATIVE_INTEGER)
		*out_value = value->via.i64;
	else if (value->type == MSGPACK_OBJECT_POSITIVE_INTEGER && value->via.u64 <= INT64_MAX)
		*out_value = (int64_t)value->via.u64;
	else
		unpack->refused = true;
}

void gz_unpack_uint64(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		      uint64_t *out_value)
{
	const msgpack_object *value = find_type(unpack, map, key, MSGPACK_OBJECT_POSITIVE_INTEGER);
	if (value)
		*out_value = value->via.u64;
}

/* @return false if @p value is no number; NaN is one. */
static bool as_number(const msgpack_object *value, double *out_number)
{
	switch (value->type) {
	case MSGPACK_OBJECT_POSITIVE_INTEGER:
		*out_number = (double)value->via.u64;
		return true;
	case MSGPACK_OBJECT_NEGATIVE_INTEGER:
		*out_number = (double)value->via.i64;
		return true;
	case MSGPACK_OBJECT_FLOAT32:
	case MSGPACK_OBJECT_FLOAT64:
		*out_number = value->via.f64;
		return true;
	default:
		return false;
	}
}

/* @return whether there was a number within the range. */
static bool find_number(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
			double min, double max, double *out_number)
{
	const msgpack_object *value = gz_unpack_find(map, key);
	double number;
	if (!value)
		return false;
	if (!as_number(value, &number) || number < min || number > max) {
		unpack->refused = true;
		return false;
	}
	if (isnan(number))
		return false;
	*out_number = number;
	return true;
}

void gz_unpack_double(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		      double min, double max, double *out_value)
{
	find_number(unpack, map, key, min, max, out_value);
}

void gz_unpack_float(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		     double min, double max, float *out_value)
{
	double number;
	if (find_number(unpack, map, key, fmax(min, -FLT_MAX), fmin(max, FLT_MAX), &number))
		*out_value = (float)number;
}

bool gz_unpack_doubles(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		       double *out_values, size_t count)
{
	const msgpack_object *array = gz_unpack_array(unpack, map, key);
	if (!array)
		return false;
	double numbers[4];
	bool good = array->via.array.size == count && count <= 4;
	for (size_t i = 0; good && i < count; i++)
		good = as_number(&array->via.array.ptr[i], &numbers[i]) && !isinf(numbers[i]);
	if (!good) {
		unpack->refused = true;
		return false;
	}
	for (size_t i = 0; i < count; i++)
		if (isnan(numbers[i]))
			return false;
	memcpy(out_values, numbers, count * sizeof *out_values);
	return true;
}

/* @return false if it was missing; a place that no float can hold is refused. */
static bool find_point(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		       double out_xy[2])
{
	double xy[2];
	if (!gz_unpack_doubles(unpack, map, key, xy, 2))
		return false;
	if (fabs(xy[0]) > FLT_MAX || fabs(xy[1]) > FLT_MAX) {
		unpack->refused = true;
		return false;
	}
	out_xy[0] = xy[0];
	out_xy[1] = xy[1];
	return true;
}

bool gz_unpack_point(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		     struct gz_point *out_point)
{
	double xy[2];
	if (!find_point(unpack, map, key, xy))
		return false;
	*out_point = (struct gz_point) { (float)xy[0], (float)xy[1] };
	return true;
}

bool gz_unpack_norm_pos(struct gz_unpack *unpack, const msgpack_object *map,
			struct gz_point *out_point)
{
	double xy[2];
	if (!find_point(unpack, map, "norm_pos", xy))
		return false;
	*out_point = (struct gz_point) { (float)xy[0], (float)(1 - xy[1]) };
	return true;
}

bool gz_unpack_time(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		    int64_t unit_ns, int64_t *out_time_ns)
{
	static const double ns_max = 9.2e18; /* within int64_t, so that rounding stays inside too */
	double limit = ns_max / (double)unit_ns;
	double number;
	if (!find_number(unpack, map, key, -limit, limit, &number))
		return false;
	*out_time_ns = llround(number * (double)unit_ns);
	return true;
}

int gz_unpack_name(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		   const char *(*name_of)(int), int count)
{
	const msgpack_object *value = find_type(unpack, map, key, MSGPACK_OBJECT_STR);
	if (!value)
		return -1;
	for (int i = 0; i < count; i++)
		if (text_equals(value, name_of(i)))
			return i;
	unpack->refused = true;
	return -1;
}
