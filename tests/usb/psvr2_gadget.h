/**
 * @file
 * The eye tracker of a PlayStation VR2: the vendor-specific interface 5 with the bulk endpoint
 * 0x85, which is silent until a control transfer enables it. Played by GadgetFS for two reasons:
 * the transfer goes to an endpoint 0, which neither configfs nor FunctionFS passes on, and GadgetFS
 * keeps the numbers of interfaces and endpoints as they are described.
 */
#ifndef GZ_TESTS_USB_PSVR2_GADGET_H
#define GZ_TESTS_USB_PSVR2_GADGET_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "drivers/psvr2_made.h"
#include "made_gaze.h"

/** Distance from the lenses to the screen of the tests, mm. */
#define PSVR2_DISTANCE_MM 600.0

/** A headset. Zero-initialised is none. */
struct psvr2_gadget {
	const char *serial;
	struct made_stream stream;
	pthread_t thread;
	bool plugged;
	atomic_bool stop;
	int control; /**< device file of the control endpoint */
	_Atomic int
		endpoint;    /**< valid after the host has chosen the configuration; otherwise -1 */
	_Atomic int error;   /**< errno of a failure on the thread; 0 for none */
	_Atomic uint32_t on; /**< correct control transfers that switch the stream on */
	_Atomic uint32_t off;     /**< control transfers that switch it off */
	_Atomic uint32_t unknown; /**< other vendor control transfers */
	_Atomic int64_t
		on_ns; /**< CLOCK_MONOTONIC of the newest transfer that switched on; 0 if off */
	_Atomic int64_t longest_ns; /**< longest time between two of these transfers */
	atomic_bool blinking;       /**< both eyes are closed */
};

/** Plug the headset in. It sends while its stream runs and it has been switched on within the last
 * two seconds. There can be only one. */
void psvr2_gadget_plug(struct psvr2_gadget *headset, const char *serial);

/** Stop its stream and unplug it; psvr2_gadget_plug() plugs it in again. */
void psvr2_gadget_unplug(struct psvr2_gadget *headset);

/** Lay out the packet of @p sample. */
void psvr2_gadget_encode(const struct psvr2_gadget *headset, const struct made_sample *sample,
			 uint8_t packet[GZ_PSVR2_PACKET_SIZE]);

/** Send any bytes as one packet. @return whether the host read it */
bool psvr2_gadget_send(struct psvr2_gadget *headset, const void *packet, size_t size);

/** Stall the endpoint, until the host clears that. The stream must be stopped. */
void psvr2_gadget_stall(struct psvr2_gadget *headset);

/** Stop its stream and unplug it. For teardowns, too. */
void psvr2_gadget_remove(struct psvr2_gadget *headset);

#endif
