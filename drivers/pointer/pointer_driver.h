/**
 * @file
 * The viewer's mouse in place of an eye: a demonstration without a tracker passes the same pipeline
 * as one with it.
 *
 * A viewer reports its pointer when it moves, and now and then while it rests (topic "pointer" of
 * the inlet). The driver samples these reports at pointer.rate_hz and holds the last place in
 * between, because a gaze is a stream: a pointer at rest is a fixation, not a loss. It holds none
 * longer than pointer.timeout_ms: a viewer that is gone looks nowhere.
 */
#ifndef GZ_DRIVERS_POINTER_DRIVER_H
#define GZ_DRIVERS_POINTER_DRIVER_H

#include "drivers/driver.h"

extern const struct gz_driver gz_driver_pointer;

#endif
