#include "view/window/window_state.h"

#include <GLFW/glfw3.h>

#include "base/clock.h"

/* How often an absent daemon is looked for, and one that is not looked at is told of the window, s
 * (chosen: a returning one is seen at once, at no cost). */
#define ABSENT_PATIENCE_S 0.25
/* Without anything live: only events change the picture. */
#define STILL_PATIENCE_S 10.0

static enum gz_result open_named(struct gz_window *window)
{
	const struct gz_gaze_choice *choice = &window->options->gaze;
	switch (choice->kind) {
	case GZ_GAZE_MOUSE:
		return GZ_OK;
	case GZ_GAZE_POINTER:
	case GZ_GAZE_LATEST:
		return gz_gaze_source_latest(choice->text, window->log, &window->source);
	case GZ_GAZE_LOG:
		return gz_gaze_source_log(choice->text, window->log, &window->source);
	case GZ_GAZE_FIXED:
		return gz_gaze_source_fixed(choice->point, &window->source);
	case GZ_GAZE_CENTRE: /* the camera always looks there */
		break;
	}
	return gz_gaze_source_fixed((struct gz_point) { 0.5f, 0.5f }, &window->source);
}

enum gz_result gz_window_gaze_open(struct gz_window *window)
{
	enum gz_result r = gz_gaze_source_mouse(&window->mouse);
	return r == GZ_OK ? open_named(window) : r;
}

struct GLFWmonitor *gz_window_monitor(struct GLFWwindow *glfw)
{
	int x, y, width, height, count;
	glfwGetWindowPos(glfw, &x, &y);
	glfwGetWindowSize(glfw, &width, &height);
	GLFWmonitor **monitors = glfwGetMonitors(&count);
	for (int i = 0; i < count; i++) {
		int left, top;
		const GLFWvidmode *mode = glfwGetVideoMode(monitors[i]);
		glfwGetMonitorPos(monitors[i], &left, &top);
		int middle_x = x + width / 2 - left, middle_y = y + height / 2 - top;
		if (mode && middle_x >= 0 && middle_x < mode->width && middle_y >= 0 &&
		    middle_y < mode->height)
			return monitors[i];
	}
	return glfwGetPrimaryMonitor();
}

struct gz_window_share gz_window_share(struct GLFWwindow *glfw)
{
	const struct gz_window_share whole = { 0, 0, 1, 1 };
	GLFWmonitor *monitor = gz_window_monitor(glfw);
	const GLFWvidmode *mode = monitor ? glfwGetVideoMode(monitor) : NULL;
	int x, y, left, top, width, height;
	glfwGetWindowSize(glfw, &width, &height);
	if (!mode || width < 1 || height < 1 || mode->width < 1 || mode->height < 1)
		return whole;
	glfwGetWindowPos(glfw, &x, &y);
	glfwGetMonitorPos(monitor, &left, &top);
	return (struct gz_window_share) {
		.x = (double)(x - left) / mode->width,
		.y = (double)(y - top) / mode->height,
		.width = (double)width / mode->width,
		.height = (double)height / mode->height,
	};
}

/* The geometry of the picture. A known display's window is a part of it; the default is made to
 * fit the picture. */
static struct gz_display picture_display(const struct gz_window *window,
					 struct gz_gaze_source *source,
					 const struct gz_window_share *share, int width, int height)
{
	const struct gz_scene *scene = gz_frame_maker_scene(window->maker);
	const struct gz_view_options *options = window->options;
	struct gz_display brought;
	const struct gz_display *known = NULL;
	if (scene->has_display)
		known = &scene->settings.display;
	else if (gz_gaze_source_display(source, &brought))
		known = &brought;
	struct gz_display display = gz_view_display(options, known, width, height);
	if (known || options->display_mm[0] > 0) {
		display.mm[0] *= share->width;
		display.mm[1] *= share->height;
	}
	display.px[0] = width;
	display.px[1] = height;
	return display;
}

void gz_window_gaze_now(struct gz_window *window, int width, int height,
			struct gz_window_gaze *out_gaze)
{
	struct gz_window_share share = { 0, 0, 1, 1 };
	struct gz_window_gaze gaze = { .source = "mouse" };
	struct gz_gaze_source *source = window->source;
	bool use_mouse = !source || window->mouse_chosen;
	if (!use_mouse) {
		gz_gaze_source_read(source, gz_clock_now_ns() - window->start_ns, &gaze.reading);
		gaze.missing = !gaze.reading.known || !gaze.reading.connected;
		use_mouse = gaze.missing;
	}
	if (use_mouse) {
		gz_gaze_source_read(window->mouse, 0, &gaze.reading);
		source = window->source ? window->source : window->mouse;
		if (!window->options->gaze_fills_window)
			share = gz_window_share(window->glfw);
	} else {
		gaze.source = window->options->gaze.kind == GZ_GAZE_POINTER ? "pointer"
									    : source->ops->name;
		/* A tracker's gaze is on the monitor, of which the window is a part. */
		if (source->ops->live && !window->options->gaze_fills_window) {
			share = gz_window_share(window->glfw);
			struct gz_point *point = &gaze.reading.point;
			point->x = (float)((point->x - share.x) / share.width);
			point->y = (float)((point->y - share.y) / share.height);
		}
	}
	gaze.display = picture_display(window, source, &share, width, height);
	*out_gaze = gaze;
}

double gz_window_gaze_patience_s(const struct gz_window *window)
{
	const struct gz_gaze_source *source = window->source;
	double frame_s = 1 / window->options->fps;
	if (window->panel_frames > 0)
		return 0;
	if (!window->maker)
		return STILL_PATIENCE_S;
	if (window->options->turn_deg != 0 || !gz_frame_settled(window->maker) ||
	    gz_frame_refinable(window->maker))
		return frame_s;
	if (!source || window->mouse_chosen)
		return window->link ? ABSENT_PATIENCE_S : STILL_PATIENCE_S;
	if (window->options->gaze.kind == GZ_GAZE_LOG)
		return frame_s;
	if (!source->ops->live)
		return STILL_PATIENCE_S;
	return window->line_missing ? ABSENT_PATIENCE_S : frame_s;
}
