/**
 * @file
 * Usages of page 0x12, "Eye and Head Trackers": HID Usage Tables 1.2 and later, from request
 * HUTRR74. The page stands in the upper 16 bits.
 */
#ifndef GZ_DRIVERS_HID_USAGES_H
#define GZ_DRIVERS_HID_USAGES_H

/** The page itself. */
#define GZ_HID_PAGE_TRACKERS 0x12u

/** A usage of the page. */
#define GZ_HID_TRACKER_USAGE(id) (GZ_HID_PAGE_TRACKERS << 16 | (id))

/* Applications. */
#define GZ_HID_EYE_TRACKER  GZ_HID_TRACKER_USAGE(0x01)
#define GZ_HID_HEAD_TRACKER GZ_HID_TRACKER_USAGE(0x02)

/* What an application holds. */
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

#endif
