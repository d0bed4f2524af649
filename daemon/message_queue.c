#include "daemon/message_queue.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Each message lies in one piece: two sizes of 4 bytes, the topic, the body. Messages follow one
 * another from first to last. One that does not fit before the end of the memory lies at its
 * beginning; wrap is then where the messages before it end. */
struct gz_message_queue {
	size_t size;
	size_t first; /* of the oldest message */
	size_t last;  /* where the next message begins */
	size_t wrap;  /* 0: last is not before first */
	unsigned char bytes[];
};

enum gz_result gz_message_queue_create(size_t size, struct gz_message_queue **out_queue)
{
	struct gz_message_queue *queue = calloc(1, sizeof *queue + size);
	if (!queue)
		return GZ_ERR_NO_MEM;
	queue->size = size;
	*out_queue = queue;
	return GZ_OK;
}

/* Find room for @p needed bytes in one piece. @return false if there is none */
static bool find_queue_place(struct gz_message_queue *queue, size_t needed)
{
	if (queue->wrap > 0)
		return needed <= queue->first - queue->last;
	if (needed <= queue->size - queue->last)
		return true;
	if (needed > queue->first)
		return false;
	queue->wrap = queue->last;
	queue->last = 0;
	return true;
}

bool gz_message_queue_push(struct gz_message_queue *queue, const struct gz_queued_message *message)
{
	const uint32_t sizes[2] = { (uint32_t)message->topic_size, (uint32_t)message->body_size };
	_Static_assert(sizeof sizes == GZ_MESSAGE_QUEUE_EXTRA, "two sizes of four bytes");
	if (message->topic_size > queue->size || message->body_size > queue->size ||
	    !find_queue_place(queue, sizeof sizes + message->topic_size + message->body_size))
		return false;
	unsigned char *place = queue->bytes + queue->last;
	memcpy(place, sizes, sizeof sizes);
	place += sizeof sizes;
	if (message->topic_size > 0)
		memcpy(place, message->topic, message->topic_size);
	if (message->body_size > 0)
		memcpy(place + message->topic_size, message->body, message->body_size);
	queue->last += sizeof sizes + message->topic_size + message->body_size;
	return true;
}

bool gz_message_queue_front(const struct gz_message_queue *queue,
			    struct gz_queued_message *out_message)
{
	uint32_t sizes[2];
	if (queue->wrap == 0 && queue->first == queue->last)
		return false;
	const unsigned char *place = queue->bytes + queue->first;
	memcpy(sizes, place, sizeof sizes);
	*out_message = (struct gz_queued_message) {
		.topic = place + sizeof sizes,
		.topic_size = sizes[0],
		.body = place + sizeof sizes + sizes[0],
		.body_size = sizes[1],
	};
	return true;
}

void gz_message_queue_pop(struct gz_message_queue *queue)
{
	struct gz_queued_message message;
	if (!gz_message_queue_front(queue, &message))
		return;
	queue->first += GZ_MESSAGE_QUEUE_EXTRA + message.topic_size + message.body_size;
	if (queue->wrap > 0 && queue->first == queue->wrap) {
		queue->first = 0;
		queue->wrap = 0;
	}
	if (queue->wrap == 0 && queue->first == queue->last)
		queue->first = queue->last = 0;
}

void gz_message_queue_destroy(struct gz_message_queue **queue)
{
	if (!queue || !*queue)
		return;
	free(*queue);
	*queue = NULL;
}
