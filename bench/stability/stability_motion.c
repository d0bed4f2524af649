/* Rows about a gaze that moves over a still picture. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/stability/stability_bench.h"
#include "render/attention/attention.h"
#include "render/plan/method.h"

enum { PATH_MAX_POINTS = 32 };

/* Two frames in turn and their common fovea. */
struct motion {
	struct gz_stability_view view;
	struct gz_foveation foveation;
	const char *what;
	struct gz_point path[PATH_MAX_POINTS];
	int count;
	struct gz_image frames[2];
	uint8_t *fovea;
};

/* Change from one frame to the next. */
static enum gz_result take_change(const struct motion *motion, int newest,
				  struct gz_stability_outcome *outcome)
{
	const struct gz_image *now = &motion->frames[newest], *before = &motion->frames[1 - newest];
	const size_t pixels = (size_t)motion->view.width * (size_t)motion->view.height;
	size_t outside = 0, worst_within = 0, worst_outside = 0;
	int most_within = 0, most_outside = 0;
	double sum = 0;
	for (size_t i = 0; i < pixels; i++) {
		const int apart = gz_stability_apart(now, before, i);
		if (!motion->fovea[i]) {
			sum += apart;
			outside++;
		}
		int *most = motion->fovea[i] ? &most_within : &most_outside;
		if (apart > *most) {
			*most = apart;
			*(motion->fovea[i] ? &worst_within : &worst_outside) = i;
		}
	}
	const char *rule = gz_step_rule_names[motion->foveation.step_rule];
	enum gz_result result = gz_stability_take(
		outcome, 0, most_within, (struct gz_stability_place) { now, before, worst_within },
		"%s, steps by %s", motion->what, rule);
	if (result == GZ_OK)
		result = gz_stability_take(
			outcome, 1, outside ? sum / (double)outside : 0,
			(struct gz_stability_place) { now, before, worst_outside },
			"%s, steps by %s; a pixel by %d at most", motion->what, rule, most_outside);
	return result;
}

static enum gz_result follow(struct gz_stability_bench *bench, struct motion *motion,
			     struct gz_stability_outcome *outcome)
{
	enum gz_result result = GZ_OK;
	for (int i = 0; i < motion->count && result == GZ_OK; i++) {
		result = gz_stability_frame_at(bench, &bench->settings.scene, &motion->foveation,
					       &motion->view, motion->path[i],
					       &motion->frames[i % 2]);
		if (result != GZ_OK || i == 0)
			continue;
		gz_stability_mark_fovea(&motion->foveation, &motion->view, motion->path[i - 1],
					false, motion->fovea);
		gz_stability_mark_fovea(&motion->foveation, &motion->view, motion->path[i], true,
					motion->fovea);
		result = take_change(motion, i % 2, outcome);
	}
	return result;
}

/* The path by every step rule. */
static enum gz_result flicker(struct gz_stability_bench *bench, struct motion *motion,
			      struct gz_stability_outcome *outcome)
{
	int rules[GZ_STABILITY_RULES_MAX];
	const int count = gz_stability_rules(bench, rules);
	motion->fovea = malloc((size_t)motion->view.width * (size_t)motion->view.height);
	enum gz_result result = motion->fovea ? GZ_OK : GZ_ERR_NO_MEM;
	for (int i = 0; i < count && result == GZ_OK; i++) {
		motion->foveation.step_rule = rules[i];
		result = follow(bench, motion, outcome);
	}
	free(motion->fovea);
	gz_image_free(&motion->frames[0]);
	gz_image_free(&motion->frames[1]);
	return result;
}

static const char in_fovea[] = "greatest change in the fovea, grey levels";
static const char elsewhere[] = "mean change elsewhere, grey levels a frame";

enum gz_result gz_stability_tremble(struct gz_stability_bench *bench,
				    struct gz_stability_outcome *outcome)
{
	static const int tremor_px[][2] = { { 0, 0 },  { 1, 0 },  { 1, 1 },   { 0, 1 }, { 0, 0 },
					    { -1, 0 }, { 0, -1 }, { -1, -1 }, { 0, 0 } };
	struct motion motion = { .view = gz_stability_scene_view(bench),
				 .foveation = bench->foveation,
				 .what = "a tremor of 1 px",
				 .count = sizeof tremor_px / sizeof tremor_px[0] };
	for (int i = 0; i < motion.count; i++)
		motion.path[i] = (struct gz_point) {
			0.45F + (float)tremor_px[i][0] / (float)motion.view.width,
			0.5F + (float)tremor_px[i][1] / (float)motion.view.height
		};
	gz_stability_name(outcome, 0, in_fovea, 0);
	gz_stability_name(outcome, 1, elsewhere, 0.5);
	return flicker(bench, &motion, outcome);
}

enum gz_result gz_stability_pursuit(struct gz_stability_bench *bench,
				    struct gz_stability_outcome *outcome)
{
	struct motion motion = { .view = gz_stability_scene_view(bench),
				 .foveation = bench->foveation,
				 .what = "a pursuit of 15 degrees a second at 60 Hz",
				 .count = 24 };
	/* a quarter of a degree a frame, down to the right */
	const double px = 0.25 * gz_display_px_per_deg(&motion.view.display);
	for (int i = 0; i < motion.count; i++)
		motion.path[i] =
			(struct gz_point) { (float)(0.4 + i * px * 0.9 / motion.view.width),
					    (float)(0.45 + i * px * 0.436 / motion.view.height) };
	gz_stability_name(outcome, 0, in_fovea, 0);
	gz_stability_name(outcome, 1, elsewhere, 0.5);
	return flicker(bench, &motion, outcome);
}

/* A saccade along the picture's middle: where it begins and ends, by its angle at the eye. */
static bool saccade_ends(const struct gz_display *display, double angle_deg,
			 struct gz_point out_ends[2])
{
	double least = 0, most = 0.5;
	for (int i = 0; i < 40; i++) {
		const double half = (least + most) / 2;
		out_ends[0] = (struct gz_point) { (float)(0.5 - half), 0.5F };
		out_ends[1] = (struct gz_point) { (float)(0.5 + half), 0.5F };
		if (gz_display_angle_deg(display, out_ends[0], out_ends[1]) < angle_deg)
			least = half;
		else
			most = half;
	}
	return least < 0.499;
}

#define SACCADE_DEG 20
/* 2.2 ms a degree and 21 ms (Carpenter, Movements of the Eyes, 1988). */
#define SACCADE_MS 65
#define SAMPLE_NS  1000000  /* a tracker of 1 kHz */
#define FRAME_NS   16666667 /* 60 Hz */

/* Where the eye is so long after it began to move: a path of least jerk. */
static struct gz_point on_way(const struct gz_point ends[2], double ms)
{
	const double t = fmin(fmax(ms / SACCADE_MS, 0), 1);
	const double share = t * t * t * (10 + t * (6 * t - 15));
	return (struct gz_point) { (float)(ends[0].x + share * (double)(ends[1].x - ends[0].x)),
				   (float)(ends[0].y + share * (double)(ends[1].y - ends[0].y)) };
}

/* What the first frame goes by that knows of the landing, which comes so long before it. */
static struct gz_focus landing_focus(const struct gz_display *display,
				     const struct gz_point ends[2], int64_t before_ns)
{
	const struct gz_attention_params params = gz_attention_default();
	struct gz_attention attention;
	struct gz_focus focus = { 0 };
	const int64_t landing_ns = SACCADE_MS * 1000000LL;
	gz_attention_init(&attention, &params);
	for (int64_t now_ns = landing_ns + before_ns - 20 * (int64_t)FRAME_NS;
	     now_ns <= landing_ns + before_ns; now_ns += FRAME_NS) {
		const int64_t sample_ns = (int64_t)floor((double)now_ns / SAMPLE_NS) * SAMPLE_NS;
		const struct gz_attention_gaze gaze = {
			.known = true,
			.point = on_way(ends, (double)sample_ns / 1e6),
			.has_age = true,
			.age_ns = now_ns - sample_ns,
			.has_event = true,
			.event = sample_ns > 0 && sample_ns < landing_ns ? GZ_EVENT_SACCADE
									 : GZ_EVENT_FIXATION,
			.noise_deg = NAN,
		};
		focus = gz_attention_step(&attention, &gaze, display, now_ns);
	}
	return focus;
}

/* Saccades between two places and the reference of their landing. */
struct landing {
	struct gz_point ends[2];
	struct gz_foveation foveation;
	struct gz_image full, image; /* by `standard`, and under test */
	uint8_t *fovea;              /* marks of pixels */
};

/* The fovea of one frame against `standard`. */
static enum gz_result check_landing(struct gz_stability_bench *bench, struct landing *landing,
				    int64_t before_ns, struct gz_stability_outcome *outcome)
{
	const struct gz_stability_view view = gz_stability_scene_view(bench);
	const struct gz_focus focus = landing_focus(&view.display, landing->ends, before_ns);
	const struct gz_stability_scene *scene = &bench->settings.scene;
	const struct gz_stability_shot shot = { &landing->foveation, &view, focus, NULL };
	const enum gz_result result = gz_stability_frame(bench, scene, &shot, &landing->image);
	if (result != GZ_OK)
		return result;
	size_t blurred = 0, worst = 0;
	int most = -1;
	gz_stability_mark_fovea(&landing->foveation, &view, landing->ends[1], false,
				landing->fovea);
	for (size_t i = 0; i < (size_t)view.width * (size_t)view.height; i++) {
		const int apart = landing->fovea[i]
					  ? gz_stability_apart(&landing->image, &landing->full, i)
					  : 0;
		blurred += apart > 0;
		if (apart > most) {
			most = apart;
			worst = i;
		}
	}
	return gz_stability_take(
		outcome, 0, (double)blurred,
		(struct gz_stability_place) { &landing->image, &landing->full, worst },
		"%.1f ms after the landing, steps by %s", (double)before_ns / 1e6,
		gz_step_rule_names[landing->foveation.step_rule]);
}

/* By each step rule, the landing at each phase of the frames. */
static enum gz_result check_landings(struct gz_stability_bench *bench, struct landing *landing,
				     struct gz_stability_outcome *outcome)
{
	int rules[GZ_STABILITY_RULES_MAX];
	const int count = gz_stability_rules(bench, rules);
	enum gz_result result = GZ_OK;
	for (int i = 0; i < count && result == GZ_OK; i++) {
		landing->foveation.step_rule = rules[i];
		for (int phase = 0; phase < 4 && result == GZ_OK; phase++)
			result = check_landing(bench, landing, phase * (int64_t)FRAME_NS / 4,
					       outcome);
	}
	return result;
}

enum gz_result gz_stability_saccade(struct gz_stability_bench *bench,
				    struct gz_stability_outcome *outcome)
{
	const struct gz_stability_view view = gz_stability_scene_view(bench);
	struct landing landing = { .foveation = bench->foveation };
	const bool sharp = gz_method_of(&bench->foveation)->sharp_at_gaze;
	if (!sharp || !saccade_ends(&view.display, SACCADE_DEG, landing.ends)) {
		outcome->verdict = GZ_STABILITY_APART;
		snprintf(outcome->note, sizeof outcome->note, "%s",
			 sharp ? "the picture is narrower than the saccade"
			       : "the method promises no sharp pixel");
		return GZ_OK;
	}
	gz_stability_name(outcome, 0, "pixels of the fovea that are not those of standard", 0);
	landing.fovea = malloc((size_t)view.width * (size_t)view.height);
	enum gz_result result = landing.fovea ? GZ_OK : GZ_ERR_NO_MEM;
	if (result == GZ_OK)
		result = gz_stability_standard(bench, &bench->settings.scene, &view, &landing.full);
	if (result == GZ_OK)
		result = check_landings(bench, &landing, outcome);
	free(landing.fovea);
	gz_image_free(&landing.full);
	gz_image_free(&landing.image);
	return result;
}

/* ---- borders ---- */

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

static enum gz_result prepare_sweep(const struct gz_stability_bench *bench, struct sweep *sweep)
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

static void release_sweep(struct sweep *sweep)
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

/* Regions: a blend band hides a hard border. */
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
	enum gz_result result = prepare_sweep(bench, &sweep);
	if (result == GZ_OK)
		result = gz_stability_converged_picture(bench, &bench->settings.scene, &sweep.view,
							&wanted);
	if (result == GZ_OK)
		result = method->is_pyramid ? check_gradual(bench, &sweep, wanted, outcome)
					    : check_band(bench, &sweep, wanted, outcome);
	release_sweep(&sweep);
	return result;
}
