/**
 * @file
 * A driver as a test uses it: its settings, what it logs, and its devices opened and read. Calls
 * whose description does not name a result fail the test if something goes wrong.
 */
#ifndef GZ_TESTS_DRIVERS_DRIVER_STAGE_H
#define GZ_TESTS_DRIVERS_DRIVER_STAGE_H

#include <stddef.h>

#include "drivers/driver.h"

/** A driver. stage_reset() fills it. */
struct driver_stage {
	const struct gz_driver *driver;
	_Alignas(max_align_t) unsigned char settings[GZ_DRIVER_SETTINGS_SIZE];
	struct gz_driver_host host; /**< what the driver gets; its log is the one below */
	struct gz_log log;
	char logged[8192]; /**< all lines logged since stage_reset() */
};

/** Choose a driver by its name, with its presets, an empty log and nothing else from the host. */
void stage_reset(struct driver_stage *stage, const char *driver);

/** Set an option. */
void stage_set(struct driver_stage *stage, const char *key, const char *text);

/** Open a device. @param[out] out_device  NULL on failure @return the result of the driver */
enum gz_result stage_create(struct driver_stage *stage, const char *choice,
			    struct gz_device **out_device);

/** Open a device; @p choice may be NULL. */
struct gz_device *stage_open(struct driver_stage *stage, const char *choice);

/** Open and start a device. */
struct gz_device *stage_start(struct driver_stage *stage);

/** List the devices. @return how many */
size_t stage_list(struct driver_stage *stage, struct gz_device_entry *out_entries);

/** Check that @p text was logged. */
void stage_expect_logged(const struct driver_stage *stage, const char *text);

/** Read until something other than GZ_ERR_TIMEOUT comes, for 20 s at most. @return that result */
enum gz_result device_read_result(struct gz_device *device, struct gz_sample *out_sample);

/** Read the next sample, however many time-outs come before it. */
struct gz_sample device_read_sample(struct gz_device *device);

/** The counters of a device. */
struct gz_device_counters device_counters(const struct gz_device *device);

#endif
