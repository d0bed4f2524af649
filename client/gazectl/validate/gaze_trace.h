/**
 * @file
 * The samples of a while, as the stream brings them, each with its certain label: that comes a few
 * samples later, with another message.
 */
#ifndef GZ_CLIENT_GAZECTL_VALIDATE_GAZE_TRACE_H
#define GZ_CLIENT_GAZECTL_VALIDATE_GAZE_TRACE_H

#include <stddef.h>

#include "base/result.h"
#include "client/gazectl/validate/gaze_quality.h"
#include "protocol/gaze.h"

/** Most samples that are kept. Chosen: half an hour at 2000 Hz. */
#define GZ_GAZE_TRACE_MAX 3600000

/** One sample kept. */
struct gz_gaze_trace_sample {
	struct gz_quality_sample sample;
	enum gz_event event; /**< the certain label; until it is known, the one given at once */
};

/** Samples in the order in which they came. Zero-initialised is empty. */
struct gz_gaze_trace {
	struct gz_gaze_trace_sample *items;
	size_t count;
	size_t room;
};

/**
 * Keep a sample, and take in the label that comes with it for an earlier one. One that is not newer
 * than the last is left out.
 *
 * @retval GZ_ERR_NO_MEM  no memory; the trace is as it was
 * @retval GZ_ERR_FULL    GZ_GAZE_TRACE_MAX samples are kept
 */
enum gz_result gz_gaze_trace_add(struct gz_gaze_trace *trace, const struct gz_gaze *gaze);

/** Index of the first sample taken at @p host_ns or later; count if there is none. */
size_t gz_gaze_trace_find(const struct gz_gaze_trace *trace, int64_t host_ns);

/** Free what it holds and make it empty. */
void gz_gaze_trace_clear(struct gz_gaze_trace *trace);

#endif
