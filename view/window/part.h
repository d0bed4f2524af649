/**
 * @file
 * The parts of the window. Each feature is a part: a file with its state, keys and panels, and with
 * functions that window.c calls at fixed moments of the loop. Parts use each other only by what the
 * headers of this folder offer. Internal to view/.
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

/** Menus, in their order in the bar; window/menu.c has their names. */
enum gz_window_menu {
	GZ_MENU_NONE,
	GZ_MENU_FILE,
	GZ_MENU_EDIT,
	GZ_MENU_VIEW,
	GZ_MENU_GAZE,
	GZ_MENU_PICTURE,
	GZ_MENU_STUDY,
	GZ_MENU_HELP,
	GZ_MENU_COUNT,
};

/** What can be done, by a key, in a menu and by its words: the list of keys, the menus and the
 *  search are made from these rows. */
struct gz_window_action {
	/** A character of the user's keyboard layout, in lower case: 'c', '+', ' '; 0: @p key is
	 *  used. */
	char letter;
	int key;           /**< of GLFW, as GLFW_KEY_F12; 0: @p letter is used */
	int modifiers;     /**< exactly these of GZ_KEY_SHIFT, GZ_KEY_CONTROL */
	bool repeats;      /**< runs again while the key is held */
	int number;        /**< handed to run, which several rows may share */
	const char *keys;  /**< as shown in the list of keys: "Ctrl+O"; NULL: not listed there */
	const char *help;  /**< what it does; about 48 letters fit */
	const char *group; /**< group in the list of keys; NULL: that of the part */
	const char *name;  /**< in menus: "Open..."; NULL: it is in no menu */
	enum gz_window_menu menu; /**< the menu it is in */
	int section;              /**< of the menu, 0 to 3; a line parts sections */
	const char *submenu; /**< it lies in a submenu of this name; NULL: in the menu itself */
	bool on_picture;     /**< it is also in the menu of a right click on the picture */
	const char *words;   /**< other words that find it, separated by blanks; or NULL */
	/** Whether what it switches is on, for a mark in menus. NULL: it is no switch. */
	bool (*is_on)(const struct gz_window *window, int number);
	/** Whether the key is this action's at present; if not, the next action with the key is
	 *  asked. NULL: always. */
	bool (*applies)(const struct gz_window *window);
	/** What it lacks at present, such as "empty", static: menus show it grey with this. Its key
	 *  still runs it, and it says what to do. NULL, or a slot that is NULL: nothing. */
	const char *(*lacks)(const struct gz_window *window, int number);
	void (*run)(struct gz_window *window, int number);
};

/** A part. Tables are const and have static storage. Any slot may be NULL or 0. */
struct gz_window_part {
	const char *name;
	/** Group of its keys in the list, one of those in keys.c; NULL: the part's name, behind
	 *  them. */
	const char *title;
	const struct gz_window_action *actions;
	size_t action_count;
	/** The part's state: where struct gz_window points to it, and its size. The window makes
	 * the states of all parts, zeroed, before any open, and frees each after its close. Set by
	 *  GZ_PART_STATE(). */
	size_t state_at, state_size;
	/** Fill the state from the options, once, before there is a window. Logs failures. */
	enum gz_result (*open)(struct gz_window *window);
	/** Make what lives in the OpenGL context (3.3 or later), which is new: at the start, and
	 *  after a loss. */
	enum gz_result (*gl_open)(struct gz_window *window);
	/** A scene is about to be shown: window->maker, with a renderer, and its settings. */
	void (*scene_shown)(struct gz_window *window);
	/** The scene is about to be freed: stop using it, on every thread. */
	void (*scene_leaving)(struct gz_window *window);
	/** Another time point is about to replace the data of the scene: stop using them, on every
	 *  thread. @return whether the part lets them go; if not, they stay */
	bool (*data_leaving)(struct gz_window *window);
	/** First in each turn of the loop: check threads and clocks, and ask for a frame by
	 *  window->cast_needed or window->present_needed. */
	void (*turn)(struct gz_window *window);
	/** See or replace the gaze of this turn before it is used. Only with a scene. */
	void (*gaze)(struct gz_window *window, struct gz_window_gaze *gaze);
	/** A button of the mouse (GLFW_MOUSE_BUTTON_LEFT, …) was pressed on the picture at
	 *  window->cursor. @return true to get the mouse until it is released; later parts are not
	 *  asked then. Only with a scene. */
	bool (*grab)(struct gz_window *window, int button, int modifiers);
	/** The mouse, which the part has grabbed, moved by this to window->cursor. */
	void (*drag)(struct gz_window *window, double right, double down);
	/** The left button was clicked on the picture at window->cursor, without a drag and without
	 *  a modifier, and nothing but the camera had grabbed it. Only with a scene. */
	void (*click)(struct gz_window *window);
	/** The wheel was turned over the picture, notches. Only with a scene. @return whether the
	 *  part took it; later parts are not asked then */
	bool (*wheel)(struct gz_window *window, double up);
	/** Whether what the part draws over the picture changes with this gaze. */
	bool (*follows)(struct gz_window *window, const struct gz_window_gaze *gaze);
	/** A picture has been cast; window->record describes it. */
	void (*frame_made)(struct gz_window *window);
	/** Draw by OpenGL over the picture, in a framebuffer of width times height px. Panels have
	 *  been laid out and are drawn afterwards; where they hide the picture it may be missing,
	 *  unless gz_window_reads_picture() says that it is read. */
	void (*paint)(struct gz_window *window, int width, int height);
	/** Lay out panels and marks by panels/widgets.h. Changes of window->settings are checked
	 *  afterwards. */
	void (*panels)(struct gz_window *window, const struct gz_window_gaze *gaze);
	/** Panels have been drawn, and the framebuffer of width times height px is about to be
	 *  swapped. */
	void (*drawn)(struct gz_window *window, int width, int height);
	/** The framebuffer has been swapped. */
	void (*presented)(struct gz_window *window);
	/** A key of GLFW was pressed. Only of the part that has the window to itself
	 *  (window->alone). @return whether the part takes the key */
	bool (*key)(struct gz_window *window, int key, int scancode, bool repeated);
	/** A button of the mouse was pressed at window->cursor. Only of the part that has the
	 *  window to itself. */
	void (*press)(struct gz_window *window, int button);
	/** Longest time until the next turn, s, if no event comes before; INFINITY: any. */
	double (*patience_s)(const struct gz_window *window);
	/** The OpenGL context is about to go: delete what lives in it. Correct after a failed
	 *  gl_open. */
	void (*gl_close)(struct gz_window *window);
	/** Free what the state holds. Correct without open, and after a failed one. With a
	 *  state_size only called if there is a state. */
	void (*close)(struct gz_window *window);
};

/** The slots actions and action_count for an array of actions. */
#define GZ_PART_ACTIONS(array) .actions = (array), .action_count = sizeof(array) / sizeof(array)[0]

/** The slots for a part whose state is window->@p name. */
#define GZ_PART_STATE(name)                           \
	.state_at = offsetof(struct gz_window, name), \
	.state_size = sizeof *((struct gz_window *)0)->name

/* clang-format off */
/** All parts, in the order in which they are asked: ROW(name) for gz_window_NAME_part. A new part is
 *  a file and a row here. */
#define GZ_WINDOW_PARTS(ROW) \
	ROW(menu)          /* menus; first, as all others lie below its bar */ \
	ROW(loading)       /* loads and holds scenes */ \
	ROW(keys)          /* lists keys */ \
	ROW(start)         /* the window without a scene */ \
	ROW(simulator)     /* starts a simulated viewer, and shows it the picture */ \
	ROW(effect)        /* shows what foveation does; before history: it begins with it */ \
	ROW(history)       /* undoes and redoes; before all that change settings */ \
	ROW(displays)      /* monitors, and which is the tracker's */ \
	ROW(gaze)          /* sources of the gaze */ \
	ROW(sections)      /* slices; under the captions, and before all that take the mouse */ \
	ROW(status)        /* the line on top, and the lower left corner */ \
	ROW(compare)       /* the standard picture beside the method's */ \
	ROW(refine)        /* full quality at rest */ \
	ROW(overlay)       /* the tint that shows the plan */ \
	ROW(trail)         /* the last second of the gaze */ \
	ROW(clip)          /* moves the faces of the clip box; before what takes all drags */ \
	ROW(clip_plane)    /* moves and tilts the clip plane; behind the clip box's small handles */ \
	ROW(light)         /* moves the light; before the camera, which takes all other drags */ \
	ROW(camera)        /* moves the camera */ \
	ROW(frame_times)   /* plots what frames cost */ \
	ROW(gaze_panel)    /* the panel of the gaze */ \
	ROW(latency)       /* from gaze to light on the display; V-sync */ \
	ROW(files)         /* opens and saves */ \
	ROW(print)         /* writes stipples and hatches for print */ \
	ROW(mesh_export)   /* writes the surfaces shown as a mesh */ \
	ROW(series)        /* asks which of several series is to be shown */ \
	ROW(notices)       /* shows messages */ \
	ROW(objects)       /* lists what is shown */ \
	ROW(illustration)  /* how illustrations are shaded */ \
	ROW(transfer)      /* edits the transfer function */ \
	ROW(time)          /* shows the time points of a series */ \
	ROW(replay)        /* shows a session again; behind all that change the gaze */ \
	ROW(surface)       /* surfaces without triangles while they change; behind replay */ \
	ROW(labels)        /* surfaces of labels with other settings */ \
	ROW(session)       /* records sessions; behind all that change the gaze */ \
	ROW(full_picture)  /* saves pictures of full quality */ \
	ROW(capture)       /* writes pictures and videos; behind all that paint */ \
	ROW(basics)        /* methods, settings, cursor; behind all whose panels Escape closes */ \
	ROW(unsaved)       /* asks before changes are lost, and quits; last to take Escape */ \
	ROW(experiment_start) /* asks who takes part, alone */ \
	ROW(experiment)    /* runs an experiment, alone */
/* clang-format on */

#define GZ_DECLARE_PART(name) extern const struct gz_window_part gz_window_##name##_part;
GZ_WINDOW_PARTS(GZ_DECLARE_PART)
#undef GZ_DECLARE_PART

/** The same, NULL-terminated. */
extern const struct gz_window_part *const gz_window_parts[];

/** Loop over all parts; @p part is declared as a pointer into gz_window_parts. */
#define GZ_FOR_EACH_PART(part) \
	for (const struct gz_window_part *const *part = gz_window_parts; *part; part++)

#endif
