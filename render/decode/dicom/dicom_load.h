/**
 * @file
 * DICOM series as volumes, in the process that calls: the decoder's.
 */
#ifndef GZ_RENDER_DECODE_DICOM_LOAD_H
#define GZ_RENDER_DECODE_DICOM_LOAD_H

#include "render/data/volume_import.h"
#include "render/decode/decode.h"

/**
 * Load a series: a folder, one file of it, or a file with several frames. Slices are decoded by
 * several threads and turned to RAS+ like those of every other format.
 *
 * @param choice           UID of the series wanted; NULL: the file's, or the only one
 * @param[out] out_volume  written on GZ_OK; the caller frees it with gz_volume_free()
 * @return as gz_dicom_series_open() and gz_volume_import()
 */
enum gz_result gz_dicom_load(const struct gz_volume_file *file, const char *choice,
			     struct gz_volume *out_volume);

/**
 * Load the only series of a path, or list those that there are.
 *
 * @param out_volume  as above
 * @retval GZ_ERR_CHOICE  series were listed; not logged
 * @return else as gz_dicom_list() and gz_volume_import()
 */
enum gz_result gz_dicom_load_or_list(const struct gz_volume_file *file,
				     const struct gz_decode_listener *listener,
				     struct gz_volume *out_volume);

#endif
