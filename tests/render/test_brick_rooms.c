/* The books of bricks in a fixed number of rooms. */
#include "suite.h"

#include "render/data/brick_pool.h"

enum { BRICKS = 65, ROOMS = 4 };

/* 64 bricks of level 0 and one over all of them. */
static const struct gz_brick_layout layout = {
	.level_count = 2,
	.brick_count = BRICKS,
	.levels = { { .dims = { 128, 128, 128 }, .bricks = { 4, 4, 4 } },
		    { .dims = { 32, 32, 32 },
		      .bricks = { 1, 1, 1 },
		      .halvings = { 2, 2, 2 },
		      .first = 64 } },
};

static struct gz_brick_rooms rooms_with_the_coarsest(void)
{
	struct gz_brick_rooms rooms = { 0 };
	assert_int_equal(gz_brick_rooms_init(&rooms, &layout, ROOMS), GZ_OK);
	gz_brick_rooms_let_in(&rooms, gz_brick_rooms_pin(&rooms, 64));
	return rooms;
}

/* Sorting all rooms for each brick that comes made waiting pictures slow. */
static void what_comes_in_the_turn_that_took_it_leaves_the_victims_known(void **state)
{
	(void)state;
	struct gz_brick_rooms rooms = rooms_with_the_coarsest();
	const struct gz_brick_want wants[] = { { 9, 0 }, { 8, 1 }, { 7, 2 }, { 6, 3 } };
	int32_t taken[3];
	gz_brick_rooms_turn(&rooms, wants, 4);
	for (int i = 0; i < 3; i++)
		taken[i] = gz_brick_rooms_take(&rooms, wants[i].brick, wants[i].weight);
	assert_int_equal(gz_brick_rooms_take(&rooms, 3, 6), GZ_BRICK_NOWHERE);
	assert_true(rooms.victims_known);
	for (int i = 0; i < 3; i++)
		gz_brick_rooms_let_in(&rooms, taken[i]);
	assert_true(rooms.victims_known);
	assert_int_equal(gz_brick_rooms_take(&rooms, 3, 6), GZ_BRICK_NOWHERE);
	gz_brick_rooms_free(&rooms);
}

static void what_was_sent_for_before_and_comes_late_makes_room(void **state)
{
	(void)state;
	struct gz_brick_rooms rooms = rooms_with_the_coarsest();
	const struct gz_brick_want before[] = { { 9, 0 }, { 8, 1 }, { 7, 2 } };
	const struct gz_brick_want now[] = { { 5, 3 } };
	int32_t taken[3];
	gz_brick_rooms_turn(&rooms, before, 3);
	for (int i = 0; i < 3; i++)
		taken[i] = gz_brick_rooms_take(&rooms, before[i].brick, before[i].weight);
	gz_brick_rooms_turn(&rooms, now, 1);
	/* All rooms are on their way: none can be had. */
	assert_int_equal(gz_brick_rooms_take(&rooms, 3, 5), GZ_BRICK_NOWHERE);
	gz_brick_rooms_let_in(&rooms, taken[1]);
	assert_int_equal(gz_brick_rooms_take(&rooms, 3, 5), taken[1]);
	assert_int_equal(rooms.room_of[1], GZ_BRICK_NOWHERE);
	gz_brick_rooms_free(&rooms);
}

static void room_of_a_brick_that_cannot_be_read_is_had_at_once(void **state)
{
	(void)state;
	struct gz_brick_rooms rooms = rooms_with_the_coarsest();
	const struct gz_brick_want wants[] = { { 9, 0 }, { 8, 1 }, { 7, 2 }, { 6, 3 } };
	int32_t taken[3];
	gz_brick_rooms_turn(&rooms, wants, 4);
	for (int i = 0; i < 3; i++)
		taken[i] = gz_brick_rooms_take(&rooms, wants[i].brick, wants[i].weight);
	assert_int_equal(gz_brick_rooms_take(&rooms, 3, 6), GZ_BRICK_NOWHERE);
	gz_brick_rooms_give_up(&rooms, taken[0]);
	assert_int_equal(rooms.room_of[0], GZ_BRICK_UNREADABLE);
	assert_int_equal(gz_brick_rooms_take(&rooms, 3, 6), taken[0]);
	gz_brick_rooms_free(&rooms);
}

TEST_SUITE(brick_rooms)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_comes_in_the_turn_that_took_it_leaves_the_victims_known),
		cmocka_unit_test(what_was_sent_for_before_and_comes_late_makes_room),
		cmocka_unit_test(room_of_a_brick_that_cannot_be_read_is_had_at_once),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
