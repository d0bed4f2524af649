/**
 * @file
 * The part of the window that shows the last second of the gaze: a line that fades, fixations as
 * discs that grow as they last. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_TRAIL_H
#define GZ_VIEW_WINDOW_TRAIL_H

#include "view/window/part.h"

/** The part. */
extern const struct gz_window_part gz_window_trail_part;

#endif
