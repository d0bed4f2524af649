#include "drivers/device/device.h"

#include <errno.h>
#include <poll.h>
#include <string.h>
#include <time.h>

enum gz_result gz_device_start(struct gz_device *device)
{
	return device->ops->start(device);
}

enum gz_result gz_device_read(struct gz_device *device, int timeout_ms,
			      struct gz_sample *out_sample)
{
	if (timeout_ms < 0)
		return GZ_ERR_INVAL;
	return device->ops->read(device, timeout_ms, out_sample);
}

void gz_device_get_info(const struct gz_device *device, struct gz_device_info *out_info)
{
	*out_info = (struct gz_device_info) { 0 };
	device->ops->info(device, out_info);
}

void gz_device_get_counters(const struct gz_device *device, struct gz_device_counters *out_counters)
{
	*out_counters = (struct gz_device_counters) { 0 };
	device->ops->counters(device, out_counters);
}

void gz_device_destroy(struct gz_device **device)
{
	if (!device || !*device)
		return;
	(*device)->ops->destroy(*device);
	*device = NULL;
}

bool gz_device_is_chosen(const char *choice, const char *name, const char *serial)
{
	if (!choice || !choice[0])
		return true;
	return strcmp(choice, serial) == 0 || strcmp(choice, name) == 0;
}

enum gz_result gz_device_poll(int fd, short events, int64_t deadline_ns)
{
	struct pollfd poll_fd = { .fd = fd, .events = events };
	for (;;) {
		int64_t left_ns = deadline_ns - gz_clock_now_ns();
		if (left_ns < 0)
			left_ns = 0;
		struct timespec timeout = { .tv_sec = (time_t)(left_ns / GZ_NS_PER_S),
					    .tv_nsec = (long)(left_ns % GZ_NS_PER_S) };
		int ready = ppoll(&poll_fd, 1, &timeout, NULL);
		if (ready > 0)
			return GZ_OK;
		if (ready == 0)
			return GZ_ERR_TIMEOUT;
		if (errno != EINTR)
			return GZ_ERR_NO_DEVICE;
	}
}
