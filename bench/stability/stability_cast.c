/* Rows about what rays show: brightness, volumes, cameras, transfer functions. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/stability/stability_rays.h"
#include "render/transfer/transfer_table.h"

static const char levels_off[] = "grey levels off";
static const char seams[] = "pixels beyond all that is around them";

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

static struct gz_stability_check built_in_check(const struct gz_stability_bench *bench,
						const struct gz_stability_scene *scene, int width,
						int height)
{
	struct gz_stability_check check = { .scene = scene,
					    .view = gz_stability_small_view(width, height),
					    .gaze = { 0.3F, 0.4F } };
	check.foveation = gz_stability_small_foveation(bench, &check.view);
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
	struct gz_stability_check check = built_in_check(bench, &scene, 128, 96);
	gz_stability_name(outcome, 0, levels_off, 1);
	check.fine_rate = 8;
	check.between = true;
	enum gz_result result = gz_stability_volume(bench, GZ_STABILITY_SLAB, &scene.volume);
	for (size_t i = 0; i < sizeof rates / sizeof rates[0] && result == GZ_OK; i++) {
		char name[64];
		snprintf(name, sizeof name, "%g samples a voxel", rates[i]);
		check.name = name;
		scene.rays.ray_sampling_rate = rates[i];
		result = gz_stability_check_rules(bench, &check, outcome);
	}
	return result;
}

enum gz_result gz_stability_volumes(struct gz_stability_bench *bench,
				    struct gz_stability_outcome *outcome)
{
	struct gz_stability_scene scene = { .transfer = &plain_transfer,
					    .camera = askew_camera(),
					    .rays = gz_ray_params_default() };
	struct gz_stability_check check = built_in_check(bench, &scene, 64, 48);
	enum gz_result result = GZ_OK;
	gz_stability_name(outcome, 0, levels_off, 1);
	gz_stability_name(outcome, 1, seams, 0);
	for (int which = GZ_STABILITY_LINE; which <= GZ_STABILITY_SIGNED && result == GZ_OK;
	     which++) {
		result = gz_stability_volume(bench, which, &scene.volume);
		check.name = gz_stability_volume_names[which];
		if (result == GZ_OK)
			result = gz_stability_check_rules(bench, &check, outcome);
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
				  const struct gz_stability_check *check,
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
	struct gz_stability_check check = built_in_check(bench, &scene, 64, 48);
	struct gz_image wanted = { 0 };
	int rules[GZ_STABILITY_RULES_MAX];
	const int count = gz_stability_rules(bench, rules);
	/* A segment's ends are known to one of 512 cells: 18 of a voxel here, 1.5 levels. */
	gz_stability_name(outcome, 0, levels_off, 2);
	scene.rays.integration = GZ_INTEGRATION_PREINTEGRATED;
	/* Within half a voxel of its faces the ramp is none. */
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

/* The scene's view, made smaller where it is large: what these rows look at is no finer. */
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

static struct gz_stability_check scene_check(const struct gz_stability_bench *bench,
					     const struct gz_stability_scene *scene)
{
	struct gz_stability_check check = { .scene = scene,
					    .view = middling_view(bench),
					    .gaze = { 0.4F, 0.55F } };
	check.foveation = gz_stability_small_foveation(bench, &check.view);
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
	struct gz_stability_check check = scene_check(bench, &scene);
	enum gz_result result = GZ_OK;
	gz_stability_name(outcome, 0, levels_off, 1);
	gz_stability_name(outcome, 1, seams, 0);
	for (int i = 0; i < CAMERAS && result == GZ_OK; i++) {
		scene.camera = camera_of(i, &scene);
		check.name = names[i];
		result = gz_stability_check_rules(bench, &check, outcome);
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
	struct gz_stability_check check = scene_check(bench, &scene);
	enum gz_result result = GZ_OK;
	gz_stability_name(outcome, 0, levels_off, 1);
	gz_stability_name(outcome, 1, seams, 0);
	for (size_t i = 0; i < 2 && result == GZ_OK; i++) {
		scene.transfer = &transfers[i];
		check.name = names[i];
		result = gz_stability_check_rules(bench, &check, outcome);
	}
	return result;
}
