/**
 * @file
 * The last second of a gaze: where it went, and where it rested. Pure: times come in.
 */
#ifndef GZ_VIEW_GAZE_GAZE_TRAIL_H
#define GZ_VIEW_GAZE_GAZE_TRAIL_H

#include <stdbool.h>
#include <stdint.h>

#include "view/gaze/gaze_source.h"

#ifdef __cplusplus
extern "C" {
#endif

/** What is kept, ns. */
#define GZ_GAZE_TRAIL_NS INT64_C(1000000000)

/** Room for it at a step every 4 ms; at more the oldest go sooner. */
enum { GZ_GAZE_TRAIL_ROOM = 256 };

/** A place that the gaze was at until the next one, or is at. */
struct gz_gaze_stay {
	struct gz_point point; /**< on the picture */
	int64_t from_ns, to_ns;
	bool fixation; /**< the eye rested there */
};

/** The trail, oldest first. Zero-initialised is empty. */
struct gz_gaze_trail {
	struct gz_gaze_stay stays[GZ_GAZE_TRAIL_ROOM];
	int count;
};

/**
 * Take the gaze of a moment. A fixation that a tracker tells is one stay, at the mean of its
 * places; where nobody tells, a place where the gaze stays for 100 ms is (chosen: the shortest
 * fixation of the usual classifiers).
 *
 * @param apart   places nearer than this on both axes are the same
 * @param now_ns  not before the last one
 * @return whether what is drawn has changed: something new, or an older stay that fades
 */
bool gz_gaze_trail_step(struct gz_gaze_trail *trail, const struct gz_gaze_reading *reading,
			float apart, int64_t now_ns);

/** How much is left of a stay that ended then: 1 now, 0 a second later. */
float gz_gaze_trail_strength(const struct gz_gaze_stay *stay, int64_t now_ns);

#ifdef __cplusplus
}
#endif

#endif
