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

/**
 * Load or make the volume of the scene that the options name and write it, by the name's ending as
 * bricks (.gzb) or NRRD (.nrrd). A volume of more than a quarter of the machine's memory is kept
 * meanwhile in a nameless file beside the new one.
 *
 * @retval GZ_ERR_UNSUPPORTED  another ending; logged
 * @return else what gz_scene_load(), gz_bricks_write() and gz_nrrd_write() return; logged but for
 * GZ_ERR_CANCELLED, which a signal gives
 */
enum gz_result gz_view_write_volume(const struct gz_view_options *options,
				    const struct gz_log *log);

#endif
