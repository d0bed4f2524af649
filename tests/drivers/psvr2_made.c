#include "psvr2_made.h"

#include "frame_bytes.h"

/* The device's +x is left and its +y is up. */
static void put_vector(unsigned char *bytes, bool known, const float vector[3])
{
	bytes = frame_put(bytes, 4, known);
	bytes = frame_put_f32(bytes, known ? -vector[0] : 0);
	bytes = frame_put_f32(bytes, known ? -vector[1] : 0);
	frame_put_f32(bytes, known ? vector[2] : 0);
}

static void put_ray(unsigned char *bytes, const struct gz_psvr2_ray *ray)
{
	put_vector(bytes, ray->has_origin, ray->origin_mm);
	put_vector(bytes + PSVR2_AT_DIRECTION, ray->has_direction, ray->direction);
}

static void put_eye(unsigned char *bytes, const struct gz_psvr2_eye *eye)
{
	put_ray(bytes, &eye->ray);
	frame_put(bytes + PSVR2_AT_PUPIL, 4, eye->has_pupil);
	frame_put_f32(bytes + PSVR2_AT_PUPIL + 4, eye->has_pupil ? eye->pupil_mm : 0);
	frame_put(bytes + PSVR2_AT_BLINK, 4, 1);
	frame_put(bytes + PSVR2_AT_BLINK + 4, 4, eye->blink);
}

void psvr2_made_packet(const struct gz_psvr2_packet *packet,
		       unsigned char bytes[GZ_PSVR2_PACKET_SIZE])
{
	memset(bytes, 0, GZ_PSVR2_PACKET_SIZE);
	memcpy(bytes, "GS", 2);
	frame_put(bytes + 0x02, 2, 1);
	frame_put(bytes + 0x04, 4, GZ_PSVR2_PACKET_SIZE);
	frame_put(bytes + PSVR2_AT_TIME, 8, (uint64_t)(packet->device_ns / 1000));
	frame_put(bytes + PSVR2_AT_FRAME, 4, packet->frame);
	put_eye(bytes + PSVR2_AT_LEFT, &packet->eye[GZ_EYE_LEFT]);
	put_eye(bytes + PSVR2_AT_RIGHT, &packet->eye[GZ_EYE_RIGHT]);
	put_ray(bytes + PSVR2_AT_COMBINED, &packet->combined);
	frame_put_f32(bytes + PSVR2_AT_CONVERGENCE,
		      packet->has_convergence ? packet->convergence_mm : 0);
}
