/**
 * @file
 * Which bricks are in a fixed number of rooms, and which make room for others: the books alone, of
 * rooms in memory (brick_pool.h) or on a graphics device (render/raycast/gl/gl_bricks.h).
 */
#ifndef GZ_RENDER_DATA_BRICK_ROOMS_H
#define GZ_RENDER_DATA_BRICK_ROOMS_H

#include "base/result.h"
#include "render/data/brick_layout.h"

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

#endif
