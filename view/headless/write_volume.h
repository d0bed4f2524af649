/**
 * @file
 * gazeview --write-volume: the volume of a scene to a file, and no picture.
 */
#ifndef GZ_VIEW_HEADLESS_WRITE_VOLUME_H
#define GZ_VIEW_HEADLESS_WRITE_VOLUME_H

#include "base/log.h"
#include "base/result.h"
#include "view/options/options.h"

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
