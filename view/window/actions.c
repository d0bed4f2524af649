/* Keys to actions. */
#include <ctype.h>
#include <string.h>

#include <GLFW/glfw3.h>

#include "view/panels/widgets.h"
#include "view/window/part.h"
#include "view/window/window_state.h"

/* Keys that move about in panels, where somebody does. */
static bool navigates(int key)
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

int gz_window_modifiers(int glfw)
{
	return (glfw & GLFW_MOD_SHIFT ? GZ_KEY_SHIFT : 0) |
	       (glfw & GLFW_MOD_CONTROL ? GZ_KEY_CONTROL : 0);
}

/* The key's letter in the user's layout, not of its place on an American keyboard; 0: it has none.
 */
static int letter_of(int key, int scancode)
{
	const char *name = key == GLFW_KEY_SPACE ? " " : glfwGetKeyName(key, scancode);
	return name && name[0] && !name[1] ? tolower((unsigned char)name[0]) : 0;
}

static bool matches(const struct gz_window_action *action, int key, int letter, int modifiers)
{
	if (action->modifiers != modifiers)
		return false;
	return action->key ? action->key == key : letter && action->letter == letter;
}

/* The first action that @p wanted says yes to is run. */
struct wanted {
	int key, letter, modifiers;
	bool repeated;
};

static bool run_first(struct gz_window *window, const struct wanted *wanted)
{
	for (const struct gz_window_part *const *part = gz_window_parts; *part; part++) {
		for (size_t i = 0; i < (*part)->action_count; i++) {
			const struct gz_window_action *action = &(*part)->actions[i];
			if (!matches(action, wanted->key, wanted->letter, wanted->modifiers) ||
			    (action->applies && !action->applies(window)))
				continue;
			if (!wanted->repeated || action->repeats)
				action->run(window, action->number);
			return true;
		}
	}
	return false;
}

bool gz_window_run_action(struct gz_window *window, int key, int scancode, int modifiers,
			  bool repeated)
{
	if (window->alone)
		return window->alone->key && window->alone->key(window, key, scancode, repeated);
	if (gz_widgets_have_text() || gz_widgets_have_dialog() ||
	    (modifiers & (GLFW_MOD_ALT | GLFW_MOD_SUPER)) ||
	    (gz_widgets_have_navigation() && navigates(key)))
		return false;
	const struct wanted wanted = {
		.key = key,
		.letter = letter_of(key, scancode),
		.modifiers = gz_window_modifiers(modifiers),
		.repeated = repeated,
	};
	return run_first(window, &wanted);
}

/* Letters and digits are keys; what needs Shift on some layouts only is a character. */
bool gz_window_run_character(struct gz_window *window, unsigned codepoint)
{
	if (window->alone || gz_widgets_have_text() || gz_widgets_have_dialog() ||
	    (codepoint != '?' && codepoint != '+'))
		return false;
	const struct wanted wanted = { .letter = (int)codepoint };
	return run_first(window, &wanted);
}
