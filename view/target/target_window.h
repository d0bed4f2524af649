/**
 * @file
 * gazeview as the shower of fixation targets, for a check of a tracker's calibration: one after
 * another on a grey ground, on the whole display.
 *
 * The target is a disc with a cross and a dot in its middle, 0.6 and 0.2 degrees wide: of seven
 * shapes the one that holds the eye stillest (Thaler, Schuetz, Goodale and Gegenfurtner, "What is
 * the best fixation target? The effect of target shape on stability of fixational eye movements",
 * Vision Research 76, 2013). It appears three times as large and shrinks, which draws the eye.
 *
 * What is seen when is told on standard output, a line each, numbers separated by blanks; times are
 * CLOCK_MONOTONIC, ns, taken when the buffers were swapped and the graphics processor had finished:
 *
 *     screen WIDTH HEIGHT               pixels of the display that the targets are on
 *     shown INDEX COUNT X Y TIME        a target appeared; INDEX from 0, X and Y on the display
 *     hidden INDEX TIME                 it is about to vanish
 *     finished TIME                     all were shown
 *     cancelled TIME                    the Escape key, or the window was closed
 */
#ifndef GZ_VIEW_TARGET_TARGET_WINDOW_H
#define GZ_VIEW_TARGET_TARGET_WINDOW_H

#include "base/log.h"
#include "base/result.h"
#include "view/options/options.h"

/** Widths of the disc and of its dot, degrees (Thaler et al. 2013, shape ABC). */
#define GZ_TARGET_DISC_DEG 0.6
#define GZ_TARGET_DOT_DEG  0.2

/**
 * Show the targets that @p options name.
 *
 * @retval GZ_OK               all were shown
 * @retval GZ_ERR_END          somebody cancelled; told on standard output
 * @retval GZ_ERR_NO_DEVICE    no display, or its context is lost; logged
 * @retval GZ_ERR_UNSUPPORTED  no OpenGL 3.3; logged
 * @return else what gz_target_places() returns; logged
 */
enum gz_result gz_view_targets(const struct gz_view_options *options, const struct gz_log *log);

#endif
