#include "check.h"

#include "psvr2_gadget.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/usb/ch9.h>
#include <linux/usb/gadgetfs.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"

#define FOLDER   "/dev/gadget"
#define CONTROL  FOLDER "/dummy_udc"
#define ENDPOINT FOLDER "/ep1in-bulk"

enum {
	INTERFACES = 6, /* 0 to 4 have no endpoints, and no use here */
	ENDPOINT_ADDRESS = 0x85,
	STRING_MAKER = 1,
	STRING_NAME = 2,
	STRING_SERIAL = 3,
	REQUEST_SET = 0x09,
	GAZE_STREAM = 0x0C,
	SWITCH_ON = 1,
	SWITCH_OFF = 2,
	CONTROL_MAX = 1024,
};

/* The headset falls silent where it is not told again to send. */
#define ON_NS (2 * GZ_NS_PER_S)

static uint8_t *put(uint8_t *bytes, size_t size, uint64_t value)
{
	for (size_t i = 0; i < size; i++)
		*bytes++ = (uint8_t)(value >> (8 * i));
	return bytes;
}

static uint8_t *append(uint8_t *bytes, const void *more, size_t size)
{
	memcpy(bytes, more, size);
	return bytes + size;
}

/* The endpoint's descriptor, for full (64 bytes a packet) or high speed. */
static uint8_t *append_endpoint(uint8_t *bytes, uint16_t packet_size)
{
	const uint8_t descriptor[] = {
		USB_DT_ENDPOINT_SIZE,
		USB_DT_ENDPOINT,
		ENDPOINT_ADDRESS,
		USB_ENDPOINT_XFER_BULK,
		(uint8_t)packet_size,
		(uint8_t)(packet_size >> 8),
		0,
	};
	return append(bytes, descriptor, sizeof descriptor);
}

static uint8_t *append_configuration(uint8_t *bytes, uint16_t packet_size)
{
	uint16_t total =
		USB_DT_CONFIG_SIZE + INTERFACES * USB_DT_INTERFACE_SIZE + USB_DT_ENDPOINT_SIZE;
	const uint8_t head[USB_DT_CONFIG_SIZE] = {
		USB_DT_CONFIG_SIZE,
		USB_DT_CONFIG,
		(uint8_t)total,
		(uint8_t)(total >> 8),
		INTERFACES,
		1,
		0,
		USB_CONFIG_ATT_ONE | USB_CONFIG_ATT_SELFPOWER,
		50,
	};
	bytes = append(bytes, head, sizeof head);
	for (uint8_t number = 0; number < INTERFACES; number++) {
		const uint8_t interface[USB_DT_INTERFACE_SIZE] = {
			USB_DT_INTERFACE_SIZE,
			USB_DT_INTERFACE,
			number,
			0,
			number == INTERFACES - 1,
			USB_CLASS_VENDOR_SPEC,
			0,
			0,
			0,
		};
		bytes = append(bytes, interface, sizeof interface);
	}
	return append_endpoint(bytes, packet_size);
}

/* What GadgetFS wants first: configurations of both speeds, and the device. */
static void describe(struct psvr2_gadget *headset)
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
		0x4C,
		0x05,
		0xDE,
		0x0C,
		0x00,
		0x01,
		STRING_MAKER,
		STRING_NAME,
		STRING_SERIAL,
		1,
	};
	uint8_t bytes[512];
	uint8_t *end = put(bytes, 4, 0);
	end = append_configuration(end, 64);
	end = append_configuration(end, 512);
	end = append(end, device, sizeof device);
	if (write(headset->control, bytes, (size_t)(end - bytes)) != end - bytes)
		fail_msg("GadgetFS refuses the descriptors: %s", strerror(errno));
}

/* The host has chosen the configuration: the endpoint may be used. */
static void open_endpoint(struct psvr2_gadget *headset)
{
	uint8_t bytes[4 + 2 * USB_DT_ENDPOINT_SIZE];
	put(bytes, 4, 1);
	append_endpoint(append_endpoint(bytes + 4, 64), 512);
	int fd = open(ENDPOINT, O_RDWR | O_CLOEXEC);
	if (fd < 0 || write(fd, bytes, sizeof bytes) != sizeof bytes)
		headset->error = errno;
	headset->endpoint = fd;
}

static void note_request(struct psvr2_gadget *headset, const struct usb_ctrlrequest *request,
			 const uint8_t *bytes, ssize_t size)
{
	static const uint8_t switch_on[8] = { GAZE_STREAM, 0, SWITCH_ON };
	static const uint8_t switch_off[8] = { GAZE_STREAM, 0, SWITCH_OFF };
	bool ours = request->bRequest == REQUEST_SET && request->wValue == GAZE_STREAM && size == 8;
	if (ours && memcmp(bytes, switch_on, 8) == 0) {
		int64_t now_ns = gz_clock_now_ns();
		if (headset->on_ns && now_ns - headset->on_ns > headset->longest_ns)
			headset->longest_ns = now_ns - headset->on_ns;
		headset->on_ns = now_ns;
		headset->on++;
	} else if (ours && memcmp(bytes, switch_off, 8) == 0) {
		headset->on_ns = 0;
		headset->off++;
	} else {
		headset->unknown++;
	}
}

static ssize_t string_descriptor(const struct psvr2_gadget *headset, uint8_t number, uint8_t *bytes)
{
	const char *const texts[] = { "", "Sony Corp.", "PlayStation VR2", headset->serial };
	if (number == 0) { /* the languages: English */
		put(bytes, 4, 0x04090304);
		return 4;
	}
	if (number > STRING_SERIAL)
		return -1;
	uint8_t *end = bytes + 2;
	for (const char *text = texts[number]; *text; text++)
		end = put(end, 2, (uint8_t)*text);
	bytes[0] = (uint8_t)(end - bytes);
	bytes[1] = USB_DT_STRING;
	return end - bytes;
}

static void answer_in(struct psvr2_gadget *headset, const struct usb_ctrlrequest *request)
{
	uint8_t bytes[CONTROL_MAX] = { 0 };
	ssize_t size = -1;
	if (request->bRequest == USB_REQ_GET_DESCRIPTOR && request->wValue >> 8 == USB_DT_STRING)
		size = string_descriptor(headset, (uint8_t)request->wValue, bytes);
	if (size < 0) /* the wrong way stalls */
		size = read(headset->control, bytes, 0);
	else
		size = write(headset->control, bytes,
			     size < request->wLength ? (size_t)size : request->wLength);
}

/* The data may still be on their way. */
static ssize_t read_data(struct psvr2_gadget *headset, uint8_t *bytes, size_t wanted)
{
	const struct timespec pause = { .tv_nsec = 200000 };
	ssize_t size;
	while ((size = read(headset->control, bytes, wanted)) < 0 && errno == EAGAIN &&
	       !headset->stop)
		nanosleep(&pause, NULL);
	return size;
}

static void answer_out(struct psvr2_gadget *headset, const struct usb_ctrlrequest *request)
{
	uint8_t bytes[CONTROL_MAX] = { 0 };
	size_t wanted = request->wLength < sizeof bytes ? request->wLength : sizeof bytes;
	bool vendors = (request->bRequestType & USB_TYPE_MASK) == USB_TYPE_VENDOR;
	if (!vendors && request->bRequest == USB_REQ_SET_CONFIGURATION && headset->endpoint < 0)
		open_endpoint(headset);
	ssize_t size = read_data(headset, bytes, wanted);
	if (vendors)
		note_request(headset, request, bytes, size);
}

static void take_event(struct psvr2_gadget *headset, const struct usb_gadgetfs_event *event)
{
	if (event->type != GADGETFS_SETUP)
		return;
	if (event->u.setup.bRequestType & USB_DIR_IN)
		answer_in(headset, &event->u.setup);
	else
		answer_out(headset, &event->u.setup);
}

static void *play(void *argument)
{
	struct psvr2_gadget *headset = argument;
	struct pollfd ready = { .fd = headset->control, .events = POLLIN };
	while (!headset->stop) {
		struct usb_gadgetfs_event event;
		if (poll(&ready, 1, 20) > 0 &&
		    read(headset->control, &event, sizeof event) == sizeof event)
			take_event(headset, &event);
	}
	return NULL;
}

static uint8_t *put_float(uint8_t *bytes, double value)
{
	float number = (float)value;
	uint32_t bits;
	memcpy(&bits, &number, sizeof bits);
	return put(bytes, 4, bits);
}

static uint8_t *put_vector(uint8_t *bytes, const double vector[3])
{
	for (size_t i = 0; i < 3; i++)
		bytes = put_float(bytes, vector[i]);
	return bytes;
}

/* A known origin, and the direction from there to the sample's point on the screen: +x is to the
 * wearer's left, +y up, +z ahead. */
static void put_ray(uint8_t *bytes, const struct made_sample *sample, double left_mm, bool known)
{
	const double origin[3] = { left_mm, 0, 0 };
	double direction[3] = {
		(0.5 - sample->x) * MADE_WIDTH_MM - left_mm,
		(0.5 - sample->y) * MADE_HEIGHT_MM,
		PSVR2_DISTANCE_MM,
	};
	double length = sqrt(direction[0] * direction[0] + direction[1] * direction[1] +
			     direction[2] * direction[2]);
	for (size_t i = 0; i < 3; i++)
		direction[i] /= length;
	bytes = put(bytes, 4, known);
	bytes = put_vector(bytes, origin);
	bytes = put(bytes, 4, known);
	put_vector(bytes, direction);
}

void psvr2_gadget_encode(const struct psvr2_gadget *headset, const struct made_sample *sample,
			 uint8_t packet[PSVR2_PACKET_SIZE])
{
	const struct {
		size_t offset;
		double left_mm, pupil_mm;
	} eyes[2] = { { 0x5C, 31.5, 3.25 }, { 0xA4, -31.5, 3.5 } };
	bool open = !headset->blinking;
	memset(packet, 0, PSVR2_PACKET_SIZE);
	memcpy(packet, "GS", 2);
	put(packet + 2, 2, 1);
	put(packet + 4, 4, PSVR2_PACKET_SIZE);
	put(packet + 0x50, 8, (uint64_t)sample->device_us);
	put(packet + 0x58, 4, sample->number);
	for (size_t i = 0; i < 2; i++) {
		uint8_t *eye = packet + eyes[i].offset;
		put_ray(eye, sample, eyes[i].left_mm, open);
		put_float(put(eye + 0x20, 4, open), eyes[i].pupil_mm);
		put(put(eye + 0x40, 4, 1), 4, !open);
	}
	put_ray(packet + 0xEC, sample, 0, open);
	put_float(packet + 0x144, PSVR2_DISTANCE_MM);
}

bool psvr2_gadget_send(struct psvr2_gadget *headset, const void *packet, size_t size)
{
	int fd = headset->endpoint;
	return fd >= 0 && write(fd, packet, size) == (ssize_t)size;
}

static void send_sample(void *argument, const struct made_sample *sample)
{
	struct psvr2_gadget *headset = argument;
	uint8_t packet[PSVR2_PACKET_SIZE];
	int64_t on_ns = headset->on_ns;
	if (on_ns == 0 || gz_clock_now_ns() - on_ns > ON_NS)
		return;
	psvr2_gadget_encode(headset, sample, packet);
	psvr2_gadget_send(headset, packet, sizeof packet);
}

void psvr2_gadget_plug(struct psvr2_gadget *headset, const char *serial)
{
	headset->serial = serial;
	headset->stream.send = send_sample;
	headset->stream.tracker = headset;
	headset->endpoint = -1;
	headset->stop = false;
	headset->on_ns = 0;
	mkdir(FOLDER, 0755);
	if (access(CONTROL, F_OK) != 0 && mount("none", FOLDER, "gadgetfs", 0, NULL) != 0)
		fail_msg("mounting GadgetFS: %s", strerror(errno));
	headset->control = open(CONTROL, O_RDWR | O_NONBLOCK | O_CLOEXEC);
	if (headset->control < 0)
		fail_msg("%s: %s", CONTROL, strerror(errno));
	headset->plugged = true;
	describe(headset);
	assert_int_equal(pthread_create(&headset->thread, NULL, play, headset), 0);
}

void psvr2_gadget_unplug(struct psvr2_gadget *headset)
{
	/* GadgetFS cannot let the device go while somebody writes to it. */
	made_stream_stop(&headset->stream);
	headset->stop = true;
	pthread_join(headset->thread, NULL);
	close(headset->control); /* the host sees it go here */
	if (headset->endpoint >= 0)
		close(headset->endpoint);
	headset->endpoint = -1;
	headset->plugged = false;
}

void psvr2_gadget_stall(struct psvr2_gadget *headset)
{
	uint8_t byte;
	/* Reading from an endpoint that sends stalls it, and says so by this error. */
	assert_int_equal(read(headset->endpoint, &byte, 1), -1);
	assert_int_equal(errno, EBADMSG);
}

void psvr2_gadget_remove(struct psvr2_gadget *headset)
{
	if (headset->plugged)
		psvr2_gadget_unplug(headset);
	umount(FOLDER);
	*headset = (struct psvr2_gadget) { .endpoint = -1 };
}
