/**
 * @file
 * HID devices played in this process: linked in place of drivers/hid/hid_port.c, so that the whole
 * driver above it runs against them. Thread-safe where a test plays a device while the driver reads
 * it.
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

/** Pull a device out; an open one reads as gone. */
void hid_played_unplug(int number);

/** Pull all out and forget what they held. */
void hid_played_reset(void);

/** What opening it answers; GZ_OK after plugging. */
void hid_played_set_access(int number, enum gz_result result);

/** What a feature report answers from now on, its ID first; size 0: nothing any more. */
void hid_played_set_feature(int number, uint8_t id, const unsigned char *bytes, size_t size);

/** The same read back: also what the driver has set. @return bytes, 0 if there is none */
size_t hid_played_get_feature(int number, uint8_t id, unsigned char *out_bytes);

/** How often the driver has set a feature report. */
int hid_played_times_set(int number);

/** Send an input report. @return whether somebody has it open and has room, some 200 reports */
bool hid_played_send(int number, const unsigned char *bytes, size_t size);

#endif
