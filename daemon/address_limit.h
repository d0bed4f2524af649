/**
 * @file
 * Log once a minute per address, whatever is sent from there, in memory of fixed size.
 */
#ifndef GZ_DAEMON_ADDRESS_LIMIT_H
#define GZ_DAEMON_ADDRESS_LIMIT_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"

/** Addresses remembered. Chosen: more than a laboratory has; whoever comes from more shares one
 * entry. */
#define GZ_ADDRESS_LIMIT_COUNT 64

/** Longest address that is told from others, with its NUL: an IPv6 address with its interface. */
#define GZ_ADDRESS_SIZE 64

/** Least time between two messages about one address, ns. */
#define GZ_ADDRESS_LIMIT_NS (60 * INT64_C(1000000000))

/** An address, and what of it is being told. */
struct gz_address_limit_entry {
	char address[GZ_ADDRESS_SIZE];
	int kind;
	struct gz_ratelimit limit;
};

/** The memory. Zero-initialised is ready. One thread at a time. */
struct gz_address_limit {
	struct gz_address_limit_entry entries[GZ_ADDRESS_LIMIT_COUNT];
	struct gz_ratelimit others; /**< of all addresses that found no room */
};

/**
 * Whether something of @p kind may be logged of @p address now. An entry makes room for another
 * address once its minute is over.
 *
 * @param address   text; longer ones are cut
 * @param kind      the caller's own number: kinds do not hold each other back
 * @param now_ns    host time
 * @param[out] out_dropped  how many were held back since the last one; written only on true
 */
bool gz_address_limit_pass(struct gz_address_limit *limit, const char *address, int kind,
			   int64_t now_ns, uint64_t *out_dropped);

#endif
