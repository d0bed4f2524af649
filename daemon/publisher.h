/**
 * @file
 * The two channels that anyone may read: the stream, every message in two frames, and the latest
 * gaze, one frame, conflated.
 *
 * A reader that is slow or dead delays nobody. What it has not taken is kept for it up to
 * GZ_STREAM_QUEUE messages and dropped beyond, which it sees as a gap in seq; of the latest channel
 * one message is kept.
 */
#ifndef GZ_DAEMON_PUBLISHER_H
#define GZ_DAEMON_PUBLISHER_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "daemon/messages.h"
#include "daemon/network.h"

/** Messages kept for a reader of the stream (ZMQ_SNDHWM). Chosen: half a second of everything at
 * 1200 Hz, about 1.5 MB. */
#define GZ_STREAM_QUEUE 2048

/** How long leaving waits for readers to take what was sent, ms. Chosen: a live reader needs far
 * less, and a dead one must not hold the daemon. */
#define GZ_STREAM_LINGER_MS 500

/** Both channels. One thread at a time. */
struct gz_publisher;

/**
 * Bind the channels "stream" and "latest".
 *
 * @param network  how; its guard and its context outlive the publisher
 * @return GZ_OK, GZ_ERR_NO_MEM, or as gz_network_bind(); logged
 */
enum gz_result gz_publisher_create(const struct gz_network *network,
				   struct gz_publisher **out_publisher);

/** The stream's TCP port, 0 without TCP. */
int gz_publisher_port(const struct gz_publisher *publisher);

/** The latest channel's TCP port, 0 without TCP. */
int gz_publisher_latest_port(const struct gz_publisher *publisher);

/** Send a sample's messages: all on the stream, the gaze also as latest. Never waits. */
void gz_publisher_send(struct gz_publisher *publisher, const struct gz_outgoing_batch *batch);

/** Send one message on the stream. Never waits. */
void gz_publisher_send_one(struct gz_publisher *publisher, const char *topic, const void *bytes,
			   size_t size);

/** Take note of who came and went. Never waits; call it some times a second. */
void gz_publisher_update(struct gz_publisher *publisher);

/** Connections of both channels, now. */
uint32_t gz_publisher_subscribers(const struct gz_publisher *publisher);

/** Subscriptions of the stream, at the last update: one for each topic of each reader. */
uint32_t gz_publisher_subscriptions(const struct gz_publisher *publisher);

/** Subscriptions of the stream since the start, at the last update. */
uint64_t gz_publisher_arrivals(const struct gz_publisher *publisher);

/** Close and set to NULL. Accepts a pointer to NULL. */
void gz_publisher_destroy(struct gz_publisher **publisher);

#endif
