/* How the daemon uses what a viewer reports about itself. */
#include "suite.h"

#include "base/clock.h"
#include "daemon/inlet.h"

static const int64_t now_ns = 100 * GZ_NS_PER_S;
static const int rect_px[4] = { 10, -20, 640, 480 };
static const int other_px[4] = { 11, -20, 640, 480 };

static void time_of_the_sender_counts_where_it_can_be(void **state)
{
	(void)state;
	assert_true(gz_viewer_time_ns(true, now_ns - 5, now_ns) == now_ns - 5);
	assert_true(gz_viewer_time_ns(true, now_ns, now_ns) == now_ns);
	assert_true(gz_viewer_time_ns(true, now_ns + 1, now_ns) == now_ns);
	assert_true(gz_viewer_time_ns(true, now_ns - GZ_VIEWER_AGE_MAX_NS, now_ns) == now_ns);
	assert_true(gz_viewer_time_ns(true, INT64_MIN, now_ns) == now_ns);
	assert_true(gz_viewer_time_ns(true, INT64_MAX, now_ns) == now_ns);
	assert_true(gz_viewer_time_ns(false, now_ns - 5, now_ns) == now_ns);
}

static void pointer_is_reported_with_its_time(void **state)
{
	(void)state;
	const struct gz_viewer_pointer pointer = {
		.known = true, .point = { 0.25f, 0.75f }, .has_time = true, .time_ns = now_ns - 9
	};
	struct gz_pointer_report report = gz_viewer_report(&pointer, now_ns);
	assert_true(report.known && report.host_ns == now_ns - 9);
	assert_true(report.point.x == 0.25f && report.point.y == 0.75f);
	assert_false(gz_viewer_report(&(struct gz_viewer_pointer) { 0 }, now_ns).known);
}

static void log_is_told_of_a_window_when_it_changes(void **state)
{
	(void)state;
	struct gz_viewer_place place = { 0 };
	struct gz_gaze_log_record record = { .kind = GZ_GAZE_LOG_GAP };
	assert_true(gz_viewer_place_step(&place, rect_px, now_ns, &record));
	assert_int_equal(record.kind, GZ_GAZE_LOG_WINDOW);
	assert_true(record.host_ns == now_ns);
	assert_memory_equal(record.window_px, rect_px, sizeof rect_px);
	record.kind = GZ_GAZE_LOG_GAP;
	assert_false(gz_viewer_place_step(&place, rect_px, now_ns + GZ_NS_PER_S, &record));
	assert_int_equal(record.kind, GZ_GAZE_LOG_GAP);
	assert_true(gz_viewer_place_step(&place, other_px, now_ns + 2 * GZ_NS_PER_S, &record));
	assert_int_equal(record.window_px[0], 11);
	/* Closed, and opened again in the same position. */
	assert_false(gz_viewer_place_step(&place, NULL, now_ns + 2 * GZ_NS_PER_S, &record));
	assert_true(gz_viewer_place_step(&place, other_px, now_ns + 2 * GZ_NS_PER_S, &record));
	/* Killed, and started again. */
	assert_true(gz_viewer_place_step(&place, other_px,
					 now_ns + 3 * GZ_NS_PER_S + GZ_VIEWER_WINDOW_NS, &record));
}

static void recording_begins_with_the_window_that_is_there(void **state)
{
	(void)state;
	struct gz_viewer_place place = { 0 };
	struct gz_gaze_log_record record;
	assert_false(gz_viewer_place_at_start(&place, now_ns, &record));
	gz_viewer_place_step(&place, rect_px, now_ns, &record);
	record = (struct gz_gaze_log_record) { .kind = GZ_GAZE_LOG_GAP };
	assert_true(gz_viewer_place_at_start(&place, now_ns + GZ_VIEWER_WINDOW_NS, &record));
	assert_int_equal(record.kind, GZ_GAZE_LOG_WINDOW);
	assert_true(record.host_ns == now_ns + GZ_VIEWER_WINDOW_NS);
	assert_memory_equal(record.window_px, rect_px, sizeof rect_px);
	assert_false(gz_viewer_place_at_start(&place, now_ns + GZ_VIEWER_WINDOW_NS + 1, &record));
	gz_viewer_place_step(&place, NULL, now_ns, &record);
	assert_false(gz_viewer_place_at_start(&place, now_ns, &record));
}

static const struct gz_viewer_window still = { .known = true,
					       .has_still = true,
					       .still_scene = true },
				     moving = { .known = true, .has_still = true },
				     silent = { .known = true }, closed = { .known = false };

static void scene_is_still_while_a_viewer_says_so(void **state)
{
	(void)state;
	struct gz_viewer_scenes scenes = { 0 };
	assert_false(gz_viewer_scenes_still(&scenes, now_ns));
	gz_viewer_scenes_step(&scenes, &silent, now_ns);
	assert_false(gz_viewer_scenes_still(&scenes, now_ns));
	gz_viewer_scenes_step(&scenes, &still, now_ns);
	gz_viewer_scenes_step(&scenes, &silent, now_ns);
	assert_true(gz_viewer_scenes_still(&scenes, now_ns + GZ_VIEWER_WINDOW_NS));
	/* Killed. */
	assert_false(gz_viewer_scenes_still(&scenes, now_ns + GZ_VIEWER_WINDOW_NS + 1));
	gz_viewer_scenes_step(&scenes, &still, now_ns + 1);
	assert_true(gz_viewer_scenes_still(&scenes, now_ns + GZ_VIEWER_WINDOW_NS + 1));
	gz_viewer_scenes_step(&scenes, &closed, now_ns + 2);
	assert_false(gz_viewer_scenes_still(&scenes, now_ns + 2));
}

static void one_scene_that_moves_counts_against_all_that_are_still(void **state)
{
	(void)state;
	struct gz_viewer_scenes scenes = { 0 };
	gz_viewer_scenes_step(&scenes, &still, now_ns);
	gz_viewer_scenes_step(&scenes, &moving, now_ns);
	assert_false(gz_viewer_scenes_still(&scenes, now_ns));
	/* The one is silent from now on, the other repeats itself. */
	gz_viewer_scenes_step(&scenes, &still, now_ns + GZ_VIEWER_WINDOW_NS);
	assert_false(gz_viewer_scenes_still(&scenes, now_ns + GZ_VIEWER_WINDOW_NS));
	assert_true(gz_viewer_scenes_still(&scenes, now_ns + GZ_VIEWER_WINDOW_NS + 1));
	/* That a viewer closes its window does not make another one's scene still. */
	gz_viewer_scenes_step(&scenes, &moving, now_ns + GZ_VIEWER_WINDOW_NS);
	gz_viewer_scenes_step(&scenes, &closed, now_ns + GZ_VIEWER_WINDOW_NS);
	gz_viewer_scenes_step(&scenes, &still, now_ns + GZ_VIEWER_WINDOW_NS);
	assert_false(gz_viewer_scenes_still(&scenes, now_ns + GZ_VIEWER_WINDOW_NS));
}

TEST_SUITE(viewer)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(time_of_the_sender_counts_where_it_can_be),
		cmocka_unit_test(pointer_is_reported_with_its_time),
		cmocka_unit_test(log_is_told_of_a_window_when_it_changes),
		cmocka_unit_test(recording_begins_with_the_window_that_is_there),
		cmocka_unit_test(scene_is_still_while_a_viewer_says_so),
		cmocka_unit_test(one_scene_that_moves_counts_against_all_that_are_still),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
