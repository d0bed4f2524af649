/**
 * @file
 * The driver "auto": whatever tracker is there. It asks the other drivers what they see, those on
 * USB first, in the order of gz_drivers[], and opens the first tracker that can be used; where
 * there is none the daemon waits for one to be plugged in.
 */
#ifndef GZ_DRIVERS_AUTO_DRIVER_H
#define GZ_DRIVERS_AUTO_DRIVER_H

#include "drivers/driver.h"

extern const struct gz_driver gz_driver_auto;

#endif
