/**
 * @file
 * The settings with which a suite tests the pipeline: the presets, or others by options on the
 * command line.
 */
#ifndef GZ_TESTS_FILTER_TESTED_PARAMS_H
#define GZ_TESTS_FILTER_TESTED_PARAMS_H

#include "base/log.h"
#include "base/option.h"
#include "filter/pipeline.h"

/** Set by read_tested_params(). */
static struct gz_pipeline_params tested_params;

/** Take the presets and the options of the pipeline on the command line. @return false, having
 *  logged it, if an option is wrong */
static inline bool read_tested_params(int argc, char **argv)
{
	struct gz_log log;
	gz_log_init(&log, NULL, NULL, NULL);
	tested_params = gz_pipeline_default_params();
	struct gz_option_binding binding = { gz_pipeline_options, gz_pipeline_option_count,
					     &tested_params, NULL };
	return gz_options_read_arguments(&binding, 1, argc, argv, NULL, &log) == GZ_OK;
}

#endif
