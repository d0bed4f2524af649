/**
 * @file
 * Every message of the daemon's stream, in order: gaze, fixations, saccades, blinks, status. For
 * those who need all; an application that draws wants client.h, which cannot lag.
 *
 * libzmq drops messages in silence when a reader is slow, so each reader counts what it missed.
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
	GZ_MESSAGE_OTHER, /**< a topic without a struct here, as "surfaces.screen": see bytes */
};

/** One message. Which member of the union holds something follows from the kind. */
struct gz_message {
	enum gz_message_kind kind;
	char topic[GZ_NAME_SIZE];
	int64_t received_ns; /**< host time when it was read */
	uint64_t lost;       /**< GAZE: messages missed just before this one; 0 elsewhere */
	union {
		struct gz_gaze gaze;
		struct gz_fixation fixation;
		struct gz_blink blink;
		struct gz_saccade saccade;
		struct gz_status status;
	};
	const void *bytes; /**< the MessagePack map as it came; valid until the next read */
	size_t size;       /**< of @p bytes; at most 65536 */
};

/**
 * Subscribe.
 *
 * @param endpoint  a ZeroMQ endpoint of a stream; NULL finds the local daemon's
 * @param topics    prefixes of topics, NULL-terminated, copied; NULL or none at all for everything
 * @param log       borrowed, outlives the stream; may be NULL
 * @param[out] out_stream  owned by the caller: gz_stream_close()
 * @retval GZ_ERR_INVAL   @p endpoint is no ZeroMQ endpoint; logged
 * @retval GZ_ERR_NO_MEM  no room for memory, sockets or threads; logged
 * @return else as gz_keys_find(), which is asked for keys
 *
 * Succeeds also while no daemon runs; messages sent before the connection stands are not seen and
 * do not count as lost.
 */
enum gz_result gz_stream_open(const char *endpoint, const char *const *topics,
			      const struct gz_log *log, struct gz_stream **out_stream);

/** As gz_stream_open() with @p keys, copied, and no others; NULL connects without any. */
enum gz_result gz_stream_open_with_keys(const char *endpoint, const char *const *topics,
					const struct gz_keys *keys, const struct gz_log *log,
					struct gz_stream **out_stream);

/**
 * Wait for the next message.
 *
 * @param timeout_ms        longest wait, ms; 0 polls, negative is refused
 * @param[out] out_message  written only on GZ_OK
 * @retval GZ_OK           a message
 * @retval GZ_ERR_TIMEOUT  none came in time, or a signal arrived
 * @retval GZ_ERR_INVAL    @p timeout_ms is negative
 *
 * Malformed messages are dropped and counted. Up to 4096 messages wait in memory; if more come
 * before they are read, the publisher drops them.
 */
enum gz_result gz_stream_read(struct gz_stream *stream, int timeout_ms,
			      struct gz_message *out_message);

/** What a stream has seen. */
struct gz_stream_counters {
	uint64_t received; /**< well-formed messages */
	uint64_t lost;     /**< gaze messages missed, by gaps in their numbers; 0 if the topics
			      leave some gaze messages out */
	uint64_t malformed;
	uint64_t connections; /**< times that a daemon was found; above 1, it was lost and returned
			       */
	bool connected;
};

/** Count up to now. Never blocks, takes no message. */
void gz_stream_get_counters(struct gz_stream *stream, struct gz_stream_counters *out_counters);

/** The endpoint in use. Valid until the stream is closed. */
const char *gz_stream_endpoint(const struct gz_stream *stream);

/** Close and set to NULL; returns at once. Accepts a pointer to NULL. */
void gz_stream_close(struct gz_stream **stream);

#ifdef __cplusplus
}
#endif

#endif
