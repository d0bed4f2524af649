/**
 * @file
 * Tells when something is plugged into USB, so that a tracker that is waited for is looked for at
 * once. By libusb's hot-plug callbacks, on a thread of its own; the reader sees a descriptor to
 * poll.
 */
#ifndef GZ_DRIVERS_USB_WATCH_H
#define GZ_DRIVERS_USB_WATCH_H

#include "base/log.h"
#include "base/result.h"

/** Where udev's daemon listens: without it nobody tells libusb what is plugged in. */
#define GZ_UDEV_CONTROL "/run/udev/control"

/** A watch. */
struct gz_usb_watch;

/**
 * Begin to watch.
 *
 * @param udev_control  GZ_UDEV_CONTROL
 * @param log           borrowed, outlives the watch
 * @retval GZ_ERR_UNSUPPORTED  plugging in is not told here (a container without udev); logged
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_usb_watch_create(const char *udev_control, const struct gz_log *log,
				   struct gz_usb_watch **out_watch);

/**
 * An eventfd: readable from the first arrival on until its 8 bytes are read. Belongs to the watch.
 * -1 for NULL.
 */
int gz_usb_watch_fd(const struct gz_usb_watch *watch);

/** End the thread, free and set to NULL. Accepts a pointer to NULL. */
void gz_usb_watch_destroy(struct gz_usb_watch **watch);

#endif
