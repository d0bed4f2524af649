#include "drivers/usb/usb_stream.h"

#include <stdlib.h>

#include "base/clock.h"

#define GZ_LOG_MODULE "usb"

struct stream_slot {
	struct gz_usb_stream *stream;
	struct libusb_transfer *transfer;
	unsigned char *bytes;
	bool in_flight;
};

struct gz_usb_stream {
	struct gz_usb_stream_params params;
	struct stream_slot *slots;
	unsigned char *bytes; /* of all slots */
	int in_flight;        /* transfers of the slots */
	bool gone;
	bool stopping;
	bool recovering; /* no transfer is submitted until recovery_ns */
	int64_t recovery_ns;
	int recoveries; /* attempts without a confirmation in between */
};

void gz_usb_stream_lose(struct gz_usb_stream *stream)
{
	stream->gone = true;
}

bool gz_usb_stream_is_gone(const struct gz_usb_stream *stream)
{
	return stream->gone;
}

void gz_usb_stream_confirm(struct gz_usb_stream *stream)
{
	stream->recoveries = 0;
}

static void cancel_stream_slots(struct gz_usb_stream *stream)
{
	for (int i = 0; i < stream->params.transfers; i++)
		if (stream->slots[i].in_flight)
			libusb_cancel_transfer(stream->slots[i].transfer);
}

/* A halted endpoint must be cleared before it is used again, and may be cleared only while no
 * transfer is in flight. */
static void begin_stream_recovery(struct gz_usb_stream *stream, const char *what)
{
	const struct gz_usb_stream_params *params = &stream->params;
	if (stream->recovering || stream->gone || stream->stopping)
		return;
	if (stream->recoveries == GZ_USB_STREAM_RECOVERIES) {
		gz_err(params->log,
		       "device bug: endpoint 0x%02x %s again after %d resets; unplug the tracker "
		       "and plug it in again if it does not return",
		       params->endpoint, what, stream->recoveries);
		gz_usb_stream_lose(stream);
		return;
	}
	if (stream->recoveries == 0)
		gz_warn(params->log, "endpoint 0x%02x %s; resetting it", params->endpoint, what);
	stream->recovering = true;
	stream->recovery_ns = gz_clock_now_ns() + (GZ_USB_STREAM_RECOVERY_MS * GZ_NS_PER_MS) *
							  (INT64_C(1) << stream->recoveries);
	stream->recoveries++;
	cancel_stream_slots(stream);
}

static void submit_stream_slot(struct stream_slot *slot)
{
	struct gz_usb_stream *stream = slot->stream;
	if (stream->gone || stream->stopping || stream->recovering)
		return;
	int error = libusb_submit_transfer(slot->transfer);
	if (error == LIBUSB_SUCCESS) {
		slot->in_flight = true;
		stream->in_flight++;
	} else if (error == LIBUSB_ERROR_NO_DEVICE) {
		gz_usb_stream_lose(stream);
	} else {
		begin_stream_recovery(stream, libusb_error_name(error));
	}
}

void gz_usb_stream_submit(struct gz_usb_stream *stream)
{
	stream->stopping = false;
	for (int i = 0; i < stream->params.transfers; i++)
		submit_stream_slot(&stream->slots[i]);
}

static void LIBUSB_CALL on_stream_transfer(struct libusb_transfer *transfer)
{
	struct stream_slot *slot = transfer->user_data;
	struct gz_usb_stream *stream = slot->stream;
	const struct gz_usb_stream_params *params = &stream->params;
	slot->in_flight = false;
	stream->in_flight--;
	switch (transfer->status) {
	case LIBUSB_TRANSFER_COMPLETED:
		params->take(params->user, transfer->buffer, transfer->actual_length);
		break;
	case LIBUSB_TRANSFER_OVERFLOW:
		params->take_too_long(params->user);
		break;
	case LIBUSB_TRANSFER_CANCELLED:
		return;
	case LIBUSB_TRANSFER_NO_DEVICE:
		gz_usb_stream_lose(stream);
		return;
	case LIBUSB_TRANSFER_STALL:
		begin_stream_recovery(stream, "is stalled");
		return;
	default: /* LIBUSB_TRANSFER_ERROR, LIBUSB_TRANSFER_TIMED_OUT */
		begin_stream_recovery(stream, "fails");
		return;
	}
	submit_stream_slot(slot);
}

/* @return whether the endpoint has been reset */
static bool recover_stream(struct gz_usb_stream *stream, int64_t now_ns)
{
	const struct gz_usb_stream_params *params = &stream->params;
	if (!stream->recovering || stream->in_flight > 0 || now_ns < stream->recovery_ns)
		return false;
	stream->recovering = false;
	int error = libusb_clear_halt(params->handle, params->endpoint);
	if (error == LIBUSB_ERROR_NO_DEVICE) {
		gz_usb_stream_lose(stream);
		return false;
	}
	if (error != LIBUSB_SUCCESS)
		gz_debug(params->log, "resetting the endpoint: %s", libusb_error_name(error));
	params->restarted(params->user);
	gz_usb_stream_submit(stream);
	return true;
}

/* Let libusb call back until the deadline. */
static enum gz_result handle_usb_events(struct gz_usb_stream *stream, int64_t deadline_ns)
{
	int64_t left_ns = deadline_ns - gz_clock_now_ns();
	if (left_ns < 0)
		left_ns = 0;
	struct timeval timeout = { .tv_sec = (time_t)(left_ns / GZ_NS_PER_S),
				   .tv_usec = (suseconds_t)(left_ns % GZ_NS_PER_S / GZ_NS_PER_US) };
	int error = libusb_handle_events_timeout_completed(stream->params.context, &timeout, NULL);
	if (error == LIBUSB_SUCCESS || error == LIBUSB_ERROR_INTERRUPTED ||
	    error == LIBUSB_ERROR_TIMEOUT)
		return GZ_OK;
	gz_err(stream->params.log, "USB: %s", libusb_error_name(error));
	gz_usb_stream_lose(stream);
	return GZ_ERR_NO_DEVICE;
}

void gz_usb_stream_handle(struct gz_usb_stream *stream, int64_t deadline_ns)
{
	if (stream->gone || recover_stream(stream, gz_clock_now_ns()) || stream->gone)
		return;
	if (stream->recovering && stream->in_flight == 0 && stream->recovery_ns < deadline_ns)
		deadline_ns = stream->recovery_ns;
	handle_usb_events(stream, deadline_ns);
}

static enum gz_result allocate_stream_slots(struct gz_usb_stream *stream)
{
	const struct gz_usb_stream_params *params = &stream->params;
	size_t size = (size_t)params->transfer_size;
	stream->slots = calloc((size_t)params->transfers, sizeof *stream->slots);
	stream->bytes = calloc((size_t)params->transfers, size);
	if (!stream->slots || !stream->bytes)
		return GZ_ERR_NO_MEM;
	for (int i = 0; i < params->transfers; i++) {
		struct stream_slot *slot = &stream->slots[i];
		slot->stream = stream;
		slot->bytes = stream->bytes + (size_t)i * size;
		slot->transfer = libusb_alloc_transfer(0);
		if (!slot->transfer)
			return GZ_ERR_NO_MEM;
		libusb_fill_bulk_transfer(slot->transfer, params->handle, params->endpoint,
					  slot->bytes, params->transfer_size, on_stream_transfer,
					  slot, 0);
	}
	return GZ_OK;
}

enum gz_result gz_usb_stream_create(const struct gz_usb_stream_params *params,
				    struct gz_usb_stream **out_stream)
{
	struct gz_usb_stream *stream = calloc(1, sizeof *stream);
	if (!stream)
		return GZ_ERR_NO_MEM;
	stream->params = *params;
	stream->stopping = true;
	enum gz_result result = allocate_stream_slots(stream);
	if (result != GZ_OK) {
		gz_usb_stream_destroy(&stream);
		return result;
	}
	*out_stream = stream;
	return GZ_OK;
}

static bool is_stream_busy(const struct gz_usb_stream *stream, bool (*others)(const void *user))
{
	return stream->in_flight > 0 || (others && others(stream->params.user));
}

bool gz_usb_stream_stop(struct gz_usb_stream *stream, bool (*others)(const void *user))
{
	int64_t deadline_ns = gz_clock_now_ns() + GZ_USB_STREAM_STOP_NS;
	stream->stopping = true;
	cancel_stream_slots(stream);
	while (is_stream_busy(stream, others) && gz_clock_now_ns() < deadline_ns &&
	       handle_usb_events(stream, deadline_ns) == GZ_OK)
		;
	if (!is_stream_busy(stream, others))
		return true;
	gz_err(stream->params.log, "USB transfers do not return; their memory is not freed");
	return false;
}

void gz_usb_stream_destroy(struct gz_usb_stream **stream)
{
	if (!stream || !*stream)
		return;
	struct gz_usb_stream *s = *stream;
	*stream = NULL;
	for (int i = 0; s->slots && i < s->params.transfers; i++)
		libusb_free_transfer(s->slots[i].transfer);
	free(s->slots);
	free(s->bytes);
	free(s);
}
