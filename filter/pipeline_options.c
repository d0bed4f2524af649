/* The settings of the pipeline: presets and their sources, and the settings of a recording. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "filter/classifier/forest.h"
#include "filter/pipeline.h"

#define GZ_LOG_MODULE "pipeline"

#define VALIDATE(field) offsetof(struct gz_pipeline_params, validate.field)
#define CORRECT(field)  offsetof(struct gz_pipeline_params, correct.field)
#define COMBINE(field)  offsetof(struct gz_pipeline_params, combine.field)
#define DESPIKE(field)  offsetof(struct gz_pipeline_params, despike.field)
#define LID(field)      offsetof(struct gz_pipeline_params, lid.field)
#define CLASSIFY(field) offsetof(struct gz_pipeline_params, classify.field)
#define SMOOTH(field)   offsetof(struct gz_pipeline_params, smooth.field)

static const char *const eye_names[] = { "both", "left", "right", NULL };
static const char *const source_names[] = { "rules", "learned", NULL };

/* Sources of the presets, if the help does not give them:
 *
 * max_velocity_deg_s  eyes turn at up to 900 degrees per second (Bauer 2018, section 2.2)
 * lid_change          three times what a pupil can change by itself (lid.h)
 * peak_factor         Engbert and Kliegl 2003 take 6 standard deviations of each axis, which are 5
 *                     medians of the speed
 * onset_factor        less than half of it: Nyström and Holmqvist 2010 take 3 against 6 standard
 *                     deviations
 * blink_max_ms        the longest blink of Stern, Walrath and Goldstein 1984, 400 ms, and a margin
 * window_ms           the shortest fixation of Bauer 2018, section 2.2
 * end_ms              half the window over which speed is measured, less a sample at 500 Hz
 * despike_delay_ms    a sample at 250 Hz whose times are rounded to milliseconds
 * smooth_window_ms, smooth_start_ms,
 * smooth_drift_...,
 * smooth_pass_deg     chosen by bench/probes/gaze_noise.c: least noise in fixations of all sets
 *                     without more lag in pursuits than a mean of 100 ms has, and with at most one
 *                     sample of lag at the onset of saccades
 * fixation_...,
 * pursuit_...         chosen by bench/probes/gaze_filter_fit.c, on a plateau
 * all others          chosen on recordings that two people labelled (Andersson et al. 2017) and on
 *                     simulated ones; bench/probes/gaze_filter.c prints what they achieve
 */
const struct gz_option gz_pipeline_options[] = {
	{ "pipeline.margin", GZ_OPTION_DOUBLE, VALIDATE(margin), 0, 10, .preset = "0.25",
	  .help = "how far outside the display a point may be, display sides" },
	{ "pipeline.max_velocity_deg_s", GZ_OPTION_DOUBLE, VALIDATE(max_velocity_deg_s), 100,
	  100000, .preset = "1000", .help = "greatest speed of an eye, degrees per second" },
	{ "pipeline.jump_deg", GZ_OPTION_DOUBLE, VALIDATE(jump_deg), 0, 180, .preset = "2",
	  .help = "a step up to this size is never too fast, degrees" },
	{ "pipeline.max_disparity_deg", GZ_OPTION_DOUBLE, VALIDATE(max_disparity_deg), 0.1, 180,
	  .preset = "5",
	  .help = "greatest angle between the eyes' points beyond their usual one, degrees" },
	{ "pipeline.min_confidence", GZ_OPTION_DOUBLE, VALIDATE(min_confidence), 0, 1,
	  .preset = "0.6", .help = "least confidence of an eye that is used" },
	{ "pipeline.eyes", GZ_OPTION_CHOICE, VALIDATE(eyes), .choices = eye_names, .preset = "both",
	  .help = "which eyes are used, if the tracker measures each of them" },
	{ "pipeline.offset_ms", GZ_OPTION_DOUBLE, COMBINE(offset_ms), 1, 100000, .preset = "100",
	  .help = "time constant for learning the eyes' offset from each other, ms" },
	{ "pipeline.noise_ms", GZ_OPTION_DOUBLE, COMBINE(noise_ms), 1, 100000, .preset = "2000",
	  .help = "time constant for learning each eye's noise, ms" },
	{ "pipeline.despike_delay_ms", GZ_OPTION_DOUBLE, DESPIKE(max_delay_ms), 0, 100,
	  .preset = "5",
	  .help = "longest delay of a sample that may be a spike, ms; 0 switches this off" },
	{ "pipeline.despike_deg", GZ_OPTION_DOUBLE, DESPIKE(threshold_deg), 0, 180, .preset = "0.4",
	  .help = "smaller departures are not spikes, degrees" },
	{ "pipeline.despike_factor", GZ_OPTION_DOUBLE, DESPIKE(noise_factor), 0, 1000,
	  .preset = "8", .help = "nor are departures below this multiple of the usual step" },
	{ "pipeline.lid_change", GZ_OPTION_DOUBLE, LID(change), 0, 1, .preset = "0.12",
	  .help = "change of the pupil within 24 ms that only a lid makes, of its usual size; 0 "
		  "switches this off" },
	{ "pipeline.final_delay_ms", GZ_OPTION_DOUBLE, CLASSIFY(final_delay_ms), 0, 100,
	  .preset = "10", .help = "greatest delay of the certain label, ms" },
	{ "pipeline.velocity_window_ms", GZ_OPTION_DOUBLE, CLASSIFY(velocity_window_ms), 1, 100,
	  .preset = "10", .help = "width of the window for measuring speed, ms" },
	{ "pipeline.quick_window_ms", GZ_OPTION_DOUBLE, CLASSIFY(quick_window_ms), 1, 100,
	  .preset = "8", .help = "width of the trailing window for the immediate label, ms" },
	{ "pipeline.noise_memory_s", GZ_OPTION_DOUBLE, CLASSIFY(noise_memory_s), 0.01, 1000,
	  .preset = "2", .help = "time constant of the noise estimate, s" },
	{ "pipeline.peak_factor", GZ_OPTION_DOUBLE, CLASSIFY(peak_factor), 0, 100, .preset = "5",
	  .help = "factor of the median speed in the peak threshold of a saccade" },
	{ "pipeline.onset_factor", GZ_OPTION_DOUBLE, CLASSIFY(onset_factor), 0, 100, .preset = "2",
	  .help = "factor of the median speed in the onset and end threshold" },
	{ "pipeline.peak_base_deg_s", GZ_OPTION_DOUBLE, CLASSIFY(peak_base_deg_s), 1, 1000,
	  .preset = "20", .help = "peak threshold of a saccade without noise, degrees per second" },
	{ "pipeline.onset_base_deg_s", GZ_OPTION_DOUBLE, CLASSIFY(onset_base_deg_s), 1, 1000,
	  .preset = "10",
	  .help = "onset and end threshold of a saccade without noise, degrees per second" },
	{ "pipeline.end_fraction", GZ_OPTION_DOUBLE, CLASSIFY(end_fraction), 0, 1, .preset = "0.05",
	  .help = "a saccade ends below this fraction of its peak velocity, along its direction" },
	{ "pipeline.end_ms", GZ_OPTION_DOUBLE, CLASSIFY(end_ms), 0, 100, .preset = "4",
	  .help = "delay of the end after the speed falls below that, ms" },
	{ "pipeline.turn_fraction", GZ_OPTION_DOUBLE, CLASSIFY(turn_fraction), 0, 1, .preset = "0",
	  .help = "a saccade also ends if it accelerates again below this fraction of its peak" },
	{ "pipeline.saccade_max_ms", GZ_OPTION_DOUBLE, CLASSIFY(saccade_max_ms), 10, 1000,
	  .preset = "200", .help = "longest saccade, ms" },
	{ "pipeline.glissade_ms", GZ_OPTION_DOUBLE, CLASSIFY(glissade_ms), 0, 1000, .preset = "40",
	  .help = "how long the eye may ring after a saccade, ms" },
	{ "pipeline.glissade_fraction", GZ_OPTION_DOUBLE, CLASSIFY(glissade_fraction), 0, 10,
	  .preset = "0.5",
	  .help = "ringing up to this fraction of the saccade's peak is not another saccade" },
	{ "pipeline.fixation_min_ms", GZ_OPTION_DOUBLE, CLASSIFY(fixation_min_ms), 0, 1000,
	  .preset = "40", .help = "shorter fixations are not announced, ms" },
	{ "pipeline.pursuit_window_ms", GZ_OPTION_DOUBLE, CLASSIFY(pursuit_window_ms), 20, 600,
	  .preset = "450", .help = "window for measuring slow movement, ms" },
	{ "pipeline.fixation_spread_deg", GZ_OPTION_DOUBLE, CLASSIFY(fixation_spread_deg), 0.001,
	  100, .preset = "0.165",
	  .help = "standard deviation of the places in a fixation on an axis, degrees" },
	{ "pipeline.fixation_drift_deg2_s", GZ_OPTION_DOUBLE, CLASSIFY(fixation_drift_deg2_s), 0,
	  100, .preset = "0.025", .help = "growth of that variance, square degrees per second" },
	{ "pipeline.pursuit_speed_deg_s", GZ_OPTION_DOUBLE, CLASSIFY(pursuit_speed_deg_s), 0.1,
	  1000, .preset = "6", .help = "usual speed of a pursuit on an axis, degrees per second" },
	{ "pipeline.pursuit_factor_max", GZ_OPTION_DOUBLE, CLASSIFY(pursuit_factor_max), 1, 1000,
	  .preset = "6",
	  .help = "greatest factor by which the movement between two saccades changes the odds of "
		  "pursuit after them" },
	{ "pipeline.pursuit_scenes", GZ_OPTION_DOUBLE, CLASSIFY(pursuit_scenes), 0.01, 0.99,
	  .preset = "0.68", .help = "fraction of scenes that contain something to follow" },
	{ "pipeline.pursuit_begins", GZ_OPTION_DOUBLE, CLASSIFY(pursuit_begins), 0.01, 0.99,
	  .preset = "0.62",
	  .help = "in such scenes: how often a saccade leads from fixation to pursuit" },
	{ "pipeline.pursuit_hysteresis", GZ_OPTION_DOUBLE, CLASSIFY(pursuit_hysteresis), 1, 1000,
	  .preset = "1", .help = "odds needed to change between fixation and pursuit" },
	{ "pipeline.dropout_ms", GZ_OPTION_DOUBLE, CLASSIFY(dropout_ms), 0, 100, .preset = "10",
	  .help = "shorter losses are not blinks, ms" },
	{ "pipeline.blink_max_ms", GZ_OPTION_DOUBLE, CLASSIFY(blink_max_ms), 10, 10000,
	  .preset = "500", .help = "longer losses are not blinks but lost gaze, ms" },
	{ "pipeline.labels", GZ_OPTION_CHOICE, CLASSIFY(source), .choices = source_names,
	  .preset = "learned",
	  .help = "what labels come from: rules, or forests learned from labelled recordings" },
	{ "pipeline.still_scene", GZ_OPTION_BOOL, CLASSIFY(still_scene), .preset = "false",
	  .help = "nothing moves in the scene, so there is no pursuit" },
	{ "pipeline.smooth_window_ms", GZ_OPTION_DOUBLE, SMOOTH(window_ms), 0, 1000,
	  .preset = "300", .help = "longest window of the mean in a fixation, ms" },
	{ "pipeline.smooth_start_ms", GZ_OPTION_DOUBLE, SMOOTH(start_ms), 0, 1000, .preset = "30",
	  .help = "window of the mean at the beginning of a fixation, ms" },
	{ "pipeline.smooth_pursuit_ms", GZ_OPTION_DOUBLE, SMOOTH(pursuit_ms), 0, 1000,
	  .preset = "25", .help = "time constant in a pursuit, ms" },
	{ "pipeline.smooth_drift_factor", GZ_OPTION_DOUBLE, SMOOTH(drift_factor), 0, 1000,
	  .preset = "3",
	  .help = "lag of the mean that halves its window, multiple of the usual distance" },
	{ "pipeline.smooth_leave_factor", GZ_OPTION_DOUBLE, SMOOTH(leave_factor), 0, 1000,
	  .preset = "4",
	  .help = "distance from which the point follows a saccade, multiple of the usual "
		  "distance" },
	{ "pipeline.smooth_leave_deg", GZ_OPTION_DOUBLE, SMOOTH(leave_deg), 0, 180, .preset = "0.2",
	  .help = "least distance from which the point follows a saccade, degrees" },
	{ "pipeline.smooth_drift_deg", GZ_OPTION_DOUBLE, SMOOTH(drift_deg), 0, 180,
	  .preset = "0.24", .help = "least lag of the mean that halves its window, degrees" },
	{ "pipeline.smooth_pass_deg", GZ_OPTION_DOUBLE, SMOOTH(pass_deg), 0, 180, .preset = "1.1",
	  .help = "distance from which a saccade passes unsmoothed, degrees" },
	{ "pipeline.smooth_glide_ms", GZ_OPTION_DOUBLE, SMOOTH(glide_ms), 0, 1000, .preset = "20",
	  .help = "time constant of following smaller movements, ms" },
	{ "pipeline.correction.x", GZ_OPTION_DOUBLE, CORRECT(x), -10, 10, .count = 3,
	  .preset = "0 1 0",
	  .help = "a b c of x' = a + b x + c y, the corrected point; display sides" },
	{ "pipeline.correction.y", GZ_OPTION_DOUBLE, CORRECT(y), -10, 10, .count = 3,
	  .preset = "0 0 1",
	  .help = "a b c of y' = a + b x + c y, the corrected point; display sides" },
};

const size_t gz_pipeline_option_count = sizeof gz_pipeline_options / sizeof gz_pipeline_options[0];

struct gz_pipeline_params gz_pipeline_default_params(void)
{
	struct gz_pipeline_params params = { .validate = { .margin = 0 } };
	struct gz_option_binding binding = {
		.options = gz_pipeline_options,
		.count = gz_pipeline_option_count,
		.target = &params,
	};
	(void)gz_options_preset(&binding); /* a test checks that every preset parses */
	return params;
}

enum gz_result gz_pipeline_check_params(const struct gz_pipeline_params *params, char *message,
					size_t message_size)
{
	if (gz_correct_usable(&params->correct))
		return GZ_OK;
	snprintf(message, message_size,
		 "pipeline.correction: x and y leave no area or are not finite; the size of (b of "
		 "x) "
		 "(c of y) - (c of x) (b of y) must be at least %g",
		 GZ_CORRECT_LEAST_AREA);
	return GZ_ERR_INVAL;
}

void gz_pipeline_name_forests(char out_name[GZ_PIPELINE_FORESTS_SIZE])
{
	/* A factor, so that it matters which is which. */
	const uint64_t name = gz_forest_at_once.training_hash + 3 * gz_forest_certain.training_hash;
	snprintf(out_name, GZ_PIPELINE_FORESTS_SIZE, "%016" PRIx64, name);
}

bool gz_pipeline_other_forests(const struct gz_gaze_log_header *header,
			       const struct gz_pipeline_params *params, const char *path,
			       const struct gz_log *log)
{
	char ours[GZ_PIPELINE_FORESTS_SIZE];
	const char *theirs = "of an earlier version";
	gz_pipeline_name_forests(ours);
	for (size_t i = 0; i < header->setting_count; i++)
		if (strcmp(header->settings[i].key, GZ_PIPELINE_FORESTS_KEY) == 0)
			theirs = header->settings[i].value;
	if (header->setting_count == 0 || params->classify.source != GZ_CLASSIFY_LEARNED ||
	    strcmp(theirs, ours) == 0)
		return false;
	gz_warn(log,
		"%s: recorded with the forests %s, and this version has %s; labels may differ from "
		"those that were shown",
		path, theirs, ours);
	return true;
}

/* Parse one "#pipeline." line. A setting that this version does not have is ignored. */
static enum gz_result parse_recorded_setting(const struct gz_gaze_log_setting *setting,
					     const char *path, const struct gz_log *log,
					     struct gz_pipeline_params *params)
{
	const struct gz_option_binding binding = { gz_pipeline_options, gz_pipeline_option_count,
						   params, NULL };
	char key[GZ_NAME_SIZE + sizeof "pipeline."];
	char message[256];
	if (strcmp(setting->key, GZ_PIPELINE_FORESTS_KEY) == 0)
		return GZ_OK;
	snprintf(key, sizeof key, "pipeline.%s", setting->key);
	const struct gz_option *option = gz_options_find(&binding, 1, key, NULL);
	if (!option) {
		gz_warn(log, "%s: #%s %s: this version has no such setting; it is ignored", path,
			key, setting->value);
		return GZ_OK;
	}
	if (gz_option_parse(option, setting->value, params, message, sizeof message) == GZ_OK)
		return GZ_OK;
	gz_err(log, "%s: #%s: %s; correct this line to replay the log", path, key, message);
	return GZ_ERR_FORMAT;
}

struct gz_pipeline_params gz_pipeline_unnamed_params(const struct gz_gaze_log_header *header)
{
	struct gz_pipeline_params params = gz_pipeline_default_params();
	if (header->setting_count > 0) { /* what it names comes later */
		params.classify.source = GZ_CLASSIFY_RULES;
		params.lid.change = 0;
	}
	return params;
}

enum gz_result gz_pipeline_recorded_params(const struct gz_gaze_log_header *header,
					   const char *path, const struct gz_log *log,
					   struct gz_pipeline_params *out_params)
{
	struct gz_pipeline_params params = gz_pipeline_unnamed_params(header);
	for (size_t i = 0; i < header->setting_count; i++) {
		const enum gz_result result =
			parse_recorded_setting(&header->settings[i], path, log, &params);
		if (result != GZ_OK)
			return result;
	}
	char message[256];
	if (gz_pipeline_check_params(&params, message, sizeof message) != GZ_OK) {
		gz_err(log, "%s: %s", path, message);
		return GZ_ERR_FORMAT;
	}
	(void)gz_pipeline_other_forests(header, &params, path, log);
	*out_params = params;
	return GZ_OK;
}
