/**
 * @file
 * Messages as MessagePack, with the topics and keys of docs/protocol.md (Pupil Core's where it has
 * a word for a thing). Encoding writes into the caller's buffer and allocates nothing; decoding
 * walks the bytes for bounds before msgpack-c sees them and tolerates unknown keys.
 */
#ifndef GZ_PROTOCOL_WIRE_H
#define GZ_PROTOCOL_WIRE_H

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
#define GZ_TOPIC_ANNOTATION  "annotation"

/** What "method" says in our pupil and fixation maps. */
#define GZ_WIRE_METHOD "gazecast"

/** Room that any one encoded message fits in, bytes. */
#define GZ_WIRE_MESSAGE_SIZE 4096

/** Bytes at the end of a gaze map that hold publish_ns: its key (11) and an int 64 (9). */
#define GZ_WIRE_PUBLISH_SIZE 20

/** Bytes of an annotation's label with its NUL; longer ones are refused. */
#define GZ_ANNOTATION_LABEL_SIZE 256

/** Nesting deeper than this is refused. */
#define GZ_WIRE_DEPTH_MAX 8

/** Bytes of one encoded message. */
struct gz_wire_message {
	size_t size;
	/** In a gaze message where its pupil maps stand, by eye: each is also a whole message, of
	 * topic GZ_TOPIC_PUPIL_RIGHT or _LEFT. Size 0 where there is none. */
	struct {
		size_t at;
		size_t size;
	} pupil[GZ_EYE_COUNT];
	unsigned char bytes[GZ_WIRE_MESSAGE_SIZE];
};

/**
 * The topic of a gaze message by which eyes took part: the valid ones; both where neither is valid
 * or the device gives one point for both. Static text.
 */
const char *gz_wire_gaze_topic(const struct gz_gaze *gaze);

/*
 * Encoders. Each fills @p out_message. They return GZ_OK, or GZ_ERR_FULL with an empty message
 * where names are too long for one message (a bug, not a state that input can cause). Equal
 * arguments give equal bytes. Numbers that are not finite are sent as nil. Threads: any; nothing is
 * shared.
 */

/**
 * The map of a gaze message. Its last GZ_WIRE_PUBLISH_SIZE bytes are the key publish_ns and its
 * value: two messages that agree in all bytes before them differ in nothing else, which is how
 * replays are compared.
 *
 * @param display  for gaze_point_3d, phi and theta; must be valid
 */
enum gz_result gz_wire_encode_gaze(const struct gz_gaze *gaze, const struct gz_display *display,
				   struct gz_wire_message *out_message);

/** @param surface_name  the <name> of "surfaces.<name>" */
enum gz_result gz_wire_encode_surface(const struct gz_gaze *gaze, const char *surface_name,
				      struct gz_wire_message *out_message);
enum gz_result gz_wire_encode_fixation(const struct gz_fixation *fixation,
				       struct gz_wire_message *out_message);
enum gz_result gz_wire_encode_blink(const struct gz_blink *blink,
				    struct gz_wire_message *out_message);
enum gz_result gz_wire_encode_saccade(const struct gz_saccade *saccade,
				      struct gz_wire_message *out_message);
enum gz_result gz_wire_encode_status(const struct gz_status *status,
				     struct gz_wire_message *out_message);

/**
 * Check that @p bytes are one whole MessagePack value: no count above the bytes left, no nesting
 * beyond GZ_WIRE_DEPTH_MAX, nothing behind it. Must precede msgpack-c, which allocates by claims.
 *
 * @retval GZ_OK            well formed
 * @retval GZ_ERR_PROTOCOL  not
 */
enum gz_result gz_wire_check(const void *bytes, size_t size);

/*
 * Decoders. Unknown keys are skipped; missing keys, nil and NaN leave NaN, 0 or the enum's first
 * value (device_ns: GZ_NO_DEVICE_TIME). A known key with a value of another type or out of its
 * range refuses the message, as does a gaze without place or time, a fixation or saccade without
 * time, a blink without type or time. They return GZ_OK, or GZ_ERR_PROTOCOL with *out untouched.
 * They may allocate within msgpack-c, at most a small multiple of @p size. Threads: any.
 *
 * Times that travel as seconds come back exact up to 17 days of uptime, then to 0.1 us.
 */

/**
 * A gaze map of ours, or of Pupil Capture (norm_pos, confidence, timestamp, base_data): there the
 * point is norm_pos turned to our origin, the eyes in base_data are the valid ones, and their
 * origins and directions are eye_center(s)_3d and gaze_normal(s)_3d, in the frame of the scene
 * camera. Of our maps the eyes' directions do not travel and are NaN; their origins are NaN where a
 * distance stood in.
 */
enum gz_result gz_wire_decode_gaze(const void *bytes, size_t size, struct gz_gaze *out_gaze);

/** One entry of "gaze_on_surfaces". */
struct gz_surface_gaze {
	struct gz_point point; /**< on the surface, origin top left */
	bool on_surface;       /**< within its edges, as the sender says */
	float confidence;      /**< NaN where it has none */
	int64_t time_ns;       /**< of the gaze message that it was mapped from */
};

/**
 * A surface map: what Pupil Capture's surface tracker, or a daemon of ours, says of gaze on it.
 *
 * @param max             room at @p out_gaze
 * @param[out] out_gaze   its entries; undefined after a failure
 * @param[out] out_count  how many; written on success only
 * @retval GZ_ERR_FULL    more than @p max; *out_count is untouched
 */
enum gz_result gz_wire_decode_surface(const void *bytes, size_t size,
				      struct gz_surface_gaze *out_gaze, size_t max,
				      size_t *out_count);
enum gz_result gz_wire_decode_fixation(const void *bytes, size_t size,
				       struct gz_fixation *out_fixation);
enum gz_result gz_wire_decode_blink(const void *bytes, size_t size, struct gz_blink *out_blink);
enum gz_result gz_wire_decode_saccade(const void *bytes, size_t size,
				      struct gz_saccade *out_saccade);
/** The display may be one that gz_display_valid() refuses: a daemon may not know it. */
enum gz_result gz_wire_decode_status(const void *bytes, size_t size, struct gz_status *out_status);

/** What a client says of a moment, as Pupil's annotations have it. */
struct gz_annotation {
	char label[GZ_ANNOTATION_LABEL_SIZE];
	bool has_time;
	int64_t time_ns;     /**< if has_time */
	int64_t duration_ns; /**< 0 for a moment */
};

/** {"topic": "annotation", "label", "timestamp" s if it has one, "duration" s}: as Pupil's clients
 * send them. As the encoders above. */
enum gz_result gz_wire_encode_annotation(const struct gz_annotation *annotation,
					 struct gz_wire_message *out_message);

/** A map with "label", and where given "timestamp" s and "duration" s. As the decoders above. */
enum gz_result gz_wire_decode_annotation(const void *bytes, size_t size,
					 struct gz_annotation *out_annotation);

#endif
