/**
 * @file
 * The part of the window that shows messages: for some seconds in a corner, errors until somebody
 * has seen to them, and all in a list. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_NOTICES_H
#define GZ_VIEW_WINDOW_NOTICES_H

#include "view/window/part.h"

/** The part. */
extern const struct gz_window_part gz_window_notices;

#endif
