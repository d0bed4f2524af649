/**
 * @file
 * The latest gaze, for an application that draws. The connection restores itself: the daemon may
 * start later, end and return.
 */
#ifndef GZ_CLIENT_CLIENT_H
#define GZ_CLIENT_CLIENT_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "client/keys.h"
#include "protocol/gaze.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A connection to the daemon's latest channel. One thread at a time. */
struct gz_client;

/**
 * Connect to a `latest` channel. Succeeds even if no daemon is running. Starts ZeroMQ's two
 * threads. Waits up to 20 ms for a daemon on this machine that is busy.
 *
 * @param endpoint  ZeroMQ endpoint of a `latest` channel; NULL: that of the local daemon
 * @param log       borrowed, outlives the client; may be NULL
 * @param[out] out_client  owned by the caller: gz_client_close()
 * @retval GZ_ERR_INVAL   @p endpoint is not a ZeroMQ endpoint; logged
 * @retval GZ_ERR_NO_MEM  no memory, socket or thread; if no socket or thread, logged
 * @return else as gz_keys_find(), which looks for keys
 */
enum gz_result gz_client_open(const char *endpoint, const struct gz_log *log,
			      struct gz_client **out_client);

/** Connect like gz_client_open(), but with @p keys, which are copied; NULL: without keys. */
enum gz_result gz_client_open_with_keys(const char *endpoint, const struct gz_keys *keys,
					const struct gz_log *log, struct gz_client **out_client);

/**
 * Get the newest gaze. Never blocks. Its times are on this machine's CLOCK_MONOTONIC if the daemon
 * runs here; the age of gaze from a daemon on another machine has no meaning.
 *
 * @param[out] out_gaze    written only on GZ_OK
 * @param[out] out_age_ns  its age by gz_gaze_age_ns(), ns; written only on GZ_OK. May be NULL
 * @retval GZ_OK           *out_gaze is filled; it is the same as before if nothing newer came, so
 *                         check the age
 * @retval GZ_ERR_TIMEOUT  no gaze has come since the client was opened
 */
enum gz_result gz_client_latest(struct gz_client *client, struct gz_gaze *out_gaze,
				int64_t *out_age_ns);

/**
 * The age of @p gaze at host time @p now_ns, ns, never negative: @p now_ns minus host_ns. The times
 * of a replayed recording are those of another day: if host_ns is later than publish_ns, or more
 * than a second earlier (chosen: no live pipeline takes that long), the age is @p now_ns minus
 * publish_ns. Threads: any.
 */
int64_t gz_gaze_age_ns(const struct gz_gaze *gaze, int64_t now_ns);

/** Counters of a client since it was opened. */
struct gz_client_counters {
	uint64_t received;    /**< messages received */
	uint64_t skipped;     /**< gaze messages that a newer one replaced before they were read:
				 normal on this channel; counted by gaps in seq */
	uint64_t malformed;   /**< messages that were not gaze; dropped */
	uint64_t connections; /**< connections established; above 1: the daemon was lost and
				 returned */
	bool connected;       /**< connected to a daemon now */
};

/** Get the counters up to now. Never blocks; receives no message. */
void gz_client_get_counters(struct gz_client *client, struct gz_client_counters *out_counters);

/** The endpoint in use. Valid until the client is closed. */
const char *gz_client_endpoint(const struct gz_client *client);

/** Close the client and set *client to NULL; returns at once. Accepts a pointer to NULL. */
void gz_client_close(struct gz_client **client);

#ifdef __cplusplus
}
#endif

#endif
