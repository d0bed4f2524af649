#include "base/clock.h"
#include "protocol/wire.h"
#include "protocol/wire_unpack.h"

enum gz_result gz_wire_decode_annotation(const void *bytes, size_t size,
					 struct gz_annotation *out_annotation)
{
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
	enum gz_result result = gz_unpack_end(&unpack);
	if (result == GZ_OK)
		*out_annotation = annotation;
	return result;
}
