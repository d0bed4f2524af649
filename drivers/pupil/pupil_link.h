/**
 * @file
 * The sockets to Pupil Capture or to another gazed: requests to Pupil Remote, and the stream.
 *
 * Requests never hold up the stream: one at a time is sent, and its answer is read when it comes.
 * The first one asks for the port of the stream, which changes each time Pupil Capture starts; the
 * others compare the clocks (pupil_clock.h).
 *
 * Another gazed on another machine, which serves with `tcp = curve`, needs keys: its public key, by
 * its host, is in `known_servers`, ours is in `client_key` (docs/man/gazectl.1, keygen). Pupil
 * Capture has none.
 */
#ifndef GZ_DRIVERS_PUPIL_LINK_H
#define GZ_DRIVERS_PUPIL_LINK_H

#include <stdbool.h>
#include <stdint.h>
#include <zmq.h>

#include "base/log.h"
#include "base/result.h"
#include "drivers/pupil/pupil_clock.h"
#include "protocol/endpoint.h"
#include "protocol/gaze.h"
#include "protocol/key.h"

/** Time between two rounds of clock comparison, ns (Pupil's network_time_sync.py). */
#define GZ_PUPIL_ROUND_NS INT64_C(10000000000)

/** Longest wait for an answer, ms. Chosen: Pupil Remote answers within some ms. */
#define GZ_PUPIL_PATIENCE_MS 500

/** Time between two requests for the port while the stream is silent, ms. */
#define GZ_PUPIL_SILENCE_MS 500

/** Largest message that is accepted, bytes; libzmq disconnects a peer that sends a larger one.
 * Chosen: a surface message with a second of Pupil Core's gaze has some 80 kB. */
#define GZ_PUPIL_MESSAGE_MAX 262144

/** Bytes of a topic prefix with its NUL. */
#define GZ_PUPIL_TOPIC_SIZE 96

/** The request whose answer the link waits for. */
enum gz_pupil_request {
	GZ_PUPIL_REQUEST_NONE,
	GZ_PUPIL_REQUEST_PORT,
	GZ_PUPIL_REQUEST_TIME,
};

/** Keys of a connection. */
struct gz_pupil_keys {
	struct gz_key_pair own;
	char server[GZ_KEY_TEXT_SIZE]; /**< public key of the other gazed; empty: no keys are used
					*/
};

/** A link. Zero-initialised is none; gz_pupil_link_open() fills it. */
struct gz_pupil_link {
	const struct gz_log *log;
	void *context;
	void *control; /**< DEALER, because a REQ socket is stuck if an answer does not come */
	void *stream;  /**< SUB; NULL before gz_pupil_link_subscribe() */
	char address[GZ_ENDPOINT_SIZE];
	struct gz_pupil_keys keys;
	char topics[2][GZ_PUPIL_TOPIC_SIZE]; /**< "" for none */
	int port;                            /**< of the stream; 0 while unknown */
	struct gz_pupil_clock clock;
	bool in_round;
	enum gz_pupil_request request;
	int64_t sent_ns;
	int64_t next_round_ns;
	int64_t next_port_ns;
	int64_t heard_ns; /**< newest message of the stream, or start of the subscription */
	int unanswered;   /**< unanswered requests in a row */
	uint64_t jumps;   /**< how often Pupil's clock was set */
	bool told_reply;  /**< the log says that an answer was not a port */
};

/** Whether @p address is "tcp://HOST:PORT" with a port of 1 to 65535, and short enough. */
bool gz_pupil_address_valid(const char *address);

/**
 * Connect to Pupil Remote, with keys if the other gazed has one in `known_servers`, and wait for
 * the port of the stream.
 *
 * @param address     valid by gz_pupil_address_valid()
 * @param timeout_ms  longest wait for the port
 * @param log         borrowed, outlives the link; may be NULL
 * @retval GZ_ERR_NO_DEVICE  no answer within @p timeout_ms, or none with a port; logged
 * @retval GZ_ERR_NO_MEM, GZ_ERR_INVAL  logged
 * @retval GZ_ERR_ACCESS  the other's key is known and ours is missing, or a key file is unsafe;
 *                        logged with the remedy
 * @retval GZ_ERR_FORMAT, GZ_ERR_IO, GZ_ERR_FULL  a key file cannot be read; logged
 */
enum gz_result gz_pupil_link_open(struct gz_pupil_link *link, const char *address, int timeout_ms,
				  const struct gz_log *log);

/**
 * Subscribe to the topics that begin with @p first and, if it is not NULL, @p second.
 *
 * @retval GZ_ERR_IO  logged
 */
enum gz_result gz_pupil_link_subscribe(struct gz_pupil_link *link, const char *first,
				       const char *second);

/**
 * Wait for a message of the stream, and meanwhile send requests that are due. Does not allocate,
 * unless an unanswered request needs a new socket.
 *
 * @param deadline_ns  end of the wait, host time
 * @retval GZ_OK             the socket of the stream has a message
 * @retval GZ_ERR_TIMEOUT    none until @p deadline_ns
 * @retval GZ_ERR_NO_DEVICE  neither a message nor an answer for a second
 */
enum gz_result gz_pupil_link_wait(struct gz_pupil_link *link, int64_t deadline_ns);

/** Compare the clocks until a round is complete or @p deadline_ns; messages wait meanwhile. */
void gz_pupil_link_synchronise(struct gz_pupil_link *link, int64_t deadline_ns);

/** Compare the clocks soon, at most once a second, because samples do not fit. */
void gz_pupil_link_doubt_clock(struct gz_pupil_link *link, int64_t now_ns);

/**
 * Get the status of another gazed, on a link that is not yet subscribed.
 *
 * @param[out] out_status  written on success only
 * @retval GZ_ERR_TIMEOUT  none within @p timeout_ms
 * @retval GZ_ERR_PROTOCOL  only such that cannot be decoded
 * @retval GZ_ERR_IO       no socket; logged
 */
enum gz_result gz_pupil_link_status(struct gz_pupil_link *link, int timeout_ms,
				    struct gz_status *out_status);

/**
 * Send one request and wait for its answer, on a link that is not yet subscribed.
 *
 * @param[out] answer  NUL-terminated, empty on failure; @p size bytes
 * @retval GZ_ERR_TIMEOUT  no answer within @p timeout_ms
 */
enum gz_result gz_pupil_link_ask(struct gz_pupil_link *link, const char *question, int timeout_ms,
				 char *answer, size_t size);

/** Close. Also works on a link that could not be opened, or was never opened. */
void gz_pupil_link_close(struct gz_pupil_link *link);

#endif
