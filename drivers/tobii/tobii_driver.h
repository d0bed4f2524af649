/**
 * @file
 * Tobii Pro eye trackers, by the Tobii Pro SDK that the user has installed (tobii_abi.h). The SDK
 * calls back on a thread of its own; a ring without locks hands its data over.
 *
 * A tracker whose connection is lost, or whose display area is set anew, is a device that is
 * unplugged: the daemon closes it and looks for it again.
 */
#ifndef GZ_DRIVERS_TOBII_DRIVER_H
#define GZ_DRIVERS_TOBII_DRIVER_H

#include "drivers/driver.h"

extern const struct gz_driver gz_driver_tobii;

#endif
