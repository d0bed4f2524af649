#include <float.h>
#include <math.h>

#include "base/clock.h"
#include "protocol/wire.h"
#include "protocol/wire_unpack.h"

static const double ANGLE_MAX_DEG = 360;

static void require(struct gz_unpack *unpack, bool there)
{
	if (!there)
		unpack->refused = true;
}

/* "duration", ms: never negative. */
static void take_duration(struct gz_unpack *unpack, int64_t *out_duration_ns)
{
	gz_unpack_time(unpack, unpack->map, "duration", GZ_NS_PER_MS, out_duration_ns);
	require(unpack, *out_duration_ns >= 0);
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
	require(&unpack,
		gz_unpack_time(&unpack, map, "timestamp", GZ_NS_PER_S, &fixation.onset_ns));
	take_duration(&unpack, &fixation.duration_ns);
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
	require(&unpack, type >= 0);
	blink.onset = type == 1;
	require(&unpack,
		gz_unpack_time(&unpack, unpack.map, "timestamp", GZ_NS_PER_S, &blink.time_ns));
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
		.predicted_end = { NAN, NAN },
		.sigma_deg = NAN,
	};
	struct gz_unpack unpack;
	gz_unpack_begin(&unpack, bytes, size);
	const msgpack_object *map = unpack.map;
	require(&unpack, gz_unpack_time(&unpack, map, "timestamp", GZ_NS_PER_S, &saccade.start_ns));
	take_duration(&unpack, &saccade.duration_ns);
	gz_unpack_float(&unpack, map, "amplitude_deg", 0, ANGLE_MAX_DEG, &saccade.amplitude_deg);
	gz_unpack_float(&unpack, map, "peak_velocity_deg_s", 0, FLT_MAX,
			&saccade.peak_velocity_deg_s);
	gz_unpack_point(&unpack, map, "start", &saccade.start);
	gz_unpack_point(&unpack, map, "end", &saccade.end);
	saccade.has_prediction =
		gz_unpack_point(&unpack, map, "predicted_end", &saccade.predicted_end);
	gz_unpack_float(&unpack, map, "sigma_deg", 0, ANGLE_MAX_DEG, &saccade.sigma_deg);

	enum gz_result result = gz_unpack_end(&unpack);
	if (result == GZ_OK)
		*out_saccade = saccade;
	return result;
}
