/* The row about borders: error on both sides of where spacings change. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/stability/stability_bench.h"
#include "render/plan/method.h"

/* The border moves by one ring a frame, so that each pixel is seen on both of its sides and what
 * the picture shows there cancels. */
enum { RINGS = 512, SWEEP_FRAMES = 20, RING_PX = 4 };

/* Chosen: as wide as hides the borders of the scenes in docs/results.md. */
#define BAND_PX 16

/* Where there is hardly a step without a band, there may be as little of one with it. */
#define SLACK_LEVELS 0.05

struct sweep {
	struct gz_stability_view view;
	struct gz_foveation foveation;
	struct gz_image image;
	int16_t *rings[2]; /* of the last frame and this, a pixel each; -1 = none */
	uint8_t *errors[2];
	double change[RINGS]; /* of error from ring i to i + 1: sums over pixels that went over */
	size_t crossed[RINGS];
};

/* Signed distance in px to the border of a region, along its shorter half axis. */
static double beyond_rim_px(const struct gz_region *region, double x, double y)
{
	const double u = fabs(x - region->centre_px[0]) / region->half_px[0];
	const double v = fabs(y - region->centre_px[1]) / region->half_px[1];
	const double r = region->shape == GZ_REGION_ELLIPSE ? hypot(u, v) : fmax(u, v);
	return (r - 1) * fmin(region->half_px[0], region->half_px[1]);
}

/* Which ring a pixel is in: of regions round the nearest border, of the others by eccentricity. */
static int ring_at(const struct gz_plan *plan, const struct sweep *sweep, struct gz_point gaze,
		   int x, int y)
{
	double place = 0;
	if (plan->reconstruction == GZ_RECONSTRUCT_PYRAMID) {
		const struct gz_point at = { (float)((x + 0.5) / sweep->view.width),
					     (float)((y + 0.5) / sweep->view.height) };
		place = gz_display_angle_deg(&sweep->view.display, gaze, at) *
			gz_display_px_per_deg(&sweep->view.display) / RING_PX;
	} else {
		double nearest = INFINITY;
		int border = 0;
		for (int i = 0; i + 1 < plan->layer_count; i++) {
			const double px = beyond_rim_px(&plan->layers[i].region, x, y);
			if (fabs(px) < fabs(nearest)) {
				nearest = px;
				border = i;
			}
		}
		/* 64 rings a border, its rim between the middle two */
		if (fabs(nearest) >= 30 * RING_PX)
			return -1;
		place = 64 * border + 32 + nearest / RING_PX;
	}
	return place >= 0 && place < RINGS ? (int)place : -1;
}

static void see_frame(const struct gz_plan *plan, struct sweep *sweep, struct gz_point gaze,
		      const struct gz_image *wanted, int now, bool first)
{
	size_t pixel = 0;
	for (int y = 0; y < sweep->view.height; y++)
		for (int x = 0; x < sweep->view.width; x++, pixel++) {
			const int ring = ring_at(plan, sweep, gaze, x, y);
			const int error = gz_stability_apart(&sweep->image, wanted, pixel);
			const int ring_before = sweep->rings[1 - now][pixel];
			const int error_before = sweep->errors[1 - now][pixel];
			sweep->rings[now][pixel] = (int16_t)ring;
			sweep->errors[now][pixel] = (uint8_t)error;
			if (first || ring < 0 || ring_before < 0 || abs(ring - ring_before) != 1)
				continue;
			const int inner = ring < ring_before ? ring : ring_before;
			sweep->change[inner] += (error - error_before) * (ring - ring_before);
			sweep->crossed[inner]++;
		}
}

static enum gz_result run_sweep(struct gz_stability_bench *bench, struct sweep *sweep,
				const struct gz_image *wanted)
{
	enum gz_result result = GZ_OK;
	memset(sweep->change, 0, sizeof sweep->change);
	memset(sweep->crossed, 0, sizeof sweep->crossed);
	for (int i = 0; i < SWEEP_FRAMES && result == GZ_OK; i++) {
		/* along a line that no edge of a region is parallel to */
		const struct gz_point gaze = {
			(float)(0.45 + 0.9 * RING_PX * i / sweep->view.width),
			(float)(0.47 + 0.44 * RING_PX * i / sweep->view.height)
		};
		result = gz_stability_frame_at(bench, &bench->settings.scene, &sweep->foveation,
					       &sweep->view, gaze, &sweep->image);
		if (result == GZ_OK)
			see_frame(&bench->plan, sweep, gaze, wanted, i % 2, i == 0);
	}
	return result;
}

/* The greatest change of mean error over a border that enough pixels went over. */
static double greatest_step(const struct sweep *sweep)
{
	double greatest = 0;
	for (int i = 0; i < RINGS; i++)
		if (sweep->crossed[i] >= 300)
			greatest =
				fmax(greatest, fabs(sweep->change[i]) / (double)sweep->crossed[i]);
	return greatest;
}

static enum gz_result prepare(const struct gz_stability_bench *bench, struct sweep *sweep)
{
	sweep->view = gz_stability_scene_view(bench);
	sweep->foveation = bench->foveation;
	const size_t pixels = (size_t)sweep->view.width * (size_t)sweep->view.height;
	for (int i = 0; i < 2; i++) {
		sweep->rings[i] = malloc(pixels * sizeof *sweep->rings[i]);
		sweep->errors[i] = malloc(pixels);
		if (!sweep->rings[i] || !sweep->errors[i])
			return GZ_ERR_NO_MEM;
	}
	return GZ_OK;
}

static void release(struct sweep *sweep)
{
	for (int i = 0; i < 2; i++) {
		free(sweep->rings[i]);
		free(sweep->errors[i]);
	}
	gz_image_free(&sweep->image);
}

static const char step_of_error[] = "step of the mean error over a border, grey levels";

/* acuity and table: spacings grow so gradually that none is seen. */
static enum gz_result check_gradual(struct gz_stability_bench *bench, struct sweep *sweep,
				    const struct gz_image *wanted,
				    struct gz_stability_outcome *outcome)
{
	gz_stability_name(outcome, 0, step_of_error, 0.5);
	const enum gz_result result = run_sweep(bench, sweep, wanted);
	if (result != GZ_OK)
		return result;
	return gz_stability_take(outcome, 0, greatest_step(sweep),
				 (struct gz_stability_place) { 0 }, "rings of %d px", RING_PX);
}

/* Regions: a band hides what a hard border shows. */
static enum gz_result check_band(struct gz_stability_bench *bench, struct sweep *sweep,
				 const struct gz_image *wanted,
				 struct gz_stability_outcome *outcome)
{
	const double band_px = bench->foveation.blend_px > 0 ? bench->foveation.blend_px : BAND_PX;
	sweep->foveation.blend_px = 0;
	enum gz_result result = run_sweep(bench, sweep, wanted);
	if (result != GZ_OK)
		return result;
	const double hard = greatest_step(sweep);
	gz_stability_name(outcome, 0, step_of_error, hard + SLACK_LEVELS);
	sweep->foveation.blend_px = band_px;
	result = run_sweep(bench, sweep, wanted);
	if (result != GZ_OK)
		return result;
	return gz_stability_take(
		outcome, 0, greatest_step(sweep), (struct gz_stability_place) { 0 },
		"a band of %g px, the bound without one; rings of %d px", band_px, RING_PX);
}

enum gz_result gz_stability_border(struct gz_stability_bench *bench,
				   struct gz_stability_outcome *outcome)
{
	const struct gz_method *method = gz_method_of(&bench->foveation);
	if (!method->follows_gaze) {
		outcome->verdict = GZ_STABILITY_APART;
		snprintf(outcome->note, sizeof outcome->note, "one spacing has no border");
		return GZ_OK;
	}
	struct sweep sweep = { 0 };
	const struct gz_image *wanted = NULL;
	enum gz_result result = prepare(bench, &sweep);
	if (result == GZ_OK)
		result = gz_stability_converged_picture(bench, &bench->settings.scene, &sweep.view,
							&wanted);
	if (result == GZ_OK)
		result = method->is_pyramid ? check_gradual(bench, &sweep, wanted, outcome)
					    : check_band(bench, &sweep, wanted, outcome);
	release(&sweep);
	return result;
}
