/**
 * @file
 * Who is let in over TCP: the requests of the ZeroMQ Authentication Protocol, the list of clients'
 * keys, and a limit on how often one address is logged. The guard (guard.h) puts them together.
 */
#ifndef GZ_DAEMON_ADMISSION_H
#define GZ_DAEMON_ADMISSION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/stat.h>

#include "base/log.h"
#include "base/result.h"
#include "base/sizes.h"
#include "protocol/key.h"

/** Room for an address with its NUL: an IPv6 address with its interface. Longer ones are cut. */
#define GZ_ADDRESS_SIZE 64

/*
 * Authentication requests (ZeroMQ RFC 27/ZAP): may the peer with this key come in? Bytes to
 * meaning, no I/O. libzmq writes the requests, but parts of them come from the peer.
 */

/** Frames of a CURVE request after the empty delimiter frame: version, request id, domain, address,
 *  identity, mechanism, public key. */
#define GZ_ZAP_FRAMES 7

/** Longest request id, bytes. libzmq's is "1". */
#define GZ_ZAP_ID_SIZE_MAX 32

/** One frame as received. */
struct gz_zap_frame {
	const void *bytes;
	size_t size;
};

/** A request. */
struct gz_zap_request {
	size_t id_size;
	unsigned char id[GZ_ZAP_ID_SIZE_MAX]; /**< repeated in the reply */
	char address[GZ_ADDRESS_SIZE];        /**< printable; "?" if the request has none */
	char key[GZ_KEY_TEXT_SIZE]; /**< the peer's public key; the peer has proved that it
				       holds the secret half */
};

/**
 * Read one request.
 *
 * @param frames  all frames, untrusted; frames beyond GZ_ZAP_FRAMES may be left out
 * @param count   how many frames the request has
 * @param[out] out  @p id is filled on failure too, because a reply to it is owed; it is empty if
 *                  the request has none. The other fields are filled on success only.
 * @retval GZ_ERR_PROTOCOL  the frames are not those of a CURVE request, or the id is too long
 * @retval GZ_ERR_ACCESS    another version, a mechanism other than CURVE, or a key that is not 32
 *                          bytes long
 *
 * Threads: any.
 */
enum gz_result gz_zap_parse(const struct gz_zap_frame *frames, size_t count,
			    struct gz_zap_request *out);

/*
 * The keys of the clients that are let in. The file may change at any time and is then read again,
 * as ssh does with its authorized_keys.
 */

/** The keys. One thread at a time. */
struct gz_authorized_keys {
	char path[GZ_PATH_SIZE];
	const struct gz_log *log;
	struct gz_key_list list;
	struct stat read; /**< state of the file when it was last read; all zero: no file */
	bool fresh;       /**< the file had just been written then: a further change may not show */
};

/**
 * Read the file for the first time. A missing file is allowed, with a warning: it may appear later,
 * and until then no client is let in.
 *
 * @param path  of the file; copied
 * @param log   borrowed; must outlive @p keys
 * @retval GZ_OK        read, or there is no file yet
 * @retval GZ_ERR_FULL  @p path is too long
 * @return else as gz_key_file_read_list(); logged
 */
enum gz_result gz_authorized_keys_open(struct gz_authorized_keys *keys, const char *path,
				       const struct gz_log *log);

/**
 * Find the entry with @p key. Checks first, with one system call, whether the file has changed.
 * While the file is damaged or its permissions are unsafe nobody is let in; each change is logged
 * once.
 *
 * @return the entry, valid until the next call, or NULL
 */
const struct gz_known_key *gz_authorized_keys_find(struct gz_authorized_keys *keys,
						   const char *key);

/*
 * A limit on log messages: one a minute for each address and kind of message, in memory of fixed
 * size, however many addresses call.
 */

/** Addresses remembered. Chosen: more than a laboratory has; all further ones share one entry. */
#define GZ_ADDRESS_LIMIT_COUNT 64

/** Shortest time between two messages of one kind about one address, ns. */
#define GZ_ADDRESS_LIMIT_NS (60 * INT64_C(1000000000))

/** The limit for one kind of message about one address. */
struct gz_address_limit_entry {
	char address[GZ_ADDRESS_SIZE];
	int kind;
	struct gz_ratelimit limit;
};

/** The memory. Zero-initialised is ready. One thread at a time. */
struct gz_address_limit {
	struct gz_address_limit_entry entries[GZ_ADDRESS_LIMIT_COUNT];
	struct gz_ratelimit others; /**< shared by all addresses that found no free entry */
};

/**
 * Whether a message of @p kind about @p address may be logged now. An entry becomes free for
 * another address once its minute is over.
 *
 * @param address   text; cut to GZ_ADDRESS_SIZE - 1 bytes
 * @param kind      the caller's own number; messages of different kinds do not delay each other
 * @param now_ns    host time
 * @param[out] out_dropped  messages held back since the last one; written only on true
 */
bool gz_address_limit_pass(struct gz_address_limit *limit, const char *address, int kind,
			   int64_t now_ns, uint64_t *out_dropped);

#endif
