/**
 * @file
 * The part of the window that shows the standard picture beside the foveated one, or what both
 * differ by. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_COMPARE_H
#define GZ_VIEW_WINDOW_COMPARE_H

#include "view/window/part.h"

/** The part. */
extern const struct gz_window_part gz_window_compare_part;

#endif
