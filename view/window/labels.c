/* The part that makes the surfaces of labels again when their settings change. */
#include <string.h>

#include <GLFW/glfw3.h>

#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

/* The surfaces take longer than a frame, so the mouse that changes their settings is waited for.
 * Letting go of it is an event. */
static void watch_labels(struct gz_window *window)
{
	if (!window->maker ||
	    glfwGetMouseButton(window->glfw, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS)
		return;
	const struct gz_label_look *shown = &gz_frame_maker_scene(window->maker)->settings.labels;
	if (gz_label_look_same(&window->settings.labels, shown))
		return;
	if (!gz_window_let_data_go(window))
		gz_warn(window->log,
			"the labels stay as they are while a session is recorded or shown");
	else
		(void)gz_frame_set_labels(window->maker, &window->settings.labels);
	/* Why it fails has been logged. */
	window->settings.labels = window->shown.labels = *shown;
	window->cast_needed = true;
	gz_window_wake_panels(window);
}

const struct gz_window_part gz_window_labels_part = {
	.name = "labels",
	.turn = watch_labels,
};
