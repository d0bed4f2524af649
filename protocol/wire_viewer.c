#include "protocol/wire_viewer.h"

#include <math.h>

#include "base/clock.h"
#include "protocol/wire_pack.h"
#include "protocol/wire_unpack.h"

static void pack_time(struct gz_pack *pack, bool has_time, int64_t time_ns)
{
	if (has_time)
		gz_pack_time(pack, "timestamp", time_ns);
	else
		gz_pack_nil(pack, "timestamp");
}

enum gz_result gz_wire_encode_pointer(const struct gz_viewer_pointer *pointer,
				      struct gz_wire_message *out_message)
{
	struct gz_pack pack;
	gz_pack_begin(&pack, out_message);
	gz_pack_map(&pack, NULL, 2);
	if (pointer->known)
		gz_pack_point(&pack, "point", pointer->point);
	else
		gz_pack_nil(&pack, "point");
	pack_time(&pack, pointer->has_time, pointer->time_ns);
	return gz_pack_end(&pack);
}

enum gz_result gz_wire_encode_window(const struct gz_viewer_window *window,
				     struct gz_wire_message *out_message)
{
	struct gz_pack pack;
	gz_pack_begin(&pack, out_message);
	gz_pack_map(&pack, NULL, 2);
	if (window->known) {
		gz_pack_array(&pack, "rect", 4);
		for (int i = 0; i < 4; i++)
			gz_pack_int(&pack, NULL, window->rect_px[i]);
	} else {
		gz_pack_nil(&pack, "rect");
	}
	pack_time(&pack, window->has_time, window->time_ns);
	return gz_pack_end(&pack);
}

enum gz_result gz_wire_decode_pointer(const void *bytes, size_t size,
				      struct gz_viewer_pointer *out_pointer)
{
	struct gz_viewer_pointer pointer = { 0 };
	struct gz_unpack unpack;
	gz_unpack_begin(&unpack, bytes, size);
	pointer.known = gz_unpack_point(&unpack, unpack.map, "point", &pointer.point);
	pointer.has_time =
		gz_unpack_time(&unpack, unpack.map, "timestamp", GZ_NS_PER_S, &pointer.time_ns);
	enum gz_result result = gz_unpack_end(&unpack);
	if (result == GZ_OK)
		*out_pointer = pointer;
	return result;
}

/* @return whether they are whole numbers of pixels, and a window */
static bool take_rect(const double numbers[4], int out_px[4])
{
	for (int i = 0; i < 4; i++) {
		if (!(fabs(numbers[i]) <= GZ_WINDOW_PX_MAX) || numbers[i] != trunc(numbers[i]))
			return false;
		out_px[i] = (int)numbers[i];
	}
	return out_px[2] > 0 && out_px[3] > 0;
}

enum gz_result gz_wire_decode_window(const void *bytes, size_t size,
				     struct gz_viewer_window *out_window)
{
	struct gz_viewer_window window = { 0 };
	struct gz_unpack unpack;
	double numbers[4];
	gz_unpack_begin(&unpack, bytes, size);
	window.known = gz_unpack_doubles(&unpack, unpack.map, "rect", numbers, 4);
	if (window.known && !take_rect(numbers, window.rect_px))
		unpack.refused = true;
	window.has_time =
		gz_unpack_time(&unpack, unpack.map, "timestamp", GZ_NS_PER_S, &window.time_ns);
	enum gz_result result = gz_unpack_end(&unpack);
	if (result == GZ_OK)
		*out_window = window;
	return result;
}
