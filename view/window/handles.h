/**
 * @file
 * Handles in the picture that cut the volume: where a place of the world is in the window, and how
 * handles look and are taken. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_HANDLES_H
#define GZ_VIEW_WINDOW_HANDLES_H

#include <stdbool.h>

#include "view/panels/widgets.h"

struct gz_window;

/** The room around the middle of a handle in which the mouse takes it, unscaled. */
#define GZ_HANDLE_REACH 11.0F

/** Whether there is a scene that can be cut, and no experiment has the window. */
bool gz_window_can_clip(const struct gz_window *window);

/** Whether handles can be shown: as gz_window_can_clip(), and the picture fills the window. */
bool gz_window_has_handles(const struct gz_window *window);

/** Where a place of the world is in the window. @return false: behind the eye, or no window */
bool gz_handle_place(const struct gz_window *window, const double world[3],
		     struct gz_place *out_place);

/** How far the mouse is from a place of the window, unscaled. */
double gz_handle_away(const struct gz_window *window, struct gz_place at);

/** Draw a handle. @param marked  the mouse is over it, or drags it */
void gz_handle_draw(struct gz_place at, struct gz_paint paint, bool marked);

/** Draw a handle that is a ring; radius and thickness unscaled. */
void gz_handle_draw_ring(struct gz_place at, float radius, struct gz_paint paint, float thickness);

/** Draw what belongs to handles, from place to place, fainter than they are. */
void gz_handle_draw_line(struct gz_place from, struct gz_place to, struct gz_paint paint);

/** Handles were shown or hidden. @param what  they belong to: "clip box" */
void gz_handles_toggled(struct gz_window *window, bool shown, const char *what);

#endif
