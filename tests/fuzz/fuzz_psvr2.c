/* Untrusted packets of a headset, up to the point on the screen. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include "drivers/psvr2/psvr2_packet.h"
#include "tests/drivers/psvr2_made.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
	if (!holds)
		abort();
}

static void check_ray(const struct gz_psvr2_screen *screen, const struct gz_psvr2_ray *ray)
{
	struct gz_point point;
	double square = 0;
	for (int i = 0; i < 3; i++) {
		require(isfinite(ray->origin_mm[i]) && isfinite(ray->direction[i]));
		require(ray->has_origin || ray->origin_mm[i] == 0);
		square += (double)ray->direction[i] * (double)ray->direction[i];
	}
	require(ray->has_direction ? fabs(square - 1) < 1e-5 : square == 0);
	if (gz_psvr2_screen_meet(screen, ray, &point)) {
		require(ray->has_origin && ray->has_direction);
		require(isfinite(point.x) && isfinite(point.y));
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static const struct gz_psvr2_screen_params params = {
		.distance_mm = 600,
		.offset_mm = { 5, -7 },
		.size_mm = { 564.677, 317.631 },
		.turn_deg = { 10, 20, 30 },
	};
	struct gz_psvr2_screen screen = gz_psvr2_screen_make(&params);
	struct gz_psvr2_packet packet, again;
	enum gz_malformed malformed = GZ_MALFORMED_COUNT;
	unsigned char bytes[GZ_PSVR2_PACKET_SIZE];
	if (gz_psvr2_parse(data, size, &packet, &malformed) != GZ_OK) {
		require(malformed < GZ_MALFORMED_COUNT && malformed != GZ_MALFORMED_STALE);
		return 0;
	}
	require(malformed == GZ_MALFORMED_COUNT);
	check_ray(&screen, &packet.combined);
	for (int eye = 0; eye < GZ_EYE_COUNT; eye++) {
		check_ray(&screen, &packet.eye[eye].ray);
		require(isfinite(packet.eye[eye].pupil_mm) && packet.eye[eye].pupil_mm >= 0);
	}
	/* What was understood is printed to bytes that mean the same. */
	psvr2_made_packet(&packet, bytes);
	require(gz_psvr2_parse(bytes, sizeof bytes, &again, &malformed) == GZ_OK);
	require(again.device_ns == packet.device_ns && again.frame == packet.frame);
	require(again.eye[GZ_EYE_LEFT].blink == packet.eye[GZ_EYE_LEFT].blink);
	require(again.combined.has_direction == packet.combined.has_direction);
	return 0;
}
