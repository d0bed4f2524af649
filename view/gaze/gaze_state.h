/**
 * @file
 * Whether a gaze can be relied on: what is wrong with it, how badly, in words; and how often it
 * comes. Pure: no clock, no input or output.
 */
#ifndef GZ_VIEW_GAZE_GAZE_STATE_H
#define GZ_VIEW_GAZE_GAZE_STATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "protocol/gaze.h"
#include "view/gaze/gaze_source.h"

#ifdef __cplusplus
extern "C" {
#endif

/** An older gaze is late. Of the 50 to 70 ms from eye to picture that foveated rendering bears
 * (Albert, Patney, Luebke and Kim 2017, Latency Requirements for Foveated Rendering in Virtual
 * Reality, abstract) nothing is left to make the picture in. */
#define GZ_GAZE_LATE_NS INT64_C(50000000)

/** An older gaze is silent: it has no age that runs on any more. */
#define GZ_GAZE_SILENT_NS INT64_C(1000000000)

/** How badly. */
enum gz_gaze_level {
	GZ_GAZE_LEVEL_GOOD,
	GZ_GAZE_LEVEL_WARN, /**< amber */
	GZ_GAZE_LEVEL_BAD,  /**< red */
};

/** What is known. */
struct gz_gaze_signs {
	bool from_daemon;
	bool from_log;
	bool wants_pointer;             /**< the mouse, by way of the daemon */
	struct gz_gaze_reading reading; /**< of the source that is asked for */
	const struct gz_status *status; /**< of the daemon; NULL: not told */
	bool losing;                    /**< samples were lost just now */
	bool log_ended;
	bool window_elsewhere; /**< the window is not on the tracker's display */
};

/** What follows from it. */
struct gz_gaze_state {
	enum gz_gaze_level level;
	char reason[2 * GZ_REASON_SIZE]; /**< begins with a word in capitals; empty where GOOD */
};

/** The worst that the signs say. */
void gz_gaze_state_of(const struct gz_gaze_signs *signs, struct gz_gaze_state *out_state);

/** Readings that a rate is made of, a hundredth of a second apart at least. */
enum { GZ_GAZE_RATE_ROOM = 128 };

/** Counts. Zero-initialised has counted nothing. */
struct gz_gaze_rate {
	struct {
		uint64_t seq;
		int64_t sample_ns;
	} kept[GZ_GAZE_RATE_ROOM];
	size_t count, next;
};

/** Take a reading; those without a number are left out. One that does not go on from the one before
 * begins anew. */
void gz_gaze_rate_step(struct gz_gaze_rate *rate, const struct gz_gaze_reading *reading);

/** Samples a second over the last second; 0 while there are too few to tell. */
double gz_gaze_rate_hz(const struct gz_gaze_rate *rate);

#ifdef __cplusplus
}
#endif

#endif
