/**
 * @file
 * What the part that undoes and redoes tells the others: what the scene's file has, and whether the
 * scene differs from it. Internal to view/; main thread only.
 */
#ifndef GZ_VIEW_WINDOW_HISTORY_H
#define GZ_VIEW_WINDOW_HISTORY_H

#include <stdbool.h>

#include "base/option.h"

struct gz_window;

/** Whether the scene has changes that are lost without saving: of any setting but the camera and
 *  section "view", or of the transfer function. */
bool gz_window_scene_changed(const struct gz_window *window);

/** The tables of window->tables, bound to the settings as the scene was opened or saved last. */
const struct gz_option_binding *gz_window_given_settings(const struct gz_window *window);

/** The scene has been saved as it is. */
void gz_window_scene_saved(struct gz_window *window);

#endif
