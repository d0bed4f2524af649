/**
 * @file
 * What the part of the time points offers to others. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_TIME_H
#define GZ_VIEW_WINDOW_TIME_H

#include <stdbool.h>

struct gz_window;

/** Whether time points follow each other by themselves. */
bool gz_window_time_plays(const struct gz_window *window);

#endif
