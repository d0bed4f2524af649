/**
 * @file
 * Whether a path is DICOM, without reading more than a few bytes of it.
 */
#ifndef GZ_RENDER_DATA_DICOM_NAME_H
#define GZ_RENDER_DATA_DICOM_NAME_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Whether a path is a folder, or a file that is DICOM by its preamble (PS3.10, 7.1), or, without
 *  one, by its first three elements: of group 2 or 8, little-endian, one after the other; or that
 *  is named DICOMDIR, even if it is damaged. */
bool gz_dicom_is(const char *path);

#ifdef __cplusplus
}
#endif

#endif
