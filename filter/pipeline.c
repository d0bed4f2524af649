#include "filter/pipeline.h"

#include <math.h>
#include <string.h>

#include "filter/angle.h"

/* How many steps the noise is a mean of at most: chosen, seconds to minutes. */
static const double NOISE_COUNT_MAX = 20000;

void gz_pipeline_init(struct gz_pipeline *pipeline, const struct gz_pipeline_params *params,
		      const struct gz_display *display)
{
	*pipeline = (struct gz_pipeline) {
		.params = params ? *params : gz_pipeline_default_params(),
		.display = *display,
		.event = GZ_EVENT_LOST,
		.point = { 0.5f, 0.5f },
	};
}

static struct gz_gaze_eye eye_message(const struct gz_eye_sample *eye, bool good)
{
	struct gz_gaze_eye message = {
		.point = eye->point,
		.pupil_mm = eye->pupil_mm,
		.valid = good,
		.confidence = eye->confidence,
	};
	memcpy(message.origin_mm, eye->origin_mm, sizeof message.origin_mm);
	memcpy(message.direction, eye->direction, sizeof message.direction);
	return message;
}

/** What is known without looking at the eyes' movement. */
static struct gz_gaze message_of(const struct gz_pipeline *pipeline, const struct gz_sample *sample,
				 const struct gz_validate_output *valid)
{
	bool usable = valid->rejection != GZ_REJECT_TIME;
	struct gz_gaze gaze = {
		.seq = sample->seq,
		.device_ns = sample->device_ns,
		.host_ns = usable ? sample->host_ns : pipeline->host_ns,
		.point = pipeline->point,
		.raw = { NAN, NAN },
		.event = pipeline->event,
		.combined = gz_sample_combined_only(sample),
	};
	for (int i = 0; i < GZ_EYE_COUNT; i++)
		gaze.eye[i] = eye_message(&sample->eye[i], valid->eye_good[i]);
	return gaze;
}

static void measure_noise(struct gz_pipeline *pipeline, enum gz_event event, bool valid,
			  struct gz_point raw)
{
	struct gz_pipeline_noise *noise = &pipeline->noise;
	bool in_fixation = valid && event == GZ_EVENT_FIXATION;
	if (in_fixation && noise->in_fixation) {
		double deg = gz_chord_deg(&pipeline->display, noise->last, raw);
		noise->count = fmin(noise->count + 1, NOISE_COUNT_MAX);
		noise->mean_square_deg2 += (deg * deg - noise->mean_square_deg2) / noise->count;
	}
	noise->in_fixation = in_fixation;
	noise->last = raw;
}

static void copy_messages(const struct gz_messages *messages, struct gz_pipeline_output *out)
{
	out->fixation_count = messages->fixation_count;
	out->blink_count = messages->blink_count;
	out->saccade_count = messages->saccade_count;
	memcpy(out->fixations, messages->fixations, sizeof out->fixations);
	memcpy(out->blinks, messages->blinks, sizeof out->blinks);
	memcpy(out->saccades, messages->saccades, sizeof out->saccades);
}

/** One point out of the sample, without spikes. */
static struct gz_classify_input join(struct gz_pipeline *pipeline, const struct gz_sample *sample,
				     const struct gz_validate_output *valid,
				     struct gz_point *out_raw)
{
	struct gz_classify_input input = { .seq = sample->seq, .time_ns = sample->host_ns };
	if (valid->rejection != GZ_REJECT_NONE)
		return input;
	input.valid = true;
	gz_combine_step(&pipeline->combine, &pipeline->params.combine, &pipeline->display, sample,
			valid, out_raw, &input.confidence);
	bool restart = pipeline->event == GZ_EVENT_BLINK || pipeline->event == GZ_EVENT_LOST;
	input.point = gz_despike_step(&pipeline->despike, &pipeline->params.despike,
				      &pipeline->display, sample->host_ns, *out_raw, restart);
	return input;
}

static void take_label(const struct gz_classify_output *label, struct gz_gaze *gaze)
{
	gaze->event = label->event;
	gaze->velocity_deg_s = (float)label->velocity_deg_s;
	gaze->final_known = label->final_count > 0;
	if (!gaze->final_known)
		return;
	gaze->final_seq = label->final[label->final_count - 1].seq;
	gaze->final_span = gaze->final_seq - label->final[0].seq;
	gaze->final_event = label->final[0].event;
}

void gz_pipeline_step(struct gz_pipeline *pipeline, const struct gz_sample *sample,
		      struct gz_pipeline_output *out)
{
	const struct gz_pipeline_params *params = &pipeline->params;
	const struct gz_display *display = &pipeline->display;
	struct gz_validate_output valid =
		gz_validate_step(&pipeline->validate, &params->validate, display, sample);
	struct gz_sample corrected = *sample;
	gz_correct_step(&params->correct, &corrected);
	*out = (struct gz_pipeline_output) { .rejection = valid.rejection };
	out->gaze = message_of(pipeline, &corrected, &valid);
	if (valid.rejection == GZ_REJECT_TIME)
		return;

	struct gz_messages messages;
	struct gz_classify_input input = join(pipeline, &corrected, &valid, &out->gaze.raw);
	struct gz_classify_output label =
		gz_classify_step(&pipeline->classify, &params->classify, display, &input);
	gz_messages_step(&pipeline->messages, &params->classify, display, &label, input.time_ns,
			 &messages);
	copy_messages(&messages, out);
	take_label(&label, &out->gaze);
	measure_noise(pipeline, label.event, input.valid, out->gaze.raw);
	out->gaze.confidence = input.valid ? input.confidence : 0;
	out->gaze.point = gz_smooth_step(&pipeline->smooth, &params->smooth, display, label.event,
					 input.time_ns, input.valid, input.point);
	pipeline->host_ns = sample->host_ns;
	pipeline->event = label.event;
	pipeline->point = out->gaze.point;
}

double gz_pipeline_noise_deg(const struct gz_pipeline *pipeline)
{
	return pipeline->noise.count > 0 ? sqrt(pipeline->noise.mean_square_deg2) : NAN;
}
