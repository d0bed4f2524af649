#include "client/gazectl/validate/validation.h"

#include <stdlib.h>

/* When the eye came to rest after the first saccade that the target can have caused; its showing
 * where there was none. */
static int64_t landing_ns(const struct gz_gaze_trace *trace,
			  const struct gz_validation_target *target)
{
	size_t end = gz_gaze_trace_find(trace, target->hidden_ns);
	bool moved = false;
	for (size_t i = gz_gaze_trace_find(trace, target->shown_ns + GZ_VALIDATION_REACTION_NS);
	     i < end; i++) {
		enum gz_event event = trace->items[i].event;
		if (event == GZ_EVENT_SACCADE)
			moved = true;
		else if (moved && event == GZ_EVENT_FIXATION)
			return trace->items[i].sample.host_ns;
	}
	return target->shown_ns;
}

static void find_samples(const struct gz_gaze_trace *trace, struct gz_validation_target *target)
{
	int64_t landed_ns = landing_ns(trace, target);
	target->begin_ns = target->shown_ns + GZ_VALIDATION_SETTLE_NS;
	if (landed_ns > target->begin_ns)
		target->begin_ns = landed_ns;
	if (target->begin_ns > target->hidden_ns)
		target->begin_ns = target->hidden_ns;
	target->first = gz_gaze_trace_find(trace, target->begin_ns);
	target->count = gz_gaze_trace_find(trace, target->hidden_ns) - target->first;
}

static void measure_target(const struct gz_validation *validation,
			   const struct gz_quality_sample *samples, int64_t period_ns,
			   struct gz_validation_target *target)
{
	const struct gz_quality_input input = {
		.display = &validation->status.display,
		.target = target->point,
		.samples = samples + target->first,
		.count = target->count,
		.begin_ns = target->begin_ns,
		.end_ns = target->hidden_ns,
		.period_ns = period_ns,
	};
	for (int i = 0; i < GZ_TRACE_COUNT; i++)
		gz_quality_measure(&input, (enum gz_trace)i, &target->quality[i]);
}

static void summarise(struct gz_validation *validation)
{
	static const size_t max = GZ_FIT_TARGETS_MAX;
	size_t count = validation->target_count < max ? validation->target_count : max;
	struct gz_quality quality[GZ_FIT_TARGETS_MAX];
	struct gz_fit_pair pairs[GZ_FIT_TARGETS_MAX];
	for (int trace = 0; trace < GZ_TRACE_COUNT; trace++) {
		for (size_t i = 0; i < count; i++)
			quality[i] = validation->target[i].quality[trace];
		gz_quality_summarise(quality, count, &validation->summary[trace]);
	}
	for (size_t i = 0; i < count; i++)
		pairs[i] = (struct gz_fit_pair) {
			validation->target[i].point,
			validation->target[i].quality[GZ_TRACE_BOTH].mean,
		};
	gz_fit_correction(&validation->status.display, pairs, count, &validation->fit);
}

enum gz_result gz_validation_evaluate(struct gz_validation *validation)
{
	const struct gz_gaze_trace *trace = &validation->trace;
	if (!gz_display_valid(&validation->status.display))
		return GZ_ERR_INVAL;
	struct gz_quality_sample *samples = calloc(trace->count + 1, sizeof *samples);
	if (!samples)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i < trace->count; i++)
		samples[i] = trace->items[i].sample;
	int64_t period_ns = gz_quality_period_ns(samples, trace->count);
	for (size_t i = 0; period_ns >= 0 && i < validation->target_count; i++) {
		find_samples(trace, &validation->target[i]);
		measure_target(validation, samples, period_ns, &validation->target[i]);
	}
	free(samples);
	if (period_ns < 0)
		return GZ_ERR_NO_MEM;
	summarise(validation);
	return GZ_OK;
}
