/**
 * @file
 * The picture that is refined at rest. Internal to view/; main thread only.
 */
#ifndef GZ_VIEW_WINDOW_REFINE_H
#define GZ_VIEW_WINDOW_REFINE_H

#include <stdbool.h>

struct gz_window;

/** Whether the refined picture is on the screen: each pixel has its ray. */
bool gz_window_is_refined(const struct gz_window *window);

#endif
