/* Frames by the backend under test, and the pictures that are wanted. */
#define GZ_LOG_MODULE "stability"
#include "bench/stability/stability_bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/picture_plan.h"

/* Wanted pictures are kept for the next method up to so many bytes. Chosen: a row asks for up to a
 * hundred of one small size, or a dozen of the largest. */
#define KEPT_BYTES_MAX ((size_t)512 << 20)

static void hear(void *user, enum gz_log_level level, const char *module, const char *message)
{
	struct gz_stability_bench *bench = user;
	(void)module;
	if (level >= GZ_LOG_WARN)
		snprintf(bench->said, sizeof bench->said, "%s", message);
}

enum gz_result gz_stability_create(const struct gz_stability_settings *settings,
				   struct gz_stability_bench **out_bench)
{
	if (settings->width < 1 || settings->width > GZ_IMAGE_SIDE_MAX || settings->height < 1 ||
	    settings->height > GZ_IMAGE_SIDE_MAX || settings->churn_frames < 1000 ||
	    !gz_display_valid(&settings->display))
		return GZ_ERR_INVAL;
	if (settings->scene.volume->bricks) {
		gz_err(settings->log,
		       "a volume of bricks can be shown by one renderer at a time, and "
		       "this needs two: convert it to one that fits into memory");
		return GZ_ERR_UNSUPPORTED;
	}
	struct gz_stability_bench *bench = calloc(1, sizeof *bench);
	if (!bench)
		return GZ_ERR_NO_MEM;
	bench->settings = *settings;
	gz_log_init(&bench->said_log, hear, bench, "*:warn");
	*out_bench = bench;
	return GZ_OK;
}

enum gz_result gz_stability_use_backend(struct gz_stability_bench *bench, const char *backend)
{
	const struct gz_renderer_params params = { .threads = bench->settings.threads };
	gz_renderer_destroy(&bench->renderer);
	bench->shown = NULL;
	snprintf(bench->backend, sizeof bench->backend, "%s", backend);
	/* What is said while it starts is for people. */
	enum gz_result result =
		gz_renderer_create(backend, &params, bench->settings.log, &bench->renderer);
	if (result == GZ_OK)
		bench->renderer->log = &bench->said_log;
	return result;
}

/* Stands in where the user has none. */
static const struct gz_spacing_table small_table = {
	.in_deg = true,
	.count = 3,
	.rows = { { 0, 0.01, 1 }, { 3, 0.05, 1 }, { 25, 0.4, 3 } },
};

void gz_stability_use_method(struct gz_stability_bench *bench, const struct gz_foveation *foveation,
			     const struct gz_ray_params *rays, bool every_step_rule)
{
	if (rays)
		bench->settings.scene.rays = *rays;
	bench->foveation = *foveation;
	bench->every_step_rule = every_step_rule;
	bench->has_method = true;
	if (foveation->method == GZ_METHOD_TABLE && foveation->table.count == 0)
		bench->foveation.table = small_table;
}

const char *gz_stability_describe(const struct gz_stability_bench *bench)
{
	return bench->renderer ? gz_renderer_describe(bench->renderer) : "";
}

void gz_stability_destroy(struct gz_stability_bench **bench)
{
	if (!*bench)
		return;
	gz_renderer_destroy(&(*bench)->renderer);
	gz_renderer_destroy(&(*bench)->portable);
	gz_plan_free(&(*bench)->plan);
	for (int i = 0; i < GZ_STABILITY_VOLUME_COUNT; i++)
		gz_volume_free(&(*bench)->volumes[i]);
	for (size_t i = 0; i < (*bench)->kept_count; i++)
		gz_image_free(&(*bench)->kept[i].image);
	free((*bench)->kept);
	free(*bench);
	*bench = NULL;
}

struct gz_stability_view gz_stability_scene_view(const struct gz_stability_bench *bench)
{
	return (struct gz_stability_view) { bench->settings.width, bench->settings.height,
					    bench->settings.display };
}

struct gz_stability_view gz_stability_small_view(int width, int height)
{
	return (struct gz_stability_view) { width, height, gz_display_default(width, height) };
}

struct gz_foveation gz_stability_small_foveation(const struct gz_stability_bench *bench,
						 const struct gz_stability_view *view)
{
	struct gz_foveation f = bench->foveation;
	const double edge = fmin(view->width, view->height);
	const double px_per_deg = gz_display_px_per_deg(&view->display);
	f.mdc_square_px = fmax(edge / 4, 1);
	f.mdc3_square_px = fmax(edge / 2, 1);
	for (int axis = 0; axis < 2; axis++) {
		f.ddc_inner_px[axis] = fmax((axis ? 0.16 : 0.2) * edge, 1);
		f.ddc_middle_px[axis] = fmax((axis ? 0.33 : 0.4) * edge, 1);
	}
	f.blend_px = 0;
	/* 16 px at 25 degrees, which the default display shows half its width from the middle */
	f.acuity_slope = fmin(2 * 16 / px_per_deg / 25, 1);
	return f;
}

int gz_stability_rules(const struct gz_stability_bench *bench,
		       int out_rules[GZ_STABILITY_RULES_MAX])
{
	out_rules[0] = bench->foveation.step_rule;
	if (!bench->every_step_rule)
		return 1;
	out_rules[0] = GZ_STEP_METHOD;
	out_rules[1] = GZ_STEP_DISTANCE;
	out_rules[2] = bench->foveation.method == GZ_METHOD_ACUITY ? GZ_STEP_NONE : GZ_STEP_ACUITY;
	return 3;
}

enum gz_result gz_stability_volume(struct gz_stability_bench *bench, enum gz_stability_volume which,
				   const struct gz_volume **out_volume)
{
	enum gz_result result = GZ_OK;
	if (!bench->volumes[which].voxels)
		result = gz_stability_volume_make(which, bench->settings.log,
						  &bench->volumes[which]);
	if (result == GZ_OK)
		*out_volume = &bench->volumes[which];
	return result;
}

/* Field by field: the bytes between fields are nobody's. */
static bool same_transfer(const struct gz_transfer *a, const struct gz_transfer *b)
{
	return a->count == b->count && a->interpolation == b->interpolation &&
	       a->has_range == b->has_range && a->range[0] == b->range[0] &&
	       a->range[1] == b->range[1] &&
	       memcmp(a->points, b->points, a->count * sizeof a->points[0]) == 0;
}

static enum gz_result show_on(struct gz_renderer *renderer, const struct gz_stability_scene *scene,
			      const struct gz_volume **shown, struct gz_transfer *transfer)
{
	enum gz_result result = GZ_OK;
	const bool other = *shown != scene->volume;
	if (other) {
		*shown = NULL;
		result = gz_renderer_set_volume(renderer, scene->volume);
	}
	if (result == GZ_OK && (other || !same_transfer(transfer, scene->transfer)))
		result = gz_renderer_set_transfer(renderer, scene->transfer);
	if (result == GZ_OK) {
		*shown = scene->volume;
		*transfer = *scene->transfer;
	}
	return result;
}

enum gz_result gz_stability_show(struct gz_stability_bench *bench,
				 const struct gz_stability_scene *scene)
{
	return bench->failed =
		       show_on(bench->renderer, scene, &bench->shown, &bench->shown_transfer);
}

enum gz_result gz_stability_frame(struct gz_stability_bench *bench,
				  const struct gz_stability_scene *scene,
				  const struct gz_plan_request *request, struct gz_image *image)
{
	enum gz_result result = gz_stability_show(bench, scene);
	if (result == GZ_OK)
		result = gz_plan_update(request, &bench->plan);
	if (result == GZ_OK)
		result = gz_renderer_render(bench->renderer, &scene->camera, &scene->rays,
					    &bench->plan, image, &bench->stats);
	return bench->failed = result;
}

enum gz_result gz_stability_frame_at(struct gz_stability_bench *bench,
				     const struct gz_stability_scene *scene,
				     const struct gz_foveation *foveation,
				     const struct gz_stability_view *view, struct gz_point gaze,
				     struct gz_image *image)
{
	const struct gz_picture_subject subject = { scene->volume, &scene->camera, &scene->rays };
	const struct gz_plan_request request = gz_picture_plan_request(
		&subject, foveation, &view->display, gaze, view->width, view->height);
	return gz_stability_frame(bench, scene, &request, image);
}

static const struct gz_point centre = { 0.5F, 0.5F };

enum gz_result gz_stability_standard(struct gz_stability_bench *bench,
				     const struct gz_stability_scene *scene,
				     const struct gz_stability_view *view, struct gz_image *image)
{
	struct gz_foveation standard = gz_foveation_default();
	standard.method = GZ_METHOD_STANDARD;
	return gz_stability_frame_at(bench, scene, &standard, view, centre, image);
}

/* The portable kernel shares no instruction with the others that it could be wrong by. */
static enum gz_result render_portable(struct gz_stability_bench *bench,
				      const struct gz_stability_scene *scene,
				      const struct gz_stability_view *view, struct gz_image *image)
{
	const struct gz_renderer_params params = { .threads = bench->settings.threads,
						   .simd = "portable" };
	struct gz_foveation standard = gz_foveation_default();
	struct gz_plan plan = { 0 };
	enum gz_result result = GZ_OK;
	standard.method = GZ_METHOD_STANDARD;
	if (!bench->portable)
		result = gz_renderer_create("cpu", &params, bench->settings.log, &bench->portable);
	if (result == GZ_OK)
		result = show_on(bench->portable, scene, &bench->portable_shown,
				 &bench->portable_transfer);
	if (result == GZ_OK)
		result = gz_plan_make(&standard, &view->display, centre, view->width, view->height,
				      &plan);
	if (result == GZ_OK)
		result = gz_renderer_render(bench->portable, &scene->camera, &scene->rays, &plan,
					    image, NULL);
	gz_plan_free(&plan);
	return result;
}

/* A scene is told by what is in it; both structs are zeroed before they are filled. */
static bool same_scene(const struct gz_stability_kept *kept, const struct gz_stability_scene *scene,
		       const struct gz_stability_view *view)
{
	return kept->width == view->width && kept->height == view->height &&
	       kept->scene.volume == scene->volume &&
	       memcmp(&kept->scene.camera, &scene->camera, sizeof scene->camera) == 0 &&
	       memcmp(&kept->scene.rays, &scene->rays, sizeof scene->rays) == 0 &&
	       same_transfer(&kept->transfer, scene->transfer);
}

static void forget_pictures(struct gz_stability_bench *bench)
{
	for (size_t i = 0; i < bench->kept_count; i++)
		gz_image_free(&bench->kept[i].image);
	bench->kept_count = bench->kept_bytes = 0;
}

static enum gz_result make_room(struct gz_stability_bench *bench)
{
	if (bench->kept_count < bench->kept_capacity)
		return GZ_OK;
	const size_t capacity = bench->kept_capacity ? 2 * bench->kept_capacity : 16;
	struct gz_stability_kept *kept = realloc(bench->kept, capacity * sizeof *kept);
	if (!kept)
		return GZ_ERR_NO_MEM;
	bench->kept = kept;
	bench->kept_capacity = capacity;
	return GZ_OK;
}

enum gz_result gz_stability_wanted_picture(struct gz_stability_bench *bench,
					   const struct gz_stability_scene *scene,
					   const struct gz_stability_view *view,
					   const struct gz_image **out_image)
{
	for (size_t i = 0; i < bench->kept_count; i++)
		if (same_scene(&bench->kept[i], scene, view)) {
			*out_image = &bench->kept[i].image;
			return GZ_OK;
		}
	const size_t bytes = (size_t)view->width * (size_t)view->height * 4;
	if (bench->kept_bytes + bytes > KEPT_BYTES_MAX)
		forget_pictures(bench);
	enum gz_result result = make_room(bench);
	if (result != GZ_OK)
		return result;
	struct gz_stability_kept *kept = &bench->kept[bench->kept_count];
	*kept = (struct gz_stability_kept) { .scene = *scene,
					     .transfer = *scene->transfer,
					     .width = view->width,
					     .height = view->height };
	if (bench->settings.wanted)
		result = bench->settings.wanted(bench->settings.wanted_user, scene, view->width,
						view->height, &kept->image);
	else
		result = render_portable(bench, scene, view, &kept->image);
	if (result != GZ_OK) {
		gz_image_free(&kept->image);
		return result;
	}
	bench->kept_count++;
	bench->kept_bytes += bytes;
	*out_image = &kept->image;
	return GZ_OK;
}

enum gz_result gz_stability_converged_picture(struct gz_stability_bench *bench,
					      const struct gz_stability_scene *scene,
					      const struct gz_stability_view *view,
					      const struct gz_image **out_image)
{
	struct gz_stability_scene fine = *scene;
	fine.rays.ray_sampling_rate =
		fmin(fmax(8, scene->rays.ray_sampling_rate), GZ_RAY_SAMPLING_RATE_MAX);
	fine.rays.levels = false;
	fine.rays.early_termination = false;
	return gz_stability_wanted_picture(bench, &fine, view, out_image);
}
