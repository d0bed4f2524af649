/**
 * @file
 * A USB device made of nothing but configfs and one of the guest's controllers without hardware
 * (dummy_hcd). Its functions are played by hid_gadget.h and functionfs.h. Every call fails the test
 * where the kernel refuses.
 */
#ifndef GZ_TESTS_USB_GADGET_H
#define GZ_TESTS_USB_GADGET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** What a device says of itself. */
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
	char path[64];  /**< of its folder in configfs */
};

/** Make a device without functions, unplugged, for @p controller. */
void gadget_make(struct gadget *gadget, int controller, const struct gadget_identity *identity);

/** Make the function @p kind ("hid", "ffs") called @p name; its folder into @p path of @p size. */
void gadget_add_function(struct gadget *gadget, const char *kind, const char *name, char *path,
			 size_t size);

/** Put the function into the device's configuration. */
void gadget_link_function(struct gadget *gadget, const char *kind, const char *name);

/** Write @p size bytes into the file @p name of @p folder. */
void gadget_write(const char *folder, const char *name, const void *bytes, size_t size);

/** The same for text made as by printf(). */
void gadget_print(const char *folder, const char *name, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

/** Plug it in; returns before the host has enumerated it. */
void gadget_plug(struct gadget *gadget);

/** Pull it out. */
void gadget_unplug(struct gadget *gadget);

/** Unplug it, and take configfs apart. Never fails a test, so that it may end one. */
void gadget_remove(struct gadget *gadget);

#endif
