#include "client/gazectl/label/label_recording.h"

#include "filter/pipeline.h"

#define GZ_LOG_MODULE "label"

static enum gz_result report_no_memory(const struct gz_label_recording *recording,
				       enum gz_result result)
{
	if (result == GZ_ERR_NO_MEM)
		gz_err(recording->log,
		       "%s is too long for this machine's memory; label a part of it",
		       recording->name);
	return result;
}

enum gz_result gz_label_take_header(void *user, const struct gz_gaze_log_header *header)
{
	struct gz_label_recording *recording = user;
	struct gz_pipeline_params params;
	const bool known = header->has_display && gz_display_valid(&header->display);
	/* Only its angles matter, and those of the default are the same at any size. */
	const struct gz_display display = known ? header->display : gz_display_default(1920, 1080);
	enum gz_result result =
		gz_pipeline_recorded_params(header, recording->name, recording->log, &params);
	if (result != GZ_OK)
		return result;
	return report_no_memory(recording,
				gz_offline_create(&params, &display, &recording->offline));
}

enum gz_result gz_label_take_record(void *user, const struct gz_gaze_log_record *record)
{
	struct gz_label_recording *recording = user;
	if (record->kind != GZ_GAZE_LOG_SAMPLE)
		return GZ_OK;
	return report_no_memory(recording, gz_offline_add(recording->offline, &record->sample));
}

enum gz_result gz_label_finish(const struct gz_label_recording *recording,
			       struct gz_offline_labels *out_labels)
{
	struct gz_offline_labels labels = { .count = 0 };
	enum gz_result result =
		recording->offline ? gz_offline_finish(recording->offline, &labels) : GZ_ERR_FORMAT;
	if (result == GZ_OK && labels.count > 0) {
		*out_labels = labels;
		return GZ_OK;
	}
	gz_offline_labels_free(&labels);
	if (result == GZ_ERR_NO_MEM)
		return report_no_memory(recording, result);
	gz_err(recording->log, "%s has no samples", recording->name);
	return GZ_ERR_FORMAT;
}
