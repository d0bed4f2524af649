/**
 * @file
 * The part of the window that knows the monitors: which one is the tracker's display, where the
 * window is on it, and what happens when a monitor is unplugged. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_DISPLAYS_H
#define GZ_VIEW_WINDOW_DISPLAYS_H

#include "view/gaze/tracker_display.h"

struct gz_window;
struct GLFWmonitor;

/** The monitors, as last seen. */
const struct gz_monitor_list *gz_window_monitors(const struct gz_window *window);

/** Which of them is the tracker's display, and why. */
struct gz_tracker_display gz_window_tracker_display(const struct gz_window *window);

/** The tracker's display; NULL: there is no monitor. */
const struct gz_monitor *gz_window_tracker_monitor(const struct gz_window *window);

/** GLFW's handle of the tracker's display; NULL: there is no monitor. */
struct GLFWmonitor *gz_window_tracker_handle(const struct gz_window *window);

/** The monitor that the window is on; NULL: there is none. */
const struct gz_monitor *gz_window_own_monitor(const struct gz_window *window);

/** The window's content, x y w h in the coordinates of all monitors. */
void gz_window_rect(const struct gz_window *window, int out_rect_px[4]);

/** Size of the framebuffer in this turn, px; 0 while the window is minimised. */
void gz_window_framebuffer(const struct gz_window *window, int *out_width, int *out_height);

/** Size of the picture, px: the framebuffer's, or a quarter of it beside slices. */
void gz_window_picture_size(const struct gz_window *window, int *out_width, int *out_height);

/** Where the picture lies in the window: x, y, width, height in screen coordinates. It touches the
 *  lower left corner. */
void gz_window_picture_place(const struct gz_window *window, double out_place[4]);

/** The mouse on the picture, 0 to 1; beyond beside it. @return false: the picture has no size */
bool gz_window_mouse_point(const struct gz_window *window, struct gz_point *out_point);

/** The window as a share of the tracker's display; all of it with --gaze-fills-window. */
struct gz_window_share gz_window_share(const struct gz_window *window);

#endif
