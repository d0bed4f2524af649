/**
 * @file
 * From a sample to all messages that it brings about, as bytes: a pipeline step and the encoding,
 * without sockets and without a clock. That is all that decides what the stream carries, so the
 * same samples, settings and display from the start state give the same bytes, but for publish_ns.
 */
#ifndef GZ_DAEMON_MESSAGES_H
#define GZ_DAEMON_MESSAGES_H

#include <stddef.h>

#include "daemon/config.h"
#include "filter/pipeline.h"
#include "protocol/wire.h"

/** Room for a topic with its NUL: "surfaces." and a name. */
#define GZ_TOPIC_SIZE 80

/** Most messages of one sample: the gaze, each surface, and the pipeline's. */
#define GZ_MESSAGES_MAX (1 + GZ_SURFACES_MAX + GZ_FIXATION_MESSAGES_MAX + GZ_BLINK_MESSAGES_MAX + 1)

/** One message of the stream. */
struct gz_outgoing {
	char topic[GZ_TOPIC_SIZE];
	struct gz_wire_message body;
};

/** Messages of one sample in the order they are sent; the first one is the gaze. */
struct gz_outgoing_batch {
	size_t count;
	enum gz_rejection rejection; /**< of the sample */
	struct gz_outgoing item[GZ_MESSAGES_MAX];
};

/** Makes messages. Plain data; gz_message_maker_init() fills it. */
struct gz_message_maker {
	struct gz_pipeline pipeline;
	size_t surface_count;
	char surface[GZ_SURFACES_MAX][GZ_NAME_SIZE];
};

/**
 * Put the maker into its start state.
 *
 * @param config   for the names of the surfaces
 * @param display  valid
 */
void gz_message_maker_init(struct gz_message_maker *maker, const struct gz_config *config,
			   const struct gz_pipeline_params *params,
			   const struct gz_display *display);

/** Back to the start state, with the same settings. */
void gz_message_maker_reset(struct gz_message_maker *maker);

/**
 * Take one sample. Does not allocate.
 *
 * @param publish_ns  what the gaze message says of when it was sent
 * @param[out] out    always filled
 */
void gz_message_maker_step(struct gz_message_maker *maker, const struct gz_sample *sample,
			   int64_t publish_ns, struct gz_outgoing_batch *out);

#endif
