/* Rows about the values of rays: brightness, volumes, cameras, transfer functions. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/stability/stability_bench.h"
#include "render/plan/method.h"
#include "render/transfer/transfer_table.h"

/* ---- frames against standard ---- */

/*
 * Holding a frame against what is wanted, ray by ray: a pixel that a ray was cast for shows what
 * `standard` shows there with the same step, and pixels between rays nothing beyond those around
 * them.
 */

/* One frame to check. */
struct ray_check {
	const struct gz_stability_scene *scene;
	struct gz_stability_view view;
	struct gz_foveation foveation;
	struct gz_point gaze;
	const char *name; /* of what is rendered, for reports */
	/* Hold all against one picture at this sampling rate, whatever step they were cast with;
	 *  0 = each against that of its own step. */
	double fine_rate;
	bool between; /* those between rays too; only with fine_rate */
};

#define NO_RAY 255

/* The steps by which pixels were cast, places in the plan's list; NO_RAY between them. */
static void mark_tile(const struct gz_plan *plan, const struct gz_tile *tile, uint8_t *steps)
{
	const uint32_t active = gz_plan_tile_active(plan, tile);
	const int spacing = plan->layers[tile->layer].spacing;
	for (int i = 0; i < GZ_TILE_EDGE * GZ_TILE_EDGE; i++) {
		const int x = tile->x + gz_tile_columns[tile->pattern][i] * spacing;
		const int y = tile->y + gz_tile_rows[i] * spacing;
		if (!(active >> i & 1) || x >= plan->width || y >= plan->height)
			continue;
		/* A pixel shows the first region that holds it: another's ray there is not seen. */
		int layer = tile->layer;
		if (plan->reconstruction == GZ_RECONSTRUCT_REGIONS)
			for (layer = 0; !gz_region_holds(&plan->layers[layer].region, x, y);)
				layer++;
		if (layer == tile->layer)
			steps[(size_t)y * (size_t)plan->width + (size_t)x] = tile->step;
	}
}

static void mark_ray_steps(const struct gz_plan *plan, uint8_t *steps)
{
	memset(steps, NO_RAY, (size_t)plan->width * (size_t)plan->height);
	for (size_t i = 0; i < plan->tile_count; i++)
		mark_tile(plan, &plan->tiles[i], steps);
}

/* Differences of the pixels held against something so far. */
struct differences {
	size_t count, by_levels[256];
	int worst;
	size_t worst_pixel;
	const struct gz_image *worst_wanted;
};

static void compare_ray(const struct gz_image *got, const struct gz_image *wanted, size_t pixel,
			struct differences *differences)
{
	const int apart = gz_stability_apart(got, wanted, pixel);
	differences->count++;
	differences->by_levels[apart]++;
	if (!differences->worst_wanted || apart > differences->worst) {
		differences->worst = apart;
		differences->worst_pixel = pixel;
		differences->worst_wanted = wanted;
	}
}

/* The least difference that all but a share of the pixels are within. */
static int levels_apart(const struct differences *differences, double share)
{
	size_t left = (size_t)(share * (double)differences->count);
	int levels = 255;
	while (levels > 0 && differences->by_levels[levels] <= left)
		left -= differences->by_levels[levels--];
	return levels;
}

/* Least and greatest of each channel over a block of pixels. */
struct block {
	uint8_t least[3], greatest[3];
};

static void widen_hull(struct block *block, const uint8_t *least, const uint8_t *greatest)
{
	for (int c = 0; c < 3; c++) {
		block->least[c] = least[c] < block->least[c] ? least[c] : block->least[c];
		block->greatest[c] =
			greatest[c] > block->greatest[c] ? greatest[c] : block->greatest[c];
	}
}

static struct block around(const struct block *blocks, int columns, int rows, int column, int row)
{
	struct block hull = { { 255, 255, 255 }, { 0, 0, 0 } };
	for (int y = row > 0 ? row - 1 : 0; y <= row + 1 && y < rows; y++)
		for (int x = column > 0 ? column - 1 : 0; x <= column + 1 && x < columns; x++) {
			const struct block *block = &blocks[y * columns + x];
			widen_hull(&hull, block->least, block->greatest);
		}
	return hull;
}

static bool beyond(const struct block *hull, const uint8_t *pixel)
{
	bool is = false;
	for (int c = 0; c < 3; c++) /* a level for rounding */
		is = is || pixel[c] + 1 < hull->least[c] || pixel[c] > hull->greatest[c] + 1;
	return is;
}

/* What no pixel may lie beyond: what `standard` shows around it, by any of the plan's steps. Rays
 * that another region hides are among that. */
struct hulls {
	int edge, columns, rows; /* of blocks: an interpolation never looks farther than its edge */
	int inner[2]; /* pixels with lattice points on all sides: beyond the last one within the
			 picture there are rays that it does not show */
	struct block *blocks;
};

static enum gz_result start_hulls(const struct gz_plan *plan, struct hulls *hulls)
{
	int spacing = 1;
	for (int i = 0; i < plan->layer_count; i++)
		spacing = plan->layers[i].spacing > spacing ? plan->layers[i].spacing : spacing;
	hulls->edge = 2 * spacing;
	hulls->columns = (plan->width + hulls->edge - 1) / hulls->edge;
	hulls->rows = (plan->height + hulls->edge - 1) / hulls->edge;
	hulls->inner[0] = (plan->width - 1) / spacing * spacing;
	hulls->inner[1] = (plan->height - 1) / spacing * spacing;
	const size_t count = (size_t)hulls->columns * (size_t)hulls->rows;
	hulls->blocks = malloc(count * sizeof *hulls->blocks);
	if (!hulls->blocks)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i < count; i++)
		hulls->blocks[i] = (struct block) { { 255, 255, 255 }, { 0, 0, 0 } };
	return GZ_OK;
}

static void widen_hulls(struct hulls *hulls, const struct gz_image *image)
{
	const uint8_t *colour = image->pixels;
	for (int y = 0; y < image->height; y++)
		for (int x = 0; x < image->width; x++, colour += 4)
			widen_hull(
				&hulls->blocks[y / hulls->edge * hulls->columns + x / hulls->edge],
				colour, colour);
}

static size_t count_seams(const struct hulls *hulls, const struct gz_image *got, size_t *out_pixel)
{
	size_t count = 0;
	*out_pixel = 0;
	for (int y = 0; y <= hulls->inner[1]; y++)
		for (int x = 0; x <= hulls->inner[0]; x++) {
			const size_t pixel = (size_t)y * (size_t)got->width + (size_t)x;
			const struct block hull = around(hulls->blocks, hulls->columns, hulls->rows,
							 x / hulls->edge, y / hulls->edge);
			if (!beyond(&hull, got->pixels + 4 * pixel))
				continue;
			count++;
			*out_pixel = pixel;
		}
	return count;
}

/* Result of comparing a frame. */
struct compared {
	const uint8_t *steps; /* of each pixel's ray */
	struct differences differences;
	struct hulls hulls;
	struct gz_image wanted; /* where the worst pixel is */
};

/* Against `standard` with each step that the plan has, or with the one asked for. */
static enum gz_result compare_steps(struct gz_stability_bench *bench, const struct ray_check *check,
				    const struct gz_image *got, struct compared *compared)
{
	const size_t pixels = (size_t)got->width * (size_t)got->height;
	struct differences *differences = &compared->differences;
	enum gz_result result = GZ_OK;
	for (int step = 0; step < bench->plan.step_count && result == GZ_OK; step++) {
		struct gz_stability_scene scene = *check->scene;
		const struct gz_image *wanted = NULL;
		const double rate = scene.rays.ray_sampling_rate / (double)bench->plan.steps[step];
		if (check->fine_rate == 0 &&
		    (!memchr(compared->steps, step, pixels) || rate < GZ_RAY_SAMPLING_RATE_MIN))
			continue; /* not taken, or outside a scene's range */
		scene.rays.ray_sampling_rate = check->fine_rate > 0 ? check->fine_rate : rate;
		result = gz_stability_wanted_picture(bench, &scene, &check->view, &wanted);
		if (result != GZ_OK)
			break;
		widen_hulls(&compared->hulls, wanted);
		const struct gz_image *before = differences->worst_wanted;
		for (size_t i = 0; i < pixels; i++)
			if (check->fine_rate > 0 ? check->between || compared->steps[i] != NO_RAY
						 : compared->steps[i] == step)
				compare_ray(got, wanted, i, differences);
		/* The bench may drop a picture while it makes the next. */
		if (differences->worst_wanted != before)
			result = gz_image_resize(&compared->wanted, got->width, got->height);
		if (differences->worst_wanted != before && result == GZ_OK) {
			memcpy(compared->wanted.pixels, wanted->pixels, pixels * 4);
			differences->worst_wanted = &compared->wanted;
		}
		if (check->fine_rate > 0)
			break;
	}
	return result;
}

static enum gz_result judge_frame(struct gz_stability_bench *bench, const struct ray_check *check,
				  const struct gz_image *got, uint8_t *steps,
				  struct gz_stability_outcome *outcome)
{
	/* The user's transfer function may be steeper than rounding is fine. */
	const bool shared = check->scene->volume == bench->settings.scene.volume ||
			    strcmp(bench->backend, "cpu") != 0;
	const char *rule = gz_step_rule_names[check->foveation.step_rule];
	struct compared compared = { .steps = steps };
	size_t seam = 0;
	mark_ray_steps(&bench->plan, steps);
	enum gz_result result = start_hulls(&bench->plan, &compared.hulls);
	if (result == GZ_OK)
		result = compare_steps(bench, check, got, &compared);
	const struct differences *differences = &compared.differences;
	if (result == GZ_OK && differences->count > 0)
		result =
			gz_stability_take(outcome, 0, levels_apart(differences, shared ? 0.001 : 0),
					  (struct gz_stability_place) { got, &compared.wanted,
									differences->worst_pixel },
					  "%s, steps by %s", check->name, rule);
	if (result == GZ_OK && outcome->number_count > 1) {
		const size_t seams = count_seams(&compared.hulls, got, &seam);
		result = gz_stability_take(outcome, 1, (double)seams,
					   (struct gz_stability_place) { 0 },
					   "%s, steps by %s, at %zu, %zu", check->name, rule,
					   seam % (size_t)got->width, seam / (size_t)got->width);
	}
	free(compared.hulls.blocks);
	gz_image_free(&compared.wanted);
	return result;
}

/*
 * Check a frame. Number 0 takes by how many grey levels a pixel is off, in the worst of all or, of
 * the gl backend or a scene of the user's, of 99.9 % of them: the share in which kernels may round
 * to either side. Number 1, where the outcome has it, takes the pixels that are brighter or darker
 * than all that is around them.
 */
static enum gz_result check_rays(struct gz_stability_bench *bench, const struct ray_check *check,
				 struct gz_stability_outcome *outcome)
{
	struct gz_image got = { 0 };
	uint8_t *steps = malloc((size_t)check->view.width * (size_t)check->view.height);
	enum gz_result result = steps ? GZ_OK : GZ_ERR_NO_MEM;
	if (result == GZ_OK)
		result = gz_stability_frame_at(bench, check->scene, &check->foveation, &check->view,
					       check->gaze, &got);
	if (result == GZ_OK)
		result = judge_frame(bench, check, &got, steps, outcome);
	gz_image_free(&got);
	free(steps);
	return result;
}

/* By every step rule in turn. */
static enum gz_result check_rules(struct gz_stability_bench *bench, const struct ray_check *check,
				  struct gz_stability_outcome *outcome)
{
	int rules[GZ_STABILITY_RULES_MAX];
	const int count = gz_stability_rules(bench, rules);
	enum gz_result result = GZ_OK;
	for (int i = 0; i < count && result == GZ_OK; i++) {
		struct ray_check ruled = *check;
		ruled.foveation.step_rule = rules[i];
		result = check_rays(bench, &ruled, outcome);
	}
	return result;
}

/* ---- rows ---- */

static const char levels_off[] = "grey levels off";
static const char beyond_all[] = "pixels beyond all that is around them";

/* A ramp from clear to white-ish, that also shows what is the same everywhere. */
static const struct gz_transfer plain_transfer = {
	.count = 4,
	.points = {
		{ 0, { 0.2, 0.1, 0.1 }, 0.02 },
		{ 0.2, { 0.3, 0.1, 0.9 }, 0 },
		{ 0.6, { 0.8, 0.6, 0.2 }, 0.06 },
		{ 1, { 1, 1, 0.8 }, 0.3 },
	},
};

static void set(double target[3], double x, double y, double z)
{
	target[0] = x;
	target[1] = y;
	target[2] = z;
}

static struct gz_camera askew_camera(void)
{
	return (struct gz_camera) {
		.eye = { 0.8, 1.3, 0.35 }, .up = { 0, 0, 1 }, .fov_deg = 40, .height = 1.2
	};
}

/* Rays are compared with those of pictures in which all begin alike. */
static struct gz_foveation aligned_foveation(const struct gz_stability_bench *bench,
					     const struct gz_stability_view *view)
{
	struct gz_foveation foveation = gz_stability_small_foveation(bench, view);
	foveation.step_phase = GZ_STEP_PHASE_ALIGNED;
	return foveation;
}

static struct ray_check built_in_check(const struct gz_stability_bench *bench,
				       const struct gz_stability_scene *scene, int width,
				       int height)
{
	struct ray_check check = { .scene = scene,
				   .view = gz_stability_small_view(width, height),
				   .gaze = { 0.3F, 0.4F } };
	check.foveation = aligned_foveation(bench, &check.view);
	return check;
}

enum gz_result gz_stability_brightness(struct gz_stability_bench *bench,
				       struct gz_stability_outcome *outcome)
{
	static const double rates[] = { 0.25, 0.37, 1, 1.5, 3 };
	/* What lies between the slab's faces is as deep everywhere, so nothing is interpolated. */
	static const struct gz_transfer even = { .count = 1,
						 .points = { { 0.5, { 0.9, 0.6, 0.3 }, 0.05 } } };
	struct gz_stability_scene scene = {
		.transfer = &even,
		.camera = { .eye = { 0.2, 0.1, 2 }, .up = { 0, 1, 0 }, .fov_deg = 15 },
		.rays = gz_ray_params_default()
	};
	struct ray_check check = built_in_check(bench, &scene, 128, 96);
	/* A method that refines interpolates what differs by less than its threshold: up to 1/32 of
	 * the luminance, which is 1/64 of a level of 0 to 255. */
	const bool refines = gz_method_of(&bench->foveation)->refines;
	gz_stability_name(outcome, 0, levels_off, refines ? 2 : 1);
	check.fine_rate = 8;
	check.between = true;
	enum gz_result result = gz_stability_volume(bench, GZ_STABILITY_SLAB, &scene.volume);
	for (size_t i = 0; i < sizeof rates / sizeof rates[0] && result == GZ_OK; i++) {
		char name[64];
		snprintf(name, sizeof name, "%g samples a voxel", rates[i]);
		check.name = name;
		scene.rays.ray_sampling_rate = rates[i];
		result = check_rules(bench, &check, outcome);
	}
	return result;
}

enum gz_result gz_stability_volumes(struct gz_stability_bench *bench,
				    struct gz_stability_outcome *outcome)
{
	struct gz_stability_scene scene = { .transfer = &plain_transfer,
					    .camera = askew_camera(),
					    .rays = gz_ray_params_default() };
	struct ray_check check = built_in_check(bench, &scene, 64, 48);
	enum gz_result result = GZ_OK;
	gz_stability_name(outcome, 0, levels_off, 1);
	gz_stability_name(outcome, 1, beyond_all, 0);
	for (int which = GZ_STABILITY_LINE; which <= GZ_STABILITY_SIGNED && result == GZ_OK;
	     which++) {
		result = gz_stability_volume(bench, which, &scene.volume);
		check.name = gz_stability_volume_names[which];
		if (result == GZ_OK)
			result = check_rules(bench, &check, outcome);
	}
	return result;
}

/* The built-in ramp along x: its range is from the first voxel's centre to the last one's. */
#define RAMP_PER_VOXEL (1 / 1.75 / 15)

/* What all of a picture shows whose rays go through a spike of the transfer function once, where
 * the data are linear: one entry's extinction over the length in which the data pass it. */
static enum gz_result paint_spike(const struct gz_stability_view *view,
				  const struct gz_transfer_point *spike, struct gz_image *image)
{
	const double length = 1.0 / GZ_TRANSFER_TABLE_SIZE / RAMP_PER_VOXEL;
	const double opacity = gz_transfer_opacity_over(spike->opacity, length);
	const enum gz_result result = gz_image_resize(image, view->width, view->height);
	for (size_t i = 0; i < 4 * (size_t)view->width * (size_t)view->height && result == GZ_OK;
	     i++)
		image->pixels[i] =
			i % 4 == 3 ? 255 : (uint8_t)lround(255 * opacity * spike->rgb[i % 4]);
	return result;
}

static enum gz_result check_spike(struct gz_stability_bench *bench, const struct gz_image *wanted,
				  const struct ray_check *check,
				  struct gz_stability_outcome *outcome)
{
	struct gz_image got = { 0 };
	size_t worst = 0;
	int most = -1;
	enum gz_result result = gz_stability_frame_at(bench, check->scene, &check->foveation,
						      &check->view, check->gaze, &got);
	for (size_t i = 0; i < (size_t)wanted->width * (size_t)wanted->height && result == GZ_OK;
	     i++) {
		const int apart = gz_stability_apart(&got, wanted, i);
		if (apart > most) {
			most = apart;
			worst = i;
		}
	}
	if (result == GZ_OK)
		result = gz_stability_take(
			outcome, 0, most, (struct gz_stability_place) { &got, wanted, worst },
			"%g samples a voxel, steps by %s", check->scene->rays.ray_sampling_rate,
			gz_step_rule_names[check->foveation.step_rule]);
	gz_image_free(&got);
	return result;
}

enum gz_result gz_stability_spike(struct gz_stability_bench *bench,
				  struct gz_stability_outcome *outcome)
{
	static const double rates[] = { 0.25, 0.5, 1 };
	/* One entry wide; along x, every ray through the clip box meets the value once. */
	static const double at = 2047.0 / (GZ_TRANSFER_TABLE_SIZE - 1),
			    wide = 1.0 / (GZ_TRANSFER_TABLE_SIZE - 1);
	const struct gz_transfer spike = {
		.count = 5,
		.points = { { 0, { 1, 0.6, 0.2 }, 0 },
			    { at - wide, { 1, 0.6, 0.2 }, 0 },
			    { at, { 1, 0.6, 0.2 }, 0.9999999 },
			    { at + wide, { 1, 0.6, 0.2 }, 0 },
			    { 1, { 1, 0.6, 0.2 }, 0 } },
	};
	struct gz_stability_scene scene = { .transfer = &spike,
					    .camera = { .eye = { 2, 0.00131, 0.00173 },
							.look_at = { 0, 0.00131, 0.00173 },
							.up = { 0, 0, 1 },
							.height = 0.5,
							.projection = GZ_PROJECTION_ORTHOGRAPHIC },
					    .rays = gz_ray_params_default() };
	struct ray_check check = built_in_check(bench, &scene, 64, 48);
	struct gz_image wanted = { 0 };
	int rules[GZ_STABILITY_RULES_MAX];
	const int count = gz_stability_rules(bench, rules);
	/* A segment's ends are known to one of 512 cells: 18 of a voxel here, 1.5 levels. */
	gz_stability_name(outcome, 0, levels_off, 2);
	scene.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
	/* Within half a voxel of its faces the ramp is constant. */
	set(scene.rays.clip.least, 0.1, 0.1, 0.1);
	set(scene.rays.clip.greatest, 0.9, 0.9, 0.9);
	enum gz_result result = gz_stability_volume(bench, GZ_STABILITY_RAMP, &scene.volume);
	if (result == GZ_OK)
		result = paint_spike(&check.view, &spike.points[2], &wanted);
	for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++)
		for (int rule = 0; rule < count && result == GZ_OK; rule++) {
			scene.rays.ray_sampling_rate = rates[i];
			check.foveation.step_rule = rules[rule];
			result = check_spike(bench, &wanted, &check, outcome);
		}
	gz_image_free(&wanted);
	return result;
}

/* The scene's view, reduced if it is large: these rows look at nothing finer. */
static struct gz_stability_view middling_view(const struct gz_stability_bench *bench)
{
	struct gz_stability_view view = gz_stability_scene_view(bench);
	const double share = fmin(1, 320.0 / fmax(view.width, view.height));
	view.width = (int)fmax(1, lround(view.width * share));
	view.height = (int)fmax(1, lround(view.height * share));
	view.display.px[0] = view.width;
	view.display.px[1] = view.height;
	return view;
}

static struct ray_check scene_check(const struct gz_stability_bench *bench,
				    const struct gz_stability_scene *scene)
{
	struct ray_check check = { .scene = scene,
				   .view = middling_view(bench),
				   .gaze = { 0.4F, 0.55F } };
	check.foveation = aligned_foveation(bench, &check.view);
	return check;
}

enum { INSIDE, FACE, AXIS, ORTHOGRAPHIC, CAMERAS };

static struct gz_camera camera_of(int which, const struct gz_stability_scene *scene)
{
	struct gz_camera camera = scene->camera;
	double half[3];
	gz_volume_half_extent(scene->volume, half);
	camera.projection =
		which == ORTHOGRAPHIC ? GZ_PROJECTION_ORTHOGRAPHIC : GZ_PROJECTION_PERSPECTIVE;
	if (camera.fov_deg <= 0 || camera.fov_deg >= 180)
		camera.fov_deg = 40;
	set(camera.up, 0, 0, 1);
	set(camera.look_at, 0, 0, 0);
	if (which == INSIDE) {
		set(camera.eye, 0.26 * half[0], 0.42 * half[1], 0.14 * half[2]);
		set(camera.look_at, -0.6 * half[0], -0.4 * half[1], 0.2 * half[2]);
	} else if (which == FACE) {
		set(camera.eye, half[0], 0.06 * half[1], 0.08 * half[2]);
	} else if (which == AXIS) { /* no ray on a voxel's face, where either side is right */
		set(camera.eye, 0.00131, -2.2, 0.00173);
		set(camera.look_at, 0.00131, 0, 0.00173);
	} else {
		set(camera.eye, 1.1, 1.3, 0.6);
		camera.height = 1.3;
	}
	return camera;
}

enum gz_result gz_stability_camera(struct gz_stability_bench *bench,
				   struct gz_stability_outcome *outcome)
{
	static const char *const names[CAMERAS] = { "inside", "on a face", "along an axis",
						    "orthographic" };
	struct gz_stability_scene scene = bench->settings.scene;
	scene.rays.levels = false; /* a ray's level is its tile's */
	struct ray_check check = scene_check(bench, &scene);
	enum gz_result result = GZ_OK;
	gz_stability_name(outcome, 0, levels_off, 1);
	gz_stability_name(outcome, 1, beyond_all, 0);
	for (int i = 0; i < CAMERAS && result == GZ_OK; i++) {
		scene.camera = camera_of(i, &scene);
		check.name = names[i];
		result = check_rules(bench, &check, outcome);
	}
	return result;
}

enum gz_result gz_stability_transfer(struct gz_stability_bench *bench,
				     struct gz_stability_outcome *outcome)
{
	static const struct gz_transfer transfers[] = {
		{ .count = 1, .points = { { 0.5, { 1, 1, 1 }, 0 } } },
		{ .count = 2,
		  .points = { { 0, { 0.9, 0.3, 0.1 }, 1 }, { 1, { 0.2, 0.5, 0.9 }, 1 } } },
	};
	static const char *const names[] = { "all transparent", "all opaque" };
	struct gz_stability_scene scene = bench->settings.scene;
	scene.rays.levels = false;
	set(scene.rays.background, 0.1, 0.5, 0.3);
	struct ray_check check = scene_check(bench, &scene);
	enum gz_result result = GZ_OK;
	gz_stability_name(outcome, 0, levels_off, 1);
	gz_stability_name(outcome, 1, beyond_all, 0);
	for (size_t i = 0; i < 2 && result == GZ_OK; i++) {
		scene.transfer = &transfers[i];
		check.name = names[i];
		result = check_rules(bench, &check, outcome);
	}
	return result;
}
