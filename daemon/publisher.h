/**
 * @file
 * Publishing: the messages made from a sample, and the two channels that carry them. The channel
 * "stream" carries every message, in two frames; the channel "latest" carries the newest gaze
 * message, in one frame, conflated.
 *
 * A slow or dead reader delays nobody. The stream keeps up to GZ_STREAM_QUEUE messages for each
 * reader and drops further ones, which the reader sees as a gap in seq. The latest channel keeps
 * one message.
 */
#ifndef GZ_DAEMON_PUBLISHER_H
#define GZ_DAEMON_PUBLISHER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "daemon/config.h"
#include "daemon/network.h"
#include "filter/pipeline.h"
#include "protocol/wire.h"

/*
 * Messages: a pipeline step and the encoding of its results, without sockets or a clock. Nothing
 * else decides what the stream carries: from the start state, the same samples, settings and
 * display give the same bytes, except for publish_ns. Messages about surfaces and about pupils are
 * made only while somebody wants them.
 */

/** Room for a topic with its NUL: "surfaces." and a name. */
#define GZ_TOPIC_SIZE 80

/** Most messages of one sample: the gaze, one for each surface, fixations, blinks and a saccade. */
#define GZ_MESSAGES_MAX (1 + GZ_SURFACES_MAX + GZ_FIXATION_MESSAGES_MAX + GZ_BLINK_MESSAGES_MAX + 1)

/** One message of the stream. */
struct gz_outgoing {
	char topic[GZ_TOPIC_SIZE];
	struct gz_wire_message body;
};

/** The messages of one sample, in the order in which they are sent; the first is the gaze. */
struct gz_outgoing_batch {
	size_t count;
	struct gz_pipeline_output step; /**< what the messages were made of */
	struct gz_outgoing item[GZ_MESSAGES_MAX];
};

/** Makes messages. Plain data; gz_message_maker_init() fills it. */
struct gz_message_maker {
	struct gz_pipeline pipeline;
	size_t surface_count;
	char surface[GZ_SURFACES_MAX][GZ_NAME_SIZE];
	bool without_surfaces; /**< nobody wants messages about surfaces: none are made */
};

/**
 * Put the maker into its start state.
 *
 * @param config   gives the names of the surfaces
 * @param params   settings of the pipeline
 * @param display  valid
 */
void gz_message_maker_init(struct gz_message_maker *maker, const struct gz_config *config,
			   const struct gz_pipeline_params *params,
			   const struct gz_display *display);

/** Return to the start state, with the same settings. */
void gz_message_maker_reset(struct gz_message_maker *maker);

/**
 * Process one sample. Does not allocate.
 *
 * @param publish_ns  the time of sending that the gaze message carries, host time
 * @param[out] out    always filled
 */
void gz_message_maker_step(struct gz_message_maker *maker, const struct gz_sample *sample,
			   int64_t publish_ns, struct gz_outgoing_batch *out);

/**
 * After the last sample of a replay: make a message of events that have become certain. Call it
 * until it returns false. The maker must be reset before the next sample.
 *
 * @param[out] out  written on true
 * @return whether there was one. Does not allocate
 */
bool gz_message_maker_flush(struct gz_message_maker *maker, struct gz_outgoing *out);

/*
 * The channels.
 */

/** Messages kept for each reader of the stream (ZMQ_SNDHWM). Chosen: 4 s of gaze at 2000 Hz, as the
 * recorder's ring, for a reader that waits for its disk or its machine. About 8 MB, which slow
 * readers share. */
#define GZ_STREAM_QUEUE 8192

/** How long closing waits for readers to take what was sent, ms. Chosen: a live reader needs far
 * less, and a dead one must not block the daemon. */
#define GZ_STREAM_LINGER_MS 500

/** Both channels. One thread at a time. */
struct gz_publisher;

/**
 * Bind the channels "stream" and "latest".
 *
 * @param network  how sockets are bound; its guard and its context outlive the publisher
 * @param[out] out_publisher  owned by the caller: gz_publisher_destroy()
 * @retval GZ_ERR_NO_MEM  no memory or no socket
 * @return else as gz_network_bind(); logged
 */
enum gz_result gz_publisher_create(const struct gz_network *network,
				   struct gz_publisher **out_publisher);

/** The stream's TCP port, 0 without TCP. */
int gz_publisher_port(const struct gz_publisher *publisher);

/** The latest channel's TCP port, 0 without TCP. */
int gz_publisher_latest_port(const struct gz_publisher *publisher);

/** Send all messages of a sample on the stream, and the gaze on the latest channel too. Never
 * waits. */
void gz_publisher_send(struct gz_publisher *publisher, const struct gz_outgoing_batch *batch);

/** Send one message on the stream. Never waits. */
void gz_publisher_send_one(struct gz_publisher *publisher, const char *topic, const void *bytes,
			   size_t size);

/** Update the numbers of connections and subscriptions. Never waits; call it several times a
 * second. */
void gz_publisher_update(struct gz_publisher *publisher);

/** Whether a reader may want messages about surfaces: one has subscribed to them, or readers have
 * come since the last update. */
bool gz_publisher_wants_surfaces(const struct gz_publisher *publisher);

/** Present connections of both channels. */
uint32_t gz_publisher_subscribers(const struct gz_publisher *publisher);

/** Subscriptions of the stream at the last update: one for each topic of each reader. */
uint32_t gz_publisher_subscriptions(const struct gz_publisher *publisher);

/** All subscriptions of the stream from the start to the last update, ended ones included. */
uint64_t gz_publisher_arrivals(const struct gz_publisher *publisher);

/** Connections of readers that were ended because of too many subscriptions (readers.h), from the
 * start to the last update. The quota (quota.h) ends others. */
uint64_t gz_publisher_refused(const struct gz_publisher *publisher);

/** Close and set to NULL. Accepts a pointer to NULL. */
void gz_publisher_destroy(struct gz_publisher **publisher);

#endif
