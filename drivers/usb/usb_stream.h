/**
 * @file
 * Reads one bulk IN endpoint without gaps: several transfers in flight, each submitted again from
 * its callback, and the reset of a stalled endpoint. Callbacks run only within
 * gz_usb_stream_handle(), on the reading thread.
 */
#ifndef GZ_DRIVERS_USB_STREAM_H
#define GZ_DRIVERS_USB_STREAM_H

#include <libusb.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"

/** First pause before a stalled endpoint is used again, ms; it doubles with each attempt. After
 * GZ_USB_STREAM_RECOVERIES attempts without gz_usb_stream_confirm() the device counts as gone.
 * Chosen: 10 ms go unnoticed, and all attempts last 0.6 s. */
#define GZ_USB_STREAM_RECOVERY_MS 10
#define GZ_USB_STREAM_RECOVERIES  6

/** How long transfers may take to return at the end, ns. */
#define GZ_USB_STREAM_STOP_NS INT64_C(1000000000)

/** What to read, and who takes it. Copied by gz_usb_stream_create(). */
struct gz_usb_stream_params {
	libusb_context *context; /**< borrowed, outlives the stream */
	libusb_device_handle
		*handle;          /**< borrowed, outlives the stream; the interface is claimed */
	const struct gz_log *log; /**< borrowed, outlives the stream; may be NULL */
	unsigned char endpoint;   /**< address, with the bit for IN */
	int transfers;            /**< in flight, above 0 */
	int transfer_size; /**< bytes, a whole number of packets of any bulk endpoint (64, 512 or
			      1024 bytes), so that a transfer that is too long arrives as such */

	/** A transfer has arrived; @p size may be 0. */
	void (*take)(void *user, const unsigned char *bytes, int size);
	/** A transfer was longer than transfer_size and is lost. */
	void (*take_too_long)(void *user);
	/** The endpoint has been reset; the device may have stopped its stream. */
	void (*restarted)(void *user);
	void *user; /**< first argument of the callbacks */
};

/** A stream. */
struct gz_usb_stream;

/**
 * Prepare the transfers.
 *
 * @param[out] out_stream  owned by the caller: gz_usb_stream_destroy()
 * @retval GZ_ERR_NO_MEM
 */
enum gz_result gz_usb_stream_create(const struct gz_usb_stream_params *params,
				    struct gz_usb_stream **out_stream);

/** Put all transfers in flight. If that fails, the stream recovers or is gone. */
void gz_usb_stream_submit(struct gz_usb_stream *stream);

/**
 * Let libusb call back, and reset the endpoint if that is due, until something has happened or host
 * time is @p deadline_ns; one in the past polls. libusb keeps a few bytes for each transfer that it
 * passes to the kernel; nothing else is allocated.
 */
void gz_usb_stream_handle(struct gz_usb_stream *stream, int64_t deadline_ns);

/** The device works: what has arrived makes sense. Recoveries are counted from here. */
void gz_usb_stream_confirm(struct gz_usb_stream *stream);

/** The device is gone. Also for transfers of the caller that end so. */
void gz_usb_stream_lose(struct gz_usb_stream *stream);

/** Whether it is unplugged, or stalled for good. Nothing more arrives then. */
bool gz_usb_stream_is_gone(const struct gz_usb_stream *stream);

/**
 * Take all transfers back. @p others, if not NULL, tells whether transfers of the caller are still
 * in flight; it is called with the stream's user argument, and those are waited for, too.
 *
 * @return whether all have returned within GZ_USB_STREAM_STOP_NS. If not, the kernel may still
 *         write into them: neither their memory nor the stream may be freed. That is logged.
 */
bool gz_usb_stream_stop(struct gz_usb_stream *stream, bool (*others)(const void *user));

/** Free and set to NULL, after gz_usb_stream_stop() has returned true. Accepts a pointer to NULL.
 */
void gz_usb_stream_destroy(struct gz_usb_stream **stream);

#endif
