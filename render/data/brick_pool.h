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

/** A brick that a picture would use, and how visible its absence would be. */
struct gz_brick_want {
	float weight;   /**< above 0; only comparisons count */
	uint32_t brick; /**< its number */
};

/** What stands in place of a room. */
enum {
	GZ_BRICK_NOWHERE = -1,    /**< the brick has no room */
	GZ_BRICK_UNREADABLE = -2, /**< it cannot be read and never gets a room */
};

/** One room. */
struct gz_brick_room {
	uint32_t brick;
	bool taken;        /**< it belongs to the brick */
	bool there;        /**< the brick's voxels have arrived */
	bool pinned;       /**< the brick stays for good */
	float weight;      /**< of the brick, when it was last wanted */
	uint64_t wanted;   /**< the turn in which it was last wanted */
	uint64_t taken_in; /**< the turn in which the room was taken for it */
};

/** The books of a number of rooms. Zero-initialised has none. */
struct gz_brick_rooms {
	const struct gz_brick_layout *layout; /**< borrowed */
	size_t count;
	struct gz_brick_room *room;
	int32_t *room_of; /**< by a brick's number: its room, GZ_BRICK_NOWHERE or
			     GZ_BRICK_UNREADABLE */
	/** By a brick's number: the finest brick that is there over its place, of its own level or
	 *  coarser: room << GZ_BRICK_LEVEL_BITS | level. -1 before any has arrived. */
	int32_t *table;
	uint64_t changes; /**< counts changes of the table */
	uint64_t turn;
	size_t free_at;  /**< all rooms before it have been taken at least once */
	size_t *victims; /**< rooms, the least valuable first */
	size_t victim_count, victim_at;
	bool victims_known;
};

/** Start with @p count empty rooms, 1 to the number of bricks. @p layout is borrowed until
 *  gz_brick_rooms_free(), which may also be called after GZ_ERR_NO_MEM. */
enum gz_result gz_brick_rooms_init(struct gz_brick_rooms *rooms,
				   const struct gz_brick_layout *layout, size_t count);

/** The finest level that stays for good with @p count rooms: this level and all coarser ones fill
 * at most an eighth of the rooms (chosen). The coarsest always stays. */
int gz_brick_rooms_pinned_level(const struct gz_brick_layout *layout, size_t count);

/** Begin a turn: the next picture wants these bricks. Until the next turn, rooms must be taken in
 *  falling order of weight. */
void gz_brick_rooms_turn(struct gz_brick_rooms *rooms, const struct gz_brick_want *wants,
			 size_t count);

/** Whether gz_brick_rooms_take() would find a room for a brick of this weight. */
bool gz_brick_rooms_has(struct gz_brick_rooms *rooms, float weight);

/**
 * Take a room for a brick that has none: an empty one, or that of the brick that has not been
 * wanted for longest, or that of the brick of least weight if it is below @p weight.
 *
 * @return the room, or GZ_BRICK_NOWHERE if all bricks in rooms have more weight
 */
int32_t gz_brick_rooms_take(struct gz_brick_rooms *rooms, uint32_t brick, float weight);

/** Take an empty room, of which there must be one, for a brick that stays for good. */
int32_t gz_brick_rooms_pin(struct gz_brick_rooms *rooms, uint32_t brick);

/** The brick has arrived in the room taken for it. */
void gz_brick_rooms_let_in(struct gz_brick_rooms *rooms, int32_t room);

/** The brick cannot be read: mark it so and empty the room. */
void gz_brick_rooms_give_up(struct gz_brick_rooms *rooms, int32_t room);

/** Free the books and zero them. */
void gz_brick_rooms_free(struct gz_brick_rooms *rooms);

/** Least number of rooms of a pool, unless the file has fewer bricks (chosen: enough for a picture
 * of a thousand pixels a side to show fine levels). */
#define GZ_BRICK_POOL_LEAST 256

struct gz_brick_pool;

/** The bricks in memory while a picture is made; valid until the next turn. */
struct gz_brick_view {
	/** Voxels of all rooms; those of room r begin at r * GZ_BRICK_VOXELS. */
	const void *voxels;
	/** By a brick's number: the finest brick in memory over its place, of its own level or
	 *  coarser: room << GZ_BRICK_LEVEL_BITS | level. */
	const int32_t *table;
	size_t coming; /**< bricks that are being read */
};

/**
 * Open a file of bricks and read the coarse levels that stay: all that fit an eighth of the memory,
 * and always the coarsest.
 *
 * @param memory_bytes   for voxels; 0: a quarter of the machine's memory. No more is allocated than
 * the file needs; too little for GZ_BRICK_POOL_LEAST bricks (or all, if there are fewer) is refused
 * @param[out] out_pool  owned by the caller: gz_brick_pool_destroy()
 * @return the results of gz_brick_file_open() and, for the coarsest level, of gz_brick_file_read();
 * logged
 * @retval GZ_ERR_INVAL  @p memory_bytes is too little; logged with the least allowed
 */
enum gz_result gz_brick_pool_open(const char *path, size_t memory_bytes, const struct gz_log *log,
				  struct gz_brick_pool **out_pool);

/** The pool's file; valid as long as the pool. */
const struct gz_brick_file *gz_brick_pool_file(const struct gz_brick_pool *pool);

/** Number of rooms. */
size_t gz_brick_pool_rooms(const struct gz_brick_pool *pool);

/**
 * Between two pictures: take in the bricks that have been read, and start reading those that are
 * wanted. See gz_brick_rooms_take() for the bricks that they replace.
 *
 * @param wants   in falling order of weight
 * @param wait    return only when all wanted bricks that have room have been read
 * @param[out] out_view  for the next picture
 *
 * A brick that cannot be read is not tried again; the first such brick is logged, and their number
 * when the pool is destroyed. Threads: one at a time; the view of the last turn must not be in use.
 */
void gz_brick_pool_turn(struct gz_brick_pool *pool, const struct gz_brick_want *wants, size_t count,
			bool wait, struct gz_brick_view *out_view);

/** The view of the last turn, again; before the first, of the levels that stay. */
void gz_brick_pool_view(const struct gz_brick_pool *pool, struct gz_brick_view *out_view);

/** Stop the threads, close the file, free everything and set to NULL. Accepts a pointer to NULL. */
void gz_brick_pool_destroy(struct gz_brick_pool **pool);

#endif
