#include "view/window_state.h"

#include <ctype.h>
#include <math.h>

#include <GLFW/glfw3.h>

#include "view/panel.h"

/* A drag over the window's height turns by this much (chosen: half a turn within one sweep). */
#define DRAG_DEG_PER_HEIGHT 180.0
/* One notch of the wheel (chosen: seven notches halve the distance). */
#define ZOOM_PER_NOTCH 0.9

const char *gz_window_keys_text(void)
{
	return "1 2 3 4   standard, mdc, ddc, acuity\n"
	       "5 6 7     mdc3, uniform, table\n"
	       "drag      turn the camera\n"
	       "wheel     zoom\n"
	       "R         reset the camera\n"
	       "C         cross at the gaze\n"
	       "M         gaze from the mouse or from the daemon\n"
	       "P         settings\n"
	       "L         letters: which side is where\n"
	       "F         full screen\n"
	       "H or ?    show or hide this\n"
	       "Esc or Q  quit";
}

static struct gz_window *window_of(GLFWwindow *glfw)
{
	return glfwGetWindowUserPointer(glfw);
}

void gz_window_toggle_fullscreen(struct gz_window *window)
{
	int *place = window->windowed_place;
	if (glfwGetWindowMonitor(window->glfw)) {
		glfwSetWindowMonitor(window->glfw, NULL, place[0], place[1], place[2], place[3],
				     GLFW_DONT_CARE);
		return;
	}
	GLFWmonitor *monitor = gz_window_monitor(window->glfw);
	const GLFWvidmode *mode = monitor ? glfwGetVideoMode(monitor) : NULL;
	if (!mode)
		return;
	glfwGetWindowPos(window->glfw, &place[0], &place[1]);
	glfwGetWindowSize(window->glfw, &place[2], &place[3]);
	glfwSetWindowMonitor(window->glfw, monitor, 0, 0, mode->width, mode->height,
			     mode->refreshRate);
}

/* Dear ImGui takes in what happens while it draws, and shows what came of it a frame later. */
void gz_window_wake_panel(struct gz_window *window)
{
	enum { ANSWER_FRAMES = 3 };
	if (window->panel_shown)
		window->panel_frames = ANSWER_FRAMES;
}

static void choose_method(struct gz_window *window, int method)
{
	if (method == GZ_METHOD_TABLE && window->settings.foveation.table.count == 0)
		return; /* the scene has none to show */
	window->settings.foveation.method = method;
	window->cast_needed = true;
}

/* Letters are those of the user's layout, not of their places on an American keyboard. */
static void press_letter(struct gz_window *window, int letter)
{
	switch (letter) {
	case 'c':
		window->cross = !window->cross;
		break;
	case 'm':
		if (window->source)
			window->mouse_chosen = !window->mouse_chosen;
		break;
	case 'f':
		gz_window_toggle_fullscreen(window);
		break;
	case 'p':
		window->panel_shown = !window->panel_shown;
		gz_window_wake_panel(window);
		break;
	case 'l':
		window->letters = !window->letters;
		if (window->letters)
			gz_frame_tell_unoriented(window->maker);
		break;
	case 'h':
		window->keys_shown = !window->keys_shown;
		break;
	case 'r':
		window->settings.camera = gz_frame_maker_scene(window->maker)->settings.camera;
		window->cast_needed = true;
		break;
	case 'q':
		glfwSetWindowShouldClose(window->glfw, GLFW_TRUE);
		break;
	default:
		return;
	}
	window->present_needed = true;
}

static void on_key(GLFWwindow *glfw, int key, int scancode, int action, int mods)
{
	struct gz_window *window = window_of(glfw);
	gz_window_wake_panel(window);
	if (gz_panel_has_keyboard())
		return;
	if (action != GLFW_PRESS || (mods & (GLFW_MOD_CONTROL | GLFW_MOD_ALT | GLFW_MOD_SUPER)))
		return;
	if (key == GLFW_KEY_ESCAPE) {
		glfwSetWindowShouldClose(glfw, GLFW_TRUE);
	} else if (key >= GLFW_KEY_1 && key < GLFW_KEY_1 + GZ_METHOD_COUNT) {
		choose_method(window, key - GLFW_KEY_1);
	} else if (key >= GLFW_KEY_KP_1 && key < GLFW_KEY_KP_1 + GZ_METHOD_COUNT) {
		choose_method(window, key - GLFW_KEY_KP_1);
	} else {
		const char *name = glfwGetKeyName(key, scancode);
		if (name && name[0] && !name[1])
			press_letter(window, tolower((unsigned char)name[0]));
	}
}

static void on_character(GLFWwindow *glfw, unsigned codepoint)
{
	struct gz_window *window = window_of(glfw);
	gz_window_wake_panel(window);
	if (codepoint == '?' && !gz_panel_has_keyboard()) {
		window->keys_shown = !window->keys_shown;
		window->present_needed = true;
	}
}

static void on_button(GLFWwindow *glfw, int button, int action, int mods)
{
	(void)mods;
	struct gz_window *window = window_of(glfw);
	gz_window_wake_panel(window);
	if (button == GLFW_MOUSE_BUTTON_LEFT)
		window->dragging = action == GLFW_PRESS && !gz_panel_has_mouse();
}

static void drag(struct gz_window *window, double right, double down, int height)
{
	double deg = DRAG_DEG_PER_HEIGHT / height;
	/* The volume follows the hand, so the eye goes the other way. */
	gz_camera_orbit(&window->settings.camera, -right * deg, -down * deg);
	window->cast_needed = true;
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
	int width, height;
	glfwGetWindowSize(glfw, &width, &height);
	if (window->dragging && height > 0)
		drag(window, x - window->cursor[0], y - window->cursor[1], height);
	window->cursor[0] = x;
	window->cursor[1] = y;
	window->cursor_known = true;
	gz_window_wake_panel(window);
	/* Whoever changes a setting wants to see what it does where he looked before. */
	if (!gz_panel_has_mouse())
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
	gz_window_wake_panel(window);
	if (gz_panel_has_mouse())
		return;
	gz_camera_zoom(&window->settings.camera, pow(ZOOM_PER_NOTCH, up));
	window->cast_needed = true;
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
	/* A mouse that already rests in the window is a gaze before it moves. */
	glfwGetCursorPos(glfw, &x, &y);
	glfwGetWindowSize(glfw, &width, &height);
	if (x >= 0 && y >= 0 && x < width && y < height) {
		on_enter(glfw, GLFW_TRUE);
		on_cursor(glfw, x, y);
	}
}
