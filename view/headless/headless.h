/**
 * @file
 * gazeview without a window: a sequence of frames to files and lines.
 */
#ifndef GZ_VIEW_HEADLESS_HEADLESS_H
#define GZ_VIEW_HEADLESS_HEADLESS_H

#include "base/log.h"
#include "base/result.h"
#include "view/options/options.h"

/**
 * Render options->frames pictures, a line on stdout for each.
 *
 * A live gaze is followed in real time: frame k is made no earlier than k / fps seconds after the
 * first. Any other gaze runs as fast as frames are made, its time being k / fps.
 *
 * @param[out] out_signal  SIGINT or SIGTERM if that ended the sequence between two frames, else 0
 * @return GZ_OK also then; else what went wrong, logged
 */
enum gz_result gz_view_headless(const struct gz_view_options *options, const struct gz_log *log,
				int *out_signal);

#endif
