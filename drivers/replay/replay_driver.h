/**
 * @file
 * A gaze log played again through the door that a tracker uses: the samples as they were recorded,
 * with their numbers and times.
 */
#ifndef GZ_DRIVERS_REPLAY_DRIVER_H
#define GZ_DRIVERS_REPLAY_DRIVER_H

#include "drivers/driver.h"

extern const struct gz_driver gz_driver_replay;

#endif
