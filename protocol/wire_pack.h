/**
 * @file
 * Packs keys and values into a message; wire_values.h, which says what holds for all of them,
 * includes this. The functions are here so that a compiler that knows the key also knows its length
 * and copies it by one or two moves: a gaze message has two hundred pieces, for each sample. For
 * the same reason msgpack-c does not do it. The formats are those of MessagePack's specification,
 * section "Formats".
 */
#ifndef GZ_PROTOCOL_WIRE_PACK_H
#define GZ_PROTOCOL_WIRE_PACK_H

#include <endian.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "protocol/wire.h"

/* Only where a call is inlined are its key and its size constants. */
#define GZ_PACK_INLINE static inline __attribute__((always_inline))

/*
 * Each gz_put_ function writes at @p to, where there must be room, and returns where the next piece
 * goes. Pieces of a message that is known to fit are written without looking for room before each.
 */

/** A format and a number of @p size bytes, which is a constant for each caller. */
GZ_PACK_INLINE unsigned char *gz_put_number(unsigned char *to, unsigned char format, uint64_t value,
					    size_t size)
{
	value = htobe64(value);
	*to = format;
	memcpy(to + 1, (const unsigned char *)&value + sizeof value - size, size);
	return to + 1 + size;
}

/** Text of less than 32 bytes, such as a key. */
GZ_PACK_INLINE unsigned char *gz_put_short_text(unsigned char *to, const char *text)
{
	const size_t length = strlen(text);
	*to = (unsigned char)(0xa0 | length);
	memcpy(to + 1, text, length);
	return to + 1 + length;
}

GZ_PACK_INLINE unsigned char *gz_put_nil(unsigned char *to)
{
	*to = 0xc0;
	return to + 1;
}

GZ_PACK_INLINE unsigned char *gz_put_bool(unsigned char *to, bool value)
{
	*to = value ? 0xc3 : 0xc2;
	return to + 1;
}

/** A map of less than 16 pairs. */
GZ_PACK_INLINE unsigned char *gz_put_small_map(unsigned char *to, size_t pairs)
{
	*to = (unsigned char)(0x80 | pairs);
	return to + 1;
}

/** An array of less than 16 elements. */
GZ_PACK_INLINE unsigned char *gz_put_small_array(unsigned char *to, size_t elements)
{
	*to = (unsigned char)(0x90 | elements);
	return to + 1;
}

/** A real; nil if it is not finite. */
GZ_PACK_INLINE unsigned char *gz_put_float(unsigned char *to, float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof bits);
	return isfinite(value) ? gz_put_number(to, 0xca, bits, 4) : gz_put_nil(to);
}

/** A real; nil if it is not finite. */
GZ_PACK_INLINE unsigned char *gz_put_double(unsigned char *to, double value)
{
	uint64_t bits;
	memcpy(&bits, &value, sizeof bits);
	return isfinite(value) ? gz_put_number(to, 0xcb, bits, 8) : gz_put_nil(to);
}

/** Most bytes that an integer takes. */
#define GZ_PUT_INT_SIZE 9

/** An integer in its shortest form. */
unsigned char *gz_put_uint(unsigned char *to, uint64_t value);
unsigned char *gz_put_int(unsigned char *to, int64_t value);

/** A message being packed. */
struct gz_pack {
	struct gz_wire_message *message;
	bool full;
};

/* Each function packs a key and a value. With a NULL key the value alone is packed, as an element
 * of an array. */

/** Pack text. Bytes that are not UTF-8 become '?', because readers would refuse the whole message.
 */
void gz_pack_text(struct gz_pack *pack, const char *key, const char *text);

/** Room for @p size further bytes; NULL if the message is full. */
GZ_PACK_INLINE unsigned char *gz_pack_room(struct gz_pack *pack, size_t size)
{
	struct gz_wire_message *message = pack->message;
	if (pack->full || size > sizeof message->bytes - message->size) {
		pack->full = true;
		return NULL;
	}
	unsigned char *room = message->bytes + message->size;
	message->size += size;
	return room;
}

/** Room for a key and then @p size bytes of its value; at the value. NULL if the message is full.
 */
GZ_PACK_INLINE unsigned char *gz_pack_keyed_room(struct gz_pack *pack, const char *key, size_t size)
{
	if (!key)
		return gz_pack_room(pack, size);
	size_t length = strlen(key);
	if (length >= 32) {
		gz_pack_text(pack, NULL, key);
		return gz_pack_room(pack, size);
	}
	unsigned char *room = gz_pack_room(pack, 1 + length + size);
	return room ? gz_put_short_text(room, key) : NULL;
}

/** A key, and a value that is one byte. */
GZ_PACK_INLINE void gz_pack_byte(struct gz_pack *pack, const char *key, unsigned byte)
{
	unsigned char *room = gz_pack_keyed_room(pack, key, 1);
	if (room)
		*room = (unsigned char)byte;
}

/** A key, a format and a number of @p size bytes, which is a constant for each caller. */
GZ_PACK_INLINE void gz_pack_number(struct gz_pack *pack, const char *key, unsigned char format,
				   uint64_t value, size_t size)
{
	unsigned char *room = gz_pack_keyed_room(pack, key, 1 + size);
	if (room)
		gz_put_number(room, format, value, size);
}

GZ_PACK_INLINE void gz_pack_map(struct gz_pack *pack, const char *key, size_t pairs)
{
	if (pairs < 16)
		gz_pack_byte(pack, key, 0x80 | (unsigned)pairs);
	else if (pairs <= UINT16_MAX)
		gz_pack_number(pack, key, 0xde, pairs, 2);
	else
		gz_pack_number(pack, key, 0xdf, pairs, 4);
}

GZ_PACK_INLINE void gz_pack_array(struct gz_pack *pack, const char *key, size_t elements)
{
	if (elements < 16)
		gz_pack_byte(pack, key, 0x90 | (unsigned)elements);
	else if (elements <= UINT16_MAX)
		gz_pack_number(pack, key, 0xdc, elements, 2);
	else
		gz_pack_number(pack, key, 0xdd, elements, 4);
}

GZ_PACK_INLINE void gz_pack_nil(struct gz_pack *pack, const char *key)
{
	gz_pack_byte(pack, key, 0xc0);
}

GZ_PACK_INLINE void gz_pack_bool(struct gz_pack *pack, const char *key, bool value)
{
	gz_pack_byte(pack, key, value ? 0xc3 : 0xc2);
}

GZ_PACK_INLINE void gz_pack_float(struct gz_pack *pack, const char *key, float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof bits);
	if (isfinite(value))
		gz_pack_number(pack, key, 0xca, bits, 4);
	else
		gz_pack_nil(pack, key);
}

GZ_PACK_INLINE void gz_pack_double(struct gz_pack *pack, const char *key, double value)
{
	uint64_t bits;
	memcpy(&bits, &value, sizeof bits);
	if (isfinite(value))
		gz_pack_number(pack, key, 0xcb, bits, 8);
	else
		gz_pack_nil(pack, key);
}

#endif
