/**
 * @file
 * Keys of CurveZMQ: as text (32 bytes in 40 characters of Z85, ZeroMQ RFC 32/Z85), lists of keys,
 * and the files that hold them. A file is read only if it is safe: a secret that others can read is
 * not a secret, and a list that others can write lets them add keys.
 *
 * gz_key_valid() and the parsers do no I/O; what they read is untrusted.
 */
#ifndef GZ_PROTOCOL_KEY_H
#define GZ_PROTOCOL_KEY_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"

/** Characters of a key. */
#define GZ_KEY_LENGTH 40

/** Size of a key with its NUL, bytes. */
#define GZ_KEY_TEXT_SIZE (GZ_KEY_LENGTH + 1)

/** Most keys in a list. Chosen: several times the machines of a laboratory. */
#define GZ_KEYS_MAX 256

/** Size of the longest comment or list of hosts beside a key, with its NUL, bytes. */
#define GZ_KEY_NAME_SIZE 128

/** Largest key file or list that is read, bytes. Chosen: GZ_KEYS_MAX of the longest lines, and some
 * comments. */
#define GZ_KEY_FILE_SIZE_MAX 65536

#define GZ_SERVER_KEY_FILE      "server_key"      /**< the daemon's secret key */
#define GZ_CLIENT_KEY_FILE      "client_key"      /**< a client's secret key */
#define GZ_AUTHORIZED_KEYS_FILE "authorized_keys" /**< the daemon's: GZ_KEY_LIST_AUTHORIZED */
#define GZ_KNOWN_SERVERS_FILE   "known_servers"   /**< a client's: GZ_KEY_LIST_SERVERS */

/** A public key and its secret key. */
struct gz_key_pair {
	char public_text[GZ_KEY_TEXT_SIZE];
	char secret_text[GZ_KEY_TEXT_SIZE];
};

/** A public key and its owner. */
struct gz_known_key {
	char key[GZ_KEY_TEXT_SIZE];
	char name[GZ_KEY_NAME_SIZE]; /**< AUTHORIZED: the comment; SERVERS: host names, separated
					by commas */
};

/** A list of public keys. */
struct gz_key_list {
	size_t count;
	struct gz_known_key items[GZ_KEYS_MAX];
};

/** What the lines of a list hold. */
enum gz_key_list_kind {
	GZ_KEY_LIST_AUTHORIZED, /**< "KEY [comment]": clients that may connect */
	GZ_KEY_LIST_SERVERS,    /**< "HOST[,HOST...] KEY [comment]": daemons on other machines */
};

/**
 * Whether the @p length bytes at @p text are a key: 40 characters of Z85, each group of five of
 * which fits into 32 bits. Such a text and its 32 bytes determine each other.
 */
bool gz_key_valid(const char *text, size_t length);

/**
 * Parse a file that holds one key: a line with the key, and lines that are empty or begin with '#'.
 * (No key begins with '#': a group of five characters that does is beyond 32 bits.)
 *
 * @param name            the file's name in messages
 * @param text, size      its content, untrusted
 * @param[out] out_key    with its NUL; written on success only
 * @retval GZ_ERR_FORMAT  no key, several keys, or something else; logged with file, line and
 * remedy, but without the text, which may be a secret
 */
enum gz_result gz_key_parse(const char *name, const char *text, size_t size,
			    const struct gz_log *log, char out_key[GZ_KEY_TEXT_SIZE]);

/**
 * Parse a list: one key per line, and lines that are empty or begin with '#'. The list may be
 * empty.
 *
 * @param name            the file's name in messages
 * @param text, size      its content, untrusted
 * @param[out] out_list   unspecified on failure
 * @retval GZ_ERR_FORMAT  a line is something else, or gives a server another key than an earlier
 *                        line does; logged with file, line and remedy
 * @retval GZ_ERR_FULL    more than GZ_KEYS_MAX keys; logged
 */
enum gz_result gz_key_list_parse(const char *name, const char *text, size_t size,
				 enum gz_key_list_kind kind, const struct gz_log *log,
				 struct gz_key_list *out_list);

/** The entry with @p key, or NULL. */
const struct gz_known_key *gz_key_list_find_key(const struct gz_key_list *list, const char *key);

/** The entry that names @p host, ignoring case, or NULL. */
const struct gz_known_key *gz_key_list_find_host(const struct gz_key_list *list, const char *host);

/**
 * The user's configuration directory, which holds the keys: $XDG_CONFIG_HOME/gazecast, otherwise
 * ~/.config/gazecast.
 *
 * @retval GZ_ERR_NOT_FOUND  neither XDG_CONFIG_HOME nor HOME is an absolute path
 * @retval GZ_ERR_FULL       @p size is too small
 */
enum gz_result gz_key_directory(char *text, size_t size);

/**
 * Find the key file @p name.
 *
 * @param directory  where it must be; if NULL or empty, it may be in the user's directory or, after
 *                   that, in gazecast in the system's configuration directory
 * @param[out] path  the file's path, or the first path that was tried
 * @retval GZ_ERR_NOT_FOUND  there is no such file
 * @retval GZ_ERR_FULL       @p size is too small
 */
enum gz_result gz_key_file_find(const char *directory, const char *name, char *path, size_t size);

/**
 * Read a whole key file or list. As in ssh, these are refused: a path that is not a regular file; a
 * file that anybody but its owner can write, or in a directory that anybody else can write; a file
 * that belongs neither to this user nor to root; and, if @p secret, a file that group or others can
 * read.
 *
 * @param[out] out_text  owned by the caller, who frees it
 * @retval GZ_ERR_NOT_FOUND  no such file; not logged
 * @retval GZ_ERR_ACCESS     refused; logged with the remedy
 * @retval GZ_ERR_FORMAT     longer than GZ_KEY_FILE_SIZE_MAX; logged
 * @retval GZ_ERR_IO         the file cannot be read; logged
 * @retval GZ_ERR_NO_MEM     out of memory
 */
enum gz_result gz_key_file_read(const char *path, bool secret, const struct gz_log *log,
				char **out_text, size_t *out_size);

/**
 * Read a file that holds one secret key. The text that was read is wiped from memory.
 *
 * @param[out] out_key  with its NUL; written on success only
 * @return GZ_OK, or what gz_key_file_read() or gz_key_parse() returns
 */
enum gz_result gz_key_file_read_secret(const char *path, const struct gz_log *log,
				       char out_key[GZ_KEY_TEXT_SIZE]);

/**
 * Read a file that holds a list of keys.
 *
 * @param[out] out_list  unspecified on failure
 * @return GZ_OK, or what gz_key_file_read() or gz_key_list_parse() returns
 */
enum gz_result gz_key_file_read_list(const char *path, enum gz_key_list_kind kind,
				     const struct gz_log *log, struct gz_key_list *out_list);

/**
 * Find the public key of the daemon on @p host in GZ_KNOWN_SERVERS_FILE.
 *
 * @param directory     as for gz_key_file_find()
 * @param host          name or address as the file gives it, without brackets
 * @param[out] out_key  with its NUL; written on success only
 * @retval GZ_ERR_NOT_FOUND  there is no such file, or it does not name the host; not logged
 * @return otherwise what gz_key_file_find() or gz_key_file_read_list() returns
 */
enum gz_result gz_key_file_find_server(const char *directory, const char *host,
				       const struct gz_log *log, char out_key[GZ_KEY_TEXT_SIZE]);

/**
 * Make @p directory and its missing parents, with mode 0700.
 *
 * @retval GZ_ERR_IO    it cannot be made; logged
 * @retval GZ_ERR_FULL  the path is longer than 4095 bytes; not logged
 */
enum gz_result gz_key_directory_make(const char *directory, const struct gz_log *log);

/**
 * Write a new file; an existing file is never overwritten.
 *
 * @param secret  whether the mode is 0600 instead of 0644
 * @retval GZ_ERR_BUSY  the file exists; logged
 * @retval GZ_ERR_IO    the file cannot be written; logged, and nothing is left behind
 */
enum gz_result gz_key_file_write(const char *path, bool secret, const char *text,
				 const struct gz_log *log);

#endif
