/**
 * @file
 * The gaze packets of a PlayStation VR2: bytes to numbers, no I/O.
 *
 * Layout after the public descriptions of it in Monado's psvr2 driver (psvr2_protocol.h: magic,
 * eyes, combined gaze, 324 bytes) and in PSVR2Toolkit (hmd2_gaze.h: time, frame counter, tracking
 * state, convergence, 328 bytes). Little-endian; a truth value is a u32, 0 for no:
 *
 *     0x000  u8[2]   "GS"
 *     0x002  u16     version
 *     0x004  u32     size; what it counts is described differently, so it is not relied on
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
 *     0x28   u32     place in the camera's picture known; f32[2]
 *     0x34   u32     position guide known; f32[2]
 *     0x40   u32     blink known; u32 blink
 *
 * The device's axes, as Monado turns them into OpenXR's (x and z change sign): +x to the wearer's
 * left, +y up, +z ahead. Here they become those of gz_display_to_mm(): +x right, +y down, +z ahead.
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

/** A ray in the head's frame: +x right, +y down, +z ahead. */
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
	float pupil_mm; /**< above 0; 0 if not known */
	bool blink;     /**< the device says that the eye is closed */
};

/** Numbers of a packet. */
struct gz_psvr2_packet {
	int64_t device_ns;
	uint32_t frame; /**< counts frames, also those that did not arrive; wraps */
	struct gz_psvr2_eye eye[GZ_EYE_COUNT];
	struct gz_psvr2_ray combined;
	bool has_convergence;
	float convergence_mm; /**< above 0; 0 if not known */
};

/**
 * Parse one packet. A field that is flagged as known but is not finite, or a direction that has no
 * length, counts as not known.
 *
 * @param bytes, size  as received, untrusted
 * @param[out] out_packet     written on success only
 * @param[out] out_malformed  what is wrong; written on failure only
 * @retval GZ_ERR_PROTOCOL  no length or magic of a packet, or a time beyond 292 years
 */
enum gz_result gz_psvr2_parse(const unsigned char *bytes, size_t size,
			      struct gz_psvr2_packet *out_packet, enum gz_malformed *out_malformed);

/** The same packet as bytes; for whoever plays the device. device_ns is cut to whole us. */
void gz_psvr2_print(const struct gz_psvr2_packet *packet,
		    unsigned char bytes[GZ_PSVR2_PACKET_SIZE]);

/** Control transfer that sets the gaze stream: bRequest, and report id, which is wValue too. */
#define GZ_PSVR2_SET_REPORT  0x09
#define GZ_PSVR2_GAZE_STREAM 0x0c

/**
 * The payload that switches the gaze stream on or off: u16 report id, u16 subcommand (1 on, 2 off),
 * u32 length of what follows, here 0. The device switches itself off where "on" is not repeated.
 */
void gz_psvr2_print_request(bool on, unsigned char bytes[GZ_PSVR2_REQUEST_SIZE]);

#endif
