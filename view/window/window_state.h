/**
 * @file
 * What the files of the window share: its state, and what window.c, context.c, input.c and some
 * parts offer the others. Internal to view/; main thread only.
 */
#ifndef GZ_VIEW_WINDOW_STATE_H
#define GZ_VIEW_WINDOW_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/clock.h"
#include "base/log.h"
#include "render/opengl/gl_device.h"
#include "view/draw/quad.h"
#include "view/files/recent.h"
#include "view/frame/frame.h"
#include "view/gaze/gaze_source.h"
#include "view/gaze/tracker_display.h"
#include "view/options/options.h"
#include "view/panels/notices.h"
#include "view/panels/settings_panel.h"
#include "view/settings/scene_keys.h"
#include "view/window/part.h"

struct GLFWmonitor;
struct GLFWwindow;

enum { GZ_WINDOW_LINE_SIZE = 256 };

/** Losses of the context in quick succession from which cpu casts the rays. */
enum { GZ_WINDOW_LOSSES_TO_CPU = 2 };

/** The window's OpenGL context, as the gl backend uses it. */
struct gz_window_context {
	struct gz_gl_context base;
	struct GLFWwindow *glfw;
	bool display_lost; /**< it must not be used any more: glfw.h */
};

/** A key that ran nothing. */
struct gz_window_idle_key {
	int key; /**< of GLFW */
	char letter;
	int modifiers;
	const struct gz_window_action *other; /**< runs by it at other times; NULL: none */
	bool noted;                           /**< there is one, and it has not been told */
};

/** The window of gz_view_window(). */
struct gz_window {
	const struct gz_view_options *options;
	const struct gz_log *log;
	struct gz_notices *notices; /**< what the log has said */
	struct GLFWwindow *glfw;
	struct gz_window_context context;
	struct gz_frame_maker *maker; /**< of the scene shown; NULL: there is none */
	struct gz_quad quad;

	/* States of the parts: struct gz_window_part's state_size. */
	struct gz_window_capture *capture;
	struct gz_window_clip *clip;
	struct gz_window_clip_plane *clip_plane;
	struct gz_window_compare *compare;
	struct gz_window_displays *displays;
	struct gz_window_effect *effect;
	struct gz_window_files *files;
	struct gz_window_frame_times *frame_times;
	struct gz_window_full_picture *full_picture;
	struct gz_window_gaze_panel *gaze_panel;
	struct gz_window_history *history;
	struct gz_window_surface *surface;
	struct gz_window_illustration *illustration;
	struct gz_window_keys *keys;
	struct gz_window_latency *latency;
	struct gz_window_loading *loading;
	struct gz_window_menu_bar *menu;
	struct gz_window_mesh_export *mesh_export;
	struct gz_window_labels *labels;
	struct gz_window_notices *notices_state;
	struct gz_window_objects *objects;
	struct gz_overlay *overlay;
	struct gz_window_print *print;
	struct gz_window_refine *refine;
	struct gz_window_replay *replay;
	struct gz_window_series *series;
	struct gz_window_sections *sections;
	struct gz_window_session *session;
	struct gz_window_sources *sources;
	struct gz_window_simulator *simulator;
	struct gz_window_start *start;
	struct gz_window_status *status;
	struct gz_window_time *time;
	struct gz_window_trail *trail;
	struct gz_window_transfer *transfer;
	struct gz_window_unsaved *unsaved;
	struct gz_window_experiment_start *experiment_start;
	/** Of part experiment, which makes it itself; NULL: there is no experiment. */
	struct gz_window_experiment *experiment;

	struct gz_gaze_source *source; /**< the one asked for; NULL: the mouse alone */
	struct gz_gaze_source *mouse;
	bool source_missing;         /**< it gave no gaze when it was last read */
	bool gaze_frozen;            /**< the plan stays while the gaze goes on */
	struct gz_viewer_link *link; /**< to the daemon's inlet; NULL: none to be told */
	int64_t motion_ns; /**< when something moved last that the eye may have followed */

	struct gz_scene_settings settings; /**< as the user has changed them */
	struct gz_scene_settings made;     /**< those of the last frame; valid if any_shown */
	/** Those to go back to if a frame cannot be made: made, but with triangles, and the
	 * isovalue is the last one that had triangles. */
	struct gz_scene_settings shown;
	bool without_triangles; /**< of part isovalue: rays find the surface in the voxels */
	bool any_shown;         /**< there was such a frame of this scene */
	bool taken_back;        /**< a frame with other settings could not be made */
	struct gz_view_scene_tables tables; /**< option tables bound to settings */
	/** The part that has the window to itself: no other part draws over the picture or has
	 * keys, and the mouse does not move the camera. NULL: none. */
	const struct gz_window_part *alone;
	bool picture_hidden;        /**< nothing is cast, as something else fills the window */
	bool settings_open;         /**< the settings panel is open */
	const char *setting_marked; /**< key of the setting that was searched for; NULL: none */
	bool setting_reveal;        /**< it is scrolled to in the next frame */
	int panel_frames;           /**< frames still to be drawn so that panels answer input */
	float panels_top;           /**< lower edge of the captions at the top, in this frame */
	float panels_bottom;        /**< height of the caption at the bottom left, in this frame */

	int64_t key_ns; /**< when the last key was pressed */
	bool key_taken; /**< that key did something: its character is ignored */
	struct gz_window_idle_key idle_key;
	const struct gz_window_part *grabber; /**< has the mouse; NULL: none */
	int grab_button;
	double grab_moved; /**< way of the mouse since then, screen coordinates */
	int camera_drag;   /**< of part camera: what dragging does */
	bool cursor_known;
	bool cursor_inside;    /**< the mouse is over the window's content */
	bool cursor_held;      /**< the mouse has moved, and its gaze has not followed yet */
	double cursor[2];      /**< screen coordinates of the window */
	int size_px[2];        /**< size of a new window */
	int windowed_place[4]; /**< x y w h to return to from full screen */

	int losses;      /**< of the context, in quick succession */
	int64_t lost_ns; /**< the last one */

	bool cast_needed;    /**< camera, method or size has changed */
	bool frame_new;      /**< a picture has been cast in this turn */
	bool present_needed; /**< what lies over the picture has changed */

	/* The frame on the screen. */
	struct gz_frame_record record;
	struct gz_display shown_display;
	struct gz_point cross_drawn;
	int64_t swap_ns; /**< when it was swapped */
};

/** The gaze of one turn, on the picture. */
struct gz_window_gaze {
	struct gz_gaze_reading reading; /**< its point is on the picture */
	struct gz_display display;      /**< geometry of the picture */
	const char *source;             /**< "daemon", "mouse", …; NULL: no scene is shown */
	bool missing; /**< the source asked for gives no gaze; the mouse stands in */
	/** Focus of the plan, in place of what the attention makes of the reading; NULL: none. */
	const struct gz_focus *focus;
	bool focus_new;                 /**< make a frame with the focus */
	struct gz_gaze_reading asked;   /**< as the source asked for gave it */
	const struct gz_status *status; /**< of the daemon asked for; NULL: not known */
};

/* ---- window.c ---- */

/** Draw the picture and all that lies over it, on a framebuffer of @p width times @p height px, and
 *  swap. */
void gz_window_present(struct gz_window *window, const struct gz_window_gaze *gaze, int width,
		       int height);

/** Check settings that have changed since @p before, load what they name, and show them; if they
 *  contradict each other, they become those of @p before again. */
void gz_window_take_changes(struct gz_window *window, const struct gz_scene_settings *before);

/* ---- context.c ---- */

/** Open the window and make its context current: OpenGL 4.3 if the gl backend may use it and the
 *  driver has it, else 3.3. GZ_ERR_UNSUPPORTED: not even that; logged. */
enum gz_result gz_window_context_open(struct gz_window *window);

/** Make what is drawn with: the picture, panels, and what parts need. GZ_ERR_UNSUPPORTED: the
 * driver refuses shaders; logged. */
enum gz_result gz_window_drawing_open(struct gz_window *window);

/** Delete that and the window, if they exist. */
void gz_window_drawing_close(struct gz_window *window);

/**
 * Replace the window after its context was lost: at the same place, with the same backend or, if
 * that soon loses the next context too, with cpu.
 *
 * @retval GZ_ERR_NO_DEVICE  the driver loses one context after the other; logged
 * @return else what gz_window_context_open() and gz_frame_maker_start_cpu() return; logged
 */
enum gz_result gz_window_rebuild(struct gz_window *window);

/** Read the framebuffer before it is swapped. Waits for drawing to finish. @param[in,out] image
 *  resized @return what gz_image_resize() returns */
enum gz_result gz_window_read_back(int width, int height, struct gz_image *image);

/**
 * The picture on the screen without what lies over it, scaled to fit into @p width times @p height
 * px. What lies over it must be drawn again before the next swap.
 *
 * @param[in,out] image    resized
 * @retval GZ_ERR_INVAL    the window has no size
 * @return otherwise what gz_image_resize() returns
 */
enum gz_result gz_window_shrink_shown(struct gz_window *window, int width, int height,
				      struct gz_image *image);

/** Go into full screen on the monitor that the window is on, or back. */
void gz_window_toggle_fullscreen(struct gz_window *window);

/** Go into full screen on @p monitor; NULL: back to a window. */
void gz_window_fill_monitor(struct gz_window *window, struct GLFWmonitor *monitor);

/* ---- input.c ---- */

/** Set callbacks for keys, buttons, cursor, wheel and size. Before gz_widgets_init(), which chains
 *  them. */
void gz_window_input_attach(struct gz_window *window);

/** Let the mouse's gaze follow a mouse that panels had when it moved and have no longer. Panels
 * only know while they draw whether they have it: each turn of the loop asks again. */
void gz_window_follow_cursor(struct gz_window *window);

/** Draw panels for a few frames: something has happened that they may have to answer. */
void gz_window_wake_panels(struct gz_window *window);

/** Ask all parts to stop using the data of the scene, which are about to change. @return whether
 * all let them go; if not, they stay */
bool gz_window_let_data_go(struct gz_window *window);

/* ---- basics.c ---- */

/** Rows of the settings panel: the options of window->settings, with those grey that have no
 * effect. */
struct gz_settings_panel gz_window_settings_rows(const struct gz_window *window);

/** Open the settings panel at a setting, which is marked. @param key  static text */
void gz_window_show_setting(struct gz_window *window, const char *key);

/* ---- measure.c ---- */

/**
 * Measure what the window itself costs a frame, without casting. Shows frames in three ways in
 * turn, each options->measure_window times: a bare upload, quad and swap; the window as it is; the
 * window with settings and frame times open. Prints the medians on stdout, from before the upload
 * until the graphics device has finished. Pictures have the window's size, and each differs from
 * the one before.
 *
 * @retval GZ_ERR_NO_MEM     no memory; logged
 * @retval GZ_ERR_NO_DEVICE  the window has no size
 */
enum gz_result gz_window_measure(struct gz_window *window);

/* ---- files.c ---- */

/** Ask for the layout of the raw file that the program was started with, if neither the options nor
 *  its name and size tell it for certain. @return whether it is asked for */
bool gz_window_ask_layout(struct gz_window *window);

/** Show a file as if it had been dropped on the window; nothing is asked. */
void gz_window_open_file(struct gz_window *window, const char *path);

/** Open the dialog that asks what to open. */
void gz_window_ask_for_file(struct gz_window *window);

/** The recent files. */
const struct gz_recent *gz_window_recent(const struct gz_window *window);

/** Save the scene, or ask for its name. */
void gz_window_save_scene(struct gz_window *window);

/** Replace what options of the command line set for this run only, and nobody has changed since, by
 * what the scene's file has: for settings that are about to be saved. */
void gz_window_drop_run_settings(const struct gz_window *window, struct gz_view_settings *view);

/** Whether the name of the scene is being asked for. */
bool gz_window_is_saving(const struct gz_window *window);

/* ---- keys.c ---- */

/** Show or hide the list of keys. */
void gz_window_toggle_keys(struct gz_window *window);

/** Whether the search is open and its field has no keyboard yet: keys are no actions. */
bool gz_window_is_search_starting(const struct gz_window *window);

/** Take a character that was typed before the search was drawn. */
void gz_window_type_into_search(struct gz_window *window, unsigned codepoint);

/** Run an action, if it applies. */
void gz_window_run_action(struct gz_window *window, const struct gz_window_action *action);

/** Say that window->idle_key, if one is noted, does nothing and where keys are listed; not again
 * while that is still shown. */
void gz_window_tell_idle_key(struct gz_window *window);

/** Print the key of an action, such as "Ctrl+Shift+S"; nothing if it has none. */
void gz_window_print_key(const struct gz_window_action *action, char *text, size_t size);

/* ---- menu.c ---- */

/** Open the menu of the picture at the mouse. */
void gz_window_ask_for_menu(struct gz_window *window);

/* ---- gaze_panel.c ---- */

/** Whether the panel of the gaze is open. */
bool gz_window_gaze_panel_open(const struct gz_window *window);

#endif
