/**
 * @file
 * The affine correction of a tracker's gaze: computing it from targets, and storing it so that the
 * daemon applies it.
 *
 * The fit minimises the squared distances between the targets and the corrected gaze, separately
 * for each axis. A target that the person did not look at must not spoil the result: a target is
 * left out if its distance from the prediction of a fit over the others exceeds both
 * GZ_FIT_OUTLIER_DEG and GZ_FIT_OUTLIER_FACTOR times the median of these distances. The worst
 * target is left out first, and at most one in four.
 *
 * Two maps are compared, a shift and the full affine map, by leave-one-out cross-validation (Stone,
 * "Cross-validatory choice and assessment of statistical predictions", Journal of the Royal
 * Statistical Society B 36, 1974): each target is corrected by a fit over the others, so that a map
 * that only follows the noise shows no gain.
 */
#ifndef GZ_CLIENT_GAZECTL_VALIDATE_CORRECTION_H
#define GZ_CLIENT_GAZECTL_VALIDATE_CORRECTION_H

#include <stdbool.h>
#include <stddef.h>

#include "client/gazectl/gazectl.h"
#include "filter/combine.h"
#include "protocol/display.h"

struct gz_validation;

/** Most targets of a fit. Chosen: more than anyone looks at in a row. */
#define GZ_FIT_TARGETS_MAX 256

/** Fewest targets for a shift and for an affine map. Chosen: if any one is left out, the rest still
 * determines the map with one target to spare. */
#define GZ_FIT_SHIFT_TARGETS  3
#define GZ_FIT_AFFINE_TARGETS 5

/** Smallest spread of the measured points in every direction for an affine map, display sides
 * (standard deviation). Chosen: a quarter of the spread of targets at 0.3 and 0.7; with less the
 * map would extrapolate. */
#define GZ_FIT_SPREAD_MIN 0.05

/** When a target is left out, see above. Chosen: one in 512 of normally distributed errors exceeds
 * three medians, and no usable tracker has random errors above 1 degree. */
#define GZ_FIT_OUTLIER_FACTOR 3.0
#define GZ_FIT_OUTLIER_DEG    1.0

/** A correction helps if it removes at least this share of the error and this many degrees. Chosen:
 * two checks in a row differ by less. */
#define GZ_FIT_GAIN_SHARE 0.1
#define GZ_FIT_GAIN_DEG   0.05

enum gz_fit_model {
	GZ_FIT_NONE, /**< too few targets: the identity */
	GZ_FIT_SHIFT,
	GZ_FIT_AFFINE,
};

/** "none", "shift", "affine"; "unknown" outside the enum. Static text. */
const char *gz_fit_model_name(enum gz_fit_model model);

/** A target, and where the tracker measured the gaze. */
struct gz_fit_pair {
	struct gz_point target;
	struct gz_point seen; /**< NaN: not measured; the pair is ignored */
};

/** A fit. */
struct gz_fit {
	enum gz_fit_model model;
	struct gz_correct_params map; /**< from measured to corrected gaze; the identity for NONE */
	bool used[GZ_FIT_TARGETS_MAX];
	size_t used_count;
	double before_deg; /**< mean error of the targets used; NaN if there are none */
	double after_deg;  /**< the same with the map; too small, because the map was made from
			      these targets */
	double cross_deg;  /**< mean error by cross-validation; NaN for NONE */
	bool helps;        /**< cross_deg is low enough, and the map is usable */
};

/**
 * Fit a correction.
 *
 * @param display       valid
 * @param pairs, count  targets; those beyond GZ_FIT_TARGETS_MAX are ignored
 * @param[out] out_fit  always filled
 */
void gz_fit_correction(const struct gz_display *display, const struct gz_fit_pair *pairs,
		       size_t count, struct gz_fit *out_fit);

/** The map that applies @p first and then @p second: the correction to store if the tracker's gaze
 * was already corrected by @p first. */
struct gz_correct_params gz_fit_compose(const struct gz_correct_params *first,
					const struct gz_correct_params *second);

/** The daemon, and the directory of stored corrections. All borrowed. */
struct gazectl_correction {
	struct gz_control *control;
	struct gz_stream *stream; /**< with status messages */
	const struct gz_log *log;
	const char *directory; /**< empty: the user's, gz_correction_directory() */
};

/**
 * Store the correction of a check, combined with the one that was in force during the check, and
 * wait until the daemon applies it. A correction that does not help is not stored; this is logged
 * and is not a failure.
 *
 * @return GAZECTL_DONE; or another status after logging why
 */
enum gazectl_exit gazectl_correction_store(const struct gazectl_correction *correction,
					   const struct gz_validation *validation);

/**
 * Store what the tracker was validated on, so that the daemon can say when that changes; it is
 * asked to look, unless a recording is running. Nothing is stored if no target was fixated. What
 * fails is logged.
 */
void gazectl_validated_store(const struct gazectl_correction *correction,
			     const struct gz_validation *validation);

/**
 * Remove the correction stored for the tracker and display of @p status, and wait until the daemon
 * no longer applies it.
 *
 * @return GAZECTL_DONE; GAZECTL_FAILED if none is stored; or another status after logging why
 */
enum gazectl_exit gazectl_correction_forget(const struct gazectl_correction *correction,
					    const struct gz_status *status);

#endif
