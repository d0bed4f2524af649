/**
 * @file
 * Judges the gaze: what is wrong with it, how badly, in words; and measures its sample rate. Pure:
 * no clock, no I/O.
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

/** Age from which a gaze is late, ns. Foveated rendering tolerates 50 to 70 ms from eye movement to
 * picture (Albert, Patney, Luebke and Kim 2017, Latency Requirements for Foveated Rendering in
 * Virtual Reality, abstract); a gaze this old leaves no time to render. */
#define GZ_GAZE_LATE_NS INT64_C(50000000)

/** Age from which a gaze is silent, ns: its age is no longer shown counting. */
#define GZ_GAZE_SILENT_NS INT64_C(1000000000)

/** How bad the state is. */
enum gz_gaze_level {
	GZ_GAZE_LEVEL_GOOD,
	GZ_GAZE_LEVEL_WARN, /**< amber */
	GZ_GAZE_LEVEL_BAD,  /**< red */
};

/** What is known about the gaze. */
struct gz_gaze_signs {
	bool from_daemon;
	bool from_log;
	bool wants_pointer;             /**< the user chose the mouse through the daemon */
	struct gz_gaze_reading reading; /**< from the source the user chose */
	const struct gz_status *status; /**< of the daemon; NULL: unknown */
	bool losing;                    /**< samples were lost recently */
	bool log_ended;
	bool window_elsewhere; /**< the window is not on the tracker's display */
};

/** The verdict. */
struct gz_gaze_state {
	enum gz_gaze_level level;
	char reason[2 * GZ_REASON_SIZE]; /**< begins with a word in capitals; empty if GOOD */
};

/** Judge the signs and return the worst verdict. */
void gz_gaze_state_of(const struct gz_gaze_signs *signs, struct gz_gaze_state *out_state);

/** Number of readings kept for a rate, at least 10 ms apart. */
enum { GZ_GAZE_RATE_ROOM = 128 };

/** Measures the sample rate. Zero-initialised: nothing measured. */
struct gz_gaze_rate {
	struct {
		uint64_t seq;
		int64_t sample_ns;
	} kept[GZ_GAZE_RATE_ROOM];
	size_t count, next;
};

/** Take a reading. Readings without a number are ignored; if the number or time decreases, the
 * measurement starts again. */
void gz_gaze_rate_step(struct gz_gaze_rate *rate, const struct gz_gaze_reading *reading);

/** Samples per second over the last second; 0 while there are too few readings. */
double gz_gaze_rate_hz(const struct gz_gaze_rate *rate);

#ifdef __cplusplus
}
#endif

#endif
