/**
 * @file
 * A USB function that a program plays (FunctionFS): its descriptors, its answers to control
 * transfers and the packets of its endpoint.
 */
#ifndef GZ_TESTS_USB_FUNCTIONFS_H
#define GZ_TESTS_USB_FUNCTIONFS_H

#include <linux/usb/ch9.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "gadget.h"

/** Most data of a control transfer, bytes. */
#define FUNCTIONFS_CONTROL_MAX 1024

/** Callbacks of a function. Both are called on the thread of the function. */
struct functionfs_player {
	/** The host requests data. @return bytes written to @p bytes, or -1 to stall. */
	ssize_t (*get)(void *player, const struct usb_ctrlrequest *request, uint8_t *bytes);

	/** The host has sent data. */
	void (*set)(void *player, const struct usb_ctrlrequest *request, const uint8_t *bytes,
		    size_t size);
};

/** A function with one IN endpoint that is used, the last one described. */
struct functionfs {
	const struct functionfs_player *calls;
	void *player;
	char folder[48]; /**< where it is mounted */
	int control;     /**< ep0 */
	int endpoint;    /**< the last one described */
	pthread_t thread;
	bool running;
	atomic_bool stop;
	bool refuses_data; /**< control transfers with data from the host are stalled */
};

/** Descriptors of a function. */
struct functionfs_descriptors {
	const void *bytes; /**< interface and endpoint descriptors, the same at every speed */
	size_t size;
	uint32_t count; /**< descriptors in @p bytes */
	int endpoints;  /**< number of endpoints among them */
};

/** Make the function @p name of @p gadget and start to play it. */
void functionfs_start(struct functionfs *function, struct gadget *gadget, const char *name,
		      const struct functionfs_descriptors *descriptors);

/** Send a packet on the endpoint and wait until the host has read it. @return false if the host
 * does not: unplugged, or not configured */
bool functionfs_send(struct functionfs *function, const void *bytes, size_t size);

/** End it, after its gadget has been removed. For teardowns, too. */
void functionfs_stop(struct functionfs *function);

#endif
