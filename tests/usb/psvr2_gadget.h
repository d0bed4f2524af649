/**
 * @file
 * A PlayStation VR2 as far as its eye tracker goes: the vendor-specific interface 5 with the bulk
 * endpoint 0x85, which is silent until a control transfer enables it. Played over GadgetFS, because
 * that transfer is for an endpoint 0, which neither configfs nor FunctionFS hands on, and because
 * GadgetFS leaves the numbers of interfaces and endpoints as they are described.
 */
#ifndef GZ_TESTS_USB_PSVR2_GADGET_H
#define GZ_TESTS_USB_PSVR2_GADGET_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "made_gaze.h"

/** Bytes of a packet. */
#define PSVR2_PACKET_SIZE 328

/** From the lenses to the screen of the tests, mm. */
#define PSVR2_DISTANCE_MM 600.0

/** A headset. Zero-initialised is none. */
struct psvr2_gadget {
	const char *serial;
	struct made_stream stream;
	pthread_t thread;
	bool plugged;
	atomic_bool stop;
	int control;                /**< the device's file */
	_Atomic int endpoint;       /**< once the host has chosen the configuration; else -1 */
	_Atomic int error;          /**< errno of what went wrong on the thread; 0 */
	_Atomic uint32_t on;        /**< control transfers that switch on, as they should be */
	_Atomic uint32_t off;       /**< that switch off */
	_Atomic uint32_t unknown;   /**< control transfers of the vendor's that are neither */
	_Atomic int64_t on_ns;      /**< CLOCK_MONOTONIC of the newest that switched on; 0 if off */
	_Atomic int64_t longest_ns; /**< longest time between two of them */
	atomic_bool blinking;       /**< both eyes are closed */
};

/** Plug the headset in. It sends while its stream runs and it has been switched on within the last
 *  two seconds. There can be one. */
void psvr2_gadget_plug(struct psvr2_gadget *headset, const char *serial);

/** Stop its stream and pull it out; psvr2_gadget_plug() plugs it in again. */
void psvr2_gadget_unplug(struct psvr2_gadget *headset);

/** Lay out the packet of @p sample. */
void psvr2_gadget_encode(const struct psvr2_gadget *headset, const struct made_sample *sample,
			 uint8_t packet[PSVR2_PACKET_SIZE]);

/** Send any bytes as one packet. @return whether the host took it */
bool psvr2_gadget_send(struct psvr2_gadget *headset, const void *packet, size_t size);

/** Stall the endpoint, until the host clears that. The stream is stopped. */
void psvr2_gadget_stall(struct psvr2_gadget *headset);

/** Stop its stream and pull it out. For a teardown, too. */
void psvr2_gadget_remove(struct psvr2_gadget *headset);

#endif
