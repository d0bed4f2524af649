#include "drivers/psvr2/psvr2_link.h"

#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "drivers/usb/usb_device.h"

#define GZ_LOG_MODULE "psvr2"

/* Monado sends its requests to the default endpoint. */
#define REQUEST_TYPE \
	((uint8_t)(LIBUSB_REQUEST_TYPE_VENDOR | LIBUSB_RECIPIENT_ENDPOINT | LIBUSB_ENDPOINT_OUT))

/* Longest wait for the answer to a request, ms: at the start, when the request is repeated, and at
 * the end. */
enum { START_TIMEOUT_MS = 150, KEEPALIVE_TIMEOUT_MS = 500, STOP_TIMEOUT_MS = 200 };

/* How long transfers may take to return at the end, ns. */
static const int64_t STOP_PATIENCE_NS = GZ_NS_PER_S;

/* Pause between two warnings about rejected requests, which are sent once a second. */
static const int64_t REQUEST_COMPLAINT_NS = 10 * GZ_NS_PER_S;

struct slot {
	struct gz_psvr2_link *link;
	struct libusb_transfer *transfer;
	bool in_flight;
	unsigned char bytes[GZ_PSVR2_TRANSFER_SIZE];
};

struct gz_psvr2_link {
	libusb_context *context;
	libusb_device_handle *handle;
	const struct gz_log *log;
	struct slot slots[GZ_PSVR2_TRANSFERS];
	struct libusb_transfer *request; /* the repeated request "on" */
	bool request_in_flight;
	unsigned char request_bytes[LIBUSB_CONTROL_SETUP_SIZE + GZ_PSVR2_REQUEST_SIZE];
	int64_t request_ns; /* host time at which it is due */
	int in_flight;      /* transfers of the slots */
	bool gone;
	bool stopping;
	bool recovering; /* no transfer is submitted until recovery_ns */
	int64_t recovery_ns;
	int recoveries; /* attempts without a packet in between */
	struct gz_psvr2_arrival queue[GZ_PSVR2_QUEUE];
	unsigned first, count; /* of the queue */
	uint64_t malformed[GZ_MALFORMED_COUNT];
	struct gz_ratelimit complaints, request_complaints;
};

static void lose_psvr2(struct gz_psvr2_link *link)
{
	link->gone = true;
}

static void cancel_psvr2_transfers(struct gz_psvr2_link *link)
{
	for (int i = 0; i < GZ_PSVR2_TRANSFERS; i++)
		if (link->slots[i].in_flight)
			libusb_cancel_transfer(link->slots[i].transfer);
}

/* A halted endpoint must be cleared before it is used again, and may be cleared only while no
 * transfer is in flight. */
static void begin_endpoint_recovery(struct gz_psvr2_link *link, const char *what)
{
	if (link->recovering || link->gone || link->stopping)
		return;
	if (link->recoveries == GZ_PSVR2_RECOVERIES) {
		gz_err(link->log,
		       "device bug: endpoint 0x%02x %s again after %d resets; unplug the headset "
		       "and plug it in again if it does not return",
		       GZ_PSVR2_ENDPOINT, what, link->recoveries);
		lose_psvr2(link);
		return;
	}
	if (link->recoveries == 0)
		gz_warn(link->log, "endpoint 0x%02x %s; resetting it", GZ_PSVR2_ENDPOINT, what);
	link->recovering = true;
	link->recovery_ns = gz_clock_now_ns() + (GZ_PSVR2_RECOVERY_MS * GZ_NS_PER_MS) *
							(INT64_C(1) << link->recoveries);
	link->recoveries++;
	cancel_psvr2_transfers(link);
}

static void submit_slot(struct slot *slot)
{
	struct gz_psvr2_link *link = slot->link;
	if (link->gone || link->stopping || link->recovering)
		return;
	int error = libusb_submit_transfer(slot->transfer);
	if (error == LIBUSB_SUCCESS) {
		slot->in_flight = true;
		link->in_flight++;
	} else if (error == LIBUSB_ERROR_NO_DEVICE) {
		lose_psvr2(link);
	} else {
		begin_endpoint_recovery(link, libusb_error_name(error));
	}
}

static void submit_all_slots(struct gz_psvr2_link *link)
{
	for (int i = 0; i < GZ_PSVR2_TRANSFERS; i++)
		submit_slot(&link->slots[i]);
}

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

static void take_psvr2_bytes(struct gz_psvr2_link *link, const unsigned char *bytes, int size)
{
	struct gz_psvr2_packet packet;
	enum gz_malformed reason;
	/* A packet that fills its last USB packet is followed by an empty one. */
	if (size == 0)
		return;
	if (gz_psvr2_parse(bytes, (size_t)size, &packet, &reason) != GZ_OK) {
		count_psvr2_malformed(link, reason, size);
		return;
	}
	link->recoveries = 0;
	enqueue_psvr2_packet(link, &packet);
}

static void LIBUSB_CALL on_psvr2_packet(struct libusb_transfer *transfer)
{
	struct slot *slot = transfer->user_data;
	struct gz_psvr2_link *link = slot->link;
	slot->in_flight = false;
	link->in_flight--;
	switch (transfer->status) {
	case LIBUSB_TRANSFER_COMPLETED:
		take_psvr2_bytes(link, transfer->buffer, transfer->actual_length);
		break;
	case LIBUSB_TRANSFER_OVERFLOW:
		count_psvr2_malformed(link, GZ_MALFORMED_LONG, transfer->length);
		break;
	case LIBUSB_TRANSFER_CANCELLED:
		return;
	case LIBUSB_TRANSFER_NO_DEVICE:
		lose_psvr2(link);
		return;
	case LIBUSB_TRANSFER_STALL:
		begin_endpoint_recovery(link, "is stalled");
		return;
	default: /* LIBUSB_TRANSFER_ERROR, LIBUSB_TRANSFER_TIMED_OUT */
		begin_endpoint_recovery(link, "fails");
		return;
	}
	submit_slot(slot);
}

static void LIBUSB_CALL on_psvr2_request(struct libusb_transfer *transfer)
{
	struct gz_psvr2_link *link = transfer->user_data;
	uint64_t held_back;
	link->request_in_flight = false;
	if (transfer->status == LIBUSB_TRANSFER_NO_DEVICE)
		lose_psvr2(link);
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
		lose_psvr2(link);
}

static void recover_endpoint(struct gz_psvr2_link *link, int64_t now_ns)
{
	if (!link->recovering || link->in_flight > 0 || now_ns < link->recovery_ns)
		return;
	link->recovering = false;
	int error = libusb_clear_halt(link->handle, GZ_PSVR2_ENDPOINT);
	if (error == LIBUSB_ERROR_NO_DEVICE) {
		lose_psvr2(link);
		return;
	}
	if (error != LIBUSB_SUCCESS)
		gz_debug(link->log, "resetting the endpoint: %s", libusb_error_name(error));
	/* The device may have stopped its stream. */
	link->request_ns = now_ns;
	submit_all_slots(link);
}

/* Let libusb call back until the deadline. */
static enum gz_result handle_usb_events(struct gz_psvr2_link *link, int64_t deadline_ns)
{
	int64_t left_ns = deadline_ns - gz_clock_now_ns();
	if (left_ns < 0)
		left_ns = 0;
	struct timeval timeout = { .tv_sec = (time_t)(left_ns / GZ_NS_PER_S),
				   .tv_usec = (suseconds_t)(left_ns % GZ_NS_PER_S / GZ_NS_PER_US) };
	int error = libusb_handle_events_timeout_completed(link->context, &timeout, NULL);
	if (error == LIBUSB_SUCCESS || error == LIBUSB_ERROR_INTERRUPTED ||
	    error == LIBUSB_ERROR_TIMEOUT)
		return GZ_OK;
	gz_err(link->log, "USB: %s", libusb_error_name(error));
	lose_psvr2(link);
	return GZ_ERR_NO_DEVICE;
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

/* When something is due even if nothing arrives, host time. */
static int64_t next_psvr2_duty_ns(const struct gz_psvr2_link *link, int64_t deadline_ns)
{
	int64_t due_ns = deadline_ns;
	if (link->recovering && link->in_flight == 0 && link->recovery_ns < due_ns)
		due_ns = link->recovery_ns;
	if (!link->request_in_flight && link->request_ns < due_ns)
		due_ns = link->request_ns;
	return due_ns;
}

enum gz_result gz_psvr2_link_next(struct gz_psvr2_link *link, int64_t deadline_ns,
				  struct gz_psvr2_arrival *out_arrival)
{
	int64_t now_ns = gz_clock_now_ns();
	do {
		if (dequeue_psvr2_packet(link, out_arrival))
			return GZ_OK;
		if (!link->gone) {
			repeat_stream_request(link, now_ns);
			recover_endpoint(link, now_ns);
		}
		if (link->gone)
			return GZ_ERR_NO_DEVICE;
		handle_usb_events(link, next_psvr2_duty_ns(link, deadline_ns));
		now_ns = gz_clock_now_ns();
	} while (now_ns < deadline_ns);
	if (dequeue_psvr2_packet(link, out_arrival))
		return GZ_OK;
	return link->gone ? GZ_ERR_NO_DEVICE : GZ_ERR_TIMEOUT;
}

const uint64_t *gz_psvr2_link_malformed(const struct gz_psvr2_link *link)
{
	return link->malformed;
}

static enum gz_result allocate_psvr2_transfers(struct gz_psvr2_link *link)
{
	for (int i = 0; i < GZ_PSVR2_TRANSFERS; i++) {
		struct slot *slot = &link->slots[i];
		slot->link = link;
		slot->transfer = libusb_alloc_transfer(0);
		if (!slot->transfer)
			return GZ_ERR_NO_MEM;
		libusb_fill_bulk_transfer(slot->transfer, link->handle, GZ_PSVR2_ENDPOINT,
					  slot->bytes, sizeof slot->bytes, on_psvr2_packet, slot,
					  0);
	}
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
	link->context = context;
	link->handle = handle;
	link->log = log;
	link->stopping = true; /* nothing to switch off yet */
	enum gz_result result = allocate_psvr2_transfers(link);
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
	submit_all_slots(link);
	link->request_ns = gz_clock_now_ns() + GZ_PSVR2_KEEPALIVE_MS * GZ_NS_PER_MS;
	int sent = switch_psvr2_stream(link, true, START_TIMEOUT_MS);
	if (sent >= 0 && !link->gone)
		return GZ_OK;
	enum gz_result result = link->gone ? GZ_ERR_NO_DEVICE : gz_usb_result(sent);
	gz_err(link->log, "the headset cannot switch its eye tracker on: %s; plug it in again",
	       link->gone ? "it is gone" : libusb_error_name(sent));
	return result;
}

/* Stop the stream. @return whether no transfer is in flight any more */
static bool stop_psvr2_stream(struct gz_psvr2_link *link)
{
	int64_t deadline_ns = gz_clock_now_ns() + STOP_PATIENCE_NS;
	if (!link->gone && !link->stopping)
		switch_psvr2_stream(link, false, STOP_TIMEOUT_MS);
	link->stopping = true;
	cancel_psvr2_transfers(link);
	if (link->request_in_flight)
		libusb_cancel_transfer(link->request);
	while ((link->in_flight > 0 || link->request_in_flight) &&
	       gz_clock_now_ns() < deadline_ns && handle_usb_events(link, deadline_ns) == GZ_OK)
		;
	return link->in_flight == 0 && !link->request_in_flight;
}

void gz_psvr2_link_destroy(struct gz_psvr2_link **link)
{
	if (!link || !*link)
		return;
	struct gz_psvr2_link *l = *link;
	*link = NULL;
	if (!stop_psvr2_stream(l)) {
		/* The kernel may still write into them. */
		gz_err(l->log, "USB transfers do not return; their memory is not freed");
		return;
	}
	for (int i = 0; i < GZ_PSVR2_TRANSFERS; i++)
		libusb_free_transfer(l->slots[i].transfer);
	libusb_free_transfer(l->request);
	free(l);
}
