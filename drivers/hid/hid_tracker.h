/**
 * @file
 * An eye tracker of usage page 0x12: where its descriptor puts what we need, and its reports as
 * numbers in our units. No I/O, no allocation.
 *
 * Units: HID 1.11, section 6.2.2.7. Range and scale: 5.8 and 6.2.2.7.
 *
 * The class does not define the frame of positions. Its reference drivers (MSREnable/GazeHid,
 * drivers/tobii and gazepoint) send the gaze point in micrometres right of and below the upper left
 * corner of the calibrated screen. Eye positions share the usages and are read in the same frame;
 * their third coordinate counts from the screen towards the viewer.
 */
#ifndef GZ_DRIVERS_HID_TRACKER_H
#define GZ_DRIVERS_HID_TRACKER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "drivers/hid/hid_descriptor.h"
#include "protocol/gaze.h"

/** Dimensions, and the unit that each is converted to. */
enum gz_hid_dimension {
	GZ_HID_NUMBER,    /**< a count or code: as it is, whatever the unit */
	GZ_HID_LENGTH,    /**< mm */
	GZ_HID_TIME,      /**< ns */
	GZ_HID_FREQUENCY, /**< Hz */
};

/** A number in a report. Zero-initialised is one that the device does not have. */
struct gz_hid_value {
	bool present;
	bool has_unit; /**< false if the descriptor gives none and scale is a guess */
	bool is_signed;
	bool nullable;  /**< outside its range it means "nothing" */
	bool has_range; /**< raw_min and raw_max are set */
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
 * @retval GZ_ERR_FORMAT     the unit has another dimension
 */
enum gz_result gz_hid_unit_factor(uint32_t unit, int exponent, enum gz_hid_dimension dimension,
				  double *out_factor);

/**
 * Describe element @p index of a field. If the descriptor gives no unit, lengths are micrometres
 * and frequencies hertz, as in the reference descriptors of the class, and the scale of a time is
 * 0.
 *
 * @param[out] out_value  written on success
 * @retval GZ_ERR_FORMAT       the unit has another dimension, or the physical range is empty
 * @retval GZ_ERR_UNSUPPORTED  more than 64 bits, or no such element
 */
enum gz_result gz_hid_value_from_field(const struct gz_hid_field *field, uint32_t index,
				       enum gz_hid_dimension dimension,
				       struct gz_hid_value *out_value);

/**
 * Read @p count bits from bit @p at, the least significant first (HID 1.11, 5.6).
 *
 * @param count  0 to 64
 * @return 0 if they do not lie within @p size bytes
 */
uint64_t gz_hid_bits(const unsigned char *bytes, size_t size, size_t at, unsigned count);

/** Result of reading a value. */
enum gz_hid_reading {
	GZ_HID_READ,       /**< a number */
	GZ_HID_READ_NULL,  /**< "nothing" */
	GZ_HID_READ_WRONG, /**< outside its range or outside the report */
};

/**
 * Read the bits of a value.
 *
 * @param bytes, size  the report behind its ID
 * @param[out] out_raw  written on GZ_HID_READ; an unsigned 64-bit number above INT64_MAX is its
 *                      two's complement
 */
enum gz_hid_reading gz_hid_value_raw(const struct gz_hid_value *value, const unsigned char *bytes,
				     size_t size, int64_t *out_raw);

/**
 * Read a value in its unit.
 *
 * @param bytes, size  the report behind its ID
 * @param[out] out_number  finite; written on GZ_HID_READ
 */
enum gz_hid_reading gz_hid_value_read(const struct gz_hid_value *value, const unsigned char *bytes,
				      size_t size, double *out_number);

/** The numbers that the driver uses. */
enum gz_hid_quantity {
	/* In one input report. */
	GZ_HID_GAZE_X, /**< mm */
	GZ_HID_GAZE_Y,
	GZ_HID_TICKS, /**< one number, even if the descriptor declares eight bytes */
	GZ_HID_RIGHT_X,
	GZ_HID_RIGHT_Y,
	GZ_HID_RIGHT_Z,
	GZ_HID_LEFT_X,
	GZ_HID_LEFT_Y,
	GZ_HID_LEFT_Z,
	/* In an input report of any ID. */
	GZ_HID_STATE_INPUT,
	GZ_HID_RATE_INPUT, /**< Hz */
	/* In feature reports. */
	GZ_HID_STATE,
	GZ_HID_RATE,
	GZ_HID_MODE,
	GZ_HID_WIDTH, /**< mm */
	GZ_HID_HEIGHT,
	GZ_HID_NEAREST, /**< mm */
	GZ_HID_OPTIMUM,
	GZ_HID_FARTHEST,
	GZ_HID_QUANTITIES,
};

/** Where the numbers of an eye tracker are. */
struct gz_hid_tracker {
	bool numbered; /**< reports begin with their ID */
	struct gz_hid_value values[GZ_HID_QUANTITIES];
	bool has_eyes;     /**< positions of both eyes, with all coordinates */
	bool time_refused; /**< its time stamp has more than 64 bits or no unit of time */
	size_t longest[GZ_HID_REPORT_TYPES]; /**< bytes of the longest report of a type, including
						its ID; of the whole device, like reports[] */
	size_t report_count;
	struct gz_hid_report reports[GZ_HID_REPORTS_MAX];
};

/** How many eye trackers the device has: applications of that usage. */
size_t gz_hid_tracker_count(const struct gz_hid_descriptor *descriptor);

/**
 * Find what one of the eye trackers of the device sends.
 *
 * @param index  below gz_hid_tracker_count()
 * @param[out] out_tracker  written on success
 * @param[out] out_reason   on failure: static text; may be NULL
 * @retval GZ_ERR_NOT_FOUND  there are not that many
 * @retval GZ_ERR_FORMAT     its tracking data have no gaze point in a unit of length
 */
enum gz_result gz_hid_tracker_find(const struct gz_hid_descriptor *descriptor, size_t index,
				   struct gz_hid_tracker *out_tracker, const char **out_reason);

/** Bytes of the report that holds a quantity, including its ID; 0 if the device does not have it.
 */
size_t gz_hid_tracker_bytes(const struct gz_hid_tracker *tracker, enum gz_hid_quantity quantity);

/** What an input report is. */
enum gz_hid_input_kind {
	GZ_HID_INPUT_TRACKING,
	GZ_HID_INPUT_STATUS,
	GZ_HID_INPUT_OTHER, /**< of another application, or without anything for us */
	GZ_HID_INPUT_MALFORMED,
};

/** An input report. Fields that do not belong to @p kind are meaningless. */
struct gz_hid_input_report {
	enum gz_hid_input_kind kind;
	enum gz_malformed malformed;
	bool has_ticks;
	uint64_t ticks;
	bool has_gaze; /**< false if the device reports "nothing" */
	double gaze_mm[2];
	bool has_eye[GZ_EYE_COUNT];
	double eye_mm[GZ_EYE_COUNT][3];
	bool has_state;
	int state; /**< enum gz_hid_state, or any number */
	bool has_rate;
	double rate_hz; /**< as sent */
};

/**
 * Read an input report.
 *
 * @param bytes, size  as received, beginning with the ID if reports have one; untrusted
 *
 * A report that is too short is malformed. It may be longer, up to the longest input report,
 * because some devices pad all reports to one length. A gaze point outside its declared range is
 * malformed, unless that means "nothing". Eye positions outside their range, or not between 50 mm
 * and 5 m from the screen, are not measured: some devices leave them empty. Does not allocate.
 */
void gz_hid_tracker_read(const struct gz_hid_tracker *tracker, const unsigned char *bytes,
			 size_t size, struct gz_hid_input_report *out_report);

/** Size of the screen that the gaze is measured on. */
struct gz_hid_screen {
	bool stated;   /**< the report contains it */
	bool believed; /**< it is possible: each side 50 mm to 5 m, neither 6 times the other */
	double mm[2];
};

/** Read a Configuration report. @param bytes, size  the report behind its ID; untrusted */
struct gz_hid_screen gz_hid_tracker_screen(const struct gz_hid_tracker *tracker,
					   const unsigned char *bytes, size_t size);

/** Distances at which eyes are tracked. */
struct gz_hid_distances {
	bool stated;    /**< the report contains them */
	bool believed;  /**< they are possible: 100 mm to 5 m, in order */
	bool corrected; /**< they were a tenth of the true ones and have been multiplied by ten, as
			   those of the reference drivers, which report 5, 6.5 and 9 cm */
	double nearest_mm, optimum_mm, farthest_mm;
};

/** Read a Capabilities report. @param bytes, size  the report behind its ID; untrusted */
struct gz_hid_distances gz_hid_tracker_distances(const struct gz_hid_tracker *tracker,
						 const unsigned char *bytes, size_t size);

/** The sampling frequency if it is possible, 1 to 10000 Hz; otherwise 0. */
double gz_hid_believed_rate(double rate_hz);

/**
 * Write the device mode into the Control report.
 *
 * @param bytes, size  the report behind its ID; the rest of it does not change
 * @param mode         GZ_HID_MODE_… bits; bits that do not fit the field are dropped
 * @retval GZ_ERR_NOT_FOUND  there is no such field, or it lies beyond @p size
 */
enum gz_result gz_hid_tracker_set_mode(const struct gz_hid_tracker *tracker, unsigned char *bytes,
				       size_t size, unsigned mode);

#endif
