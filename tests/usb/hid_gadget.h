/**
 * @file
 * An eye tracker by the kernel's own HID function (f_hid): reports written to /dev/hidgN arrive at
 * the host's /dev/hidraw0 through the whole USB stack. It answers every feature report with zeros.
 */
#ifndef GZ_TESTS_USB_HID_GADGET_H
#define GZ_TESTS_USB_HID_GADGET_H

#include "drivers/hid_made.h"
#include "gadget.h"
#include "made_gaze.h"

/** The eyes of every sample that has them: mm right of, below and in front of the top left corner
 * of the screen. */
#define HID_LEFT_EYE_MM             \
	{                           \
		-32.0, -50.0, 610.0 \
	}
#define HID_RIGHT_EYE_MM           \
	{                          \
		31.0, -51.0, 605.0 \
	}

/** Lay out a report of @p sample. @return its bytes; at most HID_REPORT_MAX */
size_t hid_gadget_report(enum hid_layout layout, const struct made_sample *sample, uint8_t *report);

/** A tracker. Zero-initialised is none. */
struct hid_gadget {
	struct gadget gadget;
	enum hid_layout layout;
	bool made;
	int fd; /**< of /dev/hidgN */
	struct made_stream stream;
};

/** Make the tracker for controller 0 or 1 and plug it in. */
void hid_gadget_plug(struct hid_gadget *tracker, int controller, enum hid_layout layout,
		     const char *name, const char *serial);

/** Send a report with any content; fails the test if the kernel does not accept it. */
void hid_gadget_send(struct hid_gadget *tracker, const void *report, size_t size);

/** Stop its stream, unplug and remove it. For teardowns, too. */
void hid_gadget_remove(struct hid_gadget *tracker);

#endif
