/**
 * @file
 * Parsing requests and notifications of Pupil Remote's protocol. Bytes to meaning, no I/O.
 */
#ifndef GZ_DAEMON_REMOTE_H
#define GZ_DAEMON_REMOTE_H

#include <stddef.h>

#include "protocol/wire.h"

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
	GZ_REMOTE_LATEST_PORT,      /**< "LATEST_PORT", an addition of ours */
	GZ_REMOTE_CORRECTION,       /**< "CORRECTION", an addition of ours */
	GZ_REMOTE_CALIBRATE,        /**< "C" */
	GZ_REMOTE_CALIBRATION_STOP, /**< "c" */
};

/** A request. */
struct gz_remote_request {
	enum gz_remote_kind kind;
	char name[GZ_REMOTE_REQUEST_SIZE]; /**< RECORD: any text, not checked yet; empty: none */
};

/**
 * Parse one request.
 *
 * @param bytes, size  as received, untrusted; any content
 * @param[out] out     always filled
 */
void gz_remote_parse(const void *bytes, size_t size, struct gz_remote_request *out);

/** What a notification asks of the daemon. */
enum gz_remote_notice {
	GZ_REMOTE_NOTICE_OTHER,     /**< nothing: it is for other readers */
	GZ_REMOTE_NOTICE_RECORD,    /**< "recording.should_start", with session_name */
	GZ_REMOTE_NOTICE_STOP,      /**< "recording.should_stop" */
	GZ_REMOTE_NOTICE_CALIBRATE, /**< "calibration.should_start" */
	GZ_REMOTE_NOTICE_DOC,       /**< "meta.should_doc": list what the daemon understands */
};

/** What the notification with @p subject asks for. */
enum gz_remote_notice gz_remote_notice(const char *subject);

/** The answer to "meta.should_doc": what requests and notifications the daemon understands; static
 * text. */
const char *gz_remote_doc(void);

#endif
