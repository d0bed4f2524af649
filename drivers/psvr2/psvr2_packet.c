#include "drivers/psvr2/psvr2_packet.h"

#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "drivers/device/little_endian.h"

enum {
	AT_TIME = 0x50,
	AT_FRAME = 0x58,
	AT_LEFT = 0x5c,
	AT_RIGHT = 0xa4,
	AT_COMBINED = 0xec,
	AT_CONVERGENCE = 0x144,
	/* Within an eye; the combined ray begins like one. */
	EYE_ORIGIN = 0x00,
	EYE_DIRECTION = 0x10,
	EYE_PUPIL = 0x20,
	EYE_BLINK = 0x40,
	SUBCOMMAND_ON = 1,
	SUBCOMMAND_OFF = 2,
};

/* From device axes to display axes. */
static const float axis_sign[3] = { -1, -1, 1 };

/* Read a flag and the three numbers behind it. */
static bool read_psvr2_vector(const unsigned char *bytes, float out_vector[3])
{
	float vector[3];
	if (gz_read_u32le(bytes) == 0)
		return false;
	for (int i = 0; i < 3; i++) {
		vector[i] = axis_sign[i] * gz_read_f32le(bytes + 4 + 4 * i);
		if (!isfinite(vector[i]))
			return false;
	}
	memcpy(out_vector, vector, sizeof vector);
	return true;
}

/* Read a flag and the length behind it. */
static bool read_psvr2_length(const unsigned char *bytes, float *out_length_mm)
{
	float length_mm = gz_read_f32le(bytes + 4);
	if (gz_read_u32le(bytes) == 0 || !isfinite(length_mm) || length_mm <= 0)
		return false;
	*out_length_mm = length_mm;
	return true;
}

static bool normalise_psvr2_direction(float vector[3])
{
	double length =
		sqrt((double)vector[0] * (double)vector[0] + (double)vector[1] * (double)vector[1] +
		     (double)vector[2] * (double)vector[2]);
	/* Chosen: a shorter vector has no direction. */
	if (length < 1e-6)
		return false;
	for (int i = 0; i < 3; i++)
		vector[i] = (float)((double)vector[i] / length);
	return true;
}

static void read_psvr2_ray(const unsigned char *bytes, struct gz_psvr2_ray *ray)
{
	float direction[3];
	ray->has_origin = read_psvr2_vector(bytes + EYE_ORIGIN, ray->origin_mm);
	ray->has_direction = read_psvr2_vector(bytes + EYE_DIRECTION, direction) &&
			     normalise_psvr2_direction(direction);
	if (ray->has_direction)
		memcpy(ray->direction, direction, sizeof direction);
}

static void read_psvr2_eye(const unsigned char *bytes, struct gz_psvr2_eye *eye)
{
	read_psvr2_ray(bytes, &eye->ray);
	eye->has_pupil = read_psvr2_length(bytes + EYE_PUPIL, &eye->pupil_mm);
	eye->blink =
		gz_read_u32le(bytes + EYE_BLINK) != 0 && gz_read_u32le(bytes + EYE_BLINK + 4) != 0;
}

static bool is_psvr2_malformed(const unsigned char *bytes, size_t size,
			       enum gz_malformed *out_malformed)
{
	if (size != GZ_PSVR2_PACKET_SIZE && size != GZ_PSVR2_PACKET_SIZE_SHORT) {
		*out_malformed =
			size < GZ_PSVR2_PACKET_SIZE ? GZ_MALFORMED_SHORT : GZ_MALFORMED_LONG;
		return true;
	}
	if (memcmp(bytes, "GS", 2) != 0) {
		*out_malformed = GZ_MALFORMED_SYNTAX;
		return true;
	}
	int64_t time_us = gz_read_i64le(bytes + AT_TIME);
	if (time_us > INT64_MAX / GZ_NS_PER_US || time_us <= INT64_MIN / GZ_NS_PER_US) {
		*out_malformed = GZ_MALFORMED_VALUE;
		return true;
	}
	return false;
}

enum gz_result gz_psvr2_parse(const unsigned char *bytes, size_t size,
			      struct gz_psvr2_packet *out_packet, enum gz_malformed *out_malformed)
{
	if (is_psvr2_malformed(bytes, size, out_malformed))
		return GZ_ERR_PROTOCOL;
	struct gz_psvr2_packet packet = {
		.device_ns = gz_read_i64le(bytes + AT_TIME) * GZ_NS_PER_US,
		.frame = gz_read_u32le(bytes + AT_FRAME),
	};
	read_psvr2_eye(bytes + AT_LEFT, &packet.eye[GZ_EYE_LEFT]);
	read_psvr2_eye(bytes + AT_RIGHT, &packet.eye[GZ_EYE_RIGHT]);
	read_psvr2_ray(bytes + AT_COMBINED, &packet.combined);
	if (size == GZ_PSVR2_PACKET_SIZE) {
		float convergence_mm = gz_read_f32le(bytes + AT_CONVERGENCE);
		packet.has_convergence = isfinite(convergence_mm) && convergence_mm > 0;
		packet.convergence_mm = packet.has_convergence ? convergence_mm : 0;
	}
	*out_packet = packet;
	return GZ_OK;
}

void gz_psvr2_print_request(bool on, unsigned char bytes[GZ_PSVR2_REQUEST_SIZE])
{
	gz_write_u16le(bytes, GZ_PSVR2_GAZE_STREAM);
	gz_write_u16le(bytes + 2, on ? SUBCOMMAND_ON : SUBCOMMAND_OFF);
	gz_write_u32le(bytes + 4, 0);
}

/* Cosine of 85 degrees. */
static const double COS_GRAZING = 0.08715574274765817;

/* Largest normalised coordinate. Chosen: a point a million screens away is no measurement. */
static const double FARTHEST = 1e6;

static double dot_product_3d(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Rotate a frame about its third axis: @p from turns towards @p to by an angle, and @p to follows.
 */
static void rotate_frame(double from[3], double to[3], double angle_deg)
{
	double angle = angle_deg * (M_PI / 180);
	for (int i = 0; i < 3; i++) {
		double a = from[i], b = to[i];
		from[i] = cos(angle) * a + sin(angle) * b;
		to[i] = cos(angle) * b - sin(angle) * a;
	}
}

struct gz_psvr2_screen gz_psvr2_screen_make(const struct gz_psvr2_screen_params *params)
{
	struct gz_psvr2_screen screen = {
		.centre_mm = { params->offset_mm[0], params->offset_mm[1], params->distance_mm },
		.right = { 1, 0, 0 },
		.down = { 0, 1, 0 },
		.ahead = { 0, 0, 1 },
	};
	memcpy(screen.size_mm, params->size_mm, sizeof screen.size_mm);
	/* Nearer means against ahead. */
	rotate_frame(screen.right, screen.ahead, -params->turn_deg[0]);
	rotate_frame(screen.down, screen.ahead, -params->turn_deg[1]);
	rotate_frame(screen.right, screen.down, params->turn_deg[2]);
	return screen;
}

bool gz_psvr2_screen_meet(const struct gz_psvr2_screen *screen, const struct gz_psvr2_ray *ray,
			  struct gz_point *out_point)
{
	double direction[3], to_centre[3], place[3];
	if (!ray->has_origin || !ray->has_direction)
		return false;
	for (int i = 0; i < 3; i++) {
		direction[i] = (double)ray->direction[i];
		to_centre[i] = screen->centre_mm[i] - (double)ray->origin_mm[i];
	}
	double slope = dot_product_3d(direction, screen->ahead);
	double distance_mm = dot_product_3d(to_centre, screen->ahead);
	if (slope < COS_GRAZING || distance_mm <= 0)
		return false;
	for (int i = 0; i < 3; i++)
		place[i] = direction[i] * (distance_mm / slope) - to_centre[i];
	double x = dot_product_3d(place, screen->right) / screen->size_mm[0] + 0.5;
	double y = dot_product_3d(place, screen->down) / screen->size_mm[1] + 0.5;
	if (fabs(x) > FARTHEST || fabs(y) > FARTHEST)
		return false;
	*out_point = (struct gz_point) { (float)x, (float)y };
	return true;
}
