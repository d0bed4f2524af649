/**
 * @file
 * The part of the window that knows the monitors: which is the tracker's, where the window is on
 * it, and what happens when one goes. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_DISPLAYS_H
#define GZ_VIEW_WINDOW_DISPLAYS_H

#include "view/gaze/tracker_display.h"
#include "view/window/part.h"

/** The part. */
extern const struct gz_window_part gz_window_display_part;

/** The monitors as last seen. */
const struct gz_monitor_list *gz_window_monitors(const struct gz_window *window);

/** Which of them is the tracker's, and why. */
struct gz_tracker_display gz_window_tracker_display(const struct gz_window *window);

/** The tracker's; NULL where there is none. */
const struct gz_monitor *gz_window_tracker_monitor(const struct gz_window *window);

/** GLFW's handle of the same. */
struct GLFWmonitor *gz_window_tracker_handle(const struct gz_window *window);

/** The one that the window is on; NULL where there is none. */
const struct gz_monitor *gz_window_own_monitor(const struct gz_window *window);

/** Where the window's content is, x y w h among all monitors. */
void gz_window_rect(const struct gz_window *window, int out_rect_px[4]);

/** Pixels that the window has to draw on, as of this turn; 0 while it is minimised. */
void gz_window_framebuffer(const struct gz_window *window, int *out_width, int *out_height);

/** The window as a part of the tracker's display; the whole where --gaze-fills-window says so. */
struct gz_window_share gz_window_share(const struct gz_window *window);

#endif
