/**
 * @file
 * What the part with the objects of a scene offers the search. Internal to view/; main thread only.
 */
#ifndef GZ_VIEW_WINDOW_OBJECTS_H
#define GZ_VIEW_WINDOW_OBJECTS_H

#include "view/window/window_state.h"

/** How many objects and regions the scene has; 0 without a scene. */
size_t gz_window_object_rows(struct gz_window *window);

/** Print one of them for a list, with what can be set of it. */
void gz_window_print_object_row(const struct gz_window *window, size_t row, char *text,
				size_t size);

/** Open the list at one of them. */
void gz_window_show_object_row(struct gz_window *window, size_t row);

#endif
