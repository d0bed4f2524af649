/**
 * @file
 * The affine correction that brings what a tracker said of several targets closest to where they
 * were, and whether it would help with places that it was not made from.
 *
 * Least squares of the targets' places over the seen ones, each axis by itself. A target that the
 * person did not look at must not spoil it: a target is left out whose distance from what a fit
 * over the others predicts is more than GZ_FIT_OUTLIER_FACTOR times the median of all such
 * distances and more than GZ_FIT_OUTLIER_DEG; the worst first, no more than one in four.
 *
 * Two maps are tried, a shift of everything and the full affine map, by leave-one-out
 * cross-validation (Stone, "Cross-validatory choice and assessment of statistical predictions",
 * Journal of the Royal Statistical Society B 36, 1974): each target is corrected by a fit over the
 * others, so that a map which only follows the noise shows no gain.
 */
#ifndef GZ_CLIENT_GAZECTL_VALIDATE_CORRECTION_FIT_H
#define GZ_CLIENT_GAZECTL_VALIDATE_CORRECTION_FIT_H

#include <stdbool.h>
#include <stddef.h>

#include "filter/correct.h"
#include "protocol/display.h"

/** Most targets of a fit. Chosen: more than anybody looks at in a row. */
#define GZ_FIT_TARGETS_MAX 256

/** Fewest targets for a shift and for an affine map. Chosen: one more than the smallest number of
 * which each may be left out and still leave a fit with something over. */
#define GZ_FIT_SHIFT_TARGETS  3
#define GZ_FIT_AFFINE_TARGETS 5

/** Least spread of the seen places in every direction for an affine map, display sides (standard
 * deviation). Chosen: a quarter of that of targets at 0.3 and 0.7; less extrapolates. */
#define GZ_FIT_SPREAD_MIN 0.05

/** When a target is left out; see above. Chosen: three medians are
 * passed by one in 512 of normally distributed errors;
 * 1 degree is more than any usable tracker errs by at random. */
#define GZ_FIT_OUTLIER_FACTOR 3.0
#define GZ_FIT_OUTLIER_DEG    1.0

/** A correction helps if it takes away this share of the error and so many degrees. Chosen: less
 * is within what two checks in a row differ by. */
#define GZ_FIT_GAIN_SHARE 0.1
#define GZ_FIT_GAIN_DEG   0.05

enum gz_fit_model {
	GZ_FIT_NONE, /**< too few targets: the identity */
	GZ_FIT_SHIFT,
	GZ_FIT_AFFINE,
};

/** "none", "shift", "affine". Static text. */
const char *gz_fit_model_name(enum gz_fit_model model);

/** One target: where it was, and where the tracker saw the gaze. */
struct gz_fit_pair {
	struct gz_point target;
	struct gz_point seen; /**< NaN: not at all; it does not count */
};

/** A fit. */
struct gz_fit {
	enum gz_fit_model model;
	struct gz_correct_params map; /**< from seen to true; the identity for NONE */
	bool used[GZ_FIT_TARGETS_MAX];
	size_t used_count;
	double before_deg; /**< mean error of the targets used; NaN if there are none */
	double after_deg;  /**< with the map, of the same targets; too good by nature */
	double cross_deg;  /**< of targets that the map was not made from; NaN for NONE */
	bool helps;        /**< the last by the measure above, and the map is usable */
};

/**
 * Fit.
 *
 * @param display  valid
 * @param pairs    up to GZ_FIT_TARGETS_MAX; more are not looked at
 */
void gz_fit_correction(const struct gz_display *display, const struct gz_fit_pair *pairs,
		       size_t count, struct gz_fit *out_fit);

/** The map that does @p first and then @p second: what to store where the tracker's gaze has been
 * corrected by @p first already. */
struct gz_correct_params gz_fit_compose(const struct gz_correct_params *first,
					const struct gz_correct_params *second);

#endif
