/**
 * @file
 * A USB function that a program plays by itself (FunctionFS): its descriptors, its answers to
 * control transfers and what its endpoint sends.
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

/** Longest data of a control transfer that is played. */
#define FUNCTIONFS_CONTROL_MAX 1024

/** What plays a function. Both calls come from the function's own thread. */
struct functionfs_player {
	/** The host wants data. @return bytes put into @p bytes, or -1 to stall. */
	ssize_t (*get)(void *player, const struct usb_ctrlrequest *request, uint8_t *bytes);

	/** The host has sent data. */
	void (*set)(void *player, const struct usb_ctrlrequest *request, const uint8_t *bytes,
		    size_t size);
};

/** A function with one IN endpoint that matters, its newest one. */
struct functionfs {
	const struct functionfs_player *calls;
	void *player;
	char folder[48]; /**< where it is mounted */
	int control;     /**< ep0 */
	int endpoint;    /**< the last one described */
	pthread_t thread;
	bool running;
	atomic_bool stop;
	bool refuses_data; /**< control transfers by which the host sends something are stalled */
};

/** What a function is made of. */
struct functionfs_descriptors {
	const void *bytes; /**< interface and endpoint descriptors, the same at every speed */
	size_t size;
	uint32_t count; /**< descriptors in @p bytes */
	int endpoints;  /**< endpoints among them */
};

/** Make the function @p name of @p gadget and start to play it. */
void functionfs_start(struct functionfs *function, struct gadget *gadget, const char *name,
		      const struct functionfs_descriptors *descriptors);

/** Send a packet over the endpoint. Waits until the host has taken it. @return false where it has
 *  not: unplugged, or not configured */
bool functionfs_send(struct functionfs *function, const void *bytes, size_t size);

/** Stall the endpoint, until the host clears that. */
void functionfs_stall(struct functionfs *function);

/** End it, once its gadget is unplugged and taken apart. For a teardown, too. */
void functionfs_stop(struct functionfs *function);

#endif
