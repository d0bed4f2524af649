/**
 * @file
 * The trackers that the SDK finds, and which of them is meant.
 */
#ifndef GZ_DRIVERS_TOBII_FIND_H
#define GZ_DRIVERS_TOBII_FIND_H

#include "base/log.h"
#include "drivers/driver.h"
#include "drivers/tobii/tobii_library.h"

/**
 * Find the trackers that are there. May block for seconds: the SDK asks the network.
 *
 * @param[out] out_trackers  room for GZ_DEVICE_ENTRIES_MAX
 * @param[out] out_entries   likewise: model (where there is none, the device name), serial number,
 *                           address
 * @param[out] out_count     how many
 * @retval GZ_ERR_NO_DEVICE  the SDK cannot look, or found none; logged
 */
enum gz_result gz_tobii_find(const struct gz_tobii_library *library, const struct gz_log *log,
			     struct gz_tobii_tracker **out_trackers,
			     struct gz_device_entry *out_entries, size_t *out_count);

/**
 * Which of @p count is meant.
 *
 * @param choice  model, device name, serial number or address; NULL or empty: the first
 * @return its index, or @p count if it is none of them; logged with those there are
 */
size_t gz_tobii_choose(const struct gz_tobii_library *library,
		       struct gz_tobii_tracker *const *trackers,
		       const struct gz_device_entry *entries, size_t count, const char *choice,
		       const struct gz_log *log);

#endif
