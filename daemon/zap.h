/**
 * @file
 * Requests of the ZeroMQ Authentication Protocol (ZeroMQ RFC 27/ZAP): may the peer with this key
 * come in? Bytes to meaning, no I/O. libzmq writes the requests, but parts of them are the peer's.
 */
#ifndef GZ_DAEMON_ZAP_H
#define GZ_DAEMON_ZAP_H

#include <stddef.h>

#include "base/result.h"
#include "daemon/address_limit.h"
#include "protocol/key.h"

/** Frames of a CURVE request behind the empty one: version, request id, domain, address, identity,
 * mechanism, public key. */
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
	unsigned char id[GZ_ZAP_ID_SIZE_MAX]; /**< to be sent back */
	char address[GZ_ADDRESS_SIZE];        /**< printable; "?" where it cannot be told */
	char key[GZ_KEY_TEXT_SIZE];           /**< the peer's public key, proven to be its own */
};

/**
 * Read one request.
 *
 * @param frames, count  all frames, untrusted; those beyond GZ_ZAP_FRAMES need not be there
 * @param[out] out       @p id is filled also on failure where there is one, else empty: an answer
 *                       is owed to it; the rest on success only
 * @retval GZ_ERR_PROTOCOL  other frames than these, or a request id too long
 * @retval GZ_ERR_ACCESS    another version, another mechanism than CURVE, or a key that is not 32
 *                          bytes
 */
enum gz_result gz_zap_parse(const struct gz_zap_frame *frames, size_t count,
			    struct gz_zap_request *out);

#endif
