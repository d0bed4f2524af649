/**
 * @file
 * gazeview in a window: GLFW and OpenGL 3.3. Gaze from a daemon or the mouse, keys for the methods,
 * a drag turns the camera.
 */
#ifndef GZ_VIEW_WINDOW_H
#define GZ_VIEW_WINDOW_H

#include "base/log.h"
#include "base/result.h"
#include "view/options/options.h"
#include "view/panels/notices.h"

/**
 * Show the scene until the window is closed; without one, or where it cannot be shown, the window
 * says so and waits for another. Draws only what has changed.
 *
 * @param notices  what the log says, for people to see
 * @retval GZ_ERR_NO_DEVICE    no display; logged with the way without one
 * @retval GZ_ERR_UNSUPPORTED  no OpenGL 3.3; logged
 * @return else what went wrong with the gaze or the window, or with the scene where none has been
 *         shown until the end; logged
 */
enum gz_result gz_view_window(const struct gz_view_options *options, const struct gz_log *log,
			      struct gz_notices *notices);

#endif
