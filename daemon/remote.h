/**
 * @file
 * Pupil Remote's letters: what a request says. Bytes to meaning, no I/O.
 */
#ifndef GZ_DAEMON_REMOTE_H
#define GZ_DAEMON_REMOTE_H

#include <stddef.h>

/** Longest request that is understood, bytes with a NUL. */
#define GZ_REMOTE_REQUEST_SIZE 256

/** What a request asks for. */
enum gz_remote_kind {
	GZ_REMOTE_UNKNOWN,
	GZ_REMOTE_RECORD,           /**< "R" or "R name" */
	GZ_REMOTE_STOP,             /**< "r" */
	GZ_REMOTE_TIME,             /**< "t" */
	GZ_REMOTE_SET_TIME,         /**< "T seconds" */
	GZ_REMOTE_VERSION,          /**< "v" */
	GZ_REMOTE_STREAM_PORT,      /**< "SUB_PORT" */
	GZ_REMOTE_INLET_PORT,       /**< "PUB_PORT" */
	GZ_REMOTE_LATEST_PORT,      /**< "LATEST_PORT", ours */
	GZ_REMOTE_CALIBRATE,        /**< "C" */
	GZ_REMOTE_CALIBRATION_STOP, /**< "c" */
};

/** A request. */
struct gz_remote_request {
	enum gz_remote_kind kind;
	char name[GZ_REMOTE_REQUEST_SIZE]; /**< RECORD: any text, to be judged; empty: none */
};

/**
 * Read one request.
 *
 * @param bytes, size  as received, untrusted; any content
 * @param[out] out     always filled
 */
void gz_remote_parse(const void *bytes, size_t size, struct gz_remote_request *out);

#endif
