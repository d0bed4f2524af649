/**
 * @file
 * What gazeview is told of fixation targets: which places, for how long, in which order.
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

enum gz_target_order {
	GZ_TARGET_ORDER_FIXED, /**< as listed */
	GZ_TARGET_ORDER_RANDOM,
};

enum gz_target_advance {
	GZ_TARGET_ADVANCE_AUTO,  /**< each target stays for its time */
	GZ_TARGET_ADVANCE_SPACE, /**< each stays until the space bar is pressed after its time */
};

/** Settings; one table describes them: gz_target_option_table. */
struct gz_target_options {
	char targets[GZ_PATH_SIZE]; /**< "5", "9", "13" or a file's name; empty: no targets */
	double duration_s;          /**< each stays for at least so long */
	int order;                  /**< enum gz_target_order */
	int seed;                   /**< of the random order; 0: another one each time */
	int advance;                /**< enum gz_target_advance */
	bool instructions;          /**< begin with them, and wait for the space bar */
	bool windowed;              /**< in a window instead of the whole display */
};

/** Table over struct gz_target_options. */
extern const struct gz_option gz_target_option_table[];
extern const size_t gz_target_option_count;

/**
 * The places that @p options name, in the order in which they are to be shown.
 *
 * "5" are the middle and four at a tenth from the edges, "9" a grid of three by three with the same
 * outline, "13" these and four half-way to the corners: the layouts of common calibrations. Else
 * the file that gz_targets_load() reads; weights do not matter.
 *
 * @param[out] out_targets  written on success only
 * @return GZ_OK, or what gz_targets_load() returns; logged
 */
enum gz_result gz_target_places(const struct gz_target_options *options, const struct gz_log *log,
				struct gz_targets *out_targets);

#endif
