#include "suite.h"

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
#include "drivers/frame_bytes.h"
#include "gadget.h"

#define FOLDER   "/dev/gadget"
#define CONTROL  FOLDER "/dummy_udc"
#define ENDPOINT FOLDER "/ep1in-bulk"

enum {
	INTERFACES = 6, /* 0 to 4 have no endpoints and are not used here */
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

/* The headset stops sending if the request is not repeated. */
#define ON_NS (2 * GZ_NS_PER_S)

static uint8_t *append(uint8_t *bytes, const void *more, size_t size)
{
	memcpy(bytes, more, size);
	return bytes + size;
}

/* The descriptor of the endpoint, for full (64 bytes a packet) or high speed. */
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

/* Write what GadgetFS expects first: configurations for both speeds, and the device. */
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
	uint8_t *end = frame_put(bytes, 4, 0);
	end = append_configuration(end, 64);
	end = append_configuration(end, 512);
	end = append(end, device, sizeof device);
	if (write(headset->control, bytes, (size_t)(end - bytes)) != end - bytes)
		fail_msg("GadgetFS refuses the descriptors: %s", strerror(errno));
}

/* The host has chosen the configuration: open the endpoint. */
static void open_endpoint(struct psvr2_gadget *headset)
{
	uint8_t bytes[4 + 2 * USB_DT_ENDPOINT_SIZE];
	frame_put(bytes, 4, 1);
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

static void answer_in(struct psvr2_gadget *headset, const struct usb_ctrlrequest *request)
{
	uint8_t bytes[CONTROL_MAX] = { 0 };
	ssize_t size = -1;
	if (request->bRequest == USB_REQ_GET_DESCRIPTOR && request->wValue >> 8 == USB_DT_STRING)
		size = string_descriptor(headset, (uint8_t)request->wValue, bytes);
	if (size < 0) /* a transfer in the wrong direction stalls */
		size = read(headset->control, bytes, 0);
	else
		size = write(headset->control, bytes,
			     size < request->wLength ? (size_t)size : request->wLength);
}

/* The data may not have arrived yet. */
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

/* The ray from an eye to the point of the sample on the screen: +x right, +y down, +z ahead. */
static struct gz_psvr2_ray ray_to(const struct made_sample *sample, double right_mm, bool known)
{
	double direction[3] = {
		(sample->x - 0.5) * MADE_WIDTH_MM - right_mm,
		(sample->y - 0.5) * MADE_HEIGHT_MM,
		PSVR2_DISTANCE_MM,
	};
	double length = sqrt(direction[0] * direction[0] + direction[1] * direction[1] +
			     direction[2] * direction[2]);
	struct gz_psvr2_ray ray = { known, known, { (float)right_mm, 0, 0 }, { 0 } };
	for (size_t i = 0; i < 3; i++)
		ray.direction[i] = (float)(direction[i] / length);
	return ray;
}

void psvr2_gadget_encode(const struct psvr2_gadget *headset, const struct made_sample *sample,
			 uint8_t packet[GZ_PSVR2_PACKET_SIZE])
{
	bool open = !headset->blinking;
	const struct gz_psvr2_packet laid_out = {
		.device_ns = sample->device_us * GZ_NS_PER_US,
		.frame = (uint32_t)sample->number,
		.eye = {
			[GZ_EYE_LEFT] = { ray_to(sample, -31.5, open), open, 3.25f, !open },
			[GZ_EYE_RIGHT] = { ray_to(sample, 31.5, open), open, 3.5f, !open },
		},
		.combined = ray_to(sample, 0, open),
		.has_convergence = true,
		.convergence_mm = (float)PSVR2_DISTANCE_MM,
	};
	psvr2_made_packet(&laid_out, packet);
}

bool psvr2_gadget_send(struct psvr2_gadget *headset, const void *packet, size_t size)
{
	int fd = headset->endpoint;
	return fd >= 0 && write(fd, packet, size) == (ssize_t)size;
}

static void send_sample(void *argument, const struct made_sample *sample)
{
	struct psvr2_gadget *headset = argument;
	uint8_t packet[GZ_PSVR2_PACKET_SIZE];
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
	headset->stream.has_clock = true;
	headset->stream.tolerance = 1e-4;
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
	/* GadgetFS cannot release the device while a thread writes to it. */
	made_stream_stop(&headset->stream);
	headset->stop = true;
	pthread_join(headset->thread, NULL);
	close(headset->control); /* the host sees the device go */
	if (headset->endpoint >= 0)
		close(headset->endpoint);
	headset->endpoint = -1;
	headset->plugged = false;
}

void psvr2_gadget_stall(struct psvr2_gadget *headset)
{
	gadget_stall(headset->endpoint);
}

void psvr2_gadget_remove(struct psvr2_gadget *headset)
{
	if (headset->plugged)
		psvr2_gadget_unplug(headset);
	umount(FOLDER);
	*headset = (struct psvr2_gadget) { .endpoint = -1 };
}
