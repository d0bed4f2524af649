/**
 * @file
 * MINC 2 files as volumes, in the process that calls: the decoder's.
 */
#ifndef GZ_RENDER_DECODE_MINC_LOAD_H
#define GZ_RENDER_DECODE_MINC_LOAD_H

#include "render/data/volume_import.h"

/**
 * Load a file. In a build without HDF5 it only says so.
 *
 * @param choice           not used
 * @param[out] out_volume  written on GZ_OK; the caller frees it with gz_volume_free()
 * @retval GZ_ERR_UNSUPPORTED  also: this build has no HDF5; logged with the remedy
 * @return otherwise as gz_minc_image_open() and gz_volume_import()
 */
enum gz_result gz_minc_load(const struct gz_volume_file *file, const char *choice,
			    struct gz_volume *out_volume);

#endif
