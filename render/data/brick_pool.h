/**
 * @file
 * Bricks in memory: a fixed room that the bricks of a file come and go in. Coarse levels are there
 * from the beginning and stay, so that every place has a brick; finer ones are fetched by threads
 * of their own while pictures are made, those with the greatest weight first.
 */
#ifndef GZ_RENDER_DATA_BRICK_POOL_H
#define GZ_RENDER_DATA_BRICK_POOL_H

#include "base/log.h"
#include "base/result.h"
#include "render/data/brick_file.h"
#include "render/data/brick_rooms.h"

/** The least number of bricks that a pool has room for, where the file has as many (chosen: a
 *  picture of a thousand pixels a side is not all coarse). */
#define GZ_BRICK_POOL_LEAST 256

struct gz_brick_pool;

/** What is in memory while a picture is made: valid until the next turn. */
struct gz_brick_view {
	/** Voxels of all rooms: that of brick r begins at r * GZ_BRICK_VOXELS. */
	const void *voxels;
	/** By a brick's number: the finest brick in memory, of its own level or coarser, over its
	 *  place: room << GZ_BRICK_LEVEL_BITS | level. */
	const int32_t *table;
	size_t coming; /**< bricks asked for and not there yet */
};

/**
 * Open a file of bricks and read the coarse levels that stay: all that fit an eighth of the memory,
 * and the coarsest in any case.
 *
 * @param memory_bytes   for voxels; 0 = a quarter of the machine's memory. More than the file has
 * is not taken; less than GZ_BRICK_POOL_LEAST bricks, or all of fewer, is refused
 * @param[out] out_pool  owned by the caller: gz_brick_pool_destroy()
 * @return what gz_brick_file_open() returns, also where the coarsest level cannot be read; logged
 * @retval GZ_ERR_INVAL  @p memory_bytes is too little; logged with the least
 */
enum gz_result gz_brick_pool_open(const char *path, size_t memory_bytes, const struct gz_log *log,
				  struct gz_brick_pool **out_pool);

/** The file. Read-only; valid as long as the pool. */
const struct gz_brick_file *gz_brick_pool_file(const struct gz_brick_pool *pool);

/** Bricks that have room at once. */
size_t gz_brick_pool_rooms(const struct gz_brick_pool *pool);

/**
 * Between two pictures: let in what has come, and send for what is wanted. A wanted brick takes the
 * room of one that is not, the least lately wanted first, else that of one of less weight.
 *
 * @param wants   greatest weight first
 * @param wait    return only when nothing more is coming: the most that there is room for is there
 * @param[out] out_view  what to make the next picture of
 *
 * A brick that cannot be read is never asked for again; the first is logged, and how many there
 * were when the pool is destroyed. Threads: one at a time, and none may read what an earlier turn
 * gave.
 */
void gz_brick_pool_turn(struct gz_brick_pool *pool, const struct gz_brick_want *wants, size_t count,
			bool wait, struct gz_brick_view *out_view);

/** End the threads, close the file, free, set to NULL. Accepts a pointer to NULL. */
void gz_brick_pool_destroy(struct gz_brick_pool **pool);

#endif
