#include "drivers/psvr2/psvr2_packet.h"

#include <math.h>
#include <string.h>

#include "base/clock.h"

enum {
	AT_VERSION = 0x02,
	AT_SIZE = 0x04,
	AT_TIME = 0x50,
	AT_FRAME = 0x58,
	AT_LEFT = 0x5c,
	AT_RIGHT = 0xa4,
	AT_COMBINED = 0xec,
	AT_CONVERGENCE = 0x144,
	/* Of an eye; the combined ray begins like one. */
	EYE_ORIGIN = 0x00,
	EYE_DIRECTION = 0x10,
	EYE_PUPIL = 0x20,
	EYE_BLINK = 0x40,
	SUBCOMMAND_ON = 1,
	SUBCOMMAND_OFF = 2,
};

/* From the device's axes to those of the display. */
static const float axis_sign[3] = { -1, -1, 1 };

static uint32_t read_u32le(const unsigned char *bytes)
{
	return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
	       (uint32_t)bytes[3] << 24;
}

static int64_t read_i64le(const unsigned char *bytes)
{
	return (int64_t)((uint64_t)read_u32le(bytes) | (uint64_t)read_u32le(bytes + 4) << 32);
}

static float read_f32le(const unsigned char *bytes)
{
	uint32_t bits = read_u32le(bytes);
	float value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

static void write_u16le(unsigned char *bytes, uint16_t value)
{
	bytes[0] = (unsigned char)value;
	bytes[1] = (unsigned char)(value >> 8);
}

static void write_u32le(unsigned char *bytes, uint32_t value)
{
	write_u16le(bytes, (uint16_t)value);
	write_u16le(bytes + 2, (uint16_t)(value >> 16));
}

static void write_f32le(unsigned char *bytes, float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof bits);
	write_u32le(bytes, bits);
}

/* A flag and three numbers behind it. */
static bool read_vector(const unsigned char *bytes, float out_vector[3])
{
	float vector[3];
	if (read_u32le(bytes) == 0)
		return false;
	for (int i = 0; i < 3; i++) {
		vector[i] = axis_sign[i] * read_f32le(bytes + 4 + 4 * i);
		if (!isfinite(vector[i]))
			return false;
	}
	memcpy(out_vector, vector, sizeof vector);
	return true;
}

/* A flag and one length behind it. */
static bool read_length(const unsigned char *bytes, float *out_length_mm)
{
	float length_mm = read_f32le(bytes + 4);
	if (read_u32le(bytes) == 0 || !isfinite(length_mm) || length_mm <= 0)
		return false;
	*out_length_mm = length_mm;
	return true;
}

static bool normalise(float vector[3])
{
	double length =
		sqrt((double)vector[0] * (double)vector[0] + (double)vector[1] * (double)vector[1] +
		     (double)vector[2] * (double)vector[2]);
	/* Chosen: what is so short has no direction. */
	if (length < 1e-6)
		return false;
	for (int i = 0; i < 3; i++)
		vector[i] = (float)((double)vector[i] / length);
	return true;
}

static void read_ray(const unsigned char *bytes, struct gz_psvr2_ray *ray)
{
	float direction[3];
	ray->has_origin = read_vector(bytes + EYE_ORIGIN, ray->origin_mm);
	ray->has_direction = read_vector(bytes + EYE_DIRECTION, direction) && normalise(direction);
	if (ray->has_direction)
		memcpy(ray->direction, direction, sizeof direction);
}

static void read_eye(const unsigned char *bytes, struct gz_psvr2_eye *eye)
{
	read_ray(bytes, &eye->ray);
	eye->has_pupil = read_length(bytes + EYE_PUPIL, &eye->pupil_mm);
	eye->blink = read_u32le(bytes + EYE_BLINK) != 0 && read_u32le(bytes + EYE_BLINK + 4) != 0;
}

static bool is_malformed(const unsigned char *bytes, size_t size, enum gz_malformed *out_malformed)
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
	int64_t time_us = read_i64le(bytes + AT_TIME);
	if (time_us > INT64_MAX / GZ_NS_PER_US || time_us <= INT64_MIN / GZ_NS_PER_US) {
		*out_malformed = GZ_MALFORMED_VALUE;
		return true;
	}
	return false;
}

enum gz_result gz_psvr2_parse(const unsigned char *bytes, size_t size,
			      struct gz_psvr2_packet *out_packet, enum gz_malformed *out_malformed)
{
	if (is_malformed(bytes, size, out_malformed))
		return GZ_ERR_PROTOCOL;
	struct gz_psvr2_packet packet = {
		.device_ns = read_i64le(bytes + AT_TIME) * GZ_NS_PER_US,
		.frame = read_u32le(bytes + AT_FRAME),
	};
	read_eye(bytes + AT_LEFT, &packet.eye[GZ_EYE_LEFT]);
	read_eye(bytes + AT_RIGHT, &packet.eye[GZ_EYE_RIGHT]);
	read_ray(bytes + AT_COMBINED, &packet.combined);
	if (size == GZ_PSVR2_PACKET_SIZE) {
		float convergence_mm = read_f32le(bytes + AT_CONVERGENCE);
		packet.has_convergence = isfinite(convergence_mm) && convergence_mm > 0;
		packet.convergence_mm = packet.has_convergence ? convergence_mm : 0;
	}
	*out_packet = packet;
	return GZ_OK;
}

static void write_vector(bool known, const float vector[3], unsigned char *bytes)
{
	write_u32le(bytes, known);
	for (int i = 0; i < 3; i++)
		write_f32le(bytes + 4 + 4 * i, known ? axis_sign[i] * vector[i] : 0);
}

static void write_ray(const struct gz_psvr2_ray *ray, unsigned char *bytes)
{
	write_vector(ray->has_origin, ray->origin_mm, bytes + EYE_ORIGIN);
	write_vector(ray->has_direction, ray->direction, bytes + EYE_DIRECTION);
}

static void write_eye(const struct gz_psvr2_eye *eye, unsigned char *bytes)
{
	write_ray(&eye->ray, bytes);
	write_u32le(bytes + EYE_PUPIL, eye->has_pupil);
	write_f32le(bytes + EYE_PUPIL + 4, eye->has_pupil ? eye->pupil_mm : 0);
	write_u32le(bytes + EYE_BLINK, 1);
	write_u32le(bytes + EYE_BLINK + 4, eye->blink);
}

void gz_psvr2_print(const struct gz_psvr2_packet *packet, unsigned char bytes[GZ_PSVR2_PACKET_SIZE])
{
	uint64_t time_us = (uint64_t)(packet->device_ns / GZ_NS_PER_US);
	memset(bytes, 0, GZ_PSVR2_PACKET_SIZE);
	memcpy(bytes, "GS", 2);
	write_u16le(bytes + AT_VERSION, 1);
	write_u32le(bytes + AT_SIZE, GZ_PSVR2_PACKET_SIZE);
	write_u32le(bytes + AT_TIME, (uint32_t)time_us);
	write_u32le(bytes + AT_TIME + 4, (uint32_t)(time_us >> 32));
	write_u32le(bytes + AT_FRAME, packet->frame);
	write_eye(&packet->eye[GZ_EYE_LEFT], bytes + AT_LEFT);
	write_eye(&packet->eye[GZ_EYE_RIGHT], bytes + AT_RIGHT);
	write_ray(&packet->combined, bytes + AT_COMBINED);
	write_f32le(bytes + AT_CONVERGENCE, packet->has_convergence ? packet->convergence_mm : 0);
}

void gz_psvr2_print_request(bool on, unsigned char bytes[GZ_PSVR2_REQUEST_SIZE])
{
	write_u16le(bytes, GZ_PSVR2_GAZE_STREAM);
	write_u16le(bytes + 2, on ? SUBCOMMAND_ON : SUBCOMMAND_OFF);
	write_u32le(bytes + 4, 0);
}
