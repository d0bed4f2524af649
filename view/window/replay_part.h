/**
 * @file
 * The part of the window that shows a session again: --replay. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_REPLAY_PART_H
#define GZ_VIEW_WINDOW_REPLAY_PART_H

#include "view/window/part.h"

/** The part. Behind all that change the gaze. */
extern const struct gz_window_part gz_window_replay;

#endif
