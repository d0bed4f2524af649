/**
 * @file
 * Packing keys and values into a message's fixed buffer; for this folder's encoders. Nothing
 * allocates. Once the message is full everything further is ignored and gz_pack_end() says so.
 * Integers take MessagePack's shortest form and reals keep their C type, so that equal messages are
 * equal bytes. A real that is not finite becomes nil.
 */
#ifndef GZ_PROTOCOL_WIRE_PACK_H
#define GZ_PROTOCOL_WIRE_PACK_H

#include <msgpack.h>

#include "protocol/wire.h"

struct gz_pack {
	msgpack_packer packer;
	struct gz_wire_message *message;
	bool full;
};

/** Begin an empty @p message. */
void gz_pack_begin(struct gz_pack *pack, struct gz_wire_message *message);

/** GZ_OK, or GZ_ERR_FULL with the message emptied. */
enum gz_result gz_pack_end(struct gz_pack *pack);

/* Values. A NULL key packs the value alone: an element of an array. */
void gz_pack_map(struct gz_pack *pack, const char *key, size_t pairs);
void gz_pack_array(struct gz_pack *pack, const char *key, size_t elements);
void gz_pack_nil(struct gz_pack *pack, const char *key);
/** Bytes that are not UTF-8 are packed as '?', because readers refuse a whole message for them. */
void gz_pack_text(struct gz_pack *pack, const char *key, const char *text);
void gz_pack_bool(struct gz_pack *pack, const char *key, bool value);
void gz_pack_int(struct gz_pack *pack, const char *key, int64_t value);
void gz_pack_uint(struct gz_pack *pack, const char *key, uint64_t value);
/** Always 9 bytes, whatever the value. */
void gz_pack_fixed_int64(struct gz_pack *pack, const char *key, int64_t value);
void gz_pack_float(struct gz_pack *pack, const char *key, float value);
void gz_pack_double(struct gz_pack *pack, const char *key, double value);

/** @p count doubles as an array. */
void gz_pack_doubles(struct gz_pack *pack, const char *key, const double *values, size_t count);
/** [x, y], or nil where either is not finite. */
void gz_pack_point(struct gz_pack *pack, const char *key, struct gz_point point);
/** "norm_pos": the point with Pupil's origin, bottom left. */
void gz_pack_norm_pos(struct gz_pack *pack, struct gz_point point);
/** Host time as seconds. Equal times give equal bytes: readers match messages by them. */
void gz_pack_time(struct gz_pack *pack, const char *key, int64_t time_ns);

#endif
