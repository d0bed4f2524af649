#include "suite.h"

#include "hid_function.h"

#include <linux/hid.h>
#include <string.h>

enum {
	REPORT_FEATURE = 3,
	REPORT_CAPABILITIES = 0x11,
	REPORT_CONFIGURATION = 0x12,
	REPORT_STATUS = 0x13,
	REPORT_CONTROL = 0x14,
	STATUS_READY = 1,
	DESCRIPTOR_HID = 0x21,
	DESCRIPTOR_REPORT = 0x22,
};

/* The end of a collection that was never opened. */
static const uint8_t broken_descriptor[] = { 0x05, 0x12, 0x09, 0x01, 0xC0, 0xC0, 0x81, 0x02 };

/* Write the report descriptor. @return its size */
static size_t report_descriptor(const struct hid_function *tracker, uint8_t *bytes)
{
	struct hid_made made = { 0 };
	if (tracker->broken_descriptor) {
		memcpy(bytes, broken_descriptor, sizeof broken_descriptor);
		return sizeof broken_descriptor;
	}
	hid_made_tracker(&made, HID_LAYOUT_REFERENCE);
	assert_true(made.size <= FUNCTIONFS_CONTROL_MAX);
	memcpy(bytes, made.bytes, made.size);
	return made.size;
}

/* Write a feature report, with its ID. @return its size, -1 if there is none */
static ssize_t get_feature(struct hid_function *tracker, uint8_t id, uint8_t *report)
{
	enum hid_layout layout = HID_LAYOUT_REFERENCE;
	tracker->feature_reads++;
	switch (id) {
	case REPORT_CAPABILITIES:
		return (ssize_t)hid_made_capabilities(layout, 500000, 650000, 900000, report);
	case REPORT_CONFIGURATION:
		return (ssize_t)hid_made_configuration(layout, tracker->screen_um[0],
						       tracker->screen_um[1], report);
	case REPORT_STATUS:
		return (ssize_t)hid_made_status(layout, STATUS_READY, MADE_RATE_HZ, report);
	case REPORT_CONTROL:
		return (ssize_t)hid_made_control(layout, tracker->mode, report);
	default:
		return -1;
	}
}

static ssize_t get_descriptor(struct hid_function *tracker, uint8_t type, uint8_t *bytes)
{
	if (type != DESCRIPTOR_REPORT)
		return -1;
	tracker->descriptor_reads++;
	return (ssize_t)report_descriptor(tracker, bytes);
}

static ssize_t get(void *player, const struct usb_ctrlrequest *request, uint8_t *bytes)
{
	struct hid_function *tracker = player;
	uint8_t high = (uint8_t)(request->wValue >> 8), low = (uint8_t)request->wValue;
	if (request->bRequest == USB_REQ_GET_DESCRIPTOR &&
	    (request->bRequestType & USB_TYPE_MASK) == USB_TYPE_STANDARD)
		return get_descriptor(tracker, high, bytes);
	if (request->bRequest == HID_REQ_GET_REPORT && high == REPORT_FEATURE &&
	    !tracker->refuses_features)
		return get_feature(tracker, low, bytes);
	return -1;
}

static void set(void *player, const struct usb_ctrlrequest *request, const uint8_t *bytes,
		size_t size)
{
	struct hid_function *tracker = player;
	if (request->bRequest == HID_REQ_SET_REPORT &&
	    request->wValue == (REPORT_FEATURE << 8 | REPORT_CONTROL) && size == 2 &&
	    bytes[0] == REPORT_CONTROL) {
		tracker->mode = bytes[1];
		tracker->mode_requests++;
	}
}

static const struct functionfs_player calls = { .get = get, .set = set };

/* The interface, HID and endpoint descriptors (HID 1.11, section 7.1). Packets have 64 bytes, the
 * maximum at full speed, so that the reference report of 65 bytes takes two. */
static void start_function(struct hid_function *tracker, const char *serial)
{
	uint8_t descriptor[FUNCTIONFS_CONTROL_MAX];
	size_t size = report_descriptor(tracker, descriptor);
	const uint8_t bytes[] = {
		9,
		USB_DT_INTERFACE,
		0,
		0,
		1,
		USB_CLASS_HID,
		0,
		0,
		0,
		9,
		DESCRIPTOR_HID,
		0x11,
		0x01,
		0,
		1,
		DESCRIPTOR_REPORT,
		size & 0xFF,
		(uint8_t)(size >> 8),
		7,
		USB_DT_ENDPOINT,
		0x81,
		USB_ENDPOINT_XFER_INT,
		64,
		0,
		4,
	};
	const struct functionfs_descriptors descriptors = {
		.bytes = bytes,
		.size = sizeof bytes,
		.count = 3,
		.endpoints = 1,
	};
	tracker->function = (struct functionfs) {
		.calls = &calls,
		.player = tracker,
		.refuses_data = tracker->refuses_features,
	};
	functionfs_start(&tracker->function, &tracker->gadget, serial, &descriptors);
}

static void send_sample(void *argument, const struct made_sample *sample)
{
	struct hid_function *tracker = argument;
	uint8_t report[HID_REPORT_MAX];
	size_t size = hid_gadget_report(HID_LAYOUT_REFERENCE, sample, report);
	functionfs_send(&tracker->function, report, size);
}

void hid_function_plug(struct hid_function *tracker, int controller, const char *name,
		       const char *serial)
{
	struct gadget_identity identity = { 0x1209, 0x0002, "Gazecast", name, serial };
	tracker->made = true;
	tracker->mode = 4; /* head position, which is useless here */
	tracker->stream = (struct made_stream) {
		.send = send_sample, .tracker = tracker, .has_clock = true, .tolerance = 1e-4
	};
	gadget_make(&tracker->gadget, controller, &identity);
	start_function(tracker, serial);
	gadget_plug(&tracker->gadget);
}

void hid_function_remove(struct hid_function *tracker)
{
	if (!tracker->made)
		return;
	made_stream_stop(&tracker->stream);
	gadget_remove(&tracker->gadget);
	functionfs_stop(&tracker->function);
	*tracker = (struct hid_function) { 0 };
}
