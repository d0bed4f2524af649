#include "drivers/tobii5/tobii5_link.h"

#include <stdlib.h>

#include "base/clock.h"
#include "drivers/usb/usb_device.h"
#include "drivers/usb/usb_stream.h"

#define GZ_LOG_MODULE "tobii5"

#define VENDOR_REQUEST \
	((uint8_t)(LIBUSB_REQUEST_TYPE_VENDOR | LIBUSB_RECIPIENT_INTERFACE | LIBUSB_ENDPOINT_OUT))

/* Longest wait for a session to open and to close, and for the tracker to take a request, ms. */
enum { OPEN_TIMEOUT_MS = 150, CLOSE_TIMEOUT_MS = 200, REQUEST_TIMEOUT_MS = 500 };

struct gz_tobii5_link {
	libusb_device_handle *handle;
	const struct gz_log *log;
	struct gz_usb_stream *stream;
	struct libusb_transfer *request;
	unsigned char request_bytes[GZ_TOBII5_REQUEST_MAX];
	bool request_in_flight;
	bool is_open;
	struct gz_tobii5_session session;
	struct gz_tobii5_reader reader;
	struct gz_tobii5_arrival queue[GZ_TOBII5_QUEUE];
	unsigned first, count; /* of the queue */
	uint64_t malformed[GZ_MALFORMED_COUNT];
	struct gz_ratelimit complaints;
	const char *told; /* the newest trouble that was logged */
	bool told_unknown, told_strange, told_request, told_silence;
};

const struct gz_tobii5_session *gz_tobii5_link_session(const struct gz_tobii5_link *link)
{
	return &link->session;
}

const uint64_t *gz_tobii5_link_malformed(const struct gz_tobii5_link *link)
{
	return link->malformed;
}

static void count_tobii5_malformed(struct gz_tobii5_link *link, enum gz_malformed reason)
{
	link->malformed[reason]++;
	gz_warn_limited(link->log, &link->complaints,
			"device bug: what it sends is not as described: %s",
			gz_malformed_name(reason));
}

static void enqueue_tobii5_gaze(struct gz_tobii5_link *link, const struct gz_tobii5_gaze *gaze)
{
	if (link->count == GZ_TOBII5_QUEUE) {
		link->first = (link->first + 1) % GZ_TOBII5_QUEUE;
		link->count--;
	}
	link->queue[(link->first + link->count++) % GZ_TOBII5_QUEUE] =
		(struct gz_tobii5_arrival) { .arrival_ns = gz_clock_now_ns(), .gaze = *gaze };
}

static bool dequeue_tobii5_gaze(struct gz_tobii5_link *link, struct gz_tobii5_arrival *out_arrival)
{
	if (link->count == 0)
		return false;
	*out_arrival = link->queue[link->first];
	link->first = (link->first + 1) % GZ_TOBII5_QUEUE;
	link->count--;
	return true;
}

static void take_tobii5_gaze(struct gz_tobii5_link *link, const struct gz_tobii5_frame *frame)
{
	struct gz_tobii5_gaze gaze;
	enum gz_malformed reason = GZ_MALFORMED_LONG;
	if (frame->size > GZ_TOBII5_PAYLOAD_MAX ||
	    gz_tobii5_parse_gaze(frame->payload, frame->size, &gaze, &reason) != GZ_OK) {
		count_tobii5_malformed(link, reason);
		return;
	}
	gz_usb_stream_confirm(link->stream);
	if (gaze.strange && !link->told_strange) {
		link->told_strange = true;
		gz_info(link->log,
			"column 0x%x of its gaze is not as described and is ignored; its firmware "
			"is newer than the description",
			gaze.strange);
	}
	enqueue_tobii5_gaze(link, &gaze);
}

static void take_tobii5_frame(struct gz_tobii5_link *link, const struct gz_tobii5_frame *frame)
{
	switch (gz_tobii5_session_take(&link->session, frame, gz_clock_now_ns())) {
	case GZ_TOBII5_NEWS_GAZE:
		take_tobii5_gaze(link, frame);
		return;
	case GZ_TOBII5_NEWS_UNKNOWN:
		if (!link->told_unknown)
			gz_info(link->log,
				"it sends messages that are not described (kind 0x%x, operation "
				"0x%x, %u bytes); they are ignored",
				(unsigned)frame->kind, frame->operation, frame->size);
		link->told_unknown = true;
		return;
	default:
		return;
	}
}

static void take_tobii5_bytes(void *user, const unsigned char *bytes, int size)
{
	struct gz_tobii5_link *link = user;
	struct gz_tobii5_frame frame;
	enum gz_malformed reason;
	enum gz_result result;
	gz_tobii5_reader_take(&link->reader, bytes, (size_t)size);
	while ((result = gz_tobii5_reader_next(&link->reader, &frame, &reason)) != GZ_ERR_END) {
		if (result == GZ_OK)
			take_tobii5_frame(link, &frame);
		else
			count_tobii5_malformed(link, reason);
	}
}

static void count_long_tobii5_transfer(void *user)
{
	count_tobii5_malformed(user, GZ_MALFORMED_LONG);
}

/* What came before the reset is lost, perhaps in the middle of a frame. */
static void restart_tobii5_reader(void *user)
{
	struct gz_tobii5_link *link = user;
	link->reader = (struct gz_tobii5_reader) { 0 };
}

static void complain_about_request(struct gz_tobii5_link *link, const char *what)
{
	if (!link->told_request)
		gz_warn(link->log, "it does not take requests: %s", what);
	link->told_request = true;
}

static void LIBUSB_CALL on_tobii5_request(struct libusb_transfer *transfer)
{
	struct gz_tobii5_link *link = transfer->user_data;
	link->request_in_flight = false;
	if (transfer->status == LIBUSB_TRANSFER_NO_DEVICE)
		gz_usb_stream_lose(link->stream);
	else if (transfer->status == LIBUSB_TRANSFER_STALL)
		complain_about_request(link, "the endpoint is stalled");
	else if (transfer->status == LIBUSB_TRANSFER_COMPLETED)
		link->told_request = false;
	else if (transfer->status != LIBUSB_TRANSFER_CANCELLED)
		complain_about_request(link, "the transfer fails or takes too long");
}

static void send_tobii5_request(struct gz_tobii5_link *link, size_t size)
{
	link->request->length = (int)size;
	int error = libusb_submit_transfer(link->request);
	if (error == LIBUSB_SUCCESS)
		link->request_in_flight = true;
	else if (error == LIBUSB_ERROR_NO_DEVICE)
		gz_usb_stream_lose(link->stream);
	else
		complain_about_request(link, libusb_error_name(error));
}

/* Log what the conversation has come to, once. */
static void tell_about_session(struct gz_tobii5_link *link)
{
	const struct gz_tobii5_session *session = &link->session;
	if (session->trouble && session->trouble != link->told)
		gz_warn(link->log, "%s", session->trouble);
	link->told = session->trouble;
	if (session->phase == GZ_TOBII5_STREAMING && session->tries > 0 && !link->told_silence) {
		gz_warn(link->log, "it is silent; asking for gaze again (request %u)",
			session->number);
		link->told_silence = true;
	}
}

/* Send the request that is due, if the one before it is through. */
static void continue_tobii5_session(struct gz_tobii5_link *link, int64_t now_ns)
{
	if (link->request_in_flight)
		return;
	size_t size = gz_tobii5_session_ask(&link->session, now_ns, link->request_bytes);
	tell_about_session(link);
	if (size > 0)
		send_tobii5_request(link, size);
	if (link->session.phase != GZ_TOBII5_SILENT)
		return;
	gz_warn(link->log, "it stays silent after %d requests; opening it anew", GZ_TOBII5_TRIES);
	gz_usb_stream_lose(link->stream);
}

/* Do what is due, and then let something happen before the deadline. */
static void step_tobii5_link(struct gz_tobii5_link *link, int64_t now_ns, int64_t deadline_ns)
{
	continue_tobii5_session(link, now_ns);
	if (gz_usb_stream_is_gone(link->stream))
		return;
	bool is_due_first = !link->request_in_flight && link->session.due_ns < deadline_ns;
	gz_usb_stream_handle(link->stream, is_due_first ? link->session.due_ns : deadline_ns);
}

void gz_tobii5_link_prepare(struct gz_tobii5_link *link, int64_t deadline_ns)
{
	int64_t now_ns = gz_clock_now_ns();
	while (now_ns < deadline_ns && link->session.phase < GZ_TOBII5_SUBSCRIBING &&
	       !gz_usb_stream_is_gone(link->stream)) {
		step_tobii5_link(link, now_ns, deadline_ns);
		now_ns = gz_clock_now_ns();
	}
}

enum gz_result gz_tobii5_link_next(struct gz_tobii5_link *link, int64_t deadline_ns,
				   struct gz_tobii5_arrival *out_arrival)
{
	int64_t now_ns = gz_clock_now_ns();
	do {
		if (dequeue_tobii5_gaze(link, out_arrival))
			return GZ_OK;
		if (gz_usb_stream_is_gone(link->stream))
			return GZ_ERR_NO_DEVICE;
		step_tobii5_link(link, now_ns, deadline_ns);
		now_ns = gz_clock_now_ns();
	} while (now_ns < deadline_ns);
	if (dequeue_tobii5_gaze(link, out_arrival))
		return GZ_OK;
	return gz_usb_stream_is_gone(link->stream) ? GZ_ERR_NO_DEVICE : GZ_ERR_TIMEOUT;
}

static enum gz_result allocate_tobii5_request(struct gz_tobii5_link *link)
{
	link->request = libusb_alloc_transfer(0);
	if (!link->request)
		return GZ_ERR_NO_MEM;
	libusb_fill_bulk_transfer(link->request, link->handle, GZ_TOBII5_ENDPOINT_OUT,
				  link->request_bytes, 0, on_tobii5_request, link,
				  REQUEST_TIMEOUT_MS);
	return GZ_OK;
}

enum gz_result gz_tobii5_link_create(libusb_context *context, libusb_device_handle *handle,
				     const struct gz_log *log, struct gz_tobii5_link **out_link)
{
	struct gz_tobii5_link *link = calloc(1, sizeof *link);
	if (!link)
		return GZ_ERR_NO_MEM;
	link->handle = handle;
	link->log = log;
	enum gz_result result = gz_usb_stream_create(
		&(struct gz_usb_stream_params) { .context = context,
						 .handle = handle,
						 .log = log,
						 .endpoint = GZ_TOBII5_ENDPOINT_IN,
						 .transfers = GZ_TOBII5_TRANSFERS,
						 .transfer_size = GZ_TOBII5_TRANSFER_SIZE,
						 .take = take_tobii5_bytes,
						 .take_too_long = count_long_tobii5_transfer,
						 .restarted = restart_tobii5_reader,
						 .user = link },
		&link->stream);
	if (result == GZ_OK)
		result = allocate_tobii5_request(link);
	if (result != GZ_OK) {
		gz_tobii5_link_destroy(&link);
		return result;
	}
	*out_link = link;
	return GZ_OK;
}

static int request_tobii5_session(struct gz_tobii5_link *link, uint8_t request, unsigned timeout_ms)
{
	return libusb_control_transfer(link->handle, VENDOR_REQUEST, request, 0,
				       GZ_TOBII5_INTERFACE, NULL, 0, timeout_ms);
}

enum gz_result gz_tobii5_link_start(struct gz_tobii5_link *link,
				    const struct gz_tobii5_area *wanted)
{
	gz_tobii5_session_begin(&link->session, wanted, gz_clock_now_ns());
	int error = request_tobii5_session(link, GZ_TOBII5_SESSION_OPEN, OPEN_TIMEOUT_MS);
	if (error < 0) {
		gz_err(link->log, "the tracker does not open a session: %s; plug it in again",
		       libusb_error_name(error));
		return error == LIBUSB_ERROR_NO_DEVICE ? GZ_ERR_NO_DEVICE : GZ_ERR_IO;
	}
	link->is_open = true;
	gz_usb_stream_submit(link->stream);
	return GZ_OK;
}

static bool is_tobii5_request_in_flight(const void *user)
{
	return ((const struct gz_tobii5_link *)user)->request_in_flight;
}

/* Close the session. @return whether no transfer is in flight any more */
static bool stop_tobii5_link(struct gz_tobii5_link *link)
{
	if (!link->stream)
		return true;
	if (link->request_in_flight)
		libusb_cancel_transfer(link->request);
	bool stopped = gz_usb_stream_stop(link->stream, is_tobii5_request_in_flight);
	bool is_silent = link->session.phase == GZ_TOBII5_SILENT;
	if (link->is_open && (is_silent || !gz_usb_stream_is_gone(link->stream)))
		request_tobii5_session(link, GZ_TOBII5_SESSION_CLOSE, CLOSE_TIMEOUT_MS);
	return stopped;
}

void gz_tobii5_link_destroy(struct gz_tobii5_link **link)
{
	if (!link || !*link)
		return;
	struct gz_tobii5_link *l = *link;
	*link = NULL;
	if (!stop_tobii5_link(l))
		return;
	gz_usb_stream_destroy(&l->stream);
	libusb_free_transfer(l->request);
	free(l);
}
