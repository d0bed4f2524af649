/* The gaze message, which is made for each sample. All its texts are constants and its numbers have
 * a greatest size, so it always fits: its pieces are written one behind the other, without looking
 * for room before each of two hundred. */
#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "protocol/wire.h"
#include "protocol/wire_pack.h"

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

static const char *topic_of(const struct eyes *eyes)
{
	if (eyes->count == 2)
		return GZ_TOPIC_GAZE_BOTH;
	return eyes->index[0] == GZ_EYE_RIGHT ? GZ_TOPIC_GAZE_RIGHT : GZ_TOPIC_GAZE_LEFT;
}

const char *gz_wire_gaze_topic(const struct gz_gaze *gaze)
{
	const struct eyes eyes = participating_eyes(gaze);
	return topic_of(&eyes);
}

/* With constants, which are copied by a move or two. */
static inline unsigned char *put_topic(unsigned char *to, const struct eyes *eyes)
{
	if (eyes->count == 2)
		return gz_put_short_text(to, GZ_TOPIC_GAZE_BOTH);
	return eyes->index[0] == GZ_EYE_RIGHT ? gz_put_short_text(to, GZ_TOPIC_GAZE_RIGHT)
					      : gz_put_short_text(to, GZ_TOPIC_GAZE_LEFT);
}

static bool is_finite_point(struct gz_point point)
{
	return isfinite(point.x) && isfinite(point.y);
}

static bool is_finite_vector(const float values[3])
{
	return isfinite(values[0]) && isfinite(values[1]) && isfinite(values[2]);
}

static inline unsigned char *put_doubles(unsigned char *to, const double values[3])
{
	to = gz_put_small_array(to, 3);
	for (int i = 0; i < 3; i++)
		to = gz_put_double(to, values[i]);
	return to;
}

/* [x, y], or nil if either is not finite. */
static unsigned char *put_point(unsigned char *to, struct gz_point point)
{
	if (!is_finite_point(point))
		return gz_put_nil(to);
	to = gz_put_small_array(to, 2);
	to = gz_put_float(to, point.x);
	return gz_put_float(to, point.y);
}

/* The key "norm_pos" and the point with Pupil's origin, bottom left; nil if it is not finite. */
static unsigned char *put_norm_pos(unsigned char *to, struct gz_point point)
{
	to = gz_put_short_text(to, "norm_pos");
	if (!is_finite_point(point))
		return gz_put_nil(to);
	to = gz_put_small_array(to, 2);
	to = gz_put_double(to, point.x);
	return gz_put_double(to, 1.0 - point.y);
}

/* Equal times give equal bytes: readers match messages by them. */
static inline unsigned char *put_time(unsigned char *to, int64_t time_ns)
{
	to = gz_put_short_text(to, "timestamp");
	return gz_put_double(to, gz_ns_to_s(time_ns));
}

static inline unsigned char *put_confidence(unsigned char *to, float confidence)
{
	to = gz_put_short_text(to, "confidence");
	return gz_put_float(to, confidence);
}

/* The position of the eye in the tracker's coordinates. If the tracker does not give it, an eye
 * straight in front of the display at the configured distance replaces it, with confidence 0. */
static inline unsigned char *put_sphere(unsigned char *to, const struct gz_gaze_eye *eye,
					float confidence, const struct gz_display *display)
{
	bool measured = is_finite_vector(eye->origin_mm);
	double centre[3] = { 0, 0, display->distance_mm };
	for (int i = 0; measured && i < 3; i++)
		centre[i] = (double)eye->origin_mm[i];
	to = gz_put_short_text(to, "sphere");
	to = gz_put_small_map(to, 3);
	to = gz_put_short_text(to, "center");
	to = put_doubles(to, centre);
	to = gz_put_short_text(to, "radius");
	to = gz_put_double(to, EYE_RADIUS_MM);
	return put_confidence(to, measured ? confidence : 0);
}

/* The direction from the eye to a point of the display, in the coordinates of gaze_point_3d. The
 * angles are those of pye3d: theta from +y (down); phi in the plane perpendicular to it, from +x
 * (right) towards +z (ahead). */
static inline unsigned char *put_direction(unsigned char *to, struct gz_point point,
					   const struct gz_display *display)
{
	double mm[3];
	gz_display_to_mm(display, point, mm);
	double length = sqrt(mm[0] * mm[0] + mm[1] * mm[1] + mm[2] * mm[2]);
	to = gz_put_short_text(to, "phi");
	to = gz_put_double(to, atan2(mm[2], mm[0]));
	to = gz_put_short_text(to, "theta");
	return gz_put_double(to, acos(mm[1] / length));
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
	return is_finite_point(eye->point) ? eye->point : gaze->point;
}

static unsigned char *put_pupil_map(unsigned char *to, const struct gz_gaze *gaze,
				    enum gz_eye index, const struct gz_display *display)
{
	const struct gz_gaze_eye *eye = &gaze->eye[index];
	const float confidence = eye_confidence(gaze, eye);
	const struct gz_point point = eye_point(gaze, eye);
	to = gz_put_small_map(to, 11);
	to = gz_put_short_text(to, "topic");
	to = index == GZ_EYE_RIGHT ? gz_put_short_text(to, GZ_TOPIC_PUPIL_RIGHT)
				   : gz_put_short_text(to, GZ_TOPIC_PUPIL_LEFT);
	to = gz_put_short_text(to, "id");
	to = gz_put_uint(to, index);
	to = put_norm_pos(to, point);
	to = gz_put_short_text(to, "diameter");
	to = gz_put_float(to, eye->pupil_mm * DIAMETER_PER_MM);
	to = gz_put_short_text(to, "diameter_3d");
	to = gz_put_float(to, eye->pupil_mm);
	to = put_direction(to, point, display);
	to = put_sphere(to, eye, confidence, display);
	to = put_confidence(to, confidence);
	to = put_time(to, gaze->host_ns);
	to = gz_put_short_text(to, "method");
	return gz_put_short_text(to, GZ_WIRE_METHOD);
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

static unsigned char *put_vector(unsigned char *to, const float vector[3])
{
	to = gz_put_small_array(to, 3);
	for (int i = 0; i < 3; i++)
		to = gz_put_float(to, vector[i]);
	return to;
}

/* A vector of each eye, by the eye's number as text. */
static inline unsigned char *put_vectors(unsigned char *to, const float right[3],
					 const float left[3])
{
	to = gz_put_small_map(to, 2);
	to = gz_put_short_text(to, "0");
	to = put_vector(to, right);
	to = gz_put_short_text(to, "1");
	return put_vector(to, left);
}

/* Centres and directions of the eyes, in the tracker's coordinates. The keys and their forms are
 * those of Pupil Core 3 (gaze_mapping/gazer_3d/gazer_headset.py): by the eye's number as text, or
 * of one eye alone. */
static unsigned char *put_lines_of_sight(unsigned char *to, const struct gz_gaze *gaze,
					 const struct eyes *eyes)
{
	const struct gz_gaze_eye *right = &gaze->eye[GZ_EYE_RIGHT];
	const struct gz_gaze_eye *left = &gaze->eye[GZ_EYE_LEFT];
	if (eyes->count == 1) {
		const struct gz_gaze_eye *eye = &gaze->eye[eyes->index[0]];
		to = gz_put_short_text(to, "eye_center_3d");
		to = put_vector(to, eye->origin_mm);
		to = gz_put_short_text(to, "gaze_normal_3d");
		return put_vector(to, eye->direction);
	}
	to = gz_put_short_text(to, "eye_centers_3d");
	to = put_vectors(to, right->origin_mm, left->origin_mm);
	to = gz_put_short_text(to, "gaze_normals_3d");
	return put_vectors(to, right->direction, left->direction);
}

static unsigned char *put_base_data(unsigned char *to, const struct gz_gaze *gaze,
				    const struct eyes *eyes, const struct gz_display *display,
				    struct gz_wire_message *message)
{
	to = gz_put_short_text(to, "base_data");
	to = gz_put_small_array(to, eyes->count);
	for (size_t i = 0; i < eyes->count; i++) {
		unsigned char *begin = to;
		to = put_pupil_map(to, gaze, eyes->index[i], display);
		message->pupil[eyes->index[i]].at = (size_t)(begin - message->bytes);
		message->pupil[eyes->index[i]].size = (size_t)(to - begin);
	}
	return to;
}

static unsigned char *put_eye_map(unsigned char *to, const struct gz_gaze_eye *eye)
{
	to = gz_put_small_map(to, 3);
	to = gz_put_short_text(to, "point");
	to = put_point(to, eye->point);
	to = gz_put_short_text(to, "pupil_mm");
	to = gz_put_float(to, eye->pupil_mm);
	to = gz_put_short_text(to, "valid");
	return gz_put_bool(to, eye->valid);
}

static unsigned char *put_event(unsigned char *to, enum gz_event event)
{
	to = gz_put_short_text(to, "event");
	return gz_put_short_text(to, gz_event_name(event));
}

static unsigned char *put_event_final(unsigned char *to, const struct gz_gaze *gaze)
{
	to = gz_put_short_text(to, "event_final");
	to = gz_put_small_map(to, gaze->final_span > 0 ? 3 : 2);
	to = gz_put_short_text(to, "seq");
	to = gz_put_uint(to, gaze->final_seq);
	to = put_event(to, gaze->final_event);
	if (gaze->final_span == 0)
		return to;
	to = gz_put_short_text(to, "first");
	return gz_put_uint(to, gaze->final_seq - gaze->final_span);
}

static unsigned char *put_landing(unsigned char *to, const struct gz_landing *landing)
{
	to = gz_put_short_text(to, "landing");
	to = gz_put_small_map(to, 3);
	to = gz_put_short_text(to, "point");
	to = put_point(to, landing->point);
	to = put_time(to, landing->time_ns);
	to = gz_put_short_text(to, "sigma_deg");
	return gz_put_float(to, landing->sigma_deg);
}

/* The keys of Pupil's gaze map. */
static unsigned char *put_pupil_core_keys(unsigned char *to, const struct gz_gaze *gaze,
					  const struct eyes *eyes, bool lines_of_sight,
					  const struct gz_display *display,
					  struct gz_wire_message *message)
{
	double mm[3];
	gz_display_to_mm(display, gaze->point, mm);
	to = gz_put_short_text(to, "topic");
	to = put_topic(to, eyes);
	to = put_norm_pos(to, gaze->point);
	to = put_confidence(to, gaze->confidence);
	to = put_time(to, gaze->host_ns);
	to = gz_put_short_text(to, "gaze_point_3d");
	to = put_doubles(to, mm);
	if (lines_of_sight)
		to = put_lines_of_sight(to, gaze, eyes);
	return put_base_data(to, gaze, eyes, display, message);
}

/* The keys of this project. publish_ns is last and has a fixed width, as wire.h promises. */
static unsigned char *put_own_keys(unsigned char *to, const struct gz_gaze *gaze)
{
	to = gz_put_short_text(to, "point");
	to = put_point(to, gaze->point);
	to = gz_put_short_text(to, "raw");
	to = put_point(to, gaze->raw);
	to = put_event(to, gaze->event);
	if (gaze->final_known)
		to = put_event_final(to, gaze);
	to = gz_put_short_text(to, "velocity_deg_s");
	to = gz_put_float(to, gaze->velocity_deg_s);
	if (gaze->landing.known)
		to = put_landing(to, &gaze->landing);
	to = gz_put_short_text(to, "seq");
	to = gz_put_uint(to, gaze->seq);
	to = gz_put_short_text(to, "device_ns");
	to = gaze->device_ns == GZ_NO_DEVICE_TIME ? gz_put_nil(to)
						  : gz_put_int(to, gaze->device_ns);
	to = gz_put_short_text(to, "host_ns");
	to = gz_put_int(to, gaze->host_ns);
	to = gz_put_short_text(to, "eye0");
	to = put_eye_map(to, &gaze->eye[GZ_EYE_RIGHT]);
	to = gz_put_short_text(to, "eye1");
	to = put_eye_map(to, &gaze->eye[GZ_EYE_LEFT]);
	to = gz_put_short_text(to, "combined");
	to = gz_put_bool(to, gaze->combined);
	to = gz_put_short_text(to, "publish_ns");
	return gz_put_number(to, 0xd3, (uint64_t)gaze->publish_ns, 8);
}

/* A gaze message is never larger; a test makes the largest one. */
enum { GAZE_SIZE_MAX = 1280 };

_Static_assert(GAZE_SIZE_MAX <= GZ_WIRE_MESSAGE_SIZE, "a gaze message fits");

enum gz_result gz_wire_encode_gaze(const struct gz_gaze *gaze, const struct gz_display *display,
				   struct gz_wire_message *out_message)
{
	const struct eyes eyes = participating_eyes(gaze);
	const bool lines_of_sight = has_lines_of_sight(gaze, &eyes);
	size_t keys = 17;
	keys += gaze->final_known ? 1 : 0;
	keys += lines_of_sight ? 2 : 0;
	keys += gaze->landing.known ? 1 : 0;
	memset(out_message->pupil, 0, sizeof out_message->pupil);
	/* A map of 16 pairs and more. */
	unsigned char *to = gz_put_number(out_message->bytes, 0xde, keys, 2);
	to = put_pupil_core_keys(to, gaze, &eyes, lines_of_sight, display, out_message);
	to = put_own_keys(to, gaze);
	out_message->size = (size_t)(to - out_message->bytes);
	return GZ_OK;
}

enum gz_result gz_wire_encode_event_final(const struct gz_gaze *gaze,
					  struct gz_wire_message *out_message)
{
	memset(out_message->pupil, 0, sizeof out_message->pupil);
	unsigned char *to = gz_put_small_map(out_message->bytes, 3);
	to = gz_put_short_text(to, "topic");
	to = gz_put_short_text(to, GZ_TOPIC_EVENT_FINAL);
	to = put_time(to, gaze->host_ns);
	to = put_event_final(to, gaze);
	out_message->size = (size_t)(to - out_message->bytes);
	return GZ_OK;
}
