#include <math.h>
#include <stdio.h>

#include "protocol/wire.h"
#include "protocol/wire_pack.h"

/* Radius of the eyeball in Pupil's 3d eye model (pye3d): sqrt(108) mm. */
static const double EYE_RADIUS_MM = 10.392304845413264;

/* Units of "diameter" in a mm: Pupil gives pixels there, and a tracker without images has none. */
static const float DIAMETER_PER_MM = 10;

/* The eyes that a message is made of; both where neither was seen. */
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

static bool all_finite(const float values[3])
{
	return isfinite(values[0]) && isfinite(values[1]) && isfinite(values[2]);
}

/* The eye in the tracker's frame. Where the tracker does not give it, an eye straight before the
 * display at the configured distance stands in, and the position's confidence is 0. */
static void pack_sphere(struct gz_pack *pack, const struct gz_gaze_eye *eye, float confidence,
			const struct gz_display *display)
{
	bool measured = all_finite(eye->origin_mm);
	double centre[3] = { 0, 0, display->distance_mm };
	for (int i = 0; measured && i < 3; i++)
		centre[i] = (double)eye->origin_mm[i];
	gz_pack_map(pack, "sphere", 3);
	gz_pack_doubles(pack, "center", centre, 3);
	gz_pack_double(pack, "radius", EYE_RADIUS_MM);
	gz_pack_float(pack, "confidence", measured ? confidence : 0);
}

/* Direction from the eye to a point of the display, in the frame of gaze_point_3d. Angles as pye3d
 * has them: theta from +y (down), phi in the plane across it from +x (right) towards +z (ahead). */
static void pack_direction(struct gz_pack *pack, struct gz_point point,
			   const struct gz_display *display)
{
	double mm[3];
	gz_display_to_mm(display, point, mm);
	double length = sqrt(mm[0] * mm[0] + mm[1] * mm[1] + mm[2] * mm[2]);
	gz_pack_double(pack, "phi", atan2(mm[2], mm[0]));
	gz_pack_double(pack, "theta", acos(mm[1] / length));
}

/* Pupil's readers compare confidences: a number always, 0 where nothing is known. */
static float eye_confidence(const struct gz_gaze *gaze, const struct gz_gaze_eye *eye)
{
	if (!isnan(eye->confidence))
		return eye->confidence;
	return eye->valid || gaze->combined ? gaze->confidence : 0;
}

/* Pupil's readers unpack norm_pos: an eye that has no point of its own shows the common one. */
static struct gz_point eye_point(const struct gz_gaze *gaze, const struct gz_gaze_eye *eye)
{
	bool measured = isfinite(eye->point.x) && isfinite(eye->point.y);
	return measured ? eye->point : gaze->point;
}

static void pack_pupil(struct gz_pack *pack, const struct gz_gaze *gaze, enum gz_eye index,
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

/* What Pupil's gaze map holds. */
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
	gz_pack_array(pack, "base_data", eyes.count);
	for (size_t i = 0; i < eyes.count; i++)
		pack_pupil(pack, gaze, eyes.index[i], display);
}

static void pack_eye(struct gz_pack *pack, const char *key, const struct gz_gaze_eye *eye)
{
	gz_pack_map(pack, key, 3);
	gz_pack_point(pack, "point", eye->point);
	gz_pack_float(pack, "pupil_mm", eye->pupil_mm);
	gz_pack_bool(pack, "valid", eye->valid);
}

/* What is ours; publish_ns comes last and at a fixed width, as the header promises. */
static void pack_own_keys(struct gz_pack *pack, const struct gz_gaze *gaze)
{
	gz_pack_point(pack, "point", gaze->point);
	gz_pack_point(pack, "raw", gaze->raw);
	gz_pack_text(pack, "event", gz_event_name(gaze->event));
	if (gaze->final_known) {
		gz_pack_map(pack, "event_final", gaze->final_span > 0 ? 3 : 2);
		gz_pack_uint(pack, "seq", gaze->final_seq);
		gz_pack_text(pack, "event", gz_event_name(gaze->final_event));
		if (gaze->final_span > 0)
			gz_pack_uint(pack, "first", gaze->final_seq - gaze->final_span);
	}
	gz_pack_float(pack, "velocity_deg_s", gaze->velocity_deg_s);
	gz_pack_uint(pack, "seq", gaze->seq);
	if (gaze->device_ns == GZ_NO_DEVICE_TIME)
		gz_pack_nil(pack, "device_ns");
	else
		gz_pack_int(pack, "device_ns", gaze->device_ns);
	gz_pack_int(pack, "host_ns", gaze->host_ns);
	pack_eye(pack, "eye0", &gaze->eye[GZ_EYE_RIGHT]);
	pack_eye(pack, "eye1", &gaze->eye[GZ_EYE_LEFT]);
	gz_pack_bool(pack, "combined", gaze->combined);
	gz_pack_fixed_int64(pack, "publish_ns", gaze->publish_ns);
}

enum gz_result gz_wire_encode_gaze(const struct gz_gaze *gaze, const struct gz_display *display,
				   struct gz_wire_message *out_message)
{
	struct gz_pack pack;
	gz_pack_begin(&pack, out_message);
	gz_pack_map(&pack, NULL, gaze->final_known ? 18 : 17);
	pack_pupil_core_keys(&pack, gaze, display);
	pack_own_keys(&pack, gaze);
	return gz_pack_end(&pack);
}

static bool on_surface(struct gz_point point)
{
	return point.x >= 0 && point.x <= 1 && point.y >= 0 && point.y <= 1;
}

enum gz_result gz_wire_encode_surface(const struct gz_gaze *gaze, const char *surface_name,
				      struct gz_wire_message *out_message)
{
	/* Pupil names the gaze on a surface so. */
	char topic[32], surface_topic[sizeof GZ_TOPIC_SURFACES + GZ_NAME_SIZE];
	snprintf(topic, sizeof topic, "%s_on_surface", gz_wire_gaze_topic(gaze));
	snprintf(surface_topic, sizeof surface_topic, GZ_TOPIC_SURFACES "%s", surface_name);

	struct gz_pack pack;
	gz_pack_begin(&pack, out_message);
	gz_pack_map(&pack, NULL, 4);
	gz_pack_text(&pack, "topic", surface_topic);
	gz_pack_text(&pack, "name", surface_name);
	gz_pack_time(&pack, "timestamp", gaze->host_ns);
	gz_pack_array(&pack, "gaze_on_surfaces", 1);
	gz_pack_map(&pack, NULL, 6);
	gz_pack_text(&pack, "topic", topic);
	gz_pack_norm_pos(&pack, gaze->point);
	gz_pack_float(&pack, "confidence", gaze->confidence);
	gz_pack_bool(&pack, "on_surf", on_surface(gaze->point));
	gz_pack_array(&pack, "base_data", 2);
	gz_pack_text(&pack, NULL, gz_wire_gaze_topic(gaze));
	gz_pack_time(&pack, NULL, gaze->host_ns);
	gz_pack_time(&pack, "timestamp", gaze->host_ns);
	return gz_pack_end(&pack);
}
