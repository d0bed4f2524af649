#include "fake_libusb.h"

#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "suite.h"

/* Most transfers in flight. */
enum { FLIGHTS_MAX = 32, PACKET_MAX = 4096 };

struct libusb_context {
	int nothing;
};

struct libusb_device {
	int index;
};

struct libusb_device_handle {
	struct libusb_device *device;
};

struct completion {
	enum libusb_transfer_status status;
	size_t size;
	unsigned char bytes[PACKET_MAX];
};

struct fake_usb fake_usb;

static struct libusb_device devices[FAKE_USB_DEVICES_MAX];
static struct completion script[FAKE_USB_SCRIPT_MAX];
static int script_first, script_end;
/* Oldest first. */
static struct libusb_transfer *flights[FLIGHTS_MAX];
static bool cancelled[FLIGHTS_MAX];
static int flight_count;

void fake_usb_reset(void)
{
	memset(&fake_usb, 0, sizeof fake_usb);
	script_first = script_end = flight_count = 0;
}

struct fake_usb_device *fake_usb_plug(uint16_t vendor, uint16_t product)
{
	assert_true(fake_usb.device_count < FAKE_USB_DEVICES_MAX);
	struct fake_usb_device *device = &fake_usb.devices[fake_usb.device_count++];
	*device = (struct fake_usb_device) { .vendor = vendor, .product = product };
	return device;
}

static bool is_in(const struct libusb_transfer *transfer)
{
	return transfer->type == LIBUSB_TRANSFER_TYPE_BULK &&
	       (transfer->endpoint & LIBUSB_ENDPOINT_IN) != 0;
}

static struct completion *add(enum libusb_transfer_status status)
{
	if (script_first == script_end)
		script_first = script_end = 0;
	assert_true(script_end < FAKE_USB_SCRIPT_MAX);
	struct completion *completion = &script[script_end++];
	completion->status = status;
	completion->size = 0;
	return completion;
}

void fake_usb_deliver(const unsigned char *bytes, size_t size)
{
	struct completion *completion = add(LIBUSB_TRANSFER_COMPLETED);
	assert_true(size <= sizeof completion->bytes);
	completion->size = size;
	memcpy(completion->bytes, bytes, size);
}

void fake_usb_fail(enum libusb_transfer_status status)
{
	add(status);
}

int libusb_init(libusb_context **context)
{
	if (fake_usb.init_error)
		return fake_usb.init_error;
	*context = calloc(1, sizeof **context);
	fake_usb.contexts++;
	return LIBUSB_SUCCESS;
}

void libusb_exit(libusb_context *context)
{
	fake_usb.contexts--;
	free(context);
}

ssize_t libusb_get_device_list(libusb_context *context, libusb_device ***list)
{
	(void)context;
	*list = calloc(FAKE_USB_DEVICES_MAX + 1, sizeof **list);
	assert_non_null(*list);
	for (int i = 0; i < fake_usb.device_count; i++) {
		devices[i].index = i;
		(*list)[i] = &devices[i];
	}
	return fake_usb.device_count;
}

void libusb_free_device_list(libusb_device **list, int unref_devices)
{
	(void)unref_devices;
	free((void *)list);
}

int libusb_get_device_descriptor(libusb_device *device, struct libusb_device_descriptor *descriptor)
{
	*descriptor = (struct libusb_device_descriptor) {
		.idVendor = fake_usb.devices[device->index].vendor,
		.idProduct = fake_usb.devices[device->index].product,
	};
	return LIBUSB_SUCCESS;
}

/* A bus that no machine has, so that sysfs has no entry for it. */
uint8_t libusb_get_bus_number(libusb_device *device)
{
	(void)device;
	return 250;
}

uint8_t libusb_get_device_address(libusb_device *device)
{
	return (uint8_t)(device->index + 1);
}

int libusb_get_port_numbers(libusb_device *device, uint8_t *ports, int size)
{
	assert_true(size >= 2);
	ports[0] = 3;
	ports[1] = (uint8_t)(device->index + 1);
	return 2;
}

int libusb_open(libusb_device *device, libusb_device_handle **handle)
{
	int error = fake_usb.devices[device->index].open_error;
	if (error)
		return error;
	*handle = calloc(1, sizeof **handle);
	assert_non_null(*handle);
	(*handle)->device = device;
	fake_usb.handles++;
	return LIBUSB_SUCCESS;
}

void libusb_close(libusb_device_handle *handle)
{
	fake_usb.handles--;
	free(handle);
}

int libusb_set_auto_detach_kernel_driver(libusb_device_handle *handle, int enable)
{
	(void)handle;
	(void)enable;
	return LIBUSB_ERROR_NOT_SUPPORTED;
}

int libusb_claim_interface(libusb_device_handle *handle, int number)
{
	(void)number;
	int error = fake_usb.devices[handle->device->index].claim_error;
	fake_usb.claims += error == 0;
	return error;
}

int libusb_release_interface(libusb_device_handle *handle, int number)
{
	(void)handle;
	(void)number;
	fake_usb.claims--;
	return LIBUSB_SUCCESS;
}

int libusb_clear_halt(libusb_device_handle *handle, unsigned char endpoint)
{
	(void)handle;
	(void)endpoint;
	fake_usb.halts_cleared++;
	return fake_usb.unplugged ? LIBUSB_ERROR_NO_DEVICE : fake_usb.clear_error;
}

struct libusb_transfer *libusb_alloc_transfer(int iso_packets)
{
	assert_int_equal(iso_packets, 0);
	fake_usb.transfers++;
	return calloc(1, sizeof(struct libusb_transfer));
}

void libusb_free_transfer(struct libusb_transfer *transfer)
{
	if (!transfer)
		return;
	for (int i = 0; i < flight_count; i++)
		assert_ptr_not_equal(flights[i], transfer);
	fake_usb.transfers--;
	free(transfer);
}

int libusb_submit_transfer(struct libusb_transfer *transfer)
{
	if (fake_usb.unplugged)
		return LIBUSB_ERROR_NO_DEVICE;
	for (int i = 0; i < flight_count; i++)
		assert_ptr_not_equal(flights[i], transfer);
	assert_true(flight_count < FLIGHTS_MAX);
	cancelled[flight_count] = false;
	flights[flight_count++] = transfer;
	if (!is_in(transfer))
		return LIBUSB_SUCCESS;
	fake_usb.submitted++;
	fake_usb.in_flight++;
	if (fake_usb.in_flight > fake_usb.most_in_flight)
		fake_usb.most_in_flight = fake_usb.in_flight;
	return LIBUSB_SUCCESS;
}

int libusb_cancel_transfer(struct libusb_transfer *transfer)
{
	for (int i = 0; i < flight_count; i++) {
		if (flights[i] == transfer) {
			cancelled[i] = true;
			return LIBUSB_SUCCESS;
		}
	}
	return LIBUSB_ERROR_NOT_FOUND;
}

static void count_request(const unsigned char *payload, int size)
{
	assert_int_equal(size, 8);
	assert_int_equal(payload[0], 0x0c);
	fake_usb.switched_on += payload[2] == 1;
	fake_usb.switched_off += payload[2] == 2;
}

/* A request that opens or closes a session. */
static int control_session(uint8_t type, uint8_t request, uint16_t value, uint16_t length)
{
	assert_int_equal(type, 0x41);
	assert_in_range(request, 0x41, 0x42);
	assert_int_equal(value, 0);
	assert_int_equal(length, 0);
	if (fake_usb.unplugged)
		return LIBUSB_ERROR_NO_DEVICE;
	if (fake_usb.control_error)
		return fake_usb.control_error;
	fake_usb.opened += request == 0x41;
	fake_usb.closed += request == 0x42;
	return 0;
}

int libusb_control_transfer(libusb_device_handle *handle, uint8_t type, uint8_t request,
			    uint16_t value, uint16_t index, unsigned char *data, uint16_t length,
			    unsigned timeout_ms)
{
	(void)handle;
	assert_int_equal(type & LIBUSB_ENDPOINT_IN, 0);
	assert_int_equal(index, 0);
	assert_in_range(timeout_ms, 1, 200);
	if (fake_usb.has_sessions)
		return control_session(type, request, value, length);
	assert_int_equal(request, 0x09);
	assert_int_equal(value, 0x0c);
	if (fake_usb.unplugged)
		return LIBUSB_ERROR_NO_DEVICE;
	if (fake_usb.control_error)
		return fake_usb.control_error;
	count_request(data, length);
	return length;
}

/* Complete the transfer at @p index. */
static void complete(int index, enum libusb_transfer_status status, const unsigned char *bytes,
		     size_t size)
{
	struct libusb_transfer *transfer = flights[index];
	flight_count--;
	memmove((void *)(flights + index), (void *)(flights + index + 1),
		sizeof *flights * (size_t)(flight_count - index));
	memmove(cancelled + index, cancelled + index + 1,
		sizeof *cancelled * (size_t)(flight_count - index));
	if (is_in(transfer))
		fake_usb.in_flight--;
	transfer->status = status;
	transfer->actual_length = (int)size;
	if (bytes) {
		assert_true((int)size <= transfer->length);
		memcpy(transfer->buffer, bytes, size);
	}
	transfer->callback(transfer);
}

/* What the device does with the bytes of a transfer to it. */
static enum libusb_transfer_status receive(const struct libusb_transfer *transfer)
{
	unsigned char reply[PACKET_MAX];
	if (transfer->type == LIBUSB_TRANSFER_TYPE_CONTROL) {
		count_request(transfer->buffer + LIBUSB_CONTROL_SETUP_SIZE,
			      transfer->length - LIBUSB_CONTROL_SETUP_SIZE);
		return LIBUSB_TRANSFER_COMPLETED;
	}
	assert_non_null(fake_usb.request);
	if (fake_usb.request_status != LIBUSB_TRANSFER_COMPLETED)
		return fake_usb.request_status;
	size_t size = fake_usb.request(fake_usb.request_user, transfer->buffer,
				       (size_t)transfer->length, reply, sizeof reply);
	if (size > 0)
		fake_usb_deliver(reply, size);
	return LIBUSB_TRANSFER_COMPLETED;
}

/* Complete one transfer that does not wait for the device to send. */
static bool complete_ended(void)
{
	for (int i = 0; i < flight_count; i++) {
		if (!cancelled[i] && !fake_usb.unplugged && is_in(flights[i]))
			continue;
		complete(i,
			 cancelled[i]         ? LIBUSB_TRANSFER_CANCELLED
			 : fake_usb.unplugged ? LIBUSB_TRANSFER_NO_DEVICE
					      : receive(flights[i]),
			 NULL, 0);
		return true;
	}
	return false;
}

static int oldest_bulk(void)
{
	for (int i = 0; i < flight_count; i++)
		if (is_in(flights[i]))
			return i;
	return -1;
}

static bool complete_scripted(void)
{
	int index = oldest_bulk();
	if (index < 0 || script_first == script_end)
		return false;
	const struct completion *completion = &script[script_first++];
	complete(index, completion->status, completion->bytes, completion->size);
	return true;
}

/* Wait for the next packet of a device that sends by itself, or until the time is up. */
static void play(int64_t deadline_ns)
{
	unsigned char bytes[PACKET_MAX];
	int index = oldest_bulk();
	if (!fake_usb.packet || index < 0 || fake_usb.due_ns > deadline_ns) {
		gz_clock_sleep_until_ns(deadline_ns);
		return;
	}
	gz_clock_sleep_until_ns(fake_usb.due_ns);
	fake_usb.due_ns += fake_usb.period_ns;
	size_t size = fake_usb.packet(fake_usb.user, bytes, sizeof bytes);
	if (size > 0)
		complete(index, LIBUSB_TRANSFER_COMPLETED, bytes, size);
}

int libusb_handle_events_timeout_completed(libusb_context *context, struct timeval *timeout,
					   int *completed)
{
	(void)context;
	assert_null(completed);
	int64_t deadline_ns =
		gz_clock_now_ns() + timeout->tv_sec * GZ_NS_PER_S + timeout->tv_usec * GZ_NS_PER_US;
	bool any = false;
	while (complete_ended())
		any = true;
	/* Complete several at once, as the library does. */
	for (int i = 0; i < (fake_usb.at_once ? fake_usb.at_once : 3) && complete_scripted(); i++)
		any = true;
	if (!any)
		play(deadline_ns);
	return LIBUSB_SUCCESS;
}

const char *libusb_error_name(int error)
{
	return error == LIBUSB_ERROR_PIPE ? "LIBUSB_ERROR_PIPE" : "some error";
}
