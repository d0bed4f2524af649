/**
 * @file
 * A gaze recording: its samples, the known events, and the output of a filter.
 *
 * What the pipeline is compared with is here too: the 1 euro filter, and velocity-threshold
 * identification.
 */
#ifndef GZ_BENCH_FILTER_TRACK_H
#define GZ_BENCH_FILTER_TRACK_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/result.h"
#include "bench/filter/labelled_recording.h"
#include "filter/pipeline.h"
#include "protocol/display.h"
#include "protocol/gaze.h"

/** A recording. The arrays have @p count elements, one a sample, by time. */
struct gz_gaze_track {
	struct gz_display display;
	size_t count;
	struct gz_sample *sample; /**< seq is the place in the array */
	struct gz_point *raw;     /**< the common point as a filter gets it; NaN where none is */
	enum gz_event *label;     /**< what the eye did: by people, or as filter/offline.h finds it;
				     ringing after a saccade is GZ_EVENT_LOST */
	struct gz_point *point;   /**< what a filter made of it, always finite */
	enum gz_event *event;     /**< what a filter called it */
};

/**
 * Room for @p count samples; all is zero.
 *
 * @retval GZ_ERR_NO_MEM  nothing to free
 */
enum gz_result gz_gaze_track_start(size_t count, const struct gz_display *display,
				   struct gz_gaze_track *out_track);

/**
 * Take a recording that people labelled: its samples, points and labels, in copies. Ringing and
 * what is undefined is GZ_EVENT_LOST.
 *
 * @retval GZ_ERR_NO_MEM  nothing to free
 */
enum gz_result gz_gaze_track_take_labelled(const struct gz_labelled_recording *recording,
					   struct gz_gaze_track *out_track);

/** Free what it holds and zero it. */
void gz_gaze_track_free(struct gz_gaze_track *track);

/** Time from sample @p from to sample @p to, ms; infinite where no clock counts so far. */
double gz_gaze_track_elapsed_ms(const struct gz_gaze_track *track, size_t from, size_t to);

/**
 * Time between samples, ms: the mean of the steps, without those above one and a half times their
 * median, which hold lost samples. NaN for fewer than two samples or without memory.
 */
double gz_gaze_track_interval_ms(const struct gz_gaze_track *track);

/**
 * Run the pipeline over it: fills @p point and @p event.
 *
 * @param params   NULL for the defaults
 * @param certain  @p event is the pipeline's final label (gz_gaze.final_event); else its immediate
 *                 one
 */
void gz_gaze_track_run_pipeline(struct gz_gaze_track *track,
				const struct gz_pipeline_params *params, bool certain);

/**
 * Run the pipeline over it and keep what its smoothing takes, because the labels cost much more
 * than the smoothing does.
 *
 * @param params  NULL for the defaults
 * @param[out] out_inputs  one a sample; time_ns is INT64_MIN where the pipeline passes over a
 * sample
 */
void gz_gaze_track_take_smoothing(const struct gz_gaze_track *track,
				  const struct gz_pipeline_params *params,
				  struct gz_smooth_input *out_inputs);

/** Smooth what gz_gaze_track_take_smoothing() kept: fills @p point as the pipeline with these
 * settings of its smoothing would. @p event stays. */
void gz_gaze_track_smooth(struct gz_gaze_track *track, const struct gz_smooth_params *params,
			  const struct gz_smooth_input *inputs);

/** Settings of the 1 euro filter: Casiez, Roussel and Vogel, "1 euro filter: a simple speed-based
 *  low-pass filter for noisy input in interactive systems", CHI 2012. */
struct gz_one_euro_params {
	double min_cutoff_hz;
	double derivative_cutoff_hz;
	double beta; /**< cutoff gained with speed, Hz over degrees a second */
};

/**
 * Run the 1 euro filter over @p raw, in degrees on each axis: fills @p point, and @p event stays.
 * Where nothing was measured the last point is held, (0.5, 0.5) before any.
 */
void gz_gaze_track_run_one_euro(struct gz_gaze_track *track,
				const struct gz_one_euro_params *params);

/** A recording of anybody. */
struct gz_gaze_log_track {
	struct gz_gaze_track track;       /**< label is by filter/offline.h */
	struct gz_pipeline_params params; /**< that it was recorded with */
	bool display_known;               /**< else the default is assumed */
};

/**
 * Read a gaze log and label it offline with the recorded settings. Samples whose time does
 * not advance are left out, as the pipeline does. @p raw is both eyes joined and corrected, before
 * anything is taken for a spike.
 *
 * @param[out] out_log  free its track
 * @retval GZ_ERR_FORMAT  no gaze log, no sample in it, or a setting that is refused; logged
 * @retval GZ_ERR_NOT_FOUND, GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_gaze_track_read_log(const char *path, const struct gz_log *log,
				      struct gz_gaze_log_track *out_log);

/** Its state on one axis; zero-initialised is the start state. */
struct gz_one_euro {
	bool started;
	double value, derivative;
};

/**
 * Filter one number.
 *
 * @param step_s  time since the last one, s; above 0 but for the first
 */
double gz_one_euro_step(struct gz_one_euro *state, const struct gz_one_euro_params *params,
			double step_s, double number);

/**
 * Velocity-threshold identification (I-VT): Salvucci and Goldberg, "Identifying fixations and
 * saccades in eye-tracking protocols", ETRA 2000, section 3.1.1. Faster from sample to sample than
 * the threshold is a saccade, all else fixation.
 *
 * @param step_deg  angle from the sample before, degrees
 * @param step_s    time since it, s; above 0
 */
bool gz_is_saccade_by_velocity(double threshold_deg_s, double step_deg, double step_s);

#endif
