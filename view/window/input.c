#include "view/window/window_state.h"

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "view/panels/widgets.h"
#include "view/window/part.h"

static struct gz_window *window_of(GLFWwindow *glfw)
{
	return glfwGetWindowUserPointer(glfw);
}

void gz_window_fill_monitor(struct gz_window *window, GLFWmonitor *monitor)
{
	int *place = window->windowed_place;
	const bool fills = glfwGetWindowMonitor(window->glfw) != NULL;
	const GLFWvidmode *mode = monitor ? glfwGetVideoMode(monitor) : NULL;
	if (!monitor && fills)
		glfwSetWindowMonitor(window->glfw, NULL, place[0], place[1], place[2], place[3],
				     GLFW_DONT_CARE);
	if (!mode)
		return;
	if (!fills) {
		glfwGetWindowPos(window->glfw, &place[0], &place[1]);
		glfwGetWindowSize(window->glfw, &place[2], &place[3]);
	}
	glfwSetWindowMonitor(window->glfw, monitor, 0, 0, mode->width, mode->height,
			     mode->refreshRate);
}

void gz_window_toggle_fullscreen(struct gz_window *window)
{
	const bool fills = glfwGetWindowMonitor(window->glfw) != NULL;
	gz_window_fill_monitor(window, fills ? NULL : gz_window_monitor(window->glfw));
}

/* Dear ImGui takes in what happens while it draws, and shows what came of it a frame later. */
void gz_window_wake_panels(struct gz_window *window)
{
	enum { ANSWER_FRAMES = 3 };
	window->panel_frames = ANSWER_FRAMES;
}

static void on_key(GLFWwindow *glfw, int key, int scancode, int action, int mods)
{
	struct gz_window *window = window_of(glfw);
	gz_window_wake_panels(window);
	if (action == GLFW_RELEASE)
		return;
	gz_widgets_note_key(key);
	window->key_ns = gz_clock_now_ns();
	window->key_taken =
		gz_window_run_action(window, key, scancode, mods, action == GLFW_REPEAT);
}

static void on_character(GLFWwindow *glfw, unsigned codepoint)
{
	struct gz_window *window = window_of(glfw);
	gz_window_wake_panels(window);
	if (!window->key_taken)
		gz_window_run_character(window, codepoint);
}

static void release(struct gz_window *window, int button)
{
	if (window->grab_button == button)
		window->grabber = NULL;
}

/* Also where it has come to a panel since the last frame. */
static bool panels_have_mouse(const struct gz_window *window)
{
	return gz_widgets_have_mouse() ||
	       gz_widgets_lie_at((float)window->cursor[0], (float)window->cursor[1]);
}

static void on_button(GLFWwindow *glfw, int button, int action, int mods)
{
	struct gz_window *window = window_of(glfw);
	gz_window_wake_panels(window);
	if (action == GLFW_RELEASE)
		release(window, button);
	if (action != GLFW_PRESS || window->alone || window->grabber || !window->maker ||
	    panels_have_mouse(window))
		return;
	for (const struct gz_window_part *const *part = gz_window_parts; *part && !window->grabber;
	     part++)
		if ((*part)->grab && (*part)->grab(window, button, gz_window_modifiers(mods)))
			window->grabber = *part;
	window->grab_button = button;
}

/* The place in the window becomes the place on the picture; also anew when the window's size
 * changes under a resting mouse. */
static void move_gaze(struct gz_window *window)
{
	int width, height;
	glfwGetWindowSize(window->glfw, &width, &height);
	if (width < 1 || height < 1)
		return;
	gz_gaze_source_move(window->mouse,
			    (struct gz_point) { (float)(window->cursor[0] / width),
						(float)(window->cursor[1] / height) });
}

static void on_cursor(GLFWwindow *glfw, double x, double y)
{
	struct gz_window *window = window_of(glfw);
	const double right = x - window->cursor[0], down = y - window->cursor[1];
	window->cursor[0] = x;
	window->cursor[1] = y;
	if (window->grabber && window->maker)
		window->grabber->drag(window, right, down);
	window->cursor_known = true;
	gz_window_wake_panels(window);
	/* Whoever changes a setting wants to see what it does where he looked before. */
	if (!gz_widgets_have_mouse())
		move_gaze(window);
}

static void on_enter(GLFWwindow *glfw, int entered)
{
	window_of(glfw)->cursor_inside = entered == GLFW_TRUE;
}

static void on_wheel(GLFWwindow *glfw, double right, double up)
{
	(void)right;
	struct gz_window *window = window_of(glfw);
	gz_window_wake_panels(window);
	if (window->alone || panels_have_mouse(window) || !window->maker)
		return;
	for (const struct gz_window_part *const *part = gz_window_parts; *part; part++)
		if ((*part)->wheel)
			(*part)->wheel(window, up);
}

static void on_size(GLFWwindow *glfw, int width, int height)
{
	(void)width;
	(void)height;
	struct gz_window *window = window_of(glfw);
	window->cast_needed = true;
	if (window->cursor_known)
		move_gaze(window);
}

static void on_scale(GLFWwindow *glfw, float x, float y)
{
	(void)x;
	(void)y;
	gz_widgets_follow_scale(glfw);
	gz_window_wake_panels(window_of(glfw));
}

static void on_damage(GLFWwindow *glfw)
{
	window_of(glfw)->present_needed = true;
}

void gz_window_input_attach(struct gz_window *window)
{
	GLFWwindow *glfw = window->glfw;
	double x, y;
	int width, height;
	glfwSetWindowUserPointer(glfw, window);
	glfwSetKeyCallback(glfw, on_key);
	glfwSetCharCallback(glfw, on_character);
	glfwSetMouseButtonCallback(glfw, on_button);
	glfwSetCursorPosCallback(glfw, on_cursor);
	glfwSetCursorEnterCallback(glfw, on_enter);
	glfwSetScrollCallback(glfw, on_wheel);
	glfwSetFramebufferSizeCallback(glfw, on_size);
	glfwSetWindowRefreshCallback(glfw, on_damage);
	glfwSetWindowContentScaleCallback(glfw, on_scale);
	/* A mouse that already rests in the window is a gaze before it moves. */
	glfwGetCursorPos(glfw, &x, &y);
	glfwGetWindowSize(glfw, &width, &height);
	if (x >= 0 && y >= 0 && x < width && y < height) {
		on_enter(glfw, GLFW_TRUE);
		on_cursor(glfw, x, y);
	}
}
