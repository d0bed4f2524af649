/**
 * @file
 * The eye tracker of a PlayStation VR2 on a USB port: a vendor-specific interface, read with
 * libusb. The headset's gaze is fixed to the head; the configuration says where the screen is.
 */
#ifndef GZ_DRIVERS_PSVR2_DRIVER_H
#define GZ_DRIVERS_PSVR2_DRIVER_H

#include "drivers/driver.h"

extern const struct gz_driver gz_driver_psvr2;

#endif
