/**
 * @file
 * The DICOM series that a path stands for, as a list to choose from.
 */
#ifndef GZ_RENDER_DECODE_DICOM_LIST_H
#define GZ_RENDER_DECODE_DICOM_LIST_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

#include "render/decode/decode.h"
#include "render/decode/dicom/dicom_series.h"

/** Open what texts are converted with. Call it before the process is confined: confine.h. */
void gz_dicom_prepare_texts(void);

/**
 * List series with the reasons why some cannot be shown, then a picture of the middle slice of each
 * other one. At most GZ_DECODE_SERIES_MAX, by patient, date and number of the series.
 *
 * @param file      as for gz_dicom_series_open()
 * @param listener  its functions are called on this thread
 * @param[out] out_series  NULL: list even a single series. Otherwise a single one is opened and not
 * listed: the caller closes it with gz_dicom_series_close()
 * @retval GZ_OK          there is one series, which is in @p out_series
 * @retval GZ_ERR_CHOICE  series were listed; not logged
 * @return else as gz_dicom_series_open(), or what the listener returned
 */
enum gz_result gz_dicom_list(const struct gz_volume_file *file,
			     const struct gz_decode_listener *listener,
			     struct gz_dicom_series **out_series);

#ifdef __cplusplus
}
#endif

#endif
