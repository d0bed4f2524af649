#include "protocol/board/board.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/futex.h>
#include <stdalign.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"

/*
 * Everything is counted in words of 8 bytes, and every word of a message is read and written as an
 * atomic one: a reader that is being overtaken reads words while they are overwritten, and finds
 * that out afterwards. Positions count the words since the board was made; position p lies in word
 * p modulo the size.
 *
 * The writer stores the tail before it overwrites the words behind it. A reader that has read one
 * new word (acquire) of a message that is overwritten (release) therefore also sees that the tail
 * has passed the message.
 */

typedef _Atomic uint64_t board_word;

/* The header. What different processors poll lies in different cache lines. */
struct board_header {
	char magic[8];
	uint64_t size;               /* bytes of messages */
	alignas(64) board_word head; /* where the next message will begin */
	board_word newest;           /* the newest gaze; NO_POSITION: none */
	_Atomic uint32_t bell;       /* a futex: counts the calls of gz_board_show() */
	alignas(64) board_word tail; /* the oldest message that is left */
};

_Static_assert(sizeof(struct board_header) <= GZ_BOARD_HEADER_SIZE, "the header fits");
_Static_assert(sizeof(board_word) == 8 && ATOMIC_LLONG_LOCK_FREE == 2, "processes share words");

#define NO_POSITION UINT64_MAX

/* Words before a message's topic: sizes, time, and the body's size. */
enum { HEAD_WORDS = 3 };

static size_t words_of(size_t bytes)
{
	return (bytes + 7) / 8;
}

/* Most words of a message. */
enum {
	MESSAGE_WORDS_MAX = HEAD_WORDS + (GZ_BOARD_TOPIC_MAX + 7) / 8 + (GZ_BOARD_BODY_MAX + 7) / 8
};

_Static_assert(2 * 8 * MESSAGE_WORDS_MAX <= GZ_BOARD_SIZE_MIN, "two messages fit");

/* The first word of a message: its words and the bytes of its topic. */
static uint64_t pack_sizes(size_t words, size_t topic_size)
{
	return (uint64_t)words | (uint64_t)topic_size << 32;
}

struct gz_board {
	int fd;
	struct board_header *header;
	board_word *words;
	uint64_t mask;
	uint64_t head; /* behind what was written; shown to readers by gz_board_show() */
	uint64_t tail;
	uint64_t newest;
	int64_t written_ns; /* of the newest message */
	/* How readers are woken. */
	int64_t rung_ns;     /* written_ns when they were woken last */
	int64_t together_ns; /* the writer wakes all of them itself until then ... */
	int64_t phase_ns;    /* ... for so long */
	bool chained;        /* the last time they woke each other */
};

static bool is_board_size(uint64_t size)
{
	return size >= GZ_BOARD_SIZE_MIN && size <= GZ_BOARD_SIZE_MAX && (size & (size - 1)) == 0;
}

/* The seals that keep readers from writing and the memory from changing its size. */
enum { BOARD_SEALS = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_FUTURE_WRITE };

/* The mapping comes before the seals, which forbid any further one to write. All its pages are
 * there from the beginning, so that none must be found while samples are served. */
static enum gz_result map_board(struct gz_board *board, size_t size)
{
	size_t whole = GZ_BOARD_HEADER_SIZE + size;
	board->fd = memfd_create("gazecast-board", MFD_CLOEXEC | MFD_ALLOW_SEALING);
	if (board->fd < 0 || ftruncate(board->fd, (off_t)whole) != 0)
		return GZ_ERR_NO_MEM;
	void *memory =
		mmap(NULL, whole, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, board->fd, 0);
	if (memory == MAP_FAILED)
		return GZ_ERR_NO_MEM;
	board->header = memory;
	board->words = (board_word *)((unsigned char *)memory + GZ_BOARD_HEADER_SIZE);
	board->mask = size / 8 - 1;
	if (fcntl(board->fd, F_ADD_SEALS, BOARD_SEALS | F_SEAL_SEAL) != 0)
		return GZ_ERR_UNSUPPORTED;
	return GZ_OK;
}

enum gz_result gz_board_create(size_t size, struct gz_board **out_board)
{
	if (!is_board_size(size))
		return GZ_ERR_INVAL;
	struct gz_board *board = calloc(1, sizeof *board);
	if (!board)
		return GZ_ERR_NO_MEM;
	enum gz_result result = map_board(board, size);
	if (result != GZ_OK) {
		gz_board_destroy(&board);
		return result;
	}
	board->newest = NO_POSITION;
	board->header->size = size;
	atomic_store(&board->header->newest, NO_POSITION);
	memcpy(board->header->magic, GZ_BOARD_MAGIC, sizeof board->header->magic);
	*out_board = board;
	return GZ_OK;
}

int gz_board_fd(const struct gz_board *board)
{
	return board->fd;
}

static void put_word(struct gz_board *board, uint64_t position, uint64_t word)
{
	atomic_store_explicit(&board->words[position & board->mask], word, memory_order_release);
}

/* Store @p count words that lie side by side. */
static void put_words(board_word *to, const unsigned char *from, size_t count)
{
#pragma GCC unroll 8
	for (size_t i = 0; i < count; i++) {
		uint64_t word;
		memcpy(&word, from + 8 * i, 8);
		atomic_store_explicit(&to[i], word, memory_order_release);
	}
}

/* @return the position behind the bytes, which are filled up with zeros to whole words */
static uint64_t put_bytes(struct gz_board *board, uint64_t position, const void *bytes, size_t size)
{
	const unsigned char *from = bytes;
	const size_t whole = size / 8, place = position & board->mask;
	const size_t before_end = board->mask + 1 - place;
	const size_t first = whole < before_end ? whole : before_end;
	uint64_t word = 0;
	put_words(board->words + place, from, first);
	put_words(board->words, from + 8 * first, whole - first);
	position += whole;
	if (size % 8 == 0)
		return position;
	memcpy(&word, from + 8 * whole, size % 8);
	put_word(board, position, word);
	return position + 1;
}

/* Give up the oldest messages until @p words are free. */
static void make_room(struct gz_board *board, size_t words)
{
	uint64_t tail = board->tail;
	while (board->head + words - tail > board->mask + 1)
		tail += (uint32_t)atomic_load_explicit(&board->words[tail & board->mask],
						       memory_order_relaxed);
	if (tail == board->tail)
		return;
	board->tail = tail;
	atomic_store_explicit(&board->header->tail, tail, memory_order_relaxed);
}

bool gz_board_write(struct gz_board *board, const struct gz_board_message *message)
{
	if (message->topic_size > GZ_BOARD_TOPIC_MAX || message->body_size > GZ_BOARD_BODY_MAX)
		return false;
	size_t words = HEAD_WORDS + words_of(message->topic_size) + words_of(message->body_size);
	make_room(board, words);
	uint64_t position = board->head;
	put_word(board, position, pack_sizes(words, message->topic_size));
	put_word(board, position + 1, (uint64_t)message->time_ns);
	put_word(board, position + 2, message->body_size);
	position = put_bytes(board, position + HEAD_WORDS, message->topic, message->topic_size);
	position = put_bytes(board, position, message->body, message->body_size);
	if (message->is_gaze)
		board->newest = board->head;
	board->head = position;
	board->written_ns = message->time_ns;
	return true;
}

/*
 * Waking the readers. A futex counts the rings of a bell; who waits for the ring after number n
 * waits with bit n modulo 32. So a wake-up can be for those only who have not heard the newest ring
 * yet.
 *
 * To wake a reader costs the writer about as much as its own wake-up does. So at high rates it
 * wakes one, and each reader that is woken wakes RELAYS others, if there are any. A reader that
 * does not, because it was killed just then, is kept from running, or does not know of this, leaves
 * others waiting until the next ring. The writer finds them there, and then wakes all itself for
 * some time: a short one if this happens now and then, as on a busy machine, and the longer the
 * sooner it happens again.
 */

/* Most readers woken at once; the others come first the next time. Chosen: so many threads of a
 * local program that wait for nothing delay the stream by a millisecond. */
enum { WAKES_MAX = 1024 };

/* How many others a reader wakes. Chosen: 15 readers are woken in four steps. */
enum { RELAYS = 2 };

/* Readers wake each other if rings follow each other so closely: the longest delay if one does not.
 * Chosen: the period of a tracker at 500 Hz. At lower rates wake-ups cost little. */
static const int64_t RELAY_NS = 2100 * GZ_NS_PER_US;

/* How long the writer wakes all, at first and at most. Chosen: long against the time for which a
 * reader is kept from running; and so that a reader that never wakes others delays them less than
 * twice a second. */
static const int64_t TOGETHER_LEAST_NS = 20 * GZ_NS_PER_MS;
static const int64_t TOGETHER_MOST_NS = GZ_NS_PER_S;

static long call_futex(const _Atomic uint32_t *word, int operation, uint32_t value,
		       const struct timespec *timeout, uint32_t bits)
{
	return syscall(SYS_futex, word, operation, value, timeout, NULL, bits);
}

/* The bit of those who wait for the ring after @p ring. */
static uint32_t bit_of_ring(uint32_t ring)
{
	return UINT32_C(1) << ring % 32;
}

/* @return how many were woken */
static long wake_waiting(const _Atomic uint32_t *bell, uint32_t count, uint32_t bits)
{
	return call_futex(bell, FUTEX_WAKE_BITSET, count, NULL, bits);
}

/* Readers were found that nobody had woken. */
static void wake_together(struct gz_board *board, int64_t now_ns)
{
	const bool soon = board->phase_ns > 0 && now_ns - board->together_ns < board->phase_ns;
	const int64_t longer_ns = soon ? 2 * board->phase_ns : TOGETHER_LEAST_NS;
	board->phase_ns = longer_ns < TOGETHER_MOST_NS ? longer_ns : TOGETHER_MOST_NS;
	board->together_ns = now_ns + board->phase_ns;
}

/* Wake those who wait for @p ring. */
static void wake_readers(struct gz_board *board, uint32_t ring)
{
	const _Atomic uint32_t *bell = &board->header->bell;
	const uint32_t next = bit_of_ring(ring), in_time = bit_of_ring(ring - 1);
	const int64_t now_ns = board->written_ns;
	const bool relay = now_ns - board->rung_ns < RELAY_NS && now_ns >= board->together_ns;
	wake_waiting(bell, relay ? 1 : WAKES_MAX, ~next);
	/* Those who have not even heard the ring before. */
	if (relay && board->chained && wake_waiting(bell, WAKES_MAX, ~(next | in_time)) > 0)
		wake_together(board, now_ns);
	board->chained = relay;
	board->rung_ns = now_ns;
}

void gz_board_show(struct gz_board *board, bool wake)
{
	struct board_header *header = board->header;
	atomic_store_explicit(&header->head, board->head, memory_order_release);
	atomic_store_explicit(&header->newest, board->newest, memory_order_release);
	uint32_t ring = 1 + atomic_fetch_add_explicit(&header->bell, 1, memory_order_release);
	if (wake)
		wake_readers(board, ring);
}

void gz_board_destroy(struct gz_board **board)
{
	if (!board || !*board)
		return;
	if ((*board)->header)
		munmap((*board)->header, GZ_BOARD_HEADER_SIZE + 8 * ((*board)->mask + 1));
	if ((*board)->fd >= 0)
		close((*board)->fd);
	free(*board);
	*board = NULL;
}

struct gz_board_reader {
	const struct board_header *header;
	const board_word *words;
	uint64_t mask;
	uint64_t position;
	uint64_t newest; /* the gaze that was read last; NO_POSITION: none */
	uint64_t overtaken;
	dev_t device; /* of the memory */
	ino_t inode;
	uint64_t copy[MESSAGE_WORDS_MAX]; /* of the message that was read last */
};

/* Check what the file of the memory promises, before it is mapped. */
static bool is_board_file(int fd, struct stat *status)
{
	int seals = fcntl(fd, F_GET_SEALS);
	bool fixed = seals >= 0 && (seals & F_SEAL_SHRINK) && (seals & F_SEAL_GROW) &&
		     (seals & (F_SEAL_FUTURE_WRITE | F_SEAL_WRITE));
	return fixed && fstat(fd, status) == 0 && status->st_size > GZ_BOARD_HEADER_SIZE &&
	       is_board_size((uint64_t)status->st_size - GZ_BOARD_HEADER_SIZE);
}

enum gz_result gz_board_open(int fd, struct gz_board_reader **out_reader)
{
	struct stat status;
	if (!is_board_file(fd, &status))
		return GZ_ERR_UNSUPPORTED;
	struct gz_board_reader *reader = calloc(1, sizeof *reader);
	if (!reader)
		return GZ_ERR_NO_MEM;
	size_t whole = (size_t)status.st_size, size = whole - GZ_BOARD_HEADER_SIZE;
	const void *memory = mmap(NULL, whole, PROT_READ, MAP_SHARED | MAP_POPULATE, fd, 0);
	if (memory == MAP_FAILED) {
		free(reader);
		return GZ_ERR_NO_MEM;
	}
	reader->header = memory;
	reader->words = (const board_word *)((const unsigned char *)memory + GZ_BOARD_HEADER_SIZE);
	reader->mask = size / 8 - 1;
	reader->newest = NO_POSITION;
	reader->device = status.st_dev;
	reader->inode = status.st_ino;
	reader->position = atomic_load_explicit(&reader->header->tail, memory_order_acquire);
	if (memcmp(reader->header->magic, GZ_BOARD_MAGIC, sizeof reader->header->magic) != 0 ||
	    reader->header->size != size) {
		gz_board_close(&reader);
		return GZ_ERR_UNSUPPORTED;
	}
	*out_reader = reader;
	return GZ_OK;
}

bool gz_board_is_same(const struct gz_board_reader *reader, int fd)
{
	struct stat status;
	return fstat(fd, &status) == 0 && status.st_dev == reader->device &&
	       status.st_ino == reader->inode;
}

static void copy_words(struct gz_board_reader *reader, uint64_t position, size_t first,
		       size_t count)
{
	for (size_t i = first; i < first + count; i++)
		reader->copy[i] = atomic_load_explicit(
			&reader->words[(position + i) & reader->mask], memory_order_acquire);
}

/* Whether the words that were copied last may have been overwritten meanwhile. */
static bool is_overtaken(const struct gz_board_reader *reader, uint64_t position)
{
	return atomic_load_explicit(&reader->header->tail, memory_order_relaxed) > position;
}

/* Read the sizes and the time of the message at @p position, which lies before @p head.
 * @retval GZ_ERR_END  it has been overwritten */
static enum gz_result copy_head(struct gz_board_reader *reader, uint64_t position, uint64_t head,
				size_t *out_words)
{
	copy_words(reader, position, 0, HEAD_WORDS);
	if (is_overtaken(reader, position))
		return GZ_ERR_END;
	size_t words = (uint32_t)reader->copy[0], topic_size = reader->copy[0] >> 32;
	uint64_t body_size = reader->copy[2];
	if (topic_size > GZ_BOARD_TOPIC_MAX || body_size > GZ_BOARD_BODY_MAX ||
	    words != HEAD_WORDS + words_of(topic_size) + words_of(body_size) ||
	    words > head - position)
		return GZ_ERR_PROTOCOL;
	*out_words = words;
	return GZ_OK;
}

/* Copy the message at @p position, as copy_head(). */
static enum gz_result copy_message(struct gz_board_reader *reader, uint64_t position, uint64_t head,
				   size_t *out_words)
{
	size_t words;
	enum gz_result result = copy_head(reader, position, head, &words);
	if (result != GZ_OK)
		return result;
	copy_words(reader, position, HEAD_WORDS, words - HEAD_WORDS);
	if (is_overtaken(reader, position))
		return GZ_ERR_END;
	*out_words = words;
	return GZ_OK;
}

static struct gz_board_record copied_record(const struct gz_board_reader *reader)
{
	size_t topic_size = reader->copy[0] >> 32;
	const uint64_t *topic = reader->copy + HEAD_WORDS;
	return (struct gz_board_record) {
		.topic = (const char *)topic,
		.topic_size = topic_size,
		.body = topic + words_of(topic_size),
		.body_size = (size_t)reader->copy[2],
		.time_ns = (int64_t)reader->copy[1],
	};
}

/* Find the next message, after those that were overwritten. @param[out] out_head  where messages
 * end
 * @retval GZ_ERR_TIMEOUT   there is none
 * @retval GZ_ERR_PROTOCOL  messages end before those that were read */
static enum gz_result find_message(struct gz_board_reader *reader, uint64_t *out_head)
{
	/* In this order: what lies between a head and a later tail is never more than the board. */
	uint64_t head = atomic_load_explicit(&reader->header->head, memory_order_acquire);
	uint64_t tail = atomic_load_explicit(&reader->header->tail, memory_order_acquire);
	if (reader->position < tail) {
		reader->position = tail;
		reader->overtaken++;
	}
	*out_head = head;
	if (reader->position < head)
		return head - reader->position <= reader->mask + 1 ? GZ_OK : GZ_ERR_PROTOCOL;
	/* While messages are written that are not shown yet, the tail may pass the head. */
	return reader->position > head && reader->position != tail ? GZ_ERR_PROTOCOL
								   : GZ_ERR_TIMEOUT;
}

/* Copy the newest gaze, once. @retval GZ_ERR_END  it has been overwritten */
static enum gz_result copy_newest(struct gz_board_reader *reader)
{
	size_t words;
	uint64_t newest = atomic_load_explicit(&reader->header->newest, memory_order_acquire);
	uint64_t head = atomic_load_explicit(&reader->header->head, memory_order_acquire);
	if (newest == NO_POSITION || newest == reader->newest)
		return GZ_ERR_TIMEOUT;
	if (newest >= head)
		return GZ_ERR_PROTOCOL;
	reader->newest = newest;
	return copy_message(reader, newest, head, &words);
}

/* Whether the message that was copied last was written before @p time_ns. */
static bool is_older(const struct gz_board_reader *reader, int64_t time_ns)
{
	return (int64_t)reader->copy[1] < time_ns;
}

enum gz_result gz_board_skip(struct gz_board_reader *reader, int64_t time_ns)
{
	enum gz_result result = copy_newest(reader);
	if (result == GZ_OK && !is_older(reader, time_ns))
		reader->newest = NO_POSITION; /* read it again */
	if (result == GZ_ERR_PROTOCOL)
		return result;
	for (;;) {
		uint64_t head;
		size_t words;
		result = find_message(reader, &head);
		if (result == GZ_OK)
			result = copy_head(reader, reader->position, head, &words);
		if (result == GZ_ERR_TIMEOUT || (result == GZ_OK && !is_older(reader, time_ns)))
			return GZ_OK;
		if (result == GZ_OK)
			reader->position += words;
		else if (result != GZ_ERR_END)
			return result;
	}
}

enum gz_result gz_board_next(struct gz_board_reader *reader, struct gz_board_record *out_record)
{
	for (;;) {
		uint64_t head;
		size_t words;
		enum gz_result result = find_message(reader, &head);
		if (result == GZ_OK)
			result = copy_message(reader, reader->position, head, &words);
		if (result == GZ_OK) {
			reader->position += words;
			*out_record = copied_record(reader);
		}
		if (result != GZ_ERR_END)
			return result;
	}
}

enum gz_result gz_board_newest(struct gz_board_reader *reader, struct gz_board_record *out_record)
{
	enum gz_result result;
	/* Ends, because one that is not newer is no result: other messages have overwritten it. */
	do
		result = copy_newest(reader);
	while (result == GZ_ERR_END);
	if (result == GZ_OK)
		*out_record = copied_record(reader);
	return result;
}

bool gz_board_has_next(const struct gz_board_reader *reader)
{
	return atomic_load_explicit(&reader->header->head, memory_order_acquire) > reader->position;
}

uint64_t gz_board_overtaken(const struct gz_board_reader *reader)
{
	return reader->overtaken;
}

/* Wake others who have not heard the newest ring, as wake_readers() expects of each who was woken.
 */
static void relay_ring(const struct gz_board_reader *reader)
{
	const _Atomic uint32_t *bell = &reader->header->bell;
	uint32_t ring = atomic_load_explicit(bell, memory_order_acquire);
	wake_waiting(bell, RELAYS, ~bit_of_ring(ring));
}

enum gz_result gz_board_wait(struct gz_board_reader *reader, int64_t timeout_ns)
{
	const int64_t until_ns = gz_clock_now_ns() + timeout_ns;
	const struct timespec until = { .tv_sec = (time_t)(until_ns / GZ_NS_PER_S),
					.tv_nsec = (long)(until_ns % GZ_NS_PER_S) };
	/* Before the look at the head: a message that is shown after it changes this number. */
	uint32_t ring = atomic_load_explicit(&reader->header->bell, memory_order_acquire);
	if (gz_board_has_next(reader))
		return GZ_OK;
	if (call_futex(&reader->header->bell, FUTEX_WAIT_BITSET, ring, &until, bit_of_ring(ring)) ==
	    0) {
		relay_ring(reader);
		return GZ_OK;
	}
	return errno == EAGAIN ? GZ_OK : errno == ETIMEDOUT ? GZ_ERR_TIMEOUT : GZ_ERR_IO;
}

void gz_board_close(struct gz_board_reader **reader)
{
	if (!reader || !*reader)
		return;
	munmap((void *)(uintptr_t)(*reader)->header,
	       GZ_BOARD_HEADER_SIZE + 8 * ((*reader)->mask + 1));
	free(*reader);
	*reader = NULL;
}
