/**
 * @file
 * HID report descriptors, from bytes to a table of fields. No I/O, no allocation.
 *
 * After "Device Class Definition for Human Interface Devices (HID)" 1.11, sections 5.4 to 5.8 and
 * 6.2.2; section numbers stand at each rule. Where a descriptor contradicts itself it is refused,
 * with the reason and the place.
 */
#ifndef GZ_DRIVERS_HID_DESCRIPTOR_H
#define GZ_DRIVERS_HID_DESCRIPTOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"

/** Largest descriptor, bytes: HID_MAX_DESCRIPTOR_SIZE of Linux. */
#define GZ_HID_DESCRIPTOR_SIZE 4096

/** Most fields, collections and reports of a descriptor. Chosen: an eye tracker has some 30, 10 and
 * 7; a mouse, keyboard and touch screen in one some 150. */
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

/** Kinds of report. */
enum gz_hid_report_type {
	GZ_HID_INPUT,
	GZ_HID_OUTPUT,
	GZ_HID_FEATURE,
	GZ_HID_REPORT_TYPES,
};

/** Flags of a field: the bits of its main item (6.2.2.5). */
enum gz_hid_flag {
	GZ_HID_FLAG_CONSTANT = 1 << 0,
	GZ_HID_FLAG_VARIABLE = 1 << 1, /**< else an array of selectors */
	GZ_HID_FLAG_RELATIVE = 1 << 2,
	GZ_HID_FLAG_NULL = 1 << 6, /**< a value outside the logical range says "nothing" */
	GZ_HID_FLAG_BYTES = 1 << 8,
};

/** Type of an application collection (6.2.2.6). */
#define GZ_HID_COLLECTION_APPLICATION 1

/** No collection. */
#define GZ_HID_NO_COLLECTION (-1)

/** A collection. Its path is itself and its parents. */
struct gz_hid_collection {
	uint32_t usage; /**< page in the upper half; 0 if it has none */
	uint8_t type;
	int parent; /**< index, or GZ_HID_NO_COLLECTION */
};

/**
 * Equal elements that stand side by side in a report and have a usage. Those without one are
 * padding and are in no field, but constant ones with a usage are: some devices call their
 * measurements constant.
 */
struct gz_hid_field {
	enum gz_hid_report_type type;
	uint8_t report_id;   /**< 0 where reports have none */
	uint32_t bit_offset; /**< from the byte behind the report ID */
	uint32_t bit_size;   /**< of an element, 1 or more */
	uint32_t count;      /**< elements, 1 or more */
	uint32_t usage;      /**< of the first element; page in the upper half */
	uint32_t usage_last; /**< usages count up from element to element until here; of an array:
				what its selectors choose from */
	int collection;      /**< index of the innermost one */
	int64_t logical_min, logical_max;
	int64_t physical_min, physical_max; /**< the logical ones where the descriptor has none */
	uint32_t unit;                      /**< nibbles, 6.2.2.7; 0 for none */
	int unit_exponent;                  /**< of ten */
	uint32_t flags;                     /**< enum gz_hid_flag */
};

/** A report. */
struct gz_hid_report {
	enum gz_hid_report_type type;
	uint8_t id;
	uint32_t bits; /**< without the ID */
};

/** What a descriptor says. Large; plain data. */
struct gz_hid_descriptor {
	bool numbered; /**< reports begin with a byte that holds their ID */
	size_t field_count, collection_count, report_count;
	struct gz_hid_field fields[GZ_HID_FIELDS_MAX];
	struct gz_hid_collection collections[GZ_HID_COLLECTIONS_MAX];
	struct gz_hid_report reports[GZ_HID_REPORTS_MAX];
};

/** Why a descriptor was refused. */
struct gz_hid_fault {
	size_t at;        /**< byte where the item begins that cannot be */
	const char *text; /**< static; "a collection is not closed" */
};

/**
 * Parse a report descriptor.
 *
 * @param bytes, size  as the device sent it, untrusted
 * @param[out] out_descriptor  of no meaning on failure
 * @param[out] out_fault  filled on failure; may be NULL
 * @retval GZ_ERR_FORMAT  refused
 *
 * Of delimited alternatives (6.2.2.8) the first usage of page 0x12 counts, else the first.
 */
enum gz_result gz_hid_descriptor_parse(const unsigned char *bytes, size_t size,
				       struct gz_hid_descriptor *out_descriptor,
				       struct gz_hid_fault *out_fault);

/** Whether a descriptor, however malformed, speaks of a usage page before it cannot be read on. */
bool gz_hid_descriptor_mentions(const unsigned char *bytes, size_t size, uint32_t page);

/** Bytes of a report as it travels, its ID included. */
size_t gz_hid_report_bytes(const struct gz_hid_descriptor *descriptor,
			   const struct gz_hid_report *report);

/** Bytes of the longest report of a type, its ID included; 0 if there is none. */
size_t gz_hid_longest_report(const struct gz_hid_descriptor *descriptor,
			     enum gz_hid_report_type type);

/** Whether @p collection, or one that it lies in, has this usage. */
bool gz_hid_within(const struct gz_hid_descriptor *descriptor, int collection, uint32_t usage);

#endif
