/**
 * @file
 * The pipeline as it was when a log was recorded.
 */
#ifndef GZ_CLIENT_GAZECTL_INSPECT_LOG_PIPELINE_H
#define GZ_CLIENT_GAZECTL_INSPECT_LOG_PIPELINE_H

#include "base/log.h"
#include "filter/pipeline.h"
#include "protocol/gaze_log.h"

/**
 * Put the pipeline into its start state with the settings and the display of a log's header;
 * presets stand in for what it does not say, gz_display_default() for a display.
 *
 * @param log  takes a warning for each setting that cannot be applied; may be NULL
 */
void gz_log_pipeline_init(struct gz_pipeline *pipeline, const struct gz_gaze_log_header *header,
			  const struct gz_log *log);

#endif
