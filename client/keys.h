/**
 * @file
 * Keys for a daemon on another machine, which serves with `tcp = curve` (docs/security.md): the
 * client's own pair, and the public key with which the daemon proves its identity. `gazectl keygen`
 * makes the files.
 *
 * gz_client_open(), gz_stream_open() and gz_control_open() find keys by themselves in the default
 * places of gz_keys_find(). The functions that take a struct gz_keys use those keys only.
 */
#ifndef GZ_CLIENT_KEYS_H
#define GZ_CLIENT_KEYS_H

#include "base/log.h"
#include "base/result.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Room for a key of 40 characters of Z85 (ZeroMQ RFC 32/Z85) with its NUL. */
#define GZ_KEYS_TEXT_SIZE 41

/** Keys as text. Plain data; wipe it when it is no longer needed. */
struct gz_keys {
	char public_key[GZ_KEYS_TEXT_SIZE]; /**< the client's; listed in the daemon's
					       authorized_keys */
	char secret_key[GZ_KEYS_TEXT_SIZE]; /**< the client's */
	char server_key[GZ_KEYS_TEXT_SIZE]; /**< the daemon's public key */
};

/**
 * Find the keys for @p endpoint: the daemon's in the file `known_servers`, by the host of the
 * endpoint; the client's in the file `client_key`.
 *
 * @param endpoint    ZeroMQ endpoint; only tcp:// endpoints have keys. NULL has none
 * @param directory   directory of the files; NULL or empty: $XDG_CONFIG_HOME/gazecast, else
 *                    ~/.config/gazecast; a file that is missing there is looked for in the
 *                    directory gazecast of the system's configuration
 * @param server_key  the daemon's public key; NULL or empty: look it up in known_servers
 * @param log         borrowed; may be NULL
 * @param[out] out_keys  written on GZ_OK only
 * @retval GZ_OK             connect with these keys
 * @retval GZ_ERR_NOT_FOUND  no key is known for the daemon at this endpoint: connect without keys;
 *                           not logged
 * @retval GZ_ERR_INVAL      @p server_key is not a key; logged
 * @retval GZ_ERR_ACCESS     a file has unsafe permissions, or the daemon's key is known and the
 *                           client's is missing; logged with the remedy
 * @retval GZ_ERR_FORMAT, GZ_ERR_IO, GZ_ERR_FULL, GZ_ERR_NO_MEM  a file cannot be read; logged
 *
 * Threads: any.
 */
enum gz_result gz_keys_find(const char *endpoint, const char *directory, const char *server_key,
			    const struct gz_log *log, struct gz_keys *out_keys);

#ifdef __cplusplus
}
#endif

#endif
