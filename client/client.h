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
 * @retval GZ_ERR_NO_MEM  no room
 *
 * Succeeds also while no daemon runs.
 */
enum gz_result gz_client_open(const char *endpoint, const struct gz_log *log,
			      struct gz_client **out_client);

/**
 * The newest gaze. Never blocks.
 *
 * @param[out] out_gaze    written only on GZ_OK
 * @param[out] out_age_ns  how old it is: host time now less the sample's host_ns; for a replayed
 *                         recording, whose times are of another day, less publish_ns. May be NULL
 * @retval GZ_OK           there is one; the same one again if nothing newer came
 * @retval GZ_ERR_TIMEOUT  none has come since the client was opened
 */
enum gz_result gz_client_latest(struct gz_client *client, struct gz_gaze *out_gaze,
				int64_t *out_age_ns);

/** What a client has seen. */
struct gz_client_counters {
	uint64_t received;  /**< messages seen */
	uint64_t skipped;   /**< sequence numbers that a newer message overtook: normal on this
			       channel */
	uint64_t malformed; /**< messages that were no gaze; dropped */
	bool connected;     /**< a daemon's socket is connected now */
};

/** Copy what was counted since gz_client_open(). Never blocks. */
void gz_client_get_counters(struct gz_client *client, struct gz_client_counters *out_counters);

/** Close and set to NULL; returns at once. Accepts a pointer to NULL. */
void gz_client_close(struct gz_client **client);

#ifdef __cplusplus
}
#endif

#endif
