/**
 * @file
 * One number of a HID report: where it stands, and what its bits mean in our units. No I/O.
 *
 * Units: HID 1.11, 6.2.2.7. Range and scale: 5.8 and 6.2.2.7.
 */
#ifndef GZ_DRIVERS_HID_VALUE_H
#define GZ_DRIVERS_HID_VALUE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "drivers/hid/hid_descriptor.h"

/** Dimensions, and the unit each is turned into. */
enum gz_hid_dimension {
	GZ_HID_NUMBER,    /**< a count or code: as it stands, whatever the unit */
	GZ_HID_LENGTH,    /**< mm */
	GZ_HID_TIME,      /**< ns */
	GZ_HID_FREQUENCY, /**< Hz */
};

/** A number in a report. Zero-initialised is one that the device does not have. */
struct gz_hid_value {
	bool present;
	bool has_unit; /**< false where the descriptor gives none and scale is a guess */
	bool is_signed;
	bool nullable;  /**< outside its range it says "nothing" */
	bool has_range; /**< raw_min and raw_max mean something */
	uint32_t at;    /**< first bit, counted from the byte behind the report ID */
	uint32_t bits;  /**< 1 to 64 */
	uint8_t report_id;
	enum gz_hid_report_type type;
	int64_t raw_min, raw_max;
	double scale, offset; /**< value = raw * scale + offset */
};

/**
 * Factor from a HID unit to ours.
 *
 * @param[out] out_factor  written on GZ_OK
 * @retval GZ_ERR_NOT_FOUND  the unit is "none"
 * @retval GZ_ERR_FORMAT     the unit is of another dimension
 */
enum gz_result gz_hid_unit_factor(uint32_t unit, int exponent, enum gz_hid_dimension dimension,
				  double *out_factor);

/**
 * The number that is element @p index of a field. Where the descriptor gives no unit, lengths are
 * micrometres and frequencies hertz, as in the class's reference descriptors, and the scale of a
 * time is 0.
 *
 * @param[out] out_value  written on success
 * @retval GZ_ERR_FORMAT       the unit is of another dimension, or the physical range is empty
 * @retval GZ_ERR_UNSUPPORTED  more than 64 bits
 */
enum gz_result gz_hid_value_from_field(const struct gz_hid_field *field, uint32_t index,
				       enum gz_hid_dimension dimension,
				       struct gz_hid_value *out_value);

/**
 * @p count bits of @p bytes from bit @p at on, the first the least significant (HID 1.11, 5.6).
 *
 * @param count  0 to 64
 * @return 0 where they do not lie within @p size bytes
 */
uint64_t gz_hid_bits(const unsigned char *bytes, size_t size, size_t at, unsigned count);

/** What a value of a report says. */
enum gz_hid_reading {
	GZ_HID_READ,       /**< a number */
	GZ_HID_READ_NULL,  /**< "nothing" */
	GZ_HID_READ_WRONG, /**< outside its range, or of the report */
};

/**
 * Read a value's bits.
 *
 * @param bytes, size  the report behind its ID
 * @param[out] out_raw  written on GZ_HID_READ; a number of 64 bits without sign above INT64_MAX is
 *                      its two's complement
 */
enum gz_hid_reading gz_hid_value_raw(const struct gz_hid_value *value, const unsigned char *bytes,
				     size_t size, int64_t *out_raw);

/** The same in the value's unit. @param[out] out_number  finite; written on GZ_HID_READ */
enum gz_hid_reading gz_hid_value_read(const struct gz_hid_value *value, const unsigned char *bytes,
				      size_t size, double *out_number);

#endif
