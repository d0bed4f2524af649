/**
 * @file
 * Reports when something is plugged into USB, so that a missing tracker is searched for at once.
 * Uses libusb's hot-plug callbacks on a thread of its own; the reader polls a file descriptor.
 */
#ifndef GZ_DRIVERS_USB_WATCH_H
#define GZ_DRIVERS_USB_WATCH_H

#include "base/log.h"
#include "base/result.h"

/** Where udev's daemon listens. Without it, nothing tells libusb what is plugged in. */
#define GZ_UDEV_CONTROL "/run/udev/control"

/** A watch. */
struct gz_usb_watch;

/**
 * Start to watch.
 *
 * @param udev_control  GZ_UDEV_CONTROL
 * @param log           borrowed, outlives the watch
 * @param[out] out_watch  owned by the caller: gz_usb_watch_destroy()
 * @retval GZ_ERR_UNSUPPORTED  hot-plug is not reported here (a container without udev); logged
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_usb_watch_create(const char *udev_control, const struct gz_log *log,
				   struct gz_usb_watch **out_watch);

/**
 * An eventfd: readable from the first arrival until its 8 bytes are read. Owned by the watch.
 * -1 for NULL.
 */
int gz_usb_watch_fd(const struct gz_usb_watch *watch);

/** Stop the thread, free and set to NULL. Accepts a pointer to NULL. */
void gz_usb_watch_destroy(struct gz_usb_watch **watch);

#endif
