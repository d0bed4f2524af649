/**
 * @file
 * Gaze packets of a PlayStation VR2, from bytes to rays, and from rays to points on a screen. No
 * I/O.
 *
 * The layout follows two public descriptions: Monado's psvr2 driver (psvr2_protocol.h: magic, eyes,
 * combined gaze, 324 bytes) and PSVR2Toolkit (hmd2_gaze.h: time, frame counter, tracking state,
 * convergence, 328 bytes). Little-endian; a truth value is a u32, 0 for false:
 *
 *     0x000  u8[2]   "GS"
 *     0x002  u16     version
 *     0x004  u32     size; the descriptions differ in what it counts, so it is ignored
 *     0x050  i64     time of the frame, us
 *     0x058  u32     frame counter
 *     0x05c  eye     left
 *     0x0a4  eye     right
 *     0x0ec  u32     combined origin known; f32[3] origin, mm
 *     0x0fc  u32     combined direction known; f32[3] direction
 *     0x11c  u32     tracking state
 *     0x144  f32     distance at which the eyes converge, mm; missing from the short form
 *
 * and an eye, 72 bytes:
 *
 *     0x00   u32     origin known; f32[3] origin, mm
 *     0x10   u32     direction known; f32[3] direction
 *     0x20   u32     pupil known; f32 diameter, mm
 *     0x28   u32     position in the camera picture known; f32[2]
 *     0x34   u32     position guide known; f32[2]
 *     0x40   u32     blink known; u32 blink
 *
 * Device axes, as Monado converts them to OpenXR's (x and z change sign): +x to the wearer's left,
 * +y up, +z ahead. Here they become those of gz_display_to_mm(): +x right, +y down, +z ahead, from
 * the origin that the tracker uses (between the lenses), mm.
 *
 * The screen is flat and keeps its position relative to the head: the picture that a headset shows,
 * or a monitor in front of a chin rest.
 */
#ifndef GZ_DRIVERS_PSVR2_PACKET_H
#define GZ_DRIVERS_PSVR2_PACKET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "protocol/gaze.h"

/** Bytes of a packet, and of the form that ends before the convergence distance. */
#define GZ_PSVR2_PACKET_SIZE       328
#define GZ_PSVR2_PACKET_SIZE_SHORT 324

/** Bytes of a request to the device. */
#define GZ_PSVR2_REQUEST_SIZE 8

/** A ray in the frame of the head: +x right, +y down, +z ahead. */
struct gz_psvr2_ray {
	bool has_origin;
	bool has_direction;
	float origin_mm[3]; /**< finite; 0 if not known */
	float direction[3]; /**< unit vector; 0 if not known */
};

/** One eye. */
struct gz_psvr2_eye {
	struct gz_psvr2_ray ray;
	bool has_pupil;
	float pupil_mm; /**< diameter, above 0; 0 if not known */
	bool blink;     /**< the device reports that the eye is closed */
};

/** Numbers of a packet. */
struct gz_psvr2_packet {
	int64_t device_ns;
	uint32_t frame; /**< frame counter, including frames that did not arrive; wraps */
	struct gz_psvr2_eye eye[GZ_EYE_COUNT];
	struct gz_psvr2_ray combined;
	bool has_convergence;
	float convergence_mm; /**< above 0; 0 if not known */
};

/**
 * Parse one packet. A field that is flagged as known but is not finite, or a direction without
 * length, counts as not known.
 *
 * @param bytes, size  as received, untrusted
 * @param[out] out_packet     written on success only
 * @param[out] out_malformed  what is wrong; written on failure only
 * @retval GZ_ERR_PROTOCOL  wrong length or magic bytes, or a time beyond 292 years
 */
enum gz_result gz_psvr2_parse(const unsigned char *bytes, size_t size,
			      struct gz_psvr2_packet *out_packet, enum gz_malformed *out_malformed);

/** Control transfer that switches the gaze stream: its bRequest, and the report ID, which is also
 * its wValue. */
#define GZ_PSVR2_SET_REPORT  0x09
#define GZ_PSVR2_GAZE_STREAM 0x0c

/**
 * Write the payload that switches the gaze stream on or off: u16 report ID, u16 subcommand (1 on,
 * 2 off), u32 length of what follows, here 0. The device switches itself off unless "on" is
 * repeated.
 */
void gz_psvr2_print_request(bool on, unsigned char bytes[GZ_PSVR2_REQUEST_SIZE]);

/** The screen as the configuration describes it. */
struct gz_psvr2_screen_params {
	double distance_mm;  /**< of its centre, along +z; above 0 */
	double offset_mm[2]; /**< of its centre, right and down */
	double size_mm[2];   /**< width and height; above 0 */
	double turn_deg[3];  /**< about its centre: yaw (moves the right side nearer), then pitch
				(moves the lower edge nearer), then roll (clockwise) */
};

/** The screen as it is used in calculations; filled by gz_psvr2_screen_make(). */
struct gz_psvr2_screen {
	double centre_mm[3];
	double right[3], down[3], ahead[3]; /**< unit vectors; ahead is the normal */
	double size_mm[2];
};

/** Prepare a screen. @param params  in their ranges */
struct gz_psvr2_screen gz_psvr2_screen_make(const struct gz_psvr2_screen_params *params);

/**
 * Intersect a ray with the plane of the screen.
 *
 * @param[out] out_point  normalised, origin top left, outside [0, 1] beside the screen; written on
 *                        true only
 * @return false if the ray lacks an origin or a direction, leads away from the plane, is more than
 *         85 degrees off its normal (chosen: no eye turns that far in a headset) or meets it more
 *         than a million screens away (chosen: that is no measurement)
 */
bool gz_psvr2_screen_meet(const struct gz_psvr2_screen *screen, const struct gz_psvr2_ray *ray,
			  struct gz_point *out_point);

#endif
