#include "protocol/wire.h"

#include <math.h>
#include <stdio.h>

#include "base/clock.h"
#include "protocol/wire_values.h"

static bool is_on_surface(struct gz_point point)
{
	return point.x >= 0 && point.x <= 1 && point.y >= 0 && point.y <= 1;
}

/* What a surface message says about a gaze or a fixation, as Pupil's surface.py forms it: the topic
 * with a suffix, and under base_data the topic and time of the original. */
struct mapped {
	const char *topic;
	struct gz_point point;
	float confidence;
	int64_t time_ns;
};

static void pack_mapped(struct gz_pack *pack, const struct mapped *mapped)
{
	/* Made for each sample, for which printing would take too long. */
	char topic[64];
	stpcpy(stpcpy(topic, mapped->topic), "_on_surface");
	gz_pack_text(pack, "topic", topic);
	gz_pack_norm_pos(pack, mapped->point);
	gz_pack_float(pack, "confidence", mapped->confidence);
	gz_pack_bool(pack, "on_surf", is_on_surface(mapped->point));
	gz_pack_array(pack, "base_data", 2);
	gz_pack_text(pack, NULL, mapped->topic);
	gz_pack_time(pack, NULL, mapped->time_ns);
	gz_pack_time(pack, "timestamp", mapped->time_ns);
}

static void pack_mapped_fixation(struct gz_pack *pack, const struct gz_fixation *fixation)
{
	gz_pack_map(pack, NULL, 9);
	pack_mapped(pack, &(struct mapped) { GZ_TOPIC_FIXATIONS, fixation->point,
					     fixation->confidence, fixation->onset_ns });
	gz_pack_uint(pack, "id", fixation->id);
	gz_pack_double(pack, "duration", gz_ns_to_ms(fixation->duration_ns));
	gz_pack_float(pack, "dispersion", fixation->dispersion_deg);
}

enum gz_result gz_wire_encode_surface(const struct gz_gaze *gaze,
				      const struct gz_fixation *fixations, size_t fixation_count,
				      const char *surface_name, struct gz_wire_message *out_message)
{
	char surface_topic[sizeof GZ_TOPIC_SURFACES + GZ_NAME_SIZE];
	memcpy(surface_topic, GZ_TOPIC_SURFACES, sizeof GZ_TOPIC_SURFACES);
	strncat(surface_topic, surface_name, GZ_NAME_SIZE - 1);

	struct gz_pack pack;
	gz_pack_begin(&pack, out_message);
	gz_pack_map(&pack, NULL, 5);
	gz_pack_text(&pack, "topic", surface_topic);
	gz_pack_text(&pack, "name", surface_name);
	gz_pack_time(&pack, "timestamp", gaze->host_ns);
	gz_pack_array(&pack, "gaze_on_surfaces", 1);
	gz_pack_map(&pack, NULL, 6);
	pack_mapped(&pack, &(struct mapped) { gz_wire_gaze_topic(gaze), gaze->point,
					      gaze->confidence, gaze->host_ns });
	gz_pack_array(&pack, "fixations_on_surfaces", fixation_count);
	for (size_t i = 0; i < fixation_count; i++)
		pack_mapped_fixation(&pack, &fixations[i]);
	return gz_pack_end(&pack);
}

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
	gz_pack_map(&pack, NULL, 6);
	gz_pack_time(&pack, "timestamp", saccade->start_ns);
	gz_pack_double(&pack, "duration", gz_ns_to_ms(saccade->duration_ns));
	gz_pack_float(&pack, "amplitude_deg", saccade->amplitude_deg);
	gz_pack_float(&pack, "peak_velocity_deg_s", saccade->peak_velocity_deg_s);
	gz_pack_point(&pack, "start", saccade->start);
	gz_pack_point(&pack, "end", saccade->end);
	return gz_pack_end(&pack);
}

static void pack_tracker_status(struct gz_pack *pack, const struct gz_status *status)
{
	gz_pack_map(pack, "tracker", 4);
	gz_pack_text(pack, "name", status->tracker.name);
	gz_pack_text(pack, "serial", status->tracker.serial);
	gz_pack_text(pack, "state", gz_tracker_state_name(status->tracker.state));
	gz_pack_text(pack, "reason", status->tracker.reason);
}

static void pack_sample_counts(struct gz_pack *pack, const struct gz_status *status)
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
	gz_pack_map(pack, "refused", GZ_REFUSAL_COUNT);
	for (int i = 0; i < GZ_REFUSAL_COUNT; i++)
		gz_pack_uint(pack, gz_refusal_name((enum gz_refusal)i), status->refused[i]);
}

static void pack_clock_status(struct gz_pack *pack, const struct gz_clock_status *clock)
{
	gz_pack_map(pack, "clock", 4);
	gz_pack_int(pack, "offset_ns", clock->offset_ns);
	gz_pack_double(pack, "skew_ppm", clock->skew_ppm);
	gz_pack_double(pack, "sigma_ns", clock->sigma_ns);
	gz_pack_text(pack, "tick", gz_clock_tick_name(clock->tick));
}

static void pack_display_geometry(struct gz_pack *pack, const struct gz_display *display)
{
	gz_pack_map(pack, "display", 3);
	gz_pack_array(pack, "px", 2);
	gz_pack_int(pack, NULL, display->px[0]);
	gz_pack_int(pack, NULL, display->px[1]);
	gz_pack_doubles(pack, "mm", display->mm, 2);
	gz_pack_double(pack, "distance_mm", display->distance_mm);
}

static void pack_gaze_correction(struct gz_pack *pack, const struct gz_status *status)
{
	gz_pack_map(pack, "correction", 2);
	gz_pack_doubles(pack, "x", status->correction.x, 3);
	gz_pack_doubles(pack, "y", status->correction.y, 3);
}

static void pack_validation(struct gz_pack *pack, const struct gz_status *status)
{
	gz_pack_map(pack, "validation", 3);
	gz_pack_text(pack, "measured", status->validation.measured);
	gz_pack_double(pack, "accuracy_deg", status->validation.accuracy_deg);
	gz_pack_text(pack, "changed", status->validation.changed);
}

static void pack_recording_status(struct gz_pack *pack, const struct gz_status *status)
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
	gz_pack_map(&pack, NULL, 16);
	pack_tracker_status(&pack, status);
	/* rate_hz, samples, lost, rejected, malformed, refused */
	pack_sample_counts(&pack, status);
	pack_clock_status(&pack, &status->clock);
	gz_pack_double(&pack, "noise_deg", status->noise_deg);
	gz_pack_bool(&pack, "still_scene", status->still_scene);
	pack_display_geometry(&pack, &status->display);
	pack_gaze_correction(&pack, status);
	pack_validation(&pack, status);
	pack_recording_status(&pack, status);
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

static void pack_optional_time(struct gz_pack *pack, bool has_time, int64_t time_ns)
{
	if (has_time)
		gz_pack_time(pack, "timestamp", time_ns);
	else
		gz_pack_nil(pack, "timestamp");
}

enum gz_result gz_wire_encode_pointer(const struct gz_viewer_pointer *pointer,
				      struct gz_wire_message *out_message)
{
	struct gz_pack pack;
	gz_pack_begin(&pack, out_message);
	gz_pack_map(&pack, NULL, 2);
	if (pointer->known)
		gz_pack_point(&pack, "point", pointer->point);
	else
		gz_pack_nil(&pack, "point");
	pack_optional_time(&pack, pointer->has_time, pointer->time_ns);
	return gz_pack_end(&pack);
}

static void pack_monitor_place(struct gz_pack *pack, const struct gz_monitor_place *monitor)
{
	gz_pack_array(pack, "monitor", 4);
	for (int i = 0; i < 2; i++)
		gz_pack_int(pack, NULL, monitor->at[i]);
	for (int i = 0; i < 2; i++)
		gz_pack_int(pack, NULL, monitor->px[i]);
	gz_pack_double(pack, "scale", monitor->scale);
}

enum gz_result gz_wire_encode_window(const struct gz_viewer_window *window,
				     struct gz_wire_message *out_message)
{
	struct gz_pack pack;
	bool has_monitor = window->monitor.px[0] > 0;
	gz_pack_begin(&pack, out_message);
	gz_pack_map(&pack, NULL, 2 + (has_monitor ? 2U : 0U) + (window->has_still ? 1U : 0U));
	if (window->known) {
		gz_pack_array(&pack, "rect", 4);
		for (int i = 0; i < 4; i++)
			gz_pack_int(&pack, NULL, window->rect_px[i]);
	} else {
		gz_pack_nil(&pack, "rect");
	}
	pack_optional_time(&pack, window->has_time, window->time_ns);
	if (has_monitor)
		pack_monitor_place(&pack, &window->monitor);
	if (window->has_still)
		gz_pack_bool(&pack, "still", window->still_scene);
	return gz_pack_end(&pack);
}

/* Begin a map of @p other_pairs pairs after "topic" and "subject", which every notification has. */
static void begin_notification(struct gz_pack *pack, struct gz_wire_message *message,
			       const char *subject, size_t other_pairs)
{
	char topic[GZ_SUBJECT_SIZE + sizeof GZ_TOPIC_NOTIFY];
	snprintf(topic, sizeof topic, GZ_TOPIC_NOTIFY "%s", subject);
	gz_pack_begin(pack, message);
	gz_pack_map(pack, NULL, 2 + other_pairs);
	gz_pack_text(pack, "topic", topic);
	gz_pack_text(pack, "subject", subject);
}

enum gz_result gz_wire_encode_recording_started(const char *path, const char *session_name,
						int64_t start_ns,
						struct gz_wire_message *out_message)
{
	struct gz_pack pack;
	begin_notification(&pack, out_message, GZ_SUBJECT_RECORDING_STARTED, 5);
	gz_pack_text(&pack, "rec_path", path);
	gz_pack_text(&pack, "session_name", session_name);
	gz_pack_bool(&pack, "record_eye", false);
	gz_pack_bool(&pack, "compression", false);
	gz_pack_time(&pack, "start_time_synced", start_ns);
	return gz_pack_end(&pack);
}

enum gz_result gz_wire_encode_recording_stopped(const char *path,
						struct gz_wire_message *out_message)
{
	struct gz_pack pack;
	begin_notification(&pack, out_message, GZ_SUBJECT_RECORDING_STOPPED, 1);
	gz_pack_text(&pack, "rec_path", path);
	return gz_pack_end(&pack);
}

enum gz_result gz_wire_encode_calibration_failed(const char *reason, int64_t time_ns,
						 struct gz_wire_message *out_message)
{
	struct gz_pack pack;
	begin_notification(&pack, out_message, GZ_SUBJECT_CALIBRATION_FAILED, 3);
	gz_pack_text(&pack, "reason", reason);
	gz_pack_time(&pack, "timestamp", time_ns);
	gz_pack_bool(&pack, "record", true);
	return gz_pack_end(&pack);
}

enum gz_result gz_wire_encode_doc(const char *actor, const char *doc,
				  struct gz_wire_message *out_message)
{
	struct gz_pack pack;
	begin_notification(&pack, out_message, GZ_SUBJECT_DOC, 2);
	gz_pack_text(&pack, "actor", actor);
	gz_pack_text(&pack, "doc", doc);
	return gz_pack_end(&pack);
}
