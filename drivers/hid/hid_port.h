/**
 * @file
 * The HID devices of the system: the hidraw backend of hidapi, and what hidapi lacks (report
 * descriptors, which hidapi 0.13 does not return). All I/O of the driver goes through these
 * functions; tests link another implementation in their place.
 */
#ifndef GZ_DRIVERS_HID_PORT_H
#define GZ_DRIVERS_HID_PORT_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "drivers/hid/hid_descriptor.h"
#include "protocol/gaze.h"

/** Most interfaces that are examined. Chosen: a busy desk has a dozen. */
#define GZ_HID_PORT_ENTRIES_MAX 64

/** An interface that is present. */
struct gz_hid_port_entry {
	char path[GZ_NAME_SIZE];   /**< "/dev/hidraw0" */
	char name[GZ_NAME_SIZE];   /**< product name, printable; its numbers if it has none */
	char serial[GZ_NAME_SIZE]; /**< printable; empty if it has none */
	uint16_t vendor, product;
};

/** An open interface. Threads: one at a time. */
struct gz_hid_port;

/**
 * List the interfaces without opening them.
 *
 * @param[out] out_entries  room for GZ_HID_PORT_ENTRIES_MAX
 * @return how many were written
 */
size_t gz_hid_port_list(struct gz_hid_port_entry *out_entries);

/**
 * Read the report descriptor of an interface without opening it.
 *
 * @param[out] out_bytes  room for GZ_HID_DESCRIPTOR_SIZE
 * @param[out] out_size   bytes written; written on success
 * @retval GZ_ERR_NO_DEVICE  it is gone
 */
enum gz_result gz_hid_port_descriptor(const char *path, unsigned char *out_bytes, size_t *out_size);

/**
 * Check whether this user may open an interface.
 *
 * @retval GZ_ERR_ACCESS     no
 * @retval GZ_ERR_NO_DEVICE  it is gone
 */
enum gz_result gz_hid_port_may_open(const char *path);

/**
 * Open an interface.
 *
 * @param[out] out_port  owned by the caller: gz_hid_port_close()
 * @retval GZ_ERR_ACCESS, GZ_ERR_NO_DEVICE  not logged
 */
enum gz_result gz_hid_port_open(const char *path, struct gz_hid_port **out_port);

/**
 * Wait for an input report. Does not allocate unless it fails.
 *
 * @param size        room, bytes; a longer report is cut
 * @param timeout_ms  longest wait, ms; 0 polls
 * @param[out] out_size  bytes written; written on success
 * @retval GZ_ERR_TIMEOUT    none came, or a signal interrupted the wait
 * @retval GZ_ERR_NO_DEVICE  the device is gone
 */
enum gz_result gz_hid_port_read(struct gz_hid_port *port, unsigned char *out_bytes, size_t size,
				int timeout_ms, size_t *out_size);

/**
 * Request a feature report. Blocks until the device answers, for up to 5 s.
 *
 * @param id    0 if reports have no IDs
 * @param[out] out_bytes  the report, beginning with the ID even if that is 0
 * @param size  room, bytes
 * @param[out] out_size  bytes written, 1 or more; written on success
 * @retval GZ_ERR_IO  the device does not answer
 */
enum gz_result gz_hid_port_get_feature(struct gz_hid_port *port, uint8_t id,
				       unsigned char *out_bytes, size_t size, size_t *out_size);

/**
 * Send a feature report.
 *
 * @param bytes, size  the report, beginning with the ID even if that is 0
 * @retval GZ_ERR_IO  the device does not accept it
 */
enum gz_result gz_hid_port_set_feature(struct gz_hid_port *port, const unsigned char *bytes,
				       size_t size);

/** Close and set to NULL. Accepts a pointer to NULL. */
void gz_hid_port_close(struct gz_hid_port **port);

#endif
