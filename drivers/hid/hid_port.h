/**
 * @file
 * The system's HID devices: hidapi's hidraw backend, and what it cannot give (report descriptors,
 * which hidapi 0.13 does not return). All I/O of the driver goes through here; tests link another
 * implementation in its place.
 */
#ifndef GZ_DRIVERS_HID_PORT_H
#define GZ_DRIVERS_HID_PORT_H

#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "drivers/hid/hid_descriptor.h"
#include "protocol/gaze.h"

/** Most interfaces that are looked at. Chosen: a busy desk has a dozen. */
#define GZ_HID_PORT_ENTRIES_MAX 64

/** An interface that is there. */
struct gz_hid_port_entry {
	char path[GZ_NAME_SIZE]; /**< "/dev/hidraw0" */
	char name[GZ_NAME_SIZE]; /**< the product's name; its numbers where it has none */
	char serial[GZ_NAME_SIZE];
	uint16_t vendor, product;
};

/** An open interface. Threads: one at a time. */
struct gz_hid_port;

/**
 * List the interfaces, opening none.
 *
 * @param[out] out_entries  room for GZ_HID_PORT_ENTRIES_MAX
 * @return how many were written
 */
size_t gz_hid_port_list(struct gz_hid_port_entry *out_entries);

/**
 * The report descriptor of an interface, without opening it.
 *
 * @param[out] out_bytes  room for GZ_HID_DESCRIPTOR_SIZE
 * @param[out] out_size   bytes written; written on success
 * @retval GZ_ERR_NO_DEVICE  it is gone
 */
enum gz_result gz_hid_port_descriptor(const char *path, unsigned char *out_bytes, size_t *out_size);

/**
 * Whether this user may open an interface.
 *
 * @retval GZ_ERR_ACCESS     no
 * @retval GZ_ERR_NO_DEVICE  it is gone
 */
enum gz_result gz_hid_port_may_open(const char *path);

/**
 * Open an interface.
 *
 * @param[out] out_port  gz_hid_port_close()
 * @retval GZ_ERR_ACCESS, GZ_ERR_NO_DEVICE  not logged
 */
enum gz_result gz_hid_port_open(const char *path, struct gz_hid_port **out_port);

/**
 * Wait for an input report. Does not allocate unless it fails.
 *
 * @param size        bytes of room; a longer report is cut
 * @param timeout_ms  0 polls
 * @param[out] out_size  bytes written; written on success
 * @retval GZ_ERR_TIMEOUT    none came, or a signal did
 * @retval GZ_ERR_NO_DEVICE  it is gone
 */
enum gz_result gz_hid_port_read(struct gz_hid_port *port, unsigned char *out_bytes, size_t size,
				int timeout_ms, size_t *out_size);

/**
 * Ask for a feature report. Blocks while the device thinks, 5 s at most.
 *
 * @param id    0 where reports have none
 * @param[out] out_bytes  the report, the ID first even if it is 0
 * @param size  bytes of room
 * @param[out] out_size  bytes written, 1 or more; written on success
 * @retval GZ_ERR_IO  it does not answer
 */
enum gz_result gz_hid_port_get_feature(struct gz_hid_port *port, uint8_t id,
				       unsigned char *out_bytes, size_t size, size_t *out_size);

/** Send a feature report, the ID first even if it is 0. @retval GZ_ERR_IO it was not taken */
enum gz_result gz_hid_port_set_feature(struct gz_hid_port *port, const unsigned char *bytes,
				       size_t size);

/** Close and set to NULL. Accepts a pointer to NULL. */
void gz_hid_port_close(struct gz_hid_port **port);

#endif
