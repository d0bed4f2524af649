/**
 * @file
 * An eye tracker of usage page 0x12 (hid_usages.h): where its descriptor puts what we need, and its
 * reports as numbers. No I/O, no allocation.
 *
 * The class leaves the frame of positions open. Its reference drivers (MSREnable/GazeHid, drivers/
 * tobii and gazepoint) send the gaze point in micrometres right and down from the upper left corner
 * of the calibrated screen; eye positions share the usages and are taken in the same frame, their
 * third coordinate counted from the screen towards the viewer.
 */
#ifndef GZ_DRIVERS_HID_TRACKER_H
#define GZ_DRIVERS_HID_TRACKER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "drivers/hid/hid_descriptor.h"
#include "drivers/hid/hid_value.h"
#include "protocol/gaze.h"

/** The numbers we look for. */
enum gz_hid_quantity {
	/* In one input report. */
	GZ_HID_GAZE_X, /**< mm */
	GZ_HID_GAZE_Y,
	GZ_HID_TICKS, /**< one number, even where the descriptor makes it eight bytes */
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

/** Where an eye tracker's numbers stand. */
struct gz_hid_tracker {
	bool numbered;
	struct gz_hid_value values[GZ_HID_QUANTITIES];
	bool has_eyes;     /**< positions of both eyes, with all coordinates */
	bool time_refused; /**< its time stamp is longer than 64 bits or has no unit of time */
	size_t longest[GZ_HID_REPORT_TYPES]; /**< bytes of the longest report of a type, its ID
						included; of the whole device, as reports[] */
	size_t report_count;
	struct gz_hid_report reports[GZ_HID_REPORTS_MAX];
};

/** How many eye trackers the device has: applications of that usage. */
size_t gz_hid_tracker_count(const struct gz_hid_descriptor *descriptor);

/**
 * Find what one of the device's eye trackers sends.
 *
 * @param index  below gz_hid_tracker_count()
 * @param[out] out_tracker  written on success
 * @param[out] out_reason   on failure: static text; may be NULL
 * @retval GZ_ERR_NOT_FOUND  there are not that many
 * @retval GZ_ERR_FORMAT     its tracking data hold no gaze point in a unit of length
 */
enum gz_result gz_hid_tracker_find(const struct gz_hid_descriptor *descriptor, size_t index,
				   struct gz_hid_tracker *out_tracker, const char **out_reason);

/** Bytes of the report that holds a quantity, its ID included; 0 if the device does not have it. */
size_t gz_hid_tracker_bytes(const struct gz_hid_tracker *tracker, enum gz_hid_quantity quantity);

/** What an input report turned out to be. */
enum gz_hid_input_kind {
	GZ_HID_INPUT_TRACKING,
	GZ_HID_INPUT_STATUS,
	GZ_HID_INPUT_OTHER, /**< another application's, or one with nothing in it for us */
	GZ_HID_INPUT_MALFORMED,
};

/** An input report. What @p kind does not name means nothing. */
struct gz_hid_input_report {
	enum gz_hid_input_kind kind;
	enum gz_malformed malformed;
	bool has_ticks;
	uint64_t ticks;
	bool has_gaze; /**< false where the device says "nothing" */
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
 * @param bytes, size  as received, its ID first if reports have one; untrusted
 *
 * Too short is malformed. Longer is allowed up to the longest input report, because some devices
 * pad all to one length. A gaze point outside its declared range is malformed, unless the range
 * allows "nothing". Eye positions outside theirs, or not between 50 mm and 5 m from the screen, are
 * not measured: some producers leave them empty. Does not allocate.
 */
void gz_hid_tracker_read(const struct gz_hid_tracker *tracker, const unsigned char *bytes,
			 size_t size, struct gz_hid_input_report *out_report);

/** The size of the screen that the gaze is measured on. */
struct gz_hid_screen {
	bool stated;   /**< the report holds it */
	bool believed; /**< and it can be: each side 50 mm to 5 m, no side 6 times the other */
	double mm[2];
};

/** Read a Configuration report. @param bytes, size  behind the ID; untrusted */
struct gz_hid_screen gz_hid_tracker_screen(const struct gz_hid_tracker *tracker,
					   const unsigned char *bytes, size_t size);

/** Distances at which eyes are tracked. */
struct gz_hid_distances {
	bool stated;
	bool believed;
	bool corrected; /**< they were a tenth of what they must be, as in the reference drivers:
			   they say 5, 6.5 and 9 cm */
	double nearest_mm, optimum_mm, farthest_mm;
};

/** Read a Capabilities report. @param bytes, size  behind the ID; untrusted. Believed is 100 mm to
 * 5 m, in order. */
struct gz_hid_distances gz_hid_tracker_distances(const struct gz_hid_tracker *tracker,
						 const unsigned char *bytes, size_t size);

/** A sampling frequency that can be, 1 to 10000 Hz; else 0. */
double gz_hid_believed_rate(double rate_hz);

/**
 * Write the device's mode into its Control report.
 *
 * @param bytes, size  the report behind its ID; the rest of it is left as it is
 * @param mode         GZ_HID_MODE_… bits; those beyond the field are left out
 * @retval GZ_ERR_NOT_FOUND  there is no such field, or it lies beyond @p size
 */
enum gz_result gz_hid_tracker_set_mode(const struct gz_hid_tracker *tracker, unsigned char *bytes,
				       size_t size, unsigned mode);

#endif
