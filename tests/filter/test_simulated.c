/*
 * What the pipeline achieves on simulated viewers, where the truth is known, and the time of a
 * step. Any option of the pipeline or the simulator may be given on the command line.
 */
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/order.h"
#include "filter/pipeline.h"
#include "sim/tracker.h"

static const double RATES_HZ[] = { 30, 60, 120, 250, 500, 1000, 1200, 2000 };
enum { RATE_COUNT = sizeof RATES_HZ / sizeof RATES_HZ[0], COUNT = 60000 };

/** Sums over one run. */
struct sums {
	double agree[GZ_EVENT_COUNT], truth[GZ_EVENT_COUNT], ours[GZ_EVENT_COUNT];
	double raw_off2, smooth_off2, raw_step2, smooth_step2, steps, fixated;
	double median_ns, late_ns; /* time of a step: median, and 99th percentile */
};

static double square(double x)
{
	return x * x;
}

static double kappa(const struct sums *s, enum gz_event event)
{
	double ours = s->ours[event], theirs = s->truth[event];
	double observed = (COUNT - ours - theirs + 2 * s->agree[event]) / COUNT;
	double chance = (ours * theirs + (COUNT - ours) * (COUNT - theirs)) / square(COUNT);
	return chance < 1 ? (observed - chance) / (1 - chance) : NAN;
}

static void compare(struct sums *s, const struct gz_display *display,
		    const struct gz_sim_sample *in, const struct gz_gaze *out,
		    const struct gz_sim_sample *last_in, const struct gz_gaze *last_out)
{
	if (in->truth.event != GZ_EVENT_FIXATION || last_in->truth.event != GZ_EVENT_FIXATION ||
	    isnan(out->raw.x) || isnan(last_out->raw.x))
		return;
	s->fixated++;
	s->raw_off2 += square(gz_display_angle_deg(display, out->raw, in->truth.point));
	s->smooth_off2 += square(gz_display_angle_deg(display, out->point, in->truth.point));
	s->raw_step2 += square(gz_display_angle_deg(display, out->raw, last_out->raw));
	s->smooth_step2 += square(gz_display_angle_deg(display, out->point, last_out->point));
}

/* The time of a step includes reading the clock, about 20 ns. */
static void time_steps(struct sums *sums, int64_t *step_ns)
{
	qsort(step_ns, COUNT, sizeof *step_ns, gz_compare_int64s);
	sums->median_ns = (double)step_ns[COUNT / 2];
	sums->late_ns = (double)step_ns[COUNT - COUNT / 100];
}

static int run(const struct gz_sim_params *sim, const struct gz_pipeline_params *params,
	       struct sums *sums)
{
	struct gz_sim_tracker *tracker = NULL;
	struct gz_sim_sample *in = calloc(COUNT, sizeof *in);
	struct gz_pipeline_output *out = calloc(COUNT, sizeof *out);
	enum gz_event *certain = calloc(COUNT, sizeof *certain);
	static int64_t step_ns[COUNT];
	bool ready = in && out && certain &&
		     gz_sim_tracker_create(sim, GZ_NS_PER_S, NULL, &tracker) == GZ_OK;
	if (ready) {
		struct gz_display display = gz_sim_tracker_display(tracker);
		struct gz_pipeline pipeline;
		gz_pipeline_init(&pipeline, params, &display);
		for (int i = 0; i < COUNT; i++)
			gz_sim_tracker_next(tracker, &in[i]);
		for (int i = 0; i < COUNT; i++) /* so that no page fault is measured */
			out[i].rejection = GZ_REJECT_COUNT;
		for (int i = 0; i < COUNT; i++) {
			int64_t begin_ns = gz_clock_now_ns();
			gz_pipeline_step(&pipeline, &in[i].sample, &out[i]);
			step_ns[i] = gz_clock_now_ns() - begin_ns;
			certain[i] = out[i].gaze.event;
			const struct gz_gaze *g = &out[i].gaze;
			for (uint64_t k = 0; g->final_known && k <= g->final_span; k++)
				certain[g->final_seq - k] = g->final_event;
		}
		time_steps(sums, step_ns);
		for (int i = 0; i < COUNT; i++) {
			sums->truth[in[i].truth.event]++;
			sums->ours[certain[i]]++;
			sums->agree[certain[i]] += certain[i] == in[i].truth.event;
			if (i > 0)
				compare(sums, &display, &in[i], &out[i].gaze, &in[i - 1],
					&out[i - 1].gaze);
		}
	}
	gz_sim_tracker_destroy(&tracker);
	free(in);
	free(out);
	free(certain);
	return ready;
}

static void print_sums(double rate_hz, const struct sums *s)
{
	printf("%6.0f  %6.3f %6.3f %6.3f %6.3f   %7.3f %7.3f   %7.3f %7.3f   %5.0f %5.0f\n",
	       rate_hz, kappa(s, GZ_EVENT_SACCADE), kappa(s, GZ_EVENT_FIXATION),
	       kappa(s, GZ_EVENT_PURSUIT), kappa(s, GZ_EVENT_BLINK), sqrt(s->raw_off2 / s->fixated),
	       sqrt(s->smooth_off2 / s->fixated), sqrt(s->raw_step2 / s->fixated),
	       sqrt(s->smooth_step2 / s->fixated), s->median_ns, s->late_ns);
}

TEST_SUITE(simulated)
{
	struct gz_log log;
	gz_log_init(&log, NULL, NULL, NULL);
	struct gz_pipeline_params params = gz_pipeline_default_params();
	struct gz_sim_params sim = gz_sim_default_params();
	sim.offset_deg = 0; /* a constant error is not caused by the filter */
	struct gz_option_binding bindings[] = {
		{ gz_pipeline_options, gz_pipeline_option_count, &params, NULL },
		{ gz_sim_options, gz_sim_option_count, &sim, NULL },
	};
	if (gz_options_read_arguments(bindings, 2, argc, argv, NULL, &log) != GZ_OK)
		return 2;
	printf("        kappa against the truth       RMS from truth    RMS step to step  step "
	       "ns\n");
	printf("    Hz  saccad fixati pursui blink     raw   smooth      raw   smooth deg median "
	       "99%%\n");
	for (int i = 0; i < RATE_COUNT; i++) {
		struct sums sums = { .steps = 0 };
		sim.rate_hz = RATES_HZ[i];
		if (!run(&sim, &params, &sums))
			return 1;
		print_sums(RATES_HZ[i], &sums);
	}
	return 0;
}
