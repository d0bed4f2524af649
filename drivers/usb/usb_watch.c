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

/* Pause after an error of libusb's, so that one that stays does not keep a core busy. */
static const int64_t ERROR_PAUSE_NS = GZ_NS_PER_S;

struct gz_usb_watch {
	const struct gz_log *log;
	libusb_context *context;
	int fd;
	pthread_t thread;
	bool has_thread;
	atomic_bool quit;
};

/* Called within libusb_handle_events(), on the watch's thread. */
static int LIBUSB_CALL on_arrival(libusb_context *context, libusb_device *device,
				  libusb_hotplug_event event, void *user)
{
	const struct gz_usb_watch *watch = user;
	const uint64_t one = 1;
	(void)context;
	(void)device;
	(void)event;
	/* Cannot fail but where it is full, and then the reader is told already. */
	ssize_t written = write(watch->fd, &one, sizeof one);
	(void)written;
	return 0; /* go on */
}

static void *run(void *user)
{
	struct gz_usb_watch *watch = user;
	struct gz_ratelimit complaints = { 0 };
	while (!atomic_load(&watch->quit)) {
		uint64_t held_back;
		int error = libusb_handle_events(watch->context);
		if (error == LIBUSB_SUCCESS || error == LIBUSB_ERROR_INTERRUPTED)
			continue;
		if (gz_ratelimit_pass(&complaints, gz_clock_now_ns(), 60 * GZ_NS_PER_S, &held_back))
			gz_warn(watch->log, "hot-plug: %s", libusb_error_name(error));
		gz_clock_sleep_until_ns(gz_clock_now_ns() + ERROR_PAUSE_NS);
	}
	return NULL;
}

static enum gz_result open_watch(struct gz_usb_watch *watch)
{
	watch->fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	if (watch->fd < 0) {
		gz_err(watch->log, "hot-plug: no eventfd: %s", strerror(errno));
		return GZ_ERR_IO;
	}
	int error = libusb_init(&watch->context);
	if (error != LIBUSB_SUCCESS) {
		watch->context = NULL;
		gz_err(watch->log, "hot-plug: no USB here: %s", libusb_error_name(error));
		return GZ_ERR_IO;
	}
	error = libusb_hotplug_register_callback(
		watch->context, LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED, 0, LIBUSB_HOTPLUG_MATCH_ANY,
		LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY, on_arrival, watch, NULL);
	if (error != LIBUSB_SUCCESS) {
		gz_err(watch->log, "hot-plug: %s", libusb_error_name(error));
		return GZ_ERR_IO;
	}
	if (pthread_create(&watch->thread, NULL, run, watch) != 0) {
		gz_err(watch->log, "hot-plug: no thread: %s", strerror(errno));
		return GZ_ERR_NO_MEM;
	}
	watch->has_thread = true;
	return GZ_OK;
}

enum gz_result gz_usb_watch_create(const char *udev_control, const struct gz_log *log,
				   struct gz_usb_watch **out_watch)
{
	if (access(udev_control, F_OK) != 0 || !libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG)) {
		gz_info(log, "no udev here tells what is plugged in; a tracker that is missing is "
			     "looked for every few seconds");
		return GZ_ERR_UNSUPPORTED;
	}
	struct gz_usb_watch *watch = calloc(1, sizeof *watch);
	if (!watch)
		return GZ_ERR_NO_MEM;
	watch->log = log;
	enum gz_result result = open_watch(watch);
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
		libusb_exit(w->context); /* and its callbacks with it */
	if (w->fd >= 0)
		close(w->fd);
	free(w);
	*watch = NULL;
}
