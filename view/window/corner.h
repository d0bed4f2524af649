/**
 * @file
 * The part of the window that tells, in its lower left corner, where the gaze comes from and how
 * well: amber where something is to be seen to, red where there is no gaze, the reason in words.
 * Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_CORNER_H
#define GZ_VIEW_WINDOW_CORNER_H

#include "view/window/part.h"

/** The part. */
extern const struct gz_window_part gz_window_corner_part;

#endif
