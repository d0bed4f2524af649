/**
 * @file
 * Keys and values of a message; for the encoders and decoders of this folder.
 *
 * Packing writes into the message's fixed buffer and allocates nothing. Once the message is full,
 * nothing more is packed and gz_pack_end() reports it. Integers take MessagePack's shortest form
 * and reals keep their C type, so equal messages are equal bytes. A real that is not finite becomes
 * nil.
 *
 * Unpacking takes values out of a received map by key. If a key is missing, nil or NaN, the output
 * does not change. A value of the wrong type or out of range marks the message as refused, which
 * gz_unpack_end() reports.
 */
#ifndef GZ_PROTOCOL_WIRE_VALUES_H
#define GZ_PROTOCOL_WIRE_VALUES_H

#include <msgpack.h>

#include "protocol/wire.h"
#include "protocol/wire_pack.h"

/** Begin an empty @p message. */
void gz_pack_begin(struct gz_pack *pack, struct gz_wire_message *message);

/** GZ_OK, or GZ_ERR_FULL with the message emptied. */
enum gz_result gz_pack_end(struct gz_pack *pack);

/* Further values, as in wire_pack.h. */
void gz_pack_int(struct gz_pack *pack, const char *key, int64_t value);
void gz_pack_uint(struct gz_pack *pack, const char *key, uint64_t value);

/** Pack an array of @p count doubles. */
void gz_pack_doubles(struct gz_pack *pack, const char *key, const double *values, size_t count);
/** Pack [x, y], or nil if either is not finite. */
void gz_pack_point(struct gz_pack *pack, const char *key, struct gz_point point);
/** Pack the key "norm_pos" and the point with Pupil's origin, bottom left; nil if it is not finite.
 */
void gz_pack_norm_pos(struct gz_pack *pack, struct gz_point point);
/** Pack a host time in seconds. Equal times give equal bytes: readers match messages by them. */
void gz_pack_time(struct gz_pack *pack, const char *key, int64_t time_ns);

/** A message being unpacked. */
struct gz_unpack {
	msgpack_unpacked unpacked;
	const msgpack_object *map; /**< the message itself */
	bool refused;
};

/** Check and unpack a message, which must be a map. gz_unpack_end() must follow: it frees. */
void gz_unpack_begin(struct gz_unpack *unpack, const void *bytes, size_t size);

/** GZ_OK, or GZ_ERR_PROTOCOL if anything was refused. */
enum gz_result gz_unpack_end(struct gz_unpack *unpack);

/** The value of @p key, or NULL if it is missing or nil, or @p map is NULL. A key of one digit may
 * also be a number. */
const msgpack_object *gz_unpack_find(const msgpack_object *map, const char *key);

/** The map or array that is the value of @p key, or NULL. */
const msgpack_object *gz_unpack_map(struct gz_unpack *unpack, const msgpack_object *map,
				    const char *key);
const msgpack_object *gz_unpack_array(struct gz_unpack *unpack, const msgpack_object *map,
				      const char *key);

/** Take a text of at most @p size - 1 bytes without a NUL in it. */
void gz_unpack_text(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		    char *out_text, size_t size);
/** Take true or false; integers are refused. @return whether it was there */
bool gz_unpack_bool(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		    bool *out_value);
/** Take an integer that fits into the type; reals are refused. */
void gz_unpack_int64(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		     int64_t *out_value);
void gz_unpack_uint64(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		      uint64_t *out_value);

/** Take a number, integer or real, within [min, max]. */
void gz_unpack_double(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		      double min, double max, double *out_value);
void gz_unpack_float(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		     double min, double max, float *out_value);
/** Take an array of exactly @p count numbers, at most 4. @return whether it was there */
bool gz_unpack_doubles(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		       double *out_values, size_t count);

/** Take a point [x, y]. @return whether it was there */
bool gz_unpack_point(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		     struct gz_point *out_point);
/** Take "norm_pos", whose origin is bottom left. @return whether it was there */
bool gz_unpack_norm_pos(struct gz_unpack *unpack, const msgpack_object *map,
			struct gz_point *out_point);
/** Take a time in units of @p unit_ns and round it to ns. @return whether it was there */
bool gz_unpack_time(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		    int64_t unit_ns, int64_t *out_time_ns);

/** Whether the key has a text that is none of the names which @p name_of gives to 0 … count - 1, as
 *  one of a later version may be. */
bool gz_unpack_name_is_strange(const msgpack_object *map, const char *key,
			       const char *(*name_of)(int), int count);
/** Take one of the names that @p name_of gives to 0 … count - 1. @return its number, or -1 if it is
 * missing or refused */
int gz_unpack_name(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		   const char *(*name_of)(int), int count);

#endif
