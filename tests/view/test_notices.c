/* What has been logged lately is kept for the window, and counted where it is the same. */
#include "suite.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

#include "view/panels/notices.h"

enum { SAYERS = 4, EACH = 500 };

static int woken;

static void wake(void)
{
	woken++;
}

static void say(struct gz_notices *notices, enum gz_log_level level, const char *text)
{
	gz_notices_sink(notices, level, "test", text);
}

static void newest_message_comes_first(void **state)
{
	(void)state;
	struct gz_notice found[3];
	struct gz_notices notices;
	gz_notices_init(&notices);
	say(&notices, GZ_LOG_WARN, "one");
	say(&notices, GZ_LOG_ERROR, "two");
	assert_int_equal(gz_notices_copy(&notices, found, 3), 2);
	assert_string_equal(found[0].text, "two");
	assert_int_equal(found[0].level, GZ_LOG_ERROR);
	assert_string_equal(found[1].text, "one");
	assert_int_equal(gz_notices_copy(&notices, found, 1), 1);
	assert_string_equal(found[0].text, "two");
	gz_notices_free(&notices);
}

static void same_message_counts_up_and_becomes_the_newest(void **state)
{
	(void)state;
	struct gz_notice found[3];
	struct gz_notices notices;
	gz_notices_init(&notices);
	say(&notices, GZ_LOG_WARN, "one");
	say(&notices, GZ_LOG_WARN, "two");
	gz_notices_copy(&notices, found, 3);
	const uint64_t number = found[1].number, version = gz_notices_version(&notices);
	say(&notices, GZ_LOG_WARN, "one");
	assert_int_equal(gz_notices_copy(&notices, found, 3), 2);
	assert_string_equal(found[0].text, "one");
	assert_int_equal(found[0].count, 2);
	assert_int_equal(found[0].number, number);
	assert_int_equal(found[1].count, 1);
	assert_true(gz_notices_version(&notices) > version);
	/* An error is not a warning, whatever both say. */
	say(&notices, GZ_LOG_ERROR, "one");
	assert_int_equal(gz_notices_copy(&notices, found, 3), 3);
	gz_notices_free(&notices);
}

static void debug_is_not_kept_and_wakes_nobody(void **state)
{
	(void)state;
	struct gz_notice found;
	struct gz_notices notices;
	gz_notices_init(&notices);
	woken = 0;
	gz_notices_wake_by(&notices, wake);
	say(&notices, GZ_LOG_DEBUG, "small talk");
	assert_int_equal(gz_notices_copy(&notices, &found, 1), 0);
	assert_int_equal(woken, 0);
	say(&notices, GZ_LOG_INFO, "something");
	assert_int_equal(woken, 1);
	gz_notices_wake_by(&notices, NULL);
	say(&notices, GZ_LOG_INFO, "something");
	assert_int_equal(woken, 1);
	gz_notices_free(&notices);
}

static void oldest_makes_room_and_a_long_text_loses_its_end(void **state)
{
	(void)state;
	static struct gz_notice found[GZ_NOTICES_MAX + 1];
	static char text[2 * GZ_NOTICE_SIZE];
	struct gz_notices notices;
	gz_notices_init(&notices);
	for (int i = 0; i < GZ_NOTICES_MAX + 3; i++) {
		snprintf(text, sizeof text, "message %d", i);
		say(&notices, GZ_LOG_INFO, text);
	}
	assert_int_equal(gz_notices_copy(&notices, found, GZ_NOTICES_MAX + 1), GZ_NOTICES_MAX);
	assert_string_equal(found[GZ_NOTICES_MAX - 1].text, "message 3");
	memset(text, 'x', sizeof text - 1);
	say(&notices, GZ_LOG_INFO, text);
	gz_notices_copy(&notices, found, 1);
	assert_int_equal(strlen(found[0].text), GZ_NOTICE_SIZE - 1);
	gz_notices_free(&notices);
}

static void *say_often(void *user)
{
	for (int i = 0; i < EACH; i++)
		gz_notices_sink(user, GZ_LOG_INFO, "test", i % 2 ? "odd" : "even");
	return NULL;
}

static void messages_of_several_threads_are_all_counted(void **state)
{
	(void)state;
	struct gz_notice found[3];
	struct gz_notices notices;
	pthread_t threads[SAYERS];
	gz_notices_init(&notices);
	for (int i = 0; i < SAYERS; i++)
		assert_int_equal(pthread_create(&threads[i], NULL, say_often, &notices), 0);
	for (int i = 0; i < SAYERS; i++)
		pthread_join(threads[i], NULL);
	assert_int_equal(gz_notices_copy(&notices, found, 3), 2);
	assert_int_equal(found[0].count, SAYERS * EACH / 2);
	assert_int_equal(found[1].count, SAYERS * EACH / 2);
	gz_notices_free(&notices);
}

TEST_SUITE(notices)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(newest_message_comes_first),
		cmocka_unit_test(same_message_counts_up_and_becomes_the_newest),
		cmocka_unit_test(debug_is_not_kept_and_wakes_nobody),
		cmocka_unit_test(oldest_makes_room_and_a_long_text_loses_its_end),
		cmocka_unit_test(messages_of_several_threads_are_all_counted),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
