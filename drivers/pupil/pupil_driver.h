/**
 * @file
 * A Pupil Core headset through Pupil Capture's Network API, or another gazed as its client.
 */
#ifndef GZ_DRIVERS_PUPIL_DRIVER_H
#define GZ_DRIVERS_PUPIL_DRIVER_H

#include "drivers/driver.h"

/** The driver "pupil". */
extern const struct gz_driver gz_driver_pupil;

#endif
