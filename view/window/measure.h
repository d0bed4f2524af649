/**
 * @file
 * What the window itself costs a frame, apart from casting. Internal to view/.
 */
#ifndef GZ_VIEW_WINDOW_MEASURE_H
#define GZ_VIEW_WINDOW_MEASURE_H

#include "base/result.h"

struct gz_window;

/**
 * Show frames by turns in three ways until each was shown options->measure_window times: a bare
 * upload, quad and swap; the window as it is; and with settings and frame times open. A line on
 * standard output has the medians, from before the upload until the graphics device has finished.
 *
 * The pictures are as large as the window, and each differs from the one before.
 *
 * @retval GZ_ERR_NO_MEM     no room; logged
 * @retval GZ_ERR_NO_DEVICE  the window has no size
 */
enum gz_result gz_window_measure(struct gz_window *window);

#endif
