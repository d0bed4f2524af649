#include "protocol/wire.h"

#include <float.h>
#include <math.h>

#include "base/clock.h"
#include "protocol/wire_json.h"
#include "protocol/wire_values.h"

static const char *event_name(int event)
{
	return gz_event_name((enum gz_event)event);
}

static bool take_gaze_event(struct gz_unpack *unpack, const msgpack_object *map, enum gz_event *out)
{
	int event = gz_unpack_name(unpack, map, "event", event_name, GZ_EVENT_COUNT);
	if (event < 0)
		return false;
	*out = (enum gz_event)event;
	return true;
}

static void take_final_event(struct gz_unpack *unpack, struct gz_gaze *gaze)
{
	const msgpack_object *map = gz_unpack_map(unpack, unpack->map, "event_final");
	/* Later versions may know more labels. Without them the sample is as good as ever. */
	if (!map || gz_unpack_name_is_strange(map, "event", event_name, GZ_EVENT_COUNT))
		return;
	gaze->final_known =
		take_gaze_event(unpack, map, &gaze->final_event) && gz_unpack_find(map, "seq");
	gz_unpack_uint64(unpack, map, "seq", &gaze->final_seq);
	if (!gaze->final_known) /* one key without the other */
		unpack->refused = true;
	uint64_t first = gaze->final_seq;
	gz_unpack_uint64(unpack, map, "first", &first);
	if (first > gaze->final_seq)
		unpack->refused = true;
	else
		gaze->final_span = gaze->final_seq - first;
}

static const double ANGLE_MAX_DEG = 360;

/* All of it or none. */
static void take_landing(struct gz_unpack *unpack, struct gz_landing *landing)
{
	const msgpack_object *map = gz_unpack_map(unpack, unpack->map, "landing");
	if (!map)
		return;
	landing->known = gz_unpack_point(unpack, map, "point", &landing->point) &&
			 gz_unpack_time(unpack, map, "timestamp", GZ_NS_PER_S, &landing->time_ns) &&
			 gz_unpack_find(map, "sigma_deg");
	gz_unpack_float(unpack, map, "sigma_deg", 0, ANGLE_MAX_DEG, &landing->sigma_deg);
	if (!landing->known)
		unpack->refused = true;
}

/* This project's map of an eye. @return whether it is there */
static bool take_own_eye(struct gz_unpack *unpack, const char *key, struct gz_gaze_eye *eye)
{
	const msgpack_object *map = gz_unpack_map(unpack, unpack->map, key);
	gz_unpack_point(unpack, map, "point", &eye->point);
	gz_unpack_float(unpack, map, "pupil_mm", 0, FLT_MAX, &eye->pupil_mm);
	gz_unpack_bool(unpack, map, "valid", &eye->valid);
	return map != NULL;
}

/* A position with confidence 0 was not measured: it is the viewing distance. Pupil's position is in
 * the coordinates of its eye camera and has no confidence of its own. */
static void take_eye_position(struct gz_unpack *unpack, const msgpack_object *pupil,
			      struct gz_gaze_eye *eye)
{
	const msgpack_object *sphere = gz_unpack_map(unpack, pupil, "sphere");
	double centre[3], confidence = 0;
	gz_unpack_double(unpack, sphere, "confidence", 0, 1, &confidence);
	if (confidence > 0 && gz_unpack_doubles(unpack, sphere, "center", centre, 3))
		for (int i = 0; i < 3; i++)
			eye->origin_mm[i] = (float)centre[i];
}

/* Take what only the pupil map has. If the message is not from this project, a pupil map also means
 * that the eye is valid. */
static void take_pupil_map(struct gz_unpack *unpack, const msgpack_object *pupil,
			   const bool ours[GZ_EYE_COUNT], struct gz_gaze *gaze)
{
	int64_t id = -1;
	gz_unpack_int64(unpack, pupil, "id", &id);
	if (id != GZ_EYE_RIGHT && id != GZ_EYE_LEFT)
		return;
	struct gz_gaze_eye *eye = &gaze->eye[id];
	gz_unpack_float(unpack, pupil, "confidence", 0, 1, &eye->confidence);
	take_eye_position(unpack, pupil, eye);
	if (ours[id])
		return;
	eye->valid = true;
	gz_unpack_float(unpack, pupil, "diameter_3d", 0, FLT_MAX, &eye->pupil_mm);
}

/* Take Pupil Capture's position and direction of each eye, in the coordinates of its scene camera.
 * They are beside base_data: by the eye's number if both eyes took part, directly in the map if one
 * did. A direction of length 0 is ignored. */
static void take_eye_vectors(struct gz_unpack *unpack, struct gz_gaze *gaze)
{
	static const char *const number[GZ_EYE_COUNT] = { "0", "1" };
	const msgpack_object *map = unpack->map;
	const msgpack_object *centers = gz_unpack_map(unpack, map, "eye_centers_3d");
	const msgpack_object *normals = gz_unpack_map(unpack, map, "gaze_normals_3d");
	for (int i = 0; i < GZ_EYE_COUNT; i++) {
		struct gz_gaze_eye *eye = &gaze->eye[i];
		bool alone = eye->valid && !gaze->eye[1 - i].valid;
		double origin[3], normal[3];
		if (gz_unpack_doubles(unpack, alone ? map : centers,
				      alone ? "eye_center_3d" : number[i], origin, 3))
			for (int k = 0; k < 3; k++)
				eye->origin_mm[k] = (float)origin[k];
		if (!gz_unpack_doubles(unpack, alone ? map : normals,
				       alone ? "gaze_normal_3d" : number[i], normal, 3))
			continue;
		double length =
			sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
		for (int k = 0; k < 3 && length > 0 && isfinite(length); k++)
			eye->direction[k] = (float)(normal[k] / length);
	}
}

static void take_gaze_eyes(struct gz_unpack *unpack, struct gz_gaze *gaze)
{
	bool ours[GZ_EYE_COUNT] = {
		[GZ_EYE_RIGHT] = take_own_eye(unpack, "eye0", &gaze->eye[GZ_EYE_RIGHT]),
		[GZ_EYE_LEFT] = take_own_eye(unpack, "eye1", &gaze->eye[GZ_EYE_LEFT]),
	};
	const msgpack_object *pupils = gz_unpack_array(unpack, unpack->map, "base_data");
	for (uint32_t i = 0; pupils && i < pupils->via.array.size; i++) {
		const msgpack_object *pupil = &pupils->via.array.ptr[i];
		if (pupil->type ==
		    MSGPACK_OBJECT_MAP) /* otherwise a reference, as in surface maps */
			take_pupil_map(unpack, pupil, ours, gaze);
	}
	take_eye_vectors(unpack, gaze);
}

/* Take this project's keys, or Pupil's if they are missing. A gaze needs a place and a time. */
static void take_place_and_time(struct gz_unpack *unpack, struct gz_gaze *gaze)
{
	const msgpack_object *map = unpack->map;
	bool placed = gz_unpack_norm_pos(unpack, map, &gaze->point);
	placed |= gz_unpack_point(unpack, map, "point", &gaze->point);
	bool timed = gz_unpack_time(unpack, map, "timestamp", GZ_NS_PER_S, &gaze->host_ns);
	timed |= gz_unpack_find(map, "host_ns") != NULL;
	gz_unpack_int64(unpack, map, "host_ns", &gaze->host_ns);
	if (!placed || !timed)
		unpack->refused = true;
}

static struct gz_gaze unmeasured_gaze(void)
{
	static const struct gz_gaze_eye eye = {
		.point = { NAN, NAN },
		.pupil_mm = NAN,
		.confidence = NAN,
		.origin_mm = { NAN, NAN, NAN },
		.direction = { NAN, NAN, NAN },
	};
	return (struct gz_gaze) {
		.device_ns = GZ_NO_DEVICE_TIME,
		.point = { NAN, NAN },
		.raw = { NAN, NAN },
		.confidence = NAN,
		.velocity_deg_s = NAN,
		.eye = { eye, eye },
	};
}

enum gz_result gz_wire_decode_gaze(const void *bytes, size_t size, struct gz_gaze *out_gaze)
{
	struct gz_gaze gaze = unmeasured_gaze();
	struct gz_unpack unpack;
	gz_unpack_begin(&unpack, bytes, size);
	const msgpack_object *map = unpack.map;
	take_place_and_time(&unpack, &gaze);
	gz_unpack_point(&unpack, map, "raw", &gaze.raw);
	gz_unpack_float(&unpack, map, "confidence", 0, 1, &gaze.confidence);
	take_gaze_event(&unpack, map, &gaze.event);
	take_final_event(&unpack, &gaze);
	gz_unpack_float(&unpack, map, "velocity_deg_s", 0, FLT_MAX, &gaze.velocity_deg_s);
	take_landing(&unpack, &gaze.landing);
	gz_unpack_uint64(&unpack, map, "seq", &gaze.seq);
	gz_unpack_int64(&unpack, map, "device_ns", &gaze.device_ns);
	gz_unpack_int64(&unpack, map, "publish_ns", &gaze.publish_ns);
	gz_unpack_bool(&unpack, map, "combined", &gaze.combined);
	take_gaze_eyes(&unpack, &gaze);

	enum gz_result result = gz_unpack_end(&unpack);
	if (result == GZ_OK)
		*out_gaze = gaze;
	return result;
}

/* Refuse the message unless a value is @p there. */
static void require_value(struct gz_unpack *unpack, bool there)
{
	if (!there)
		unpack->refused = true;
}

/* "duration", ms: 0 or more. */
static void take_duration_ms(struct gz_unpack *unpack, int64_t *out_duration_ns)
{
	gz_unpack_time(unpack, unpack->map, "duration", GZ_NS_PER_MS, out_duration_ns);
	require_value(unpack, *out_duration_ns >= 0);
}

enum gz_result gz_wire_decode_fixation(const void *bytes, size_t size,
				       struct gz_fixation *out_fixation)
{
	struct gz_fixation fixation = {
		.dispersion_deg = NAN,
		.point = { NAN, NAN },
		.confidence = NAN,
	};
	struct gz_unpack unpack;
	gz_unpack_begin(&unpack, bytes, size);
	const msgpack_object *map = unpack.map;
	gz_unpack_uint64(&unpack, map, "id", &fixation.id);
	require_value(&unpack,
		      gz_unpack_time(&unpack, map, "timestamp", GZ_NS_PER_S, &fixation.onset_ns));
	take_duration_ms(&unpack, &fixation.duration_ns);
	gz_unpack_float(&unpack, map, "dispersion", 0, ANGLE_MAX_DEG, &fixation.dispersion_deg);
	gz_unpack_float(&unpack, map, "confidence", 0, 1, &fixation.confidence);
	gz_unpack_bool(&unpack, map, "final", &fixation.final);
	gz_unpack_norm_pos(&unpack, map, &fixation.point);
	gz_unpack_point(&unpack, map, "point", &fixation.point);

	enum gz_result result = gz_unpack_end(&unpack);
	if (result == GZ_OK)
		*out_fixation = fixation;
	return result;
}

static const char *blink_name(int type)
{
	return type == 0 ? "offset" : "onset";
}

enum gz_result gz_wire_decode_blink(const void *bytes, size_t size, struct gz_blink *out_blink)
{
	struct gz_blink blink = { .confidence = NAN };
	struct gz_unpack unpack;
	gz_unpack_begin(&unpack, bytes, size);
	int type = gz_unpack_name(&unpack, unpack.map, "type", blink_name, 2);
	require_value(&unpack, type >= 0);
	blink.onset = type == 1;
	require_value(&unpack, gz_unpack_time(&unpack, unpack.map, "timestamp", GZ_NS_PER_S,
					      &blink.time_ns));
	gz_unpack_float(&unpack, unpack.map, "confidence", 0, 1, &blink.confidence);

	enum gz_result result = gz_unpack_end(&unpack);
	if (result == GZ_OK)
		*out_blink = blink;
	return result;
}

enum gz_result gz_wire_decode_saccade(const void *bytes, size_t size,
				      struct gz_saccade *out_saccade)
{
	struct gz_saccade saccade = {
		.amplitude_deg = NAN,
		.peak_velocity_deg_s = NAN,
		.start = { NAN, NAN },
		.end = { NAN, NAN },
	};
	struct gz_unpack unpack;
	gz_unpack_begin(&unpack, bytes, size);
	const msgpack_object *map = unpack.map;
	require_value(&unpack,
		      gz_unpack_time(&unpack, map, "timestamp", GZ_NS_PER_S, &saccade.start_ns));
	take_duration_ms(&unpack, &saccade.duration_ns);
	gz_unpack_float(&unpack, map, "amplitude_deg", 0, ANGLE_MAX_DEG, &saccade.amplitude_deg);
	gz_unpack_float(&unpack, map, "peak_velocity_deg_s", 0, FLT_MAX,
			&saccade.peak_velocity_deg_s);
	gz_unpack_point(&unpack, map, "start", &saccade.start);
	gz_unpack_point(&unpack, map, "end", &saccade.end);

	enum gz_result result = gz_unpack_end(&unpack);
	if (result == GZ_OK)
		*out_saccade = saccade;
	return result;
}

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

static void take_tracker_status(struct gz_unpack *unpack, struct gz_status *status)
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

static void take_sample_counts(struct gz_unpack *unpack, struct gz_status *status)
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
	const msgpack_object *refused = gz_unpack_map(unpack, unpack->map, "refused");
	for (int i = 0; i < GZ_REFUSAL_COUNT; i++)
		gz_unpack_uint64(unpack, refused, gz_refusal_name((enum gz_refusal)i),
				 &status->refused[i]);
}

static void take_clock_status(struct gz_unpack *unpack, struct gz_clock_status *clock)
{
	const msgpack_object *map = gz_unpack_map(unpack, unpack->map, "clock");
	gz_unpack_int64(unpack, map, "offset_ns", &clock->offset_ns);
	gz_unpack_double(unpack, map, "skew_ppm", -DBL_MAX, DBL_MAX, &clock->skew_ppm);
	gz_unpack_double(unpack, map, "sigma_ns", 0, DBL_MAX, &clock->sigma_ns);
	int tick = gz_unpack_name(unpack, map, "tick", clock_tick_name, GZ_CLOCK_TICK_COUNT);
	if (tick >= 0)
		clock->tick = (enum gz_clock_tick)tick;
}

static void take_display_geometry(struct gz_unpack *unpack, struct gz_display *display)
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

static void take_gaze_correction(struct gz_unpack *unpack, struct gz_status *status)
{
	const msgpack_object *map = gz_unpack_map(unpack, unpack->map, "correction");
	gz_unpack_doubles(unpack, map, "x", status->correction.x, 3);
	gz_unpack_doubles(unpack, map, "y", status->correction.y, 3);
}

static void take_validation(struct gz_unpack *unpack, struct gz_status *status)
{
	const msgpack_object *map = gz_unpack_map(unpack, unpack->map, "validation");
	gz_unpack_text(unpack, map, "measured", status->validation.measured,
		       sizeof status->validation.measured);
	gz_unpack_double(unpack, map, "accuracy_deg", 0, 360, &status->validation.accuracy_deg);
	gz_unpack_text(unpack, map, "changed", status->validation.changed,
		       sizeof status->validation.changed);
}

static void take_recording_status(struct gz_unpack *unpack, struct gz_status *status)
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
		.validation = { .accuracy_deg = NAN },
	};
	uint64_t subscribers = 0;
	struct gz_unpack unpack;
	gz_unpack_begin(&unpack, bytes, size);
	take_tracker_status(&unpack, &status);
	take_sample_counts(&unpack, &status);
	take_clock_status(&unpack, &status.clock);
	gz_unpack_double(&unpack, unpack.map, "noise_deg", 0, DBL_MAX, &status.noise_deg);
	gz_unpack_bool(&unpack, unpack.map, "still_scene", &status.still_scene);
	take_display_geometry(&unpack, &status.display);
	take_gaze_correction(&unpack, &status);
	take_validation(&unpack, &status);
	take_recording_status(&unpack, &status);
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

/* An entry needs a place and a time. */
static void take_surface_entry(struct gz_unpack *unpack, const msgpack_object *map,
			       struct gz_surface_gaze *out)
{
	*out = (struct gz_surface_gaze) { .confidence = NAN };
	gz_unpack_bool(unpack, map, "on_surf", &out->on_surface);
	gz_unpack_float(unpack, map, "confidence", 0, 1, &out->confidence);
	if (!gz_unpack_norm_pos(unpack, map, &out->point) ||
	    !gz_unpack_time(unpack, map, "timestamp", GZ_NS_PER_S, &out->time_ns))
		unpack->refused = true;
}

enum gz_result gz_wire_decode_surface(const void *bytes, size_t size,
				      struct gz_surface_gaze *out_gaze, size_t max,
				      size_t *out_count)
{
	struct gz_unpack unpack;
	gz_unpack_begin(&unpack, bytes, size);
	const msgpack_object *list = gz_unpack_array(&unpack, unpack.map, "gaze_on_surfaces");
	size_t count = list ? list->via.array.size : 0;
	bool full = count > max;
	for (size_t i = 0; !full && i < count; i++) {
		const msgpack_object *map = &list->via.array.ptr[i];
		if (map->type == MSGPACK_OBJECT_MAP)
			take_surface_entry(&unpack, map, &out_gaze[i]);
		else
			unpack.refused = true;
	}
	if (!list)
		unpack.refused = true;
	enum gz_result result = gz_unpack_end(&unpack);
	if (result == GZ_OK && full)
		return GZ_ERR_FULL;
	if (result == GZ_OK)
		*out_count = count;
	return result;
}

enum gz_result gz_wire_decode_annotation(const void *bytes, size_t size,
					 struct gz_annotation *out_annotation)
{
	static const char *const known[] = { "topic", "label", "timestamp", "duration", NULL };
	struct gz_annotation annotation = { 0 };
	struct gz_unpack unpack;
	gz_unpack_begin(&unpack, bytes, size);
	const msgpack_object *map = unpack.map;
	gz_unpack_text(&unpack, map, "label", annotation.label, sizeof annotation.label);
	annotation.has_time =
		gz_unpack_time(&unpack, map, "timestamp", GZ_NS_PER_S, &annotation.time_ns);
	gz_unpack_time(&unpack, map, "duration", GZ_NS_PER_S, &annotation.duration_ns);
	if (annotation.label[0] == '\0' || annotation.duration_ns < 0)
		unpack.refused = true;
	if (!unpack.refused)
		gz_wire_print_json(map, known, annotation.keys, sizeof annotation.keys);
	enum gz_result result = gz_unpack_end(&unpack);
	if (result == GZ_OK)
		*out_annotation = annotation;
	return result;
}

enum gz_result gz_wire_decode_pointer(const void *bytes, size_t size,
				      struct gz_viewer_pointer *out_pointer)
{
	struct gz_viewer_pointer pointer = { 0 };
	struct gz_unpack unpack;
	gz_unpack_begin(&unpack, bytes, size);
	pointer.known = gz_unpack_point(&unpack, unpack.map, "point", &pointer.point);
	pointer.has_time =
		gz_unpack_time(&unpack, unpack.map, "timestamp", GZ_NS_PER_S, &pointer.time_ns);
	enum gz_result result = gz_unpack_end(&unpack);
	if (result == GZ_OK)
		*out_pointer = pointer;
	return result;
}

/* @return whether the numbers are whole pixels within the limit, and the rectangle is not empty */
static bool take_window_rect(const double numbers[4], int out_px[4])
{
	for (int i = 0; i < 4; i++) {
		if (!(fabs(numbers[i]) <= GZ_WINDOW_PX_MAX) || numbers[i] != trunc(numbers[i]))
			return false;
		out_px[i] = (int)numbers[i];
	}
	return out_px[2] > 0 && out_px[3] > 0;
}

static void take_monitor_place(struct gz_unpack *unpack, struct gz_monitor_place *monitor)
{
	double numbers[4];
	int rect_px[4];
	if (!gz_unpack_doubles(unpack, unpack->map, "monitor", numbers, 4))
		return;
	if (!take_window_rect(numbers, rect_px) || rect_px[2] > GZ_DISPLAY_SIDE_MAX_PX ||
	    rect_px[3] > GZ_DISPLAY_SIDE_MAX_PX) {
		unpack->refused = true;
		return;
	}
	memcpy(monitor->at, rect_px, sizeof monitor->at);
	memcpy(monitor->px, rect_px + 2, sizeof monitor->px);
	gz_unpack_double(unpack, unpack->map, "scale", 0, GZ_MONITOR_SCALE_MAX, &monitor->scale);
}

enum gz_result gz_wire_decode_window(const void *bytes, size_t size,
				     struct gz_viewer_window *out_window)
{
	struct gz_viewer_window window = { 0 };
	struct gz_unpack unpack;
	double numbers[4];
	gz_unpack_begin(&unpack, bytes, size);
	window.known = gz_unpack_doubles(&unpack, unpack.map, "rect", numbers, 4);
	if (window.known && !take_window_rect(numbers, window.rect_px))
		unpack.refused = true;
	if (window.known)
		take_monitor_place(&unpack, &window.monitor);
	if (window.known)
		window.has_still =
			gz_unpack_bool(&unpack, unpack.map, "still", &window.still_scene);
	window.has_time =
		gz_unpack_time(&unpack, unpack.map, "timestamp", GZ_NS_PER_S, &window.time_ns);
	enum gz_result result = gz_unpack_end(&unpack);
	if (result == GZ_OK)
		*out_window = window;
	return result;
}

enum gz_result gz_wire_decode_notification(const void *bytes, size_t size,
					   struct gz_notification *out_notification)
{
	struct gz_notification notification = { 0 };
	struct gz_unpack unpack;
	gz_unpack_begin(&unpack, bytes, size);
	gz_unpack_text(&unpack, unpack.map, "subject", notification.subject,
		       sizeof notification.subject);
	gz_unpack_text(&unpack, unpack.map, "session_name", notification.session_name,
		       sizeof notification.session_name);
	if (notification.subject[0] == '\0')
		unpack.refused = true;
	enum gz_result result = gz_unpack_end(&unpack);
	if (result == GZ_OK)
		*out_notification = notification;
	return result;
}
