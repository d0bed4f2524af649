/**
 * @file
 * The part of the window that starts and stops a simulated viewer, gazed --driver sim, and tells it
 * what the window shows. Internal to view/; main thread only.
 */
#ifndef GZ_VIEW_WINDOW_SIMULATOR_H
#define GZ_VIEW_WINDOW_SIMULATOR_H

#include <stdbool.h>

struct gz_window;

/** Whether the window has started a simulated viewer, whose gaze is on the window. */
bool gz_window_is_simulating(const struct gz_window *window);

/** Start the simulated viewer and follow its gaze, or stop it and follow the mouse. */
void gz_window_toggle_simulator(struct gz_window *window);

#endif
