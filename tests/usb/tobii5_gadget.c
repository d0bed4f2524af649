#include "suite.h"

#include "tobii5_gadget.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/usb/ch9.h>
#include <linux/usb/gadgetfs.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "drivers/frame_bytes.h"

#define FOLDER   "/dev/gadget"
#define CONTROL  FOLDER "/dummy_udc"
#define FILE_IN  FOLDER "/ep1in-bulk"
#define FILE_OUT FOLDER "/ep2out-bulk"

enum {
	ADDRESS_IN = 0x83,
	ADDRESS_OUT = 0x05,
	STRING_MAKER = 1,
	STRING_NAME = 2,
	STRING_SERIAL = 3,
	SESSION_OPEN = 0x41,
	SESSION_CLOSE = 0x42,
	TO_INTERFACE = 0x41, /* vendor request without an answer */
	CONTROL_MAX = 256,
	/* Bulk packets at full and at high speed. */
	FULL_SPEED_PACKET = 64,
	HIGH_SPEED_PACKET = 512,
};

static uint8_t *put_bytes(uint8_t *bytes, const void *more, size_t size)
{
	memcpy(bytes, more, size);
	return bytes + size;
}

static uint8_t *put_endpoint(uint8_t *bytes, uint8_t address, uint16_t packet_size)
{
	const uint8_t descriptor[] = {
		USB_DT_ENDPOINT_SIZE,
		USB_DT_ENDPOINT,
		address,
		USB_ENDPOINT_XFER_BULK,
		(uint8_t)packet_size,
		(uint8_t)(packet_size >> 8),
		0,
	};
	return put_bytes(bytes, descriptor, sizeof descriptor);
}

static uint8_t *put_configuration(uint8_t *bytes, uint16_t packet_size)
{
	const uint8_t head[] = {
		USB_DT_CONFIG_SIZE,
		USB_DT_CONFIG,
		USB_DT_CONFIG_SIZE + USB_DT_INTERFACE_SIZE + 2 * USB_DT_ENDPOINT_SIZE,
		0,
		1,
		1,
		0,
		USB_CONFIG_ATT_ONE | USB_CONFIG_ATT_SELFPOWER,
		50,
		USB_DT_INTERFACE_SIZE,
		USB_DT_INTERFACE,
		0,
		0,
		2,
		USB_CLASS_VENDOR_SPEC,
		0,
		0,
		0,
	};
	bytes = put_bytes(bytes, head, sizeof head);
	bytes = put_endpoint(bytes, ADDRESS_IN, packet_size);
	return put_endpoint(bytes, ADDRESS_OUT, packet_size);
}

/* Write what GadgetFS expects first: configurations for both speeds, and the device. */
static void describe_tracker(struct tobii5_gadget *tracker)
{
	static const uint8_t device[USB_DT_DEVICE_SIZE] = {
		USB_DT_DEVICE_SIZE,
		USB_DT_DEVICE,
		0x00,
		0x02,
		0,
		0,
		0,
		64,
		0x04,
		0x21,
		0x13,
		0x03,
		0x00,
		0x01,
		STRING_MAKER,
		STRING_NAME,
		STRING_SERIAL,
		1,
	};
	uint8_t bytes[256];
	uint8_t *end = frame_put(bytes, 4, 0);
	end = put_configuration(end, FULL_SPEED_PACKET);
	end = put_configuration(end, HIGH_SPEED_PACKET);
	end = put_bytes(end, device, sizeof device);
	if (write(tracker->control, bytes, (size_t)(end - bytes)) != end - bytes)
		fail_msg("GadgetFS refuses the descriptors: %s", strerror(errno));
}

static int open_bulk(const char *path, uint8_t address)
{
	uint8_t bytes[4 + 2 * USB_DT_ENDPOINT_SIZE];
	frame_put(bytes, 4, 1);
	put_endpoint(put_endpoint(bytes + 4, address, FULL_SPEED_PACKET), address,
		     HIGH_SPEED_PACKET);
	int fd = open(path, O_RDWR | O_CLOEXEC);
	if (fd >= 0 && write(fd, bytes, sizeof bytes) != sizeof bytes)
		fprintf(stderr, "%s: %s\n", path, strerror(errno));
	return fd;
}

static ssize_t put_string(const struct tobii5_gadget *tracker, uint8_t number, uint8_t *bytes)
{
	const char *const texts[] = { "", "Tobii Technology AB", "EyeChip", tracker->serial };
	if (number == 0) { /* the list of languages: English */
		frame_put(bytes, 4, 0x04090304);
		return 4;
	}
	if (number > STRING_SERIAL)
		return -1;
	uint8_t *end = bytes + 2;
	for (const char *text = texts[number]; *text; text++)
		end = frame_put(end, 2, (uint8_t)*text);
	bytes[0] = (uint8_t)(end - bytes);
	bytes[1] = USB_DT_STRING;
	return end - bytes;
}

static void answer_control_in(struct tobii5_gadget *tracker, const struct usb_ctrlrequest *request)
{
	uint8_t bytes[CONTROL_MAX] = { 0 };
	ssize_t size = -1, done;
	if (request->bRequest == USB_REQ_GET_DESCRIPTOR && request->wValue >> 8 == USB_DT_STRING)
		size = put_string(tracker, (uint8_t)request->wValue, bytes);
	if (size > request->wLength)
		size = request->wLength;
	if (size < 0) /* a transfer in the wrong direction stalls */
		done = read(tracker->control, bytes, 0);
	else
		done = write(tracker->control, bytes, (size_t)size);
	(void)done;
}

static void take_control_out(struct tobii5_gadget *tracker, const struct usb_ctrlrequest *request)
{
	uint8_t bytes[1];
	if (request->bRequestType == TO_INTERFACE && request->wLength == 0) {
		tracker->opened += request->bRequest == SESSION_OPEN;
		tracker->closed += request->bRequest == SESSION_CLOSE;
		if (request->bRequest == SESSION_CLOSE)
			tracker->subscribed = false;
	} else if (request->bRequest == USB_REQ_SET_CONFIGURATION && tracker->in < 0) {
		tracker->in = open_bulk(FILE_IN, ADDRESS_IN);
		tracker->out = open_bulk(FILE_OUT, ADDRESS_OUT);
	}
	ssize_t size = read(tracker->control, bytes, 0);
	(void)size; /* acknowledged */
}

static void *play_control(void *argument)
{
	struct tobii5_gadget *tracker = argument;
	struct pollfd ready = { .fd = tracker->control, .events = POLLIN };
	while (!tracker->stop) {
		struct usb_gadgetfs_event event;
		if (poll(&ready, 1, 20) <= 0 ||
		    read(tracker->control, &event, sizeof event) != sizeof event ||
		    event.type != GADGETFS_SETUP)
			continue;
		if (event.u.setup.bRequestType & USB_DIR_IN)
			answer_control_in(tracker, &event.u.setup);
		else
			take_control_out(tracker, &event.u.setup);
	}
	return NULL;
}

bool tobii5_gadget_send(struct tobii5_gadget *tracker, const void *bytes, size_t size)
{
	int fd = tracker->in;
	pthread_mutex_lock(&tracker->sending);
	bool sent = fd >= 0 && write(fd, bytes, size) == (ssize_t)size;
	pthread_mutex_unlock(&tracker->sending);
	return sent;
}

static void *play_answers(void *argument)
{
	struct tobii5_gadget *tracker = argument;
	const struct timespec pause = { .tv_nsec = 2000000 };
	while (!tracker->stop) {
		unsigned char request[HIGH_SPEED_PACKET], reply[TOBII5_MADE_MAX];
		int fd = tracker->out;
		ssize_t got = fd >= 0 ? read(fd, request, sizeof request) : -1;
		if (got <= 0) {
			nanosleep(&pause, NULL);
			continue;
		}
		size_t size = tobii5_played_answer(&tracker->played, request, (size_t)got, reply);
		if (size > 0)
			tobii5_gadget_send(tracker, reply, size);
		if (tracker->played.is_subscribed)
			tracker->subscribed = true;
	}
	return NULL;
}

static void send_made_sample(void *argument, const struct made_sample *sample)
{
	struct tobii5_gadget *tracker = argument;
	unsigned char bytes[TOBII5_MADE_MAX];
	if (!tracker->subscribed)
		return;
	struct tobii5_made_gaze gaze =
		tobii5_made_looking((uint32_t)sample->number, sample->x, sample->y);
	gaze.time_us = sample->device_us;
	if (tracker->blinking)
		gaze.known = gaze.eye[0].seen = gaze.eye[1].seen = false;
	tobii5_gadget_send(tracker, bytes, tobii5_made_gaze(&gaze, bytes));
}

/* Ends a read that waits for the host. */
static void ignore_signal(int signal)
{
	(void)signal;
}

void tobii5_gadget_plug(struct tobii5_gadget *tracker, const char *serial,
			const double corner_mm[3][3])
{
	const struct sigaction ignored = { .sa_handler = ignore_signal };
	sigaction(SIGUSR1, &ignored, NULL);
	tracker->serial = serial;
	tracker->stream.send = send_made_sample;
	tracker->stream.tracker = tracker;
	tracker->stream.has_clock = true;
	tracker->stream.tolerance = 1e-4;
	tracker->played = (struct tobii5_played) { .late_answers = 1 };
	memcpy(tracker->played.corner_mm, corner_mm, sizeof tracker->played.corner_mm);
	pthread_mutex_init(&tracker->sending, NULL);
	tracker->in = tracker->out = -1;
	tracker->stop = tracker->subscribed = false;
	mkdir(FOLDER, 0755);
	if (access(CONTROL, F_OK) != 0 && mount("none", FOLDER, "gadgetfs", 0, NULL) != 0)
		fail_msg("mounting GadgetFS: %s", strerror(errno));
	tracker->control = open(CONTROL, O_RDWR | O_NONBLOCK | O_CLOEXEC);
	if (tracker->control < 0)
		fail_msg("%s: %s", CONTROL, strerror(errno));
	tracker->plugged = true;
	describe_tracker(tracker);
	assert_int_equal(pthread_create(&tracker->control_thread, NULL, play_control, tracker), 0);
	assert_int_equal(pthread_create(&tracker->answer_thread, NULL, play_answers, tracker), 0);
}

void tobii5_gadget_unplug(struct tobii5_gadget *tracker)
{
	/* GadgetFS cannot release the device while a thread reads from it or writes to it. */
	const struct timespec pause = { .tv_nsec = 2000000 };
	made_stream_stop(&tracker->stream);
	tracker->stop = true;
	while (pthread_tryjoin_np(tracker->answer_thread, NULL) != 0) {
		pthread_kill(tracker->answer_thread, SIGUSR1);
		nanosleep(&pause, NULL);
	}
	pthread_join(tracker->control_thread, NULL);
	close(tracker->control); /* the host sees the device go */
	if (tracker->in >= 0)
		close(tracker->in);
	if (tracker->out >= 0)
		close(tracker->out);
	tracker->in = tracker->out = -1;
	tracker->plugged = false;
}

void tobii5_gadget_remove(struct tobii5_gadget *tracker)
{
	if (!tracker->plugged)
		return;
	tobii5_gadget_unplug(tracker);
	umount(FOLDER);
	*tracker = (struct tobii5_gadget) { .in = -1, .out = -1 };
}
