/**
 * @file
 * Eye trackers of the HID class: usage page 0x12 of the HID Usage Tables 1.2 (request HUTRR74),
 * found by their report descriptor whatever their reports' layout, over hidapi's hidraw backend.
 *
 * The class sends one gaze point and, if asked, where the eyes are. A tracker that sends the point
 * alone leaves both eyes unmeasured. One that sends positions fills, for each eye that it sees, the
 * gaze point, origin_mm and direction: mm from the screen's upper left corner, right, down and
 * towards the viewer (hid_tracker.h says where that comes from).
 *
 * Silence is filled in (hid_silence.h).
 */
#ifndef GZ_DRIVERS_HID_DRIVER_H
#define GZ_DRIVERS_HID_DRIVER_H

#include "drivers/driver.h"

extern const struct gz_driver gz_driver_hid;

#endif
