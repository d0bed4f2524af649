/**
 * @file
 * HID report descriptors and reports for tests, in this process (tests/drivers) and over a whole
 * USB stack (tests/usb): item by item, and whole eye trackers of usage page 0x12 (HUTRR74) as
 * different makers would describe them. Usages are written as numbers here, so that a wrong one in
 * the product fails the tests.
 */
#ifndef GZ_TESTS_DRIVERS_HID_MADE_H
#define GZ_TESTS_DRIVERS_HID_MADE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** A descriptor under construction. Zero-initialised is empty. */
struct hid_made {
	unsigned char bytes[8192];
	size_t size;
};

/** Item prefixes without size bits. */
enum hid_item {
	HID_INPUT = 0x80,
	HID_OUTPUT = 0x90,
	HID_COLLECTION = 0xa0,
	HID_FEATURE = 0xb0,
	HID_END = 0xc0,
	HID_PAGE = 0x04,
	HID_LOGICAL_MIN = 0x14,
	HID_LOGICAL_MAX = 0x24,
	HID_PHYSICAL_MIN = 0x34,
	HID_PHYSICAL_MAX = 0x44,
	HID_EXPONENT = 0x54,
	HID_UNIT = 0x64,
	HID_SIZE = 0x74,
	HID_ID = 0x84,
	HID_COUNT = 0x94,
	HID_PUSH = 0xa4,
	HID_POP = 0xb4,
	HID_USAGE = 0x08,
	HID_USAGE_MIN = 0x18,
	HID_USAGE_MAX = 0x28,
	HID_DELIMITER = 0xa8,
};

/** Add an item with as many bytes of data as @p data needs, unsigned. */
void hid_made_item(struct hid_made *made, enum hid_item item, uint32_t data);

/** Add an item with @p size bytes of data: 0, 1, 2 or 4. */
void hid_made_sized(struct hid_made *made, enum hid_item item, unsigned size, uint32_t data);

/** Add several items: pairs of enum hid_item and data, ended by -1. */
void hid_made_items(struct hid_made *made, const int64_t *pairs);

/** Add several items, given as arguments. */
#define HID_ITEMS(made, ...) hid_made_items((made), (const int64_t[]) { __VA_ARGS__, -1 })

/** Layouts of whole eye trackers. */
enum hid_layout {
	/** Microsoft's reference design (GazeHid): the time as 8 fields of 8 bits, positions in
	 * micrometres and flagged constant, head positions as padding, feature reports, a status
	 * report. */
	HID_LAYOUT_REFERENCE,
	/** 7 bytes of padding before the time, as in DMF; positions not flagged constant. */
	HID_LAYOUT_PADDED,
	/** Other report IDs; the time, one field of 64 bits of 100 ns, behind the positions, which
	 * have 16 bits of 0.1 mm. */
	HID_LAYOUT_TIME64,
	/** No IDs, a time of 32 bits in us, no eyes, no feature reports. */
	HID_LAYOUT_GAZE_ONLY,
	/** The time is one field of 64 bits of 100 ns, in front; no feature reports. */
	HID_LAYOUT_WIDE,
	/** Report ID 0x42, positions of 16 bits of 0.1 mm, a time of 32 bits in ms behind them; no
	 * feature reports. */
	HID_LAYOUT_COARSE,
	/** Only the gaze point, in thousandths of an inch; no IDs, no time, no feature reports. */
	HID_LAYOUT_POINT,
	HID_LAYOUT_COUNT,
};

/** Length of one tick of the device clock, us; 0 if there is none. */
double hid_layout_tick_us(enum hid_layout layout);

/** Whether reports contain the positions of the eyes. */
bool hid_layout_has_eyes(enum hid_layout layout);

/** Add a whole eye tracker. */
void hid_made_tracker(struct hid_made *made, enum hid_layout layout);

/** Room for any report of a made tracker, bytes. */
#define HID_REPORT_MAX 128

/** Content of a tracking report; lengths in um. */
struct hid_made_sample {
	uint64_t time_us;
	int32_t gaze[2];
	int32_t left[3], right[3];
};

/** Lay out a tracking report. @return its bytes; at most HID_REPORT_MAX */
size_t hid_made_report(enum hid_layout layout, const struct hid_made_sample *sample,
		       unsigned char *out_bytes);

/**
 * Lay out a feature report, beginning with its ID.
 *
 * @param width, height  of the screen, um
 * @return its bytes, at most HID_REPORT_MAX; 0 if the layout has no feature reports
 */
size_t hid_made_configuration(enum hid_layout layout, int32_t width, int32_t height,
			      unsigned char *out_bytes);

/** The same for the Capabilities report; distances, um. */
size_t hid_made_capabilities(enum hid_layout layout, int32_t nearest, int32_t optimum,
			     int32_t farthest, unsigned char *out_bytes);

/** The same for the Status report, which is a feature and an input report. */
size_t hid_made_status(enum hid_layout layout, unsigned state, unsigned rate_hz,
		       unsigned char *out_bytes);

/** The same for the Control report. */
size_t hid_made_control(enum hid_layout layout, unsigned mode, unsigned char *out_bytes);

#endif
