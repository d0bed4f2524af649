/**
 * @file
 * The USB side of a Tobii Eye Tracker 5: transfers in both directions, the conversation
 * (tobii5_session.h), and gaze in order of arrival. Callbacks run only within
 * gz_tobii5_link_prepare() and gz_tobii5_link_next(), on the calling thread.
 */
#ifndef GZ_DRIVERS_TOBII5_LINK_H
#define GZ_DRIVERS_TOBII5_LINK_H

#include <libusb.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "drivers/tobii5/tobii5_session.h"

/** Interface and endpoints (driver/src/libusb_transport.zig of the repository that tobii5_frame.h
 * names). */
#define GZ_TOBII5_INTERFACE    0
#define GZ_TOBII5_ENDPOINT_IN  0x83
#define GZ_TOBII5_ENDPOINT_OUT 0x05

/** Vendor requests to the interface, without data, that open and close a session (same source). */
#define GZ_TOBII5_SESSION_OPEN  0x41
#define GZ_TOBII5_SESSION_CLOSE 0x42

/** Transfers in flight, and their bytes. Chosen: the size is that of the description; at 33 Hz four
 * of them are 0.1 s, and libusb keeps what arrives between two calls. */
#define GZ_TOBII5_TRANSFERS     4
#define GZ_TOBII5_TRANSFER_SIZE 16384

/** Samples received and not yet read. If there are more, the oldest is dropped, which its counter
 * shows. Chosen: one second. */
#define GZ_TOBII5_QUEUE 32

/** A received sample. */
struct gz_tobii5_arrival {
	int64_t arrival_ns; /**< host time */
	struct gz_tobii5_gaze gaze;
};

/** The link. */
struct gz_tobii5_link;

/**
 * Prepare the transfers.
 *
 * @param context, handle  borrowed, outlive the link; the interface is claimed
 * @param log              borrowed, outlives the link; may be NULL
 * @param[out] out_link    owned by the caller: gz_tobii5_link_destroy()
 * @retval GZ_ERR_NO_MEM
 */
enum gz_result gz_tobii5_link_create(libusb_context *context, libusb_device_handle *handle,
				     const struct gz_log *log, struct gz_tobii5_link **out_link);

/**
 * Open the session; the conversation begins with gz_tobii5_link_prepare(). Blocks for up to 150 ms.
 *
 * @param wanted  display area to set; NULL to use that of the tracker
 * @retval GZ_ERR_NO_DEVICE, GZ_ERR_IO  logged
 */
enum gz_result gz_tobii5_link_start(struct gz_tobii5_link *link,
				    const struct gz_tobii5_area *wanted);

/**
 * Converse until the display area is settled or cannot be had, or the tracker is gone, or host time
 * is @p deadline_ns. gz_tobii5_link_next() continues from there.
 */
void gz_tobii5_link_prepare(struct gz_tobii5_link *link, int64_t deadline_ns);

/**
 * Wait for the next sample, in order of arrival. Subscribes to gaze if that has not been done.
 *
 *
 * @param deadline_ns  host time; one in the past polls
 * @param[out] out_arrival  written on GZ_OK only
 * @retval GZ_ERR_TIMEOUT    none in time
 * @retval GZ_ERR_NO_DEVICE  unplugged, stalled for good, or silent; all further calls return this
 *
 * Does not allocate; libusb keeps a few bytes for each transfer that it passes to the kernel.
 */
enum gz_result gz_tobii5_link_next(struct gz_tobii5_link *link, int64_t deadline_ns,
				   struct gz_tobii5_arrival *out_arrival);

/** The conversation; valid as long as the link is. */
const struct gz_tobii5_session *gz_tobii5_link_session(const struct gz_tobii5_link *link);

/** Malformed frames by enum gz_malformed, except STALE; valid as long as the link is. */
const uint64_t *gz_tobii5_link_malformed(const struct gz_tobii5_link *link);

/** Close the session, wait for the transfers to return, for at most a second, free and set to NULL.
 * Accepts a pointer to NULL. */
void gz_tobii5_link_destroy(struct gz_tobii5_link **link);

#endif
