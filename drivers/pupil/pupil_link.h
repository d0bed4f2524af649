/**
 * @file
 * The sockets to a Pupil Capture, or to another gazed: requests to Pupil Remote, and the stream.
 *
 * Requests never hold the stream: one is under way at a time, and its answer is taken when it
 * comes. The first asks for the stream's port, which is another one each time Pupil Capture starts;
 * the others compare the clocks (pupil_clock.h).
 */
#ifndef GZ_DRIVERS_PUPIL_LINK_H
#define GZ_DRIVERS_PUPIL_LINK_H

#include <stdbool.h>
#include <stdint.h>
#include <zmq.h>

#include "base/log.h"
#include "base/result.h"
#include "drivers/pupil/pupil_clock.h"
#include "drivers/pupil/pupil_keys.h"
#include "protocol/endpoint.h"
#include "protocol/gaze.h"

/** Time between two rounds of clock comparison, ns (Pupil's network_time_sync.py). */
#define GZ_PUPIL_ROUND_NS INT64_C(10000000000)

/** Longest wait for an answer, ms. Chosen: Pupil Remote answers within some ms. */
#define GZ_PUPIL_PATIENCE_MS 500

/** A silent stream is asked for its port so often, ms. */
#define GZ_PUPIL_SILENCE_MS 500

/** Largest message taken, bytes; libzmq drops who sends more. Chosen: a surface message of a second
 * of Pupil Core's gaze has some 80 kB. */
#define GZ_PUPIL_MESSAGE_MAX 262144

/** Bytes of a topic's beginning with its NUL. */
#define GZ_PUPIL_TOPIC_SIZE 96

/** What the link waits for an answer to. */
enum gz_pupil_request {
	GZ_PUPIL_REQUEST_NONE,
	GZ_PUPIL_REQUEST_PORT,
	GZ_PUPIL_REQUEST_TIME,
};

/** A link. Zero-initialised is none; gz_pupil_link_open() fills it. */
struct gz_pupil_link {
	const struct gz_log *log;
	void *context;
	void *control; /**< DEALER, where a REQ would be stuck without an answer */
	void *stream;  /**< SUB; NULL before gz_pupil_link_subscribe() */
	char address[GZ_ENDPOINT_SIZE];
	struct gz_pupil_keys keys;
	char topics[2][GZ_PUPIL_TOPIC_SIZE]; /**< "" for none */
	int port;                            /**< of the stream; 0 while not known */
	struct gz_pupil_clock clock;
	bool in_round;
	enum gz_pupil_request request;
	int64_t sent_ns;
	int64_t next_round_ns;
	int64_t next_port_ns;
	int64_t heard_ns; /**< newest message of the stream, or begin */
	int unanswered;   /**< requests in a row */
	uint64_t jumps;   /**< how often Pupil's clock was set */
	bool told_reply;  /**< that an answer was no port */
};

/**
 * Whether @p address is "tcp://HOST:PORT" with a port of 1 to 65535, and short enough.
 */
bool gz_pupil_address_valid(const char *address);

/**
 * Connect to Pupil Remote, with keys where gz_pupil_keys_find() has some, and wait until it tells
 * the stream's port.
 *
 * @param address   as gz_pupil_address_valid() has it
 * @param log       borrowed, outlives the link; may be NULL
 * @retval GZ_ERR_NO_DEVICE  nobody answers within @p timeout_ms, or not with a port; logged
 * @retval GZ_ERR_NO_MEM, GZ_ERR_INVAL  logged
 * @retval GZ_ERR_ACCESS, GZ_ERR_FORMAT, GZ_ERR_IO, GZ_ERR_FULL  keys cannot be had; logged
 */
enum gz_result gz_pupil_link_open(struct gz_pupil_link *link, const char *address, int timeout_ms,
				  const struct gz_log *log);

/** Take the topics that begin with @p first and, where not NULL, @p second.
 *  @retval GZ_ERR_IO  logged */
enum gz_result gz_pupil_link_subscribe(struct gz_pupil_link *link, const char *first,
				       const char *second);

/**
 * Wait for a message of the stream and meanwhile do what is due with requests. Does not allocate
 * but where an unanswered request needs a new socket.
 *
 * @param deadline_ns  longest wait, host time
 * @retval GZ_OK             a message waits in the stream's socket
 * @retval GZ_ERR_TIMEOUT    none until @p deadline_ns
 * @retval GZ_ERR_NO_DEVICE  neither a message nor an answer for a second
 */
enum gz_result gz_pupil_link_wait(struct gz_pupil_link *link, int64_t deadline_ns);

/**
 * Compare the clocks until a round is complete or @p deadline_ns; messages wait meanwhile.
 */
void gz_pupil_link_synchronise(struct gz_pupil_link *link, int64_t deadline_ns);

/** Samples do not fit the clock: compare soon, at most once a second. */
void gz_pupil_link_doubt_clock(struct gz_pupil_link *link, int64_t now_ns);

/**
 * What another gazed says of itself, on a link that is not yet subscribed.
 *
 * @param[out] out_status  written on success only
 * @retval GZ_ERR_TIMEOUT  nothing within @p timeout_ms
 * @retval GZ_ERR_IO       no socket; logged
 */
enum gz_result gz_pupil_link_status(struct gz_pupil_link *link, int timeout_ms,
				    struct gz_status *out_status);

/** Ask one question and wait for its answer, on a link that is not yet subscribed.
 *  @param[out] answer  NUL-terminated, empty on failure
 *  @retval GZ_ERR_TIMEOUT  none */
enum gz_result gz_pupil_link_ask(struct gz_pupil_link *link, const char *question, int timeout_ms,
				 char *answer, size_t size);

/** Close. Also right for a link that was opened half-way, or not at all. */
void gz_pupil_link_close(struct gz_pupil_link *link);

#endif
