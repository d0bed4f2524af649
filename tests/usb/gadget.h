/**
 * @file
 * A USB device made with configfs on one of the controllers of the guest that have no hardware
 * (dummy_hcd). Its functions are played by hid_gadget.h and functionfs.h. Every call fails the test
 * if the kernel refuses.
 */
#ifndef GZ_TESTS_USB_GADGET_H
#define GZ_TESTS_USB_GADGET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Identity of a device. */
struct gadget_identity {
	uint16_t vendor;
	uint16_t product;
	const char *manufacturer;
	const char *name;
	const char *serial;
};

/** A device. */
struct gadget {
	int controller; /**< 0 or 1: where it is plugged in */
	char path[64];  /**< path of its folder in configfs */
};

/** Make a device without functions, not plugged in, for @p controller. */
void gadget_make(struct gadget *gadget, int controller, const struct gadget_identity *identity);

/** Make the function @p kind ("hid", "ffs") with the name @p name. @param[out] path  of its folder,
 * @p size bytes */
void gadget_add_function(struct gadget *gadget, const char *kind, const char *name, char *path,
			 size_t size);

/** Add the function to the configuration of the device. */
void gadget_link_function(struct gadget *gadget, const char *kind, const char *name);

/** Write @p size bytes to the file @p name in @p folder. */
void gadget_write(const char *folder, const char *name, const void *bytes, size_t size);

/** Write formatted text to the file @p name in @p folder. */
void gadget_print(const char *folder, const char *name, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

/** Plug it in; returns before the host has enumerated it. */
void gadget_plug(struct gadget *gadget);

/** Unplug it. */
void gadget_unplug(struct gadget *gadget);

/** Unplug it and remove it from configfs. Never fails a test, so that a teardown may call it. */
void gadget_remove(struct gadget *gadget);

/** Stall an IN endpoint, until the host clears that. */
void gadget_stall(int endpoint);

#endif
