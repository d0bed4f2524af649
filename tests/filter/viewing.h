/**
 * @file
 * A simulated viewer and tracker followed by the pipeline, for the tests.
 */
#ifndef GZ_TESTS_FILTER_VIEWING_H
#define GZ_TESTS_FILTER_VIEWING_H

#include "filter/check.h"
#include "filter/tested_params.h"

#include "base/clock.h"
#include "filter/pipeline.h"
#include "sim/tracker.h"

/** Time of exposure of the first sample. */
#define VIEWING_START_NS INT64_C(5000000000)

/** Rates at which the pipeline is tested, Hz. */
static const double RATES_HZ[] = { 30, 60, 120, 250, 300, 500, 1000, 1200, 2000 };
enum { RATE_COUNT = sizeof RATES_HZ / sizeof RATES_HZ[0] };

/** A simulator followed by a pipeline. */
struct viewing {
	struct gz_sim_tracker *tracker;
	struct gz_pipeline pipeline;
	struct gz_sim_sample in;
	struct gz_pipeline_output out;
	bool still_scene; /**< of the next sample */
};

static inline void viewing_open(struct viewing *viewing, const struct gz_sim_params *params)
{
	*viewing = (struct viewing) { .tracker = NULL };
	assert_int_equal(gz_sim_tracker_create(params, VIEWING_START_NS, NULL, &viewing->tracker),
			 GZ_OK);
	struct gz_display display = gz_sim_tracker_display(viewing->tracker);
	gz_pipeline_init(&viewing->pipeline, &tested_params, &display);
}

/** Pass the next sample through the pipeline. */
static inline void viewing_step(struct viewing *viewing)
{
	gz_sim_tracker_next(viewing->tracker, &viewing->in);
	viewing->in.sample.still_scene = viewing->still_scene;
	gz_pipeline_step(&viewing->pipeline, &viewing->in.sample, &viewing->out);
}

static inline void viewing_close(struct viewing *viewing)
{
	gz_sim_tracker_destroy(&viewing->tracker);
}

static inline struct gz_sim_params sim_params(double rate_hz)
{
	struct gz_sim_params params = gz_sim_default_params();
	params.rate_hz = rate_hz;
	return params;
}

static inline double angle_deg(const struct viewing *viewing, struct gz_point a, struct gz_point b)
{
	return gz_display_angle_deg(&viewing->pipeline.display, a, b);
}

#endif
