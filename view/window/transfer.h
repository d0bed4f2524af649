/**
 * @file
 * The part of the window that edits the transfer function. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_TRANSFER_H
#define GZ_VIEW_WINDOW_TRANSFER_H

#include <stdbool.h>

#include "base/result.h"

struct gz_window;

/** Tell the part that the file named in window->settings has the present transfer function. */
void gz_window_transfer_saved(struct gz_window *window);

/** How many steps of the transfer function can be undone. */
int gz_window_transfer_steps(const struct gz_window *window);

/** Undo a step of the transfer function, or redo one. @return what the step does, static text; NULL
 * if there is none */
const char *gz_window_transfer_step(struct gz_window *window, bool again);

/** Whether the transfer function differs from the one that was opened or saved last. */
bool gz_window_transfer_changed(const struct gz_window *window);

/** Replace the transfer function by that of a file, which the settings name then. One step of undo.
 *  @return what gz_transfer_load() returns; GZ_ERR_INVAL: no scene is shown. Logged */
enum gz_result gz_window_transfer_load(struct gz_window *window, const char *file);

#endif
