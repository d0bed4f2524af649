/**
 * @file
 * What a reader sends before libzmq takes it: the frames of ZeroMQ's transport protocol (RFC 23 and
 * 37, ZMTP 3.0 and 3.1; RFC 15, ZMTP 2.0), as far as the door (door.h) has to understand them.
 * Bytes to frames, in pieces as they come from a socket; no sockets, no allocation.
 */
#ifndef GZ_DAEMON_ZMTP_INPUT_H
#define GZ_DAEMON_ZMTP_INPUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Longest topic that is kept whole, bytes. Chosen: longer than any topic of the daemon. */
#define GZ_ZMTP_TOPIC_SIZE 96

/** What a frame is. */
enum gz_zmtp_kind {
	GZ_ZMTP_SUBSCRIBE, /**< a subscription */
	GZ_ZMTP_MESSAGE, /**< another message: the end of a subscription, or what no reader sends */
	GZ_ZMTP_COMMAND, /**< a command: of the handshake, or a heartbeat */
	GZ_ZMTP_UNKNOWN, /**< bytes of a version without a greeting (ZMTP 1), whose frames are not
			    told apart */
};

/** A frame. */
struct gz_zmtp_frame {
	enum gz_zmtp_kind kind;
	uint64_t size;              /**< bytes, with the frame's header */
	uint64_t body_size;         /**< bytes; 0 for UNKNOWN */
	bool more;                  /**< further frames of the same message follow */
	uint64_t topic_size;        /**< SUBSCRIBE; bytes */
	const unsigned char *topic; /**< its first bytes, GZ_ZMTP_TOPIC_SIZE at most; valid until
				       the next call */
};

/** Where in the frames a connection is. Zero-initialised is the beginning of a connection. */
struct gz_zmtp_input {
	uint8_t phase;    /**< private, as all that follows */
	uint8_t greeting; /**< bytes of it so far */
	uint8_t flags;
	uint8_t length_left; /**< bytes of the length still to come */
	uint8_t kept;
	uint64_t length;
	uint64_t left;                               /**< bytes of the body still to come */
	unsigned char head[GZ_ZMTP_TOPIC_SIZE + 10]; /**< the first bytes of the body */
};

/**
 * Read up to the end of the next frame.
 *
 * @param[in,out] bytes, size  what has come, untrusted; advanced to what follows the frame, or to
 *                             the end
 * @param[out] out_frame  written on true only
 * @return whether a frame has ended; false: all bytes are read
 */
bool gz_zmtp_next(struct gz_zmtp_input *input, const unsigned char **bytes, size_t *size,
		  struct gz_zmtp_frame *out_frame);

#endif
