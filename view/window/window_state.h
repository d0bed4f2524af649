/**
 * @file
 * What the window's parts share: window.c runs the loop, gaze.c says where the gaze is, input.c
 * turns the mouse into changes and hands on keys, and parts (part.h) do the rest. Internal to
 * view/.
 */
#ifndef GZ_VIEW_WINDOW_STATE_H
#define GZ_VIEW_WINDOW_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/clock.h"
#include "base/log.h"
#include "render/opengl/gl_device.h"
#include "view/draw/quad.h"
#include "view/frame/frame.h"
#include "view/gaze/gaze_source.h"
#include "view/gaze/tracker_display.h"
#include "view/options/options.h"
#include "view/panels/notices.h"
#include "view/panels/settings_panel.h"
#include "view/settings/scene_keys.h"

struct GLFWmonitor;
struct GLFWwindow;

struct gz_overlay;
struct gz_window_compare;
struct gz_window_frame_times;
struct gz_window_part;

enum { GZ_WINDOW_LINE_SIZE = 256 };

/** From so many losses of the context in short order on, cpu casts the rays. */
enum { GZ_WINDOW_LOSSES_TO_CPU = 2 };

struct gz_window_sources;
struct gz_window_displays;
struct gz_window_corner;
struct gz_window_trail;
struct gz_window_timing;
struct gz_window_gaze_settings;

/** The window's OpenGL context as the gl backend takes it. */
struct gz_window_context {
	struct gz_gl_context base;
	struct GLFWwindow *glfw;
	bool display_lost; /**< see display_loss.h: nothing may be asked of it */
};

/** The window of gz_view_window(). */
struct gz_window {
	const struct gz_view_options *options;
	const struct gz_log *log;
	struct gz_notices *notices; /**< what the log has said */
	struct GLFWwindow *glfw;
	struct gz_window_context context;
	struct gz_frame_maker *maker;                  /**< NULL while there is no scene */
	struct gz_window_loading_state *loading;       /**< see loading.h */
	struct gz_window_keys_state *keys;             /**< see keys.h */
	struct gz_window_notices_state *notices_state; /**< see notices.h */
	struct gz_window_screenshots_state *screenshots;
	struct gz_window_capture_state *capture;
	struct gz_window_session_state *session;
	struct gz_window_replay_state *replay;
	struct gz_quad quad;

	struct gz_window_sources *sources; /**< of the parts of the same names; NULL before they
					      are open */
	struct gz_window_displays *displays;
	struct gz_window_corner *corner;
	struct gz_window_trail *trail;
	struct gz_window_timing *timing;
	struct gz_window_gaze_settings *gaze_settings;
	struct gz_gaze_source *source; /**< that is asked for; NULL for the mouse alone */
	struct gz_gaze_source *mouse;
	bool source_missing; /**< it could not be had when it was last read */
	bool gaze_frozen;    /**< the plan stays where it is while the gaze goes on */
	struct gz_viewer_link
		*link; /**< to the daemon's inlet; NULL where there is nothing to tell */

	struct gz_scene_settings settings; /**< as the user has changed them */
	struct gz_scene_settings shown;    /**< those of the last frame that could be made */
	bool any_shown;
	bool taken_back;                    /**< a frame with other settings could not be made */
	struct gz_view_scene_tables tables; /**< over settings, for the panel */
	/** The part that has the window to itself: others draw nothing over the picture and have no
	 *  keys, and the mouse does not move the camera. NULL: none. */
	const struct gz_window_part *alone;
	bool picture_hidden; /**< something else fills the window: nothing is cast */
	struct gz_window_experiment *experiment; /**< of part experiment */
	struct gz_settings_panel settings_panel;
	struct gz_window_transfer *transfer;       /**< of transfer.c */
	struct gz_overlay *overlay;                /**< of part overlay */
	struct gz_window_compare *compare;         /**< of part compare */
	struct gz_window_frame_times *frame_times; /**< of part frame times */
	int camera_drag;     /**< of part camera: what the drag of the mouse does */
	int panel_frames;    /**< still to be drawn, so that panels answer what has happened */
	float panels_top;    /**< lower edge of what lies on top, in this frame */
	float panels_bottom; /**< height of what lies at the bottom left, in this frame */

	int64_t key_ns; /**< when a key was pressed last, whatever it does */
	bool key_taken; /**< the last key pressed did something: the character that it types does
			 * not
			 */
	const struct gz_window_part *grabber; /**< has the mouse; NULL: none */
	int grab_button;
	bool cursor_known;
	bool cursor_inside; /**< the window's content is what the mouse is over */
	double cursor[2];   /**< screen coordinates of the window */
	int size_px[2];     /**< that a new window is made with */
	struct gz_window_files_state *files;
	int windowed_place[4]; /**< x y w h to return to from full screen */

	int losses;      /**< of the context, in short order */
	int64_t lost_ns; /**< the last one */

	bool cast_needed;    /**< camera, method or size has changed */
	bool frame_new;      /**< a picture has been cast in this turn */
	bool present_needed; /**< what lies over the picture has changed */

	/** The frame on the screen. */
	struct gz_frame_record record;
	struct gz_display shown_display;
	struct gz_point cross_drawn;
	int64_t swap_ns; /**< when it was handed over to be shown */
	char line[GZ_WINDOW_LINE_SIZE];
};

/** The gaze of one moment, on the picture. */
struct gz_window_gaze {
	struct gz_gaze_reading reading; /**< its point is on the picture */
	struct gz_display display;      /**< of the picture: it fills this one */
	const char *source;             /**< "daemon", "mouse", … */
	bool missing;                 /**< the daemon asked for is not there; the mouse stands in */
	const struct gz_focus *focus; /**< what the plan is made of, in place of what the attention
					 makes of the reading; NULL: nothing is */
	bool focus_new;               /**< a frame is to be made with it; only with focus */
	struct gz_gaze_reading asked; /**< of the source that is asked for, as it gave it */
	const struct gz_status *status; /**< of the daemon asked for; NULL: not told */
};

/** The reason of GLFW's last failure, for the one line that tells of it. */
const char *gz_window_glfw_reason(void);

/** Open the window, with OpenGL 4.3 where the gl backend may use it and the driver has it, else
 *  with 3.3, and make its context current. GZ_ERR_UNSUPPORTED: not even that; logged. */
enum gz_result gz_window_context_open(struct gz_window *window);

/** Make what draws on it: the picture, and the panel over it. GZ_ERR_UNSUPPORTED: the driver
 * refuses shaders; logged. */
enum gz_result gz_window_drawing_open(struct gz_window *window);

/** Delete that and the window, as far as they are there. */
void gz_window_drawing_close(struct gz_window *window);

/**
 * Make the window anew, where it was, after its context was lost: with the same backend or, where
 * that loses the next one soon, with cpu.
 *
 * @retval GZ_ERR_NO_DEVICE  the driver loses one after the other; logged
 * @return else what gz_window_context_open() and gz_frame_maker_start_cpu() return; logged
 */
enum gz_result gz_window_rebuild(struct gz_window *window);

/** Connect to the daemon that the gaze comes from, to tell it of the window and, where the gaze is
 * the pointer, of that; nothing where it is connected, or the gaze comes from no daemon.
 * @return what gz_viewer_link_open() returns; logged */
enum gz_result gz_window_report_open(struct gz_window *window);

/** Tell what has changed. Waits for nobody. */
void gz_window_report(struct gz_window *window);

/** Where the gaze is now, on a framebuffer of @p width times @p height px. */
void gz_window_gaze_now(struct gz_window *window, int width, int height,
			struct gz_window_gaze *out_gaze);

/** Seconds until the gaze must be looked at again, if no event comes before. */
double gz_window_gaze_patience_s(const struct gz_window *window);

/** Put the picture and all that lies over it on the screen: a framebuffer of @p width times @p
 * height px. */
void gz_window_present(struct gz_window *window, const struct gz_window_gaze *gaze, int width,
		       int height);

/** Listen to keys, buttons, cursor, wheel and size. Before gz_widgets_init(), which chains them. */
void gz_window_input_attach(struct gz_window *window);

/** Something that panels may have to answer has happened: they are drawn for a few frames. */
void gz_window_wake_panels(struct gz_window *window);

/** Into full screen on the monitor that the window is on, or back. */
void gz_window_toggle_fullscreen(struct gz_window *window);

/** Into full screen on @p monitor; NULL: back to a window. */
void gz_window_fill_monitor(struct gz_window *window, struct GLFWmonitor *monitor);

/** The monitor that holds the middle of the window, or the primary one; NULL if there is none. */
struct GLFWmonitor *gz_window_monitor(struct GLFWwindow *glfw);

#endif
