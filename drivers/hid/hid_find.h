/**
 * @file
 * The eye trackers among the system's HID devices, and which of them is meant.
 */
#ifndef GZ_DRIVERS_HID_FIND_H
#define GZ_DRIVERS_HID_FIND_H

#include "base/log.h"
#include "base/result.h"
#include "drivers/driver.h"
#include "drivers/hid/hid_tracker.h"

/** An eye tracker found; a device may hold several. */
struct gz_hid_found {
	struct gz_device_entry entry;  /**< name "Product", of the second one "Product #2" */
	enum gz_result result;         /**< GZ_OK, or why it is not usable; told in entry.reason */
	size_t index;                  /**< for gz_hid_tracker_find() */
	struct gz_hid_tracker tracker; /**< filled where its descriptor could be read */
};

/**
 * Find them all, opening none.
 *
 * @param[out] out_found  room for GZ_DEVICE_ENTRIES_MAX
 * @param[out] out_count  how many were written
 * @retval GZ_ERR_NO_MEM
 */
enum gz_result gz_hid_find(struct gz_hid_found *out_found, size_t *out_count);

/**
 * The one that is meant by its name, serial number or place; where @p choice is NULL or empty, the
 * first usable one, else the first.
 *
 * @return NULL where there is none
 */
const struct gz_hid_found *gz_hid_choose(const struct gz_hid_found *found, size_t count,
					 const char *choice);

#endif
