#include "daemon/guard.h"

#include <arpa/inet.h>
#include <errno.h>
#include <malloc.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>
#include <zmq.h>

#include "base/clock.h"
#include "daemon/accept.h"
#include "daemon/admission.h"
#include "daemon/door.h"
#include "daemon/quota.h"

#define GZ_LOG_MODULE "security"

/* RFC 27: the endpoint at which libzmq asks. */
#define ZAP_ENDPOINT "inproc://zeromq.zap.01"

/* How many of the newest connections have their address kept, for the log message if the handshake
 * fails. Chosen: handshakes are short; if more run at a time, some failures are logged without an
 * address. */
enum { PEERS_MAX = 64 };

/* Most requests and events taken from each socket before the thread polls again. */
enum { AT_ONCE = 64 };

/* Kinds of message about an address; each is logged once a minute. */
enum notice { LET_IN, UNKNOWN_KEY, WRONG_SERVER_KEY, WITHOUT_KEYS, LEFT };

/* A message about refusals at the door is logged once a minute. */
#define REFUSED_AT_DOOR_NS (60 * GZ_NS_PER_S)

/* Memory is given back to the system when this many connections have ended, and this long after the
 * first of them. Chosen: not for a few programs that end, and seldom while many come and go. */
enum { ENDED_BEFORE_TRIM = 32 };
#define TRIM_AFTER_NS (5 * GZ_NS_PER_S)

/* A connection that may still fail. */
struct peer {
	int fd; /* -1: free */
	char address[GZ_ADDRESS_SIZE];
};

/* The ways by which clients come. */
enum way { BY_TCP, LOCALLY, WAYS };

struct gz_connections {
	struct gz_guard *guard;
	const char *name;
	void *monitor;   /* PAIR */
	bool of_readers; /* its clients may only subscribe */
	/* Through which doors clients come over TCP and at the local socket, and the doors' numbers
	 * for them; 0: no door is open. */
	struct gz_door *doors[WAYS];
	int channels[WAYS];
	_Atomic uint32_t count;
	bool failing; /* a handshake has failed; the next event ends its connection */
	enum notice failure;
	unsigned next_peer;           /* index of the oldest peer, which the next one replaces */
	struct peer peers[PEERS_MAX]; /* the newest connections */
};

/* A door, and its refusals that are in the log. */
struct guarded_door {
	struct gz_door *door;
	enum gz_door_kind kind;
	enum gz_door_place place;
	uint64_t told[GZ_QUOTA_REASON_COUNT];
	struct gz_ratelimit complaints[GZ_QUOTA_REASON_COUNT];
};

struct gz_guard {
	const struct gz_log *log;
	void *context;
	void *zap;   /* REP; NULL: clients need no key */
	int quit_fd; /* eventfd */
	pthread_t thread;
	bool has_thread;
	size_t socket_count;
	struct gz_connections sockets[GZ_GUARD_SOCKETS_MAX];
	struct gz_quota *quota; /* NULL until the start */
	struct gz_authorized_keys authorized;
	struct gz_address_limit told;
	uint32_t left;   /* connections that ended since memory was given back */
	int64_t left_ns; /* the first of them */
	struct gz_door_limits limits[GZ_DOOR_PLACES];
	size_t door_count;
	struct guarded_door
		doors[WAYS * (1 + GZ_GUARD_SOCKETS_MAX)]; /* the first are the readers' */
};

uint32_t gz_connections_count(const struct gz_connections *connections)
{
	return atomic_load_explicit(&connections->count, memory_order_relaxed);
}

uint32_t gz_connections_listening(const struct gz_connections *connections)
{
	uint32_t count = gz_connections_count(connections), quiet = 0;
	for (int way = 0; way < WAYS; way++) {
		if (connections->channels[way] > 0)
			quiet += gz_door_quiet(connections->doors[way], connections->channels[way]);
	}
	return count > quiet ? count - quiet : 0;
}

/* Whether @p notice about @p address may be logged now. Fills @p more with " (12 more times since
 * the last message)", or with nothing. */
static bool log_permitted(struct gz_guard *guard, const char *address, enum notice notice,
			  char *more, size_t size)
{
	uint64_t dropped;
	if (!gz_address_limit_pass(&guard->told, address, notice, gz_clock_now_ns(), &dropped))
		return false;
	more[0] = '\0';
	if (dropped > 0)
		snprintf(more, size, " (%llu more times since the last message)",
			 (unsigned long long)dropped);
	return true;
}

/* Whether the client's key is authorised; logs the decision. */
static bool is_admitted(struct gz_guard *guard, const struct gz_zap_request *request)
{
	char more[64];
	const struct gz_known_key *known =
		gz_authorized_keys_find(&guard->authorized, request->key);
	if (!log_permitted(guard, request->address, known ? LET_IN : UNKNOWN_KEY, more,
			   sizeof more))
		return known != NULL;
	if (known)
		gz_info(guard->log, "%s is let in with the key of \"%s\"%s", request->address,
			known->name[0] ? known->name : request->key, more);
	else
		gz_warn(guard->log,
			"%s is refused: its key is not in %s; to let it in, add this line there: "
			"%s%s",
			request->address, guard->authorized.path, request->key, more);
	return known != NULL;
}

static void send_text(void *socket, const char *text, bool more)
{
	zmq_send(socket, text, strlen(text), ZMQ_DONTWAIT | (more ? ZMQ_SNDMORE : 0));
}

/* RFC 27: version, request id, status code, status text, user id, metadata. */
static void send_zap_reply(struct gz_guard *guard, const struct gz_zap_request *request,
			   const char *code, const char *text)
{
	send_text(guard->zap, "1.0", true);
	zmq_send(guard->zap, request->id, request->id_size, ZMQ_DONTWAIT | ZMQ_SNDMORE);
	send_text(guard->zap, code, true);
	send_text(guard->zap, text, true);
	send_text(guard->zap, "", true);
	send_text(guard->zap, "", false);
}

/* Answer one request. @return whether there was one */
static bool answer_zap_request(struct gz_guard *guard)
{
	zmq_msg_t messages[GZ_ZAP_FRAMES + 1]; /* the last one takes all surplus frames */
	struct gz_zap_frame frames[GZ_ZAP_FRAMES + 1];
	struct gz_zap_request request;
	size_t count = 0;
	bool more = true;
	for (int i = 0; i <= GZ_ZAP_FRAMES; i++)
		zmq_msg_init(&messages[i]);
	while (more) {
		size_t i = count < GZ_ZAP_FRAMES ? count : GZ_ZAP_FRAMES;
		if (zmq_msg_recv(&messages[i], guard->zap, ZMQ_DONTWAIT) < 0)
			break;
		more = zmq_msg_more(&messages[i]) != 0;
		frames[i] = (struct gz_zap_frame) { zmq_msg_data(&messages[i]),
						    zmq_msg_size(&messages[i]) };
		count = i + 1;
	}
	if (count > 0) {
		enum gz_result result = gz_zap_parse(frames, count, &request);
		bool welcome = result == GZ_OK && is_admitted(guard, &request);
		send_zap_reply(guard, &request, welcome ? "200" : "400",
			       welcome ? "OK" : "this key is not authorised");
	}
	for (int i = 0; i <= GZ_ZAP_FRAMES; i++)
		zmq_msg_close(&messages[i]);
	return count > 0;
}

static struct peer *find_peer(struct gz_connections *connections, int fd)
{
	for (int i = 0; i < PEERS_MAX; i++) {
		if (connections->peers[i].fd == fd)
			return &connections->peers[i];
	}
	return NULL;
}

/* The address of the other end; false for a local connection and for one that has closed. */
static bool peer_address(int fd, char *text, size_t size)
{
	struct sockaddr_storage peer = { 0 };
	socklen_t length = sizeof peer;
	if (getpeername(fd, (struct sockaddr *)&peer, &length) != 0)
		return false;
	const void *address = NULL;
	if (peer.ss_family == AF_INET)
		address = &((const struct sockaddr_in *)&peer)->sin_addr;
	else if (peer.ss_family == AF_INET6)
		address = &((const struct sockaddr_in6 *)&peer)->sin6_addr;
	return address && inet_ntop(peer.ss_family, address, text, (socklen_t)size) != NULL;
}

static void peer_arrived(struct gz_connections *connections, int fd)
{
	atomic_fetch_add_explicit(&connections->count, 1, memory_order_relaxed);
	gz_quota_arrived(connections->guard->quota, fd, connections, connections->of_readers,
			 gz_clock_now_ns());
	if (!connections->guard->zap)
		return;
	char address[GZ_ADDRESS_SIZE];
	struct peer *peer = find_peer(connections, fd);
	/* Replace the oldest, whose handshake is over. */
	if (!peer)
		peer = &connections->peers[connections->next_peer++ % PEERS_MAX];
	peer->fd = -1;
	if (!peer_address(fd, address, sizeof address))
		return;
	peer->fd = fd;
	memcpy(peer->address, address, sizeof address);
}

static void log_handshake_failure(struct gz_connections *connections, const char *address)
{
	const struct gz_log *log = connections->guard->log;
	const char *name = connections->name;
	char more[64];
	if (!log_permitted(connections->guard, address, connections->failure, more, sizeof more))
		return;
	if (connections->failure == WRONG_SERVER_KEY)
		gz_warn(log,
			"%s at socket %s is refused: it has the key of another server; give it the "
			"line that gazectl keygen --server prints here%s",
			address, name, more);
	else if (connections->failure == WITHOUT_KEYS)
		gz_warn(log,
			"%s at socket %s is refused: it has no keys; run gazectl keygen --client "
			"there%s",
			address, name, more);
	else /* no refusal: a client that changes its mind does so too */
		gz_info(log, "%s at socket %s does not finish the handshake%s", address, name,
			more);
}

static void peer_left(struct gz_connections *connections, int fd)
{
	struct peer *peer = find_peer(connections, fd);
	gz_quota_left(connections->guard->quota, fd, connections);
	gz_accept_ended(fd);
	if (connections->guard->left++ == 0)
		connections->guard->left_ns = gz_clock_now_ns();
	if (gz_connections_count(connections) > 0)
		atomic_fetch_sub_explicit(&connections->count, 1, memory_order_relaxed);
	if (connections->failing)
		log_handshake_failure(connections, peer ? peer->address : "an unknown address");
	connections->failing = false;
	if (peer)
		peer->fd = -1;
}

static void handshake_failed(struct gz_connections *connections, enum notice failure)
{
	connections->failing = true;
	connections->failure = failure;
}

/* Take one event: a frame of u16 number and u32 value in the host's byte order, and a frame with
 * the socket's own address (zmq_socket_monitor(3)). libzmq's only I/O thread reports a failed
 * handshake and the end of that connection with no other event between them.
 *
 * A client may close the connection before libzmq has read what it sent: then libzmq finds no
 * fault, only the end (NO_DETAIL). So does a local client that gives up; it needs no keys, and
 * nothing is logged. @return whether there was an event */
static bool take_monitor_event(struct gz_connections *connections)
{
	static const char tcp[] = { 't', 'c', 'p', ':' };
	unsigned char frame[6];
	char address[sizeof tcp] = "";
	if (zmq_recv(connections->monitor, frame, sizeof frame, ZMQ_DONTWAIT) != sizeof frame)
		return false;
	uint16_t event;
	int32_t value;
	memcpy(&event, frame, sizeof event);
	memcpy(&value, frame + sizeof event, sizeof value);
	zmq_recv(connections->monitor, address, sizeof address, ZMQ_DONTWAIT);
	if (event == ZMQ_EVENT_ACCEPTED)
		peer_arrived(connections, value);
	else if (event == ZMQ_EVENT_DISCONNECTED)
		peer_left(connections, value);
	else if (event == ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL)
		handshake_failed(connections, value == ZMQ_PROTOCOL_ERROR_ZMTP_CRYPTOGRAPHIC
						      ? WRONG_SERVER_KEY
						      : WITHOUT_KEYS);
	else if (event == ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL &&
		 memcmp(address, tcp, sizeof tcp) == 0)
		handshake_failed(connections, LEFT);
	return true;
}

static void take_pending(struct gz_guard *guard)
{
	bool more = true;
	for (int i = 0; more && i < AT_ONCE; i++) {
		more = guard->zap && answer_zap_request(guard);
		for (size_t s = 0; s < guard->socket_count; s++)
			more = take_monitor_event(&guard->sockets[s]) || more;
	}
}

/* How many connections the doors of @p kind have refused or ended. */
static uint64_t refused_at_doors(const struct gz_guard *guard, enum gz_door_kind kind,
				 enum gz_quota_reason reason)
{
	uint64_t refused = 0;
	for (size_t i = 0; i < guard->door_count; i++) {
		if (guard->doors[i].kind == kind)
			refused += gz_door_refused(guard->doors[i].door, reason);
	}
	return refused;
}

/* A door cannot log by itself: it is asked by the thread that serves all connections. */
static void log_refused_at_door(struct gz_guard *guard, struct guarded_door *door,
				enum gz_quota_reason reason)
{
	static const char *const clients[] = {
		[GZ_DOOR_READERS] = "readers", [GZ_DOOR_SENDERS] = "clients"
	};
	static const char *const places[] = { [GZ_DOOR_OPEN] = "over TCP",
					      [GZ_DOOR_LOCAL] = "at a local socket",
					      [GZ_DOOR_KEYS] = "with keys" };
	static const char *const texts[2][GZ_QUOTA_REASON_COUNT] = {
		[GZ_DOOR_READERS] = { "there are too many, or too many come at a time",
				      "they sent too many subscriptions" },
		[GZ_DOOR_SENDERS] = { "there are too many, or too many come at a time",
				      "they sent too much at once" },
	};
	uint64_t held_back, refused = gz_door_refused(door->door, reason);
	if (refused == door->told[reason] ||
	    !gz_ratelimit_pass(&door->complaints[reason], gz_clock_now_ns(), REFUSED_AT_DOOR_NS,
			       &held_back))
		return;
	gz_warn(guard->log, "client bug: the connections of %llu %s %s are closed, because %s",
		(unsigned long long)(refused - door->told[reason]), clients[door->kind],
		places[door->place], texts[door->kind][reason]);
	door->told[reason] = refused;
}

static void log_refused_at_doors(struct gz_guard *guard)
{
	for (size_t i = 0; i < guard->door_count; i++) {
		for (int reason = 0; reason < GZ_QUOTA_REASON_COUNT; reason++)
			log_refused_at_door(guard, &guard->doors[i], (enum gz_quota_reason)reason);
	}
}

/* The C library keeps what connections have freed, between what is in use: 53 MiB after an attack
 * at the inlet, 18 MiB with this (measured). */
static void give_memory_back(struct gz_guard *guard)
{
	if (guard->left < ENDED_BEFORE_TRIM || gz_clock_now_ns() - guard->left_ns < TRIM_AFTER_NS)
		return;
	guard->left = 0;
	malloc_trim(0);
}

static void *guard_run(void *user)
{
	struct gz_guard *guard = user;
	pthread_setname_np(pthread_self(), "gazed-guard");
	zmq_pollitem_t items[3 + GZ_GUARD_SOCKETS_MAX];
	int count = 0;
	items[count++] = (zmq_pollitem_t) { .fd = guard->quit_fd, .events = ZMQ_POLLIN };
	items[count++] = (zmq_pollitem_t) { .fd = gz_quota_fd(guard->quota), .events = ZMQ_POLLIN };
	for (size_t i = 0; i < guard->socket_count; i++)
		items[count++] = (zmq_pollitem_t) { .socket = guard->sockets[i].monitor,
						    .events = ZMQ_POLLIN };
	if (guard->zap)
		items[count++] = (zmq_pollitem_t) { .socket = guard->zap, .events = ZMQ_POLLIN };
	for (;;) {
		bool waits = gz_quota_count(guard->quota) > 0 || guard->left >= ENDED_BEFORE_TRIM;
		long wait_ms = waits ? GZ_QUOTA_CHECK_MS : -1;
		if (zmq_poll(items, count, wait_ms) < 0 && errno != EINTR)
			return NULL;
		if (items[0].revents)
			break;
		gz_quota_check(guard->quota, gz_clock_now_ns());
		take_pending(guard);
		log_refused_at_doors(guard);
		give_memory_back(guard);
	}
	log_refused_at_doors(guard);
	return NULL;
}

static void set_guard_option(void *socket, int option, int value)
{
	zmq_setsockopt(socket, option, &value, sizeof value);
}

static enum gz_result open_zap(struct gz_guard *guard, const char *authorized_keys)
{
	enum gz_result result =
		gz_authorized_keys_open(&guard->authorized, authorized_keys, guard->log);
	if (result != GZ_OK)
		return result;
	guard->zap = zmq_socket(guard->context, ZMQ_REP);
	if (guard->zap)
		set_guard_option(guard->zap, ZMQ_LINGER, 0);
	if (guard->zap && zmq_bind(guard->zap, ZAP_ENDPOINT) == 0)
		return GZ_OK;
	gz_err(guard->log, "cannot open the authentication socket: %s", zmq_strerror(errno));
	return GZ_ERR_IO;
}

/* Make the doors of clients over TCP and at local sockets. */
static enum gz_result make_doors(struct gz_guard *guard, enum gz_door_kind kind,
				 struct gz_door *doors[WAYS])
{
	const enum gz_door_place places[WAYS] = {
		[BY_TCP] = guard->zap ? GZ_DOOR_KEYS : GZ_DOOR_OPEN, [LOCALLY] = GZ_DOOR_LOCAL
	};
	for (int way = 0; way < WAYS; way++) {
		enum gz_result result =
			gz_door_create(kind, places[way], &guard->limits[places[way]], &doors[way]);
		if (result != GZ_OK)
			return result;
		guard->doors[guard->door_count++] = (struct guarded_door) { .door = doors[way],
									    .kind = kind,
									    .place = places[way] };
	}
	return GZ_OK;
}

enum gz_result gz_guard_create(void *context, const char *authorized_keys,
			       const struct gz_door_limits limits[GZ_DOOR_PLACES],
			       const struct gz_log *log, struct gz_guard **out_guard)
{
	struct gz_guard *guard = calloc(1, sizeof *guard);
	if (!guard)
		return GZ_ERR_NO_MEM;
	guard->context = context;
	guard->log = log;
	for (int place = 0; place < GZ_DOOR_PLACES; place++)
		guard->limits[place] =
			limits ? limits[place] : gz_door_usual_limits((enum gz_door_place)place);
	guard->quit_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	enum gz_result result = guard->quit_fd >= 0 ? GZ_OK : GZ_ERR_NO_MEM;
	struct gz_door *doors[WAYS];
	if (result == GZ_OK && authorized_keys)
		result = open_zap(guard, authorized_keys);
	if (result == GZ_OK)
		result = make_doors(guard, GZ_DOOR_READERS, doors);
	if (result != GZ_OK) {
		gz_guard_destroy(&guard);
		return result;
	}
	*out_guard = guard;
	return GZ_OK;
}

static bool publishes(void *socket)
{
	int type = 0;
	size_t size = sizeof type;
	return zmq_getsockopt(socket, ZMQ_TYPE, &type, &size) == 0 &&
	       (type == ZMQ_PUB || type == ZMQ_XPUB);
}

/* The monitor reports connections; it must listen before the socket is bound. */
enum gz_result gz_guard_watch(struct gz_guard *guard, void *socket, const char *name,
			      struct gz_connections **out_connections)
{
	char endpoint[64];
	if (guard->socket_count == GZ_GUARD_SOCKETS_MAX)
		return GZ_ERR_FULL;
	struct gz_connections *connections = &guard->sockets[guard->socket_count++];
	connections->guard = guard;
	connections->name = name;
	connections->of_readers = publishes(socket);
	for (int way = 0; way < WAYS; way++)
		connections->doors[way] = guard->doors[way].door; /* the readers' */
	enum gz_result result = connections->of_readers
					? GZ_OK
					: make_doors(guard, GZ_DOOR_SENDERS, connections->doors);
	if (result != GZ_OK)
		return result;
	for (int i = 0; i < PEERS_MAX; i++)
		connections->peers[i].fd = -1;
	connections->monitor = zmq_socket(guard->context, ZMQ_PAIR);
	int events = ZMQ_EVENT_ACCEPTED | ZMQ_EVENT_DISCONNECTED;
	if (guard->zap)
		events |=
			ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL | ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL;
	snprintf(endpoint, sizeof endpoint, "inproc://monitor-%s", name);
	if (connections->monitor) {
		set_guard_option(connections->monitor, ZMQ_LINGER, 0);
		/* No limit: a full queue would block libzmq's I/O thread, and with it every
		 * reader. */
		set_guard_option(connections->monitor, ZMQ_RCVHWM, 0);
	}
	if (!connections->monitor || zmq_socket_monitor(socket, endpoint, events) != 0 ||
	    zmq_connect(connections->monitor, endpoint) != 0) {
		gz_err(guard->log, "cannot monitor socket %s: %s", name, zmq_strerror(errno));
		return GZ_ERR_IO;
	}
	*out_connections = connections;
	return GZ_OK;
}

enum gz_result gz_guard_start(struct gz_guard *guard)
{
	uint32_t connections = gz_quota_connections_possible();
	if (!gz_accept_is_found())
		gz_warn(guard->log, "libzmq does not find the program's accept4() and recv(); if "
				    "file descriptors run out, it may end the program, and "
				    "many readers may hold the stream");
	if (gz_quota_create(connections, guard->log, &guard->quota) != GZ_OK) {
		gz_err(guard->log, "no memory for %u connections", connections);
		return GZ_ERR_NO_MEM;
	}
	if (pthread_create(&guard->thread, NULL, guard_run, guard) != 0) {
		gz_err(guard->log, "cannot start the authentication thread: %s", strerror(errno));
		return GZ_ERR_NO_MEM;
	}
	guard->has_thread = true;
	return GZ_OK;
}

uint64_t gz_guard_ended(const struct gz_guard *guard, enum gz_quota_reason reason)
{
	uint64_t ended = guard->quota ? gz_quota_ended(guard->quota, reason) : 0;
	if (reason == GZ_QUOTA_TOO_MANY)
		ended += refused_at_doors(guard, GZ_DOOR_SENDERS, GZ_QUOTA_TOO_MANY) +
			 refused_at_doors(guard, GZ_DOOR_SENDERS, GZ_QUOTA_TOO_LARGE);
	return ended + refused_at_doors(guard, GZ_DOOR_READERS, reason);
}

void gz_guard_open_door(struct gz_connections *connections, int port)
{
	connections->channels[BY_TCP] =
		gz_accept_through(connections->doors[BY_TCP], (uint16_t)port);
}

void gz_guard_open_local_door(struct gz_connections *connections, const char *path)
{
	connections->channels[LOCALLY] = gz_accept_through_path(connections->doors[LOCALLY], path);
}

void gz_connections_took(const struct gz_connections *connections, zmq_msg_t *frame)
{
	int channel = gz_accept_channel(zmq_msg_get(frame, ZMQ_SRCFD));
	for (int way = 0; way < WAYS; way++) {
		if (channel > 0 && channel == connections->channels[way])
			gz_door_took(connections->doors[way], zmq_msg_size(frame));
	}
}

void gz_connections_emptied(const struct gz_connections *connections)
{
	for (int way = 0; way < WAYS; way++)
		gz_door_emptied(connections->doors[way]);
}

void gz_guard_know_topic(struct gz_guard *guard, const char *topic)
{
	for (int way = 0; way < WAYS; way++)
		gz_door_know(guard->doors[way].door, topic);
}

void gz_guard_destroy(struct gz_guard **guard)
{
	if (!guard || !*guard)
		return;
	struct gz_guard *g = *guard;
	uint64_t one = 1;
	if (g->has_thread && write(g->quit_fd, &one, sizeof one) == sizeof one)
		pthread_join(g->thread, NULL);
	for (size_t i = 0; i < g->socket_count; i++) {
		if (g->sockets[i].monitor)
			zmq_close(g->sockets[i].monitor);
	}
	if (g->zap)
		zmq_close(g->zap);
	if (g->quit_fd >= 0)
		close(g->quit_fd);
	gz_quota_destroy(&g->quota);
	gz_accept_freely();
	for (size_t i = 0; i < g->door_count; i++)
		gz_door_destroy(&g->doors[i].door);
	free(g);
	*guard = NULL;
}
