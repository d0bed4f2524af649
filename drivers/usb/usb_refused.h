/**
 * @file
 * USB devices that the kernel's HID drivers would not take: their report descriptor cannot be, so
 * that there is no hidraw node and no driver of ours ever sees them. Found in sysfs, so that
 * whoever wonders why a tracker is missing is told.
 */
#ifndef GZ_DRIVERS_USB_REFUSED_H
#define GZ_DRIVERS_USB_REFUSED_H

#include <stddef.h>

#include "drivers/driver.h"

/** Where sysfs is mounted. */
#define GZ_SYSFS "/sys"

/**
 * List USB interfaces of class HID that have no driver, and HID devices on USB that have none;
 * where the kernel has its drivers for them at all.
 *
 * @param sysfs  GZ_SYSFS
 * @param[out] out_entries  none of them usable
 * @param room   how many fit
 * @return how many were written
 */
size_t gz_usb_list_refused(const char *sysfs, struct gz_device_entry *out_entries, size_t room);

#endif
