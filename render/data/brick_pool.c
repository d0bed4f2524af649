#include "render/data/brick_pool.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define GZ_LOG_MODULE "volume"

/* Chosen: enough to keep the threads reading through a frame of 100 ms, few enough that a new gaze
 * is answered at once. */
#define ERRANDS_MAX 1024
/* Chosen: one waits for the disk while the other checks. */
#define FETCHERS 2
#define MIB      ((size_t)1 << 20)
/* Places in the rooms are 32-bit signed indices, as gathers take them. */
#define ROOMS_MAX ((size_t)(INT32_MAX / GZ_BRICK_VOXELS))
/* To bring a brick into a room, and how that went. */
struct errand {
	uint32_t brick;
	int32_t room;
	enum gz_result result;
};

struct gz_brick_pool {
	const struct gz_log *log;
	struct gz_brick_file *file;
	size_t brick_bytes;
	/* the rooms: only rooms on an errand are written to, and no table leads to these */
	size_t mapped;
	uint8_t *voxels;
	struct gz_brick_rooms rooms;
	size_t unreadable; /* bricks */
	/* between the threads */
	pthread_mutex_t mutex;
	pthread_cond_t errand_waits, errand_done;
	bool ending;
	struct errand waiting[ERRANDS_MAX], done[ERRANDS_MAX];
	size_t waiting_first, waiting_count, done_count, out_count;
	pthread_t fetchers[FETCHERS];
	int fetcher_count;
};

static void *fetch(void *argument)
{
	struct gz_brick_pool *pool = argument;
	pthread_mutex_lock(&pool->mutex);
	for (;;) {
		while (pool->waiting_count == 0 && !pool->ending)
			pthread_cond_wait(&pool->errand_waits, &pool->mutex);
		if (pool->ending)
			break;
		struct errand errand = pool->waiting[pool->waiting_first];
		pool->waiting_first = (pool->waiting_first + 1) % ERRANDS_MAX;
		pool->waiting_count--;
		pthread_mutex_unlock(&pool->mutex);
		errand.result =
			gz_brick_file_read(pool->file, errand.brick,
					   pool->voxels + (size_t)errand.room * pool->brick_bytes);
		pthread_mutex_lock(&pool->mutex);
		pool->done[pool->done_count++] = errand;
		pthread_cond_signal(&pool->errand_done);
	}
	pthread_mutex_unlock(&pool->mutex);
	return NULL;
}

/* What an errand has brought. */
static void let_in(struct gz_brick_pool *pool, const struct errand *errand)
{
	if (errand->result == GZ_OK) {
		gz_brick_rooms_let_in(&pool->rooms, errand->room);
		return;
	}
	/* A damaged file has thousands of them: the first, and in the end how many. */
	if (pool->unreadable++ == 0)
		gz_brick_file_complain(pool->file, errand->brick, errand->result);
	gz_brick_rooms_give_up(&pool->rooms, errand->room);
}

/* Bring in all that is done; with `wait`, at least one if any is out. Returns how many are out
 * still. */
static size_t collect(struct gz_brick_pool *pool, bool wait)
{
	struct errand done[ERRANDS_MAX];
	pthread_mutex_lock(&pool->mutex);
	while (wait && pool->done_count == 0 && pool->out_count > 0)
		pthread_cond_wait(&pool->errand_done, &pool->mutex);
	const size_t count = pool->done_count;
	memcpy(done, pool->done, count * sizeof done[0]);
	pool->done_count = 0;
	pool->out_count -= count;
	const size_t out = pool->out_count;
	pthread_mutex_unlock(&pool->mutex);
	for (size_t i = 0; i < count; i++)
		let_in(pool, &done[i]);
	return out;
}

/* Send for what is wanted and not there, while there is room and anybody to go. */
static size_t send_for(struct gz_brick_pool *pool, const struct gz_brick_want *wants, size_t count,
		       size_t out)
{
	struct errand errands[ERRANDS_MAX];
	size_t sent = 0;
	for (size_t i = 0; i < count && out + sent < ERRANDS_MAX; i++) {
		if (pool->rooms.room_of[wants[i].brick] != GZ_BRICK_NOWHERE)
			continue;
		const int32_t room =
			gz_brick_rooms_take(&pool->rooms, wants[i].brick, wants[i].weight);
		if (room == GZ_BRICK_NOWHERE)
			break;
		errands[sent++] = (struct errand) { .brick = wants[i].brick, .room = room };
	}
	pthread_mutex_lock(&pool->mutex);
	for (size_t i = 0; i < sent; i++)
		pool->waiting[(pool->waiting_first + pool->waiting_count++) % ERRANDS_MAX] =
			errands[i];
	pool->out_count += sent;
	if (sent > 0)
		pthread_cond_broadcast(&pool->errand_waits);
	pthread_mutex_unlock(&pool->mutex);
	return out + sent;
}

void gz_brick_pool_turn(struct gz_brick_pool *pool, const struct gz_brick_want *wants, size_t count,
			bool wait, struct gz_brick_view *out_view)
{
	size_t out = collect(pool, false);
	gz_brick_rooms_turn(&pool->rooms, wants, count);
	out = send_for(pool, wants, count, out);
	while (wait && out > 0) {
		out = collect(pool, true);
		out = send_for(pool, wants, count, out);
	}
	*out_view = (struct gz_brick_view) { .voxels = pool->voxels,
					     .table = pool->rooms.table,
					     .coming = out };
}

const struct gz_brick_file *gz_brick_pool_file(const struct gz_brick_pool *pool)
{
	return pool->file;
}

size_t gz_brick_pool_rooms(const struct gz_brick_pool *pool)
{
	return pool->rooms.count;
}

static size_t memory_preset(void)
{
	const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
	return pages > 0 && page > 0 ? (size_t)pages / 4 * (size_t)page : (size_t)1 << 30;
}

static enum gz_result count_rooms(const struct gz_brick_pool *pool, size_t memory_bytes,
				  size_t *out_rooms)
{
	const size_t bricks = pool->file->layout.brick_count;
	const size_t least = bricks < GZ_BRICK_POOL_LEAST ? bricks : GZ_BRICK_POOL_LEAST;
	size_t rooms = (memory_bytes ? memory_bytes : memory_preset()) / pool->brick_bytes;
	if (memory_bytes && rooms < least) {
		const size_t mib = (least * pool->brick_bytes + MIB - 1) / MIB;
		gz_err(pool->log,
		       "%s: volume.memory_mib: too little for its bricks; give it at least %zu, or "
		       "0 for a quarter of the machine's",
		       pool->file->path, mib);
		return GZ_ERR_INVAL;
	}
	rooms = rooms < least ? least : rooms;
	rooms = rooms > ROOMS_MAX ? ROOMS_MAX : rooms;
	*out_rooms = rooms > bricks ? bricks : rooms;
	return GZ_OK;
}

/* The voxels' pages come when bricks do. */
static enum gz_result make_rooms(struct gz_brick_pool *pool, size_t count)
{
	const enum gz_result result = gz_brick_rooms_init(&pool->rooms, &pool->file->layout, count);
	pool->mapped = count * pool->brick_bytes + GZ_VOLUME_PADDING;
	void *voxels = mmap(NULL, pool->mapped, PROT_READ | PROT_WRITE,
			    MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
	if (voxels != MAP_FAILED) {
		pool->voxels = voxels;
		(void)madvise(voxels, pool->mapped, MADV_HUGEPAGE); /* only a hint */
	}
	if (result != GZ_OK || !pool->voxels) {
		gz_err(pool->log, "%s: no memory for %zu bricks; set volume.memory_mib lower",
		       pool->file->path, count);
		return GZ_ERR_NO_MEM;
	}
	return GZ_OK;
}

static enum gz_result pin_level(struct gz_brick_pool *pool, int level, bool must)
{
	const struct gz_brick_layout *layout = &pool->file->layout;
	const size_t end = level + 1 < layout->level_count ? layout->levels[level + 1].first
							   : layout->brick_count;
	for (size_t i = layout->levels[level].first; i < end; i++) {
		struct errand errand = { .brick = (uint32_t)i };
		errand.room = gz_brick_rooms_pin(&pool->rooms, errand.brick);
		errand.result = gz_brick_file_read(
			pool->file, i, pool->voxels + (size_t)errand.room * pool->brick_bytes);
		let_in(pool, &errand);
		if (errand.result != GZ_OK && must)
			return errand.result;
	}
	return GZ_OK;
}

/* Coarsest first: what a finer one lacks then shows the coarser. */
static enum gz_result pin_levels(struct gz_brick_pool *pool)
{
	const struct gz_brick_layout *layout = &pool->file->layout;
	const int last = layout->level_count - 1;
	enum gz_result result = pin_level(pool, last, true);
	const int finest = gz_brick_rooms_pinned_level(layout, pool->rooms.count);
	for (int level = last - 1; level >= finest && result == GZ_OK; level--)
		result = pin_level(pool, level, false);
	return result;
}

static enum gz_result start_fetchers(struct gz_brick_pool *pool)
{
	for (int i = 0; i < FETCHERS; i++) {
		if (pthread_create(&pool->fetchers[i], NULL, fetch, pool) != 0) {
			gz_err(pool->log, "%s: no thread to read bricks", pool->file->path);
			return GZ_ERR_NO_MEM;
		}
		pool->fetcher_count++;
	}
	return GZ_OK;
}

enum gz_result gz_brick_pool_open(const char *path, size_t memory_bytes, const struct gz_log *log,
				  struct gz_brick_pool **out_pool)
{
	struct gz_brick_pool *pool = calloc(1, sizeof *pool);
	if (!pool)
		return GZ_ERR_NO_MEM;
	pool->log = log;
	pthread_mutex_init(&pool->mutex, NULL);
	pthread_cond_init(&pool->errand_waits, NULL);
	pthread_cond_init(&pool->errand_done, NULL);
	enum gz_result result = gz_brick_file_open(path, log, &pool->file);
	size_t rooms = 0;
	if (result == GZ_OK) {
		pool->brick_bytes = GZ_BRICK_VOXELS * gz_voxel_size(pool->file->header.type);
		result = count_rooms(pool, memory_bytes, &rooms);
	}
	if (result == GZ_OK)
		result = make_rooms(pool, rooms);
	if (result == GZ_OK)
		result = pin_levels(pool);
	if (result == GZ_OK)
		result = start_fetchers(pool);
	if (result != GZ_OK) {
		gz_brick_pool_destroy(&pool);
		return result;
	}
	*out_pool = pool;
	return GZ_OK;
}

void gz_brick_pool_destroy(struct gz_brick_pool **pool_pointer)
{
	struct gz_brick_pool *pool = *pool_pointer;
	if (!pool)
		return;
	pthread_mutex_lock(&pool->mutex);
	pool->ending = true;
	pthread_cond_broadcast(&pool->errand_waits);
	pthread_mutex_unlock(&pool->mutex);
	for (int i = 0; i < pool->fetcher_count; i++)
		pthread_join(pool->fetchers[i], NULL);
	pthread_cond_destroy(&pool->errand_done);
	pthread_cond_destroy(&pool->errand_waits);
	pthread_mutex_destroy(&pool->mutex);
	if (pool->unreadable > 1)
		gz_warn(pool->log, "%s: %zu bricks could not be read; write or fetch it again",
			pool->file->path, pool->unreadable);
	if (pool->voxels)
		(void)munmap(pool->voxels, pool->mapped);
	gz_brick_rooms_free(&pool->rooms);
	gz_brick_file_close(&pool->file);
	free(pool);
	*pool_pointer = NULL;
}
