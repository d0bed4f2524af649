/* Keys run the actions of parts; the mouse is a gaze, and moves what the part that has it moves. */
#include <ctype.h>
#include <math.h>
#include <string.h>

#include <GLFW/glfw3.h>

#include "base/clock.h"
#include "view/panels/widgets.h"
#include "view/window/displays.h"
#include "view/window/sections.h"
#include "view/window/window_state.h"

/* ---- keys ---- */

/* Keys that navigate panels. */
static bool is_navigation_key(int key)
{
	static const int keys[] = {
		GLFW_KEY_UP,        GLFW_KEY_DOWN,   GLFW_KEY_LEFT,    GLFW_KEY_RIGHT,
		GLFW_KEY_TAB,       GLFW_KEY_SPACE,  GLFW_KEY_ENTER,   GLFW_KEY_DELETE,
		GLFW_KEY_BACKSPACE, GLFW_KEY_ESCAPE, GLFW_KEY_PAGE_UP, GLFW_KEY_PAGE_DOWN,
	};
	for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
		if (key == keys[i])
			return true;
	return false;
}

/* GZ_KEY_SHIFT and GZ_KEY_CONTROL of GLFW's modifiers. */
static int modifiers_of(int glfw)
{
	return (glfw & GLFW_MOD_SHIFT ? GZ_KEY_SHIFT : 0) |
	       (glfw & GLFW_MOD_CONTROL ? GZ_KEY_CONTROL : 0);
}

/* The key's letter in the user's layout, rather than on an American keyboard; 0: it has none. */
static int letter_of(int key, int scancode)
{
	const char *name = key == GLFW_KEY_SPACE ? " " : glfwGetKeyName(key, scancode);
	return name && name[0] && !name[1] ? tolower((unsigned char)name[0]) : 0;
}

static bool action_matches(const struct gz_window_action *action, int key, int letter,
			   int modifiers)
{
	if (action->modifiers != modifiers)
		return false;
	return action->key ? action->key == key : letter && action->letter == letter;
}

/* What was pressed: a key, or a character alone. */
struct pressed_key {
	int key, letter, modifiers;
	bool repeated;
};

/* Run the first action of the parts that applies. @return whether there is one; if not, out_other
 * is one that has the key at other times, or NULL */
static bool run_first(struct gz_window *window, const struct pressed_key *pressed,
		      const struct gz_window_action **out_other)
{
	*out_other = NULL;
	GZ_FOR_EACH_PART (part) {
		for (size_t i = 0; i < (*part)->action_count; i++) {
			const struct gz_window_action *action = &(*part)->actions[i];
			if (!action_matches(action, pressed->key, pressed->letter,
					    pressed->modifiers))
				continue;
			if (action->applies && !action->applies(window)) {
				*out_other = action->name ? action : *out_other;
				continue;
			}
			if (!pressed->repeated || action->repeats)
				action->run(window, action->number);
			return true;
		}
	}
	return false;
}

/* Not of programs: modifiers, and what switches the keyboard or is the system's. */
static bool is_key_of_programs(int key)
{
	return key != GLFW_KEY_UNKNOWN && key < GLFW_KEY_LEFT_SHIFT &&
	       (key < GLFW_KEY_CAPS_LOCK || key > GLFW_KEY_PAUSE);
}

/* Nothing is run by a key. One that gives a character waits for it, as an action may have that. */
static void note_idle_key(struct gz_window *window, const struct pressed_key *pressed,
			  const struct gz_window_action *other)
{
	if (pressed->repeated || !is_key_of_programs(pressed->key))
		return;
	window->idle_key = (struct gz_window_idle_key) {
		.key = pressed->key,
		.letter = (char)pressed->letter,
		.modifiers = pressed->modifiers,
		.other = other,
		.noted = true,
	};
	if (!pressed->letter || (pressed->modifiers & GZ_KEY_CONTROL))
		gz_window_tell_idle_key(window);
}

/* Run the action of a key; all arguments are of GLFW. @return whether there is one */
static bool run_key(struct gz_window *window, int key, int scancode, int modifiers, bool repeated)
{
	const struct gz_window_action *other;
	if (window->alone)
		return window->alone->key && window->alone->key(window, key, scancode, repeated);
	if (gz_widgets_have_text() || gz_widgets_have_dialog() ||
	    gz_window_is_search_starting(window) || (modifiers & (GLFW_MOD_ALT | GLFW_MOD_SUPER)) ||
	    (gz_widgets_have_navigation() && is_navigation_key(key)))
		return false;
	const struct pressed_key pressed = {
		.key = key,
		.letter = letter_of(key, scancode),
		.modifiers = modifiers_of(modifiers),
		.repeated = repeated,
	};
	if (run_first(window, &pressed, &other))
		return true;
	note_idle_key(window, &pressed, other);
	return false;
}

/* Run the action of a typed character that needs Shift on some layouts only. @return whether there
 * is one */
static bool run_character(struct gz_window *window, unsigned codepoint)
{
	if (window->alone || gz_widgets_have_text() || gz_widgets_have_dialog() ||
	    (codepoint != '?' && codepoint != '+'))
		return false;
	const struct gz_window_action *other;
	const struct pressed_key pressed = { .letter = (int)codepoint };
	return run_first(window, &pressed, &other);
}

/* ---- mouse ---- */

/* A button that moved the mouse no farther was a click, unscaled (chosen: a hand that trembles). */
#define CLICK_NEAR 4.0

static struct gz_window *window_of(GLFWwindow *glfw)
{
	return glfwGetWindowUserPointer(glfw);
}

/* Dear ImGui takes input while it draws, and shows the result in the next frame. */
void gz_window_wake_panels(struct gz_window *window)
{
	enum { ANSWER_FRAMES = 3 };
	window->panel_frames = ANSWER_FRAMES;
}

static void on_window_key(GLFWwindow *glfw, int key, int scancode, int action, int mods)
{
	struct gz_window *window = window_of(glfw);
	gz_window_wake_panels(window);
	if (action == GLFW_RELEASE)
		return;
	gz_widgets_note_key(key);
	window->key_ns = gz_clock_now_ns();
	window->idle_key.noted = false;
	window->key_taken = run_key(window, key, scancode, mods, action == GLFW_REPEAT);
}

static void on_character(GLFWwindow *glfw, unsigned codepoint)
{
	struct gz_window *window = window_of(glfw);
	gz_window_wake_panels(window);
	if (gz_window_is_search_starting(window))
		gz_window_type_into_search(window, codepoint);
	else if (!window->key_taken && !run_character(window, codepoint))
		gz_window_tell_idle_key(window);
}

static void click_picture(struct gz_window *window)
{
	GZ_FOR_EACH_PART (part)
		if ((*part)->click)
			(*part)->click(window);
}

/* A right click without a drag opens the picture's menu. */
static void release_mouse(struct gz_window *window, int button, int modifiers)
{
	if (window->grab_button != button)
		return;
	const bool clicked =
		window->grabber && window->grab_moved <= CLICK_NEAR * (double)gz_widgets_scale();
	const bool plain = window->grabber == &gz_window_camera_part && modifiers == 0;
	window->grabber = NULL;
	if (clicked && button == GLFW_MOUSE_BUTTON_RIGHT)
		gz_window_ask_for_menu(window);
	else if (clicked && plain && button == GLFW_MOUSE_BUTTON_LEFT && window->maker)
		click_picture(window);
}

/* Dear ImGui itself knows where the mouse was in the last frame only. */
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
		release_mouse(window, button, modifiers_of(mods));
	if (action == GLFW_PRESS && window->alone && window->alone->press)
		window->alone->press(window, button);
	if (action != GLFW_PRESS || window->alone || window->grabber || !window->maker ||
	    panels_have_mouse(window))
		return;
	GZ_FOR_EACH_PART (part)
		if (!window->grabber && (*part)->grab &&
		    (*part)->grab(window, button, modifiers_of(mods)))
			window->grabber = *part;
	window->grab_button = button;
	window->grab_moved = 0;
}

/* The mouse's gaze is a share of the window, which also changes with the window's size. */
static void move_mouse_gaze(struct gz_window *window)
{
	struct gz_point point;
	window->cursor_held = false;
	if (gz_window_mouse_point(window, &point) && !gz_window_sections_lie_at(window, point))
		gz_gaze_source_move(window->mouse, point);
}

static void on_cursor(GLFWwindow *glfw, double x, double y)
{
	struct gz_window *window = window_of(glfw);
	const double right = x - window->cursor[0], down = y - window->cursor[1];
	window->cursor[0] = x;
	window->cursor[1] = y;
	window->grab_moved += fabs(right) + fabs(down);
	if (window->grabber && window->maker)
		window->grabber->drag(window, right, down);
	window->cursor_known = true;
	gz_window_wake_panels(window);
	window->cursor_held = true;
	gz_window_follow_cursor(window);
}

void gz_window_follow_cursor(struct gz_window *window)
{
	/* While the mouse is over a panel or a menu, its gaze rests where it left the picture. */
	if (window->cursor_held && (window->grabber || !panels_have_mouse(window)))
		move_mouse_gaze(window);
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
	GZ_FOR_EACH_PART (part)
		if ((*part)->wheel && (*part)->wheel(window, up))
			return;
}

static void on_size(GLFWwindow *glfw, int width, int height)
{
	(void)width;
	(void)height;
	struct gz_window *window = window_of(glfw);
	window->cast_needed = true;
	if (window->cursor_known && !panels_have_mouse(window))
		move_mouse_gaze(window);
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
	glfwSetKeyCallback(glfw, on_window_key);
	glfwSetCharCallback(glfw, on_character);
	glfwSetMouseButtonCallback(glfw, on_button);
	glfwSetCursorPosCallback(glfw, on_cursor);
	glfwSetCursorEnterCallback(glfw, on_enter);
	glfwSetScrollCallback(glfw, on_wheel);
	glfwSetFramebufferSizeCallback(glfw, on_size);
	glfwSetWindowRefreshCallback(glfw, on_damage);
	glfwSetWindowContentScaleCallback(glfw, on_scale);
	/* A mouse that rests in the window is a gaze before it moves. */
	glfwGetCursorPos(glfw, &x, &y);
	glfwGetWindowSize(glfw, &width, &height);
	if (x >= 0 && y >= 0 && x < width && y < height) {
		on_enter(glfw, GLFW_TRUE);
		on_cursor(glfw, x, y);
	}
}
