/**
 * @file
 * What the window is made of: each feature is a part, which has its state to itself, its keys, its
 * panels, and a say at fixed moments of the loop. window.c runs them all, in the order of
 * gz_window_parts; parts do not call each other but by what their headers offer. Internal to view/.
 *
 * All of it runs on the main thread, with the window's OpenGL context current.
 */
#ifndef GZ_VIEW_WINDOW_PART_H
#define GZ_VIEW_WINDOW_PART_H

#include <stdbool.h>
#include <stddef.h>

#include "base/result.h"

struct gz_window;
struct gz_window_gaze;

/** Modifiers of a key. */
enum { GZ_KEY_SHIFT = 1, GZ_KEY_CONTROL = 2 };

/** Something that a key does. */
struct gz_window_action {
	/** A character of the user's layout, in lower case: 'c', '+', ' '; 0 where @p key counts.
	 */
	char letter;
	int key;           /**< of GLFW: GLFW_KEY_F12; 0 where @p letter counts */
	int modifiers;     /**< GZ_KEY_SHIFT, GZ_KEY_CONTROL; exactly these */
	bool repeats;      /**< also while the key is held */
	int number;        /**< handed to run: for rows of keys that do the like */
	const char *keys;  /**< as shown in the list of keys: "Ctrl+O"; NULL: not listed, since
			      another row tells of it */
	const char *help;  /**< what it does, one line; some 48 letters fit */
	const char *group; /**< of the list, where it is not the part's; else NULL */
	/** Whether the key is this one's at the moment; else the next action with it has it. NULL:
	 *  always. */
	bool (*applies)(const struct gz_window *window);
	void (*run)(struct gz_window *window, int number);
};

/** A part. Each table is const and has static storage; any slot may be NULL. */
struct gz_window_part {
	const char *name;
	/** The group of the list that its keys stand in, of those that keys.c names; NULL: a group
	 *  of the part's name behind them. */
	const char *title;
	const struct gz_window_action *actions;
	size_t action_count;
	/** Once, before there is a window: make the part's state from the options. Logs what goes
	 * wrong. */
	enum gz_result (*open)(struct gz_window *window);
	/** The OpenGL context is there, for the first time or anew: make what lives in it. GL
	 * 3.3. */
	enum gz_result (*gl_open)(struct gz_window *window);
	/** A scene is there to be shown: window->maker, its renderer too, and settings are its. */
	void (*scene_shown)(struct gz_window *window);
	/** It is about to be freed: nothing may look at it any more, on no thread. */
	void (*scene_leaving)(struct gz_window *window);
	/** Each turn of the loop, first of all: look at threads and clocks; ask for a frame by
	 * window->cast_needed or window->present_needed. */
	void (*turn)(struct gz_window *window);
	/** The gaze of this turn, before anything goes by it: may be replaced. Only with a
	 * scene. */
	void (*gaze)(struct gz_window *window, struct gz_window_gaze *gaze);
	/** A button of the mouse (GLFW_MOUSE_BUTTON_LEFT, …) went down on the picture at
	 * window->cursor: whether its way until it is released is this part's. The first that says
	 * so has it. Only with a scene. */
	bool (*grab)(struct gz_window *window, int button, int modifiers);
	/** The mouse that the part has has moved to window->cursor, by so much. */
	void (*drag)(struct gz_window *window, double right, double down);
	/** The wheel was turned over the picture, notches. Only with a scene. */
	void (*wheel)(struct gz_window *window, double up);
	/** Whether what lies over the picture must be drawn anew for this gaze. */
	bool (*follows)(struct gz_window *window, const struct gz_window_gaze *gaze);
	/** A picture has been cast: window->record tells of it. */
	void (*frame_made)(struct gz_window *window);
	/** Draw by OpenGL over the picture, which is in the framebuffer of width times height
	 * px. */
	void (*paint)(struct gz_window *window, int width, int height);
	/** Draw panels and marks by panels/widgets.h. A changed window->settings is checked and
	 * taken afterwards. */
	void (*panels)(struct gz_window *window, const struct gz_window_gaze *gaze);
	/** Panels have been drawn too, and the framebuffer of width times height px is about to be
	 * swapped. */
	void (*drawn)(struct gz_window *window, int width, int height);
	/** What is on the screen has been swapped there. */
	void (*presented)(struct gz_window *window);
	/** A key of GLFW was pressed, before any action; only of the part that has the window to
	 * itself: window->alone. @return whether it was the part's */
	bool (*key)(struct gz_window *window, int key, int scancode, bool repeated);
	/** Seconds until the next turn is due, if no event comes before; INFINITY: whenever. */
	double (*patience_s)(const struct gz_window *window);
	/** The OpenGL context goes: delete what lives in it. Correct after a failed gl_open. */
	void (*gl_close)(struct gz_window *window);
	/** Free the state. Correct after a failed open, and without one. */
	void (*close)(struct gz_window *window);
};

/** All parts, NULL-terminated, in the order in which they are asked. */
extern const struct gz_window_part *const gz_window_parts[];

/** GZ_KEY_SHIFT and GZ_KEY_CONTROL of GLFW's modifiers. */
int gz_window_modifiers(int glfw);

/** Run the action of a key. @param key of GLFW @param scancode of GLFW, for its letter @param
 * modifiers of GLFW @param repeated the key is held @return whether there is one */
bool gz_window_run_action(struct gz_window *window, int key, int scancode, int modifiers,
			  bool repeated);

/** Run the action of a typed character that no letter key stands for, as '?' is. */
bool gz_window_run_character(struct gz_window *window, unsigned codepoint);

#endif
