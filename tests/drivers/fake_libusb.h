/**
 * @file
 * A fake libusb with the functions that our drivers use. A program that links this file has them in
 * place of those of the library. Time is that of base/clock.h, which a test may replace, too
 * (fake_clock.c).
 */
#ifndef GZ_TESTS_DRIVERS_FAKE_LIBUSB_H
#define GZ_TESTS_DRIVERS_FAKE_LIBUSB_H

#include <libusb.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Most devices, and most completions in the script. */
enum { FAKE_USB_DEVICES_MAX = 4, FAKE_USB_SCRIPT_MAX = 512 };

/** One device. */
struct fake_usb_device {
	uint16_t vendor, product;
	int open_error, claim_error; /**< 0, or the error that libusb returns */
};

/** The bus and what happens on it. Zero-initialised is an empty bus. */
struct fake_usb {
	struct fake_usb_device devices[FAKE_USB_DEVICES_MAX];
	int device_count;
	bool unplugged; /**< all transfers in flight complete with LIBUSB_TRANSFER_NO_DEVICE */
	int init_error;
	int control_error; /**< result of the next synchronous control transfers */
	int clear_error;
	int at_once; /**< completions for each wait; 0 means 3 */
	/** A device that sends a packet every period_ns; NULL: only the script. */
	size_t (*packet)(void *user, unsigned char *bytes, size_t room);
	void *user;
	int64_t period_ns, due_ns;
	/** Receives what is sent to a bulk OUT endpoint; the answer of @p room bytes at most, which
	 * it writes to @p reply, arrives on the IN endpoint. NULL: nothing may be sent. */
	size_t (*request)(void *user, const unsigned char *bytes, size_t size, unsigned char *reply,
			  size_t room);
	void *request_user;
	enum libusb_transfer_status request_status; /**< of what is sent */
	/** Vendor requests without data to interface 0, in place of those of the PS VR2: of each
	 * bRequest in turn, how many came. */
	int opened, closed;
	bool has_sessions;
	/* What the driver did. */
	int submitted, in_flight, most_in_flight;
	int switched_on, switched_off; /**< requests, synchronous or not */
	int halts_cleared;
	int contexts, handles, claims, transfers; /**< open now; all 0 at the end */
};

extern struct fake_usb fake_usb;

/** Empty the bus. */
void fake_usb_reset(void);

/** Plug in a device; the first one is fake_usb.devices[0]. */
struct fake_usb_device *fake_usb_plug(uint16_t vendor, uint16_t product);

/** Append to the script: a bulk transfer completes with @p bytes. */
void fake_usb_deliver(const unsigned char *bytes, size_t size);

/** Append to the script: a bulk transfer completes with @p status and no data. */
void fake_usb_fail(enum libusb_transfer_status status);

#endif
