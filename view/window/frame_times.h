/**
 * @file
 * The part of the window that plots what frames cost, with the time to keep and the method's own
 * settings beside it. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_FRAME_TIMES_H
#define GZ_VIEW_WINDOW_FRAME_TIMES_H

#include "view/window/part.h"

/** The part. */
extern const struct gz_window_part gz_window_frame_times_part;

#endif
