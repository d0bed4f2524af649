#include "daemon/readers.h"

#include <stdlib.h>
#include <string.h>

#include "protocol/board/board.h"
#include "protocol/wire.h"

/* A reader's topics lie one after the other, each after its length. */
struct reader {
	uint64_t identity; /* 0: none */
	bool refused;
	uint16_t count;
	uint16_t boards; /* topics of it that are read at the board */
	uint16_t used;   /* bytes of topics */
	unsigned char topics[GZ_READER_TOPICS_SIZE];
};

struct gz_readers {
	struct gz_readers_sums sums;
	int size;
	int end; /* no descriptor from here on has been used */
	struct reader *readers;
};

enum gz_result gz_readers_create(int size, struct gz_readers **out_readers)
{
	struct gz_readers *readers = calloc(1, sizeof *readers);
	if (!readers)
		return GZ_ERR_NO_MEM;
	readers->size = size;
	/* Untouched pages cost no memory. */
	readers->readers = calloc((size_t)size, sizeof *readers->readers);
	if (!readers->readers) {
		gz_readers_destroy(&readers);
		return GZ_ERR_NO_MEM;
	}
	*out_readers = readers;
	return GZ_OK;
}

static size_t topic_size_at(const struct reader *reader, size_t at)
{
	return (size_t)(reader->topics[at] | reader->topics[at + 1] << 8);
}

/* @return where the topic's length lies; reader->used if the reader has no such topic */
static size_t find_topic(const struct reader *reader, const void *topic, size_t size)
{
	size_t at = 0;
	while (at < reader->used) {
		size_t length = topic_size_at(reader, at);
		if (length == size &&
		    memcmp(reader->topics + at + GZ_READER_TOPIC_EXTRA, topic, size) == 0)
			return at;
		at += GZ_READER_TOPIC_EXTRA + length;
	}
	return at;
}

/* Whether this is the subscription of a reader of the board. */
static bool is_for_board(const unsigned char *topic, size_t size)
{
	return size >= GZ_BOARD_TOPIC_SIZE &&
	       memcmp(topic, GZ_BOARD_TOPIC, GZ_BOARD_TOPIC_SIZE) == 0;
}

/* Whether one of the two begins with the other. */
static bool begin_alike(const unsigned char *topic, size_t size, const char *other)
{
	size_t length = strlen(other);
	return memcmp(topic, other, size < length ? size : length) == 0;
}

/* Whether the subscription includes messages about a pupil: it is the beginning of their topic. */
static bool takes_pupils(const unsigned char *topic, size_t size)
{
	return size < sizeof GZ_TOPIC_PUPIL_RIGHT &&
	       (begin_alike(topic, size, GZ_TOPIC_PUPIL_RIGHT) ||
		begin_alike(topic, size, GZ_TOPIC_PUPIL_LEFT));
}

_Static_assert(sizeof GZ_TOPIC_PUPIL_RIGHT == sizeof GZ_TOPIC_PUPIL_LEFT, "of one length");

/* Count a subscription that begins, or one that ends. */
static void count_topic(struct gz_readers *readers, struct reader *reader,
			const unsigned char *topic, size_t size, bool begins)
{
	const uint32_t step = begins ? 1 : UINT32_MAX; /* one less, modulo 2^32 */
	struct gz_readers_sums *sums = &readers->sums;
	sums->subscriptions += step;
	sums->topics_size += step * (uint32_t)(GZ_READER_TOPIC_EXTRA + size);
	reader->count = (uint16_t)(reader->count + step);
	if (is_for_board(topic, size)) {
		sums->boards += begins && reader->boards == 0 ? 1 : 0;
		reader->boards = (uint16_t)(reader->boards + step);
		sums->boards -= reader->boards == 0 ? 1 : 0;
		topic += GZ_BOARD_TOPIC_SIZE;
		size -= GZ_BOARD_TOPIC_SIZE;
	} else {
		sums->remote += step;
	}
	sums->pupils += takes_pupils(topic, size) ? step : 0;
	sums->surfaces += begin_alike(topic, size, GZ_TOPIC_SURFACES) ? step : 0;
}

static void add_topic(struct gz_readers *readers, struct reader *reader, const void *topic,
		      size_t size)
{
	unsigned char *place = reader->topics + reader->used;
	place[0] = (unsigned char)size;
	place[1] = (unsigned char)(size >> 8);
	memcpy(place + GZ_READER_TOPIC_EXTRA, topic, size);
	reader->used = (uint16_t)(reader->used + GZ_READER_TOPIC_EXTRA + size);
	count_topic(readers, reader, topic, size, true);
}

static void remove_topic(struct gz_readers *readers, struct reader *reader, size_t at)
{
	size_t size = topic_size_at(reader, at);
	size_t whole = GZ_READER_TOPIC_EXTRA + size;
	count_topic(readers, reader, reader->topics + at + GZ_READER_TOPIC_EXTRA, size, false);
	memmove(reader->topics + at, reader->topics + at + whole, reader->used - at - whole);
	reader->used = (uint16_t)(reader->used - whole);
}

static void forget_reader(struct gz_readers *readers, struct reader *reader)
{
	while (reader->used > 0)
		remove_topic(readers, reader, 0);
	reader->identity = 0;
	reader->refused = false;
}

/* The reader with this connection, without the subscriptions of an older one; NULL if @p fd is not
 * in the table. */
static struct reader *find_reader(struct gz_readers *readers, int fd, uint64_t identity)
{
	if (fd < 0 || fd >= readers->size)
		return NULL;
	struct reader *reader = &readers->readers[fd];
	if (reader->identity != identity)
		forget_reader(readers, reader);
	reader->identity = identity;
	if (fd >= readers->end)
		readers->end = fd + 1;
	return reader;
}

enum gz_result gz_readers_subscribe(struct gz_readers *readers, int fd, uint64_t identity,
				    const void *topic, size_t size)
{
	const struct gz_readers_sums *sums = &readers->sums;
	struct reader *reader = find_reader(readers, fd, identity);
	if (!reader)
		return GZ_ERR_INVAL;
	if (reader->refused)
		return GZ_ERR_ACCESS;
	if (find_topic(reader, topic, size) < reader->used)
		return GZ_OK;
	size_t whole = GZ_READER_TOPIC_EXTRA + size;
	if (reader->count >= GZ_READER_SUBSCRIPTIONS ||
	    whole > GZ_READER_TOPICS_SIZE - (size_t)reader->used ||
	    sums->subscriptions >= GZ_READERS_SUBSCRIPTIONS ||
	    whole > GZ_READERS_TOPICS_SIZE - (size_t)sums->topics_size)
		reader->refused = true;
	if (reader->refused)
		return GZ_ERR_FULL;
	add_topic(readers, reader, topic, size);
	return GZ_OK;
}

void gz_readers_unsubscribe(struct gz_readers *readers, int fd, uint64_t identity,
			    const void *topic, size_t size)
{
	struct reader *reader = find_reader(readers, fd, identity);
	if (!reader)
		return;
	size_t at = find_topic(reader, topic, size);
	if (at < reader->used)
		remove_topic(readers, reader, at);
}

void gz_readers_sweep(struct gz_readers *readers, uint64_t (*identity_of)(int fd))
{
	for (int fd = 0; fd < readers->end; fd++) {
		struct reader *reader = &readers->readers[fd];
		if (reader->identity && identity_of(fd) != reader->identity)
			forget_reader(readers, reader);
	}
}

struct gz_readers_sums gz_readers_sums(const struct gz_readers *readers)
{
	return readers->sums;
}

void gz_readers_destroy(struct gz_readers **readers)
{
	if (!readers || !*readers)
		return;
	free((*readers)->readers);
	free(*readers);
	*readers = NULL;
}
