/**
 * @file
 * The part of the window that shows slices beside the picture, a quarter of the window each.
 * Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_SECTIONS_H
#define GZ_VIEW_WINDOW_SECTIONS_H

#include <stdbool.h>

#include "protocol/display.h"
#include "view/panels/widgets.h"

struct gz_window;

/** Whether slices are shown: view.layout asks for them, and the scene's volume has them. */
bool gz_window_has_sections(const struct gz_window *window);

/** Whether slices are shown and have a point of the picture, 0 to 1 and beyond. */
bool gz_window_sections_lie_at(const struct gz_window *window, struct gz_point point);

/** Where a point of the picture, 0 to 1, lies in the window. */
struct gz_place gz_window_place_of(const struct gz_window *window, struct gz_point point);

#endif
