#include "view/window/displays.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "view/window/glfw.h"
#include "view/window/sections.h"
#include "view/window/simulator.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* Interval of looking at monitors: changes of mode and place come without an event (chosen: soon
 * for a person, seldom for the display server, which is asked each time). */
#define LOOK_INTERVAL_NS (2 * GZ_NS_PER_S)

struct gz_window_displays {
	struct gz_monitor_list list;
	GLFWmonitor *handles[GZ_MONITORS_MAX]; /* of the list */
	int64_t looked_ns;                     /* 0: not looked at yet */
	int rect_px[4];                        /* of the window */
	int framebuffer_px[2];                 /* of the window; 0 while it is minimised */
	bool rect_old;                         /* the window has moved since */
	struct gz_tracker_display chosen;
	char told[GZ_NAME_SIZE];  /* the tracker's display that was logged */
	char asked[GZ_NAME_SIZE]; /* the name that was refused, and logged */
};

static bool describe_monitor(GLFWmonitor *handle, struct gz_monitor *out_monitor)
{
	const GLFWvidmode *mode = glfwGetVideoMode(handle);
	const char *name = glfwGetMonitorName(handle);
	struct gz_monitor monitor = { 0 };
	int mm[2];
	if (!mode || mode->width < 1 || mode->height < 1)
		return false;
	glfwGetMonitorPos(handle, &monitor.rect_px[0], &monitor.rect_px[1]);
	glfwGetMonitorPhysicalSize(handle, &mm[0], &mm[1]);
	monitor.rect_px[2] = mode->width;
	monitor.rect_px[3] = mode->height;
	monitor.mm[0] = mm[0] > 0 ? mm[0] : 0;
	monitor.mm[1] = mm[1] > 0 ? mm[1] : 0;
	monitor.refresh_hz = mode->refreshRate > 0 ? mode->refreshRate : 0;
	monitor.scale = gz_glfw_monitor_scale(handle);
	snprintf(monitor.name, sizeof monitor.name, "%s", name ? name : "");
	*out_monitor = monitor;
	return true;
}

static void look_at_monitors(struct gz_window_displays *displays)
{
	int count;
	GLFWmonitor **handles = glfwGetMonitors(&count);
	displays->looked_ns = gz_clock_now_ns();
	displays->list.count = 0;
	for (int i = 0; i < count && displays->list.count < GZ_MONITORS_MAX; i++) {
		if (!describe_monitor(handles[i], &displays->list.monitors[displays->list.count]))
			continue;
		displays->handles[displays->list.count++] = handles[i];
	}
}

static const struct gz_display *display_of_daemon(struct gz_window *window, struct gz_display *room)
{
	const struct gz_status *status =
		window->source ? gz_gaze_source_status(window->source) : NULL;
	if (!status)
		return NULL;
	*room = status->display;
	return room;
}

static void tell_refused(struct gz_window *window)
{
	struct gz_window_displays *displays = window->displays;
	const char *named = window->settings.view.tracker_display;
	if (!displays->chosen.named_is_absent) {
		displays->asked[0] = '\0';
		return;
	}
	if (strcmp(displays->asked, named) == 0)
		return;
	memcpy(displays->asked, named, sizeof displays->asked);
	gz_warn(window->log,
		"view.tracker_display %s: no such monitor among %d; give the name or the number of "
		"one (G lists them)",
		named, displays->list.count);
}

/* Nothing is said of the only monitor. */
static void tell_choice(struct gz_window *window)
{
	struct gz_window_displays *displays = window->displays;
	const struct gz_monitor *monitor = gz_window_tracker_monitor(window);
	const enum gz_tracker_display_reason reason = displays->chosen.reason;
	if (!monitor || strcmp(displays->told, monitor->name) == 0 ||
	    reason == GZ_TRACKER_DISPLAY_ALONE || reason == GZ_TRACKER_DISPLAY_WINDOW)
		return;
	memcpy(displays->told, monitor->name, sizeof displays->told);
	gz_info(window->log, "the tracker's display is %s, %dx%d px, %.0fx%.0f mm, %s",
		monitor->name, monitor->rect_px[2], monitor->rect_px[3], monitor->mm[0],
		monitor->mm[1],
		reason == GZ_TRACKER_DISPLAY_NAMED ? "as set by view.tracker_display"
						   : "as the daemon describes it");
}

static void look_at_window(struct gz_window *window)
{
	int *rect = window->displays->rect_px;
	glfwGetWindowPos(window->glfw, &rect[0], &rect[1]);
	glfwGetWindowSize(window->glfw, &rect[2], &rect[3]);
	int *size_px = window->displays->framebuffer_px;
	glfwGetFramebufferSize(window->glfw, &size_px[0], &size_px[1]);
	/* X11 keeps the size of a minimised window. */
	if (glfwGetWindowAttrib(window->glfw, GLFW_ICONIFIED))
		size_px[0] = size_px[1] = 0;
	window->displays->rect_old = false;
}

/* The display server is asked no more often than needed: it costs more than the rest of a turn. */
static void turn_displays(struct gz_window *window)
{
	struct gz_window_displays *displays = window->displays;
	struct gz_display room;
	const int64_t now_ns = gz_clock_now_ns();
	if (displays->looked_ns == 0 || now_ns - displays->looked_ns > LOOK_INTERVAL_NS) {
		look_at_monitors(displays);
		displays->rect_old = true;
	}
	if (displays->rect_old)
		look_at_window(window);
	displays->chosen =
		gz_tracker_display_choose(&displays->list, window->settings.view.tracker_display,
					  display_of_daemon(window, &room), displays->rect_px);
	tell_refused(window);
	tell_choice(window);
}

const struct gz_monitor_list *gz_window_monitors(const struct gz_window *window)
{
	return &window->displays->list;
}

struct gz_tracker_display gz_window_tracker_display(const struct gz_window *window)
{
	return window->displays->chosen;
}

struct GLFWmonitor *gz_window_tracker_handle(const struct gz_window *window)
{
	const struct gz_window_displays *displays = window->displays;
	const int at = displays->chosen.monitor;
	return at >= 0 && at < displays->list.count ? displays->handles[at] : NULL;
}

const struct gz_monitor *gz_window_tracker_monitor(const struct gz_window *window)
{
	const struct gz_window_displays *displays = window->displays;
	const int at = displays->chosen.monitor;
	return at >= 0 && at < displays->list.count ? &displays->list.monitors[at] : NULL;
}

const struct gz_monitor *gz_window_own_monitor(const struct gz_window *window)
{
	const struct gz_window_displays *displays = window->displays;
	const int at = gz_monitor_at(&displays->list, displays->rect_px);
	return at >= 0 ? &displays->list.monitors[at] : NULL;
}

void gz_window_picture_size(const struct gz_window *window, int *out_width, int *out_height)
{
	gz_window_framebuffer(window, out_width, out_height);
	if (!gz_window_has_sections(window))
		return;
	*out_width = *out_width > 1 ? *out_width / 2 : *out_width;
	*out_height = *out_height > 1 ? *out_height / 2 : *out_height;
}

void gz_window_picture_place(const struct gz_window *window, double out_place[4])
{
	const struct gz_window_displays *displays = window->displays;
	int size_px[2];
	gz_window_picture_size(window, &size_px[0], &size_px[1]);
	for (int i = 0; i < 2; i++)
		out_place[2 + i] = displays->framebuffer_px[i] > 0
					   ? (double)displays->rect_px[2 + i] * size_px[i] /
						     displays->framebuffer_px[i]
					   : displays->rect_px[2 + i];
	out_place[0] = 0;
	out_place[1] = displays->rect_px[3] - out_place[3];
}

bool gz_window_mouse_point(const struct gz_window *window, struct gz_point *out_point)
{
	double place[4];
	gz_window_picture_place(window, place);
	if (place[2] < 1 || place[3] < 1)
		return false;
	*out_point = (struct gz_point) { (float)((window->cursor[0] - place[0]) / place[2]),
					 (float)((window->cursor[1] - place[1]) / place[3]) };
	return true;
}

void gz_window_rect(const struct gz_window *window, int out_rect_px[4])
{
	const int *rect_px = window->displays->rect_px;
	double place[4];
	gz_window_picture_place(window, place);
	out_rect_px[0] = rect_px[0] + (int)lround(place[0]);
	out_rect_px[1] = rect_px[1] + (int)lround(place[1]);
	out_rect_px[2] = (int)lround(place[2]);
	out_rect_px[3] = (int)lround(place[3]);
}

void gz_window_framebuffer(const struct gz_window *window, int *out_width, int *out_height)
{
	*out_width = window->displays->framebuffer_px[0];
	*out_height = window->displays->framebuffer_px[1];
}

struct gz_window_share gz_window_share(const struct gz_window *window)
{
	const bool fills = window->options->gaze_fills_window || gz_window_is_simulating(window);
	int rect_px[4];
	gz_window_rect(window, rect_px);
	return gz_window_share_of(fills ? NULL : gz_window_tracker_monitor(window), rect_px);
}

/* Move a window whose monitor has gone onto another one. */
static void bring_window_back(struct gz_window *window)
{
	const struct gz_window_displays *displays = window->displays;
	const int *rect = displays->rect_px;
	const int at = gz_monitor_at(&displays->list, rect);
	if (at < 0 || glfwGetWindowMonitor(window->glfw))
		return;
	const int *to = displays->list.monitors[at].rect_px;
	const int x = rect[0] + rect[2] / 2, y = rect[1] + rect[3] / 2;
	if (x < to[0] || x >= to[0] + to[2] || y < to[1] || y >= to[1] + to[3])
		glfwSetWindowPos(window->glfw, to[0], to[1]);
}

/* The window's context is current on the thread that gets events. */
static void on_monitor(GLFWmonitor *monitor, int event)
{
	GLFWwindow *glfw = glfwGetCurrentContext();
	struct gz_window *window = glfw ? glfwGetWindowUserPointer(glfw) : NULL;
	const char *name = glfwGetMonitorName(monitor);
	if (!window)
		return;
	struct gz_window_displays *displays = window->displays;
	if (event == GLFW_DISCONNECTED)
		gz_warn(window->log, "monitor %s has gone; the window stays", name ? name : "");
	look_at_monitors(displays);
	look_at_window(window);
	if (event == GLFW_DISCONNECTED)
		bring_window_back(window);
	displays->told[0] = '\0';
	window->cast_needed = true;
	gz_window_wake_panels(window);
}

static void fill_tracker_display(struct gz_window *window, int number)
{
	(void)number;
	GLFWmonitor *wanted = gz_window_tracker_handle(window);
	if (!wanted)
		return;
	const bool there = glfwGetWindowMonitor(window->glfw) == wanted;
	gz_window_fill_monitor(window, there ? NULL : wanted);
	window->present_needed = true;
}

static const struct gz_window_action displays_actions[] = {
	{ .letter = 'd',
	  .keys = "D",
	  .help = "full screen on the tracker's display",
	  .name = "Full screen on the tracker's display",
	  .menu = GZ_MENU_VIEW,
	  .section = 3,
	  .words = "fullscreen monitor",
	  .run = fill_tracker_display },
};

static enum gz_result list_monitors(struct gz_window *window)
{
	look_at_monitors(window->displays);
	return GZ_OK;
}

static void on_place(GLFWwindow *glfw, int x_or_width, int y_or_height)
{
	const struct gz_window *window = glfwGetWindowUserPointer(glfw);
	(void)x_or_width;
	(void)y_or_height;
	if (window)
		window->displays->rect_old = true;
}

static void on_iconify(GLFWwindow *glfw, int iconified)
{
	on_place(glfw, iconified, 0);
}

static enum gz_result attach_display_callbacks(struct gz_window *window)
{
	glfwSetMonitorCallback(on_monitor);
	glfwSetWindowPosCallback(window->glfw, on_place);
	glfwSetWindowSizeCallback(window->glfw, on_place);
	glfwSetWindowIconifyCallback(window->glfw, on_iconify);
	window->displays->rect_old = true;
	return GZ_OK;
}

const struct gz_window_part gz_window_displays_part = {
	.name = "displays",
	.title = "window",
	GZ_PART_ACTIONS(displays_actions),
	GZ_PART_STATE(displays),
	.open = list_monitors,
	.gl_open = attach_display_callbacks,
	.turn = turn_displays,
};
