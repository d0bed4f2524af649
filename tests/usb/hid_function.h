/**
 * @file
 * An eye tracker whose HID interface is played here (FunctionFS), including feature reports: it
 * states its screen and its rate and accepts a device mode. Its layout is HID_LAYOUT_REFERENCE.
 */
#ifndef GZ_TESTS_USB_HID_FUNCTION_H
#define GZ_TESTS_USB_HID_FUNCTION_H

#include <stdatomic.h>

#include "functionfs.h"
#include "hid_gadget.h"
#include "made_gaze.h"

/** A tracker. Zero-initialised is none. */
struct hid_function {
	/* Set before it is plugged in. */
	int32_t screen_um[2];   /**< width and height of the Configuration report */
	bool broken_descriptor; /**< its report descriptor is malformed */
	bool refuses_features;  /**< it stalls every feature report */

	struct gadget gadget;
	struct functionfs function;
	struct made_stream stream;
	bool made;
	_Atomic uint32_t mode; /**< of the newest Device Mode Request; 4 before the first one */
	_Atomic uint32_t mode_requests;
	_Atomic uint32_t descriptor_reads;
	_Atomic uint32_t feature_reads; /**< GET_REPORT requests for feature reports */
};

/** Make the tracker for controller 0 or 1 and plug it in. */
void hid_function_plug(struct hid_function *tracker, int controller, const char *name,
		       const char *serial);

/** Stop its stream, unplug and remove it. For teardowns, too. */
void hid_function_remove(struct hid_function *tracker);

#endif
