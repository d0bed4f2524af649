/**
 * @file
 * The part of the window that shows the panel of the gaze and does what is asked for in it.
 * Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_GAZE_SETTINGS_H
#define GZ_VIEW_WINDOW_GAZE_SETTINGS_H

#include "view/window/part.h"

/** Whether its panel is shown. */
bool gz_window_gaze_panel_shown(const struct gz_window *window);

/** The part. */
extern const struct gz_window_part gz_window_gaze_settings_part;

#endif
