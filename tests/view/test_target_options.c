/* Positions and order of the targets. */
#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/captured_log.h"
#include "view/options/options.h"
#include "view/options/target_options.h"

static struct captured_log captured;

static struct gz_target_options options_of(const char *targets, enum gz_target_order order,
					   int seed)
{
	struct gz_target_options options = { .order = order, .seed = seed };
	snprintf(options.targets, sizeof options.targets, "%s", targets);
	captured_log_init(&captured, "*:debug");
	return options;
}

static bool has(const struct gz_targets *targets, float x, float y)
{
	for (size_t i = 0; i < targets->count; i++)
		if (targets->target[i].point.x == x && targets->target[i].point.y == y)
			return true;
	return false;
}

static void layouts_start_at_the_centre_and_reach_all_corners(void **state)
{
	(void)state;
	static const char *const names[] = { "5", "9", "13" };
	static const size_t counts[] = { 5, 9, 13 };
	for (int i = 0; i < 3; i++) {
		struct gz_target_options options = options_of(names[i], GZ_TARGET_ORDER_FIXED, 0);
		struct gz_targets targets;
		assert_int_equal(gz_target_places(&options, &captured.log, &targets), GZ_OK);
		assert_int_equal(targets.count, counts[i]);
		assert_true(targets.target[0].point.x == 0.5f && targets.target[0].point.y == 0.5f);
		assert_true(has(&targets, 0.1f, 0.1f) && has(&targets, 0.9f, 0.1f));
		assert_true(has(&targets, 0.1f, 0.9f) && has(&targets, 0.9f, 0.9f));
		for (size_t k = 0; k < targets.count; k++)
			for (size_t l = 0; l < k; l++)
				assert_memory_not_equal(&targets.target[k].point,
							&targets.target[l].point,
							sizeof(struct gz_point));
	}
}

static void random_order_shows_each_target_once_and_follows_its_seed(void **state)
{
	(void)state;
	struct gz_target_options fixed = options_of("13", GZ_TARGET_ORDER_FIXED, 0);
	struct gz_targets listed, first;
	assert_int_equal(gz_target_places(&fixed, &captured.log, &listed), GZ_OK);
	int differ = 0;
	for (int seed = 1; seed <= 20; seed++) {
		struct gz_target_options options = options_of("13", GZ_TARGET_ORDER_RANDOM, seed);
		struct gz_targets targets, again;
		assert_int_equal(gz_target_places(&options, &captured.log, &targets), GZ_OK);
		assert_int_equal(gz_target_places(&options, &captured.log, &again), GZ_OK);
		assert_int_equal(targets.count, listed.count);
		for (size_t i = 0; i < listed.count; i++) {
			struct gz_point point = listed.target[i].point;
			assert_true(has(&targets, point.x, point.y));
			assert_memory_equal(&targets.target[i].point, &again.target[i].point,
					    sizeof point);
		}
		if (seed == 1)
			first = targets;
		differ += memcmp(&first.target, &targets.target,
				 listed.count * sizeof first.target[0]) != 0;
	}
	assert_in_range(differ, 15, 19);
}

static void file_of_targets_is_read_and_an_invalid_one_refused(void **state)
{
	(void)state;
	char path[] = "/tmp/gazecast-test-targets-XXXXXX";
	int fd = mkstemp(path);
	assert_true(fd >= 0);
	static const char list[] = "0.25 0.75\n# a remark\n0.5 0.5 2\n";
	assert_int_equal(write(fd, list, sizeof list - 1), sizeof list - 1);
	struct gz_target_options options = options_of(path, GZ_TARGET_ORDER_FIXED, 0);
	struct gz_targets targets;
	assert_int_equal(gz_target_places(&options, &captured.log, &targets), GZ_OK);
	assert_int_equal(targets.count, 2);
	assert_true(has(&targets, 0.25f, 0.75f) && has(&targets, 0.5f, 0.5f));
	assert_int_equal(write(fd, "here\n", 5), 5);
	assert_int_equal(gz_target_places(&options, &captured.log, &targets), GZ_ERR_FORMAT);
	assert_non_null(strstr(captured.last, path));
	close(fd);
	unlink(path);
	assert_int_equal(gz_target_places(&options, &captured.log, &targets), GZ_ERR_NOT_FOUND);
}

static enum gz_result read_words(int argc, char *const *argv, struct gz_view_options *options)
{
	captured_log_init(&captured, "*:debug");
	return gz_view_options_read(argc, argv, &captured.log, options);
}

static void targets_need_a_window_and_no_scene(void **state)
{
	(void)state;
	static char name[] = "gazeview", targets[] = "--targets=9", scene[] = "a.scene",
		    headless[] = "--headless", window[] = "--window", much[] = "--duration=61";
	static struct gz_view_options options;
	char *good[] = { name, targets, window, NULL };
	assert_int_equal(read_words(3, good, &options), GZ_OK);
	assert_string_equal(options.target.targets, "9");
	assert_true(options.target.windowed && options.target.instructions);
	assert_true(options.target.duration_s == 2.5);
	char *other[] = { scene, headless, much };
	for (int i = 0; i < 3; i++) {
		char *bad[] = { name, targets, other[i], NULL };
		assert_int_equal(read_words(3, bad, &options), GZ_ERR_INVAL);
		assert_int_equal(captured.messages, 1);
	}
}

TEST_SUITE(target_options)
{
	static const struct CMUnitTest tests[] = {
		cmocka_unit_test(layouts_start_at_the_centre_and_reach_all_corners),
		cmocka_unit_test(random_order_shows_each_target_once_and_follows_its_seed),
		cmocka_unit_test(file_of_targets_is_read_and_an_invalid_one_refused),
		cmocka_unit_test(targets_need_a_window_and_no_scene),
	};
	return cmocka_run_group_tests_name("view.target_options", tests, NULL, NULL);
}
