#include "daemon/messages.h"

#include <stdio.h>
#include <string.h>

void gz_message_maker_init(struct gz_message_maker *maker, const struct gz_config *config,
			   const struct gz_pipeline_params *params,
			   const struct gz_display *display)
{
	gz_pipeline_init(&maker->pipeline, params, display);
	maker->surface_count = config->surface_count;
	memcpy(maker->surface, config->surface, sizeof maker->surface);
}

void gz_message_maker_reset(struct gz_message_maker *maker)
{
	struct gz_pipeline_params params = maker->pipeline.params;
	struct gz_display display = maker->pipeline.display;
	gz_pipeline_init(&maker->pipeline, &params, &display);
}

/* The next message's place, with its topic. GZ_MESSAGES_MAX is enough for every step. */
static struct gz_wire_message *append(struct gz_outgoing_batch *batch, const char *topic,
				      const char *name)
{
	struct gz_outgoing *item = &batch->item[batch->count++];
	size_t topic_length = strlen(topic);
	size_t name_length = strlen(name);
	memcpy(item->topic, topic, topic_length);
	memcpy(item->topic + topic_length, name, name_length + 1);
	return &item->body;
}

_Static_assert(sizeof GZ_TOPIC_SURFACES - 1 + GZ_NAME_SIZE <= GZ_TOPIC_SIZE, "topics fit");

void gz_message_maker_step(struct gz_message_maker *maker, const struct gz_sample *sample,
			   int64_t publish_ns, struct gz_outgoing_batch *out)
{
	struct gz_pipeline_output step;
	gz_pipeline_step(&maker->pipeline, sample, &step);
	step.gaze.publish_ns = publish_ns;
	out->count = 0;
	out->rejection = step.rejection;
	gz_wire_encode_gaze(&step.gaze, &maker->pipeline.display,
			    append(out, gz_wire_gaze_topic(&step.gaze), ""));
	for (size_t i = 0; i < maker->surface_count; i++)
		gz_wire_encode_surface(&step.gaze, maker->surface[i],
				       append(out, GZ_TOPIC_SURFACES, maker->surface[i]));
	for (size_t i = 0; i < step.fixation_count; i++)
		gz_wire_encode_fixation(&step.fixations[i], append(out, GZ_TOPIC_FIXATIONS, ""));
	for (size_t i = 0; i < step.blink_count; i++)
		gz_wire_encode_blink(&step.blinks[i], append(out, GZ_TOPIC_BLINKS, ""));
	for (size_t i = 0; i < step.saccade_count; i++)
		gz_wire_encode_saccade(&step.saccades[i], append(out, GZ_TOPIC_SACCADES, ""));
}
