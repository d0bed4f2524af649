/* What the window tells the daemon of itself. */
#include "view/window/window_state.h"

#include <string.h>

#include "base/clock.h"
#include "client/viewer_link.h"
#include "view/window/displays.h"
#include "view/window/gaze_sources.h"

enum gz_result gz_window_report_open(struct gz_window *window)
{
	const struct gz_gaze_choice *choice = &window->sources->choice;
	if (choice->kind != GZ_GAZE_LATEST && choice->kind != GZ_GAZE_POINTER)
		return GZ_OK;
	char *linked = window->sources->linked;
	if (window->link && strcmp(linked, choice->text) == 0)
		return GZ_OK;
	gz_viewer_link_close(&window->link);
	memcpy(linked, choice->text, sizeof window->sources->linked);
	enum gz_result r = gz_viewer_link_open(choice->text, window->log, &window->link);
	/* A daemon whose inlet is not known is one that is not told. */
	return r == GZ_ERR_UNSUPPORTED ? GZ_OK : r;
}

/* The window's content in pixels of the tracker's display. */
static void report_rect(struct gz_window *window, int64_t now_ns)
{
	int rect_px[4];
	const struct gz_monitor *monitor = gz_window_tracker_monitor(window);
	gz_window_rect(window, rect_px);
	if (monitor) {
		rect_px[0] -= monitor->rect_px[0];
		rect_px[1] -= monitor->rect_px[1];
	}
	if (rect_px[2] > 0 && rect_px[3] > 0)
		gz_viewer_link_window(window->link, rect_px, now_ns);
}

/* The way of a tracker's gaze onto the picture, backwards. */
static void report_pointer(struct gz_window *window, int64_t now_ns)
{
	int rect_px[4];
	gz_window_rect(window, rect_px);
	if (!window->cursor_inside || !window->cursor_known || rect_px[2] < 1 || rect_px[3] < 1) {
		gz_viewer_link_pointer(window->link, NULL, now_ns);
		return;
	}
	const struct gz_window_share share = gz_window_share(window);
	const struct gz_point point = {
		(float)(share.x + share.width * window->cursor[0] / rect_px[2]),
		(float)(share.y + share.height * window->cursor[1] / rect_px[3]),
	};
	gz_viewer_link_pointer(window->link, &point, now_ns);
}

void gz_window_report(struct gz_window *window)
{
	int64_t now_ns = gz_clock_now_ns();
	if (!window->link)
		return;
	report_rect(window, now_ns);
	if (window->sources->choice.kind == GZ_GAZE_POINTER)
		report_pointer(window, now_ns);
	else if (window->sources->pointer_told)
		gz_viewer_link_pointer(window->link, NULL, now_ns);
	window->sources->pointer_told = window->sources->choice.kind == GZ_GAZE_POINTER;
}
