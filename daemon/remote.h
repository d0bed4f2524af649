/**
 * @file
 * Pupil Remote's letters: what a request says. Bytes to meaning, no I/O.
 */
#ifndef GZ_DAEMON_REMOTE_H
#define GZ_DAEMON_REMOTE_H

#include <stddef.h>

#include "protocol/wire_notification.h"

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
	GZ_REMOTE_CORRECTION,       /**< "CORRECTION", ours */
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

/** What a notification asks the daemon for. */
enum gz_remote_notice {
	GZ_REMOTE_NOTICE_OTHER,     /**< nothing: for other readers, or of no meaning here */
	GZ_REMOTE_NOTICE_RECORD,    /**< "recording.should_start", with session_name */
	GZ_REMOTE_NOTICE_STOP,      /**< "recording.should_stop" */
	GZ_REMOTE_NOTICE_CALIBRATE, /**< "calibration.should_start" */
	GZ_REMOTE_NOTICE_DOC,       /**< "meta.should_doc": say what is understood */
};

/** What @p subject asks for. */
enum gz_remote_notice gz_remote_notice(const char *subject);

/** What the daemon understands, as it tells to who asks by "meta.should_doc"; static text. */
const char *gz_remote_doc(void);

#endif
