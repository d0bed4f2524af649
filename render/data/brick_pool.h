/**
 * @file
 * Bricks in memory: a fixed number of rooms that the bricks of a file come and go in. Coarse levels
 * are read when the file is opened and stay, so that every place has a brick. Finer bricks are read
 * by threads of the pool while pictures are made, those of the greatest weight first.
 *
 * The books of the rooms (gz_brick_rooms_...) serve rooms in memory and on a graphics device
 * (render/raycast/gl/gl_bricks.h).
 */
#ifndef GZ_RENDER_DATA_BRICK_POOL_H
#define GZ_RENDER_DATA_BRICK_POOL_H

#include "base/log.h"
#include "base/result.h"
#include "render/data/brick_file.h"

/** Bits of a table's entry that hold the level; those above hold the room. */
#define GZ_BRICK_LEVEL_BITS 4

/** A brick that a picture would show, and how much its absence would be seen. */
struct gz_brick_want {
	float weight;   /**< above 0; compared with each other only */
	uint32_t brick; /**< its number */
};

/** What is said in place of a room. */
enum {
	GZ_BRICK_NOWHERE = -1,
	GZ_BRICK_UNREADABLE = -2, /**< and never will be anywhere */
};

/** What is in a room. */
struct gz_brick_room {
	uint32_t brick;
	bool taken, there; /**< for the brick, which may be on its way; it has come */
	bool pinned;       /**< it stays */
	float weight;      /**< when it was last wanted */
	uint64_t wanted;   /**< the turn in which it was */
	uint64_t taken_in; /**< the turn in which the room was taken for it */
};

/** The books. Zero-initialised has no rooms. */
struct gz_brick_rooms {
	const struct gz_brick_layout *layout; /**< borrowed */
	size_t count;
	struct gz_brick_room *room;
	int32_t *room_of; /**< by a brick's number: its room, or what is said in place of one */
	/** By a brick's number: the finest brick that is there, of its own level or coarser, over
	 *  its place: room << GZ_BRICK_LEVEL_BITS | level. -1 before any has come. */
	int32_t *table;
	uint64_t changes; /**< counts changes of the table */
	uint64_t turn;
	size_t free_at;  /**< rooms before it have been taken once */
	size_t *victims; /**< rooms, the least valuable first */
	size_t victim_count, victim_at;
	bool victims_known;
};

/** Begin with @p count empty rooms, 1 to the layout's bricks. @p layout: borrowed until
 *  gz_brick_rooms_free(), which is correct also after GZ_ERR_NO_MEM. */
enum gz_result gz_brick_rooms_init(struct gz_brick_rooms *rooms,
				   const struct gz_brick_layout *layout, size_t count);

/** The finest level that is kept for good with @p count rooms: all coarser ones with it fill an
 *  eighth of them at most (chosen); the last in any case. */
int gz_brick_rooms_pinned_level(const struct gz_brick_layout *layout, size_t count);

/** The next picture wants these; the least valuable rooms are found anew. What is taken until the
 *  next turn is to be taken in the order of its weight, the greatest first. */
void gz_brick_rooms_turn(struct gz_brick_rooms *rooms, const struct gz_brick_want *wants,
			 size_t count);

/** Whether gz_brick_rooms_take() would find a room. */
bool gz_brick_rooms_has(struct gz_brick_rooms *rooms, float weight);

/**
 * Take a room for a brick that has none: an empty one, else that of the brick that was not wanted
 * for longest, else that of the one of least weight, if it is less than @p weight.
 *
 * @return the room; GZ_BRICK_NOWHERE if all are worth more
 */
int32_t gz_brick_rooms_take(struct gz_brick_rooms *rooms, uint32_t brick, float weight);

/** The same for a brick that stays; there must be an empty room. */
int32_t gz_brick_rooms_pin(struct gz_brick_rooms *rooms, uint32_t brick);

/** The brick has come to the room taken for it. */
void gz_brick_rooms_let_in(struct gz_brick_rooms *rooms, int32_t room);

/** It never will: the room is empty again. */
void gz_brick_rooms_give_up(struct gz_brick_rooms *rooms, int32_t room);

/** Free and zero. */
void gz_brick_rooms_free(struct gz_brick_rooms *rooms);

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
