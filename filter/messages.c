#include "filter/messages.h"

#include <math.h>

#include "base/clock.h"
#include "filter/angle.h"

/* Unit vectors of the directions in which outermost samples are kept. */
static const double DIRECTIONS[GZ_FIXATION_DIRECTIONS][2] = {
	{ 1, 0 },  { 0.70710678118654752, 0.70710678118654752 },
	{ 0, 1 },  { -0.70710678118654752, 0.70710678118654752 },
	{ -1, 0 }, { -0.70710678118654752, -0.70710678118654752 },
	{ 0, -1 }, { 0.70710678118654752, -0.70710678118654752 },
};

static double along(const struct gz_display *display, int direction, struct gz_point p)
{
	return DIRECTIONS[direction][0] * p.x * display->mm[0] +
	       DIRECTIONS[direction][1] * p.y * display->mm[1];
}

static void add_sample(struct gz_messages_fixation *fixation, const struct gz_display *display,
		       const struct gz_classify_final *final)
{
	for (int i = 0; i < GZ_FIXATION_DIRECTIONS; i++)
		if (fixation->count == 0 ||
		    along(display, i, final->point) > along(display, i, fixation->outermost[i]))
			fixation->outermost[i] = final->point;
	fixation->sum[0] += final->point.x;
	fixation->sum[1] += final->point.y;
	fixation->confidence_sum += final->confidence;
	fixation->count++;
	fixation->last_ns = final->time_ns;
}

static struct gz_fixation fixation_now(const struct gz_messages_fixation *fixation,
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
			  int64_t time_ns, bool final, struct gz_messages *out)
{
	fixation->announced = true;
	fixation->sent_ns = time_ns;
	out->fixations[out->fixation_count++] = fixation_now(fixation, display, final);
}

static void end_fixation(struct gz_messages_fixation *fixation, const struct gz_display *display,
			 int64_t time_ns, struct gz_messages *out)
{
	if (fixation->running && fixation->announced)
		send_fixation(fixation, display, time_ns, true, out);
	*fixation = (struct gz_messages_fixation) { .running = false };
}

static void follow_fixation(struct gz_messages_fixation *fixation,
			    const struct gz_classify_params *params,
			    const struct gz_display *display, const struct gz_classify_final *final,
			    int64_t time_ns, struct gz_messages *out)
{
	if (final->event != GZ_EVENT_FIXATION || final->after_loss)
		end_fixation(fixation, display, time_ns, out);
	if (final->event != GZ_EVENT_FIXATION || !final->valid)
		return;
	if (!fixation->running) {
		fixation->running = true;
		fixation->id = final->seq;
		fixation->onset_ns = final->time_ns;
	}
	add_sample(fixation, display, final);
	double lasted_ms = gz_ns_to_ms(fixation->last_ns - fixation->onset_ns);
	bool due = fixation->announced ? time_ns - fixation->sent_ns >= GZ_FIXATION_INTERVAL_NS
				       : lasted_ms >= params->fixation_min_ms;
	if (due)
		send_fixation(fixation, display, time_ns, false, out);
}

static void end_saccade(const struct gz_messages_saccade *saccade, const struct gz_display *display,
			const struct gz_classify_final *final, struct gz_messages *out)
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

static void follow_saccade(struct gz_messages_saccade *saccade, const struct gz_display *display,
			   const struct gz_classify_final *final, struct gz_messages *out)
{
	bool runs = final->event == GZ_EVENT_SACCADE;
	if (!final->valid && runs)
		return; /* a short dropout */
	if (saccade->running && !runs && final->valid && !final->after_loss)
		end_saccade(saccade, display, final, out);
	if (runs && (!saccade->running || final->after_loss)) {
		saccade->start_ns = final->time_ns;
		saccade->start = final->point;
	}
	saccade->running = runs;
}

static void send_blink(struct gz_messages *out, bool onset, int64_t time_ns, float confidence)
{
	out->blinks[out->blink_count++] = (struct gz_blink) {
		.onset = onset,
		.time_ns = time_ns,
		.confidence = confidence,
	};
}

static void follow_blink(struct gz_messages_state *state, const struct gz_classify_params *params,
			 const struct gz_classify_output *label, int64_t time_ns,
			 struct gz_messages *out)
{
	bool short_enough = gz_ns_to_ms(time_ns - label->last_valid_ns) <= params->blink_max_ms;
	if (!state->in_blink &&
	    (label->event == GZ_EVENT_BLINK || (label->resumed && short_enough))) {
		send_blink(out, true, label->last_valid_ns, 1);
		state->in_blink = true;
	}
	if (state->in_blink && label->event != GZ_EVENT_BLINK) {
		send_blink(out, false, time_ns, short_enough ? 1 : 0);
		state->in_blink = false;
	}
}

void gz_messages_step(struct gz_messages_state *state, const struct gz_classify_params *params,
		      const struct gz_display *display, const struct gz_classify_output *label,
		      int64_t time_ns, struct gz_messages *out)
{
	*out = (struct gz_messages) { .fixation_count = 0 };
	for (size_t i = 0; i < label->final_count; i++) {
		follow_fixation(&state->fixation, params, display, &label->final[i], time_ns, out);
		follow_saccade(&state->saccade, display, &label->final[i], out);
	}
	follow_blink(state, params, label, time_ns, out);
}
