/**
 * @file
 * gazeview in a window, by GLFW and OpenGL 3.3: docs/gazeview.md has its keys.
 */
#ifndef GZ_VIEW_WINDOW_H
#define GZ_VIEW_WINDOW_H

#include "base/log.h"
#include "base/result.h"
#include "view/options/options.h"
#include "view/panels/notices.h"

/**
 * Show the scene until the window is closed. Without a scene, or if it cannot be shown, the window
 * is empty and waits for another one. Draws only what has changed. Call on the main thread.
 *
 * If the display is lost, recordings are finished and the process ends with EXIT_FAILURE.
 *
 * @param notices  messages of @p log, to be shown in the window
 * @retval GZ_ERR_NO_DEVICE    no display; logged with the advice to use --headless
 * @retval GZ_ERR_UNSUPPORTED  no OpenGL 3.3; logged
 * @return else why the gaze or the window failed, or the scene, if none was ever shown; logged
 */
enum gz_result gz_view_window(const struct gz_view_options *options, const struct gz_log *log,
			      struct gz_notices *notices);

#endif
