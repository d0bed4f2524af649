/**
 * @file
 * gazeview without a window: renders a sequence of frames into files, or writes a volume.
 */
#ifndef GZ_VIEW_HEADLESS_HEADLESS_H
#define GZ_VIEW_HEADLESS_HEADLESS_H

#include "base/log.h"
#include "base/result.h"
#include "view/options/options.h"

/**
 * Render options->frames pictures, or all frames of options->replay, and print a line on stdout for
 * each.
 *
 * With a live gaze, frame k is rendered no earlier than k / fps seconds after the first. Any other
 * gaze is read at time k / fps, and frames follow as fast as possible.
 *
 * @param[out] out_signal  SIGINT or SIGTERM if one ended the sequence between two frames, else 0
 * @return GZ_OK also after a signal; otherwise the first error, logged
 */
enum gz_result gz_view_headless(const struct gz_view_options *options, const struct gz_log *log,
				int *out_signal);

/**
 * gazeview --write-volume: load or generate the volume of the scene that the options name and write
 * it. The ending chooses the format: bricks (.gzb) or NRRD (.nrrd). Meanwhile a volume larger than
 * a quarter of the machine's memory is kept in an unnamed file beside the new one.
 *
 * @retval GZ_ERR_UNSUPPORTED  another ending, or the volume is stored in bricks already; logged
 * @return otherwise the results of gz_scene_open(), gz_bricks_write() and gz_nrrd_write(); logged
 *         except GZ_ERR_CANCELLED, which a signal causes
 */
enum gz_result gz_view_write_volume(const struct gz_view_options *options,
				    const struct gz_log *log);

#endif
