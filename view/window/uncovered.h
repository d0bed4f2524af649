/**
 * @file
 * The picture where panels do not hide it. Internal to view/; main thread only.
 */
#ifndef GZ_VIEW_WINDOW_UNCOVERED_H
#define GZ_VIEW_WINDOW_UNCOVERED_H

struct gz_window;

/** Draw the picture over a framebuffer of @p width times @p height px, except where the panels that
 *  have been laid out hide it: software OpenGL takes as long for a pixel of it as for one of a
 *  panel. */
void gz_window_draw_uncovered(const struct gz_window *window, int width, int height);

#endif
