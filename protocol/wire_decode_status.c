#include <float.h>
#include <math.h>

#include "protocol/wire.h"
#include "protocol/wire_unpack.h"

static const char *tracker_state_name(int state)
{
	return gz_tracker_state_name((enum gz_tracker_state)state);
}

static const char *recording_state_name(int state)
{
	return gz_recording_state_name((enum gz_recording_state)state);
}

static const char *clock_tick_name(int tick)
{
	return gz_clock_tick_name((enum gz_clock_tick)tick);
}

static void take_tracker(struct gz_unpack *unpack, struct gz_status *status)
{
	const msgpack_object *map = gz_unpack_map(unpack, unpack->map, "tracker");
	gz_unpack_text(unpack, map, "name", status->tracker.name, sizeof status->tracker.name);
	gz_unpack_text(unpack, map, "serial", status->tracker.serial,
		       sizeof status->tracker.serial);
	gz_unpack_text(unpack, map, "reason", status->tracker.reason,
		       sizeof status->tracker.reason);
	int state =
		gz_unpack_name(unpack, map, "state", tracker_state_name, GZ_TRACKER_STATE_COUNT);
	if (state >= 0)
		status->tracker.state = (enum gz_tracker_state)state;
}

static void take_counts(struct gz_unpack *unpack, struct gz_status *status)
{
	const msgpack_object *rate = gz_unpack_map(unpack, unpack->map, "rate_hz");
	gz_unpack_double(unpack, rate, "nominal", 0, DBL_MAX, &status->rate_hz_nominal);
	gz_unpack_double(unpack, rate, "measured", 0, DBL_MAX, &status->rate_hz_measured);
	gz_unpack_uint64(unpack, unpack->map, "samples", &status->samples);
	gz_unpack_uint64(unpack, unpack->map, "lost", &status->lost);
	const msgpack_object *rejected = gz_unpack_map(unpack, unpack->map, "rejected");
	for (int i = GZ_REJECT_NONE + 1; i < GZ_REJECT_COUNT; i++)
		gz_unpack_uint64(unpack, rejected, gz_rejection_name((enum gz_rejection)i),
				 &status->rejected[i]);
	const msgpack_object *malformed = gz_unpack_map(unpack, unpack->map, "malformed");
	for (int i = 0; i < GZ_MALFORMED_COUNT; i++)
		gz_unpack_uint64(unpack, malformed, gz_malformed_name((enum gz_malformed)i),
				 &status->malformed[i]);
}

static void take_clock(struct gz_unpack *unpack, struct gz_clock_status *clock)
{
	const msgpack_object *map = gz_unpack_map(unpack, unpack->map, "clock");
	gz_unpack_int64(unpack, map, "offset_ns", &clock->offset_ns);
	gz_unpack_double(unpack, map, "skew_ppm", -DBL_MAX, DBL_MAX, &clock->skew_ppm);
	gz_unpack_double(unpack, map, "sigma_ns", 0, DBL_MAX, &clock->sigma_ns);
	int tick = gz_unpack_name(unpack, map, "tick", clock_tick_name, GZ_CLOCK_TICK_COUNT);
	if (tick >= 0)
		clock->tick = (enum gz_clock_tick)tick;
}

static void take_display(struct gz_unpack *unpack, struct gz_display *display)
{
	const msgpack_object *map = gz_unpack_map(unpack, unpack->map, "display");
	double px[2];
	if (gz_unpack_doubles(unpack, map, "px", px, 2)) {
		for (int i = 0; i < 2; i++) {
			if (px[i] < 0 || px[i] > GZ_DISPLAY_SIDE_MAX_PX || px[i] != floor(px[i]))
				unpack->refused = true;
			else
				display->px[i] = (int)px[i];
		}
	}
	gz_unpack_doubles(unpack, map, "mm", display->mm, 2);
	gz_unpack_double(unpack, map, "distance_mm", 0, DBL_MAX, &display->distance_mm);
}

static void take_correction(struct gz_unpack *unpack, struct gz_status *status)
{
	const msgpack_object *map = gz_unpack_map(unpack, unpack->map, "correction");
	gz_unpack_doubles(unpack, map, "x", status->correction.x, 3);
	gz_unpack_doubles(unpack, map, "y", status->correction.y, 3);
}

static void take_recording(struct gz_unpack *unpack, struct gz_status *status)
{
	const msgpack_object *map = gz_unpack_map(unpack, unpack->map, "recording");
	gz_unpack_text(unpack, map, "file", status->recording.file, sizeof status->recording.file);
	gz_unpack_text(unpack, map, "error", status->recording.error,
		       sizeof status->recording.error);
	gz_unpack_uint64(unpack, map, "samples", &status->recording.samples);
	int state = gz_unpack_name(unpack, map, "state", recording_state_name,
				   GZ_RECORDING_STATE_COUNT);
	if (state >= 0)
		status->recording.state = (enum gz_recording_state)state;
}

enum gz_result gz_wire_decode_status(const void *bytes, size_t size, struct gz_status *out_status)
{
	struct gz_status status = {
		.noise_deg = NAN,
		.correction = { .x = { 0, 1, 0 }, .y = { 0, 0, 1 } },
	};
	uint64_t subscribers = 0;
	struct gz_unpack unpack;
	gz_unpack_begin(&unpack, bytes, size);
	take_tracker(&unpack, &status);
	take_counts(&unpack, &status);
	take_clock(&unpack, &status.clock);
	gz_unpack_double(&unpack, unpack.map, "noise_deg", 0, DBL_MAX, &status.noise_deg);
	take_display(&unpack, &status.display);
	take_correction(&unpack, &status);
	take_recording(&unpack, &status);
	gz_unpack_uint64(&unpack, unpack.map, "subscribers", &subscribers);
	if (subscribers > UINT32_MAX)
		unpack.refused = true;
	status.subscribers = (uint32_t)subscribers;
	gz_unpack_text(&unpack, unpack.map, "version", status.version, sizeof status.version);

	enum gz_result result = gz_unpack_end(&unpack);
	if (result == GZ_OK)
		*out_status = status;
	return result;
}
