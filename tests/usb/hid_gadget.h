/**
 * @file
 * An eye tracker over the kernel's own HID function (f_hid): reports written to /dev/hidgN arrive
 * at the host's /dev/hidraw0 through the whole USB stack. It answers every feature report with
 * zeros.
 */
#ifndef GZ_TESTS_USB_HID_GADGET_H
#define GZ_TESTS_USB_HID_GADGET_H

#include "gadget.h"
#include "hid_layout.h"
#include "made_gaze.h"

/** A tracker. Zero-initialised is none. */
struct hid_gadget {
	struct gadget gadget;
	const struct hid_layout *layout;
	int fd; /**< of /dev/hidgN */
	struct made_stream stream;
};

/** Make the tracker for controller 0 or 1 and plug it in. */
void hid_gadget_plug(struct hid_gadget *tracker, int controller, const struct hid_layout *layout,
		     const char *name, const char *serial);

/** Send one report of any bytes; fails the test where the kernel does not take it. */
void hid_gadget_send(struct hid_gadget *tracker, const void *report, size_t size);

/** Stop its stream, unplug and take apart. For a teardown, too. */
void hid_gadget_remove(struct hid_gadget *tracker);

#endif
