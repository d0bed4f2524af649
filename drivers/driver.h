/**
 * @file
 * The drivers of this build. A new tracker is a folder below drivers/, its name here and a line in
 * gz_drivers[]; docs/adding-a-tracker.md describes each step.
 */
#ifndef GZ_DRIVERS_DRIVER_H
#define GZ_DRIVERS_DRIVER_H

#include "drivers/device/device.h"

/* Each is defined in drivers/<name>/<name>_driver.c. */
extern const struct gz_driver gz_driver_sim;
extern const struct gz_driver gz_driver_replay;
extern const struct gz_driver gz_driver_auto;
extern const struct gz_driver gz_driver_hid;
extern const struct gz_driver gz_driver_psvr2;
extern const struct gz_driver gz_driver_tobii5;
extern const struct gz_driver gz_driver_tobii;
extern const struct gz_driver gz_driver_gazepoint;
extern const struct gz_driver gz_driver_pupil;
extern const struct gz_driver gz_driver_pointer;
extern const struct gz_driver gz_driver_template;

/** All drivers, NULL-terminated: first those that play a device, then trackers on USB, then the
 * others. `gazectl devices` and the driver auto keep this order. */
extern const struct gz_driver *const gz_drivers[];

/** Find a driver by name, or NULL. */
const struct gz_driver *gz_driver_find(const char *name);

#endif
