/* Bricks in memory: the books of the rooms first, then the pool. */
#include "render/data/brick_pool.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define GZ_LOG_MODULE "volume"

/* Coarse levels may keep one in so many rooms for good. */
#define PINNED_SHARE 8

enum gz_result gz_brick_rooms_init(struct gz_brick_rooms *rooms,
				   const struct gz_brick_layout *layout, size_t count)
{
	const size_t bricks = layout->brick_count;
	*rooms = (struct gz_brick_rooms) {
		.layout = layout,
		.count = count,
		.room = calloc(count, sizeof *rooms->room),
		.victims = malloc(count * sizeof *rooms->victims),
		.room_of = malloc(bricks * sizeof *rooms->room_of),
		.table = malloc(bricks * sizeof *rooms->table),
	};
	if (!rooms->room || !rooms->victims || !rooms->room_of || !rooms->table) {
		gz_brick_rooms_free(rooms);
		return GZ_ERR_NO_MEM;
	}
	for (size_t i = 0; i < bricks; i++) {
		rooms->room_of[i] = GZ_BRICK_NOWHERE;
		rooms->table[i] = -1;
	}
	return GZ_OK;
}

int gz_brick_rooms_pinned_level(const struct gz_brick_layout *layout, size_t count)
{
	int level = layout->level_count - 1;
	while (level > 0 &&
	       layout->brick_count - layout->levels[level - 1].first <= count / PINNED_SHARE)
		level--;
	return level;
}

/* A brick's entry is the brick itself if it is there, otherwise the entry of the brick over it.
 * Updates all bricks under it too. */
static void update_table(struct gz_brick_rooms *rooms, int level, const int brick[3])
{
	const struct gz_brick_layout *layout = rooms->layout;
	const size_t number = gz_brick_number(layout, level, brick);
	const int32_t room = rooms->room_of[number];
	int32_t entry = 0;
	if (room >= 0 && rooms->room[room].there) {
		entry = room << GZ_BRICK_LEVEL_BITS | level;
	} else if (level + 1 < layout->level_count) {
		int parent[3];
		gz_brick_parent(layout, level, brick, parent);
		entry = rooms->table[gz_brick_number(layout, level + 1, parent)];
	}
	if (rooms->table[number] == entry)
		return;
	rooms->table[number] = entry;
	rooms->changes++;
	if (level == 0)
		return;
	int first[3], end[3];
	gz_brick_children(layout, level, brick, first, end);
	for (int z = first[2]; z < end[2]; z++)
		for (int y = first[1]; y < end[1]; y++)
			for (int x = first[0]; x < end[0]; x++)
				update_table(rooms, level - 1, (const int[3]) { x, y, z });
}

static void update_brick(struct gz_brick_rooms *rooms, uint32_t number)
{
	int level, brick[3];
	gz_brick_place(rooms->layout, number, &level, brick);
	update_table(rooms, level, brick);
}

void gz_brick_rooms_let_in(struct gz_brick_rooms *rooms, int32_t room)
{
	struct gz_brick_room *at = &rooms->room[room];
	at->there = true;
	/* A brick taken in this turn weighs more than those that follow and makes room for none of
	 * them. A brick taken in an earlier turn may. */
	if (at->taken_in != rooms->turn)
		rooms->victims_known = false;
	update_brick(rooms, at->brick);
}

void gz_brick_rooms_give_up(struct gz_brick_rooms *rooms, int32_t room)
{
	struct gz_brick_room *at = &rooms->room[room];
	rooms->room_of[at->brick] = GZ_BRICK_UNREADABLE;
	at->there = false;
	at->taken = false;
	at->wanted = 0;
	rooms->victims_known = false;
}

/* Value of a room in this turn: the weight of a wanted brick; less for others, by age. */
static double room_worth(const struct gz_brick_rooms *rooms, const struct gz_brick_room *room)
{
	if (!room->taken)
		return -1e30;
	return room->wanted == rooms->turn ? (double)room->weight
					   : (double)room->wanted - (double)rooms->turn;
}

static int compare_worth(const void *a, const void *b, void *user)
{
	const struct gz_brick_rooms *rooms = user;
	const double left = room_worth(rooms, &rooms->room[*(const size_t *)a]);
	const double right = room_worth(rooms, &rooms->room[*(const size_t *)b]);
	return left < right ? -1 : left > right;
}

static void find_victims(struct gz_brick_rooms *rooms)
{
	rooms->victim_count = rooms->victim_at = 0;
	for (size_t i = 0; i < rooms->count; i++) {
		const struct gz_brick_room *room = &rooms->room[i];
		if (!room->pinned && (room->there || !room->taken))
			rooms->victims[rooms->victim_count++] = i;
	}
	qsort_r(rooms->victims, rooms->victim_count, sizeof *rooms->victims, compare_worth, rooms);
	rooms->victims_known = true;
}

/* An empty room, or one whose brick is worth less than @p weight. */
bool gz_brick_rooms_has(struct gz_brick_rooms *rooms, float weight)
{
	if (rooms->free_at < rooms->count)
		return true;
	if (!rooms->victims_known)
		find_victims(rooms);
	if (rooms->victim_at == rooms->victim_count)
		return false;
	return room_worth(rooms, &rooms->room[rooms->victims[rooms->victim_at]]) < (double)weight;
}

static int32_t free_a_room(struct gz_brick_rooms *rooms, float weight)
{
	if (!gz_brick_rooms_has(rooms, weight))
		return GZ_BRICK_NOWHERE;
	if (rooms->free_at < rooms->count)
		return (int32_t)rooms->free_at++;
	const size_t victim = rooms->victims[rooms->victim_at++];
	struct gz_brick_room *room = &rooms->room[victim];
	if (room->taken) {
		const uint32_t brick = room->brick;
		rooms->room_of[brick] = GZ_BRICK_NOWHERE;
		*room = (struct gz_brick_room) { 0 };
		update_brick(rooms, brick);
	}
	return (int32_t)victim;
}

int32_t gz_brick_rooms_take(struct gz_brick_rooms *rooms, uint32_t brick, float weight)
{
	const int32_t room = free_a_room(rooms, weight);
	if (room == GZ_BRICK_NOWHERE)
		return room;
	rooms->room[room] = (struct gz_brick_room) {
		.brick = brick,
		.taken = true,
		.weight = weight,
		.wanted = rooms->turn,
		.taken_in = rooms->turn,
	};
	rooms->room_of[brick] = room;
	return room;
}

int32_t gz_brick_rooms_pin(struct gz_brick_rooms *rooms, uint32_t brick)
{
	const int32_t room = gz_brick_rooms_take(rooms, brick, 0);
	rooms->room[room].pinned = true;
	return room;
}

void gz_brick_rooms_turn(struct gz_brick_rooms *rooms, const struct gz_brick_want *wants,
			 size_t count)
{
	rooms->turn++;
	rooms->victims_known = false;
	for (size_t i = 0; i < count; i++) {
		const int32_t room = rooms->room_of[wants[i].brick];
		if (room < 0)
			continue;
		rooms->room[room].wanted = rooms->turn;
		rooms->room[room].weight = wants[i].weight;
	}
}

void gz_brick_rooms_free(struct gz_brick_rooms *rooms)
{
	free(rooms->room);
	free(rooms->victims);
	free(rooms->room_of);
	free(rooms->table);
	*rooms = (struct gz_brick_rooms) { 0 };
}

/* Bricks that are being read at most. Chosen: enough to keep the threads busy for a frame of 100
 * ms, few enough to follow a new gaze at once. */
#define ERRANDS_MAX 1024
/* Chosen: one waits for the disk while the other verifies a checksum. */
#define FETCHERS 2
#define MIB      ((size_t)1 << 20)
/* Places in the rooms are 32-bit signed indices, as gathers take them. */
#define ROOMS_MAX ((size_t)(INT32_MAX / GZ_BRICK_VOXELS))
/* Reading a brick into a room, and its result. */
struct errand {
	uint32_t brick;
	int32_t room;
	enum gz_result result;
};

struct gz_brick_pool {
	const struct gz_log *log;
	struct gz_brick_file *file;
	size_t brick_bytes;
	/* the rooms: threads write only to rooms on an errand, which no table points to */
	size_t mapped;
	uint8_t *voxels;
	struct gz_brick_rooms rooms;
	size_t unreadable; /* bricks */
	size_t coming;     /* after the last turn */
	/* shared between the threads, guarded by mutex */
	pthread_mutex_t mutex;
	pthread_cond_t errand_waits, errand_done;
	bool ending;
	struct errand waiting[ERRANDS_MAX], done[ERRANDS_MAX];
	size_t waiting_first, waiting_count, done_count, out_count;
	pthread_t fetchers[FETCHERS];
	int fetcher_count;
};

static void *fetch_bricks(void *argument)
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

/* Take in the result of an errand. */
static void let_in(struct gz_brick_pool *pool, const struct errand *errand)
{
	if (errand->result == GZ_OK) {
		gz_brick_rooms_let_in(&pool->rooms, errand->room);
		return;
	}
	/* A damaged file may have thousands: log the first now and their number at the end. */
	if (pool->unreadable++ == 0)
		gz_brick_file_complain(pool->file, errand->brick, errand->result);
	gz_brick_rooms_give_up(&pool->rooms, errand->room);
}

/* Take in all finished errands; with `wait`, wait for at least one if any is out. Returns how many
 * are still out. */
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

/* Start reading wanted bricks that are not there, while there are rooms and free errands. */
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
	pool->coming = out;
	gz_brick_pool_view(pool, out_view);
}

void gz_brick_pool_view(const struct gz_brick_pool *pool, struct gz_brick_view *out_view)
{
	*out_view = (struct gz_brick_view) { .voxels = pool->voxels,
					     .table = pool->rooms.table,
					     .coming = pool->coming };
}

const struct gz_brick_file *gz_brick_pool_file(const struct gz_brick_pool *pool)
{
	return pool->file;
}

size_t gz_brick_pool_rooms(const struct gz_brick_pool *pool)
{
	return pool->rooms.count;
}

static enum gz_result count_rooms(const struct gz_brick_pool *pool, size_t memory_bytes,
				  size_t *out_rooms)
{
	const size_t bricks = pool->file->layout.brick_count;
	const size_t least = bricks < GZ_BRICK_POOL_LEAST ? bricks : GZ_BRICK_POOL_LEAST;
	size_t rooms = (memory_bytes ? memory_bytes : gz_volume_memory_bytes()) / pool->brick_bytes;
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

/* Pages of the mapping are allocated when bricks are read into them. */
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

/* Coarsest first, so that a brick missing in a finer level shows the coarser one. */
static enum gz_result pin_coarse_levels(struct gz_brick_pool *pool)
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
		if (pthread_create(&pool->fetchers[i], NULL, fetch_bricks, pool) != 0) {
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
		result = pin_coarse_levels(pool);
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
