/**
 * @file
 * Shows fixation targets to check a tracker's calibration: one after the other on a grey
 * background, full screen.
 *
 * The target is a disc with a cross and a central dot, 0.6 and 0.2 degrees wide: the shape of seven
 * that kept fixation most stable (Thaler, Schuetz, Goodale and Gegenfurtner, "What is
 * the best fixation target? The effect of target shape on stability of fixational eye movements",
 * Vision Research 76, 2013). It appears three times as large and shrinks, which attracts the eye.
 *
 * Events are printed on standard output, one a line. Times are CLOCK_MONOTONIC, ns, taken when the
 * buffers were swapped and the GPU had finished:
 *
 *     screen WIDTH HEIGHT LEFT TOP SCALE  the monitor: its size and place on the desktop, px, and
 *                                       the desktop's scale on it; 0 where unknown
 *     shown INDEX COUNT X Y TIME        a target appeared; INDEX from 0; X, Y on the display
 *     hidden INDEX TIME                 the target is about to disappear
 *     finished TIME                     all targets were shown
 *     cancelled TIME                    Escape was pressed or the window was closed
 */
#ifndef GZ_VIEW_TARGET_TARGET_WINDOW_H
#define GZ_VIEW_TARGET_TARGET_WINDOW_H

#include "base/log.h"
#include "base/result.h"
#include "view/options/options.h"

/** Widths of the disc and the dot, degrees (Thaler et al. 2013, shape ABC). */
#define GZ_TARGET_DISC_DEG 0.6
#define GZ_TARGET_DOT_DEG  0.2

/**
 * Show the targets that @p options name.
 *
 * @retval GZ_OK               all targets were shown
 * @retval GZ_ERR_END          the user cancelled; printed on standard output
 * @retval GZ_ERR_NO_DEVICE    no display, or its context was lost; logged
 * @retval GZ_ERR_UNSUPPORTED  no OpenGL 3.3; logged
 * @return otherwise the results of gz_target_places(); logged
 */
enum gz_result gz_view_targets(const struct gz_view_options *options, const struct gz_log *log);

#endif
