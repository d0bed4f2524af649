/**
 * @file
 * What can be told of a USB device without opening it, from sysfs: for lists, for choosing, and for
 * messages that name the remedy. Nothing is sent to the device, so a program that uses it is not
 * disturbed.
 */
#ifndef GZ_DRIVERS_USB_DEVICE_H
#define GZ_DRIVERS_USB_DEVICE_H

#include <libusb.h>
#include <stdbool.h>
#include <stdint.h>

#include "drivers/driver.h"
#include "protocol/gaze.h"

/** What to do where a device node may not be opened; ends a sentence. */
#define GZ_USB_PERMISSION_REMEDY \
	"install the udev rule 70-gazecast.rules, then plug the tracker in again"

/** A USB device as sysfs describes it. */
struct gz_usb_device {
	uint16_t vendor, product;
	char name[GZ_NAME_SIZE];   /**< the product's, printable; empty if it has none */
	char serial[GZ_NAME_SIZE]; /**< printable; empty if it has none */
	char place[GZ_NAME_SIZE];  /**< "usb 1-2.3": the bus, and the ports to it */
	char node[32];             /**< "/dev/bus/usb/001/004" */
};

/** Describe @p device. Reads two small files; does not open the device. */
void gz_usb_describe(libusb_device *device, struct gz_usb_device *out_device);

/** Whether @p choice, a name or serial number, means this device. NULL or empty means any. */
bool gz_usb_is_chosen(const struct gz_usb_device *device, const char *choice);

/**
 * Whether a program may open it, and whether none has taken @p interface_number already.
 *
 * @param[out] out_entry  all fields
 */
void gz_usb_list_entry(const struct gz_usb_device *device, int interface_number,
		       struct gz_device_entry *out_entry);

/**
 * The result for an error of libusb's, for callers that log.
 *
 * @retval GZ_ERR_NO_DEVICE, GZ_ERR_ACCESS, GZ_ERR_BUSY, GZ_ERR_NO_MEM, GZ_ERR_TIMEOUT, GZ_ERR_IO
 */
enum gz_result gz_usb_result(int libusb_error);

#endif
