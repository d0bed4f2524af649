/**
 * @file
 * What a viewer tells the daemon of itself, on the inlet: where its pointer is and where its window
 * is on the display. As the coders of wire.h.
 */
#ifndef GZ_PROTOCOL_WIRE_VIEWER_H
#define GZ_PROTOCOL_WIRE_VIEWER_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol/wire.h"

#define GZ_TOPIC_POINTER "pointer"
#define GZ_TOPIC_WINDOW  "window"

/** Farthest corner or side of a window, px. Chosen: many displays side by side. */
#define GZ_WINDOW_PX_MAX 1000000

/** The pointer at one moment. */
struct gz_viewer_pointer {
	bool known;            /**< false: it is not in the viewer's window */
	struct gz_point point; /**< normalised display area; only where known */
	bool has_time;
	int64_t time_ns; /**< host time; only with has_time */
};

/** The window at one moment. */
struct gz_viewer_window {
	bool known;     /**< false: it is closed */
	int rect_px[4]; /**< x y w h of its content on the display; only where known */
	bool has_time;
	int64_t time_ns; /**< host time; only with has_time */
};

/** {"point": [x, y] or nil, "timestamp": s or nil} */
enum gz_result gz_wire_encode_pointer(const struct gz_viewer_pointer *pointer,
				      struct gz_wire_message *out_message);

/** {"rect": [x, y, w, h] or nil, "timestamp": s or nil} */
enum gz_result gz_wire_encode_window(const struct gz_viewer_window *window,
				     struct gz_wire_message *out_message);

/** @retval GZ_ERR_PROTOCOL  no such map; *out_pointer is untouched */
enum gz_result gz_wire_decode_pointer(const void *bytes, size_t size,
				      struct gz_viewer_pointer *out_pointer);

/**
 * @retval GZ_ERR_PROTOCOL  no such map, numbers that are not whole or beyond GZ_WINDOW_PX_MAX, or
 *                          an empty rectangle; *out_window is untouched
 */
enum gz_result gz_wire_decode_window(const void *bytes, size_t size,
				     struct gz_viewer_window *out_window);

#endif
