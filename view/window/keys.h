/**
 * @file
 * The part of the window that lists the keys of all parts, finds them, and runs them. Internal to
 * view/.
 */
#ifndef GZ_VIEW_WINDOW_KEYS_H
#define GZ_VIEW_WINDOW_KEYS_H

#include "view/window/part.h"

/** The part. */
extern const struct gz_window_part gz_window_keys;

#endif
