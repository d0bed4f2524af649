#include "suite.h"

#include <stdio.h>
#include <string.h>

#include "daemon/readers.h"
#include "protocol/board/board.h"

enum { SIZE = 128 };

static struct gz_readers *readers;

static int set_up(void **state)
{
	(void)state;
	return gz_readers_create(SIZE, &readers) == GZ_OK ? 0 : -1;
}

static int tear_down(void **state)
{
	(void)state;
	gz_readers_destroy(&readers);
	gz_readers_destroy(&readers);
	return readers != NULL;
}

static enum gz_result subscribe(int fd, uint64_t identity, const char *topic)
{
	return gz_readers_subscribe(readers, fd, identity, topic, strlen(topic));
}

static enum gz_result subscribe_number(int fd, uint64_t identity, int number)
{
	char topic[32];
	snprintf(topic, sizeof topic, "%d", number);
	return subscribe(fd, identity, topic);
}

static void assert_sums(uint32_t subscriptions, uint32_t pupils, uint32_t topics_size)
{
	struct gz_readers_sums sums = gz_readers_sums(readers);
	assert_int_equal(sums.subscriptions, subscriptions);
	assert_int_equal(sums.pupils, pupils);
	assert_int_equal(sums.topics_size, topics_size);
}

static void readers_topics_are_counted_once_each(void **state)
{
	(void)state;
	assert_int_equal(subscribe(5, 1, "gaze."), GZ_OK);
	assert_int_equal(subscribe(5, 1, "gaze."), GZ_OK);
	assert_int_equal(subscribe(6, 2, "gaze."), GZ_OK);
	assert_int_equal(subscribe(6, 2, ""), GZ_OK);
	assert_int_equal(subscribe(6, 2, "pupil.1"), GZ_OK);
	assert_int_equal(subscribe(6, 2, "pupil.x"), GZ_OK);
	assert_sums(5, 2, 2 * 7 + 2 + 2 * 9);
	gz_readers_unsubscribe(readers, 6, 2, "pupil.1", 7);
	gz_readers_unsubscribe(readers, 6, 2, "pupil.1", 7);
	gz_readers_unsubscribe(readers, 5, 1, "never", 5);
	assert_sums(4, 1, 2 * 7 + 2 + 9);
}

static void assert_board_sums(uint32_t boards, uint32_t remote, uint32_t pupils)
{
	struct gz_readers_sums sums = gz_readers_sums(readers);
	assert_int_equal(sums.boards, boards);
	assert_int_equal(sums.remote, remote);
	assert_int_equal(sums.pupils, pupils);
}

static void readers_of_the_board_are_counted(void **state)
{
	(void)state;
	static const char gaze[] = GZ_BOARD_TOPIC "gaze.", pupil[] = GZ_BOARD_TOPIC "pupil.0",
			  shorter[] = "\0board", all[] = GZ_BOARD_TOPIC;
	assert_int_equal(gz_readers_subscribe(readers, 5, 1, gaze, sizeof gaze - 1), GZ_OK);
	assert_int_equal(gz_readers_subscribe(readers, 6, 2, pupil, sizeof pupil - 1), GZ_OK);
	assert_int_equal(gz_readers_subscribe(readers, 6, 2, gaze, sizeof gaze - 1), GZ_OK);
	assert_int_equal(gz_readers_subscribe(readers, 7, 3, shorter, sizeof shorter - 1), GZ_OK);
	assert_int_equal(subscribe(7, 3, ""), GZ_OK);
	assert_board_sums(2, 2, 2);
	assert_int_equal(gz_readers_sums(readers).subscriptions, 5);
	gz_readers_unsubscribe(readers, 6, 2, gaze, sizeof gaze - 1);
	assert_board_sums(2, 2, 2);
	gz_readers_unsubscribe(readers, 6, 2, pupil, sizeof pupil - 1);
	assert_board_sums(1, 2, 1);
	gz_readers_unsubscribe(readers, 5, 1, gaze, sizeof gaze - 1);
	assert_board_sums(0, 2, 1);
	assert_int_equal(gz_readers_subscribe(readers, 5, 1, all, sizeof all - 1), GZ_OK);
	assert_board_sums(1, 2, 2);
	assert_int_equal(subscribe(5, 9, "status"), GZ_OK);
	assert_board_sums(0, 3, 1);
}

/* A subscription to the beginning of the topic, or to one surface. */
static void readers_of_surfaces_are_counted(void **state)
{
	(void)state;
	static const char board[] = GZ_BOARD_TOPIC "surfaces.screen";
	static const char *const topics[] = { "", "surf", "surfaces.", "surfaces.screen" };
	assert_int_equal(subscribe(5, 1, "surfaces_"), GZ_OK);
	assert_int_equal(subscribe(5, 1, "gaze."), GZ_OK);
	assert_int_equal(gz_readers_sums(readers).surfaces, 0);
	for (uint32_t i = 0; i < 4; i++) {
		assert_int_equal(subscribe(6, 2, topics[i]), GZ_OK);
		assert_int_equal(gz_readers_sums(readers).surfaces, i + 1);
	}
	assert_int_equal(gz_readers_subscribe(readers, 7, 3, board, sizeof board - 1), GZ_OK);
	assert_int_equal(gz_readers_sums(readers).surfaces, 5);
	gz_readers_unsubscribe(readers, 7, 3, board, sizeof board - 1);
	gz_readers_unsubscribe(readers, 6, 2, "surf", 4);
	assert_int_equal(gz_readers_sums(readers).surfaces, 3);
}

static void readers_beyond_their_number_are_refused_once(void **state)
{
	(void)state;
	for (int i = 0; i < GZ_READER_SUBSCRIPTIONS; i++)
		assert_int_equal(subscribe_number(5, 1, i), GZ_OK);
	assert_int_equal(subscribe(5, 1, "0"), GZ_OK);
	assert_int_equal(subscribe(5, 1, "one more"), GZ_ERR_FULL);
	assert_int_equal(subscribe(5, 1, "another"), GZ_ERR_ACCESS);
	assert_int_equal(gz_readers_sums(readers).subscriptions, GZ_READER_SUBSCRIPTIONS);
	assert_int_equal(subscribe(6, 2, "another"), GZ_OK);
}

static void readers_beyond_their_room_are_refused(void **state)
{
	(void)state;
	char topic[1023];
	memset(topic, 'x', sizeof topic);
	for (int i = 0; i < 3; i++) {
		topic[0] = (char)('a' + i);
		assert_int_equal(gz_readers_subscribe(readers, 5, 1, topic, sizeof topic), GZ_OK);
	}
	topic[0] = 'd';
	assert_int_equal(gz_readers_subscribe(readers, 5, 1, topic, 1019), GZ_OK);
	assert_sums(4, 0, GZ_READER_TOPICS_SIZE);
	assert_int_equal(subscribe(5, 1, ""), GZ_ERR_FULL);
	gz_readers_unsubscribe(readers, 5, 1, topic, 1019);
	assert_sums(3, 0, 3 * 1025);
}

static void readers_beyond_the_number_of_all_are_refused(void **state)
{
	(void)state;
	const int full = GZ_READERS_SUBSCRIPTIONS / GZ_READER_SUBSCRIPTIONS;
	for (int fd = 0; fd < full; fd++) {
		for (int i = 0; i < GZ_READER_SUBSCRIPTIONS; i++)
			assert_int_equal(subscribe_number(fd, 7, i), GZ_OK);
	}
	assert_int_equal(subscribe(full, 7, "gaze."), GZ_ERR_FULL);
}

static void readers_of_another_connection_begin_anew(void **state)
{
	(void)state;
	assert_int_equal(subscribe(5, 1, "pupil."), GZ_OK);
	assert_int_equal(subscribe(5, 2, "gaze."), GZ_OK);
	assert_sums(1, 0, 7);
	assert_int_equal(subscribe(SIZE, 2, "gaze."), GZ_ERR_INVAL);
	assert_int_equal(subscribe(-1, 2, "gaze."), GZ_ERR_INVAL);
	gz_readers_unsubscribe(readers, SIZE, 2, "gaze.", 5);
}

static uint64_t all_but_five_live(int fd)
{
	return fd == 5 ? 0 : 1;
}

static void readers_that_left_are_swept(void **state)
{
	(void)state;
	assert_int_equal(subscribe(5, 1, "pupil."), GZ_OK);
	assert_int_equal(subscribe(6, 1, "gaze."), GZ_OK);
	assert_int_equal(subscribe(7, 2, "pupil."), GZ_OK);
	gz_readers_sweep(readers, all_but_five_live);
	assert_sums(1, 0, 7);
}

#define TEST(function) cmocka_unit_test_setup_teardown(function, set_up, tear_down)

TEST_SUITE(readers)
{
	const struct CMUnitTest tests[] = {
		TEST(readers_topics_are_counted_once_each),
		TEST(readers_of_the_board_are_counted),
		TEST(readers_of_surfaces_are_counted),
		TEST(readers_beyond_their_number_are_refused_once),
		TEST(readers_beyond_their_room_are_refused),
		TEST(readers_beyond_the_number_of_all_are_refused),
		TEST(readers_of_another_connection_begin_anew),
		TEST(readers_that_left_are_swept),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
