/**
 * @file
 * The part of the window that tints the picture by its plan. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_OVERLAY_H
#define GZ_VIEW_WINDOW_OVERLAY_H

#include "view/window/part.h"

/** The part; its state is struct gz_window's overlay. */
extern const struct gz_window_part gz_window_overlay_part;

#endif
