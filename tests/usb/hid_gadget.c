#include "suite.h"

#include "hid_gadget.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Open the device node of the function. Its number is in configfs. */
static int open_node(const char *folder)
{
	char path[160], text[32] = "";
	unsigned int major, minor;
	snprintf(path, sizeof path, "%s/dev", folder);
	FILE *file = fopen(path, "r");
	assert_non_null(file);
	assert_non_null(fgets(text, sizeof text, file));
	fclose(file);
	assert_int_equal(sscanf(text, "%u:%u", &major, &minor), 2);
	snprintf(path, sizeof path, "/dev/hidg%u", minor);
	int fd = open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC);
	if (fd < 0)
		fail_msg("%s: %s", path, strerror(errno));
	return fd;
}

static void set_um(int32_t um[3], const double mm[3])
{
	for (size_t i = 0; i < 3; i++)
		um[i] = (int32_t)lround(mm[i] * 1000);
}

size_t hid_gadget_report(enum hid_layout layout, const struct made_sample *sample, uint8_t *report)
{
	static const double left_mm[3] = HID_LEFT_EYE_MM, right_mm[3] = HID_RIGHT_EYE_MM;
	struct hid_made_sample laid_out = {
		.time_us = (uint64_t)sample->device_us,
		.gaze = { (int32_t)lround(sample->x * MADE_WIDTH_MM * 1000),
			  (int32_t)lround(sample->y * MADE_HEIGHT_MM * 1000) },
	};
	set_um(laid_out.left, left_mm);
	set_um(laid_out.right, right_mm);
	return hid_made_report(layout, &laid_out, report);
}

static void send_sample(void *argument, const struct made_sample *sample)
{
	struct hid_gadget *tracker = argument;
	uint8_t report[HID_REPORT_MAX];
	size_t size = hid_gadget_report(tracker->layout, sample, report);
	/* Refused while the last report still waits for the host. */
	ssize_t ignored = write(tracker->fd, report, size);
	(void)ignored;
}

void hid_gadget_plug(struct hid_gadget *tracker, int controller, enum hid_layout layout,
		     const char *name, const char *serial)
{
	struct gadget_identity identity = { 0x1209, 0x0001, "Gazecast", name, serial };
	struct made_sample sample = made_gaze(0);
	struct hid_made made = { 0 };
	uint8_t report[HID_REPORT_MAX];
	char folder[128];
	*tracker = (struct hid_gadget) {
		.layout = layout,
		.made = true,
		.fd = -1,
		.stream = { .send = send_sample,
			    .tracker = tracker,
			    .has_clock = hid_layout_tick_us(layout) > 0,
			    /* 0.1 mm, or less */
			    .tolerance = layout == HID_LAYOUT_COARSE || layout == HID_LAYOUT_TIME64
						 ? 4e-4
						 : 1e-4 },
	};
	gadget_make(&tracker->gadget, controller, &identity);
	gadget_add_function(&tracker->gadget, "hid", serial, folder, sizeof folder);
	gadget_print(folder, "protocol", "0");
	gadget_print(folder, "subclass", "0");
	gadget_print(folder, "report_length", "%zu", hid_gadget_report(layout, &sample, report));
	hid_made_tracker(&made, layout);
	gadget_write(folder, "report_desc", made.bytes, made.size);
	gadget_link_function(&tracker->gadget, "hid", serial);
	gadget_plug(&tracker->gadget);
	tracker->fd = open_node(folder);
}

void hid_gadget_send(struct hid_gadget *tracker, const void *report, size_t size)
{
	struct pollfd room = { .fd = tracker->fd, .events = POLLOUT };
	ssize_t written = poll(&room, 1, 5000) == 1 ? write(tracker->fd, report, size) : -1;
	if (written != (ssize_t)size)
		fail_msg("sending a report of %zu bytes: %s", size, strerror(errno));
}

void hid_gadget_remove(struct hid_gadget *tracker)
{
	if (!tracker->made)
		return;
	made_stream_stop(&tracker->stream);
	if (tracker->fd >= 0)
		close(tracker->fd);
	gadget_remove(&tracker->gadget);
	*tracker = (struct hid_gadget) { .fd = -1 };
}
