/**
 * @file
 * Eye trackers as different makers would describe them in HID: report descriptors of usage page
 * 0x12 (eye and head trackers, HUTRR74) and the reports that go with them.
 */
#ifndef GZ_TESTS_USB_HID_LAYOUT_H
#define GZ_TESTS_USB_HID_LAYOUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "made_gaze.h"

/** Room for any report of these layouts. */
#define HID_REPORT_MAX 128

/** The eyes of every sample that has them, mm right of and below the screen's top left corner, and
 * before it. */
#define HID_LEFT_EYE_MM             \
	{                           \
		-32.0, -50.0, 610.0 \
	}
#define HID_RIGHT_EYE_MM           \
	{                          \
		31.0, -51.0, 605.0 \
	}

/** One maker's idea. */
struct hid_layout {
	const uint8_t *descriptor;
	size_t descriptor_size;
	size_t report_size;    /**< of the input report, with its ID */
	double device_tick_us; /**< 0: it has no clock */
	bool has_eyes;
	/** Lay out a sample; @p report holds report_size zero bytes. */
	void (*encode)(const struct made_sample *sample, uint8_t *report);
};

/** As Microsoft's reference design lays reports out: a timestamp of eight bytes, fields flagged
 *  constant, micrometres, head data without usages behind, feature reports and a status report. */
extern const struct hid_layout hid_layout_reference;

/** Seven bytes of padding before the timestamp, and fields that are not flagged constant. */
extern const struct hid_layout hid_layout_padded;

/** The timestamp is one field of 64 bits, in units of 100 ns. */
extern const struct hid_layout hid_layout_wide;

/** Report ID 0x42, positions of 16 bits in tenths of a millimetre, a timestamp of 32 bits in
 *  milliseconds, behind the positions. */
extern const struct hid_layout hid_layout_coarse;

/** Nothing but the gaze point, in thousandths of an inch, without report IDs. */
extern const struct hid_layout hid_layout_point;

/** All of the above, NULL at the end. */
extern const struct hid_layout *const hid_layouts[];

#endif
