#include "protocol/wire.h"

#include <math.h>
#include <stdio.h>

#include "base/clock.h"
#include "protocol/wire_values.h"

/* Radius of the eyeball in Pupil's 3D eye model (pye3d): sqrt(108) mm. */
static const double EYE_RADIUS_MM = 10.392304845413264;

/* Units of "diameter" per mm. In Pupil the unit is the pixel of the eye image, which trackers
 * without images do not have. */
static const float DIAMETER_PER_MM = 10;

/* The eyes that a message contains; both if neither was seen. */
struct eyes {
	size_t count;
	enum gz_eye index[GZ_EYE_COUNT];
};

static struct eyes participating_eyes(const struct gz_gaze *gaze)
{
	bool right = gaze->eye[GZ_EYE_RIGHT].valid;
	bool left = gaze->eye[GZ_EYE_LEFT].valid;
	if (gaze->combined || right == left)
		return (struct eyes) { 2, { GZ_EYE_RIGHT, GZ_EYE_LEFT } };
	return (struct eyes) { 1, { right ? GZ_EYE_RIGHT : GZ_EYE_LEFT } };
}

const char *gz_wire_gaze_topic(const struct gz_gaze *gaze)
{
	struct eyes eyes = participating_eyes(gaze);
	if (eyes.count == 2)
		return GZ_TOPIC_GAZE_BOTH;
	return eyes.index[0] == GZ_EYE_RIGHT ? GZ_TOPIC_GAZE_RIGHT : GZ_TOPIC_GAZE_LEFT;
}

static bool is_finite_vector(const float values[3])
{
	return isfinite(values[0]) && isfinite(values[1]) && isfinite(values[2]);
}

/* The position of the eye in the tracker's coordinates. If the tracker does not give it, an eye
 * straight in front of the display at the configured distance replaces it, with confidence 0. */
static void pack_sphere(struct gz_pack *pack, const struct gz_gaze_eye *eye, float confidence,
			const struct gz_display *display)
{
	bool measured = is_finite_vector(eye->origin_mm);
	double centre[3] = { 0, 0, display->distance_mm };
	for (int i = 0; measured && i < 3; i++)
		centre[i] = (double)eye->origin_mm[i];
	gz_pack_map(pack, "sphere", 3);
	gz_pack_doubles(pack, "center", centre, 3);
	gz_pack_double(pack, "radius", EYE_RADIUS_MM);
	gz_pack_float(pack, "confidence", measured ? confidence : 0);
}

/* The direction from the eye to a point of the display, in the coordinates of gaze_point_3d. The
 * angles are those of pye3d: theta from +y (down); phi in the plane perpendicular to it, from +x
 * (right) towards +z (ahead). */
static void pack_direction(struct gz_pack *pack, struct gz_point point,
			   const struct gz_display *display)
{
	double mm[3];
	gz_display_to_mm(display, point, mm);
	double length = sqrt(mm[0] * mm[0] + mm[1] * mm[1] + mm[2] * mm[2]);
	gz_pack_double(pack, "phi", atan2(mm[2], mm[0]));
	gz_pack_double(pack, "theta", acos(mm[1] / length));
}

/* Pupil's readers compare confidences, so this is always a number: 0 if nothing is known. */
static float eye_confidence(const struct gz_gaze *gaze, const struct gz_gaze_eye *eye)
{
	if (!isnan(eye->confidence))
		return eye->confidence;
	return eye->valid || gaze->combined ? gaze->confidence : 0;
}

/* Pupil's readers expect a norm_pos: an eye that has no point of its own gets the common one. */
static struct gz_point eye_point(const struct gz_gaze *gaze, const struct gz_gaze_eye *eye)
{
	bool measured = isfinite(eye->point.x) && isfinite(eye->point.y);
	return measured ? eye->point : gaze->point;
}

static void pack_pupil_map(struct gz_pack *pack, const struct gz_gaze *gaze, enum gz_eye index,
			   const struct gz_display *display)
{
	const struct gz_gaze_eye *eye = &gaze->eye[index];
	float confidence = eye_confidence(gaze, eye);
	struct gz_point point = eye_point(gaze, eye);
	size_t begin = pack->message->size;
	gz_pack_map(pack, NULL, 11);
	gz_pack_text(pack, "topic",
		     index == GZ_EYE_RIGHT ? GZ_TOPIC_PUPIL_RIGHT : GZ_TOPIC_PUPIL_LEFT);
	gz_pack_int(pack, "id", index);
	gz_pack_norm_pos(pack, point);
	gz_pack_float(pack, "diameter", eye->pupil_mm * DIAMETER_PER_MM);
	gz_pack_float(pack, "diameter_3d", eye->pupil_mm);
	pack_direction(pack, point, display);
	pack_sphere(pack, eye, confidence, display);
	gz_pack_float(pack, "confidence", confidence);
	gz_pack_time(pack, "timestamp", gaze->host_ns);
	gz_pack_text(pack, "method", GZ_WIRE_METHOD);
	pack->message->pupil[index].at = begin;
	pack->message->pupil[index].size = pack->message->size - begin;
}

/* Whether the tracker gave the position and direction of every eye of the message. Pupil's readers
 * take one only together with the other. */
static bool has_lines_of_sight(const struct gz_gaze *gaze, const struct eyes *eyes)
{
	for (size_t i = 0; i < eyes->count; i++) {
		const struct gz_gaze_eye *eye = &gaze->eye[eyes->index[i]];
		if (!is_finite_vector(eye->origin_mm) || !is_finite_vector(eye->direction))
			return false;
	}
	return true;
}

static void pack_vector(struct gz_pack *pack, const char *key, const float vector[3])
{
	gz_pack_array(pack, key, 3);
	for (int i = 0; i < 3; i++)
		gz_pack_float(pack, NULL, vector[i]);
}

/* Centres and directions of the eyes, in the tracker's coordinates. The keys and their forms are
 * those of Pupil Core 3 (gaze_mapping/gazer_3d/gazer_headset.py): by the eye's number as text, or
 * of one eye alone. */
static void pack_lines_of_sight(struct gz_pack *pack, const struct gz_gaze *gaze,
				const struct eyes *eyes)
{
	const struct gz_gaze_eye *right = &gaze->eye[GZ_EYE_RIGHT];
	const struct gz_gaze_eye *left = &gaze->eye[GZ_EYE_LEFT];
	if (eyes->count == 1) {
		const struct gz_gaze_eye *eye = &gaze->eye[eyes->index[0]];
		pack_vector(pack, "eye_center_3d", eye->origin_mm);
		pack_vector(pack, "gaze_normal_3d", eye->direction);
		return;
	}
	gz_pack_map(pack, "eye_centers_3d", 2);
	pack_vector(pack, "0", right->origin_mm);
	pack_vector(pack, "1", left->origin_mm);
	gz_pack_map(pack, "gaze_normals_3d", 2);
	pack_vector(pack, "0", right->direction);
	pack_vector(pack, "1", left->direction);
}

/* The keys of Pupil's gaze map. */
static void pack_pupil_core_keys(struct gz_pack *pack, const struct gz_gaze *gaze,
				 const struct gz_display *display)
{
	double mm[3];
	gz_display_to_mm(display, gaze->point, mm);
	struct eyes eyes = participating_eyes(gaze);
	gz_pack_text(pack, "topic", gz_wire_gaze_topic(gaze));
	gz_pack_norm_pos(pack, gaze->point);
	gz_pack_float(pack, "confidence", gaze->confidence);
	gz_pack_time(pack, "timestamp", gaze->host_ns);
	gz_pack_doubles(pack, "gaze_point_3d", mm, 3);
	if (has_lines_of_sight(gaze, &eyes))
		pack_lines_of_sight(pack, gaze, &eyes);
	gz_pack_array(pack, "base_data", eyes.count);
	for (size_t i = 0; i < eyes.count; i++)
		pack_pupil_map(pack, gaze, eyes.index[i], display);
}

static void pack_eye_map(struct gz_pack *pack, const char *key, const struct gz_gaze_eye *eye)
{
	gz_pack_map(pack, key, 3);
	gz_pack_point(pack, "point", eye->point);
	gz_pack_float(pack, "pupil_mm", eye->pupil_mm);
	gz_pack_bool(pack, "valid", eye->valid);
}

static void pack_event_final(struct gz_pack *pack, const struct gz_gaze *gaze)
{
	gz_pack_map(pack, "event_final", gaze->final_span > 0 ? 3 : 2);
	gz_pack_uint(pack, "seq", gaze->final_seq);
	gz_pack_text(pack, "event", gz_event_name(gaze->final_event));
	if (gaze->final_span > 0)
		gz_pack_uint(pack, "first", gaze->final_seq - gaze->final_span);
}

static void pack_landing(struct gz_pack *pack, const struct gz_landing *landing)
{
	gz_pack_map(pack, "landing", 3);
	gz_pack_point(pack, "point", landing->point);
	gz_pack_time(pack, "timestamp", landing->time_ns);
	gz_pack_float(pack, "sigma_deg", landing->sigma_deg);
}

/* The keys of this project. publish_ns is last and has a fixed width, as wire.h promises. */
static void pack_own_keys(struct gz_pack *pack, const struct gz_gaze *gaze)
{
	gz_pack_point(pack, "point", gaze->point);
	gz_pack_point(pack, "raw", gaze->raw);
	gz_pack_text(pack, "event", gz_event_name(gaze->event));
	if (gaze->final_known)
		pack_event_final(pack, gaze);
	gz_pack_float(pack, "velocity_deg_s", gaze->velocity_deg_s);
	if (gaze->landing.known)
		pack_landing(pack, &gaze->landing);
	gz_pack_uint(pack, "seq", gaze->seq);
	if (gaze->device_ns == GZ_NO_DEVICE_TIME)
		gz_pack_nil(pack, "device_ns");
	else
		gz_pack_int(pack, "device_ns", gaze->device_ns);
	gz_pack_int(pack, "host_ns", gaze->host_ns);
	pack_eye_map(pack, "eye0", &gaze->eye[GZ_EYE_RIGHT]);
	pack_eye_map(pack, "eye1", &gaze->eye[GZ_EYE_LEFT]);
	gz_pack_bool(pack, "combined", gaze->combined);
	gz_pack_fixed_int64(pack, "publish_ns", gaze->publish_ns);
}

enum gz_result gz_wire_encode_gaze(const struct gz_gaze *gaze, const struct gz_display *display,
				   struct gz_wire_message *out_message)
{
	struct gz_pack pack;
	gz_pack_begin(&pack, out_message);
	const struct eyes eyes = participating_eyes(gaze);
	size_t keys = 17;
	keys += gaze->final_known ? 1 : 0;
	keys += has_lines_of_sight(gaze, &eyes) ? 2 : 0;
	keys += gaze->landing.known ? 1 : 0;
	gz_pack_map(&pack, NULL, keys);
	pack_pupil_core_keys(&pack, gaze, display);
	pack_own_keys(&pack, gaze);
	return gz_pack_end(&pack);
}

enum gz_result gz_wire_encode_event_final(const struct gz_gaze *gaze,
					  struct gz_wire_message *out_message)
{
	struct gz_pack pack;
	gz_pack_begin(&pack, out_message);
	gz_pack_map(&pack, NULL, 3);
	gz_pack_text(&pack, "topic", GZ_TOPIC_EVENT_FINAL);
	gz_pack_time(&pack, "timestamp", gaze->host_ns);
	pack_event_final(&pack, gaze);
	return gz_pack_end(&pack);
}

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
