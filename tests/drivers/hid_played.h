/**
 * @file
 * Fake HID devices in this process: linked in place of drivers/hid/hid_port.c, so that the driver
 * above it runs unchanged. Thread-safe, for tests that send on another thread than the driver
 * reads.
 */
#ifndef GZ_TESTS_DRIVERS_HID_PLAYED_H
#define GZ_TESTS_DRIVERS_HID_PLAYED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"

enum { HID_PLAYED_MAX = 4, HID_PLAYED_FEATURE_SIZE = 64 };

/** Plug a device in. @return its number */
int hid_played_plug(const char *name, const char *serial, const unsigned char *descriptor,
		    size_t size);

/** Unplug a device. If it is open, reading it reports that it is gone. */
void hid_played_unplug(int number);

/** Unplug all devices and forget their reports. */
void hid_played_reset(void);

/** Set the result of opening the device; GZ_OK after plugging in. */
void hid_played_set_access(int number, enum gz_result result);

/** Set a feature report, beginning with its ID. Size 0: the device no longer answers requests for
 * it. */
void hid_played_set_feature(int number, uint8_t id, const unsigned char *bytes, size_t size);

/** Get a feature report, also one that the driver has set. @return bytes, 0 if there is none */
size_t hid_played_get_feature(int number, uint8_t id, unsigned char *out_bytes);

/** How often the driver has set a feature report. */
int hid_played_times_set(int number);

/** Send an input report. @return whether the device is open and has room; some 200 reports fit */
bool hid_played_send(int number, const unsigned char *bytes, size_t size);

#endif
