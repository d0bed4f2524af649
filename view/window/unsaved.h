/**
 * @file
 * Leaving a scene that has changes: the window asks first. Internal to view/; main thread only.
 */
#ifndef GZ_VIEW_WINDOW_UNSAVED_H
#define GZ_VIEW_WINDOW_UNSAVED_H

#include <stdbool.h>

struct gz_window;

/** End the program, or ask first whether changes are to be saved. */
void gz_window_quit(struct gz_window *window);

/** Ask before @p path replaces a scene with changes; gz_window_open_file() follows if it may.
 * @return whether there is anything to ask about */
bool gz_window_ask_before_opening(struct gz_window *window, const char *path);

#endif
