#include "daemon/door.h"

#include <linux/sockios.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>

#include "base/clock.h"
#include "daemon/zmtp_input.h"
#include "protocol/board/board.h"
#include "protocol/wire.h"

/* A reader with more unread bytes than this does not read. Chosen: a second of gaze; live readers
 * have none. */
enum { UNREAD_MAX = 16384 };

/* A quantity that runs out with time. */
struct leak {
	uint64_t level;
	int64_t since_ns;
};

struct visitor {
	uint64_t identity;
	int64_t arrived_ns;
	int64_t heard_ns; /* when it sent something last */
	uint64_t order;   /* of arrival */
	int channel;
	struct gz_zmtp_input input;
	uint64_t cost;
	uint64_t strange;
	bool useful;      /* has subscribed to what the daemon sends, or can send */
	bool wants;       /* messages, and not only those at the board */
	uint64_t unknown; /* bytes of a sender whose frames are not told apart */
	uint64_t message; /* bytes of a sender's unfinished message */
	struct leak own;  /* of what a sender has for itself */
};

struct gz_door {
	enum gz_door_kind kind;
	enum gz_door_place place;
	struct gz_door_limits limits;
	uint32_t count;
	int end; /* no visitor has had a descriptor from here on */
	uint64_t arrivals;
	uint64_t strange; /* of those that are present */
	int64_t full_ns;  /* when there was no room last */
	int64_t full_since_ns;
	struct leak arrived, settling, shared;
	_Atomic uint64_t held; /* of senders, by libzmq */
	_Atomic uint64_t refused[GZ_QUOTA_REASON_COUNT];
	_Atomic uint32_t quiet[GZ_DOOR_CHANNELS];
	size_t topic_count;
	char topics[GZ_DOOR_TOPICS_MAX][GZ_ZMTP_TOPIC_SIZE];
	bool present[GZ_QUOTA_DESCRIPTORS];
	struct visitor visitors[GZ_QUOTA_DESCRIPTORS];
};

/* Let pass what a second's @p per_s is in the time since the last call. */
static void leak_out(struct leak *leak, uint64_t per_s, int64_t now_ns)
{
	int64_t step_ns = now_ns - leak->since_ns;
	if (step_ns > 100 * GZ_NS_PER_S || leak->level == 0) {
		*leak = (struct leak) { .level = 0, .since_ns = now_ns };
		return;
	}
	uint64_t out = step_ns > 0 ? (uint64_t)step_ns * per_s / (uint64_t)GZ_NS_PER_S : 0;
	if (out == 0) /* steps of less than one add up */
		return;
	leak->level -= out < leak->level ? out : leak->level;
	leak->since_ns = now_ns;
}

struct gz_door_limits gz_door_usual_limits(enum gz_door_place place)
{
	if (place == GZ_DOOR_OPEN)
		return (struct gz_door_limits) { .connections = GZ_DOOR_CONNECTIONS,
						 .strange = GZ_DOOR_STRANGE,
						 .strange_each = GZ_DOOR_STRANGE_EACH,
						 .reader_cost = GZ_DOOR_READER_COST };
	return (struct gz_door_limits) { .connections = GZ_DOOR_TRUSTED_CONNECTIONS,
					 .strange = GZ_DOOR_TRUSTED_STRANGE,
					 .strange_each = GZ_DOOR_TRUSTED_STRANGE_EACH,
					 .reader_cost = GZ_DOOR_TRUSTED_READER_COST };
}

enum gz_result gz_door_create(enum gz_door_kind kind, enum gz_door_place place,
			      const struct gz_door_limits *limits, struct gz_door **out_door)
{
	/* Beginnings of what Pupil Capture sends are known too: its readers ask for them. */
	static const char *const known[] = {
		GZ_TOPIC_GAZE_BOTH,
		GZ_TOPIC_GAZE_RIGHT,
		GZ_TOPIC_GAZE_LEFT,
		"gaze.2d.01.",
		"gaze.2d.0.",
		"gaze.2d.1.",
		GZ_TOPIC_PUPIL_RIGHT,
		GZ_TOPIC_PUPIL_LEFT,
		"pupil.0.2d",
		"pupil.1.2d",
		GZ_TOPIC_SURFACES,
		GZ_TOPIC_FIXATIONS,
		GZ_TOPIC_BLINKS,
		GZ_TOPIC_SACCADES,
		GZ_TOPIC_STATUS,
		GZ_TOPIC_EVENT_FINAL,
		GZ_TOPIC_ANNOTATION,
		GZ_TOPIC_POINTER,
		GZ_TOPIC_WINDOW,
		GZ_TOPIC_NOTIFY,
		"remote_annotation",
		"logging.",
		"frame.world",
		(GZ_TOPIC_NOTIFY GZ_SUBJECT_RECORDING_STARTED),
		(GZ_TOPIC_NOTIFY GZ_SUBJECT_RECORDING_STOPPED),
		(GZ_TOPIC_NOTIFY GZ_SUBJECT_CALIBRATION_FAILED),
	};
	/* Untouched pages cost no memory. */
	struct gz_door *door = calloc(1, sizeof *door);
	if (!door)
		return GZ_ERR_NO_MEM;
	door->kind = kind;
	door->place = place;
	door->limits = limits ? *limits : gz_door_usual_limits(place);
	for (size_t i = 0; i < sizeof known / sizeof *known; i++)
		gz_door_know(door, known[i]);
	*out_door = door;
	return GZ_OK;
}

void gz_door_know(struct gz_door *door, const char *topic)
{
	if (door->topic_count < GZ_DOOR_TOPICS_MAX)
		snprintf(door->topics[door->topic_count++], GZ_ZMTP_TOPIC_SIZE, "%s", topic);
}

/* Whether the subscription tells what is read at the board. */
static bool is_for_board(const struct gz_zmtp_frame *frame)
{
	return frame->topic_size >= GZ_BOARD_TOPIC_SIZE &&
	       memcmp(frame->topic, GZ_BOARD_TOPIC, GZ_BOARD_TOPIC_SIZE) == 0;
}

/* Whether the subscription is the beginning of a topic that the daemon sends: its nodes are there
 * whoever subscribes. */
static bool is_known_topic(const struct gz_door *door, const struct gz_zmtp_frame *frame)
{
	const unsigned char *topic = frame->topic;
	size_t size = (size_t)frame->topic_size;
	if (frame->topic_size >= GZ_ZMTP_TOPIC_SIZE)
		return false;
	if (is_for_board(frame)) {
		topic += GZ_BOARD_TOPIC_SIZE;
		size -= GZ_BOARD_TOPIC_SIZE;
	}
	for (size_t i = 0; i < door->topic_count; i++) {
		if (strlen(door->topics[i]) >= size && memcmp(door->topics[i], topic, size) == 0)
			return true;
	}
	return false;
}

static void count_quiet(struct gz_door *door, const struct visitor *visitor, uint32_t step)
{
	atomic_fetch_add_explicit(&door->quiet[visitor->channel], step, memory_order_relaxed);
}

static void forget_visitor(struct gz_door *door, int fd, int64_t now_ns)
{
	struct visitor *visitor = &door->visitors[fd];
	if (!door->present[fd])
		return;
	if (!visitor->wants)
		count_quiet(door, visitor, UINT32_MAX); /* one less, modulo 2^32 */
	leak_out(&door->settling, GZ_DOOR_STRANGE_PER_S, now_ns);
	door->count--;
	door->strange -= visitor->strange;
	door->settling.level += visitor->strange;
	door->present[fd] = false;
}

static void note_refused(struct gz_door *door, enum gz_quota_reason reason)
{
	atomic_fetch_add_explicit(&door->refused[reason], 1, memory_order_relaxed);
}

static void sweep_visitors(struct gz_door *door, int64_t now_ns)
{
	for (int fd = 0; fd < door->end; fd++) {
		if (door->present[fd] && gz_connection_identity(fd) != door->visitors[fd].identity)
			forget_visitor(door, fd, now_ns);
	}
}

/* Why a connection is ended in favour of a new one; the first reason first. */
enum standing { USELESS, STALLED, IDLE, NEW, ESTABLISHED };

/* Whether clients prove who they are, and what they send is encrypted. */
static bool is_sealed(const struct gz_door *door)
{
	return door->place == GZ_DOOR_KEYS;
}

static enum standing standing_of(const struct gz_door *door, int fd, int64_t now_ns)
{
	const struct visitor *visitor = &door->visitors[fd];
	int unread = 0;
	if (!visitor->useful && now_ns - visitor->arrived_ns > GZ_DOOR_HANDSHAKE_MS * GZ_NS_PER_MS)
		return USELESS;
	if (ioctl(fd, SIOCOUTQ, &unread) == 0 && unread > UNREAD_MAX)
		return STALLED;
	if (door->kind == GZ_DOOR_SENDERS &&
	    now_ns - visitor->heard_ns > GZ_DOOR_IDLE_MS * GZ_NS_PER_MS)
		return IDLE;
	int64_t before_ns = door->full_since_ns - visitor->arrived_ns;
	bool is_known = is_sealed(door) || before_ns >= GZ_DOOR_NEW_MS * GZ_NS_PER_MS;
	return visitor->useful && is_known ? ESTABLISHED : NEW;
}

/* Whether of two connections of one standing the first is the one to end. */
static bool goes_before(const struct visitor *a, const struct visitor *b, enum standing standing)
{
	return standing == IDLE ? a->heard_ns < b->heard_ns : a->order < b->order;
}

/* The connection to end in favour of a new one. @return -1: none */
static int least_useful(const struct gz_door *door, int64_t now_ns)
{
	int found = -1;
	enum standing least = ESTABLISHED;
	for (int fd = 0; fd < door->end; fd++) {
		const struct visitor *visitor = &door->visitors[fd];
		if (!door->present[fd])
			continue;
		enum standing standing = standing_of(door, fd, now_ns);
		if (standing < least || (found >= 0 && standing == least &&
					 goes_before(visitor, &door->visitors[found], standing))) {
			found = fd;
			least = standing;
		}
	}
	return found;
}

/* @return whether there is room for one more */
static bool make_room(struct gz_door *door, int64_t now_ns)
{
	if (door->count < door->limits.connections)
		return true;
	sweep_visitors(door, now_ns);
	if (door->count < door->limits.connections)
		return true;
	if (door->full_ns == 0 || now_ns - door->full_ns > GZ_DOOR_CALM_MS * GZ_NS_PER_MS)
		door->full_since_ns = now_ns;
	door->full_ns = now_ns;
	int fd = least_useful(door, now_ns);
	if (fd < 0)
		return false;
	gz_connection_end(fd, door->visitors[fd].identity);
	forget_visitor(door, fd, now_ns);
	note_refused(door, GZ_QUOTA_TOO_MANY);
	return true;
}

/* Whether not too many have come lately. */
static bool may_arrive(struct gz_door *door, int64_t now_ns)
{
	leak_out(&door->arrived, GZ_DOOR_NODES_PER_S, now_ns);
	return door->arrived.level < GZ_DOOR_NODES;
}

/* Count the nodes that libzmq will walk when this one leaves. */
static void count_arrival(struct gz_door *door)
{
	door->arrived.level += GZ_DOOR_KNOWN_NODES + door->strange + door->settling.level;
}

bool gz_door_enter(struct gz_door *door, int fd, uint64_t identity, int channel, int64_t now_ns)
{
	bool has_place =
		fd >= 0 && fd < GZ_QUOTA_DESCRIPTORS && channel >= 0 && channel < GZ_DOOR_CHANNELS;
	if (has_place)
		forget_visitor(door, fd, now_ns);
	/* A client with a key arrives when the handshake is over: libzmq walks nothing before. */
	if (!has_place || (!is_sealed(door) && !may_arrive(door, now_ns)) ||
	    !make_room(door, now_ns)) {
		note_refused(door, GZ_QUOTA_TOO_MANY);
		return false;
	}
	if (!is_sealed(door))
		count_arrival(door);
	door->visitors[fd] = (struct visitor) { .identity = identity,
						.arrived_ns = now_ns,
						.heard_ns = now_ns,
						.order = door->arrivals++,
						.channel = channel };
	count_quiet(door, &door->visitors[fd], 1);
	door->present[fd] = true;
	door->count++;
	if (fd >= door->end)
		door->end = fd + 1;
	return true;
}

/* A frame of a reader with a key: after the handshake each one is a sealed message. */
static void charge_sealed_frame(struct visitor *visitor, const struct gz_zmtp_frame *frame)
{
	uint64_t content =
		frame->body_size > GZ_DOOR_SEAL_SIZE ? frame->body_size - GZ_DOOR_SEAL_SIZE : 0;
	visitor->cost += frame->size;
	if (frame->kind == GZ_ZMTP_COMMAND)
		return;
	visitor->cost += GZ_DOOR_MESSAGE_COST;
	visitor->useful = visitor->wants = true;
	if (frame->kind == GZ_ZMTP_UNKNOWN)
		visitor->strange += frame->size;
	else if (content > GZ_DOOR_HEARTBEAT_SIZE)
		visitor->strange += content;
}

static void charge_frame(const struct gz_door *door, struct visitor *visitor,
			 const struct gz_zmtp_frame *frame)
{
	visitor->wants = visitor->wants || frame->kind == GZ_ZMTP_UNKNOWN ||
			 (frame->kind == GZ_ZMTP_SUBSCRIBE && !is_for_board(frame));
	bool strange = frame->kind == GZ_ZMTP_UNKNOWN || frame->kind == GZ_ZMTP_SUBSCRIBE;
	visitor->cost += frame->size;
	if (frame->kind == GZ_ZMTP_SUBSCRIBE || frame->kind == GZ_ZMTP_MESSAGE)
		visitor->cost += GZ_DOOR_MESSAGE_COST;
	if (frame->kind == GZ_ZMTP_SUBSCRIBE && is_known_topic(door, frame)) {
		visitor->useful = true;
		strange = false;
	}
	if (strange)
		visitor->strange +=
			frame->kind == GZ_ZMTP_UNKNOWN ? frame->size : frame->topic_size + 1;
}

/* What of the visitor's cost is more than it has for itself. */
static uint64_t shared_cost(const struct gz_door *door, const struct visitor *visitor,
			    int64_t now_ns)
{
	int64_t age_s = (now_ns - visitor->arrived_ns) / GZ_NS_PER_S;
	uint64_t own = door->limits.reader_cost +
		       (age_s > 0 ? (uint64_t)age_s * GZ_DOOR_READER_COST_PER_S : 0);
	return visitor->cost > own ? visitor->cost - own : 0;
}

/* Whether the door has room for what the visitor has sent since it was @p before. */
static bool is_bearable(struct gz_door *door, const struct visitor *before, struct visitor *visitor,
			int64_t now_ns)
{
	uint64_t strange = visitor->strange - before->strange;
	uint64_t shared = shared_cost(door, visitor, now_ns);
	if (visitor->strange > door->limits.strange_each)
		return false;
	if (is_sealed(door) && !visitor->useful)
		return shared == 0;
	leak_out(&door->settling, GZ_DOOR_STRANGE_PER_S, now_ns);
	leak_out(&door->shared, GZ_DOOR_SHARED_COST_PER_S, now_ns);
	const uint64_t most = door->limits.strange;
	if (strange > 0 && door->strange + door->settling.level + strange > most) {
		sweep_visitors(door, now_ns);
		if (door->strange + door->settling.level + strange > most)
			return false;
	}
	if (shared > 0 && door->shared.level + shared > GZ_DOOR_SHARED_COST)
		return false;
	visitor->cost -= shared;
	door->shared.level += shared;
	door->strange += strange;
	return true;
}

/* @param[in,out] held  what libzmq will hold of it */
static void charge_sent_frame(const struct gz_door *door, struct visitor *visitor,
			      const struct gz_zmtp_frame *frame, uint64_t *held)
{
	/* Whoever sends a command has not proved a key yet. */
	if (!is_sealed(door) || frame->kind != GZ_ZMTP_COMMAND)
		visitor->useful = true;
	if (frame->kind == GZ_ZMTP_UNKNOWN)
		visitor->unknown += frame->size;
	if (frame->kind == GZ_ZMTP_UNKNOWN || frame->kind == GZ_ZMTP_COMMAND)
		return;
	*held += frame->body_size + GZ_DOOR_FRAME_COST;
	visitor->message += frame->body_size + GZ_DOOR_FRAME_COST;
	if (!frame->more)
		visitor->message = 0;
}

/* Whether libzmq may hold @p held bytes more, which the visitor has sent. */
static bool may_be_held(struct gz_door *door, struct visitor *visitor, uint64_t held,
			int64_t now_ns)
{
	leak_out(&visitor->own, GZ_DOOR_SENDER_BYTES_PER_S, now_ns);
	uint64_t own = visitor->own.level + held;
	uint64_t all = atomic_load_explicit(&door->held, memory_order_relaxed) + held;
	if (visitor->message > GZ_DOOR_MESSAGE_MAX ||
	    visitor->unknown > door->limits.strange_each ||
	    (all > GZ_DOOR_HELD && own > GZ_DOOR_SENDER_BYTES))
		return false;
	visitor->own.level = own < GZ_DOOR_SENDER_BYTES ? own : GZ_DOOR_SENDER_BYTES;
	atomic_fetch_add_explicit(&door->held, held, memory_order_relaxed);
	return true;
}

/* Read what the visitor has sent. @return whether libzmq may take it */
static bool admit_bytes(struct gz_door *door, struct visitor *visitor, const unsigned char *at,
			size_t size, int64_t now_ns)
{
	const struct visitor before = *visitor;
	struct gz_zmtp_frame frame;
	uint64_t held = 0;
	while (gz_zmtp_next(&visitor->input, &at, &size, &frame)) {
		if (door->kind == GZ_DOOR_SENDERS)
			charge_sent_frame(door, visitor, &frame, &held);
		else if (is_sealed(door))
			charge_sealed_frame(visitor, &frame);
		else
			charge_frame(door, visitor, &frame);
	}
	if (is_sealed(door) && visitor->useful && !before.useful) {
		if (!may_arrive(door, now_ns))
			return false;
		count_arrival(door);
	}
	return door->kind == GZ_DOOR_READERS ? is_bearable(door, &before, visitor, now_ns)
					     : may_be_held(door, visitor, held, now_ns);
}

bool gz_door_pass(struct gz_door *door, int fd, uint64_t identity, const void *bytes, size_t size,
		  int64_t now_ns)
{
	if (fd < 0 || fd >= GZ_QUOTA_DESCRIPTORS || !door->present[fd])
		return true;
	if (door->visitors[fd].identity != identity) {
		forget_visitor(door, fd, now_ns);
		return true;
	}
	struct visitor visitor = door->visitors[fd];
	visitor.heard_ns = now_ns;
	if (admit_bytes(door, &visitor, bytes, size, now_ns)) {
		if (visitor.wants && !door->visitors[fd].wants)
			count_quiet(door, &visitor, UINT32_MAX);
		door->visitors[fd] = visitor;
		return true;
	}
	forget_visitor(door, fd, now_ns);
	note_refused(door, GZ_QUOTA_TOO_LARGE);
	return false;
}

void gz_door_leave(struct gz_door *door, int fd, int64_t now_ns)
{
	if (fd >= 0 && fd < GZ_QUOTA_DESCRIPTORS)
		forget_visitor(door, fd, now_ns);
}

void gz_door_look(struct gz_door *door, int fd, int64_t now_ns)
{
	if (fd >= 0 && fd < GZ_QUOTA_DESCRIPTORS && door->present[fd] &&
	    gz_connection_identity(fd) != door->visitors[fd].identity)
		forget_visitor(door, fd, now_ns);
}

uint32_t gz_door_quiet(const struct gz_door *door, int channel)
{
	return atomic_load_explicit(&door->quiet[channel], memory_order_relaxed);
}

void gz_door_took(struct gz_door *door, size_t size)
{
	uint64_t held = atomic_load_explicit(&door->held, memory_order_relaxed), rest;
	do {
		uint64_t part = (uint64_t)size + GZ_DOOR_FRAME_COST;
		rest = held > part ? held - part : 0;
	} while (!atomic_compare_exchange_weak(&door->held, &held, rest));
}

void gz_door_emptied(struct gz_door *door)
{
	atomic_store_explicit(&door->held, 0, memory_order_relaxed);
}

uint64_t gz_door_refused(const struct gz_door *door, enum gz_quota_reason reason)
{
	return atomic_load_explicit(&door->refused[reason], memory_order_relaxed);
}

void gz_door_destroy(struct gz_door **door)
{
	if (!door || !*door)
		return;
	free(*door);
	*door = NULL;
}
