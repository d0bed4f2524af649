/**
 * @file
 * What is drawn over the picture: the text line, the list of keys, the cross, letters, the
 * settings. Dear ImGui behind a C interface; its C++ stays in panel.cpp and panel_settings.cpp.
 */
#ifndef GZ_VIEW_PANEL_H
#define GZ_VIEW_PANEL_H

#include <stdbool.h>
#include <stddef.h>

#include "base/option.h"

#ifdef __cplusplus
extern "C" {
#endif

struct GLFWwindow;
struct gz_letters;

/** What to draw. Places are in the window's screen coordinates, as GLFW's cursor is. */
struct gz_panel_content {
	const char *line; /**< UTF-8, top left */
	bool warn;        /**< the line tells of something to see to: amber */
	const char *keys; /**< lines to show in a box; NULL for none */
	bool cross;       /**< draw one at cross_at */
	float cross_at[2];
	const struct gz_letters *letters;         /**< at the edges; NULL for none */
	const struct gz_option_binding *settings; /**< to show and change; NULL for no panel */
	size_t settings_count;
	/** Whether a row counts, by its key; others are shown grey. NULL: all do. */
	bool (*applies)(const void *user, const char *key);
	const void *applies_user;
};

/**
 * Set up. The window's OpenGL context must be current; callbacks that the window has stay in force
 * and are called first.
 *
 * @return false if Dear ImGui cannot be set up
 */
bool gz_panel_init(struct GLFWwindow *window);

/** Draw into the current framebuffer. Only between gz_panel_init() and gz_panel_free(). @return
 *  whether a setting has been changed, within its row's range. */
bool gz_panel_draw(const struct gz_panel_content *content);

/** Whether the mouse is the panel's: over it, or dragging something of it. As of the last drawing.
 */
bool gz_panel_has_mouse(void);

/** Whether what is typed goes into the panel. As of the last drawing. */
bool gz_panel_has_keyboard(void);

/** Draw @p text, UTF-8, over the middle of the current framebuffer: each line centred, dark, in
 * twice the interface's size. Only between gz_panel_init() and gz_panel_free(). */
void gz_panel_draw_message(const char *text);

/** Take down what gz_panel_init() set up; nothing if it did not. */
void gz_panel_free(void);

#ifdef __cplusplus
}
#endif

#endif
