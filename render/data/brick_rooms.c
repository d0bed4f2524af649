#include "render/data/brick_rooms.h"

#include <stdlib.h>

/* Share of the rooms that coarse levels may keep for good. */
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

/* A brick's entry is its own where it is there, else that of the brick over it; and so on for all
 * bricks under it. */
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
	/* What was taken in this turn weighs more than all that is still to come: it makes room for
	 * none of it. What was taken before may. */
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

/* How much a room's brick is worth in this turn: wanted ones by weight, others less, by age. */
static double worth(const struct gz_brick_rooms *rooms, const struct gz_brick_room *room)
{
	if (!room->taken)
		return -1e30;
	return room->wanted == rooms->turn ? (double)room->weight
					   : (double)room->wanted - (double)rooms->turn;
}

static int compare_worth(const void *a, const void *b, void *user)
{
	const struct gz_brick_rooms *rooms = user;
	const double left = worth(rooms, &rooms->room[*(const size_t *)a]);
	const double right = worth(rooms, &rooms->room[*(const size_t *)b]);
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

/* Whether there is an empty room, or the next victim is worth less than @p weight. */
bool gz_brick_rooms_has(struct gz_brick_rooms *rooms, float weight)
{
	if (rooms->free_at < rooms->count)
		return true;
	if (!rooms->victims_known)
		find_victims(rooms);
	if (rooms->victim_at == rooms->victim_count)
		return false;
	return worth(rooms, &rooms->room[rooms->victims[rooms->victim_at]]) < (double)weight;
}

static int32_t make_room(struct gz_brick_rooms *rooms, float weight)
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
	const int32_t room = make_room(rooms, weight);
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
