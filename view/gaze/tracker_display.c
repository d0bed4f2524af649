#include "view/gaze/tracker_display.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Relative tolerance of a side in mm: see gz_tracker_display_choose(). */
#define SIDE_TOLERANCE 0.05

struct gz_monitor_place gz_monitor_place_of(const struct gz_monitor *monitor)
{
	const int *rect = monitor->rect_px;
	return (struct gz_monitor_place) {
		.at = { rect[0], rect[1] },
		.px = { rect[2], rect[3] },
		.scale = monitor->scale,
	};
}

int gz_monitor_at(const struct gz_monitor_list *list, const int rect_px[4])
{
	const int x = rect_px[0] + rect_px[2] / 2, y = rect_px[1] + rect_px[3] / 2;
	for (int i = 0; i < list->count; i++) {
		const int *rect = list->monitors[i].rect_px;
		if (x >= rect[0] && x - rect[0] < rect[2] && y >= rect[1] && y - rect[1] < rect[3])
			return i;
	}
	return list->count > 0 ? 0 : -1;
}

int gz_monitor_named(const struct gz_monitor_list *list, const char *text)
{
	for (int i = 0; i < list->count; i++)
		if (strcmp(list->monitors[i].name, text) == 0)
			return i;
	char *end;
	const long number = strtol(text, &end, 10);
	const bool whole = isdigit((unsigned char)text[0]) && *end == '\0';
	return whole && number >= 1 && number <= list->count ? (int)number - 1 : -1;
}

static bool same_px(const struct gz_monitor *monitor, const struct gz_display *display)
{
	return monitor->rect_px[2] == display->px[0] && monitor->rect_px[3] == display->px[1];
}

static bool same_mm(const struct gz_monitor *monitor, const struct gz_display *display)
{
	for (int i = 0; i < 2; i++)
		if (fabs(monitor->mm[i] - display->mm[i]) > SIDE_TOLERANCE * display->mm[i])
			return false;
	return true;
}

/* Whether the daemon assumed the display for lack of configuration. */
static bool is_assumed(const struct gz_display *display)
{
	const struct gz_display assumed = gz_display_default(display->px[0], display->px[1]);
	return fabs(display->mm[0] - assumed.mm[0]) < 1e-6 * assumed.mm[0] &&
	       fabs(display->mm[1] - assumed.mm[1]) < 1e-6 * assumed.mm[1];
}

typedef bool monitor_test(const struct gz_monitor *monitor, const struct gz_display *display);

static bool both(const struct gz_monitor *monitor, const struct gz_display *display)
{
	return same_px(monitor, display) && same_mm(monitor, display);
}

/* The only monitor that passes; among several, the window's; -1 if that does not pass. */
static int find_by(const struct gz_monitor_list *list, monitor_test *test,
		   const struct gz_display *display, int at_window)
{
	int found = -1, passed = 0;
	for (int i = 0; i < list->count; i++) {
		if (!test(&list->monitors[i], display))
			continue;
		passed++;
		if (found < 0 || i == at_window)
			found = i;
	}
	return passed == 1 || found == at_window ? found : -1;
}

static int find_described(const struct gz_monitor_list *list, const struct gz_display *display,
			  int at_window)
{
	monitor_test *const tests[] = { both, same_px, same_mm };
	int found = -1;
	if (!display || !gz_display_valid(display) || is_assumed(display))
		return -1;
	for (size_t i = 0; i < sizeof tests / sizeof tests[0] && found < 0; i++)
		found = find_by(list, tests[i], display, at_window);
	return found;
}

struct gz_tracker_display gz_tracker_display_choose(const struct gz_monitor_list *list,
						    const char *named,
						    const struct gz_display *described,
						    const int window_px[4])
{
	const int at_window = gz_monitor_at(list, window_px);
	struct gz_tracker_display choice = { at_window, GZ_TRACKER_DISPLAY_WINDOW, false };
	if (named[0]) {
		const int monitor = gz_monitor_named(list, named);
		choice.named_is_absent = monitor < 0;
		if (monitor >= 0)
			return (struct gz_tracker_display) { monitor, GZ_TRACKER_DISPLAY_NAMED,
							     false };
	}
	if (list->count == 1) {
		choice.reason = GZ_TRACKER_DISPLAY_ALONE;
		return choice;
	}
	const int monitor = find_described(list, described, at_window);
	if (monitor >= 0) {
		choice.monitor = monitor;
		choice.reason = GZ_TRACKER_DISPLAY_DESCRIBED;
	}
	return choice;
}

struct gz_window_share gz_window_share_of(const struct gz_monitor *monitor, const int window_px[4])
{
	if (!monitor || window_px[2] < 1 || window_px[3] < 1)
		return (struct gz_window_share) { 0, 0, 1, 1 };
	const int *rect = monitor->rect_px;
	return (struct gz_window_share) {
		.x = (double)(window_px[0] - rect[0]) / rect[2],
		.y = (double)(window_px[1] - rect[1]) / rect[3],
		.width = (double)window_px[2] / rect[2],
		.height = (double)window_px[3] / rect[3],
	};
}

bool gz_window_share_is_elsewhere(const struct gz_window_share *share)
{
	return share->x >= 1 || share->y >= 1 || share->x + share->width <= 0 ||
	       share->y + share->height <= 0;
}

struct gz_point gz_window_share_point(const struct gz_window_share *share, struct gz_point point)
{
	return (struct gz_point) {
		(float)((point.x - share->x) / share->width),
		(float)((point.y - share->y) / share->height),
	};
}
