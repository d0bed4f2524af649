/**
 * @file
 * Where key files are, and reading and writing them safely: what others could read is no secret,
 * and what others could write is nobody's key.
 */
#ifndef GZ_PROTOCOL_KEY_FILE_H
#define GZ_PROTOCOL_KEY_FILE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/key.h"

#define GZ_SERVER_KEY_FILE      "server_key"      /**< the daemon's secret key */
#define GZ_CLIENT_KEY_FILE      "client_key"      /**< a client's secret key */
#define GZ_AUTHORIZED_KEYS_FILE "authorized_keys" /**< the daemon's: GZ_KEY_LIST_AUTHORIZED */
#define GZ_KNOWN_SERVERS_FILE   "known_servers"   /**< a client's: GZ_KEY_LIST_SERVERS */

/** Largest key file or list that is read, bytes. Chosen: GZ_KEYS_MAX of the longest lines, and
 * some comments. */
#define GZ_KEY_FILE_SIZE_MAX 65536

/**
 * The user's directory for keys: $XDG_CONFIG_HOME/gazecast, else ~/.config/gazecast.
 *
 * @retval GZ_ERR_NOT_FOUND  neither variable is set
 * @retval GZ_ERR_FULL       @p size is too small
 */
enum gz_result gz_key_directory(char *text, size_t size);

/**
 * Where the file @p name is.
 *
 * @param directory  the one to look in; NULL or empty: the user's directory, then gazecast in the
 *                   system's configuration directory
 * @param[out] path  where it is, or where it was looked for first
 * @retval GZ_ERR_NOT_FOUND  it is nowhere
 * @retval GZ_ERR_FULL       @p size is too small
 */
enum gz_result gz_key_file_find(const char *directory, const char *name, char *path, size_t size);

/**
 * Read a key file or list whole. Refused, as by ssh: what is no regular file, what somebody but its
 * owner may write, or what is in a directory that somebody else may write; what belongs to neither
 * us nor root; and a @p secret that group or others may read.
 *
 * @param[out] out_text  owned by the caller, who frees it
 * @retval GZ_ERR_NOT_FOUND  no such file; not logged
 * @retval GZ_ERR_ACCESS     refused; logged with the remedy
 * @retval GZ_ERR_FORMAT     longer than GZ_KEY_FILE_SIZE_MAX; logged
 * @retval GZ_ERR_IO         cannot be read; logged
 * @retval GZ_ERR_NO_MEM     no room
 */
enum gz_result gz_key_file_read(const char *path, bool secret, const struct gz_log *log,
				char **out_text, size_t *out_size);

/** gz_key_file_read() of a secret and gz_key_parse(). What was read is wiped from memory. */
enum gz_result gz_key_file_read_secret(const char *path, const struct gz_log *log,
				       char out_key[GZ_KEY_TEXT_SIZE]);

/** gz_key_file_read() of a list and gz_key_list_parse(). */
enum gz_result gz_key_file_read_list(const char *path, enum gz_key_list_kind kind,
				     const struct gz_log *log, struct gz_key_list *out_list);

/**
 * The public key of the daemon on @p host, from GZ_KNOWN_SERVERS_FILE.
 *
 * @param directory     as for gz_key_file_find()
 * @param host          name or address as the file has it, without brackets
 * @param[out] out_key  written only on GZ_OK
 * @retval GZ_ERR_NOT_FOUND  there is no such file, or it does not name the host; not logged
 * @return else as gz_key_file_find() and gz_key_file_read_list()
 */
enum gz_result gz_key_file_find_server(const char *directory, const char *host,
				       const struct gz_log *log, char out_key[GZ_KEY_TEXT_SIZE]);

/** Make @p directory and what is missing above it, 0700. GZ_ERR_IO is logged;
 *  GZ_ERR_FULL: the path is longer than 4095 bytes. */
enum gz_result gz_key_directory_make(const char *directory, const struct gz_log *log);

/**
 * Write a new file; never over an existing one.
 *
 * @param secret  0600, else 0644
 * @retval GZ_ERR_BUSY  there is one already; logged
 * @retval GZ_ERR_IO    cannot be written; logged, and nothing is left behind
 */
enum gz_result gz_key_file_write(const char *path, bool secret, const char *text,
				 const struct gz_log *log);

#endif
