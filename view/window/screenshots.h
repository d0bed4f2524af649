/**
 * @file
 * The part of the window that writes what is on the screen into PNG files: F12. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_SCREENSHOTS_H
#define GZ_VIEW_WINDOW_SCREENSHOTS_H

#include "view/window/part.h"

/** The part. Behind all that paint over the picture. */
extern const struct gz_window_part gz_window_screenshots;

#endif
