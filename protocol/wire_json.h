/**
 * @file
 * MessagePack values as JSON, for keys of clients that the daemon keeps without knowing them.
 */
#ifndef GZ_PROTOCOL_WIRE_JSON_H
#define GZ_PROTOCOL_WIRE_JSON_H

#include <msgpack.h>
#include <stddef.h>

/** Smallest size for gz_wire_print_json(). */
#define GZ_WIRE_JSON_SIZE_MIN 32

/**
 * Print the pairs of a map as a JSON object (RFC 8259), in their order.
 *
 * Numbers that are not finite, binary values and extensions become null. Keys that are no text are
 * left out; so are bytes that are not UTF-8 (each becomes "?") and control characters but for an
 * escape. Pairs for which there is no room are left out as a whole, and the object then ends with
 * "truncated": true.
 *
 * @param map       checked by gz_wire_check(), so its depth is bounded
 * @param known     keys to leave out; NULL ends the list
 * @param[out] text at most @p size bytes with a NUL; empty if no pair is left
 * @param size      GZ_WIRE_JSON_SIZE_MIN or more
 *
 * Threads: any. Does not allocate.
 */
void gz_wire_print_json(const msgpack_object *map, const char *const *known, char *text,
			size_t size);

#endif
