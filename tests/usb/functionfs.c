#include "suite.h"

#include "functionfs.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/usb/functionfs.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <unistd.h>

/* Descriptors in the format of FunctionFS: a header, then the descriptors for full and for high
 * speed. */
static size_t lay_out(const struct functionfs_descriptors *descriptors, uint8_t *out, size_t room)
{
	uint32_t flags = FUNCTIONFS_HAS_FS_DESC | FUNCTIONFS_HAS_HS_DESC;
	struct usb_functionfs_descs_head_v2 head = {
		.magic = FUNCTIONFS_DESCRIPTORS_MAGIC_V2,
		.flags = flags,
	};
	uint32_t counts[2] = { descriptors->count, descriptors->count };
	size_t length = sizeof head + sizeof counts + 2 * descriptors->size;
	assert_true(length <= room);
	head.length = (uint32_t)length;
	memcpy(out, &head, sizeof head);
	memcpy(out + sizeof head, counts, sizeof counts);
	uint8_t *bytes = out + sizeof head + sizeof counts;
	memcpy(bytes, descriptors->bytes, descriptors->size);
	memcpy(bytes + descriptors->size, descriptors->bytes, descriptors->size);
	return length;
}

static void describe(struct functionfs *function, const struct functionfs_descriptors *descriptors)
{
	uint8_t bytes[1024];
	struct usb_functionfs_strings_head strings = {
		.magic = FUNCTIONFS_STRINGS_MAGIC,
		.length = sizeof strings,
	};
	size_t length = lay_out(descriptors, bytes, sizeof bytes);
	if (write(function->control, bytes, length) != (ssize_t)length)
		fail_msg("FunctionFS refuses the descriptors: %s", strerror(errno));
	if (write(function->control, &strings, sizeof strings) != sizeof strings)
		fail_msg("FunctionFS refuses the strings: %s", strerror(errno));
}

static void answer(struct functionfs *function, const struct usb_ctrlrequest *request)
{
	uint8_t bytes[FUNCTIONFS_CONTROL_MAX] = { 0 };
	size_t wanted = request->wLength < sizeof bytes ? request->wLength : sizeof bytes;
	if (request->bRequestType & USB_DIR_IN) {
		ssize_t size = function->calls->get(function->player, request, bytes);
		if (size < 0) /* a transfer in the wrong direction stalls */
			size = read(function->control, bytes, 0);
		else
			size = write(function->control, bytes,
				     (size_t)size < wanted ? (size_t)size : wanted);
		return;
	}
	ssize_t size = function->refuses_data && wanted > 0
			       ? write(function->control, bytes, 0)
			       : read(function->control, bytes, wanted);
	if (size >= 0)
		function->calls->set(function->player, request, bytes, (size_t)size);
}

static void *play(void *argument)
{
	struct functionfs *function = argument;
	struct pollfd ready = { .fd = function->control, .events = POLLIN };
	while (!function->stop) {
		struct usb_functionfs_event event;
		if (poll(&ready, 1, 20) <= 0)
			continue;
		ssize_t size = read(function->control, &event, sizeof event);
		if (size == (ssize_t)sizeof event && event.type == FUNCTIONFS_SETUP)
			answer(function, &event.u.setup);
	}
	return NULL;
}

static int open_file(const struct functionfs *function, const char *name, int flags)
{
	char path[96];
	snprintf(path, sizeof path, "%s/%s", function->folder, name);
	int fd = open(path, flags | O_CLOEXEC);
	if (fd < 0)
		fail_msg("%s: %s", path, strerror(errno));
	return fd;
}

void functionfs_start(struct functionfs *function, struct gadget *gadget, const char *name,
		      const struct functionfs_descriptors *descriptors)
{
	char folder[128], endpoint[16];
	gadget_add_function(gadget, "ffs", name, folder, sizeof folder);
	snprintf(function->folder, sizeof function->folder, "/tmp/ffs-%s", name);
	mkdir(function->folder, 0755);
	if (mount(name, function->folder, "functionfs", 0, NULL) != 0)
		fail_msg("mounting FunctionFS: %s", strerror(errno));
	function->control = open_file(function, "ep0", O_RDWR | O_NONBLOCK);
	describe(function, descriptors);
	snprintf(endpoint, sizeof endpoint, "ep%d", descriptors->endpoints);
	function->endpoint = open_file(function, endpoint, O_RDWR);
	assert_int_equal(pthread_create(&function->thread, NULL, play, function), 0);
	function->running = true;
	gadget_link_function(gadget, "ffs", name);
}

bool functionfs_send(struct functionfs *function, const void *bytes, size_t size)
{
	return write(function->endpoint, bytes, size) == (ssize_t)size;
}

void functionfs_stop(struct functionfs *function)
{
	if (function->running) {
		function->stop = true;
		pthread_join(function->thread, NULL);
		function->running = false;
	}
	if (function->folder[0]) {
		close(function->endpoint);
		close(function->control);
		umount(function->folder);
		rmdir(function->folder);
		function->folder[0] = '\0';
	}
}
