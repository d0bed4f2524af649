/**
 * @file
 * The part of the window that has the methods, the settings, the letters of a patient's sides, the
 * gaze cursor, full screen and the list of keys. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_BASICS_H
#define GZ_VIEW_WINDOW_BASICS_H

#include "view/window/part.h"

/** The part; its state is in struct gz_window itself. */
extern const struct gz_window_part gz_window_basics;

#endif
