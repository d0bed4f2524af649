#include "base/clock.h"
#include "protocol/wire.h"
#include "protocol/wire_pack.h"

enum gz_result gz_wire_encode_fixation(const struct gz_fixation *fixation,
				       struct gz_wire_message *out_message)
{
	struct gz_pack pack;
	gz_pack_begin(&pack, out_message);
	gz_pack_map(&pack, NULL, 11);
	gz_pack_text(&pack, "topic", GZ_TOPIC_FIXATIONS);
	gz_pack_uint(&pack, "id", fixation->id);
	gz_pack_time(&pack, "timestamp", fixation->onset_ns);
	gz_pack_double(&pack, "duration", gz_ns_to_ms(fixation->duration_ns));
	gz_pack_float(&pack, "dispersion", fixation->dispersion_deg);
	gz_pack_norm_pos(&pack, fixation->point);
	gz_pack_float(&pack, "confidence", fixation->confidence);
	gz_pack_text(&pack, "method", GZ_WIRE_METHOD);
	gz_pack_array(&pack, "base_data", 0);
	gz_pack_point(&pack, "point", fixation->point);
	gz_pack_bool(&pack, "final", fixation->final);
	return gz_pack_end(&pack);
}

enum gz_result gz_wire_encode_blink(const struct gz_blink *blink,
				    struct gz_wire_message *out_message)
{
	struct gz_pack pack;
	gz_pack_begin(&pack, out_message);
	gz_pack_map(&pack, NULL, 5);
	gz_pack_text(&pack, "topic", GZ_TOPIC_BLINKS);
	gz_pack_array(&pack, "base_data", 0);
	gz_pack_text(&pack, "type", blink->onset ? "onset" : "offset");
	gz_pack_time(&pack, "timestamp", blink->time_ns);
	gz_pack_float(&pack, "confidence", blink->confidence);
	return gz_pack_end(&pack);
}

enum gz_result gz_wire_encode_saccade(const struct gz_saccade *saccade,
				      struct gz_wire_message *out_message)
{
	struct gz_pack pack;
	gz_pack_begin(&pack, out_message);
	gz_pack_map(&pack, NULL, saccade->has_prediction ? 8 : 6);
	gz_pack_time(&pack, "timestamp", saccade->start_ns);
	gz_pack_double(&pack, "duration", gz_ns_to_ms(saccade->duration_ns));
	gz_pack_float(&pack, "amplitude_deg", saccade->amplitude_deg);
	gz_pack_float(&pack, "peak_velocity_deg_s", saccade->peak_velocity_deg_s);
	gz_pack_point(&pack, "start", saccade->start);
	gz_pack_point(&pack, "end", saccade->end);
	if (saccade->has_prediction) {
		gz_pack_point(&pack, "predicted_end", saccade->predicted_end);
		gz_pack_float(&pack, "sigma_deg", saccade->sigma_deg);
	}
	return gz_pack_end(&pack);
}

static void pack_tracker(struct gz_pack *pack, const struct gz_status *status)
{
	gz_pack_map(pack, "tracker", 4);
	gz_pack_text(pack, "name", status->tracker.name);
	gz_pack_text(pack, "serial", status->tracker.serial);
	gz_pack_text(pack, "state", gz_tracker_state_name(status->tracker.state));
	gz_pack_text(pack, "reason", status->tracker.reason);
}

static void pack_counts(struct gz_pack *pack, const struct gz_status *status)
{
	gz_pack_map(pack, "rate_hz", 2);
	gz_pack_double(pack, "nominal", status->rate_hz_nominal);
	gz_pack_double(pack, "measured", status->rate_hz_measured);
	gz_pack_uint(pack, "samples", status->samples);
	gz_pack_uint(pack, "lost", status->lost);
	gz_pack_map(pack, "rejected", GZ_REJECT_COUNT - 1);
	for (int i = GZ_REJECT_NONE + 1; i < GZ_REJECT_COUNT; i++)
		gz_pack_uint(pack, gz_rejection_name((enum gz_rejection)i), status->rejected[i]);
	gz_pack_map(pack, "malformed", GZ_MALFORMED_COUNT);
	for (int i = 0; i < GZ_MALFORMED_COUNT; i++)
		gz_pack_uint(pack, gz_malformed_name((enum gz_malformed)i), status->malformed[i]);
}

static void pack_clock(struct gz_pack *pack, const struct gz_clock_status *clock)
{
	gz_pack_map(pack, "clock", 4);
	gz_pack_int(pack, "offset_ns", clock->offset_ns);
	gz_pack_double(pack, "skew_ppm", clock->skew_ppm);
	gz_pack_double(pack, "sigma_ns", clock->sigma_ns);
	gz_pack_text(pack, "tick", gz_clock_tick_name(clock->tick));
}

static void pack_display(struct gz_pack *pack, const struct gz_display *display)
{
	gz_pack_map(pack, "display", 3);
	gz_pack_array(pack, "px", 2);
	gz_pack_int(pack, NULL, display->px[0]);
	gz_pack_int(pack, NULL, display->px[1]);
	gz_pack_doubles(pack, "mm", display->mm, 2);
	gz_pack_double(pack, "distance_mm", display->distance_mm);
}

static void pack_correction(struct gz_pack *pack, const struct gz_status *status)
{
	gz_pack_map(pack, "correction", 2);
	gz_pack_doubles(pack, "x", status->correction.x, 3);
	gz_pack_doubles(pack, "y", status->correction.y, 3);
}

static void pack_recording(struct gz_pack *pack, const struct gz_status *status)
{
	gz_pack_map(pack, "recording", 4);
	gz_pack_text(pack, "state", gz_recording_state_name(status->recording.state));
	gz_pack_text(pack, "file", status->recording.file);
	gz_pack_uint(pack, "samples", status->recording.samples);
	gz_pack_text(pack, "error", status->recording.error);
}

enum gz_result gz_wire_encode_status(const struct gz_status *status,
				     struct gz_wire_message *out_message)
{
	struct gz_pack pack;
	gz_pack_begin(&pack, out_message);
	gz_pack_map(&pack, NULL, 13);
	pack_tracker(&pack, status);
	pack_counts(&pack, status); /* rate_hz, samples, lost, rejected, malformed */
	pack_clock(&pack, &status->clock);
	gz_pack_double(&pack, "noise_deg", status->noise_deg);
	pack_display(&pack, &status->display);
	pack_correction(&pack, status);
	pack_recording(&pack, status);
	gz_pack_uint(&pack, "subscribers", status->subscribers);
	gz_pack_text(&pack, "version", status->version);
	return gz_pack_end(&pack);
}

enum gz_result gz_wire_encode_annotation(const struct gz_annotation *annotation,
					 struct gz_wire_message *out_message)
{
	struct gz_pack pack;
	gz_pack_begin(&pack, out_message);
	gz_pack_map(&pack, NULL, annotation->has_time ? 4 : 3);
	gz_pack_text(&pack, "topic", GZ_TOPIC_ANNOTATION);
	gz_pack_text(&pack, "label", annotation->label);
	if (annotation->has_time)
		gz_pack_time(&pack, "timestamp", annotation->time_ns);
	gz_pack_double(&pack, "duration", gz_ns_to_s(annotation->duration_ns));
	return gz_pack_end(&pack);
}
