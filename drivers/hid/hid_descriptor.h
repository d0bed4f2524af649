/**
 * @file
 * HID report descriptors, from bytes to a table of fields, and the usages of eye trackers. No I/O,
 * no allocation.
 *
 * After "Device Class Definition for Human Interface Devices (HID)" 1.11, sections 5.4 to 5.8 and
 * 6.2.2; each rule names its section. A descriptor that contradicts itself is refused, with the
 * reason and the position.
 */
#ifndef GZ_DRIVERS_HID_DESCRIPTOR_H
#define GZ_DRIVERS_HID_DESCRIPTOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"

/* Usages of page 0x12, "Eye and Head Trackers": HID Usage Tables 1.2 and later, from request
 * HUTRR74. The upper 16 bits hold the page. */

/** The page. */
#define GZ_HID_PAGE_TRACKERS 0x12u

/** A usage of the page. */
#define GZ_HID_TRACKER_USAGE(id) (GZ_HID_PAGE_TRACKERS << 16 | (id))

/* Applications. */
#define GZ_HID_EYE_TRACKER  GZ_HID_TRACKER_USAGE(0x01)
#define GZ_HID_HEAD_TRACKER GZ_HID_TRACKER_USAGE(0x02)

/* Collections of an application. */
#define GZ_HID_TRACKING_DATA GZ_HID_TRACKER_USAGE(0x10)
#define GZ_HID_CAPABILITIES  GZ_HID_TRACKER_USAGE(0x11)
#define GZ_HID_CONFIGURATION GZ_HID_TRACKER_USAGE(0x12)
#define GZ_HID_STATUS        GZ_HID_TRACKER_USAGE(0x13)
#define GZ_HID_CONTROL       GZ_HID_TRACKER_USAGE(0x14)

/* Tracking data. */
#define GZ_HID_TIMESTAMP          GZ_HID_TRACKER_USAGE(0x20)
#define GZ_HID_POSITION_X         GZ_HID_TRACKER_USAGE(0x21)
#define GZ_HID_POSITION_Y         GZ_HID_TRACKER_USAGE(0x22)
#define GZ_HID_POSITION_Z         GZ_HID_TRACKER_USAGE(0x23)
#define GZ_HID_GAZE_POINT         GZ_HID_TRACKER_USAGE(0x24)
#define GZ_HID_LEFT_EYE_POSITION  GZ_HID_TRACKER_USAGE(0x25)
#define GZ_HID_RIGHT_EYE_POSITION GZ_HID_TRACKER_USAGE(0x26)
#define GZ_HID_HEAD_POSITION      GZ_HID_TRACKER_USAGE(0x27)

/* Capabilities. */
#define GZ_HID_TRACKER_QUALITY  GZ_HID_TRACKER_USAGE(0x100)
#define GZ_HID_DISTANCE_MINIMUM GZ_HID_TRACKER_USAGE(0x101)
#define GZ_HID_DISTANCE_OPTIMUM GZ_HID_TRACKER_USAGE(0x102)
#define GZ_HID_DISTANCE_MAXIMUM GZ_HID_TRACKER_USAGE(0x103)

/* Configuration. */
#define GZ_HID_SCREEN_WIDTH  GZ_HID_TRACKER_USAGE(0x204)
#define GZ_HID_SCREEN_HEIGHT GZ_HID_TRACKER_USAGE(0x205)

/* Status. */
#define GZ_HID_SAMPLING_FREQUENCY   GZ_HID_TRACKER_USAGE(0x300)
#define GZ_HID_CONFIGURATION_STATUS GZ_HID_TRACKER_USAGE(0x301)

/* Control. */
#define GZ_HID_DEVICE_MODE GZ_HID_TRACKER_USAGE(0x400)

/** Values of the configuration status. */
enum gz_hid_state {
	GZ_HID_STATE_UNKNOWN = 0,
	GZ_HID_STATE_READY = 1,
	GZ_HID_STATE_CONFIGURING = 2,
	GZ_HID_STATE_SCREEN_SETUP = 3,     /**< the screen must be set up first */
	GZ_HID_STATE_USER_CALIBRATION = 4, /**< the user must be calibrated first */
};

/** Bits of the device mode request. */
enum {
	GZ_HID_MODE_GAZE = 1,
	GZ_HID_MODE_EYES = 2,
	GZ_HID_MODE_HEAD = 4,
};

/** Largest descriptor, bytes: HID_MAX_DESCRIPTOR_SIZE of Linux. */
#define GZ_HID_DESCRIPTOR_SIZE 4096

/** Most fields, collections and reports of a descriptor. Chosen: an eye tracker has some 30, 10 and
 * 7; a combined mouse, keyboard and touch screen some 150 fields. */
#define GZ_HID_FIELDS_MAX      512
#define GZ_HID_COLLECTIONS_MAX 128
#define GZ_HID_REPORTS_MAX     64

/** Deepest nesting of collections, and of push items. Chosen. */
#define GZ_HID_DEPTH_MAX 16
#define GZ_HID_PUSH_MAX  8

/** Most usages and ranges of usages before one main item. Chosen. */
#define GZ_HID_USAGES_MAX 128

/** Largest report, bits: HID_MAX_BUFFER_SIZE of Linux, 16 KiB. */
#define GZ_HID_REPORT_BITS_MAX (16384 * 8)

/** Types of report. */
enum gz_hid_report_type {
	GZ_HID_INPUT,
	GZ_HID_OUTPUT,
	GZ_HID_FEATURE,
	GZ_HID_REPORT_TYPES,
};

/** Flags of a field: the bits of its main item (6.2.2.5). */
enum gz_hid_flag {
	GZ_HID_FLAG_CONSTANT = 1 << 0,
	GZ_HID_FLAG_VARIABLE = 1 << 1, /**< otherwise the field is an array of selectors */
	GZ_HID_FLAG_RELATIVE = 1 << 2,
	GZ_HID_FLAG_NULL = 1 << 6, /**< a value outside the logical range means "nothing" */
	GZ_HID_FLAG_BYTES = 1 << 8,
};

/** Type of an application collection (6.2.2.6). */
#define GZ_HID_COLLECTION_APPLICATION 1

/** No collection. */
#define GZ_HID_NO_COLLECTION (-1)

/** A collection. Its path leads from it through its parents. */
struct gz_hid_collection {
	uint32_t usage; /**< page in the upper half; 0 if it has none */
	uint8_t type;
	int parent; /**< index, or GZ_HID_NO_COLLECTION */
};

/** Equal, adjacent elements of a report that have a usage. Elements without a usage are padding and
 * belong to no field. Constant ones with a usage are fields: some devices declare their
 * measurements constant. */
struct gz_hid_field {
	enum gz_hid_report_type type;
	uint8_t report_id;   /**< 0 if reports have no IDs */
	uint32_t bit_offset; /**< counted from the byte behind the report ID */
	uint32_t bit_size;   /**< of one element, 1 or more */
	uint32_t count;      /**< elements, 1 or more */
	uint32_t usage;      /**< of the first element; page in the upper half */
	uint32_t usage_last; /**< usages count up from element to element until this one; for an
				array: the range that its selectors choose from */
	int collection;      /**< index of the innermost collection */
	int64_t logical_min, logical_max;
	int64_t physical_min, physical_max; /**< the logical ones if the descriptor has none */
	uint32_t unit;                      /**< nibbles, section 6.2.2.7; 0 for none */
	int unit_exponent;                  /**< exponent of ten */
	uint32_t flags;                     /**< enum gz_hid_flag */
};

/** A report. */
struct gz_hid_report {
	enum gz_hid_report_type type;
	uint8_t id;
	uint32_t bits; /**< without the ID */
};

/** A parsed descriptor. Large; plain data. */
struct gz_hid_descriptor {
	bool numbered; /**< reports begin with a byte that holds their ID */
	size_t field_count, collection_count, report_count;
	struct gz_hid_field fields[GZ_HID_FIELDS_MAX];
	struct gz_hid_collection collections[GZ_HID_COLLECTIONS_MAX];
	struct gz_hid_report reports[GZ_HID_REPORTS_MAX];
};

/** Why a descriptor was refused. */
struct gz_hid_fault {
	size_t at;        /**< position of the first byte of the faulty item */
	const char *text; /**< static text; "a collection is not closed" */
};

/**
 * Parse a report descriptor.
 *
 * @param bytes, size  as the device sent it, untrusted
 * @param[out] out_descriptor  meaningless on failure
 * @param[out] out_fault  filled on failure; may be NULL
 * @retval GZ_ERR_FORMAT  refused
 *
 * Of delimited alternatives (6.2.2.8), the first usage of page 0x12 counts, or the first one if
 * there is none.
 */
enum gz_result gz_hid_descriptor_parse(const unsigned char *bytes, size_t size,
				       struct gz_hid_descriptor *out_descriptor,
				       struct gz_hid_fault *out_fault);

/** Whether a descriptor mentions a usage page in its readable part, even if it is malformed. */
bool gz_hid_descriptor_mentions(const unsigned char *bytes, size_t size, uint32_t page);

/** Bytes of a report as it is sent, including its ID. */
size_t gz_hid_report_bytes(const struct gz_hid_descriptor *descriptor,
			   const struct gz_hid_report *report);

/** Bytes of the longest report of a type, including its ID; 0 if there is none. */
size_t gz_hid_longest_report(const struct gz_hid_descriptor *descriptor,
			     enum gz_hid_report_type type);

/** Whether @p collection, or one that contains it, has this usage. */
bool gz_hid_within(const struct gz_hid_descriptor *descriptor, int collection, uint32_t usage);

#endif
