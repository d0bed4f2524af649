/**
 * @file
 * Keys of CurveZMQ as text: 32 bytes in 40 characters of Z85 (ZeroMQ RFC 32/Z85). What key files
 * and lists of keys may hold. Bytes to meaning, no I/O; the bytes are untrusted.
 */
#ifndef GZ_PROTOCOL_KEY_H
#define GZ_PROTOCOL_KEY_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"

/** A key's characters. */
#define GZ_KEY_LENGTH 40

/** Room for a key with its NUL. */
#define GZ_KEY_TEXT_SIZE (GZ_KEY_LENGTH + 1)

/** Most keys in a list. Chosen: some times what a laboratory has machines. */
#define GZ_KEYS_MAX 256

/** Longest comment or list of hosts beside a key, with its NUL, bytes. */
#define GZ_KEY_NAME_SIZE 128

/** A public key and its secret half. */
struct gz_key_pair {
	char public_text[GZ_KEY_TEXT_SIZE];
	char secret_text[GZ_KEY_TEXT_SIZE];
};

/** A public key and whose it is. */
struct gz_known_key {
	char key[GZ_KEY_TEXT_SIZE];
	char name[GZ_KEY_NAME_SIZE]; /**< AUTHORIZED: the comment; SERVERS: host names, separated
					by commas */
};

/** Keys of others. */
struct gz_key_list {
	size_t count;
	struct gz_known_key items[GZ_KEYS_MAX];
};

/** What a line of a list holds. */
enum gz_key_list_kind {
	GZ_KEY_LIST_AUTHORIZED, /**< "KEY [comment]": clients that are let in */
	GZ_KEY_LIST_SERVERS,    /**< "HOST[,HOST...] KEY [comment]": daemons on other machines */
};

/** Whether the @p length bytes at @p text are a key: 40 characters of Z85 of which each five fit
 *  into 32 bits. Such a text and its 32 bytes determine each other. */
bool gz_key_valid(const char *text, size_t length);

/**
 * Read a file of one key: a line with it, and lines that are empty or begin with '#'. (No key
 * begins with '#': five characters that do are beyond 32 bits.)
 *
 * @param name            of the file, for messages
 * @param text, size      its content, untrusted
 * @param[out] out_key    with its NUL; written on success only
 * @retval GZ_ERR_FORMAT  none, several, or something else; logged with file, line and remedy, and
 *                        without what was read, which may be a secret
 */
enum gz_result gz_key_parse(const char *name, const char *text, size_t size,
			    const struct gz_log *log, char out_key[GZ_KEY_TEXT_SIZE]);

/**
 * Read a list: a key a line, and lines that are empty or begin with '#'. An empty list is a list.
 *
 * @param name            of the file, for messages
 * @param text, size      its content, untrusted
 * @param[out] out_list   on failure of no meaning
 * @retval GZ_ERR_FORMAT  a line is something else, or gives a server another key than a line before
 *                        it; logged with file, line and remedy
 * @retval GZ_ERR_FULL    more than GZ_KEYS_MAX; logged
 */
enum gz_result gz_key_list_parse(const char *name, const char *text, size_t size,
				 enum gz_key_list_kind kind, const struct gz_log *log,
				 struct gz_key_list *out_list);

/** The entry with @p key, or NULL. */
const struct gz_known_key *gz_key_list_find_key(const struct gz_key_list *list, const char *key);

/** The entry that names @p host, of any case, or NULL. */
const struct gz_known_key *gz_key_list_find_host(const struct gz_key_list *list, const char *host);

#endif
