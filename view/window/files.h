/**
 * @file
 * The part of the window that opens and saves: dialogs, files dropped on the window, what was shown
 * lately. Internal to view/; main thread only.
 */
#ifndef GZ_VIEW_WINDOW_FILES_H
#define GZ_VIEW_WINDOW_FILES_H

#include "view/window/part.h"

/** Open a file as if it had been dropped on the window: a scene, a volume or a picture is loaded,
 * of a raw volume the layout is asked for, a transfer function and a gaze log are taken. What
 * cannot be opened is logged. */
void gz_window_open_file(struct gz_window *window, const char *path);

/** Ask for the layout of the raw file that the program was started with, where neither the options
 *  nor its name and size tell it for certain. @return whether it has to be asked */
bool gz_window_ask_layout(struct gz_window *window);

/** The part. */
extern const struct gz_window_part gz_window_files;

#endif
