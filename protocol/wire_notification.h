/**
 * @file
 * Notifications as Pupil Core has them: messages of topic "notify." and subject, whose map repeats
 * the subject. Keys are those of Pupil Capture's own notifications (its source, recorder.py and
 * calibration_choreography/; docs/pupil-clients.md).
 */
#ifndef GZ_PROTOCOL_WIRE_NOTIFICATION_H
#define GZ_PROTOCOL_WIRE_NOTIFICATION_H

#include "protocol/wire.h"

/** What every notification's topic begins with. */
#define GZ_TOPIC_NOTIFY "notify."

#define GZ_SUBJECT_RECORDING_START    "recording.should_start"
#define GZ_SUBJECT_RECORDING_STOP     "recording.should_stop"
#define GZ_SUBJECT_RECORDING_STARTED  "recording.started"
#define GZ_SUBJECT_RECORDING_STOPPED  "recording.stopped"
#define GZ_SUBJECT_CALIBRATION_START  "calibration.should_start"
#define GZ_SUBJECT_CALIBRATION_FAILED "calibration.failed"
#define GZ_SUBJECT_SHOULD_DOC         "meta.should_doc"
#define GZ_SUBJECT_DOC                "meta.doc"

/** Bytes of a subject with its NUL; longer ones are refused. */
#define GZ_SUBJECT_SIZE 240

/** Bytes of a session's name with its NUL; longer ones are refused. */
#define GZ_SESSION_NAME_SIZE 256

/** What is read of a notification. */
struct gz_notification {
	char subject[GZ_SUBJECT_SIZE];
	char session_name[GZ_SESSION_NAME_SIZE]; /**< empty where it has none; untrusted */
};

/**
 * Read a map with "subject", and where given "session_name". As the decoders of wire.h.
 *
 * @retval GZ_ERR_PROTOCOL  no such map; *out_notification is untouched
 */
enum gz_result gz_wire_decode_notification(const void *bytes, size_t size,
					   struct gz_notification *out_notification);

/*
 * Notifications that the daemon sends. As the encoders of wire.h.
 */

/** @param start_ns  host time */
enum gz_result gz_wire_encode_recording_started(const char *path, const char *session_name,
						int64_t start_ns,
						struct gz_wire_message *out_message);
enum gz_result gz_wire_encode_recording_stopped(const char *path,
						struct gz_wire_message *out_message);
enum gz_result gz_wire_encode_calibration_failed(const char *reason, int64_t time_ns,
						 struct gz_wire_message *out_message);
/** @param actor, doc  who speaks, and what it understands */
enum gz_result gz_wire_encode_doc(const char *actor, const char *doc,
				  struct gz_wire_message *out_message);

#endif
