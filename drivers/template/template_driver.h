/**
 * @file
 * A driver to begin another one from. It reads fixed reports (template_protocol.h) from a file, a
 * FIFO or a character device, and is a real driver of the table: conformance and daemon tests run
 * it.
 *
 * A new tracker takes four files in drivers/<name>/: <name>_driver.h with one symbol,
 * <name>_driver.c with the I/O, <name>_protocol.{h,c} that turn bytes into numbers without I/O so
 * that they can be tested and fuzzed alone; a line in gz_drivers[]; and in the comment of the
 * protocol where its byte layout is described. Then tests/drivers/test_conformance.c says what is
 * missing.
 */
#ifndef GZ_DRIVERS_TEMPLATE_DRIVER_H
#define GZ_DRIVERS_TEMPLATE_DRIVER_H

#include "drivers/driver.h"

extern const struct gz_driver gz_driver_template;

#endif
