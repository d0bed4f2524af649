/**
 * @file
 * What the pipeline is compared with: the 1 euro filter and velocity-threshold identification.
 */
#ifndef GZ_BENCH_FILTER_BASELINES_H
#define GZ_BENCH_FILTER_BASELINES_H

#include <stdbool.h>

/** Settings of the 1 euro filter: Casiez, Roussel and Vogel, "1 euro filter: a simple speed-based
 *  low-pass filter for noisy input in interactive systems", CHI 2012. */
struct gz_one_euro_params {
	double min_cutoff_hz;
	double derivative_cutoff_hz;
	double beta; /**< cutoff gained with speed, Hz over degrees a second */
};

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
