/**
 * @file
 * The last second of the gaze: its path and its fixations. Pure: the caller passes times.
 */
#ifndef GZ_VIEW_GAZE_GAZE_TRAIL_H
#define GZ_VIEW_GAZE_GAZE_TRAIL_H

#include <stdbool.h>
#include <stdint.h>

#include "view/gaze/gaze_source.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Time span kept, ns. */
#define GZ_GAZE_TRAIL_NS INT64_C(1000000000)

/** Largest number of stays: enough for a step every 4 ms. Faster steps drop the oldest earlier. */
enum { GZ_GAZE_TRAIL_ROOM = 256 };

/** A place where the gaze stayed. */
struct gz_gaze_stay {
	struct gz_point point; /**< on the picture */
	int64_t from_ns, to_ns;
	bool fixation; /**< the stay is a fixation */
};

/** The trail, oldest first. Zero-initialised: empty. */
struct gz_gaze_trail {
	struct gz_gaze_stay stays[GZ_GAZE_TRAIL_ROOM];
	int count;
};

/**
 * Add a reading. A fixation reported by the tracker becomes one stay at the mean of its points.
 * Without events, a gaze that stays at one place for 100 ms is a fixation (chosen: the shortest
 * fixation of the usual classifiers).
 *
 * @param apart   points closer than this on both axes are one place
 * @param now_ns  not before the previous call's
 * @return whether the drawn trail changes: something is new, or an older stay fades
 */
bool gz_gaze_trail_step(struct gz_gaze_trail *trail, const struct gz_gaze_reading *reading,
			float apart, int64_t now_ns);

/** Opacity of a stay: 1 until it ends, then down to 0 within GZ_GAZE_TRAIL_NS. */
float gz_gaze_trail_strength(const struct gz_gaze_stay *stay, int64_t now_ns);

#ifdef __cplusplus
}
#endif

#endif
