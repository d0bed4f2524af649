#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/message_queue.h"

static struct gz_message_queue *queue;

static int tear_down(void **state)
{
	(void)state;
	gz_message_queue_destroy(&queue);
	gz_message_queue_destroy(&queue);
	return queue != NULL;
}

static bool push(const char *topic, const char *body)
{
	return gz_message_queue_push(
		queue, &(struct gz_queued_message) { topic, strlen(topic), body, strlen(body) });
}

static void assert_next(const char *topic, const char *body)
{
	struct gz_queued_message message;
	assert_true(gz_message_queue_front(queue, &message));
	assert_int_equal(message.topic_size, strlen(topic));
	assert_int_equal(message.body_size, strlen(body));
	assert_memory_equal(message.topic, topic, message.topic_size);
	assert_memory_equal(message.body, body, message.body_size);
	gz_message_queue_pop(queue);
}

static void assert_empty(void)
{
	struct gz_queued_message message;
	assert_false(gz_message_queue_front(queue, &message));
	gz_message_queue_pop(queue);
}

static void message_queue_gives_messages_in_order_and_refuses_when_full(void **state)
{
	(void)state;
	assert_int_equal(gz_message_queue_create(40, &queue), GZ_OK);
	assert_empty();
	assert_true(push("ab", "cde"));
	assert_true(push("", ""));
	assert_true(push("x", "123456789"));
	assert_false(push("", ""));
	assert_next("ab", "cde");
	/* 13 bytes at the beginning are free, and one at the end. */
	assert_false(push("abc", "def"));
	assert_true(push("abc", "de"));
	assert_false(push("", ""));
	assert_next("", "");
	assert_true(push("", ""));
	assert_next("x", "123456789");
	assert_next("abc", "de");
	assert_next("", "");
	assert_empty();
}

static void message_queue_that_is_empty_takes_a_message_of_its_size(void **state)
{
	(void)state;
	assert_int_equal(gz_message_queue_create(20, &queue), GZ_OK);
	assert_true(push("abc", "def"));
	assert_next("abc", "def");
	assert_true(push("abcdef", "ghijkl"));
	assert_next("abcdef", "ghijkl");
	assert_false(push("abcdef", "ghijklm"));
	assert_empty();
}

/* Against a list: every order of sizes, around the end of the memory too. */
static void message_queue_is_a_queue(void **state)
{
	(void)state;
	enum { ROUNDS = 20000, HELD = 64 };
	static char held[HELD][2][64];
	size_t first = 0, last = 0;
	assert_int_equal(gz_message_queue_create(500, &queue), GZ_OK);
	srand(7);
	for (int i = 0; i < ROUNDS; i++) {
		if (rand() % 2) {
			char(*message)[64] = held[last % HELD];
			snprintf(message[0], 64, "%.*s", rand() % 20, "abcdefghijklmnopqrst");
			snprintf(message[1], 64, "%.*s%d", rand() % 40,
				 "0123456789012345678901234567890123456789", i);
			if (last - first < HELD && push(message[0], message[1]))
				last++;
		} else if (first < last) {
			assert_next(held[first % HELD][0], held[first % HELD][1]);
			first++;
		} else {
			assert_empty();
		}
	}
	assert_true(first > 1000);
}

#define TEST(function) cmocka_unit_test_teardown(function, tear_down)

TEST_SUITE(message_queue)
{
	const struct CMUnitTest tests[] = {
		TEST(message_queue_gives_messages_in_order_and_refuses_when_full),
		TEST(message_queue_that_is_empty_takes_a_message_of_its_size),
		TEST(message_queue_is_a_queue),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
