/**
 * @file
 * The payloads of a Tobii Eye Tracker 5: gaze and display area, from bytes to numbers, and the
 * requests to it. No I/O. See tobii5_frame.h for where the layout is described; driver/src/tlv.zig
 * of the same repository describes the fields, sdk/src/protocol.ts the columns.
 *
 * A payload is two bytes of unknown meaning (0 in requests) and then fields, big-endian: u8 type,
 * u32 bytes of the body, body. Types:
 *
 *     2   u32
 *     3   i32, 16 bits of it a fraction
 *     4   i64, 42 bits of it a fraction
 *     5   u32 tag: the beginning of a struct, whose members are the next fields
 *     6   i64
 *     7   u64
 *     23  a list of u32, the first one its length (only in requests)
 *
 * Bits 16 to 27 of a tag are the number of members. The description says so of a row; it holds of
 * all structs there, and by it the driver skips structs that it does not know.
 *
 *     0x…0bb8  row: its members are columns
 *     0x20bb9  column: u32 number of the column, value
 *     0x21f40  point: two numbers of type 4
 *     0x31f41  point in space: three numbers of type 4
 *
 * Columns of gaze that are read, for the left and right eye, or both. Lengths are mm. The frame of
 * the tracker has its origin at the sensors: +x right, +y up, +z towards the user.
 *
 *     0x01        i64    time, us
 *     0x02, 0x08  point  eye in space, calibrated
 *     0x04, 0x0a  point  where it looks, in space, on the plane of the display area
 *     0x05, 0x0b  point  where it looks, normalised to the display area, origin top left
 *     0x06, 0x0c  fix    pupil diameter; -1 if not known
 *     0x07, 0x0d  u32    0 if the eye is seen, 4 if not; perhaps missing from a 4C
 *     0x14        u32    counter of frames
 *     0x1e, 0x1f  u32    1 if 0x05, 0x0b are known
 *     0x20        point  where both eyes look, before the tracker's own smoothing
 *     0x21        u32    1 if 0x20 is known
 *
 * The smoothed point (0x1c) is not read: smoothing is the task of the pipeline.
 */
#ifndef GZ_DRIVERS_TOBII5_FIELDS_H
#define GZ_DRIVERS_TOBII5_FIELDS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "protocol/gaze.h"

/** Operation of a notification with gaze, and number of its stream. */
#define GZ_TOBII5_GAZE 0x500

/** What a tracker measured. Fields that it did not measure are NaN. */
struct gz_tobii5_gaze {
	int64_t device_ns;
	bool has_counter;
	uint32_t counter;      /**< of frames, including those that are never sent; wraps */
	struct gz_point point; /**< of both eyes */
	bool valid;            /**< of point */
	struct gz_eye_sample eye[GZ_EYE_COUNT]; /**< in the frame of the tracker; confidence NaN */
	uint32_t strange; /**< number of a column that is not as described; 0 if there is none */
};

/**
 * Parse the payload of a notification GZ_TOBII5_GAZE.
 *
 * @param bytes, size  untrusted
 * @param[out] out_gaze       written on success only; all numbers finite or NaN
 * @param[out] out_malformed  what is wrong; written on failure only
 * @retval GZ_ERR_PROTOCOL  not a row of columns, cut off, or without a time
 */
enum gz_result gz_tobii5_parse_gaze(const unsigned char *bytes, size_t size,
				    struct gz_tobii5_gaze *out_gaze,
				    enum gz_malformed *out_malformed);

/** Corners of a display area. */
enum gz_tobii5_corner {
	GZ_TOBII5_TOP_LEFT,
	GZ_TOBII5_TOP_RIGHT,
	GZ_TOBII5_BOTTOM_LEFT,
	GZ_TOBII5_CORNER_COUNT,
};

/** Where the display is, in the frame of the tracker, mm. */
struct gz_tobii5_area {
	double corner_mm[GZ_TOBII5_CORNER_COUNT][3];
};

/**
 * Parse the response to a request for the display area: three points in space.
 *
 * @param bytes, size  untrusted
 * @param[out] out_area  written on success only; finite
 * @retval GZ_ERR_PROTOCOL  not three points
 */
enum gz_result gz_tobii5_parse_area(const unsigned char *bytes, size_t size,
				    struct gz_tobii5_area *out_area);

/** How the configuration describes the place of the screen. */
struct gz_tobii5_screen_params {
	double size_mm[2];   /**< width and height; above 0 */
	double offset_mm[3]; /**< of the middle of its lower edge from the tracker: right, up,
				towards the user */
	double tilt_deg;     /**< how far its upper edge leans back, -90 to 90 */
};

/** The area of a screen. */
struct gz_tobii5_area gz_tobii5_area_make(const struct gz_tobii5_screen_params *params);

/** Width and height, mm; 0 or more. */
void gz_tobii5_area_size(const struct gz_tobii5_area *area, double out_mm[2]);

/** Whether the area can be a screen: each side 50 mm to 5 m. A tracker that has lost power has an
 * area of 4 mm (kymotsujason/tobii-gaze-linux, CLAUDE.md); 50 mm is that project's limit, and
 * 5 m that of the driver hid. */
bool gz_tobii5_area_is_screen(const struct gz_tobii5_area *area);

/** Whether all corners are within 1 mm of each other. */
bool gz_tobii5_area_is_near(const struct gz_tobii5_area *a, const struct gz_tobii5_area *b);

/** Bytes of the longest request, with its envelope. */
#define GZ_TOBII5_REQUEST_MAX 196

/** What can be asked of the tracker. */
enum gz_tobii5_request {
	GZ_TOBII5_HELLO,     /**< names the versions of the protocol, 1.0 to 1.8; answered */
	GZ_TOBII5_GET_AREA,  /**< answered with the display area */
	GZ_TOBII5_SET_AREA,  /**< no answer is described */
	GZ_TOBII5_SUBSCRIBE, /**< to gaze; no answer is described */
};

/**
 * Write a request with its envelope.
 *
 * @param number  repeated by the response
 * @param area    of GZ_TOBII5_SET_AREA, within 1 km; otherwise NULL
 * @return bytes written
 */
size_t gz_tobii5_print_request(enum gz_tobii5_request request, uint32_t number,
			       const struct gz_tobii5_area *area,
			       unsigned char bytes[GZ_TOBII5_REQUEST_MAX]);

#endif
