#include "drivers/pupil/pupil_link.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/text.h"
#include "protocol/key.h"
#include "protocol/wire.h"

#define GZ_LOG_MODULE "pupil"

/* Messages kept while the caller is busy: ten seconds of Pupil Core. */
enum { QUEUE = 4096 };

/* Longest answer that is understood, bytes with its NUL. */
enum { ANSWER_SIZE = 128 };

/* Unanswered requests in a row after which a silent peer is gone. */
enum { UNANSWERED_MAX = 2 };

/* Largest time that a clock may show, s: three hundred years. */
static const double TIME_MAX_S = 9.2e9;

static bool is_valid_port(const char *text, int *out_port)
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
	       colon > address + sizeof scheme - 1 && is_valid_port(colon + 1, &port) &&
	       strlen(address) + 6 < GZ_ENDPOINT_SIZE;
}

static void set_socket_int(void *socket, int option, int value)
{
	zmq_setsockopt(socket, option, &value, sizeof value);
}

/* Use the keys on a socket that is not connected yet. @return whether libzmq accepts them */
static bool apply_pupil_keys(const struct gz_pupil_keys *keys, void *socket)
{
	return keys->server[0] == '\0' ||
	       (zmq_setsockopt(socket, ZMQ_CURVE_SERVERKEY, keys->server, GZ_KEY_TEXT_SIZE) == 0 &&
		zmq_setsockopt(socket, ZMQ_CURVE_PUBLICKEY, keys->own.public_text,
			       GZ_KEY_TEXT_SIZE) == 0 &&
		zmq_setsockopt(socket, ZMQ_CURVE_SECRETKEY, keys->own.secret_text,
			       GZ_KEY_TEXT_SIZE) == 0);
}

static void *open_pupil_socket(struct gz_pupil_link *link, int type, int64_t size_max)
{
	void *socket = zmq_socket(link->context, type);
	if (!socket)
		return NULL;
	set_socket_int(socket, ZMQ_LINGER, 0);
	set_socket_int(socket, ZMQ_RCVHWM, QUEUE);
	set_socket_int(socket, ZMQ_IPV6, 1);
	zmq_setsockopt(socket, ZMQ_MAXMSGSIZE, &size_max, sizeof size_max);
	if (apply_pupil_keys(&link->keys, socket))
		return socket;
	zmq_close(socket);
	return NULL;
}

static int endpoint_host_length(const char *address)
{
	return (int)(strrchr(address, ':') - address);
}

static enum gz_result find_own_key(const struct gz_log *log, struct gz_key_pair *own)
{
	char path[GZ_PATH_SIZE];
	enum gz_result result = gz_key_file_find(NULL, GZ_CLIENT_KEY_FILE, path, sizeof path);
	if (result == GZ_OK)
		result = gz_key_file_read_secret(path, log, own->secret_text);
	if (result == GZ_ERR_NOT_FOUND) {
		gz_err(log,
		       "the other daemon requires a key, and %s does not exist: run gazectl keygen "
		       "--client",
		       path);
		return GZ_ERR_ACCESS;
	}
	if (result == GZ_OK && zmq_curve_public(own->public_text, own->secret_text) != 0)
		result = GZ_ERR_FORMAT;
	return result;
}

/* Find the keys for the host in the key directory of the user, or that of the system. */
static enum gz_result find_pupil_keys(struct gz_pupil_link *link)
{
	const char *host = link->address + strlen("tcp://");
	size_t length = (size_t)endpoint_host_length(link->address) - strlen("tcp://");
	struct gz_pupil_keys keys = { .server = "" };
	char bare[GZ_KEY_NAME_SIZE];
	if (length > 2 && host[0] == '[' && host[length - 1] == ']') {
		host++;
		length -= 2;
	}
	if (length >= sizeof bare) /* known_servers has no such name */
		length = 0;
	memcpy(bare, host, length);
	bare[length] = '\0';
	enum gz_result result = gz_key_file_find_server(NULL, bare, link->log, keys.server);
	if (result == GZ_ERR_NOT_FOUND)
		result = GZ_OK;
	if (result == GZ_OK && keys.server[0])
		result = find_own_key(link->log, &keys.own);
	if (result == GZ_OK)
		link->keys = keys;
	explicit_bzero(&keys, sizeof keys);
	return result;
}

/* A new socket cannot receive answers to requests of the old one. */
static enum gz_result open_pupil_control(struct gz_pupil_link *link)
{
	if (link->control)
		zmq_close(link->control);
	link->request = GZ_PUPIL_REQUEST_NONE;
	link->control = open_pupil_socket(link, ZMQ_DEALER, ANSWER_SIZE * 8);
	if (link->control && zmq_connect(link->control, link->address) == 0)
		return GZ_OK;
	gz_err(link->log, "cannot connect to %s: %s; check pupil.address", link->address,
	       zmq_strerror(errno));
	return link->control ? GZ_ERR_INVAL : GZ_ERR_NO_MEM;
}

static enum gz_result open_pupil_stream(struct gz_pupil_link *link)
{
	char endpoint[GZ_ENDPOINT_SIZE + 16];
	if (link->stream)
		zmq_close(link->stream);
	link->stream = open_pupil_socket(link, ZMQ_SUB, GZ_PUPIL_MESSAGE_MAX);
	snprintf(endpoint, sizeof endpoint, "%.*s:%d", endpoint_host_length(link->address),
		 link->address, link->port);
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

/* Send two frames: an empty one, as a REQ socket does, and the text. */
static void send_pupil_request(struct gz_pupil_link *link, enum gz_pupil_request request,
			       const char *text)
{
	link->sent_ns = gz_clock_now_ns();
	link->request = request;
	if (zmq_send(link->control, "", 0, ZMQ_SNDMORE | ZMQ_DONTWAIT) >= 0)
		zmq_send(link->control, text, strlen(text), ZMQ_DONTWAIT);
}

/* Receive the frames of one answer; the second one is its text. @return whether there was one */
static bool receive_pupil_answer(struct gz_pupil_link *link, char *answer, size_t size)
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

static void take_port_answer(struct gz_pupil_link *link, const char *answer)
{
	int port;
	if (!is_valid_port(answer, &port)) {
		if (!link->told_reply)
			gz_warn(link->log, "%s does not report the port of its stream, but: %s",
				link->address, answer);
		link->told_reply = true;
		return;
	}
	bool moved = link->port > 0 && port != link->port;
	link->port = port;
	if (!moved || !link->stream)
		return;
	gz_info(link->log, "%s has restarted: its stream is now at port %d", link->address, port);
	open_pupil_stream(link);
}

static void take_time_answer(struct gz_pupil_link *link, const char *answer, int64_t now_ns)
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
	gz_warn(link->log, "the clock of %s was set; the clock fit starts again", link->address);
}

static void take_pupil_answer(struct gz_pupil_link *link)
{
	char answer[ANSWER_SIZE];
	int64_t now_ns = gz_clock_now_ns();
	enum gz_pupil_request request = link->request;
	if (!receive_pupil_answer(link, answer, sizeof answer))
		return;
	link->request = GZ_PUPIL_REQUEST_NONE;
	link->unanswered = 0;
	if (request == GZ_PUPIL_REQUEST_PORT)
		take_port_answer(link, answer);
	else if (request == GZ_PUPIL_REQUEST_TIME)
		take_time_answer(link, answer, now_ns);
}

/* Send the request that is due. @return when the next one will be due, host time */
static int64_t send_due_requests(struct gz_pupil_link *link, int64_t now_ns)
{
	int64_t patience_ns = GZ_PUPIL_PATIENCE_MS * GZ_NS_PER_MS;
	int64_t silence_ns = GZ_PUPIL_SILENCE_MS * GZ_NS_PER_MS;
	if (link->request != GZ_PUPIL_REQUEST_NONE && now_ns - link->sent_ns >= patience_ns) {
		link->unanswered++;
		link->in_round = false;
		link->next_round_ns = now_ns + patience_ns;
		open_pupil_control(link);
	}
	if (link->request != GZ_PUPIL_REQUEST_NONE || !link->control)
		return link->sent_ns + patience_ns;
	bool silent = now_ns - link->heard_ns >= silence_ns;
	if (link->port == 0 || (silent && now_ns >= link->next_port_ns)) {
		link->next_port_ns = now_ns + silence_ns;
		send_pupil_request(link, GZ_PUPIL_REQUEST_PORT, "SUB_PORT");
	} else if (link->in_round || now_ns >= link->next_round_ns) {
		link->in_round = true;
		send_pupil_request(link, GZ_PUPIL_REQUEST_TIME, "t");
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

/* Wait once, until a message comes or a request is due. @return whether the stream has a message */
static bool wait_pupil_once(struct gz_pupil_link *link, bool with_stream, int64_t deadline_ns)
{
	int64_t now_ns = gz_clock_now_ns();
	int64_t due_ns = send_due_requests(link, now_ns);
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
		take_pupil_answer(link);
	return items[1].revents != 0;
}

static bool is_pupil_gone(const struct gz_pupil_link *link, int64_t now_ns)
{
	return link->unanswered >= UNANSWERED_MAX &&
	       now_ns - link->heard_ns >= 2 * GZ_PUPIL_PATIENCE_MS * GZ_NS_PER_MS;
}

enum gz_result gz_pupil_link_wait(struct gz_pupil_link *link, int64_t deadline_ns)
{
	while (link->control && link->stream) {
		bool message = wait_pupil_once(link, true, deadline_ns);
		int64_t now_ns = gz_clock_now_ns();
		if (message) {
			link->heard_ns = now_ns;
			return GZ_OK;
		}
		if (is_pupil_gone(link, now_ns))
			return GZ_ERR_NO_DEVICE;
		if (now_ns >= deadline_ns)
			return GZ_ERR_TIMEOUT;
	}
	return GZ_ERR_NO_DEVICE;
}

void gz_pupil_link_synchronise(struct gz_pupil_link *link, int64_t deadline_ns)
{
	while (link->control && link->clock.round_count == 0 && gz_clock_now_ns() < deadline_ns)
		wait_pupil_once(link, false, deadline_ns);
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
	send_pupil_request(link, GZ_PUPIL_REQUEST_NONE, question);
	zmq_poll(&item, 1, timeout_ms);
	if (item.revents && receive_pupil_answer(link, answer, size))
		return GZ_OK;
	open_pupil_control(
		link); /* a late answer must not be taken for the answer to another request */
	return GZ_ERR_TIMEOUT;
}

/* Decode the second frame of the newest message, if it is a status. */
static enum gz_result receive_gazed_status(struct gz_pupil_link *link, struct gz_status *out_status)
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
	enum gz_result result = open_pupil_stream(link);
	if (result == GZ_OK)
		result = GZ_ERR_TIMEOUT;
	zmq_pollitem_t item = { .socket = link->stream, .events = ZMQ_POLLIN };
	while (link->stream && result != GZ_OK && now_ns < deadline_ns) {
		zmq_poll(&item, 1, milliseconds_until(deadline_ns, now_ns));
		if (item.revents)
			result = receive_gazed_status(link, out_status);
		now_ns = gz_clock_now_ns();
	}
	if (link->stream)
		zmq_close(link->stream);
	link->stream = NULL;
	return result;
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
	enum gz_result result = find_pupil_keys(link);
	if (result == GZ_OK)
		result = open_pupil_control(link);
	int64_t deadline_ns = now_ns + timeout_ms * GZ_NS_PER_MS;
	while (result == GZ_OK && link->port == 0 && !link->told_reply &&
	       gz_clock_now_ns() < deadline_ns)
		wait_pupil_once(link, false, deadline_ns);
	if (result == GZ_OK && link->port == 0) {
		if (!link->told_reply && link->keys.server[0])
			gz_err(log,
			       "no daemon with the key of known_servers answers at %s; start it, "
			       "or let it accept our key, or check pupil.address",
			       address);
		else if (!link->told_reply)
			gz_err(log,
			       "no answer from %s; start Pupil Capture with its Network API, or "
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
	return open_pupil_stream(link);
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
