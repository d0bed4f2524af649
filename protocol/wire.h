/**
 * @file
 * Messages as MessagePack, with the topics and keys of docs/protocol.md. Where Pupil Core has a
 * topic or key for something, it is used. Encoding writes into the caller's buffer and allocates
 * nothing. Decoding checks the bounds of the bytes before msgpack-c reads them, and ignores unknown
 * keys.
 */
#ifndef GZ_PROTOCOL_WIRE_H
#define GZ_PROTOCOL_WIRE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/result.h"
#include "protocol/gaze.h"

#define GZ_TOPIC_GAZE        "gaze."
#define GZ_TOPIC_GAZE_BOTH   "gaze.3d.01."
#define GZ_TOPIC_GAZE_RIGHT  "gaze.3d.0."
#define GZ_TOPIC_GAZE_LEFT   "gaze.3d.1."
#define GZ_TOPIC_PUPIL_RIGHT "pupil.0.3d"
#define GZ_TOPIC_PUPIL_LEFT  "pupil.1.3d"
#define GZ_TOPIC_SURFACES    "surfaces."
#define GZ_TOPIC_FIXATIONS   "fixations"
#define GZ_TOPIC_BLINKS      "blinks"
#define GZ_TOPIC_SACCADES    "saccades"
#define GZ_TOPIC_STATUS      "status"
#define GZ_TOPIC_EVENT_FINAL "event_final"
#define GZ_TOPIC_ANNOTATION  "annotation"
#define GZ_TOPIC_POINTER     "pointer"
#define GZ_TOPIC_WINDOW      "window"
#define GZ_TOPIC_NOTIFY      "notify." /**< the beginning of every notification's topic */

/** The value of "method" in pupil and fixation maps of this project. */
#define GZ_WIRE_METHOD "gazecast"

/** Size of a buffer for any encoded message, bytes. */
#define GZ_WIRE_MESSAGE_SIZE 4096

/** Bytes at the end of a gaze map that hold publish_ns: its key (11) and an int 64 (9). */
#define GZ_WIRE_PUBLISH_SIZE 20

/** An annotation's label with its NUL, bytes; longer ones are refused. */
#define GZ_ANNOTATION_LABEL_SIZE 256

/** Nesting deeper than this is refused. */
#define GZ_WIRE_DEPTH_MAX 8

/** One encoded message. */
struct gz_wire_message {
	size_t size;
	/** In a gaze message: where the pupil map of each eye is. Each is also a whole message, of
	 * topic GZ_TOPIC_PUPIL_RIGHT or _LEFT. Size 0: there is none. */
	struct {
		size_t at;
		size_t size;
	} pupil[GZ_EYE_COUNT];
	unsigned char bytes[GZ_WIRE_MESSAGE_SIZE];
};

/**
 * The topic of a gaze message, which depends on the eyes that are valid: both also if neither is
 * valid or the device gives one point for both eyes. Static text.
 */
const char *gz_wire_gaze_topic(const struct gz_gaze *gaze);

/*
 * Encoders. Each fills @p out_message and returns GZ_OK, or GZ_ERR_FULL with an empty message if
 * names are too long for one message (which no input can cause: a bug). Equal arguments give equal
 * bytes. Numbers that are not finite become nil. Threads: any; nothing is shared.
 */

/**
 * Encode the map of a gaze message. Its last GZ_WIRE_PUBLISH_SIZE bytes are the key publish_ns and
 * its value. So two messages that agree in all bytes before these differ in nothing else; replays
 * are compared in this way.
 *
 * @param display  for gaze_point_3d, phi and theta; must be valid
 */
enum gz_result gz_wire_encode_gaze(const struct gz_gaze *gaze, const struct gz_display *display,
				   struct gz_wire_message *out_message);

/** Encode the certain event of earlier samples alone, when no sample follows: the fields final_ and
 * host_ns of @p gaze. */
enum gz_result gz_wire_encode_event_final(const struct gz_gaze *gaze,
					  struct gz_wire_message *out_message);

/**
 * Encode the gaze on the screen, and fixations, as those on a surface.
 *
 * @param fixations, fixation_count  those whose messages are sent together with @p gaze
 * @param surface_name  the <name> of "surfaces.<name>"
 */
enum gz_result gz_wire_encode_surface(const struct gz_gaze *gaze,
				      const struct gz_fixation *fixations, size_t fixation_count,
				      const char *surface_name,
				      struct gz_wire_message *out_message);

/** Encode a fixation. */
enum gz_result gz_wire_encode_fixation(const struct gz_fixation *fixation,
				       struct gz_wire_message *out_message);

/** Encode the beginning or end of a blink. */
enum gz_result gz_wire_encode_blink(const struct gz_blink *blink,
				    struct gz_wire_message *out_message);

/** Encode a saccade. */
enum gz_result gz_wire_encode_saccade(const struct gz_saccade *saccade,
				      struct gz_wire_message *out_message);

/** Encode the daemon's status. */
enum gz_result gz_wire_encode_status(const struct gz_status *status,
				     struct gz_wire_message *out_message);

/**
 * Check that @p bytes are one whole MessagePack value: no count is above the bytes left, the
 * nesting is at most GZ_WIRE_DEPTH_MAX, and nothing follows. Call this before msgpack-c, which
 * allocates what a message claims to need.
 *
 * @retval GZ_OK            well formed
 * @retval GZ_ERR_PROTOCOL  malformed
 */
enum gz_result gz_wire_check(const void *bytes, size_t size);

/*
 * Decoders. Unknown keys are skipped. If a key is missing, nil or NaN, the field is NaN, 0 or the
 * enum's first value (device_ns: GZ_NO_DEVICE_TIME). A message is refused if a known key has a
 * value of the wrong type or out of range; so is a gaze without place or time, a fixation or
 * saccade without time, and a blink without type or time. They return GZ_OK, or GZ_ERR_PROTOCOL
 * with *out unchanged. msgpack-c may allocate, at most a small multiple of @p size. Threads: any.
 *
 * Times that travel as seconds come back exactly for the first 17 days of uptime, and to 0.1 us
 * after that.
 */

/**
 * Decode a gaze map of this project or of Pupil Capture (norm_pos, confidence, timestamp,
 * base_data).
 *
 * In a map of Pupil Capture the point is norm_pos with the origin moved to the top left; the eyes
 * in base_data are the valid ones; their origins and directions are eye_center(s)_3d and
 * gaze_normal(s)_3d, in the coordinates of the scene camera. In a map of this project the
 * directions of the eyes are not sent and decode as NaN; an origin decodes as NaN if the sender did
 * not measure it and filled in the viewing distance.
 */
enum gz_result gz_wire_decode_gaze(const void *bytes, size_t size, struct gz_gaze *out_gaze);

/** One entry of "gaze_on_surfaces". */
struct gz_surface_gaze {
	struct gz_point point; /**< on the surface, origin top left */
	bool on_surface;       /**< within the edges, according to the sender */
	float confidence;      /**< NaN if it has none */
	int64_t time_ns;       /**< of the gaze message that it was mapped from */
};

/**
 * Decode a surface map, from Pupil Capture's surface tracker or a daemon of this project.
 *
 * @param max             how many entries fit into @p out_gaze
 * @param[out] out_gaze   the entries; undefined after a failure
 * @param[out] out_count  number of entries; written on success only
 * @retval GZ_ERR_FULL    there are more than @p max; *out_count is unchanged
 */
enum gz_result gz_wire_decode_surface(const void *bytes, size_t size,
				      struct gz_surface_gaze *out_gaze, size_t max,
				      size_t *out_count);

/** Decode a fixation. */
enum gz_result gz_wire_decode_fixation(const void *bytes, size_t size,
				       struct gz_fixation *out_fixation);

/** Decode the beginning or end of a blink. */
enum gz_result gz_wire_decode_blink(const void *bytes, size_t size, struct gz_blink *out_blink);

/** Decode a saccade. */
enum gz_result gz_wire_decode_saccade(const void *bytes, size_t size,
				      struct gz_saccade *out_saccade);

/** Decode a status. gz_display_valid() may refuse its display: a daemon may not know the display.
 */
enum gz_result gz_wire_decode_status(const void *bytes, size_t size, struct gz_status *out_status);

/*
 * What clients send to the inlet. Encoders and decoders as above.
 */

/** Room for the other keys of an annotation as JSON, with a NUL, bytes; more are left out, and a
 * key "truncated" says so. That of a mark in the gaze log. */
#define GZ_ANNOTATION_KEYS_SIZE 448

/** A client's label for a moment or a stretch of time, as in Pupil's annotations. */
struct gz_annotation {
	char label[GZ_ANNOTATION_LABEL_SIZE];
	bool has_time;
	int64_t time_ns;     /**< set if has_time */
	int64_t duration_ns; /**< 0 for a moment */
	/** All other keys as a JSON object; empty: none. Set by the decoder; the encoder ignores
	 * it. */
	char keys[GZ_ANNOTATION_KEYS_SIZE];
};

/** Encode {"topic": "annotation", "label", "timestamp" s if it has one, "duration" s}, as Pupil's
 * clients send it. */
enum gz_result gz_wire_encode_annotation(const struct gz_annotation *annotation,
					 struct gz_wire_message *out_message);

/** Decode a map with "label" and perhaps "timestamp" s and "duration" s. */
enum gz_result gz_wire_decode_annotation(const void *bytes, size_t size,
					 struct gz_annotation *out_annotation);

/** Farthest corner and longest side of a window, px. Chosen: many displays side by side. */
#define GZ_WINDOW_PX_MAX 1000000

/** A viewer's mouse pointer at one moment. */
struct gz_viewer_pointer {
	bool known;            /**< false: it is not in the viewer's window */
	struct gz_point point; /**< normalised display area; set if known */
	bool has_time;
	int64_t time_ns; /**< host time; set if has_time */
};

/** A viewer's window at one moment. */
struct gz_viewer_window {
	bool known;     /**< false: it is closed */
	int rect_px[4]; /**< x, y, width and height of its content on the display; set if known */
	struct gz_monitor_place monitor; /**< the tracker's display; zeroed: unknown */
	bool has_still;                  /**< the viewer says whether its scene is still */
	bool still_scene; /**< nothing that the person looks at moves; set if has_still */
	bool has_time;
	int64_t time_ns; /**< host time; set if has_time */
};

/** Encode {"point": [x, y] or nil, "timestamp": s or nil}. */
enum gz_result gz_wire_encode_pointer(const struct gz_viewer_pointer *pointer,
				      struct gz_wire_message *out_message);

/** Encode {"rect": [x, y, w, h] or nil, "timestamp": s or nil}; if the monitor is known,
 * "monitor": [x, y, w, h] and "scale"; if has_still, "still": bool. */
enum gz_result gz_wire_encode_window(const struct gz_viewer_window *window,
				     struct gz_wire_message *out_message);

/** Decode a pointer. */
enum gz_result gz_wire_decode_pointer(const void *bytes, size_t size,
				      struct gz_viewer_pointer *out_pointer);

/** Decode a window. Numbers that are not whole or beyond GZ_WINDOW_PX_MAX are refused, and so are
 * an empty rectangle, a monitor of more than GZ_DISPLAY_SIDE_MAX_PX and a scale above
 * GZ_MONITOR_SCALE_MAX. */
enum gz_result gz_wire_decode_window(const void *bytes, size_t size,
				     struct gz_viewer_window *out_window);

/*
 * Notifications as in Pupil Core: messages whose topic is "notify." and the subject, and whose map
 * repeats the subject. The keys are those of Pupil Capture's own notifications (its source,
 * recorder.py and calibration_choreography/; docs/pupil-clients.md). Encoders and decoders as
 * above.
 */

#define GZ_SUBJECT_RECORDING_START    "recording.should_start"
#define GZ_SUBJECT_RECORDING_STOP     "recording.should_stop"
#define GZ_SUBJECT_RECORDING_STARTED  "recording.started"
#define GZ_SUBJECT_RECORDING_STOPPED  "recording.stopped"
#define GZ_SUBJECT_CALIBRATION_START  "calibration.should_start"
#define GZ_SUBJECT_CALIBRATION_FAILED "calibration.failed"
#define GZ_SUBJECT_SHOULD_DOC         "meta.should_doc"
#define GZ_SUBJECT_DOC                "meta.doc"

/** A subject with its NUL, bytes; longer ones are refused. */
#define GZ_SUBJECT_SIZE 240

/** A session's name with its NUL, bytes; longer ones are refused. */
#define GZ_SESSION_NAME_SIZE 256

/** What the daemon reads of a notification. */
struct gz_notification {
	char subject[GZ_SUBJECT_SIZE];
	char session_name[GZ_SESSION_NAME_SIZE]; /**< empty if it has none; untrusted */
};

/** Decode a map with "subject" and perhaps "session_name". */
enum gz_result gz_wire_decode_notification(const void *bytes, size_t size,
					   struct gz_notification *out_notification);

/**
 * Encode the notification that a recording has started.
 *
 * @param start_ns  host time
 */
enum gz_result gz_wire_encode_recording_started(const char *path, const char *session_name,
						int64_t start_ns,
						struct gz_wire_message *out_message);

/** Encode the notification that a recording has stopped and its file is complete. */
enum gz_result gz_wire_encode_recording_stopped(const char *path,
						struct gz_wire_message *out_message);

/**
 * Encode the notification that a calibration has failed.
 *
 * @param time_ns  host time
 */
enum gz_result gz_wire_encode_calibration_failed(const char *reason, int64_t time_ns,
						 struct gz_wire_message *out_message);

/**
 * Encode the answer to "meta.should_doc".
 *
 * @param actor  who answers
 * @param doc    which notifications it understands
 */
enum gz_result gz_wire_encode_doc(const char *actor, const char *doc,
				  struct gz_wire_message *out_message);

#endif
