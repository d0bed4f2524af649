/**
 * @file
 * A Tobii Eye Tracker 5, as the public description has it: the vendor-specific interface 0 with the
 * bulk endpoints 0x83 and 0x05. Played by GadgetFS, which keeps the numbers of endpoints as they
 * are described. What it says is laid out by tobii5_made.h.
 */
#ifndef GZ_TESTS_USB_TOBII5_GADGET_H
#define GZ_TESTS_USB_TOBII5_GADGET_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "drivers/tobii5_made.h"
#include "made_gaze.h"

/** A tracker. Zero-initialised is none. */
struct tobii5_gadget {
	const char *serial;
	struct made_stream stream;
	struct tobii5_played played; /**< used by the thread that answers */
	pthread_t control_thread, answer_thread;
	bool plugged;
	atomic_bool stop;
	int control;     /**< device file of the control endpoint */
	_Atomic int in;  /**< valid after the host has chosen the configuration; otherwise -1 */
	_Atomic int out; /**< likewise */
	pthread_mutex_t sending;
	_Atomic uint32_t opened, closed; /**< sessions */
	atomic_bool subscribed;
	atomic_bool blinking; /**< both eyes are closed */
};

/** Plug the tracker in, with this display area. It sends while its stream runs and gaze has been
 * subscribed to. There can be only one device of GadgetFS. */
void tobii5_gadget_plug(struct tobii5_gadget *tracker, const char *serial,
			const double corner_mm[3][3]);

/** Stop its stream and unplug it; tobii5_gadget_plug() plugs it in again. */
void tobii5_gadget_unplug(struct tobii5_gadget *tracker);

/** Send any bytes as one transfer. @return whether the host read it */
bool tobii5_gadget_send(struct tobii5_gadget *tracker, const void *bytes, size_t size);

/** Stop its stream and unplug it. For teardowns, too. */
void tobii5_gadget_remove(struct tobii5_gadget *tracker);

#endif
