/**
 * @file
 * The pipeline's settings that a gaze log was recorded with.
 */
#ifndef GZ_FILTER_RECORDED_H
#define GZ_FILTER_RECORDED_H

#include "base/log.h"
#include "base/result.h"
#include "filter/pipeline.h"
#include "protocol/gaze_log.h"

/**
 * The settings in a log's header, over the defaults. One that this version does not have changes
 * nothing, with a warning.
 *
 * @param path  of the log, for messages
 * @param[out] out_params  passes gz_pipeline_check_params()
 * @retval GZ_ERR_FORMAT  a setting that the pipeline refuses; logged with the remedy
 */
enum gz_result gz_pipeline_recorded_params(const struct gz_gaze_log_header *header,
					   const char *path, const struct gz_log *log,
					   struct gz_pipeline_params *out_params);

#endif
