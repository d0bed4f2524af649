/**
 * @file
 * Finds and opens a tracker on USB by its vendor and product numbers, for drivers of
 * vendor-specific interfaces. What cannot be opened is logged with the remedy.
 */
#ifndef GZ_DRIVERS_USB_OPEN_H
#define GZ_DRIVERS_USB_OPEN_H

#include <libusb.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "base/result.h"
#include "drivers/device/device.h"
#include "drivers/usb/usb_device.h"

/** A product that a driver knows. */
struct gz_usb_product {
	uint16_t vendor, product;
	const char *name; /**< what people call it */
	bool is_named;    /**< use the name that it has itself, if it has one */
	/** Why it cannot be used, and what to do; NULL if it can. */
	const char *unusable;
};

/** The products of a driver. */
struct gz_usb_kind {
	const char *name;                      /**< of what is missing if there is none */
	const struct gz_usb_product *products; /**< borrowed */
	size_t product_count;
	int interface_number;
};

/** An open device. Zero-initialised is none. */
struct gz_usb_opened {
	libusb_context *context;
	libusb_device_handle *handle;
	struct gz_usb_device usb;
	int interface_number;
	bool is_claimed;
};

/**
 * Open the first device of a kind that can be opened, and claim its interface. The others are
 * logged, so that the user knows what to choose from.
 *
 * @param choice  name or serial number, or NULL or empty for any
 * @param log     may be NULL
 * @param[out] out_opened  gz_usb_close() also after a failure
 * @retval GZ_ERR_NO_DEVICE  none is present, or none that can be used; logged
 * @retval GZ_ERR_BUSY, GZ_ERR_ACCESS, GZ_ERR_NO_MEM, GZ_ERR_IO  logged
 */
enum gz_result gz_usb_open(const struct gz_usb_kind *kind, const char *choice,
			   const struct gz_log *log, struct gz_usb_opened *out_opened);

/** Release and close; accepts one that is not open. */
void gz_usb_close(struct gz_usb_opened *opened);

/**
 * List the devices of a kind, as struct gz_driver describes it. Opens nothing.
 *
 * @param[out] out_entries  room for GZ_DEVICE_ENTRIES_MAX
 * @return how many were written
 */
size_t gz_usb_list(const struct gz_usb_kind *kind, const struct gz_log *log,
		   struct gz_device_entry *out_entries);

#endif
