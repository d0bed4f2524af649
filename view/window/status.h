/**
 * @file
 * The part of the window that tells, in a line on top, what the last frame was and where the gaze
 * comes from. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_STATUS_H
#define GZ_VIEW_WINDOW_STATUS_H

#include "view/window/part.h"

/** The part; its state is struct gz_window's line. */
extern const struct gz_window_part gz_window_status;

#endif
