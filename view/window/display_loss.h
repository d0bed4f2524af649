/**
 * @file
 * What becomes of a program whose X server ends or goes out of reach: Xlib ends the process then,
 * unless somebody leaves its handler for good. Whatever is begun here is left that way.
 */
#ifndef GZ_VIEW_WINDOW_DISPLAY_LOSS_H
#define GZ_VIEW_WINDOW_DISPLAY_LOSS_H

#include <stdbool.h>

#include "base/result.h"

/**
 * Run something that draws on a display; on the thread that calls Xlib, once at a time in a
 * process.
 *
 * @param run   called once, with @p user
 * @param[out] out_lost  the display was lost, and run was left in the middle: GLFW, OpenGL and
 *                       Xlib must not be called any more. Else it stays as it is
 * @return what @p run returns; GZ_ERR_NO_DEVICE where the display was lost; not logged
 *
 * Where another thread than this one meets the loss, the process ends with EXIT_FAILURE and a line
 * on stderr.
 */
enum gz_result gz_display_loss_guard(enum gz_result (*run)(void *user), void *user, bool *out_lost);

#endif
