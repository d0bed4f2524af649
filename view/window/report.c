/* What the window tells the daemon of itself. */
#include "view/window/window_state.h"

#include <math.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "client/viewer_link.h"

enum gz_result gz_window_report_open(struct gz_window *window)
{
	const struct gz_gaze_choice *choice = &window->options->gaze;
	if (choice->kind != GZ_GAZE_LATEST && choice->kind != GZ_GAZE_POINTER)
		return GZ_OK;
	enum gz_result r = gz_viewer_link_open(choice->text, window->log, &window->link);
	/* A daemon whose inlet is not known is one that is not told. */
	return r == GZ_ERR_UNSUPPORTED ? GZ_OK : r;
}

/* The window's content in pixels of the monitor that it is on. */
static void report_rect(struct gz_window *window, int64_t now_ns)
{
	int x, y, rect_px[4], left = 0, top = 0;
	GLFWmonitor *monitor = gz_window_monitor(window->glfw);
	if (monitor)
		glfwGetMonitorPos(monitor, &left, &top);
	glfwGetWindowPos(window->glfw, &x, &y);
	glfwGetWindowSize(window->glfw, &rect_px[2], &rect_px[3]);
	rect_px[0] = x - left;
	rect_px[1] = y - top;
	if (rect_px[2] > 0 && rect_px[3] > 0)
		gz_viewer_link_window(window->link, rect_px, now_ns);
}

/* The way of a tracker's gaze onto the picture, backwards. */
static void report_pointer(struct gz_window *window, int64_t now_ns)
{
	int width, height;
	struct gz_window_share share = { 0, 0, 1, 1 };
	glfwGetWindowSize(window->glfw, &width, &height);
	if (!window->cursor_inside || !window->cursor_known || width < 1 || height < 1) {
		gz_viewer_link_pointer(window->link, NULL, now_ns);
		return;
	}
	if (!window->options->gaze_fills_window)
		share = gz_window_share(window->glfw);
	const struct gz_point point = {
		(float)(share.x + share.width * window->cursor[0] / width),
		(float)(share.y + share.height * window->cursor[1] / height),
	};
	gz_viewer_link_pointer(window->link, &point, now_ns);
}

void gz_window_report(struct gz_window *window)
{
	int64_t now_ns = gz_clock_now_ns();
	if (!window->link)
		return;
	report_rect(window, now_ns);
	if (window->options->gaze.kind == GZ_GAZE_POINTER)
		report_pointer(window, now_ns);
}
