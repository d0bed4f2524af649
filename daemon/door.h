/**
 * @file
 * The doors through which clients come: for each place (local sockets; TCP) one for readers, and
 * one for each socket that takes messages. What clients send is counted before libzmq takes it.
 *
 * Readers: libzmq 4.3.4 keeps all subscriptions of a socket in one tree with a node for each byte.
 * When a connection ends, it walks the whole tree in the thread of the stream: connections times
 * bytes. So what is in the tree, how many connections there are and how many come in a second is
 * limited, such that the walks take a fraction of that thread. Topics that the daemon sends share
 * their nodes and cost nothing; others are strange. A reader that subscribes to what the daemon
 * sends comes in whatever strange ones do.
 *
 * Senders: libzmq keeps messages until the daemon takes them, and limits their number and the size
 * of a frame for each connection, not bytes, frames of a message, or connections. The door limits
 * these: what libzmq holds is what has passed less what the daemon has taken.
 *
 * Clients with keys: what they send is encrypted, so the door sees the size of each message, not
 * what it is. Whatever is longer than a heartbeat counts as a strange topic. A client that has not
 * proved its key takes nothing of what clients share; libzmq ends it when its handshake fails.
 *
 * The limits hold without a race, because accept.h asks in the middle of libzmq's own calls.
 */
#ifndef GZ_DAEMON_DOOR_H
#define GZ_DAEMON_DOOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "daemon/quota.h"

/** Who comes through a door. */
enum gz_door_kind {
	GZ_DOOR_READERS, /**< they subscribe and get messages */
	GZ_DOOR_SENDERS, /**< they send messages: of the inlet, or requests */
};

/** From where clients come. */
enum gz_door_place {
	GZ_DOOR_OPEN,  /**< over TCP without keys */
	GZ_DOOR_LOCAL, /**< local sockets */
	GZ_DOOR_KEYS,  /**< over TCP with keys */
	GZ_DOOR_PLACES,
};

/** Limits that depend on the place. */
struct gz_door_limits {
	uint32_t connections;  /**< of a door, as GZ_DOOR_CONNECTIONS */
	uint32_t strange;      /**< as GZ_DOOR_STRANGE */
	uint32_t strange_each; /**< as GZ_DOOR_STRANGE_EACH */
	uint32_t reader_cost;  /**< as GZ_DOOR_READER_COST */
};

/** The usual limits of a place. */
struct gz_door_limits gz_door_usual_limits(enum gz_door_place place);

/** The same numbers for clients of the daemon's user or group and for clients with keys. Chosen:
 * four times as many connections, and what readers.h allows one reader; walks take up to 2 ms then.
 */
#define GZ_DOOR_TRUSTED_CONNECTIONS  1024
#define GZ_DOOR_TRUSTED_STRANGE      16384
#define GZ_DOOR_TRUSTED_STRANGE_EACH 4096
#define GZ_DOOR_TRUSTED_READER_COST  4096

/** What CURVE adds to a message (RFC 26): the command's name, a nonce, a code and the flags. */
#define GZ_DOOR_SEAL_SIZE (8 + 8 + 16 + 1)

/** Longest heartbeat, bytes without the seal (RFC 37: "PING" with its time to live and a context of
 * ours, which is empty). */
#define GZ_DOOR_HEARTBEAT_SIZE 16

/** Most connections of a door over TCP without keys. If a further one comes, an old one is ended:
 * one that has not subscribed to anything the daemon sends, or as a sender not finished the
 * handshake, for GZ_DOOR_HANDSHAKE_MS, else one that does not read what it is sent, the oldest of
 * each first; else the sender that has sent nothing for the longest time, at least GZ_DOOR_IDLE_MS;
 * else the oldest that came later than GZ_DOOR_NEW_MS before the house became full and has proved
 * no key. If there is none of these, the new one is refused. Chosen: a laboratory has some tens,
 * and the stream at 1000 Hz can serve these. */
#define GZ_DOOR_CONNECTIONS 256

/** How long a client may take to do so, ms, if others want its place. Chosen: a hundred times
 * what a reader on this machine needs. */
#define GZ_DOOR_HANDSHAKE_MS 250

/** How long before that a reader must have come to keep its place, ms. Those that come in a flood
 * replace each other, so that they do not keep others out. Chosen. */
#define GZ_DOOR_NEW_MS 1000

/** How long a sender must have sent nothing to lose its place, ms. libzmq's clients connect again
 * when they have something to send. Chosen. */
#define GZ_DOOR_IDLE_MS 5000

/** How long nobody must have come to a full house for it to count as not full, ms. Chosen. */
#define GZ_DOOR_CALM_MS 5000

/** Most bytes of strange topics of all connections, and of one. A connection that has ended counts
 * until GZ_DOOR_STRANGE_PER_S of all has passed, because libzmq lags behind. A topic counts with
 * its frame, and its end does not give it back. Chosen: a laboratory's programs may have fifty of
 * their own. */
#define GZ_DOOR_STRANGE       2048
#define GZ_DOOR_STRANGE_EACH  1024
#define GZ_DOOR_STRANGE_PER_S 2048

/** A connection that comes costs the nodes that libzmq walks when it ends: those of known topics,
 * with the rest of what a connection costs, and the present strange ones. Chosen: some more than
 * all known topics have. */
#define GZ_DOOR_KNOWN_NODES 1024

/** Most nodes that connections may cost in a second, and at once. Chosen: a walk takes about 0.1 us
 * for each (measured), so a tenth of the stream's thread, and 50 ms. Without strange topics 512
 * connections may come at once and 1000 in each second; with all that are allowed, a third. */
#define GZ_DOOR_NODES_PER_S (1024 * GZ_DOOR_KNOWN_NODES)
#define GZ_DOOR_NODES       (512 * GZ_DOOR_KNOWN_NODES)

/** What each message of a reader costs besides its bytes. Chosen: the stream's thread needs some
 * microseconds for it. */
#define GZ_DOOR_MESSAGE_COST 32

/** Bytes and costs that a reader has for itself, at once and for each second. Chosen: twenty
 * subscriptions; three heartbeats a second. */
#define GZ_DOOR_READER_COST       1024
#define GZ_DOOR_READER_COST_PER_S 128

/** What all readers share beyond that. Chosen: twelve readers with a hundred subscriptions each may
 * come at once. */
#define GZ_DOOR_SHARED_COST       65536
#define GZ_DOOR_SHARED_COST_PER_S 16384

/** Most bytes of messages that libzmq holds of all senders of a door, each frame with
 * GZ_DOOR_FRAME_COST. Chosen: seven senders that each have a queue full of the largest messages. */
#define GZ_DOOR_HELD (32 * 1024 * 1024)

/** What a sender has for itself beyond that, bytes at once and for each second. Chosen: a hundred
 * annotations at once, and fifty a second. */
#define GZ_DOOR_SENDER_BYTES       32768
#define GZ_DOOR_SENDER_BYTES_PER_S 16384

/** What each frame costs besides its bytes: zmq_msg_t. */
#define GZ_DOOR_FRAME_COST 64

/** Most bytes of one message, counted like that. Chosen: the largest request with its envelope. */
#define GZ_DOOR_MESSAGE_MAX (80 * 1024)

/** Channels of a door: sockets at which its clients come. Each has a number below this. */
#define GZ_DOOR_CHANNELS 16

/** Most topics that gz_door_know() keeps. */
#define GZ_DOOR_TOPICS_MAX 64

/** A door. One thread at a time, except for gz_door_took(), gz_door_emptied(), gz_door_quiet() and
 * gz_door_refused(). */
struct gz_door;

/**
 * Create a door without connections. One for readers knows the topics of the protocol.
 *
 * @param limits  copied; NULL: the usual ones
 * @param[out] out_door  owned by the caller: gz_door_destroy()
 * @retval GZ_ERR_NO_MEM  no memory
 */
enum gz_result gz_door_create(enum gz_door_kind kind, enum gz_door_place place,
			      const struct gz_door_limits *limits, struct gz_door **out_door);

/** Know a further topic that the daemon sends. Beyond GZ_DOOR_TOPICS_MAX it stays strange. */
void gz_door_know(struct gz_door *door, const char *topic);

/**
 * A connection has come.
 *
 * @param fd        its descriptor
 * @param identity  gz_connection_identity() of it
 * @param channel   at which it came
 * @param now_ns    host time
 * @return whether it may stay; if not, the caller closes it
 */
bool gz_door_enter(struct gz_door *door, int fd, uint64_t identity, int channel, int64_t now_ns);

/**
 * A connection has sent something, which libzmq has not taken yet.
 *
 * @param fd, identity  as gz_door_enter(); a connection that did not come through the door may pass
 * @param bytes, size   untrusted
 * @param now_ns        host time
 * @return whether libzmq may take it; if not, the caller ends the connection, which is forgotten
 */
bool gz_door_pass(struct gz_door *door, int fd, uint64_t identity, const void *bytes, size_t size,
		  int64_t now_ns);

/** A connection has ended. Ignored if it did not come through the door. Those that end unnoticed
 * are found when there are too many. */
void gz_door_leave(struct gz_door *door, int fd, int64_t now_ns);

/** A connection may have ended: forget it, unless @p fd is still what came through the door. */
void gz_door_look(struct gz_door *door, int fd, int64_t now_ns);

/** How many present connections of a channel want no message: they have subscribed to nothing, or
 * to what they read at the board (board.h). Threads: any. */
uint32_t gz_door_quiet(const struct gz_door *door, int channel);

/** The daemon has taken a frame of @p size bytes, which a sender has sent, from libzmq. Threads:
 * any. */
void gz_door_took(struct gz_door *door, size_t size);

/** libzmq has no message of any sender. Threads: any. */
void gz_door_emptied(struct gz_door *door);

/** How many connections were refused or ended: TOO_MANY, TOO_LARGE. Threads: any. */
uint64_t gz_door_refused(const struct gz_door *door, enum gz_quota_reason reason);

/** Free and set to NULL. Accepts a pointer to NULL. */
void gz_door_destroy(struct gz_door **door);

#endif
