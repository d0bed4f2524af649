#include "drivers/usb/usb_watch.h"

#include <errno.h>
#include <libusb.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "base/clock.h"

#define GZ_LOG_MODULE "usb"

/* Pause after an error of libusb, so that a permanent one does not keep a core busy. */
static const int64_t ERROR_PAUSE_NS = GZ_NS_PER_S;

struct gz_usb_watch {
	const struct gz_log *log;
	libusb_context *context;
	int fd;
	pthread_t thread;
	bool has_thread;
	atomic_bool quit;
};

/* Called within libusb_handle_events(), on the thread of the watch. */
static int LIBUSB_CALL note_usb_arrival(libusb_context *context, libusb_device *device,
					libusb_hotplug_event event, void *user)
{
	const struct gz_usb_watch *watch = user;
	const uint64_t one = 1;
	(void)context;
	(void)device;
	(void)event;
	/* Fails only if the counter is full; then the reader has been notified already. */
	ssize_t written = write(watch->fd, &one, sizeof one);
	(void)written;
	return 0; /* keep the callback */
}

static void *run_usb_watch(void *user)
{
	struct gz_usb_watch *watch = user;
	struct gz_ratelimit complaints = { 0 };
	while (!atomic_load(&watch->quit)) {
		uint64_t held_back;
		int error = libusb_handle_events(watch->context);
		if (error == LIBUSB_SUCCESS || error == LIBUSB_ERROR_INTERRUPTED)
			continue;
		if (gz_ratelimit_pass(&complaints, gz_clock_now_ns(), 60 * GZ_NS_PER_S, &held_back))
			gz_warn(watch->log, "USB hot-plug: %s", libusb_error_name(error));
		gz_clock_sleep_until_ns(gz_clock_now_ns() + ERROR_PAUSE_NS);
	}
	return NULL;
}

static enum gz_result open_usb_watch(struct gz_usb_watch *watch)
{
	watch->fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	if (watch->fd < 0) {
		gz_err(watch->log, "USB hot-plug: cannot make an eventfd: %s", strerror(errno));
		return GZ_ERR_IO;
	}
	int error = libusb_init(&watch->context);
	if (error != LIBUSB_SUCCESS) {
		watch->context = NULL;
		gz_err(watch->log, "USB hot-plug: cannot access USB: %s", libusb_error_name(error));
		return GZ_ERR_IO;
	}
	error = libusb_hotplug_register_callback(
		watch->context, LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED, 0, LIBUSB_HOTPLUG_MATCH_ANY,
		LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY, note_usb_arrival, watch, NULL);
	if (error != LIBUSB_SUCCESS) {
		gz_err(watch->log, "USB hot-plug: %s", libusb_error_name(error));
		return GZ_ERR_IO;
	}
	error = pthread_create(&watch->thread, NULL, run_usb_watch, watch);
	if (error != 0) {
		gz_err(watch->log, "USB hot-plug: cannot start a thread: %s", strerror(error));
		return GZ_ERR_NO_MEM;
	}
	watch->has_thread = true;
	return GZ_OK;
}

enum gz_result gz_usb_watch_create(const char *udev_control, const struct gz_log *log,
				   struct gz_usb_watch **out_watch)
{
	if (access(udev_control, F_OK) != 0 || !libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG)) {
		gz_info(log, "no udev here reports what is plugged in; a missing tracker is "
			     "searched for every few seconds");
		return GZ_ERR_UNSUPPORTED;
	}
	struct gz_usb_watch *watch = calloc(1, sizeof *watch);
	if (!watch)
		return GZ_ERR_NO_MEM;
	watch->log = log;
	enum gz_result result = open_usb_watch(watch);
	if (result != GZ_OK) {
		gz_usb_watch_destroy(&watch);
		return result;
	}
	*out_watch = watch;
	return GZ_OK;
}

int gz_usb_watch_fd(const struct gz_usb_watch *watch)
{
	return watch ? watch->fd : -1;
}

void gz_usb_watch_destroy(struct gz_usb_watch **watch)
{
	if (!watch || !*watch)
		return;
	struct gz_usb_watch *w = *watch;
	if (w->has_thread) {
		atomic_store(&w->quit, true);
		libusb_interrupt_event_handler(w->context);
		pthread_join(w->thread, NULL);
	}
	if (w->context)
		libusb_exit(w->context); /* also removes the callback */
	if (w->fd >= 0)
		close(w->fd);
	free(w);
	*watch = NULL;
}
