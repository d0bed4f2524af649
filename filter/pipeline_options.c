/* Presets and their sources. */
#include <stdio.h>

#include "filter/pipeline.h"

#define VALIDATE(field) offsetof(struct gz_pipeline_params, validate.field)
#define CORRECT(field)  offsetof(struct gz_pipeline_params, correct.field)
#define COMBINE(field)  offsetof(struct gz_pipeline_params, combine.field)
#define DESPIKE(field)  offsetof(struct gz_pipeline_params, despike.field)
#define CLASSIFY(field) offsetof(struct gz_pipeline_params, classify.field)
#define SMOOTH(field)   offsetof(struct gz_pipeline_params, smooth.field)
#define REAL(key, offset, min, max, preset, help)                                          \
	{                                                                                  \
		"pipeline." key, GZ_OPTION_DOUBLE, offset, min, max, 0, NULL, preset, help \
	}

#define AFFINE(key, offset, preset, help)                                                 \
	{                                                                                 \
		"pipeline." key, GZ_OPTION_DOUBLE, offset, -10, 10, 3, NULL, preset, help \
	}

static const char *const EYES[] = { "both", "left", "right", NULL };

/* Sources, where the help does not say it:
 *
 * max_velocity_deg_s  eyes turn at up to 900 degrees a second (Bauer 2018, section 2.2)
 * peak_factor         Engbert and Kliegl 2003 take 6 standard deviations of each axis, which are 5
 *                     medians of the speed
 * onset_factor        under half of it: 3 against 6 deviations in Nyström and Holmqvist 2010
 * blink_max_ms        the longest blink of Stern, Walrath and Goldstein 1984, 400 ms, and some
 * window_ms           the shortest fixation of Bauer 2018, section 2.2
 * the others          chosen on recordings that two people labelled (Andersson et al. 2017) and on
 *                     simulated ones: bench/gaze_filter.c prints what they reach
 * fixation_..., pursuit_...  chosen so by bench/gaze_filter_fit.c, on a plateau
 * end_ms              half the window over which speed is measured, less a sample at 500 Hz
 */
const struct gz_option gz_pipeline_options[] = {
	REAL("margin", VALIDATE(margin), 0, 10, "0.25",
	     "how far outside the display a point may lie, display sides"),
	REAL("max_velocity_deg_s", VALIDATE(max_velocity_deg_s), 100, 100000, "1000",
	     "faster than an eye turns, degrees a second"),
	REAL("jump_deg", VALIDATE(jump_deg), 0, 180, "2",
	     "a step this small is never too fast: noise, degrees"),
	REAL("max_disparity_deg", VALIDATE(max_disparity_deg), 0.1, 180, "5",
	     "greatest unusual angle between the eyes' points, degrees"),
	REAL("min_confidence", VALIDATE(min_confidence), 0, 1, "0.6",
	     "an eye with less confidence is not used"),
	{ "pipeline.eyes", GZ_OPTION_CHOICE, VALIDATE(eyes), 0, 0, 0, EYES, "both",
	  "eyes that are used, where the tracker tells them apart" },
	REAL("offset_ms", COMBINE(offset_ms), 1, 100000, "100",
	     "time constant of learning the eyes' offset from each other, ms"),
	REAL("noise_ms", COMBINE(noise_ms), 1, 100000, "2000",
	     "time constant of learning each eye's noise, ms"),
	REAL("despike_delay_ms", DESPIKE(max_delay_ms), 0, 100, "4",
	     "longest hold of a possible spike, ms; 0 switches it off"),
	REAL("despike_deg", DESPIKE(threshold_deg), 0, 180, "0.4",
	     "smaller departures are no spikes, degrees"),
	REAL("despike_factor", DESPIKE(noise_factor), 0, 1000, "8",
	     "nor are those below this multiple of the usual step"),
	REAL("final_delay_ms", CLASSIFY(final_delay_ms), 0, 100, "10",
	     "oldest age at which a label becomes certain, ms"),
	REAL("velocity_window_ms", CLASSIFY(velocity_window_ms), 1, 100, "10",
	     "width of the window over which speed is measured, ms"),
	REAL("quick_window_ms", CLASSIFY(quick_window_ms), 1, 100, "8",
	     "the same for the label given at once, trailing, ms"),
	REAL("noise_memory_s", CLASSIFY(noise_memory_s), 0.01, 1000, "2",
	     "time constant of the noise estimate, s"),
	REAL("peak_factor", CLASSIFY(peak_factor), 0, 100, "5",
	     "what the median speed adds to the peak threshold"),
	REAL("onset_factor", CLASSIFY(onset_factor), 0, 100, "2",
	     "what it adds to the onset and end threshold"),
	REAL("peak_base_deg_s", CLASSIFY(peak_base_deg_s), 1, 1000, "20",
	     "peak threshold of a saccade without noise, degrees a second"),
	REAL("onset_base_deg_s", CLASSIFY(onset_base_deg_s), 1, 1000, "10",
	     "onset and end threshold without noise, degrees a second"),
	REAL("end_fraction", CLASSIFY(end_fraction), 0, 1, "0.05",
	     "a saccade ends below this part of its peak velocity, along its way"),
	REAL("end_ms", CLASSIFY(end_ms), 0, 100, "4", "and so long after its speed fell below, ms"),
	REAL("turn_fraction", CLASSIFY(turn_fraction), 0, 1, "0",
	     "and where it gathers speed again below this part"),
	REAL("saccade_max_ms", CLASSIFY(saccade_max_ms), 10, 1000, "200", "longest saccade, ms"),
	REAL("glissade_ms", CLASSIFY(glissade_ms), 0, 1000, "40",
	     "how long after a saccade the eye may ring, ms"),
	REAL("glissade_fraction", CLASSIFY(glissade_fraction), 0, 10, "0.5",
	     "part of the saccade's peak up to which that is no other saccade"),
	REAL("fixation_min_ms", CLASSIFY(fixation_min_ms), 0, 1000, "40",
	     "shorter fixations are not announced, ms"),
	REAL("pursuit_window_ms", CLASSIFY(pursuit_window_ms), 20, 600, "450",
	     "over which slow movement is measured, ms"),
	REAL("fixation_spread_deg", CLASSIFY(fixation_spread_deg), 0.001, 100, "0.165",
	     "how far a fixation's places lie apart, deviation of an axis, degrees"),
	REAL("fixation_drift_deg2_s", CLASSIFY(fixation_drift_deg2_s), 0, 100, "0.025",
	     "what its square grows by in a second, square degrees"),
	REAL("pursuit_speed_deg_s", CLASSIFY(pursuit_speed_deg_s), 0.1, 1000, "6",
	     "usual speed of a pursuit on an axis, degrees a second"),
	REAL("pursuit_factor_max", CLASSIFY(pursuit_factor_max), 1, 1000, "6",
	     "most that the movement between two saccades changes the odds of pursuit after them"),
	REAL("pursuit_scenes", CLASSIFY(pursuit_scenes), 0.01, 0.99, "0.68",
	     "part of the scenes that have something to follow"),
	REAL("pursuit_begins", CLASSIFY(pursuit_begins), 0.01, 0.99, "0.62",
	     "how often, there, a saccade leads from fixation to pursuit"),
	REAL("pursuit_hysteresis", CLASSIFY(pursuit_hysteresis), 1, 1000, "1",
	     "odds needed to change between fixation and pursuit"),
	REAL("dropout_ms", CLASSIFY(dropout_ms), 0, 100, "10", "shorter losses are not blinks, ms"),
	REAL("blink_max_ms", CLASSIFY(blink_max_ms), 10, 10000, "500",
	     "longer losses are not blinks but lost gaze, ms"),
	REAL("smooth_window_ms", SMOOTH(window_ms), 0, 1000, "100",
	     "longest window of the mean within a fixation, ms"),
	REAL("smooth_start_ms", SMOOTH(start_ms), 0, 1000, "15",
	     "shortest window of the mean, at its beginning, ms"),
	REAL("smooth_pursuit_ms", SMOOTH(pursuit_ms), 0, 1000, "25",
	     "time constant within a pursuit, ms"),
	REAL("smooth_drift_factor", SMOOTH(drift_factor), 0, 1000, "5",
	     "the window is halved at this multiple of the usual distance"),
	REAL("smooth_leave_factor", SMOOTH(leave_factor), 0, 1000, "4",
	     "a saccade is followed from this multiple of the usual distance on"),
	REAL("smooth_leave_deg", SMOOTH(leave_deg), 0, 180, "0.2",
	     "and from at least this distance on, degrees"),
	REAL("smooth_drift_deg", SMOOTH(drift_deg), 0, 180, "0.4",
	     "and at least at this distance, degrees"),
	REAL("smooth_pass_deg", SMOOTH(pass_deg), 0, 180, "1.2",
	     "from this distance on a saccade passes unsmoothed, degrees"),
	REAL("smooth_glide_ms", SMOOTH(glide_ms), 0, 1000, "20",
	     "time constant of giving way to smaller movements, ms"),
	AFFINE("correction.x", CORRECT(x), "0 1 0",
	       "a b c of x' = a + b x + c y, the corrected point, display sides"),
	AFFINE("correction.y", CORRECT(y), "0 0 1",
	       "a b c of y' = a + b x + c y, the corrected point, display sides"),
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
	(void)gz_options_preset(&binding); /* that every preset parses is a test's matter */
	return params;
}

enum gz_result gz_pipeline_check_params(const struct gz_pipeline_params *params, char *message,
					size_t message_size)
{
	if (gz_correct_usable(&params->correct))
		return GZ_OK;
	snprintf(message, message_size,
		 "pipeline.correction: x and y as given leave no area, or are not finite; b of x "
		 "times c of y less c of x times b of y must be at least %g",
		 GZ_CORRECT_LEAST_AREA);
	return GZ_ERR_INVAL;
}
