#include "protocol/wire_pack.h"

#include <math.h>
#include <string.h>

#include "base/clock.h"

/* What msgpack-c calls with each piece; not 0 stops the value it is in the middle of. */
static int append(void *user, const char *bytes, size_t size)
{
	struct gz_pack *pack = user;
	struct gz_wire_message *message = pack->message;
	if (pack->full || size > sizeof message->bytes - message->size) {
		pack->full = true;
		return -1;
	}
	memcpy(message->bytes + message->size, bytes, size);
	message->size += size;
	return 0;
}

void gz_pack_begin(struct gz_pack *pack, struct gz_wire_message *message)
{
	message->size = 0;
	memset(message->pupil, 0, sizeof message->pupil);
	pack->message = message;
	pack->full = false;
	msgpack_packer_init(&pack->packer, pack, append);
}

enum gz_result gz_pack_end(struct gz_pack *pack)
{
	if (!pack->full)
		return GZ_OK;
	pack->message->size = 0;
	memset(pack->message->pupil, 0, sizeof pack->message->pupil);
	return GZ_ERR_FULL;
}

static void pack_key(struct gz_pack *pack, const char *key)
{
	if (key)
		msgpack_pack_str_with_body(&pack->packer, key, strlen(key));
}

void gz_pack_map(struct gz_pack *pack, const char *key, size_t pairs)
{
	pack_key(pack, key);
	msgpack_pack_map(&pack->packer, pairs);
}

void gz_pack_array(struct gz_pack *pack, const char *key, size_t elements)
{
	pack_key(pack, key);
	msgpack_pack_array(&pack->packer, elements);
}

void gz_pack_nil(struct gz_pack *pack, const char *key)
{
	pack_key(pack, key);
	msgpack_pack_nil(&pack->packer);
}

/* Bytes of the UTF-8 character at @p text, or 0 if none is there: RFC 3629, section 4. */
static size_t utf8_length(const unsigned char *text)
{
	unsigned char lead = text[0];
	if (lead < 0x80)
		return 1;
	size_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
	unsigned char low = 0x80, high = 0xbf; /* allowed in the second byte */
	if (lead < 0xc2 || lead > 0xf4)
		return 0;
	if (lead == 0xe0)
		low = 0xa0;
	else if (lead == 0xed)
		high = 0x9f;
	else if (lead == 0xf0)
		low = 0x90;
	else if (lead == 0xf4)
		high = 0x8f;
	if (text[1] < low || text[1] > high)
		return 0;
	for (size_t i = 2; i < length; i++)
		if ((text[i] & 0xc0) != 0x80)
			return 0;
	return length;
}

void gz_pack_text(struct gz_pack *pack, const char *key, const char *text)
{
	pack_key(pack, key);
	size_t left = strlen(text);
	msgpack_pack_str(&pack->packer, left);
	while (left > 0) {
		/* The final NUL is no continuation byte, so this never reads past it. */
		size_t length = utf8_length((const unsigned char *)text);
		if (length > 0)
			append(pack, text, length);
		else
			append(pack, "?", length = 1);
		text += length;
		left -= length;
	}
}

void gz_pack_bool(struct gz_pack *pack, const char *key, bool value)
{
	pack_key(pack, key);
	if (value)
		msgpack_pack_true(&pack->packer);
	else
		msgpack_pack_false(&pack->packer);
}

void gz_pack_int(struct gz_pack *pack, const char *key, int64_t value)
{
	pack_key(pack, key);
	msgpack_pack_int64(&pack->packer, value);
}

void gz_pack_uint(struct gz_pack *pack, const char *key, uint64_t value)
{
	pack_key(pack, key);
	msgpack_pack_uint64(&pack->packer, value);
}

void gz_pack_fixed_int64(struct gz_pack *pack, const char *key, int64_t value)
{
	pack_key(pack, key);
	msgpack_pack_fix_int64(&pack->packer, value);
}

void gz_pack_float(struct gz_pack *pack, const char *key, float value)
{
	pack_key(pack, key);
	if (isfinite(value))
		msgpack_pack_float(&pack->packer, value);
	else
		msgpack_pack_nil(&pack->packer);
}

void gz_pack_double(struct gz_pack *pack, const char *key, double value)
{
	pack_key(pack, key);
	if (isfinite(value))
		msgpack_pack_double(&pack->packer, value);
	else
		msgpack_pack_nil(&pack->packer);
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
