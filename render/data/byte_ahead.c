#include "render/data/byte_ahead.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Chosen: a block is a fraction of a millisecond of decoding, the ring fits a second-level cache.
 */
#define BLOCK_BYTES ((size_t)256 << 10)
enum { BLOCKS = 4 };

struct block {
	uint8_t *bytes;
	size_t size; /* bytes in it */
	enum gz_result result;
};

struct gz_byte_ahead {
	gz_byte_source *source;
	void *user;
	uint64_t left; /* bytes to make; the thread's own */
	pthread_t thread;
	pthread_mutex_t mutex;
	pthread_cond_t changed;
	uint64_t made, taken; /* blocks; guarded by mutex, as what follows */
	bool through;         /* no more will be made */
	bool ending;
	struct block blocks[BLOCKS]; /* the reader's from taken on, the thread's from made on */
	size_t at;                   /* bytes read of the first; the reader's own */
	uint8_t memory[BLOCKS * BLOCK_BYTES];
};

/* The block to fill next; NULL where nobody wants any more. */
static struct block *await_room(struct gz_byte_ahead *ahead)
{
	pthread_mutex_lock(&ahead->mutex);
	while (!ahead->ending && ahead->made - ahead->taken == BLOCKS)
		pthread_cond_wait(&ahead->changed, &ahead->mutex);
	struct block *block = ahead->ending ? NULL : &ahead->blocks[ahead->made % BLOCKS];
	pthread_mutex_unlock(&ahead->mutex);
	return block;
}

static void hand_over(struct gz_byte_ahead *ahead, bool through)
{
	pthread_mutex_lock(&ahead->mutex);
	ahead->made++;
	ahead->through = through;
	pthread_cond_signal(&ahead->changed);
	pthread_mutex_unlock(&ahead->mutex);
}

static void *make(void *user)
{
	struct gz_byte_ahead *ahead = user;
	struct block *block;
	bool through = false;
	while (!through && (block = await_room(ahead))) {
		const size_t wanted = ahead->left < BLOCK_BYTES ? (size_t)ahead->left : BLOCK_BYTES;
		block->size = 0;
		block->result = ahead->source(ahead->user, block->bytes, wanted, &block->size);
		ahead->left -= block->size;
		through = block->result != GZ_OK || block->size < wanted || ahead->left == 0;
		hand_over(ahead, through);
	}
	return NULL;
}

enum gz_result gz_byte_ahead_start(gz_byte_source *source, void *user, uint64_t bytes,
				   struct gz_byte_ahead **out_ahead)
{
	struct gz_byte_ahead *ahead = malloc(sizeof *ahead);
	if (!ahead)
		return GZ_ERR_NO_MEM;
	memset(ahead, 0, offsetof(struct gz_byte_ahead, memory));
	ahead->source = source;
	ahead->user = user;
	ahead->left = bytes;
	for (int i = 0; i < BLOCKS; i++)
		ahead->blocks[i].bytes = ahead->memory + (size_t)i * BLOCK_BYTES;
	pthread_mutex_init(&ahead->mutex, NULL);
	pthread_cond_init(&ahead->changed, NULL);
	if (pthread_create(&ahead->thread, NULL, make, ahead) != 0) {
		pthread_cond_destroy(&ahead->changed);
		pthread_mutex_destroy(&ahead->mutex);
		free(ahead);
		return GZ_ERR_NO_MEM;
	}
	*out_ahead = ahead;
	return GZ_OK;
}

/* The block to read next; NULL where no more will come. */
static struct block *await_block(struct gz_byte_ahead *ahead)
{
	pthread_mutex_lock(&ahead->mutex);
	while (ahead->made == ahead->taken && !ahead->through)
		pthread_cond_wait(&ahead->changed, &ahead->mutex);
	struct block *block =
		ahead->made == ahead->taken ? NULL : &ahead->blocks[ahead->taken % BLOCKS];
	pthread_mutex_unlock(&ahead->mutex);
	return block;
}

static void give_back(struct gz_byte_ahead *ahead)
{
	pthread_mutex_lock(&ahead->mutex);
	ahead->taken++;
	ahead->at = 0;
	pthread_cond_signal(&ahead->changed);
	pthread_mutex_unlock(&ahead->mutex);
}

enum gz_result gz_byte_ahead_read(struct gz_byte_ahead *ahead, void *buffer, size_t size,
				  size_t *out_got)
{
	size_t got = 0;
	struct block *block;
	while (got < size && (block = await_block(ahead))) {
		if (block->result != GZ_OK)
			return block->result; /* and stays the next one */
		const size_t there = block->size - ahead->at;
		const size_t part = there < size - got ? there : size - got;
		memcpy((uint8_t *)buffer + got, block->bytes + ahead->at, part);
		got += part;
		ahead->at += part;
		if (ahead->at == block->size)
			give_back(ahead);
	}
	*out_got = got;
	return GZ_OK;
}

void gz_byte_ahead_end(struct gz_byte_ahead **ahead)
{
	struct gz_byte_ahead *a = *ahead;
	if (!a)
		return;
	pthread_mutex_lock(&a->mutex);
	a->ending = true;
	pthread_cond_signal(&a->changed);
	pthread_mutex_unlock(&a->mutex);
	pthread_join(a->thread, NULL);
	pthread_cond_destroy(&a->changed);
	pthread_mutex_destroy(&a->mutex);
	free(a);
	*ahead = NULL;
}
