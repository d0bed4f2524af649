/**
 * @file
 * Every message of the daemon's stream, in order: gaze, fixations, saccades, blinks, status. For
 * programs that need all of them; an application that draws should use client.h, which cannot lag.
 *
 * libzmq silently drops messages when a reader is slow, so each reader counts what it missed.
 */
#ifndef GZ_CLIENT_STREAM_H
#define GZ_CLIENT_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "client/keys.h"
#include "protocol/gaze.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A subscription to the stream. One thread at a time. */
struct gz_stream;

enum gz_message_kind {
	GZ_MESSAGE_GAZE,
	GZ_MESSAGE_FIXATION,
	GZ_MESSAGE_BLINK,
	GZ_MESSAGE_SACCADE,
	GZ_MESSAGE_STATUS,
	GZ_MESSAGE_OTHER, /**< a topic without a struct here, such as "surfaces.screen": see bytes
			   */
};

/** One message. The kind decides which member of the union is set. */
struct gz_message {
	enum gz_message_kind kind;
	char topic[GZ_NAME_SIZE];
	int64_t received_ns; /**< host time when it was read */
	uint64_t lost;       /**< GAZE: gaze messages missed just before this one; otherwise 0 */
	union {
		struct gz_gaze gaze;
		struct gz_fixation fixation;
		struct gz_blink blink;
		struct gz_saccade saccade;
		struct gz_status status;
	};
	const void *bytes; /**< the MessagePack map as received; valid until the next read */
	size_t size;       /**< of @p bytes; at most 65536 */
};

/**
 * Subscribe to a stream. Succeeds even if no daemon is running. Messages sent before the connection
 * is established are not received and do not count as lost. Waits up to 20 ms for a daemon on
 * this machine that is busy.
 *
 * @param endpoint  ZeroMQ endpoint of a stream; NULL: that of the local daemon
 * @param topics    prefixes of topics, NULL-terminated, copied; NULL or an empty list: everything
 * @param log       borrowed, outlives the stream; may be NULL
 * @param[out] out_stream  owned by the caller: gz_stream_close()
 * @retval GZ_ERR_INVAL   @p endpoint is not a ZeroMQ endpoint; logged
 * @retval GZ_ERR_NO_MEM  no memory, socket or thread; if no socket or thread, logged
 * @return else as gz_keys_find(), which looks for keys
 */
enum gz_result gz_stream_open(const char *endpoint, const char *const *topics,
			      const struct gz_log *log, struct gz_stream **out_stream);

/** Subscribe like gz_stream_open(), but with @p keys, which are copied; NULL: without keys. */
enum gz_result gz_stream_open_with_keys(const char *endpoint, const char *const *topics,
					const struct gz_keys *keys, const struct gz_log *log,
					struct gz_stream **out_stream);

/**
 * Wait for the next message. Malformed messages are dropped and counted. Up to 4096 unread messages
 * are kept in memory; the publisher drops further ones. Of a daemon on this machine, whose messages
 * are read in shared memory (docs/protocol.md), the last 4 MiB are kept.
 *
 * @param timeout_ms        longest wait, ms; 0 polls, negative is refused
 * @param[out] out_message  written only on GZ_OK
 * @retval GZ_OK           *out_message is filled
 * @retval GZ_ERR_TIMEOUT  no message came in time, or a signal arrived
 * @retval GZ_ERR_INVAL    @p timeout_ms is negative
 */
enum gz_result gz_stream_read(struct gz_stream *stream, int timeout_ms,
			      struct gz_message *out_message);

/** Counters of a stream since it was opened. */
struct gz_stream_counters {
	uint64_t received;    /**< well-formed messages */
	uint64_t lost;        /**< gaze messages missed, counted by gaps in seq; 0 if the topics
				 leave some gaze messages out */
	uint64_t malformed;   /**< messages that could not be decoded; dropped */
	uint64_t connections; /**< connections established; above 1: the daemon was lost and
				 returned */
	bool connected;       /**< connected to a daemon now */
};

/** Get the counters up to now. Never blocks; receives no message. */
void gz_stream_get_counters(struct gz_stream *stream, struct gz_stream_counters *out_counters);

/** The endpoint in use. Valid until the stream is closed. */
const char *gz_stream_endpoint(const struct gz_stream *stream);

/** Close the stream and set *stream to NULL; returns at once. Accepts a pointer to NULL. */
void gz_stream_close(struct gz_stream **stream);

#ifdef __cplusplus
}
#endif

#endif
