/**
 * @file
 * The clients' keys that are let in, from a file that may change at any time: as ssh's, it is read
 * again when it has.
 */
#ifndef GZ_DAEMON_AUTHORIZED_KEYS_H
#define GZ_DAEMON_AUTHORIZED_KEYS_H

#include <stdbool.h>
#include <sys/stat.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/key.h"

/** The keys. One thread at a time. */
struct gz_authorized_keys {
	char path[1024];
	const struct gz_log *log;
	struct gz_key_list list;
	struct stat read; /**< of the file when it was read; all zero: there was none */
	bool fresh;       /**< it had just been written then, and may change unseen */
};

/**
 * Read the file for the first time. That there is none is warned of: it may come later, and until
 * then nobody is let in.
 *
 * @param path  of the file; copied
 * @return GZ_OK, or as gz_key_file_read_list(); logged
 */
enum gz_result gz_authorized_keys_open(struct gz_authorized_keys *keys, const char *path,
				       const struct gz_log *log);

/**
 * The entry with @p key, or NULL. Looks whether the file has changed first: one system call. While
 * the file is damaged or unsafe nobody is let in; that is logged once for each change.
 *
 * @return valid until the next call
 */
const struct gz_known_key *gz_authorized_keys_find(struct gz_authorized_keys *keys,
						   const char *key);

#endif
