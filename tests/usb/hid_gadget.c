#include "check.h"

#include "hid_gadget.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* The device node of the function: its number is in configfs. */
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

static void send_sample(void *argument, const struct made_sample *sample)
{
	struct hid_gadget *tracker = argument;
	uint8_t report[HID_REPORT_MAX] = { 0 };
	tracker->layout->encode(sample, report);
	/* Refused while the one before still waits for the host. */
	ssize_t ignored = write(tracker->fd, report, tracker->layout->report_size);
	(void)ignored;
}

void hid_gadget_plug(struct hid_gadget *tracker, int controller, const struct hid_layout *layout,
		     const char *name, const char *serial)
{
	struct gadget_identity identity = { 0x1209, 0x0001, "Gazecast", name, serial };
	char folder[128];
	*tracker = (struct hid_gadget) {
		.layout = layout,
		.fd = -1,
		.stream = { .send = send_sample, .tracker = tracker },
	};
	gadget_make(&tracker->gadget, controller, &identity);
	gadget_add_function(&tracker->gadget, "hid", serial, folder, sizeof folder);
	gadget_print(folder, "protocol", "0");
	gadget_print(folder, "subclass", "0");
	gadget_print(folder, "report_length", "%zu", layout->report_size);
	gadget_write(folder, "report_desc", layout->descriptor, layout->descriptor_size);
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
	if (!tracker->layout)
		return;
	made_stream_stop(&tracker->stream);
	if (tracker->fd >= 0)
		close(tracker->fd);
	gadget_remove(&tracker->gadget);
	*tracker = (struct hid_gadget) { .fd = -1 };
}
