/**
 * @file
 * Keys for another gazed on another machine, which serves with `tcp = curve`: its public key by its
 * host in `known_servers`, ours in `client_key` (docs/man/gazectl.1, keygen). Pupil Capture has
 * none.
 */
#ifndef GZ_DRIVERS_PUPIL_KEYS_H
#define GZ_DRIVERS_PUPIL_KEYS_H

#include "base/log.h"
#include "base/result.h"
#include "protocol/key.h"

/** Keys of a connection. Wipe them when they are no longer needed. */
struct gz_pupil_keys {
	struct gz_key_pair own;
	char server[GZ_KEY_TEXT_SIZE]; /**< the other's public key; empty: connect without keys */
};

/**
 * Find the keys for @p host in the user's directory for keys, or the system's.
 *
 * @param host  as in an endpoint; an IPv6 address with its brackets
 * @param[out] out_keys  written on GZ_OK only; its server is empty where none is known
 * @retval GZ_ERR_ACCESS  the other's key is known and ours is missing, or a file is unsafe; logged
 *                        with the remedy
 * @retval GZ_ERR_FORMAT, GZ_ERR_IO, GZ_ERR_FULL, GZ_ERR_NO_MEM  a file cannot be read; logged
 */
enum gz_result gz_pupil_keys_find(const char *host, const struct gz_log *log,
				  struct gz_pupil_keys *out_keys);

/** Use @p keys on a ZeroMQ @p socket that is not yet connected. @return whether libzmq took them */
bool gz_pupil_keys_apply(const struct gz_pupil_keys *keys, void *socket);

#endif
