/* The tracker's monitor, and the window's part of it. */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "view/gaze/tracker_display.h"

/* A 4K one at the left, two of 1920x1080 beside it: one of 24 inches, one of 27. */
static struct gz_monitor_list three(void)
{
	return (struct gz_monitor_list) {
		.monitors = {
			{ "DP-1", { 0, 0, 3840, 2160 }, { 600, 340 }, 60 },
			{ "HDMI-1", { 3840, 100, 1920, 1080 }, { 530, 300 }, 144 },
			{ "HDMI-2", { 5760, 0, 1920, 1080 }, { 600, 340 }, 60 },
		},
		.count = 3,
	};
}

static const int on_first[4] = { 100, 100, 1280, 720 };
static const int on_second[4] = { 4000, 200, 1280, 720 };
static const int on_third[4] = { 6000, 100, 640, 480 };
static const int nowhere[4] = { -5000, -5000, 640, 480 };

static const struct gz_display of_hdmi_1 = { { 1920, 1080 }, { 531, 299 }, 650 };

static void choose(const struct gz_monitor_list *list, const char *named,
		   const struct gz_display *described, const int window[4], int monitor,
		   enum gz_tracker_display_reason reason)
{
	const struct gz_tracker_display choice =
		gz_tracker_display_choose(list, named, described, window);
	assert_int_equal(choice.monitor, monitor);
	assert_int_equal(choice.reason, reason);
	assert_false(choice.named_is_absent);
}

static void monitor_of_a_window_contains_its_centre_or_is_the_first(void **state)
{
	(void)state;
	const struct gz_monitor_list list = three(), none = { .count = 0 };
	const int astride[4] = { 3700, 200, 200, 200 }; /* its middle is 3800 */
	assert_int_equal(gz_monitor_at(&list, on_first), 0);
	assert_int_equal(gz_monitor_at(&list, on_second), 1);
	assert_int_equal(gz_monitor_at(&list, on_third), 2);
	assert_int_equal(gz_monitor_at(&list, astride), 0);
	assert_int_equal(gz_monitor_at(&list, nowhere), 0);
	assert_int_equal(gz_monitor_at(&none, on_first), -1);
}

static void monitor_is_named_by_name_or_number_and_by_nothing_else(void **state)
{
	(void)state;
	const struct gz_monitor_list list = three();
	static const char *const refused[] = { "", "0", "4", "-1", "1x", " 1", "dp-1", "DP" };
	assert_int_equal(gz_monitor_named(&list, "HDMI-1"), 1);
	assert_int_equal(gz_monitor_named(&list, "1"), 0);
	assert_int_equal(gz_monitor_named(&list, "3"), 2);
	for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++)
		assert_int_equal(gz_monitor_named(&list, refused[i]), -1);
}

static void name_overrides_description_overrides_window(void **state)
{
	(void)state;
	const struct gz_monitor_list list = three();
	choose(&list, "HDMI-2", &of_hdmi_1, on_first, 2, GZ_TRACKER_DISPLAY_NAMED);
	choose(&list, "", &of_hdmi_1, on_first, 1, GZ_TRACKER_DISPLAY_DESCRIBED);
	choose(&list, "", NULL, on_first, 0, GZ_TRACKER_DISPLAY_WINDOW);
	choose(&list, "", NULL, on_third, 2, GZ_TRACKER_DISPLAY_WINDOW);
}

static void unknown_name_is_reported_and_the_rest_decides(void **state)
{
	(void)state;
	const struct gz_monitor_list list = three();
	struct gz_tracker_display choice =
		gz_tracker_display_choose(&list, "DP-9", &of_hdmi_1, on_first);
	assert_true(choice.named_is_absent);
	assert_int_equal(choice.monitor, 1);
	choice = gz_tracker_display_choose(&list, "7", NULL, on_first);
	assert_true(choice.named_is_absent);
	assert_int_equal(choice.monitor, 0);
}

static void ambiguous_description_is_decided_by_mm_then_by_window(void **state)
{
	(void)state;
	struct gz_monitor_list list = three();
	const struct gz_display of_hdmi_2 = { { 1920, 1080 }, { 598, 336 }, 650 };
	const struct gz_display of_neither = { { 1920, 1080 }, { 480, 270 }, 650 };
	choose(&list, "", &of_hdmi_2, on_first, 2, GZ_TRACKER_DISPLAY_DESCRIBED);
	choose(&list, "", &of_neither, on_third, 2, GZ_TRACKER_DISPLAY_DESCRIBED);
	choose(&list, "", &of_neither, on_first, 0, GZ_TRACKER_DISPLAY_WINDOW);
	/* A desktop that scales: no size in px matches. */
	const struct gz_display scaled = { { 2560, 1440 }, { 530, 300 }, 650 };
	choose(&list, "", &scaled, on_first, 1, GZ_TRACKER_DISPLAY_DESCRIBED);
}

static void assumed_and_invalid_descriptions_are_ignored(void **state)
{
	(void)state;
	const struct gz_monitor_list list = three();
	const struct gz_display assumed = gz_display_default(1920, 1080);
	const struct gz_display impossible = { { 0, 0 }, { NAN, -1 }, 0 };
	choose(&list, "", &assumed, on_first, 0, GZ_TRACKER_DISPLAY_WINDOW);
	choose(&list, "", &impossible, on_second, 1, GZ_TRACKER_DISPLAY_WINDOW);
}

static void only_monitor_is_chosen_and_empty_list_gives_none(void **state)
{
	(void)state;
	struct gz_monitor_list list = three();
	list.count = 1;
	choose(&list, "", &of_hdmi_1, on_second, 0, GZ_TRACKER_DISPLAY_ALONE);
	list.count = 0;
	assert_int_equal(gz_tracker_display_choose(&list, "", &of_hdmi_1, on_first).monitor, -1);
	assert_int_equal(gz_tracker_display_choose(&list, "1", NULL, on_first).monitor, -1);
}

static void near(double a, double b)
{
	if (fabs(a - b) > 1e-6)
		fail_msg("%.9g is not %.9g", a, b);
}

static void point_on_monitor_becomes_point_on_window(void **state)
{
	(void)state;
	const struct gz_monitor_list list = three();
	const struct gz_window_share share = gz_window_share_of(&list.monitors[1], on_second);
	assert_false(gz_window_share_is_elsewhere(&share));
	/* The window's corner is 160, 100 px from the monitor's. */
	const struct gz_point corner = { 160.0f / 1920, 100.0f / 1080 };
	const struct gz_point opposite = { 1440.0f / 1920, 820.0f / 1080 };
	struct gz_point on = gz_window_share_point(&share, corner);
	near(on.x, 0);
	near(on.y, 0);
	on = gz_window_share_point(&share, opposite);
	near(on.x, 1);
	near(on.y, 1);
}

static void window_on_another_monitor_has_gaze_outside(void **state)
{
	(void)state;
	const struct gz_monitor_list list = three();
	const struct gz_window_share share = gz_window_share_of(&list.monitors[1], on_first);
	assert_true(gz_window_share_is_elsewhere(&share));
	for (int i = 0; i <= 10; i++) {
		const struct gz_point on = gz_window_share_point(
			&share, (struct gz_point) { (float)i / 10, (float)i / 10 });
		assert_true(on.x > 1);
	}
	/* A window across the edge is not outside. */
	const int astride[4] = { 3800, 200, 200, 200 };
	const struct gz_window_share across = gz_window_share_of(&list.monitors[1], astride);
	assert_false(gz_window_share_is_elsewhere(&across));
}

static void window_without_size_or_monitor_covers_everything(void **state)
{
	(void)state;
	const struct gz_monitor_list list = three();
	const int vanished[4] = { 100, 100, 0, 0 };
	const struct gz_window_share shares[] = {
		gz_window_share_of(&list.monitors[0], vanished),
		gz_window_share_of(NULL, on_first),
	};
	for (size_t i = 0; i < 2; i++) {
		near(shares[i].x, 0);
		near(shares[i].y, 0);
		near(shares[i].width, 1);
		near(shares[i].height, 1);
	}
}

TEST_SUITE(tracker_display)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(monitor_of_a_window_contains_its_centre_or_is_the_first),
		cmocka_unit_test(monitor_is_named_by_name_or_number_and_by_nothing_else),
		cmocka_unit_test(name_overrides_description_overrides_window),
		cmocka_unit_test(unknown_name_is_reported_and_the_rest_decides),
		cmocka_unit_test(ambiguous_description_is_decided_by_mm_then_by_window),
		cmocka_unit_test(assumed_and_invalid_descriptions_are_ignored),
		cmocka_unit_test(only_monitor_is_chosen_and_empty_list_gives_none),
		cmocka_unit_test(point_on_monitor_becomes_point_on_window),
		cmocka_unit_test(window_on_another_monitor_has_gaze_outside),
		cmocka_unit_test(window_without_size_or_monitor_covers_everything),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
