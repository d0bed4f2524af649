#include <float.h>
#include <math.h>

#include "base/clock.h"
#include "protocol/wire.h"
#include "protocol/wire_unpack.h"

static const char *event_name(int event)
{
	return gz_event_name((enum gz_event)event);
}

static bool take_event(struct gz_unpack *unpack, const msgpack_object *map, enum gz_event *out)
{
	int event = gz_unpack_name(unpack, map, "event", event_name, GZ_EVENT_COUNT);
	if (event < 0)
		return false;
	*out = (enum gz_event)event;
	return true;
}

static void take_event_final(struct gz_unpack *unpack, struct gz_gaze *gaze)
{
	const msgpack_object *map = gz_unpack_map(unpack, unpack->map, "event_final");
	if (!map)
		return;
	gaze->final_known =
		take_event(unpack, map, &gaze->final_event) && gz_unpack_find(map, "seq");
	gz_unpack_uint64(unpack, map, "seq", &gaze->final_seq);
	if (!gaze->final_known) /* half of it says nothing */
		unpack->refused = true;
	uint64_t first = gaze->final_seq;
	gz_unpack_uint64(unpack, map, "first", &first);
	if (first > gaze->final_seq)
		unpack->refused = true;
	else
		gaze->final_span = gaze->final_seq - first;
}

/* Our own map of an eye. @return whether it is there */
static bool take_eye(struct gz_unpack *unpack, const char *key, struct gz_gaze_eye *eye)
{
	const msgpack_object *map = gz_unpack_map(unpack, unpack->map, key);
	gz_unpack_point(unpack, map, "point", &eye->point);
	gz_unpack_float(unpack, map, "pupil_mm", 0, FLT_MAX, &eye->pupil_mm);
	gz_unpack_bool(unpack, map, "valid", &eye->valid);
	return map != NULL;
}

/* A position of confidence 0 is the viewing distance standing in. Pupil's is in the frame of its
 * eye camera and has no confidence of its own. */
static void take_sphere(struct gz_unpack *unpack, const msgpack_object *pupil,
			struct gz_gaze_eye *eye)
{
	const msgpack_object *sphere = gz_unpack_map(unpack, pupil, "sphere");
	double centre[3], confidence = 0;
	gz_unpack_double(unpack, sphere, "confidence", 0, 1, &confidence);
	if (confidence > 0 && gz_unpack_doubles(unpack, sphere, "center", centre, 3))
		for (int i = 0; i < 3; i++)
			eye->origin_mm[i] = (float)centre[i];
}

/* What only the pupil map tells; where we did not send the message, also that the eye took part. */
static void take_pupil(struct gz_unpack *unpack, const msgpack_object *pupil,
		       const bool ours[GZ_EYE_COUNT], struct gz_gaze *gaze)
{
	int64_t id = -1;
	gz_unpack_int64(unpack, pupil, "id", &id);
	if (id != GZ_EYE_RIGHT && id != GZ_EYE_LEFT)
		return;
	struct gz_gaze_eye *eye = &gaze->eye[id];
	gz_unpack_float(unpack, pupil, "confidence", 0, 1, &eye->confidence);
	take_sphere(unpack, pupil, eye);
	if (ours[id])
		return;
	eye->valid = true;
	gz_unpack_float(unpack, pupil, "diameter_3d", 0, FLT_MAX, &eye->pupil_mm);
}

/* Pupil Capture's own words for an eye, in the frame of its scene camera: beside base_data, by the
 * eye's number where both took part, alone where one did. A direction of no length says nothing. */
static void take_vectors(struct gz_unpack *unpack, struct gz_gaze *gaze)
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

static void take_eyes(struct gz_unpack *unpack, struct gz_gaze *gaze)
{
	bool ours[GZ_EYE_COUNT] = {
		[GZ_EYE_RIGHT] = take_eye(unpack, "eye0", &gaze->eye[GZ_EYE_RIGHT]),
		[GZ_EYE_LEFT] = take_eye(unpack, "eye1", &gaze->eye[GZ_EYE_LEFT]),
	};
	const msgpack_object *pupils = gz_unpack_array(unpack, unpack->map, "base_data");
	for (uint32_t i = 0; pupils && i < pupils->via.array.size; i++) {
		const msgpack_object *pupil = &pupils->via.array.ptr[i];
		if (pupil->type == MSGPACK_OBJECT_MAP) /* else a reference, as surfaces have */
			take_pupil(unpack, pupil, ours, gaze);
	}
	take_vectors(unpack, gaze);
}

/* Ours if it is there, else Pupil's. A gaze must be somewhere at some time. */
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
	take_event(&unpack, map, &gaze.event);
	take_event_final(&unpack, &gaze);
	gz_unpack_float(&unpack, map, "velocity_deg_s", 0, FLT_MAX, &gaze.velocity_deg_s);
	gz_unpack_uint64(&unpack, map, "seq", &gaze.seq);
	gz_unpack_int64(&unpack, map, "device_ns", &gaze.device_ns);
	gz_unpack_int64(&unpack, map, "publish_ns", &gaze.publish_ns);
	gz_unpack_bool(&unpack, map, "combined", &gaze.combined);
	take_eyes(&unpack, &gaze);

	enum gz_result result = gz_unpack_end(&unpack);
	if (result == GZ_OK)
		*out_gaze = gaze;
	return result;
}
