/**
 * @file
 * From sample to fixation: validate, correct, combine, despike, watch the lid, classify, smooth,
 * and the messages about fixations, blinks and saccades. All are pure steps over a state: no I/O,
 * no clock, no allocation. Every timeout runs on sample time, so a log that is replayed gives the
 * same messages bit for bit. The daemon runs the pipeline live; the viewer and the benchmark run it
 * over a log in their own process.
 */
#ifndef GZ_FILTER_PIPELINE_H
#define GZ_FILTER_PIPELINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "filter/classify.h"
#include "filter/combine.h"
#include "filter/despike.h"
#include "filter/landing.h"
#include "filter/lid.h"
#include "filter/smooth.h"
#include "filter/validate.h"
#include "protocol/display.h"
#include "protocol/gaze.h"
#include "protocol/gaze_log.h"

/** Every setting of the pipeline. The header of each log has their values. */
struct gz_pipeline_params {
	struct gz_validate_params validate;
	struct gz_correct_params correct;
	struct gz_combine_params combine;
	struct gz_despike_params despike;
	struct gz_lid_params lid;
	struct gz_classify_params classify;
	struct gz_smooth_params smooth;
};

/** Options over struct gz_pipeline_params; the keys are "pipeline.<name>". */
extern const struct gz_option gz_pipeline_options[];
extern const size_t gz_pipeline_option_count;

/** The presets of gz_pipeline_options. */
struct gz_pipeline_params gz_pipeline_default_params(void);

/**
 * Check what the option table cannot check for a single setting: that the correction keeps two
 * dimensions.
 *
 * @param[out] message  on failure: the setting, what is wrong and what is allowed, one line
 * @param message_size  bytes of @p message
 * @retval GZ_OK         the pipeline can run with these settings
 * @retval GZ_ERR_INVAL  it cannot
 */
enum gz_result gz_pipeline_check_params(const struct gz_pipeline_params *params, char *message,
					size_t message_size);

/**
 * The settings that a gaze log was recorded with as far as its header does not name them: the
 * presets. If it names settings but not the source of labels, it is older than the choice, and
 * labels come from the rules; likewise the guard against lids is off.
 */
struct gz_pipeline_params gz_pipeline_unnamed_params(const struct gz_gaze_log_header *header);

/** Key of the header's line that names the forests whose labels were shown while a log was
 *  recorded: no setting, because a program has only its own forests. */
#define GZ_PIPELINE_FORESTS_KEY "forests"

/** Bytes of a name of forests with its NUL: 16 hexadecimal digits. */
#define GZ_PIPELINE_FORESTS_SIZE 17

/** The name of this version's forests for immediate and certain labels. */
void gz_pipeline_name_forests(char out_name[GZ_PIPELINE_FORESTS_SIZE]);

/**
 * Whether a replay may label samples otherwise than when the log was recorded: its labels come from
 * forests, and not from those of this version. Then also warns.
 *
 * @param params  the settings of the replay
 * @param path    of the log, for messages
 */
bool gz_pipeline_other_forests(const struct gz_gaze_log_header *header,
			       const struct gz_pipeline_params *params, const char *path,
			       const struct gz_log *log);

/**
 * The settings that a gaze log was recorded with: those in its header, and
 * gz_pipeline_unnamed_params() for the rest. A setting that this version does not have is ignored,
 * with a warning; warns too if gz_pipeline_other_forests().
 *
 * @param path  of the log, for messages
 * @param[out] out_params  passes gz_pipeline_check_params(); written on success only
 * @retval GZ_ERR_FORMAT  a setting is refused; logged with the remedy
 */
enum gz_result gz_pipeline_recorded_params(const struct gz_gaze_log_header *header,
					   const char *path, const struct gz_log *log,
					   struct gz_pipeline_params *out_params);

/** Most fixation messages of one step: the end of one fixation and the onset of the next. */
#define GZ_FIXATION_MESSAGES_MAX 2

/** Most blink messages of one step: a gap in sample time is a whole blink. */
#define GZ_BLINK_MESSAGES_MAX 2

/** Shortest time between two messages about a lasting fixation, ns: 30 per second. */
#define GZ_FIXATION_INTERVAL_NS INT64_C(33333334)

/** Directions in which the outermost samples of a fixation are kept. The dispersion is at most 8 %
 *  (cos 22.5 degrees) below the greatest distance. */
#define GZ_FIXATION_DIRECTIONS 8

/** The running fixation. */
struct gz_messages_fixation {
	bool running;
	bool announced; /**< whether its onset was sent */
	uint64_t id;
	int64_t onset_ns, last_ns; /**< times of its first and newest sample */
	int64_t sent_ns;           /**< sample time of the newest message about it */
	uint64_t count;            /**< number of its samples */
	double sum[2];             /**< sum of their points */
	double confidence_sum;
	struct gz_point outermost[GZ_FIXATION_DIRECTIONS];
};

/** The running saccade. */
struct gz_messages_saccade {
	bool running;
	int64_t start_ns;
	struct gz_point start;
};

/** State of the messages. Zero-initialised is the start state. */
struct gz_messages_state {
	struct gz_messages_fixation fixation;
	struct gz_messages_saccade saccade;
	bool in_blink; /**< an onset was sent and the offset was not */
};

/** Noise in fixations, for the status. */
struct gz_pipeline_noise {
	bool in_fixation; /**< whether last is set */
	struct gz_point last;
	double mean_square_deg2; /**< mean square of the sample-to-sample steps */
	double count;            /**< number of steps, up to a limit: older ones lose weight */
};

/** The whole state of the pipeline. Plain data: a copy can be used to try something out. */
struct gz_pipeline {
	struct gz_pipeline_params params;
	struct gz_display display;
	struct gz_validate_state validate;
	struct gz_combine_state combine;
	struct gz_despike_state despike;
	struct gz_lid_state lid;
	struct gz_classify_state classify;
	struct gz_smooth_state smooth;
	struct gz_landing_state landing;
	struct gz_messages_state messages;
	struct gz_pipeline_noise noise;
	int64_t host_ns;       /**< of the newest output; 0 before it */
	enum gz_event event;   /**< of the newest output */
	struct gz_point point; /**< of the newest output */
};

/** What one sample gives. */
struct gz_pipeline_output {
	struct gz_gaze gaze;         /**< always filled; publish_ns is 0 and is set by the sender */
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
 * @param params   within the ranges of the options, and passes gz_pipeline_check_params(); NULL for
 *                 the defaults
 * @param display  passes gz_display_valid()
 */
void gz_pipeline_init(struct gz_pipeline *pipeline, const struct gz_pipeline_params *params,
		      const struct gz_display *display);

/**
 * Take one sample.
 *
 * A sample that is not newer than the last is rejected (GZ_REJECT_TIME) and does not change the
 * state; its message repeats the last one, with its time and with confidence 0. During a blink, and
 * while the gaze is lost, the point keeps its last place; before the first good sample it is
 * (0.5, 0.5) and the event is lost.
 *
 * Messages are made from the certain labels. The id of a fixation is the seq of its first sample.
 * Its first message comes when it has lasted fixation_min_ms, further ones at most 30 times per
 * second, and the last one, final, at its end; a shorter fixation is never announced. The onset of
 * a blink is the newest good sample before it, its offset the first good sample after it. A blink
 * that becomes too long ends, with confidence 0, when this is noticed. A saccade is announced at
 * its end, unless a blink cuts it off.
 *
 * @param[out] out  always filled. Every number is finite, except fields that are documented as NaN
 * if they were not measured. Its time is never before that of an earlier output
 *
 * Does not allocate. Threads: one at a time per pipeline.
 */
void gz_pipeline_step(struct gz_pipeline *pipeline, const struct gz_sample *sample,
		      struct gz_pipeline_output *out);

/**
 * Make events certain that wait for later samples, at the end of a recording, where none will come.
 * Call it until it returns false; then gz_pipeline_init() starts again. No other messages are made
 * of them, because a pipeline that goes on would make those later.
 *
 * @param[out] out  written on true: final_known, final_seq, final_span and final_event, and
 * host_ns, the time of the newest sample; the other fields are 0
 * @return whether there were any
 *
 * Does not allocate.
 */
bool gz_pipeline_flush(struct gz_pipeline *pipeline, struct gz_gaze *out);

/** RMS of the sample-to-sample distances in fixations so far, degrees; NaN before the first one. */
double gz_pipeline_noise_deg(const struct gz_pipeline *pipeline);

#endif
