/**
 * @file
 * A queue of messages in memory of fixed size: what clients sent and the daemon has not passed on
 * yet.
 */
#ifndef GZ_DAEMON_MESSAGE_QUEUE_H
#define GZ_DAEMON_MESSAGE_QUEUE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/result.h"

/** Bytes that a message takes in the queue besides its topic and body. */
#define GZ_MESSAGE_QUEUE_EXTRA 8

/** A message: a topic and a body. */
struct gz_queued_message {
	const void *topic;
	size_t topic_size;
	const void *body;
	size_t body_size;
};

/** The queue. One thread at a time. */
struct gz_message_queue;

/**
 * Create an empty queue.
 *
 * @param size  bytes for all messages, 1 to 1 GiB. A message may take up to half of it without
 *              being refused by an empty queue.
 * @param[out] out_queue  owned by the caller: gz_message_queue_destroy()
 * @retval GZ_ERR_NO_MEM  no memory
 */
enum gz_result gz_message_queue_create(size_t size, struct gz_message_queue **out_queue);

/** Append a copy of @p message. @return false if there is no room for it. Does not allocate. */
bool gz_message_queue_push(struct gz_message_queue *queue, const struct gz_queued_message *message);

/**
 * The oldest message.
 *
 * @param[out] out_message  written on true only; valid until gz_message_queue_pop()
 * @return whether there is one
 */
bool gz_message_queue_front(const struct gz_message_queue *queue,
			    struct gz_queued_message *out_message);

/** Remove the oldest message; ignored if there is none. */
void gz_message_queue_pop(struct gz_message_queue *queue);

/** Free and set to NULL. Accepts a pointer to NULL. */
void gz_message_queue_destroy(struct gz_message_queue **queue);

#endif
