/**
 * @file
 * libusb as far as our drivers use it, played by a test. A program that links this file has these
 * functions in place of the library's. Time is that of base/clock.h, which a test may play, too
 * (fake_clock.c).
 */
#ifndef GZ_TESTS_DRIVERS_FAKE_LIBUSB_H
#define GZ_TESTS_DRIVERS_FAKE_LIBUSB_H

#include <libusb.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Most devices, and most completions that wait to be delivered. */
enum { FAKE_USB_DEVICES_MAX = 4, FAKE_USB_SCRIPT_MAX = 512 };

/** One device. */
struct fake_usb_device {
	uint16_t vendor, product;
	int open_error, claim_error; /**< 0, or what libusb answers */
};

/** The bus and what happens on it. Zero-initialised is an empty one. */
struct fake_usb {
	struct fake_usb_device devices[FAKE_USB_DEVICES_MAX];
	int device_count;
	bool unplugged; /**< whatever is in flight comes back so */
	int init_error;
	int control_error; /**< of the next synchronous control transfers */
	int clear_error;
	int at_once; /**< completions of one wait; 0 for 3 */
	/** A device that answers each wait: a packet every so often; NULL for the script alone. */
	size_t (*packet)(void *user, unsigned char *bytes, size_t room);
	void *user;
	int64_t period_ns, due_ns;
	/* What was asked of it. */
	int submitted, in_flight, most_in_flight;
	int switched_on, switched_off; /**< requests, of either kind */
	int halts_cleared;
	int contexts, handles, claims, transfers; /**< now open; all 0 at the end */
};

extern struct fake_usb fake_usb;

/** An empty bus again. */
void fake_usb_reset(void);

/** Plug in a device; 0 is its place in fake_usb.devices. */
struct fake_usb_device *fake_usb_plug(uint16_t vendor, uint16_t product);

/** Let a bulk transfer come back with @p bytes, in the order of these calls. */
void fake_usb_deliver(const unsigned char *bytes, size_t size);

/** Let a bulk transfer come back as @p status, with nothing in it. */
void fake_usb_fail(enum libusb_transfer_status status);

#endif
