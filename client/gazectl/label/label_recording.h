/**
 * @file
 * Labels of a recording that is read record by record: a destination for its header and samples.
 */
#ifndef GZ_CLIENT_GAZECTL_LABEL_LABEL_RECORDING_H
#define GZ_CLIENT_GAZECTL_LABEL_LABEL_RECORDING_H

#include "base/log.h"
#include "base/result.h"
#include "filter/offline.h"
#include "protocol/gaze_log.h"

/** What is kept of a recording. Zero-initialised but for name and log: nothing yet. */
struct gz_label_recording {
	const char *name; /**< of the file, for messages */
	const struct gz_log *log;
	struct gz_offline *offline; /**< NULL before the header; free with gz_offline_destroy() */
};

/**
 * Take the header: labels are found with the settings and the display with which the recording was
 * made, as far as it has them; otherwise with the presets and gz_display_default().
 *
 * @param user  a struct gz_label_recording
 * @retval GZ_ERR_FORMAT  a setting is refused; logged with the remedy
 * @retval GZ_ERR_NO_MEM  no memory; logged
 */
enum gz_result gz_label_take_header(void *user, const struct gz_gaze_log_header *header);

/**
 * Take a record. Only samples count.
 *
 * @param user  as gz_label_take_header(), which came before
 * @retval GZ_ERR_NO_MEM  no memory; logged
 */
enum gz_result gz_label_take_record(void *user, const struct gz_gaze_log_record *record);

/**
 * Label what was taken.
 *
 * @param[out] out_labels  free with gz_offline_labels_free(); written on success only
 * @retval GZ_ERR_FORMAT  there is no sample; logged
 * @retval GZ_ERR_NO_MEM  no memory; logged
 */
enum gz_result gz_label_finish(const struct gz_label_recording *recording,
			       struct gz_offline_labels *out_labels);

#endif
