/**
 * @file
 * From sample to fixation: validate, correct, combine, despike, classify, smooth. Pure steps over a
 * state: no I/O, no clock, no allocation; every timeout runs on sample time, so that replaying a
 * log gives the same messages bit for bit. The daemon runs it live; the viewer and the benchmark
 * run it over a log in process.
 */
#ifndef GZ_FILTER_PIPELINE_H
#define GZ_FILTER_PIPELINE_H

#include <stddef.h>

#include "base/option.h"
#include "base/result.h"
#include "filter/classify.h"
#include "filter/combine.h"
#include "filter/correct.h"
#include "filter/despike.h"
#include "filter/messages.h"
#include "filter/smooth.h"
#include "filter/validate.h"
#include "protocol/display.h"
#include "protocol/gaze.h"

/** Every setting of the pipeline; written into each log's header. */
struct gz_pipeline_params {
	struct gz_validate_params validate;
	struct gz_correct_params correct;
	struct gz_combine_params combine;
	struct gz_despike_params despike;
	struct gz_classify_params classify;
	struct gz_smooth_params smooth;
};

/** Table over struct gz_pipeline_params; keys are "pipeline.<name>". */
extern const struct gz_option gz_pipeline_options[];
extern const size_t gz_pipeline_option_count;

/** The table's presets. */
struct gz_pipeline_params gz_pipeline_default_params(void);

/**
 * Check what the table cannot say of a single setting: that the correction keeps two dimensions.
 *
 * @param[out] message  on failure: the setting, what is wrong and what is allowed, one line
 * @param message_size  bytes of @p message
 * @retval GZ_OK         the pipeline may run with them
 * @retval GZ_ERR_INVAL  it may not
 */
enum gz_result gz_pipeline_check_params(const struct gz_pipeline_params *params, char *message,
					size_t message_size);

/** Noise within fixations, as status tells it. */
struct gz_pipeline_noise {
	bool in_fixation; /**< whether last holds something */
	struct gz_point last;
	double mean_square_deg2; /**< of sample-to-sample steps */
	double count;            /**< of them, up to a limit: older ones fade */
};

/** The whole state of the pipeline; plain data, may be copied to try something out. */
struct gz_pipeline {
	struct gz_pipeline_params params;
	struct gz_display display;
	struct gz_validate_state validate;
	struct gz_combine_state combine;
	struct gz_despike_state despike;
	struct gz_classify_state classify;
	struct gz_smooth_state smooth;
	struct gz_messages_state messages;
	struct gz_pipeline_noise noise;
	int64_t host_ns;     /**< of the newest output; 0 before it */
	enum gz_event event; /**< of the newest output */
	struct gz_point point;
};

/** What one sample brought about. */
struct gz_pipeline_output {
	struct gz_gaze gaze;         /**< always filled; publish_ns is 0, for the sender to set */
	enum gz_rejection rejection; /**< NONE if the sample was good */
	size_t fixation_count;       /**< fixations[] to publish, in order */
	struct gz_fixation fixations[GZ_FIXATION_MESSAGES_MAX];
	size_t blink_count; /**< blinks[] to publish, in order */
	struct gz_blink blinks[GZ_BLINK_MESSAGES_MAX];
	size_t saccade_count; /**< 0 or 1 */
	struct gz_saccade saccades[1];
};

/**
 * Put the pipeline into its start state.
 *
 * @param params   in the ranges of the table, and passed gz_pipeline_check_params(); NULL for the
 *                 defaults
 * @param display  must be valid (gz_display_valid())
 */
void gz_pipeline_init(struct gz_pipeline *pipeline, const struct gz_pipeline_params *params,
		      const struct gz_display *display);

/**
 * Take one sample.
 *
 * @param[out] out  always filled; every number in it is finite, but for fields documented as NaN
 *                  where unmeasured, and its time is never before that of an earlier output
 *
 * A sample not newer than the last is rejected (GZ_REJECT_TIME) and leaves the state as it was; its
 * message says what was said last, with its time and confidence 0. While blinking or lost the point
 * holds its last place; before any good sample it is (0.5, 0.5), lost. Does not allocate. Threads:
 * one at a time per pipeline.
 */
void gz_pipeline_step(struct gz_pipeline *pipeline, const struct gz_sample *sample,
		      struct gz_pipeline_output *out);

/** Sample-to-sample RMS within fixations so far, degrees; NaN before there was one. */
double gz_pipeline_noise_deg(const struct gz_pipeline *pipeline);

#endif
