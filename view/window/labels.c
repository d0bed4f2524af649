/* The part that makes the surfaces of labels again when their settings change, beside the frames.
 */
#include <GLFW/glfw3.h>

#include "view/panels/marks.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* The row of the mark while surfaces are made. */
enum { MARK_ROW = 4 };

struct gz_window_labels {
	bool making;
	struct gz_label_look wanted; /* what is being made */
	int64_t start_ns;
	int64_t drawn_s; /* time in the mark, as last drawn */
};

/* Called on the threads that make them. */
static void wake_loop_for_labels(void *user)
{
	(void)user;
	glfwPostEmptyEvent();
}

static const struct gz_label_look *look_shown(const struct gz_window *window)
{
	return &gz_frame_maker_scene(window->maker)->settings.labels;
}

static void end_change(struct gz_window *window)
{
	window->labels->making = false;
	window->settings.labels = window->shown.labels = *look_shown(window);
	window->cast_needed = true;
	gz_window_wake_panels(window);
}

/* Let nothing use the surfaces shown. If something keeps them, the change is given up. */
static bool free_surfaces_shown(struct gz_window *window)
{
	if (gz_window_let_data_go(window))
		return true;
	gz_warn(window->log, "the labels stay as they are while a session is recorded or shown, "
			     "and while a picture of full quality is made");
	gz_frame_drop_labels(window->maker);
	end_change(window);
	return false;
}

/* What cannot be made has been logged. */
static void go_on_with_change(struct gz_window *window)
{
	struct gz_window_labels *self = window->labels;
	if (!self->making && !free_surfaces_shown(window))
		return;
	if (!self->making)
		self->start_ns = gz_clock_now_ns();
	self->making = true;
	self->wanted = window->settings.labels;
	switch (gz_frame_prepare_labels(window->maker, &window->settings, wake_loop_for_labels)) {
	case GZ_FRAME_PREPARING:
		window->present_needed =
			window->present_needed ||
			(gz_clock_now_ns() - self->start_ns) / GZ_NS_PER_S != self->drawn_s;
		return;
	case GZ_FRAME_READY:
		if (!free_surfaces_shown(window))
			return;
		(void)gz_frame_show_labels(window->maker);
		break;
	case GZ_FRAME_CANNOT_WAIT:
		break;
	}
	end_change(window);
}

/* Whether the mouse may still be changing what is asked for. Letting go of it is an event. */
static bool may_change_further(const struct gz_window *window)
{
	const struct gz_window_labels *self = window->labels;
	return glfwGetMouseButton(window->glfw, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS &&
	       !(self->making && gz_label_look_same(&window->settings.labels, &self->wanted));
}

static void watch_labels(struct gz_window *window)
{
	struct gz_window_labels *self = window->labels;
	if (!window->maker || may_change_further(window))
		return;
	if (!gz_label_look_same(&window->settings.labels, look_shown(window))) {
		go_on_with_change(window);
	} else if (self->making && !gz_frame_making_labels(window->maker)) { /* taken back */
		gz_frame_drop_labels(window->maker);
		end_change(window);
	}
}

static void forget_change(struct gz_window *window)
{
	window->labels->making = false;
	if (window->maker)
		gz_frame_drop_labels(window->maker);
}

static void draw_label_mark(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	struct gz_window_labels *self = window->labels;
	(void)gaze;
	if (!self->making)
		return;
	self->drawn_s = (gz_clock_now_ns() - self->start_ns) / GZ_NS_PER_S;
	gz_marks_draw_running(MARK_ROW, "making surfaces", false, self->drawn_s);
}

const struct gz_window_part gz_window_labels_part = {
	.name = "labels",
	GZ_PART_STATE(labels),
	.scene_leaving = forget_change,
	.turn = watch_labels,
	.panels = draw_label_mark,
};
