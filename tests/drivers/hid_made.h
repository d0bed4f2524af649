/**
 * @file
 * Report descriptors and reports made for tests: item by item, and whole eye trackers in several
 * layouts.
 */
#ifndef GZ_TESTS_DRIVERS_HID_MADE_H
#define GZ_TESTS_DRIVERS_HID_MADE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** A descriptor in the making. Zero-initialised is empty. */
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

/** Add an item with as many bytes of data as @p data needs, read without sign. */
void hid_made_item(struct hid_made *made, enum hid_item item, uint32_t data);

/** Add an item with @p size bytes of data: 0, 1, 2 or 4. */
void hid_made_sized(struct hid_made *made, enum hid_item item, unsigned size, uint32_t data);

/** Add several items: pairs of enum hid_item and data, ended by -1. */
void hid_made_items(struct hid_made *made, const int64_t *pairs);

/** The same from a list. */
#define HID_ITEMS(made, ...) hid_made_items((made), (const int64_t[]) { __VA_ARGS__, -1 })

/** What a made tracker's tracking report looks like. */
enum hid_layout {
	HID_LAYOUT_BYTES,     /**< time as 8 fields of 8 bits, everything flagged constant, head
				 positions as padding: what GazeHid's reference driver sends */
	HID_LAYOUT_PADDED,    /**< 7 bytes of padding before the time: DMF's */
	HID_LAYOUT_TIME64,    /**< time as one field of 64 bits of 100 ns, positions in 16 bits of
				 0.1 mm, other report IDs, the time at the end */
	HID_LAYOUT_GAZE_ONLY, /**< no IDs, a time of 32 bits in us, no positions, no features */
	HID_LAYOUT_COUNT,
};

/** A whole eye tracker. */
void hid_made_tracker(struct hid_made *made, enum hid_layout layout);

/** What a tracking report of a made tracker says; lengths in um. */
struct hid_made_sample {
	uint64_t time_us;
	int32_t gaze[2];
	int32_t left[3], right[3];
};

/** Print it. @return its bytes; at most 128 */
size_t hid_made_report(enum hid_layout layout, const struct hid_made_sample *sample,
		       unsigned char *out_bytes);

/** Configuration report: the screen, um. @return its bytes, ID first; 0 if the layout has none */
size_t hid_made_configuration(enum hid_layout layout, int32_t width, int32_t height,
			      unsigned char *out_bytes);

/** Capabilities report: distances, um. @return as above */
size_t hid_made_capabilities(enum hid_layout layout, int32_t nearest, int32_t optimum,
			     int32_t farthest, unsigned char *out_bytes);

/** Status report, feature and input alike. @return as above */
size_t hid_made_status(enum hid_layout layout, unsigned state, unsigned rate_hz,
		       unsigned char *out_bytes);

/** Control report. @return as above */
size_t hid_made_control(enum hid_layout layout, unsigned mode, unsigned char *out_bytes);

#endif
