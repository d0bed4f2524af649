#include "protocol/wire_values.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/clock.h"
#include "base/utf8.h"

static void append_bytes(struct gz_pack *pack, const char *bytes, size_t size)
{
	unsigned char *room = gz_pack_room(pack, size);
	if (room)
		memcpy(room, bytes, size);
}

/* A key, and the head of a text of @p size bytes. */
static void pack_text_head(struct gz_pack *pack, const char *key, size_t size)
{
	if (size < 32)
		gz_pack_byte(pack, key, 0xa0 | (unsigned)size);
	else if (size <= UINT8_MAX)
		gz_pack_number(pack, key, 0xd9, size, 1);
	else if (size <= UINT16_MAX)
		gz_pack_number(pack, key, 0xda, size, 2);
	else
		gz_pack_number(pack, key, 0xdb, size, 4);
}

void gz_pack_begin(struct gz_pack *pack, struct gz_wire_message *message)
{
	message->size = 0;
	memset(message->pupil, 0, sizeof message->pupil);
	pack->message = message;
	pack->full = false;
}

enum gz_result gz_pack_end(struct gz_pack *pack)
{
	if (!pack->full)
		return GZ_OK;
	pack->message->size = 0;
	memset(pack->message->pupil, 0, sizeof pack->message->pupil);
	return GZ_ERR_FULL;
}

void gz_pack_text(struct gz_pack *pack, const char *key, const char *text)
{
	size_t left = strlen(text), good = 0;
	pack_text_head(pack, key, left);
	while (good < left) {
		if ((unsigned char)text[good] < 0x80) {
			good++;
			continue;
		}
		size_t length = gz_utf8_length(text + good, left - good);
		if (length > 0) {
			good += length;
			continue;
		}
		append_bytes(pack, text, good);
		append_bytes(pack, "?", 1);
		text += good + 1;
		left -= good + 1;
		good = 0;
	}
	append_bytes(pack, text, good);
}

static unsigned char *put_negative(unsigned char *to, int64_t value)
{
	if (value >= INT8_MIN)
		return gz_put_number(to, 0xd0, (uint64_t)value, 1);
	if (value >= INT16_MIN)
		return gz_put_number(to, 0xd1, (uint64_t)value, 2);
	if (value >= INT32_MIN)
		return gz_put_number(to, 0xd2, (uint64_t)value, 4);
	return gz_put_number(to, 0xd3, (uint64_t)value, 8);
}

unsigned char *gz_put_int(unsigned char *to, int64_t value)
{
	if (value >= 0)
		return gz_put_uint(to, (uint64_t)value);
	if (value < -32)
		return put_negative(to, value);
	*to = (unsigned char)value;
	return to + 1;
}

unsigned char *gz_put_uint(unsigned char *to, uint64_t value)
{
	if (value > UINT32_MAX)
		return gz_put_number(to, 0xcf, value, 8);
	if (value > UINT16_MAX)
		return gz_put_number(to, 0xce, value, 4);
	if (value > UINT8_MAX)
		return gz_put_number(to, 0xcd, value, 2);
	if (value >= 0x80)
		return gz_put_number(to, 0xcc, value, 1);
	*to = (unsigned char)value;
	return to + 1;
}

void gz_pack_int(struct gz_pack *pack, const char *key, int64_t value)
{
	unsigned char bytes[GZ_PUT_INT_SIZE];
	const size_t size = (size_t)(gz_put_int(bytes, value) - bytes);
	unsigned char *room = gz_pack_keyed_room(pack, key, size);
	if (room)
		memcpy(room, bytes, size);
}

void gz_pack_uint(struct gz_pack *pack, const char *key, uint64_t value)
{
	unsigned char bytes[GZ_PUT_INT_SIZE];
	const size_t size = (size_t)(gz_put_uint(bytes, value) - bytes);
	unsigned char *room = gz_pack_keyed_room(pack, key, size);
	if (room)
		memcpy(room, bytes, size);
}

void gz_pack_doubles(struct gz_pack *pack, const char *key, const double *values, size_t count)
{
	gz_pack_array(pack, key, count);
	for (size_t i = 0; i < count; i++)
		gz_pack_double(pack, NULL, values[i]);
}

void gz_pack_point(struct gz_pack *pack, const char *key, struct gz_point point)
{
	if (!isfinite(point.x) || !isfinite(point.y)) {
		gz_pack_nil(pack, key);
		return;
	}
	gz_pack_array(pack, key, 2);
	gz_pack_float(pack, NULL, point.x);
	gz_pack_float(pack, NULL, point.y);
}

void gz_pack_norm_pos(struct gz_pack *pack, struct gz_point point)
{
	if (!isfinite(point.x) || !isfinite(point.y)) {
		gz_pack_nil(pack, "norm_pos");
		return;
	}
	gz_pack_doubles(pack, "norm_pos", (double[]) { point.x, 1.0 - point.y }, 2);
}

void gz_pack_time(struct gz_pack *pack, const char *key, int64_t time_ns)
{
	gz_pack_double(pack, key, gz_ns_to_s(time_ns));
}

/* A walk over a MessagePack value (the format's specification, "Formats") without recursion: for
 * each open level the number of values to come is enough. */
struct value_walk {
	const unsigned char *next;
	size_t left;
	size_t depth;                     /* open levels */
	uint64_t owed[GZ_WIRE_DEPTH_MAX]; /* values to come on each of them */
};

static bool skip_bytes(struct value_walk *walk, uint64_t bytes)
{
	if (bytes > walk->left)
		return false;
	walk->next += bytes;
	walk->left -= bytes;
	return true;
}

/* Read a big-endian length of 1, 2 or 4 bytes. */
static bool read_big_endian_length(struct value_walk *walk, size_t bytes, uint64_t *out_length)
{
	if (bytes > walk->left)
		return false;
	uint64_t length = 0;
	for (size_t i = 0; i < bytes; i++)
		length = length << 8 | walk->next[i];
	*out_length = length;
	return skip_bytes(walk, bytes);
}

/* Open a map or array of @p values values, each of which has at least one byte. */
static bool enter_container(struct value_walk *walk, uint64_t values)
{
	if (values > walk->left || walk->depth == GZ_WIRE_DEPTH_MAX)
		return false;
	walk->owed[walk->depth++] = values;
	return true;
}

/* Skip a length of @p length_bytes bytes, then that many bytes and @p extra more. */
static bool skip_counted_bytes(struct value_walk *walk, size_t length_bytes, uint64_t extra)
{
	uint64_t length;
	return read_big_endian_length(walk, length_bytes, &length) &&
	       skip_bytes(walk, length + extra);
}

/* Read a count of @p length_bytes bytes and open a container of count times @p each values. */
static bool enter_counted_container(struct value_walk *walk, size_t length_bytes, uint64_t each)
{
	uint64_t count;
	return read_big_endian_length(walk, length_bytes, &count) &&
	       enter_container(walk, count * each);
}

/* The formats 0xc0 to 0xdf, whose first byte contains nothing but the format. */
static bool walk_tagged(struct value_walk *walk, unsigned char tag)
{
	switch (tag) {
	case 0xc0: /* nil, false, true */
	case 0xc2:
	case 0xc3:
		return true;
	case 0xc4: /* bin 8, 16, 32 */
	case 0xc5:
	case 0xc6:
		return skip_counted_bytes(walk, (size_t)1 << (tag - 0xc4), 0);
	case 0xc7: /* ext 8, 16, 32: a type byte and the data */
	case 0xc8:
	case 0xc9:
		return skip_counted_bytes(walk, (size_t)1 << (tag - 0xc7), 1);
	case 0xca: /* float 32, 64 */
	case 0xcb:
		return skip_bytes(walk, tag == 0xca ? 4 : 8);
	case 0xcc: /* uint 8, 16, 32, 64 */
	case 0xcd:
	case 0xce:
	case 0xcf:
		return skip_bytes(walk, UINT64_C(1) << (tag - 0xcc));
	case 0xd0: /* int 8, 16, 32, 64 */
	case 0xd1:
	case 0xd2:
	case 0xd3:
		return skip_bytes(walk, UINT64_C(1) << (tag - 0xd0));
	case 0xd4: /* fixext 1, 2, 4, 8, 16: a type byte and the data */
	case 0xd5:
	case 0xd6:
	case 0xd7:
	case 0xd8:
		return skip_bytes(walk, 1 + (UINT64_C(1) << (tag - 0xd4)));
	case 0xd9: /* str 8, 16, 32 */
	case 0xda:
	case 0xdb:
		return skip_counted_bytes(walk, (size_t)1 << (tag - 0xd9), 0);
	case 0xdc: /* array 16, 32 */
	case 0xdd:
		return enter_counted_container(walk, tag == 0xdc ? 2 : 4, 1);
	case 0xde: /* map 16, 32 */
	case 0xdf:
		return enter_counted_container(walk, tag == 0xde ? 2 : 4, 2);
	default: /* 0xc1 is never used */
		return false;
	}
}

static bool walk_value(struct value_walk *walk)
{
	if (walk->left == 0)
		return false;
	unsigned char tag = *walk->next;
	skip_bytes(walk, 1);
	if (tag < 0x80 || tag >= 0xe0) /* fixint */
		return true;
	if (tag < 0x90) /* fixmap */
		return enter_container(walk, 2 * (uint64_t)(tag & 0x0f));
	if (tag < 0xa0) /* fixarray */
		return enter_container(walk, tag & 0x0f);
	if (tag < 0xc0) /* fixstr */
		return skip_bytes(walk, tag & 0x1f);
	return walk_tagged(walk, tag);
}

enum gz_result gz_wire_check(const void *bytes, size_t size)
{
	struct value_walk walk = { .next = bytes, .left = size };
	if (!walk_value(&walk))
		return GZ_ERR_PROTOCOL;
	while (walk.depth > 0) {
		if (walk.owed[walk.depth - 1] == 0) {
			walk.depth--;
			continue;
		}
		walk.owed[walk.depth - 1]--;
		if (!walk_value(&walk))
			return GZ_ERR_PROTOCOL;
	}
	return walk.left == 0 ? GZ_OK : GZ_ERR_PROTOCOL;
}

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

/* A whole number of one digit counts as its text: Pupil Capture before 2.0 numbers the eyes so. */
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

bool gz_unpack_bool(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		    bool *out_value)
{
	const msgpack_object *value = find_type(unpack, map, key, MSGPACK_OBJECT_BOOLEAN);
	if (value)
		*out_value = value->via.boolean;
	return value != NULL;
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

/* @return whether @p value is a number; NaN is one */
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

/* @return whether there is a number, not NaN, within the range */
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

/* @return whether the point is there; one beyond the range of float is refused */
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
	static const double ns_max = 9.2e18; /* within int64_t, also after rounding */
	double limit = ns_max / (double)unit_ns;
	double number;
	if (!find_number(unpack, map, key, -limit, limit, &number))
		return false;
	*out_time_ns = llround(number * (double)unit_ns);
	return true;
}

/* The number of a name; -1: none has it. */
static int find_name(const msgpack_object *value, const char *(*name_of)(int), int count)
{
	int i = 0;
	while (i < count && !text_equals(value, name_of(i)))
		i++;
	return i < count ? i : -1;
}

bool gz_unpack_name_is_strange(const msgpack_object *map, const char *key,
			       const char *(*name_of)(int), int count)
{
	const msgpack_object *value = gz_unpack_find(map, key);
	return value && value->type == MSGPACK_OBJECT_STR && find_name(value, name_of, count) < 0;
}

int gz_unpack_name(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		   const char *(*name_of)(int), int count)
{
	const msgpack_object *value = find_type(unpack, map, key, MSGPACK_OBJECT_STR);
	if (!value)
		return -1;
	const int found = find_name(value, name_of, count);
	unpack->refused = unpack->refused || found < 0;
	return found;
}
