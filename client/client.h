/**
 * @file
 * The library an application links to have the latest gaze. Reconnects by itself: the daemon may
 * start later, die and return.
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
 * Connect.
 *
 * @param endpoint  a ZeroMQ endpoint of a `latest` channel; NULL finds the local daemon's
 * @param log       borrowed, outlives the client; may be NULL
 * @param[out] out_client  owned by the caller: gz_client_close()
 * @retval GZ_ERR_INVAL   @p endpoint is no ZeroMQ endpoint; logged
 * @retval GZ_ERR_NO_MEM  no room for memory, sockets or threads; logged
 * @return else as gz_keys_find(), which is asked for keys
 *
 * Succeeds also while no daemon runs. Starts ZeroMQ's two threads.
 */
enum gz_result gz_client_open(const char *endpoint, const struct gz_log *log,
			      struct gz_client **out_client);

/** As gz_client_open() with @p keys, copied, and no others; NULL connects without any. */
enum gz_result gz_client_open_with_keys(const char *endpoint, const struct gz_keys *keys,
					const struct gz_log *log, struct gz_client **out_client);

/**
 * The newest gaze. Never blocks. Its time is on this machine's CLOCK_MONOTONIC if the daemon runs
 * here; for a daemon elsewhere the age says nothing.
 *
 * @param[out] out_gaze    written only on GZ_OK
 * @param[out] out_age_ns  how old it is, as gz_gaze_age_ns() has it; written only on GZ_OK. May be
 *                         NULL
 * @retval GZ_OK           there is one; the same one again if nothing newer came, so look at the
 *                         age
 * @retval GZ_ERR_TIMEOUT  none has come since the client was opened
 */
enum gz_result gz_client_latest(struct gz_client *client, struct gz_gaze *out_gaze,
				int64_t *out_age_ns);

/**
 * The age of @p gaze at host time @p now_ns, ns: now less the sample's host_ns. A replayed
 * recording has times of another day: where host_ns is later than publish_ns, or more than a
 * second (chosen: no live pipeline holds a sample that long) before it, it is now less publish_ns.
 * Never negative.
 */
int64_t gz_gaze_age_ns(const struct gz_gaze *gaze, int64_t now_ns);

/** What a client has seen. */
struct gz_client_counters {
	uint64_t received;    /**< messages taken from the channel */
	uint64_t skipped;     /**< sequence numbers that a newer message overtook: normal on this
				 channel */
	uint64_t malformed;   /**< messages that were no gaze; dropped */
	uint64_t connections; /**< times that a daemon was found; above 1, it was lost and returned
			       */
	bool connected;       /**< a daemon's socket is connected now */
};

/** Count up to now. Never blocks, takes no message. */
void gz_client_get_counters(struct gz_client *client, struct gz_client_counters *out_counters);

/** The endpoint in use. Valid until the client is closed. */
const char *gz_client_endpoint(const struct gz_client *client);

/** Close and set to NULL; returns at once. Accepts a pointer to NULL. */
void gz_client_close(struct gz_client **client);

#ifdef __cplusplus
}
#endif

#endif
