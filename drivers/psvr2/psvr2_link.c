#include "drivers/psvr2/psvr2_link.h"

#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "drivers/usb/usb_device.h"
#include "drivers/usb/usb_stream.h"

#define GZ_LOG_MODULE "psvr2"

/* Monado sends its requests to the default endpoint. */
#define REQUEST_TYPE \
	((uint8_t)(LIBUSB_REQUEST_TYPE_VENDOR | LIBUSB_RECIPIENT_ENDPOINT | LIBUSB_ENDPOINT_OUT))

/* Longest wait for the answer to a request, ms: at the start, when the request is repeated, and at
 * the end. */
enum { START_TIMEOUT_MS = 150, KEEPALIVE_TIMEOUT_MS = 500, STOP_TIMEOUT_MS = 200 };

/* Pause between two warnings about rejected requests, which are sent once a second. */
static const int64_t REQUEST_COMPLAINT_NS = 10 * GZ_NS_PER_S;

struct gz_psvr2_link {
	libusb_device_handle *handle;
	const struct gz_log *log;
	struct gz_usb_stream *stream;
	struct libusb_transfer *request; /* the repeated request "on" */
	bool request_in_flight;
	unsigned char request_bytes[LIBUSB_CONTROL_SETUP_SIZE + GZ_PSVR2_REQUEST_SIZE];
	int64_t request_ns; /* host time at which it is due */
	bool stopping;
	struct gz_psvr2_arrival queue[GZ_PSVR2_QUEUE];
	unsigned first, count; /* of the queue */
	uint64_t malformed[GZ_MALFORMED_COUNT];
	struct gz_ratelimit complaints, request_complaints;
};

static void count_psvr2_malformed(struct gz_psvr2_link *link, enum gz_malformed reason, int size)
{
	link->malformed[reason]++;
	gz_warn_limited(link->log, &link->complaints,
			"device bug: %d bytes are not a gaze packet: %s", size,
			gz_malformed_name(reason));
}

static void enqueue_psvr2_packet(struct gz_psvr2_link *link, const struct gz_psvr2_packet *packet)
{
	if (link->count == GZ_PSVR2_QUEUE) {
		link->first = (link->first + 1) % GZ_PSVR2_QUEUE;
		link->count--;
	}
	struct gz_psvr2_arrival *arrival =
		&link->queue[(link->first + link->count++) % GZ_PSVR2_QUEUE];
	arrival->arrival_ns = gz_clock_now_ns();
	arrival->packet = *packet;
}

static void take_psvr2_bytes(void *user, const unsigned char *bytes, int size)
{
	struct gz_psvr2_link *link = user;
	struct gz_psvr2_packet packet;
	enum gz_malformed reason;
	/* A packet that fills its last USB packet is followed by an empty one. */
	if (size == 0)
		return;
	if (gz_psvr2_parse(bytes, (size_t)size, &packet, &reason) != GZ_OK) {
		count_psvr2_malformed(link, reason, size);
		return;
	}
	gz_usb_stream_confirm(link->stream);
	enqueue_psvr2_packet(link, &packet);
}

static void count_long_psvr2_transfer(void *user)
{
	count_psvr2_malformed(user, GZ_MALFORMED_LONG, GZ_PSVR2_TRANSFER_SIZE);
}

/* The headset may have stopped its stream: request it at once. */
static void request_psvr2_stream_again(void *user)
{
	struct gz_psvr2_link *link = user;
	link->request_ns = gz_clock_now_ns();
}

static void LIBUSB_CALL on_psvr2_request(struct libusb_transfer *transfer)
{
	struct gz_psvr2_link *link = transfer->user_data;
	uint64_t held_back;
	link->request_in_flight = false;
	if (transfer->status == LIBUSB_TRANSFER_NO_DEVICE)
		gz_usb_stream_lose(link->stream);
	else if (transfer->status != LIBUSB_TRANSFER_COMPLETED && !link->stopping &&
		 gz_ratelimit_pass(&link->request_complaints, gz_clock_now_ns(),
				   REQUEST_COMPLAINT_NS, &held_back))
		gz_warn(link->log,
			"the headset rejects the request to keep the stream on (USB transfer "
			"status %d)",
			(int)transfer->status);
}

static void repeat_stream_request(struct gz_psvr2_link *link, int64_t now_ns)
{
	if (link->request_in_flight || now_ns < link->request_ns)
		return;
	link->request_ns = now_ns + GZ_PSVR2_KEEPALIVE_MS * GZ_NS_PER_MS;
	int error = libusb_submit_transfer(link->request);
	if (error == LIBUSB_SUCCESS)
		link->request_in_flight = true;
	else if (error == LIBUSB_ERROR_NO_DEVICE)
		gz_usb_stream_lose(link->stream);
}

static bool dequeue_psvr2_packet(struct gz_psvr2_link *link, struct gz_psvr2_arrival *out_arrival)
{
	if (link->count == 0)
		return false;
	*out_arrival = link->queue[link->first];
	link->first = (link->first + 1) % GZ_PSVR2_QUEUE;
	link->count--;
	return true;
}

enum gz_result gz_psvr2_link_next(struct gz_psvr2_link *link, int64_t deadline_ns,
				  struct gz_psvr2_arrival *out_arrival)
{
	int64_t now_ns = gz_clock_now_ns();
	do {
		if (dequeue_psvr2_packet(link, out_arrival))
			return GZ_OK;
		if (!gz_usb_stream_is_gone(link->stream))
			repeat_stream_request(link, now_ns);
		if (gz_usb_stream_is_gone(link->stream))
			return GZ_ERR_NO_DEVICE;
		bool is_due_first = !link->request_in_flight && link->request_ns < deadline_ns;
		gz_usb_stream_handle(link->stream, is_due_first ? link->request_ns : deadline_ns);
		now_ns = gz_clock_now_ns();
	} while (now_ns < deadline_ns);
	if (dequeue_psvr2_packet(link, out_arrival))
		return GZ_OK;
	return gz_usb_stream_is_gone(link->stream) ? GZ_ERR_NO_DEVICE : GZ_ERR_TIMEOUT;
}

const uint64_t *gz_psvr2_link_malformed(const struct gz_psvr2_link *link)
{
	return link->malformed;
}

static enum gz_result allocate_psvr2_request(struct gz_psvr2_link *link)
{
	link->request = libusb_alloc_transfer(0);
	if (!link->request)
		return GZ_ERR_NO_MEM;
	libusb_fill_control_setup(link->request_bytes, REQUEST_TYPE, GZ_PSVR2_SET_REPORT,
				  GZ_PSVR2_GAZE_STREAM, 0, GZ_PSVR2_REQUEST_SIZE);
	gz_psvr2_print_request(true, link->request_bytes + LIBUSB_CONTROL_SETUP_SIZE);
	libusb_fill_control_transfer(link->request, link->handle, link->request_bytes,
				     on_psvr2_request, link, KEEPALIVE_TIMEOUT_MS);
	return GZ_OK;
}

enum gz_result gz_psvr2_link_create(libusb_context *context, libusb_device_handle *handle,
				    const struct gz_log *log, struct gz_psvr2_link **out_link)
{
	struct gz_psvr2_link *link = calloc(1, sizeof *link);
	if (!link)
		return GZ_ERR_NO_MEM;
	link->handle = handle;
	link->log = log;
	link->stopping = true; /* nothing to switch off yet */
	enum gz_result result = gz_usb_stream_create(
		&(struct gz_usb_stream_params) { .context = context,
						 .handle = handle,
						 .log = log,
						 .endpoint = GZ_PSVR2_ENDPOINT,
						 .transfers = GZ_PSVR2_TRANSFERS,
						 .transfer_size = GZ_PSVR2_TRANSFER_SIZE,
						 .take = take_psvr2_bytes,
						 .take_too_long = count_long_psvr2_transfer,
						 .restarted = request_psvr2_stream_again,
						 .user = link },
		&link->stream);
	if (result == GZ_OK)
		result = allocate_psvr2_request(link);
	if (result != GZ_OK) {
		gz_psvr2_link_destroy(&link);
		return result;
	}
	*out_link = link;
	return GZ_OK;
}

static int switch_psvr2_stream(struct gz_psvr2_link *link, bool on, unsigned timeout_ms)
{
	unsigned char bytes[GZ_PSVR2_REQUEST_SIZE];
	gz_psvr2_print_request(on, bytes);
	return libusb_control_transfer(link->handle, REQUEST_TYPE, GZ_PSVR2_SET_REPORT,
				       GZ_PSVR2_GAZE_STREAM, 0, bytes, sizeof bytes, timeout_ms);
}

enum gz_result gz_psvr2_link_start(struct gz_psvr2_link *link)
{
	link->stopping = false;
	gz_usb_stream_submit(link->stream);
	link->request_ns = gz_clock_now_ns() + GZ_PSVR2_KEEPALIVE_MS * GZ_NS_PER_MS;
	int sent = switch_psvr2_stream(link, true, START_TIMEOUT_MS);
	bool gone = gz_usb_stream_is_gone(link->stream);
	if (sent >= 0 && !gone)
		return GZ_OK;
	gz_err(link->log, "the headset cannot switch its eye tracker on: %s; plug it in again",
	       gone ? "it is gone" : libusb_error_name(sent));
	return gone ? GZ_ERR_NO_DEVICE : gz_usb_result(sent);
}

static bool is_psvr2_request_in_flight(const void *user)
{
	return ((const struct gz_psvr2_link *)user)->request_in_flight;
}

/* Stop the stream. @return whether no transfer is in flight any more */
static bool stop_psvr2_stream(struct gz_psvr2_link *link)
{
	if (!link->stream)
		return true;
	if (!gz_usb_stream_is_gone(link->stream) && !link->stopping)
		switch_psvr2_stream(link, false, STOP_TIMEOUT_MS);
	link->stopping = true;
	if (link->request_in_flight)
		libusb_cancel_transfer(link->request);
	return gz_usb_stream_stop(link->stream, is_psvr2_request_in_flight);
}

void gz_psvr2_link_destroy(struct gz_psvr2_link **link)
{
	if (!link || !*link)
		return;
	struct gz_psvr2_link *l = *link;
	*link = NULL;
	if (!stop_psvr2_stream(l))
		return;
	gz_usb_stream_destroy(&l->stream);
	libusb_free_transfer(l->request);
	free(l);
}
