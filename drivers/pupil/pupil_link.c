#include "drivers/pupil/pupil_link.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/number.h"
#include "protocol/wire.h"

#define GZ_LOG_MODULE "pupil"

/* Messages kept while the caller is busy: ten seconds of Pupil Core's. */
enum { QUEUE = 4096 };

/* Longest answer understood, bytes with its NUL. */
enum { ANSWER_SIZE = 128 };

/* A silent stream and so many requests without an answer: nobody is there any more. */
enum { UNANSWERED_MAX = 2 };

/* Time that no clock shows, s: three hundred years. */
static const double TIME_MAX_S = 9.2e9;

static bool port_valid(const char *text, int *out_port)
{
	long long port;
	if (!gz_number_parse_whole(text, &port) || port < 1 || port > 65535)
		return false;
	*out_port = (int)port;
	return true;
}

bool gz_pupil_address_valid(const char *address)
{
	static const char scheme[] = "tcp://";
	int port;
	const char *colon = strrchr(address, ':');
	return strncmp(address, scheme, sizeof scheme - 1) == 0 &&
	       colon > address + sizeof scheme - 1 && port_valid(colon + 1, &port) &&
	       strlen(address) + 6 < GZ_ENDPOINT_SIZE;
}

static void set_int(void *socket, int option, int value)
{
	zmq_setsockopt(socket, option, &value, sizeof value);
}

static void *open_socket(struct gz_pupil_link *link, int type, int64_t size_max)
{
	void *socket = zmq_socket(link->context, type);
	if (!socket)
		return NULL;
	set_int(socket, ZMQ_LINGER, 0);
	set_int(socket, ZMQ_RCVHWM, QUEUE);
	set_int(socket, ZMQ_IPV6, 1);
	zmq_setsockopt(socket, ZMQ_MAXMSGSIZE, &size_max, sizeof size_max);
	if (gz_pupil_keys_apply(&link->keys, socket))
		return socket;
	zmq_close(socket);
	return NULL;
}

static int host_length(const char *address)
{
	return (int)(strrchr(address, ':') - address);
}

static enum gz_result find_keys(struct gz_pupil_link *link)
{
	char host[GZ_ENDPOINT_SIZE];
	int scheme = (int)strlen("tcp://");
	snprintf(host, sizeof host, "%.*s", host_length(link->address) - scheme,
		 link->address + scheme);
	return gz_pupil_keys_find(host, link->log, &link->keys);
}

/* A new socket has no answers to questions of the last one. */
static enum gz_result open_control(struct gz_pupil_link *link)
{
	if (link->control)
		zmq_close(link->control);
	link->request = GZ_PUPIL_REQUEST_NONE;
	link->control = open_socket(link, ZMQ_DEALER, ANSWER_SIZE * 8);
	if (link->control && zmq_connect(link->control, link->address) == 0)
		return GZ_OK;
	gz_err(link->log, "cannot connect to %s: %s; check pupil.address", link->address,
	       zmq_strerror(errno));
	return link->control ? GZ_ERR_INVAL : GZ_ERR_NO_MEM;
}

static enum gz_result open_stream(struct gz_pupil_link *link)
{
	char endpoint[GZ_ENDPOINT_SIZE + 16];
	if (link->stream)
		zmq_close(link->stream);
	link->stream = open_socket(link, ZMQ_SUB, GZ_PUPIL_MESSAGE_MAX);
	snprintf(endpoint, sizeof endpoint, "%.*s:%d", host_length(link->address), link->address,
		 link->port);
	for (int i = 0; link->stream && i < 2; i++) {
		if (link->topics[i][0])
			zmq_setsockopt(link->stream, ZMQ_SUBSCRIBE, link->topics[i],
				       strlen(link->topics[i]));
	}
	if (link->stream && zmq_connect(link->stream, endpoint) == 0)
		return GZ_OK;
	gz_err(link->log, "cannot connect to %s: %s", endpoint, zmq_strerror(errno));
	return GZ_ERR_IO;
}

/* Two frames: an empty one, as from a REQ, and the text. */
static void send_request(struct gz_pupil_link *link, enum gz_pupil_request request,
			 const char *text)
{
	link->sent_ns = gz_clock_now_ns();
	link->request = request;
	if (zmq_send(link->control, "", 0, ZMQ_SNDMORE | ZMQ_DONTWAIT) >= 0)
		zmq_send(link->control, text, strlen(text), ZMQ_DONTWAIT);
}

/* The frames of one answer, of which the second is text. @return whether there was one */
static bool receive_answer(struct gz_pupil_link *link, char *answer, size_t size)
{
	int frames = 0, more = 1, length = -1;
	char text[ANSWER_SIZE * 8];
	for (; more; frames++) {
		length = zmq_recv(link->control, text, sizeof text, ZMQ_DONTWAIT);
		size_t option_size = sizeof more;
		if (length < 0 ||
		    zmq_getsockopt(link->control, ZMQ_RCVMORE, &more, &option_size) != 0)
			return false;
	}
	bool whole = frames == 2 && (size_t)length < size && !memchr(text, '\0', (size_t)length);
	if (whole)
		memcpy(answer, text, (size_t)length);
	answer[whole ? length : 0] = '\0';
	return true;
}

static void take_port(struct gz_pupil_link *link, const char *answer)
{
	int port;
	if (!port_valid(answer, &port)) {
		if (!link->told_reply)
			gz_warn(link->log, "%s tells no port of its stream, but: %s", link->address,
				answer);
		link->told_reply = true;
		return;
	}
	bool moved = link->port > 0 && port != link->port;
	link->port = port;
	if (!moved || !link->stream)
		return;
	gz_info(link->log, "%s has begun anew: its stream is at port %d now", link->address, port);
	open_stream(link);
}

static void take_time(struct gz_pupil_link *link, const char *answer, int64_t now_ns)
{
	double time_s;
	if (!gz_number_parse(answer, &time_s) || fabs(time_s) > TIME_MAX_S) {
		link->in_round = false;
		link->next_round_ns = now_ns + GZ_PUPIL_ROUND_NS;
		return;
	}
	enum gz_pupil_sync sync =
		gz_pupil_clock_exchange(&link->clock, link->sent_ns, llround(time_s * 1e9), now_ns);
	if (sync == GZ_PUPIL_SYNC_MORE)
		return;
	link->in_round = false;
	link->next_round_ns = now_ns + GZ_PUPIL_ROUND_NS;
	if (sync != GZ_PUPIL_SYNC_JUMPED)
		return;
	link->jumps++;
	gz_warn(link->log, "the clock of %s was set; its fit begins again", link->address);
}

static void take_answer(struct gz_pupil_link *link)
{
	char answer[ANSWER_SIZE];
	int64_t now_ns = gz_clock_now_ns();
	enum gz_pupil_request request = link->request;
	if (!receive_answer(link, answer, sizeof answer))
		return;
	link->request = GZ_PUPIL_REQUEST_NONE;
	link->unanswered = 0;
	if (request == GZ_PUPIL_REQUEST_PORT)
		take_port(link, answer);
	else if (request == GZ_PUPIL_REQUEST_TIME)
		take_time(link, answer, now_ns);
}

/* Do what is due. @return when something will be, host time */
static int64_t take_care(struct gz_pupil_link *link, int64_t now_ns)
{
	int64_t patience_ns = GZ_PUPIL_PATIENCE_MS * GZ_NS_PER_MS;
	int64_t silence_ns = GZ_PUPIL_SILENCE_MS * GZ_NS_PER_MS;
	if (link->request != GZ_PUPIL_REQUEST_NONE && now_ns - link->sent_ns >= patience_ns) {
		link->unanswered++;
		link->in_round = false;
		link->next_round_ns = now_ns + patience_ns;
		open_control(link);
	}
	if (link->request != GZ_PUPIL_REQUEST_NONE || !link->control)
		return link->sent_ns + patience_ns;
	bool silent = now_ns - link->heard_ns >= silence_ns;
	if (link->port == 0 || (silent && now_ns >= link->next_port_ns)) {
		link->next_port_ns = now_ns + silence_ns;
		send_request(link, GZ_PUPIL_REQUEST_PORT, "SUB_PORT");
	} else if (link->in_round || now_ns >= link->next_round_ns) {
		link->in_round = true;
		send_request(link, GZ_PUPIL_REQUEST_TIME, "t");
	} else {
		int64_t next_ns = silent ? link->next_port_ns : link->heard_ns + silence_ns;
		return next_ns < link->next_round_ns ? next_ns : link->next_round_ns;
	}
	return link->sent_ns + patience_ns;
}

static long milliseconds_until(int64_t time_ns, int64_t now_ns)
{
	int64_t left_ns = time_ns - now_ns;
	return left_ns <= 0 ? 0 : (long)((left_ns + GZ_NS_PER_MS - 1) / GZ_NS_PER_MS);
}

/* Wait once, until something comes or is due. @return whether a message waits in the stream */
static bool wait_once(struct gz_pupil_link *link, bool with_stream, int64_t deadline_ns)
{
	int64_t now_ns = gz_clock_now_ns();
	int64_t due_ns = take_care(link, now_ns);
	if (!link->control)
		return false;
	zmq_pollitem_t items[] = {
		{ .socket = link->control, .events = ZMQ_POLLIN },
		{ .socket = link->stream, .events = ZMQ_POLLIN },
	};
	int count = with_stream && link->stream ? 2 : 1;
	zmq_poll(items, count,
		 milliseconds_until(due_ns < deadline_ns ? due_ns : deadline_ns, now_ns));
	if (items[0].revents)
		take_answer(link);
	return items[1].revents != 0;
}

static bool is_dead(const struct gz_pupil_link *link, int64_t now_ns)
{
	return link->unanswered >= UNANSWERED_MAX &&
	       now_ns - link->heard_ns >= 2 * GZ_PUPIL_PATIENCE_MS * GZ_NS_PER_MS;
}

enum gz_result gz_pupil_link_wait(struct gz_pupil_link *link, int64_t deadline_ns)
{
	while (link->control && link->stream) {
		bool message = wait_once(link, true, deadline_ns);
		int64_t now_ns = gz_clock_now_ns();
		if (message) {
			link->heard_ns = now_ns;
			return GZ_OK;
		}
		if (is_dead(link, now_ns))
			return GZ_ERR_NO_DEVICE;
		if (now_ns >= deadline_ns)
			return GZ_ERR_TIMEOUT;
	}
	return GZ_ERR_NO_DEVICE;
}

void gz_pupil_link_synchronise(struct gz_pupil_link *link, int64_t deadline_ns)
{
	while (link->control && link->clock.round_count == 0 && gz_clock_now_ns() < deadline_ns)
		wait_once(link, false, deadline_ns);
}

void gz_pupil_link_doubt_clock(struct gz_pupil_link *link, int64_t now_ns)
{
	int64_t soon_ns = link->next_round_ns - GZ_PUPIL_ROUND_NS + GZ_NS_PER_S;
	if (!link->in_round && now_ns >= soon_ns)
		link->next_round_ns = now_ns;
}

enum gz_result gz_pupil_link_ask(struct gz_pupil_link *link, const char *question, int timeout_ms,
				 char *answer, size_t size)
{
	zmq_pollitem_t item = { .socket = link->control, .events = ZMQ_POLLIN };
	answer[0] = '\0';
	send_request(link, GZ_PUPIL_REQUEST_NONE, question);
	zmq_poll(&item, 1, timeout_ms);
	if (item.revents && receive_answer(link, answer, size))
		return GZ_OK;
	open_control(link); /* a late answer must not be taken for that to another question */
	return GZ_ERR_TIMEOUT;
}

/* The newest message's second frame, if it is a status. */
static enum gz_result receive_status(struct gz_pupil_link *link, struct gz_status *out_status)
{
	zmq_msg_t frame;
	enum gz_result result = GZ_ERR_TIMEOUT;
	zmq_msg_init(&frame);
	for (int i = 0; zmq_msg_recv(&frame, link->stream, ZMQ_DONTWAIT) >= 0; i++) {
		if (i == 1)
			result = gz_wire_decode_status(zmq_msg_data(&frame), zmq_msg_size(&frame),
						       out_status);
		if (!zmq_msg_more(&frame))
			break;
	}
	zmq_msg_close(&frame);
	return result;
}

enum gz_result gz_pupil_link_status(struct gz_pupil_link *link, int timeout_ms,
				    struct gz_status *out_status)
{
	int64_t now_ns = gz_clock_now_ns(), deadline_ns = now_ns + timeout_ms * GZ_NS_PER_MS;
	snprintf(link->topics[0], sizeof link->topics[0], GZ_TOPIC_STATUS);
	enum gz_result result = open_stream(link);
	if (result == GZ_OK)
		result = GZ_ERR_TIMEOUT;
	zmq_pollitem_t item = { .socket = link->stream, .events = ZMQ_POLLIN };
	while (link->stream && result != GZ_OK && now_ns < deadline_ns) {
		zmq_poll(&item, 1, milliseconds_until(deadline_ns, now_ns));
		if (item.revents)
			result = receive_status(link, out_status);
		now_ns = gz_clock_now_ns();
	}
	if (link->stream)
		zmq_close(link->stream);
	link->stream = NULL;
	return result == GZ_ERR_PROTOCOL ? GZ_ERR_TIMEOUT : result;
}

enum gz_result gz_pupil_link_open(struct gz_pupil_link *link, const char *address, int timeout_ms,
				  const struct gz_log *log)
{
	int64_t now_ns = gz_clock_now_ns();
	*link = (struct gz_pupil_link) { .log = log,
					 .heard_ns = now_ns,
					 .next_round_ns = INT64_MAX };
	snprintf(link->address, sizeof link->address, "%s", address);
	link->context = zmq_ctx_new();
	if (!link->context)
		return GZ_ERR_NO_MEM;
	enum gz_result result = find_keys(link);
	if (result == GZ_OK)
		result = open_control(link);
	int64_t deadline_ns = now_ns + timeout_ms * GZ_NS_PER_MS;
	while (result == GZ_OK && link->port == 0 && !link->told_reply &&
	       gz_clock_now_ns() < deadline_ns)
		wait_once(link, false, deadline_ns);
	if (result == GZ_OK && link->port == 0) {
		if (!link->told_reply && link->keys.server[0])
			gz_err(log,
			       "no daemon with the key of known_servers answers at %s; start it, "
			       "or "
			       "have it let our key in, or check pupil.address",
			       address);
		else if (!link->told_reply)
			gz_err(log,
			       "nobody answers at %s; start Pupil Capture with its Network API, or "
			       "check pupil.address",
			       address);
		result = GZ_ERR_NO_DEVICE;
	}
	if (result != GZ_OK)
		gz_pupil_link_close(link);
	return result;
}

enum gz_result gz_pupil_link_subscribe(struct gz_pupil_link *link, const char *first,
				       const char *second)
{
	snprintf(link->topics[0], sizeof link->topics[0], "%s", first);
	snprintf(link->topics[1], sizeof link->topics[1], "%s", second ? second : "");
	link->heard_ns = link->next_round_ns = gz_clock_now_ns();
	return open_stream(link);
}

void gz_pupil_link_close(struct gz_pupil_link *link)
{
	if (link->control)
		zmq_close(link->control);
	if (link->stream)
		zmq_close(link->stream);
	if (link->context)
		zmq_ctx_term(link->context);
	link->control = link->stream = link->context = NULL;
	explicit_bzero(&link->keys, sizeof link->keys);
}
