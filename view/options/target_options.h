/**
 * @file
 * Options of the fixation targets: which positions, for how long, in which order.
 */
#ifndef GZ_VIEW_OPTIONS_TARGET_OPTIONS_H
#define GZ_VIEW_OPTIONS_TARGET_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/log.h"
#include "base/option.h"
#include "base/result.h"
#include "protocol/gaze.h"
#include "sim/targets.h"

/** Order of the targets. */
enum gz_target_order {
	GZ_TARGET_ORDER_FIXED, /**< as listed */
	GZ_TARGET_ORDER_RANDOM,
};

/** When the next target is shown. */
enum gz_target_advance {
	GZ_TARGET_ADVANCE_AUTO,  /**< after the duration */
	GZ_TARGET_ADVANCE_SPACE, /**< when Space is pressed, after the duration at the earliest */
};

/** The options, described by gz_target_option_table. */
struct gz_target_options {
	char targets[GZ_PATH_SIZE]; /**< "5", "9", "13" or a file; empty: no targets */
	double duration_s;          /**< shortest time of a target, s */
	int order;                  /**< enum gz_target_order */
	int seed;                   /**< of the random order; 0: a new order each time */
	int advance;                /**< enum gz_target_advance */
	bool instructions;          /**< show instructions first and wait for Space */
	bool windowed;              /**< in a window instead of full screen */
};

/** Table over struct gz_target_options. */
extern const struct gz_option gz_target_option_table[];
extern const size_t gz_target_option_count;

/**
 * The positions of the targets in the order they are shown.
 *
 * "5": the centre and four at a tenth from the edges; "9": a three-by-three grid with the same
 * outline; "13": these and four half-way to the corners. These are the layouts of common
 * calibrations. Any other text is a file for gz_targets_load(); its weights are ignored.
 *
 * @param[out] out_targets  written on success only
 * @return the results of gz_targets_load(); logged
 */
enum gz_result gz_target_places(const struct gz_target_options *options, const struct gz_log *log,
				struct gz_targets *out_targets);

#endif
