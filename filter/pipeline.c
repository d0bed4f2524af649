#include "filter/pipeline.h"

#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "filter/angle.h"
#include "filter/classifier/forest_lists.h"

/* Most steps that the mean of the noise takes into account. Chosen: seconds to minutes. */
static const double NOISE_COUNT_MAX = 20000;

/* How long a lid that closes holds the point. Chosen: until it hides the pupil, and less than what
 * starts the smoothing again (GZ_SMOOTH_GAP_NS). */
static const int64_t LID_HOLD_NS = 40 * GZ_NS_PER_MS;

void gz_pipeline_init(struct gz_pipeline *pipeline, const struct gz_pipeline_params *params,
		      const struct gz_display *display)
{
	*pipeline = (struct gz_pipeline) {
		.params = params ? *params : gz_pipeline_default_params(),
		.display = *display,
		.event = GZ_EVENT_LOST,
		.point = { 0.5f, 0.5f },
	};
	if (pipeline->params.classify.source != GZ_CLASSIFY_LEARNED)
		return;
	/* Made here, because a step does not allocate. */
	(void)gz_forest_lists_of(&gz_forest_at_once);
	(void)gz_forest_lists_of(&gz_forest_certain);
}

/* Unit vectors of the directions in which the outermost samples of a fixation are kept. */
static const double DIRECTIONS[GZ_FIXATION_DIRECTIONS][2] = {
	{ 1, 0 },  { 0.70710678118654752, 0.70710678118654752 },
	{ 0, 1 },  { -0.70710678118654752, 0.70710678118654752 },
	{ -1, 0 }, { -0.70710678118654752, -0.70710678118654752 },
	{ 0, -1 }, { 0.70710678118654752, -0.70710678118654752 },
};

static double extent_along(const struct gz_display *display, int direction, struct gz_point p)
{
	return DIRECTIONS[direction][0] * p.x * display->mm[0] +
	       DIRECTIONS[direction][1] * p.y * display->mm[1];
}

static void add_to_fixation(struct gz_messages_fixation *fixation, const struct gz_display *display,
			    const struct gz_classify_final *final)
{
	for (int i = 0; i < GZ_FIXATION_DIRECTIONS; i++)
		if (fixation->count == 0 ||
		    extent_along(display, i, final->point) >
			    extent_along(display, i, fixation->outermost[i]))
			fixation->outermost[i] = final->point;
	fixation->sum[0] += final->point.x;
	fixation->sum[1] += final->point.y;
	fixation->confidence_sum += final->confidence;
	fixation->count++;
	fixation->last_ns = final->time_ns;
}

static struct gz_fixation fixation_message(const struct gz_messages_fixation *fixation,
					   const struct gz_display *display, bool final)
{
	double count = (double)fixation->count;
	struct gz_fixation message = {
		.id = fixation->id,
		.onset_ns = fixation->onset_ns,
		.duration_ns = fixation->last_ns - fixation->onset_ns,
		.point = { (float)(fixation->sum[0] / count), (float)(fixation->sum[1] / count) },
		.confidence = (float)(fixation->confidence_sum / count),
		.final = final,
	};
	double farthest_deg = 0;
	for (int i = 0; i < GZ_FIXATION_DIRECTIONS; i++)
		farthest_deg = fmax(farthest_deg,
				    gz_chord_deg(display, message.point, fixation->outermost[i]));
	message.dispersion_deg = (float)farthest_deg;
	return message;
}

static void send_fixation(struct gz_messages_fixation *fixation, const struct gz_display *display,
			  int64_t time_ns, bool final, struct gz_pipeline_output *out)
{
	fixation->announced = true;
	fixation->sent_ns = time_ns;
	out->fixations[out->fixation_count++] = fixation_message(fixation, display, final);
}

static void finish_fixation(struct gz_messages_fixation *fixation, const struct gz_display *display,
			    int64_t time_ns, struct gz_pipeline_output *out)
{
	if (fixation->running && fixation->announced)
		send_fixation(fixation, display, time_ns, true, out);
	*fixation = (struct gz_messages_fixation) { .running = false };
}

static void update_fixation_message(struct gz_messages_fixation *fixation,
				    const struct gz_classify_params *params,
				    const struct gz_display *display,
				    const struct gz_classify_final *final, int64_t time_ns,
				    struct gz_pipeline_output *out)
{
	if (final->event != GZ_EVENT_FIXATION || final->after_loss)
		finish_fixation(fixation, display, time_ns, out);
	if (final->event != GZ_EVENT_FIXATION || !final->valid)
		return;
	if (!fixation->running) {
		fixation->running = true;
		fixation->id = final->seq;
		fixation->onset_ns = final->time_ns;
	}
	add_to_fixation(fixation, display, final);
	double lasted_ms = gz_ns_to_ms(fixation->last_ns - fixation->onset_ns);
	bool due = fixation->announced ? time_ns - fixation->sent_ns >= GZ_FIXATION_INTERVAL_NS
				       : lasted_ms >= params->fixation_min_ms;
	if (due)
		send_fixation(fixation, display, time_ns, false, out);
}

static void send_saccade(const struct gz_messages_saccade *saccade,
			 const struct gz_display *display, const struct gz_classify_final *final,
			 struct gz_pipeline_output *out)
{
	out->saccades[out->saccade_count++] = (struct gz_saccade) {
		.start_ns = saccade->start_ns,
		.duration_ns = final->time_ns - saccade->start_ns,
		.amplitude_deg = (float)gz_display_angle_deg(display, saccade->start, final->point),
		.peak_velocity_deg_s = (float) final->peak_deg_s,
		.start = saccade->start,
		.end = final->point,
	};
}

static void update_saccade_message(struct gz_messages_saccade *saccade,
				   const struct gz_display *display,
				   const struct gz_classify_final *final,
				   struct gz_pipeline_output *out)
{
	bool runs = final->event == GZ_EVENT_SACCADE;
	if (!final->valid && runs)
		return; /* a short dropout */
	if (saccade->running && !runs && final->valid && !final->after_loss)
		send_saccade(saccade, display, final, out);
	if (runs && (!saccade->running || final->after_loss)) {
		saccade->start_ns = final->time_ns;
		saccade->start = final->point;
	}
	saccade->running = runs;
}

static void send_blink(struct gz_pipeline_output *out, bool onset, int64_t time_ns,
		       float confidence)
{
	out->blinks[out->blink_count++] = (struct gz_blink) {
		.onset = onset,
		.time_ns = time_ns,
		.confidence = confidence,
	};
}

/* A blink is announced once nothing is measured, or the pupil tells of the lid; it has begun before
 * that if a lid moved the point. Movement of that kind alone is not announced. */
static void update_blink_message(struct gz_messages_state *state,
				 const struct gz_classify_params *params,
				 const struct gz_classify_output *label,
				 const struct gz_classify_input *input,
				 struct gz_pipeline_output *out)
{
	int64_t time_ns = input->time_ns;
	bool short_enough = gz_ns_to_ms(time_ns - label->last_valid_ns) <= params->blink_max_ms;
	bool unseen = !input->valid || input->lid;
	if (!state->in_blink &&
	    ((label->event == GZ_EVENT_BLINK && unseen) || (label->resumed && short_enough))) {
		send_blink(out, true, label->last_valid_ns, 1);
		state->in_blink = true;
	}
	if (state->in_blink && label->event != GZ_EVENT_BLINK) {
		send_blink(out, false, time_ns, short_enough ? 1 : 0);
		state->in_blink = false;
	}
}

static void make_messages(struct gz_pipeline *pipeline, const struct gz_classify_output *label,
			  const struct gz_classify_input *input, struct gz_pipeline_output *out)
{
	struct gz_messages_state *state = &pipeline->messages;
	const struct gz_classify_params *params = &pipeline->params.classify;
	const struct gz_display *display = &pipeline->display;
	for (size_t i = 0; i < label->final_count; i++) {
		const struct gz_classify_final *final = &label->final[i];
		update_fixation_message(&state->fixation, params, display, final, input->time_ns,
					out);
		update_saccade_message(&state->saccade, display, final, out);
	}
	update_blink_message(state, params, label, input, out);
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

/* The part of a gaze message that does not depend on the eyes' movement. */
static struct gz_gaze begin_gaze_message(const struct gz_pipeline *pipeline,
					 const struct gz_sample *sample,
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

static void measure_fixation_noise(struct gz_pipeline *pipeline, enum gz_event event, bool valid,
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

/* Reduce the sample to one point without spikes. */
static struct gz_classify_input reduce_sample(struct gz_pipeline *pipeline,
					      const struct gz_sample *sample,
					      const struct gz_validate_output *valid,
					      struct gz_point *out_raw)
{
	struct gz_classify_input input = { .seq = sample->seq,
					   .time_ns = sample->host_ns,
					   .still_scene = sample->still_scene };
	if (valid->rejection != GZ_REJECT_NONE)
		return input;
	input.valid = true;
	struct gz_combine_output combined = gz_combine_step(
		&pipeline->combine, &pipeline->params.combine, &pipeline->display, sample, valid);
	input.raw = *out_raw = combined.point;
	input.confidence = combined.confidence;
	bool restart = pipeline->event == GZ_EVENT_BLINK || pipeline->event == GZ_EVENT_LOST;
	input.point = gz_despike_step(&pipeline->despike, &pipeline->params.despike,
				      &pipeline->display, sample->host_ns, *out_raw, restart);
	struct gz_lid_output lid =
		gz_lid_step(&pipeline->lid, &pipeline->params.lid, &pipeline->display, sample,
			    *out_raw, input.confidence);
	input.lid = lid.covers;
	input.lid_since_ns = lid.since_ns;
	return input;
}

static void set_gaze_label(const struct gz_classify_output *label, struct gz_gaze *gaze)
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
	out->gaze = begin_gaze_message(pipeline, &corrected, &valid);
	if (valid.rejection == GZ_REJECT_TIME)
		return;

	struct gz_classify_input input =
		reduce_sample(pipeline, &corrected, &valid, &out->gaze.raw);
	struct gz_classify_output label;
	gz_classify_step(&pipeline->classify, &params->classify, display, &input, &label);
	make_messages(pipeline, &label, &input, out);
	set_gaze_label(&label, &out->gaze);
	const struct gz_landing_input landing_input = { label.event, input.time_ns, input.valid,
							input.point };
	out->gaze.landing =
		gz_landing_step(&pipeline->landing, &gz_landing_model, display, &landing_input);
	measure_fixation_noise(pipeline, label.event, input.valid, out->gaze.raw);
	bool hidden = label.event == GZ_EVENT_BLINK || label.event == GZ_EVENT_LOST;
	out->gaze.confidence = input.valid && !hidden ? input.confidence : 0;
	/* While a lid closes, an eye that rested is where it was. When it opens, the point follows,
	 * so that it does not jump in the fixation after that. */
	bool closing = input.lid && input.time_ns - label.last_valid_ns <= LID_HOLD_NS &&
		       pipeline->smooth.mode == GZ_EVENT_FIXATION;
	const struct gz_smooth_input smooth_input = { label.event, input.time_ns,
						      input.valid && !closing, input.point };
	out->gaze.point =
		gz_smooth_step(&pipeline->smooth, &params->smooth, display, &smooth_input);
	pipeline->host_ns = sample->host_ns;
	pipeline->event = label.event;
	pipeline->point = out->gaze.point;
}

bool gz_pipeline_flush(struct gz_pipeline *pipeline, struct gz_gaze *out)
{
	struct gz_classify_output label;
	gz_classify_flush(&pipeline->classify, &pipeline->params.classify, &label);
	if (label.final_count == 0)
		return false;
	*out = (struct gz_gaze) { .host_ns = pipeline->host_ns };
	set_gaze_label(&label, out);
	return true;
}

double gz_pipeline_noise_deg(const struct gz_pipeline *pipeline)
{
	return pipeline->noise.count > 0 ? sqrt(pipeline->noise.mean_square_deg2) : NAN;
}
