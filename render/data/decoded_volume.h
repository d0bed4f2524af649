/**
 * @file
 * Volumes whose voxels a decoder process makes (render/decode/): what it says is checked here.
 */
#ifndef GZ_RENDER_DATA_DECODED_VOLUME_H
#define GZ_RENDER_DATA_DECODED_VOLUME_H

#include "render/data/volume_import.h"

/**
 * Load a file through a decoder process. The voxels are mapped where the decoder wrote them and are
 * not copied; they are in memory, or in a file in the scratch folder as gz_volume_allocate_in()
 * says.
 *
 * @param format  the name that the decoder has for it: "dicom"
 * @param choice  what to choose of the file; NULL: nothing
 * @param[out] out_volume  written on GZ_OK; the caller frees it with gz_volume_free()
 * @return as gz_decode_run(), and
 * @retval GZ_ERR_FORMAT  the decoder's volume breaks a promise of struct gz_volume; logged
 * @retval GZ_ERR_FULL    no room in the scratch folder; logged
 * @retval GZ_ERR_CHOICE  series were listed in the series_list of the file's loading; not logged
 */
enum gz_result gz_volume_decode(const struct gz_volume_file *file, const char *format,
				const char *choice, struct gz_volume *out_volume);

#endif
