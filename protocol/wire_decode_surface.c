#include <math.h>

#include "base/clock.h"
#include "protocol/wire.h"
#include "protocol/wire_unpack.h"

/* An entry must be somewhere at some time. */
static void take_entry(struct gz_unpack *unpack, const msgpack_object *map,
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
			take_entry(&unpack, map, &out_gaze[i]);
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
