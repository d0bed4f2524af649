/**
 * @file
 * What sysfs says about USB devices, for lists, for choosing a device, and for messages that name
 * the remedy. Nothing is opened and nothing is sent to a device, so a program that uses it is not
 * disturbed.
 */
#ifndef GZ_DRIVERS_USB_DEVICE_H
#define GZ_DRIVERS_USB_DEVICE_H

#include <libusb.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "drivers/device/device.h"
#include "protocol/gaze.h"

/** Where sysfs is mounted. */
#define GZ_SYSFS "/sys"

/** A USB device as sysfs describes it. */
struct gz_usb_device {
	uint16_t vendor, product;
	char name[GZ_NAME_SIZE];   /**< product name, printable; empty if it has none */
	char serial[GZ_NAME_SIZE]; /**< printable; empty if it has none */
	char place[GZ_NAME_SIZE];  /**< "usb 1-2.3": the bus, and the ports to the device */
	char node[32];             /**< "/dev/bus/usb/001/004" */
};

/** Describe @p device. Reads two small files; does not open the device. */
void gz_usb_describe(libusb_device *device, struct gz_usb_device *out_device);

/**
 * List a device: usable if this program may open it and no program uses @p interface_number.
 *
 * @param[out] out_entry  all fields
 */
void gz_usb_list_entry(const struct gz_usb_device *device, int interface_number,
		       struct gz_device_entry *out_entry);

/**
 * List USB devices that the kernel's HID drivers refused because their report descriptor is
 * malformed. They have no hidraw node, so no driver of ours ever sees them: interfaces of class HID
 * without a driver, and HID devices on USB without a driver. If the kernel's HID drivers are not
 * loaded, nothing is listed.
 *
 * @param sysfs  GZ_SYSFS
 * @param[out] out_entries  none of them usable
 * @param room   how many fit
 * @return how many were written
 */
size_t gz_usb_list_refused(const char *sysfs, struct gz_device_entry *out_entries, size_t room);

/**
 * The result for an error of libusb, for callers that log.
 *
 * @return GZ_OK for 0 and positive numbers; GZ_ERR_NO_DEVICE, GZ_ERR_ACCESS, GZ_ERR_BUSY,
 *         GZ_ERR_NO_MEM or GZ_ERR_TIMEOUT for the errors of that meaning, else GZ_ERR_IO
 */
enum gz_result gz_usb_result(int libusb_error);

#endif
