/**
 * @file
 * The part of the window that makes a video of the picture: F10. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_CAPTURE_H
#define GZ_VIEW_WINDOW_CAPTURE_H

#include "view/window/part.h"

/** The part. Behind all that paint over the picture. */
extern const struct gz_window_part gz_window_capture;

#endif
