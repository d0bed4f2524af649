/**
 * @file
 * The USB side of a PlayStation VR2's gaze stream: the packets of its endpoint, and the repeated
 * request that keeps the stream on. Callbacks run only within gz_psvr2_link_next(), on the reading
 * thread.
 */
#ifndef GZ_DRIVERS_PSVR2_LINK_H
#define GZ_DRIVERS_PSVR2_LINK_H

#include <libusb.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "drivers/psvr2/psvr2_packet.h"

/** The device, and where its gaze comes from (Monado, psvr2_protocol.h). */
#define GZ_PSVR2_VENDOR    0x054c
#define GZ_PSVR2_PRODUCT   0x0cde
#define GZ_PSVR2_INTERFACE 5
#define GZ_PSVR2_ENDPOINT  0x85

/** Transfers in flight. Chosen: a reader that is held up for several frames loses none. */
#define GZ_PSVR2_TRANSFERS 8

/** Packets received and not yet read. If there are more, the oldest is dropped, which its frame
 * number shows. Chosen: libusb delivers at most 25 transfers at once. */
#define GZ_PSVR2_QUEUE 32

/** Bytes of a transfer: a whole number of packets of any bulk endpoint (64, 512 or 1024 bytes), so
 * that a report that is too long arrives as such. */
#define GZ_PSVR2_TRANSFER_SIZE 1024

/** Time between two requests for the stream, ms. Chosen: Monado's second. */
#define GZ_PSVR2_KEEPALIVE_MS 1000

/** A received packet. */
struct gz_psvr2_arrival {
	int64_t arrival_ns; /**< host time */
	struct gz_psvr2_packet packet;
};

/** The link. */
struct gz_psvr2_link;

/**
 * Prepare the transfers.
 *
 * @param context, handle  borrowed, outlive the link; the interface is claimed
 * @param log              borrowed, outlives the link; may be NULL
 * @param[out] out_link    owned by the caller: gz_psvr2_link_destroy()
 * @retval GZ_ERR_NO_MEM
 */
enum gz_result gz_psvr2_link_create(libusb_context *context, libusb_device_handle *handle,
				    const struct gz_log *log, struct gz_psvr2_link **out_link);

/**
 * Switch the stream on. Blocks for up to 150 ms.
 *
 * @retval GZ_ERR_NO_DEVICE, GZ_ERR_IO, GZ_ERR_TIMEOUT  logged
 */
enum gz_result gz_psvr2_link_start(struct gz_psvr2_link *link);

/**
 * Wait for the next packet, in order of arrival.
 *
 * @param deadline_ns  host time; one in the past polls
 * @param[out] out_arrival  written on GZ_OK only
 * @retval GZ_ERR_TIMEOUT    none in time
 * @retval GZ_ERR_NO_DEVICE  unplugged, or stalled for good; all further calls return this
 *
 * Does not allocate; libusb keeps a few bytes for each transfer that it passes to the kernel.
 */
enum gz_result gz_psvr2_link_next(struct gz_psvr2_link *link, int64_t deadline_ns,
				  struct gz_psvr2_arrival *out_arrival);

/** Malformed packets by enum gz_malformed, except STALE; valid as long as the link is. */
const uint64_t *gz_psvr2_link_malformed(const struct gz_psvr2_link *link);

/** Switch the stream off, wait for the transfers to return, for at most a second, free and set to
 * NULL. Accepts a pointer to NULL. */
void gz_psvr2_link_destroy(struct gz_psvr2_link **link);

#endif
