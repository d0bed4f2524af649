/* Panels open where they cover no others, and fold the earliest ones where there is no room. */
#include "suite.h"

#include "view/panels/panel_places.h"

enum { TITLE = 19 };

/* Panels as they are, unscaled: the editor of the transfer function, settings, frame times, objects
 * and the gaze; and where they are wanted. */
static const struct {
	float width, height;
	bool right, low;
} panels[] = {
	{ 540, 350, false, true },  { 380, 375, true, false },  { 380, 525, true, true },
	{ 380, 312, false, false }, { 380, 300, false, false },
};
enum { PANELS = sizeof panels / sizeof panels[0] };

static bool overlap(const struct gz_panel_rectangle *a, const struct gz_panel_rectangle *b)
{
	return a->x < b->x + b->width && b->x < a->x + a->width && a->y < b->y + b->height &&
	       b->y < a->y + a->height;
}

/* Open a panel. It becomes the last of others. */
static void open_panel(struct gz_panel_placing *placing, int panel)
{
	const struct gz_panel_rectangle *room = &placing->room;
	float corner[2];
	placing->width = panels[panel].width;
	placing->height = panels[panel].height;
	placing->wanted[0] = panels[panel].right ? room->x + room->width - placing->width : room->x;
	placing->wanted[1] = panels[panel].low ? room->y + room->height - placing->height : room->y;
	gz_panel_find_place(placing, corner);
	placing->others[placing->count] = (struct gz_panel_other) {
		.at = { corner[0], corner[1], placing->width, placing->height },
		.title_height = TITLE,
		.opened = placing->count,
	};
	placing->count++;
}

static struct gz_panel_placing empty_window(float width, float height)
{
	return (struct gz_panel_placing) {
		.room = { 8, 56, width - 16, height - 64 - 56 },
		.gap = 8,
	};
}

static int overlaps_of(const struct gz_panel_placing *placing)
{
	int overlaps = 0;
	for (int i = 0; i < placing->count; i++)
		for (int k = 0; k < i; k++)
			overlaps += overlap(&placing->others[i].at, &placing->others[k].at);
	return overlaps;
}

static int folded_of(const struct gz_panel_placing *placing)
{
	int folded = 0;
	for (int i = 0; i < placing->count; i++)
		folded += placing->others[i].folded;
	return folded;
}

static void assert_within_room(const struct gz_panel_placing *placing)
{
	const struct gz_panel_rectangle *room = &placing->room;
	for (int i = 0; i < placing->count; i++) {
		const struct gz_panel_rectangle *at = &placing->others[i].at;
		assert_true(at->x >= room->x && at->x + at->width <= room->x + room->width + 1);
		assert_true(at->y >= room->y && at->y + at->height <= room->y + room->height + 1);
	}
}

/* In all orders of opening. */
static void four_panels_of_a_small_window_do_not_overlap(void **state)
{
	(void)state;
	for (int order = 0; order < PANELS * PANELS * PANELS * PANELS; order++) {
		const int four[4] = { order % PANELS, order / PANELS % PANELS,
				      order / PANELS / PANELS % PANELS,
				      order / PANELS / PANELS / PANELS };
		struct gz_panel_placing placing = empty_window(1280, 720);
		for (int i = 0; i < 4; i++)
			open_panel(&placing, four[i]);
		assert_int_equal(overlaps_of(&placing), 0);
		assert_false(placing.others[3].folded);
		assert_within_room(&placing);
	}
}

static void nothing_is_folded_where_there_is_room(void **state)
{
	(void)state;
	struct gz_panel_placing placing = empty_window(1920, 1080);
	for (int i = 0; i < PANELS; i++)
		open_panel(&placing, i);
	assert_int_equal(overlaps_of(&placing), 0);
	assert_int_equal(folded_of(&placing), 0);
	assert_true(placing.others[0].at.x == 8 && placing.others[0].at.y == 1016 - 350 + 0);
}

static void earliest_is_folded_first_and_its_title_goes_to_the_top(void **state)
{
	(void)state;
	struct gz_panel_placing placing = empty_window(1280, 720);
	open_panel(&placing, 0);
	open_panel(&placing, 1);
	assert_int_equal(folded_of(&placing), 0);
	open_panel(&placing, 2);
	assert_int_equal(folded_of(&placing), 1);
	assert_true(placing.others[0].folded && placing.others[0].at.y == placing.room.y &&
		    placing.others[0].at.height == TITLE);
	assert_int_equal(overlaps_of(&placing), 0);
}

static void nothing_is_folded_where_that_does_not_help(void **state)
{
	(void)state;
	struct gz_panel_placing placing = empty_window(480, 320);
	open_panel(&placing, 1);
	open_panel(&placing, 3);
	assert_int_equal(folded_of(&placing), 0);
}

TEST_SUITE(panel_places)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(four_panels_of_a_small_window_do_not_overlap),
		cmocka_unit_test(nothing_is_folded_where_there_is_room),
		cmocka_unit_test(earliest_is_folded_first_and_its_title_goes_to_the_top),
		cmocka_unit_test(nothing_is_folded_where_that_does_not_help),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
