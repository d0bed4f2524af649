/* The part that has the foveation methods, the settings panel, the letters of a patient's sides,
 * the gaze cursor, and full screen. Its state is in struct gz_window. */
#include <GLFW/glfw3.h>

#include "render/plan/method.h"
#include "view/draw/letters.h"
#include "view/panels/marks.h"
#include "view/panels/settings_panel.h"
#include "view/settings/scene_keys.h"
#include "view/window/history.h"
#include "view/window/sections.h"
#include "view/window/window_state.h"

#define GZ_LOG_MODULE "window"

static bool has_scene(const struct gz_window *window)
{
	return window->maker != NULL;
}

static void choose_method(struct gz_window *window, int method)
{
	if (gz_methods[method].needs_table && window->settings.foveation.table.count == 0) {
		gz_warn(window->log,
			"the scene names no table of spacings, which the method %s needs: give "
			"--foveation.table FILE",
			gz_method_names[method]);
		return;
	}
	window->settings.foveation.method = method;
	window->cast_needed = true;
}

static void toggle_cross(struct gz_window *window, int number)
{
	(void)number;
	window->settings.view.gaze_cursor = !window->settings.view.gaze_cursor;
	window->present_needed = true;
}

static void toggle_settings(struct gz_window *window, int number)
{
	(void)number;
	window->settings_open = !window->settings_open;
	window->setting_marked = NULL;
	gz_window_wake_panels(window);
}

static void toggle_letters(struct gz_window *window, int number)
{
	(void)number;
	window->settings.view.letters = !window->settings.view.letters;
	window->present_needed = true;
	if (window->settings.view.letters && window->maker)
		gz_frame_tell_unoriented(window->maker);
}

static void toggle_fullscreen(struct gz_window *window, int number)
{
	(void)number;
	gz_window_toggle_fullscreen(window);
	window->present_needed = true;
}

static bool is_method(const struct gz_window *window, int method)
{
	return window->settings.foveation.method == method;
}

#define METHOD(digit, method, text, what, label)                                      \
	{ .key = GLFW_KEY_##digit,                                                    \
	  .number = (method),                                                         \
	  .keys = (text),                                                             \
	  .help = (what),                                                             \
	  .name = (label),                                                            \
	  .menu = GZ_MENU_PICTURE,                                                    \
	  .submenu = "Method",                                                        \
	  .on_picture = true,                                                         \
	  .is_on = is_method,                                                         \
	  .applies = has_scene,                                                       \
	  .run = choose_method },                                                     \
	{                                                                             \
		.key = GLFW_KEY_KP_##digit, .number = (method), .applies = has_scene, \
		.run = choose_method                                                  \
	}

static bool is_settings_open(const struct gz_window *window)
{
	return window->settings_open;
}

static bool is_settings_on(const struct gz_window *window, int number)
{
	(void)number;
	return window->settings_open;
}

static bool is_cross_on(const struct gz_window *window, int number)
{
	(void)number;
	return window->settings.view.gaze_cursor;
}

static bool are_letters_on(const struct gz_window *window, int number)
{
	(void)number;
	return window->settings.view.letters;
}

static bool is_fullscreen_on(const struct gz_window *window, int number)
{
	(void)number;
	return glfwGetWindowMonitor(window->glfw) != NULL;
}

static const struct gz_window_action basics_actions[] = {
	{ .key = GLFW_KEY_ESCAPE, .applies = is_settings_open, .run = toggle_settings },
	METHOD(1, 0, "1", "method standard: every ray", "Standard"),
	METHOD(2, 1, "2", "method mdc: a sharp square, coarse around it", "MDC"),
	METHOD(3, 2, "3", "method ddc: two ellipses", "DDC"),
	METHOD(4, 3, "4", "method acuity: as fine as the eye resolves", "Acuity"),
	METHOD(5, 4, "5", "method mdc3: three squares", "MDC3"),
	METHOD(6, 5, "6", "method uniform: the same everywhere", "Uniform"),
	METHOD(7, 6, "7", "method table: spacings from a file", "Table"),
	METHOD(8, 7, "8", "method contrast: rays where the eye sees contrast", "Contrast"),
	{ .letter = 'c',
	  .keys = "C",
	  .help = "cross at the gaze",
	  .name = "Cross at the gaze",
	  .menu = GZ_MENU_GAZE,
	  .section = 1,
	  .on_picture = true,
	  .words = "cursor point mark",
	  .is_on = is_cross_on,
	  .group = "gaze",
	  .run = toggle_cross },
	{ .letter = 'p',
	  .keys = "P",
	  .help = "all settings of the scene",
	  .name = "All settings",
	  .menu = GZ_MENU_EDIT,
	  .section = 1,
	  .on_picture = true,
	  .words = "preferences options configuration",
	  .is_on = is_settings_on,
	  .run = toggle_settings },
	{ .letter = 'l',
	  .keys = "L",
	  .help = "letters: sides of the patient",
	  .name = "Sides of the patient",
	  .menu = GZ_MENU_VIEW,
	  .section = 2,
	  .words = "orientation left right anterior",
	  .is_on = are_letters_on,
	  .run = toggle_letters },
	{ .letter = 'f',
	  .keys = "F F11",
	  .help = "full screen",
	  .name = "Full screen",
	  .menu = GZ_MENU_VIEW,
	  .section = 3,
	  .on_picture = true,
	  .words = "fullscreen maximise maximize",
	  .is_on = is_fullscreen_on,
	  .group = "window",
	  .run = toggle_fullscreen },
	{ .key = GLFW_KEY_F11, .run = toggle_fullscreen },
};

static bool setting_has_effect(const void *user, const char *key)
{
	return gz_setting_applies(user, key);
}

void gz_window_show_setting(struct gz_window *window, const char *key)
{
	window->settings_open = true;
	window->setting_marked = key;
	window->setting_reveal = true;
	gz_window_wake_panels(window);
}

struct gz_settings_panel gz_window_settings_rows(const struct gz_window *window)
{
	return (struct gz_settings_panel) {
		.bindings = window->tables.bindings,
		.count = GZ_VIEW_SCENE_TABLES,
		.applies = setting_has_effect,
		.user = &window->settings,
		.given = gz_window_given_settings(window),
	};
}

static void draw_patient_letters(struct gz_window *window)
{
	struct gz_letters letters;
	const struct gz_place corner = gz_window_place_of(window, (struct gz_point) { 0, 0 });
	const struct gz_place opposite = gz_window_place_of(window, (struct gz_point) { 1, 1 });
	if (window->settings.view.letters && window->maker &&
	    gz_frame_maker_scene(window->maker)->volume.oriented &&
	    gz_letters_of_camera(&window->settings.camera, &letters) == GZ_OK)
		gz_marks_draw_letters(&letters, corner, opposite);
}

static void draw_basics(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	draw_patient_letters(window);
	if (window->settings.view.gaze_cursor && gaze->reading.known)
		gz_marks_draw_cross(gz_window_place_of(window, gaze->reading.point));
	window->cross_drawn = gaze->reading.point;
	if (!window->settings_open || !window->maker)
		return;
	struct gz_settings_panel panel = gz_window_settings_rows(window);
	panel.margin_top = window->panels_top;
	panel.open = true;
	panel.marked = window->setting_marked;
	panel.reveal = window->setting_reveal;
	gz_settings_panel_draw(&panel);
	window->settings_open = panel.open;
	window->setting_reveal = false;
	if (!panel.open)
		window->setting_marked = NULL;
}

static bool cursor_follows(struct gz_window *window, const struct gz_window_gaze *gaze)
{
	const struct gz_point at = gaze->reading.point;
	return window->settings.view.gaze_cursor &&
	       (at.x != window->cross_drawn.x || at.y != window->cross_drawn.y);
}

const struct gz_window_part gz_window_basics_part = {
	.name = "basics",
	.title = "picture",
	GZ_PART_ACTIONS(basics_actions),
	.follows = cursor_follows,
	.panels = draw_basics,
};
