/**
 * @file
 * The framing of a Tobii Eye Tracker 5: from transfers of its bulk endpoint to frames. No I/O.
 *
 * The layout follows a public description, the repository Aetherall/tobiifree
 * (driver/src/tobiifree_core.zig, at d303e47), which was made by watching the USB of such a
 * tracker. Nothing of it has been tried on a tracker here. What both sides send is wrapped in
 * envelopes:
 *
 *     0   u8      direction: 0 to the tracker, 1 from it
 *     1   u8[3]   0
 *     4   u32     little-endian: bytes that follow; from the tracker, the 8 of the envelope count
 *     8   ...     a frame, or a part of one
 *
 * and a frame, big-endian:
 *
 *     0   u32     kind: 0x51 request, 0x52 response, 0x53 notification
 *     4   u32     number of the request; a response repeats it
 *     8   u32     0 in requests
 *     12  u32     operation, for example 0x500 for gaze
 *     16  u32     0 in requests
 *     20  u32     bytes of the payload that follows
 *
 * A frame that is too long for a transfer comes in several. A transfer that continues a frame has
 * an envelope of its own, whether or not the first one announced the whole frame, or none. All of
 * these are read. Frames may also share a transfer.
 *
 * Payloads have any length: the calibration of one tracker has 414,844 bytes, that of a related one
 * 1480 (issues 3 and 5 of that repository; the first reports that longer ones than expected were
 * written past the end of a buffer there). Here a payload beyond GZ_TOBII5_PAYLOAD_MAX is counted
 * and thrown away as it comes, and nothing is allocated.
 */
#ifndef GZ_DRIVERS_TOBII5_FRAME_H
#define GZ_DRIVERS_TOBII5_FRAME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "protocol/gaze.h"

/** Bytes of an envelope and of the head of a frame. */
#define GZ_TOBII5_ENVELOPE_SIZE 8
#define GZ_TOBII5_HEAD_SIZE     24

/** Bytes of a payload that are kept. Chosen: all 40 described columns of a gaze row are 1719 bytes,
 * a display area is 164. */
#define GZ_TOBII5_PAYLOAD_MAX 4096

/** Longest payload of a frame, bytes. Chosen: more than twice the longest one that was reported. */
#define GZ_TOBII5_FRAME_MAX (1u << 20)

/** Kind of a frame. */
enum gz_tobii5_kind {
	GZ_TOBII5_REQUEST = 0x51,
	GZ_TOBII5_RESPONSE = 0x52,
	GZ_TOBII5_NOTIFICATION = 0x53,
};

/** A frame from the tracker. */
struct gz_tobii5_frame {
	enum gz_tobii5_kind kind;
	uint32_t number; /**< of the request that a response answers */
	uint32_t operation;
	uint32_t size;                /**< bytes of the payload, as sent */
	const unsigned char *payload; /**< its first bytes: size of them, but at most
					 GZ_TOBII5_PAYLOAD_MAX; valid until the next call */
};

/** Puts transfers together. Zero-initialised is the start state. */
struct gz_tobii5_reader {
	const unsigned char *bytes; /**< what is left of the transfer; borrowed */
	size_t size;
	bool is_start; /**< nothing of the transfer has been read */
	bool is_torn;  /**< the transfer begins a frame although the last one is not complete */
	unsigned char envelope[GZ_TOBII5_ENVELOPE_SIZE];
	uint32_t envelope_got;
	uint32_t envelope_left; /**< bytes that the envelope still announces */
	unsigned char head[GZ_TOBII5_HEAD_SIZE];
	uint32_t head_got;
	uint32_t payload_size, payload_got;
	unsigned char payload[GZ_TOBII5_PAYLOAD_MAX];
};

/** Give the reader a transfer. What was left of the last one is dropped.
 *
 * @param bytes, size  as received, untrusted; borrowed until gz_tobii5_reader_next() has returned
 *                     GZ_ERR_END
 */
void gz_tobii5_reader_take(struct gz_tobii5_reader *reader, const unsigned char *bytes,
			   size_t size);

/**
 * The next frame of the transfer.
 *
 * @param[out] out_frame      written on success only
 * @param[out] out_malformed  what is wrong; written with GZ_ERR_PROTOCOL only
 * @retval GZ_ERR_END       the transfer has no further complete frame
 * @retval GZ_ERR_PROTOCOL  not an envelope or a frame, or one that is too long: the rest of the
 *                          transfer is dropped; or a frame that another one interrupts. Call again.
 */
enum gz_result gz_tobii5_reader_next(struct gz_tobii5_reader *reader,
				     struct gz_tobii5_frame *out_frame,
				     enum gz_malformed *out_malformed);

#endif
