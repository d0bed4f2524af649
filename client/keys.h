/**
 * @file
 * Keys for a daemon on another machine, which serves with `tcp = curve` (docs/security.md): the
 * client's own pair, and the public key by which the daemon proves itself. `gazectl keygen` makes
 * the files.
 *
 * gz_client_open(), gz_stream_open() and gz_control_open() find keys by themselves, as
 * gz_keys_find() does with the usual places; the functions that take a struct gz_keys use these.
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
	char public_key[GZ_KEYS_TEXT_SIZE]; /**< the client's; the daemon's authorized_keys has it
					     */
	char secret_key[GZ_KEYS_TEXT_SIZE]; /**< the client's */
	char server_key[GZ_KEYS_TEXT_SIZE]; /**< the daemon's public key */
};

/**
 * Find the keys for @p endpoint: the daemon's by the endpoint's host in the file `known_servers`,
 * the client's in the file `client_key`.
 *
 * @param endpoint    ZeroMQ endpoint; only those of tcp:// have keys. NULL has none
 * @param directory   where the files are; NULL or empty: $XDG_CONFIG_HOME/gazecast, else
 *                    ~/.config/gazecast, and what is not there in gazecast of the system's
 *                    configuration directory
 * @param server_key  the daemon's public key, in place of known_servers; NULL or empty: from there
 * @param[out] out_keys  written on GZ_OK only
 * @retval GZ_OK             use these
 * @retval GZ_ERR_NOT_FOUND  no daemon with keys is known at this endpoint: connect without; not
 *                           logged
 * @retval GZ_ERR_INVAL      @p server_key is no key; logged
 * @retval GZ_ERR_ACCESS     a file is unsafe, or the client's key is missing where the daemon's is
 *                           known; logged with the remedy
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
