/**
 * @file
 * A simulated viewer before a simulated tracker (sim/tracker.h), delivered as time passes.
 */
#ifndef GZ_DRIVERS_SIM_DRIVER_H
#define GZ_DRIVERS_SIM_DRIVER_H

#include "drivers/driver.h"

extern const struct gz_driver gz_driver_sim;

#endif
