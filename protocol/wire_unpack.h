/**
 * @file
 * Taking values by key out of a received map; for this folder's decoders. A missing key, nil and a
 * NaN leave the output as it is; a value of another type or out of range marks the message as
 * refused, which the decoder asks for once at its end.
 */
#ifndef GZ_PROTOCOL_WIRE_UNPACK_H
#define GZ_PROTOCOL_WIRE_UNPACK_H

#include <msgpack.h>

#include "protocol/wire.h"

struct gz_unpack {
	msgpack_unpacked unpacked;
	const msgpack_object *map; /**< the message itself */
	bool refused;
};

/**
 * Check and unpack a message, which must be a map. Always pair with gz_unpack_end(), which frees.
 */
void gz_unpack_begin(struct gz_unpack *unpack, const void *bytes, size_t size);

/** GZ_OK, or GZ_ERR_PROTOCOL if anything was refused. */
enum gz_result gz_unpack_end(struct gz_unpack *unpack);

/** The value of @p key, or NULL if it is missing or nil. A key of one digit may also be a number.
 * NULL for a NULL @p map: an absent map has no keys. */
const msgpack_object *gz_unpack_find(const msgpack_object *map, const char *key);

/** As gz_unpack_find() for a map, an array. */
const msgpack_object *gz_unpack_map(struct gz_unpack *unpack, const msgpack_object *map,
				    const char *key);
const msgpack_object *gz_unpack_array(struct gz_unpack *unpack, const msgpack_object *map,
				      const char *key);

/** Text of at most @p size - 1 bytes without a NUL. */
void gz_unpack_text(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		    char *out_text, size_t size);
/** true or false; integers are no booleans. */
void gz_unpack_bool(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		    bool *out_value);
/** An integer within the type; a real is none. */
void gz_unpack_int64(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		     int64_t *out_value);
void gz_unpack_uint64(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		      uint64_t *out_value);

/** A number of either kind within [min, max]. */
void gz_unpack_double(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		      double min, double max, double *out_value);
void gz_unpack_float(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		     double min, double max, float *out_value);
/** @p count numbers, at most 4; @return whether they were there. An array of another length is
 * refused. */
bool gz_unpack_doubles(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		       double *out_values, size_t count);

/** [x, y]. @return whether it was there */
bool gz_unpack_point(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		     struct gz_point *out_point);
/** "norm_pos", whose origin is bottom left. @return whether it was there */
bool gz_unpack_norm_pos(struct gz_unpack *unpack, const msgpack_object *map,
			struct gz_point *out_point);
/** A number of units of @p unit_ns as ns, rounded. @return whether it was there */
bool gz_unpack_time(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		    int64_t unit_ns, int64_t *out_time_ns);

/** One of the names that @p name_of gives to 0 … count - 1. @return its number, or -1 if it is
 *  missing or refused */
int gz_unpack_name(struct gz_unpack *unpack, const msgpack_object *map, const char *key,
		   const char *(*name_of)(int), int count);

#endif
