/**
 * @file
 * What the streams of the Lab Streaming Layer hold: their descriptions, the values of a gaze
 * sample, the labels of events, and the relation of their clock to the host's.
 *
 * The description of the gaze follows the "Gaze Meta-Data" of XDF, the file format of LSL's
 * recorder (https://github.com/sccn/xdf/wiki/Gaze-Meta-Data): for each channel label, eye, type,
 * unit and coordinate system; for the acquisition the model and the serial number.
 */
#ifndef GZ_DAEMON_LSL_STREAM_H
#define GZ_DAEMON_LSL_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/sizes.h"
#include "daemon/lsl/lsl_library.h"
#include "filter/pipeline.h"
#include "protocol/display.h"
#include "protocol/gaze.h"

/** What a gaze stream is described with. */
struct gz_lsl_device {
	char tracker[GZ_NAME_SIZE];
	char serial[GZ_NAME_SIZE]; /**< empty: none */
	double rate_hz;            /**< nominal; 0: unknown */
	struct gz_display display;
};

/** Whether two devices have the same description. */
bool gz_lsl_device_same(const struct gz_lsl_device *a, const struct gz_lsl_device *b);

/** Channels of the gaze stream: six of both eyes, and ten of each eye. */
#define GZ_LSL_CHANNELS 26

/**
 * Describe the stream of gaze: type "Gaze", GZ_LSL_CHANNELS channels of double.
 *
 * @param name  of the stream; not empty
 * @param host  name of the machine, a part of the stream's source_id
 * @return owned by the caller: destroy_streaminfo(); NULL if the library refuses
 */
struct gz_lsl_info *gz_lsl_describe_gaze(const struct gz_lsl_library *library, const char *name,
					 const char *host, const struct gz_lsl_device *device);

/** Describe the stream of events: type "Markers", one channel of strings, at irregular times. Its
 * name is @p name and " events". Otherwise as gz_lsl_describe_gaze(). */
struct gz_lsl_info *gz_lsl_describe_events(const struct gz_lsl_library *library, const char *name,
					   const char *host);

/**
 * The channels of a sample, in the order of the description. What was not measured is NaN; while
 * the gaze is lost, the smoothed point keeps its last value and its confidence is 0, as in the
 * daemon's own messages. Pure.
 */
void gz_lsl_values(const struct gz_gaze *gaze, const struct gz_display *display,
		   double out_values[GZ_LSL_CHANNELS]);

/** An event on the stream of events. */
struct gz_lsl_event {
	int64_t host_ns;   /**< when it happened */
	const char *label; /**< "fixation_onset", "fixation_offset", "saccade_onset", …; static */
};

/** Most events of one step: of each fixation and saccade a beginning and an end. */
#define GZ_LSL_EVENTS_MAX (2 * GZ_FIXATION_MESSAGES_MAX + GZ_BLINK_MESSAGES_MAX + 2)

/** What is remembered between steps. Zero-initialised is the start state. */
struct gz_lsl_events {
	bool in_fixation; /**< the onset of fixation_id was given, its end was not */
	uint64_t fixation_id;
};

/**
 * The events that a step of the pipeline tells: onset and end of each fixation, blink and finished
 * saccade, once. Pure.
 *
 * @param[out] out_events  GZ_LSL_EVENTS_MAX
 * @return how many
 */
size_t gz_lsl_events_step(struct gz_lsl_events *events, const struct gz_pipeline_output *step,
			  struct gz_lsl_event out_events[GZ_LSL_EVENTS_MAX]);

/**
 * LSL's clock less the host's, s, from one reading. While the reading agrees with the offset known
 * so far, that is kept, so that stamps do not jitter; before the first reading it is 0, which is
 * exact where both are the same clock, as on Linux. Pure.
 *
 * @param offset_s             known so far
 * @param before_ns, after_ns  host time just before and after the reading
 * @param lsl_s                the reading
 */
double gz_lsl_offset_step(double offset_s, int64_t before_ns, double lsl_s, int64_t after_ns);

#endif
