#include "bench/comparison/comparison_measure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/command.h"
#include "render/scene/techniques.h"

#define GZ_LOG_MODULE "techniques"

/* Where the eye looks. */
static const struct gz_point middle = { 0.5F, 0.5F };

/* A picture of a series. */
struct series_picture {
	size_t series, method;
	const struct gz_camera *camera;
	struct gz_plan *plan; /* NULL: the maker's own */
	struct gz_image *image;
	bool on_device;
};

static enum gz_result make_picture(const struct gz_comparison_job *job,
				   const struct series_picture *picture,
				   struct gz_picture_cost *out_cost)
{
	const struct gz_comparison_series *series = &job->list->series[picture->series];
	const struct gz_foveation *foveation = &job->methods[picture->method];
	const struct gz_picture_request request = {
		.camera = picture->camera,
		.settings = &series->rays,
		.foveation = foveation,
		.display = job->stage->display,
		.focus = gz_focus_at(middle),
		.width = job->request->width,
		.height = job->request->height,
		.on_device = picture->on_device,
		/* A viewer makes one plan for all frames where the gaze does not matter. */
		.fresh_plan = gz_foveation_follows_gaze(foveation),
		.plan = picture->plan,
		.image = picture->image,
	};
	struct gz_image *made;
	if (gz_command_interrupted())
		return GZ_ERR_CANCELLED;
	return gz_picture_make(series->maker, &request, &made, out_cost);
}

/* ---- frames ---- */

/* Pictures that frames are drawn into, and plans by series and method. */
struct timing {
	const struct gz_comparison_job *job;
	struct gz_plan *plans;
	struct gz_image image;
};

static enum gz_result time_one_frame(struct timing *timing, size_t index,
				     const struct gz_camera *camera,
				     struct gz_comparison_frame *out_frame)
{
	const struct gz_comparison_job *job = timing->job;
	const struct series_picture picture = {
		.series = index / job->method_count,
		.method = index % job->method_count,
		.camera = camera,
		.plan = &timing->plans[index],
		.image = &timing->image,
		.on_device = true,
	};
	struct gz_picture_cost cost;
	const enum gz_result result = make_picture(job, &picture, &cost);
	if (result == GZ_OK)
		*out_frame = (struct gz_comparison_frame) {
			.frame_ms = cost.total_ms,
			.cast_ms = cost.stats.cast_ms,
			.reconstruct_ms = cost.stats.reconstruct_ms,
			.prepare_ms = cost.stats.prepare_ms,
			.gpu_ms = cost.stats.gpu_ms,
			.rays = cost.stats.rays,
			.samples = cost.stats.samples,
		};
	return result;
}

/* The camera of a round from how it stood in the round before. Warm-up is at the first place of a
 * path: what is prepared there is what the first counted frame needs. */
static void move_camera(const struct gz_comparison_job *job, int round, bool first,
			struct gz_camera *camera)
{
	if (job->cameras)
		*camera = job->cameras[round > 0 ? round : 0];
	else if (!first)
		gz_camera_turn(camera, job->request->turn_deg);
}

/* What is prepared in warm-up frames and in the first counted one is done once. */
static enum gz_result time_rounds(struct timing *timing)
{
	const struct gz_comparison_job *job = timing->job;
	const int warm_up = job->request->warm_up > 0 ? job->request->warm_up : 1;
	struct gz_camera camera = *job->stage->camera;
	for (int round = -warm_up; round < job->frames; round++) {
		move_camera(job, round, round == -warm_up, &camera);
		for (size_t i = 0; i < job->list->count * job->method_count; i++) {
			struct gz_comparison_frame frame;
			const enum gz_result result = time_one_frame(timing, i, &camera, &frame);
			if (result != GZ_OK)
				return result;
			if (round <= 0)
				job->list->series[i / job->method_count].prepare_ms +=
					frame.prepare_ms;
			if (round >= 0)
				job->rows[i].frames[round] = frame;
		}
	}
	return GZ_OK;
}

enum gz_result gz_comparison_time(const struct gz_comparison_job *job)
{
	const size_t count = job->list->count * job->method_count;
	struct timing timing = { .job = job };
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < job->list->count && result == GZ_OK; i++) {
		struct gz_comparison_series *series = &job->list->series[i];
		result = gz_comparison_open(job->stage, series->technique, series->backend,
					    job->log, &series->maker);
	}
	timing.plans = calloc(count > 0 ? count : 1, sizeof *timing.plans);
	if (result == GZ_OK && !timing.plans)
		result = GZ_ERR_NO_MEM;
	if (result == GZ_OK)
		result = time_rounds(&timing);
	for (size_t i = 0; i < count && result == GZ_OK; i++) {
		const struct gz_comparison_series *series =
			&job->list->series[i / job->method_count];
		job->rows[i].prepare_ms = series->prepare_ms;
		snprintf(job->rows[i].device, sizeof job->rows[i].device, "%s",
			 gz_picture_maker_describe(series->maker));
	}
	for (size_t i = 0; i < count && timing.plans; i++)
		gz_plan_free(&timing.plans[i]);
	free(timing.plans);
	gz_image_free(&timing.image);
	return result;
}

/* ---- errors ---- */

/* Pictures and maps of a scene. */
struct comparing {
	const struct gz_comparison_job *job;
	struct gz_picture_maker *makers[GZ_REFERENCE_COUNT]; /* of references */
	struct gz_image test, standard, converged, half_step;
	/* Which reference converged is. */
	enum gz_comparison_reference reference;
	size_t effect;
	struct gz_error_weights weights;
	struct gz_error_maps maps;
};

/* Surfaces are opaque matter, lit by its gradient. Matter has neither hard shadows nor glass: for
 * these, rays find the surface in the voxels. An illustration is to look like none of it. */
static enum gz_comparison_reference reference_of(const struct gz_comparison_job *job,
						 const struct gz_comparison_series *series)
{
	if (!job->request->errors || series->technique->stylised)
		return GZ_REFERENCE_NONE;
	if (series->technique->sharing == GZ_SHARES_AS_OPAQUE)
		return series->rays.surface.shadows ||
				       series->rays.surface.material != GZ_MATERIAL_MATTE
			       ? GZ_REFERENCE_VOXELS
			       : GZ_REFERENCE_SURFACE;
	return job->list->converged_has[series->effect] ? GZ_REFERENCE_VOLUME : GZ_REFERENCE_NONE;
}

static struct gz_ray_params rays_of_reference(const struct gz_comparison_series *series,
					      enum gz_comparison_reference kind)
{
	struct gz_ray_params rays = series->rays;
	if (kind != GZ_REFERENCE_SURFACE)
		return rays;
	rays.shading = GZ_SHADING_GRADIENT;
	rays.light.occlusion = 0; /* surfaces have none */
	rays.light.shadow_steps = 0;
	return rays;
}

/* Open the maker of a reference. Surfaces in voxels are of the series' own technique. */
static enum gz_result open_reference(struct comparing *comparing,
				     const struct gz_comparison_series *series,
				     enum gz_comparison_reference kind)
{
	struct gz_comparison_stage stage = *comparing->job->stage;
	struct gz_picture_maker **maker = &comparing->makers[kind];
	if (*maker)
		return GZ_OK;
	if (kind == GZ_REFERENCE_SURFACE)
		stage.transfer = comparing->job->surface;
	return gz_comparison_open(
		&stage, kind == GZ_REFERENCE_VOXELS ? series->technique : gz_techniques[0],
		gz_comparison_reference_backend, comparing->job->log, maker);
}

/* Make the picture of a surface in the voxels: it needs no smaller step, because rays find where
 * they cross it. */
static enum gz_result make_voxel_picture(struct comparing *comparing,
					 const struct gz_comparison_series *series)
{
	const struct gz_comparison_job *job = comparing->job;
	const struct gz_foveation foveation = gz_foveation_full();
	struct gz_ray_params rays = series->rays;
	struct gz_image *made;
	const struct gz_picture_request request = {
		.camera = job->stage->camera,
		.settings = &rays,
		.foveation = &foveation,
		.display = job->stage->display,
		.focus = gz_focus_at(middle),
		.width = job->request->width,
		.height = job->request->height,
		.image = &comparing->converged,
	};
	rays.surface.source = GZ_SURFACE_VOXELS;
	return gz_picture_make(comparing->makers[GZ_REFERENCE_VOXELS], &request, &made, NULL);
}

/* Make or find a converged ray cast. */
static enum gz_result get_converged_picture(struct comparing *comparing,
					    const struct gz_comparison_series *series,
					    enum gz_comparison_reference kind)
{
	const struct gz_comparison_job *job = comparing->job;
	const struct gz_ray_params rays = rays_of_reference(series, kind);
	const struct gz_reference_request request = {
		.maker = comparing->makers[kind],
		.data_hash =
			kind == GZ_REFERENCE_SURFACE ? job->surface_hash : job->scene->data_hash,
		.program = job->program,
		.camera = job->stage->camera,
		.rays = &rays,
		.display = job->stage->display,
		.width = job->request->width,
		.height = job->request->height,
		.cache = job->request->cache,
	};
	double db;
	bool made;
	const enum gz_result result = gz_reference_get(&request, job->log, &comparing->converged,
						       &comparing->half_step, &db, &made);
	if (result == GZ_OK) /* fmin passes over NaN */
		job->scene->reference_db = fmin(job->scene->reference_db, db);
	return result;
}

static enum gz_result find_converged_picture(struct comparing *comparing,
					     const struct gz_comparison_series *series,
					     enum gz_comparison_reference kind)
{
	if (comparing->reference == kind && comparing->effect == series->effect)
		return GZ_OK;
	comparing->reference = GZ_REFERENCE_NONE;
	enum gz_result result = open_reference(comparing, series, kind);
	if (result == GZ_OK)
		result = kind == GZ_REFERENCE_VOXELS
				 ? make_voxel_picture(comparing, series)
				 : get_converged_picture(comparing, series, kind);
	if (result != GZ_OK)
		return result;
	comparing->reference = kind;
	comparing->effect = series->effect;
	return GZ_OK;
}

static enum gz_result compare_pictures(struct comparing *comparing, const struct gz_image *wanted,
				       const struct gz_image *test,
				       struct gz_study_errors *out_errors)
{
	const struct gz_comparison_job *job = comparing->job;
	const double px_per_deg = fmin(fmax(gz_display_px_per_deg(job->stage->display), 1), 1000);
	const enum gz_result result =
		gz_error_maps_make(&comparing->maps, wanted, test, px_per_deg, job->workers);
	if (result == GZ_OK)
		*out_errors = gz_error_maps_weigh(&comparing->maps, &comparing->weights);
	return result;
}

/* SCENE-TECHNIQUE-BACKEND-EFFECT-SLICES.png */
static enum gz_result write_series_picture(const struct gz_comparison_job *job,
					   const struct gz_comparison_series *series,
					   const struct gz_image *image)
{
	char path[GZ_PATH_SIZE + GZ_STUDY_TEXT_SIZE + 4 * GZ_NAME_SIZE], slices[GZ_NAME_SIZE] = "";
	if (!job->request->pictures)
		return GZ_OK;
	if (series->slices > 0)
		snprintf(slices, sizeof slices, "-%d", series->slices);
	snprintf(path, sizeof path, "%s/%s-%s-%s-%s%s.png", job->request->pictures,
		 job->scene->name, series->technique->name, series->backend,
		 gz_effects[series->effect].name, slices);
	return gz_image_write_png(image, path, job->log);
}

static enum gz_result compare_method(struct comparing *comparing, size_t index, size_t method)
{
	const struct gz_comparison_job *job = comparing->job;
	struct gz_comparison_row *row = &job->rows[index * job->method_count + method];
	const struct series_picture picture = {
		.series = index,
		.method = method,
		.camera = job->stage->camera,
		.image = method == 0 ? &comparing->standard : &comparing->test,
	};
	enum gz_result result = make_picture(job, &picture, NULL);
	if (result == GZ_OK)
		result = compare_pictures(comparing, &comparing->standard, picture.image,
					  &row->standard);
	if (result == GZ_OK && row->reference != GZ_REFERENCE_NONE)
		result = compare_pictures(comparing, &comparing->converged, picture.image,
					  &row->converged);
	return result;
}

static enum gz_result compare_series(struct comparing *comparing, size_t index)
{
	const struct gz_comparison_job *job = comparing->job;
	const struct gz_comparison_series *series = &job->list->series[index];
	enum gz_comparison_reference kind = reference_of(job, series);
	enum gz_result result =
		kind == GZ_REFERENCE_NONE ? GZ_OK : find_converged_picture(comparing, series, kind);
	if (kind == GZ_REFERENCE_VOXELS && result == GZ_ERR_UNSUPPORTED) { /* built without rays */
		kind = GZ_REFERENCE_NONE;
		result = GZ_OK;
	}
	for (size_t method = 0; method < job->method_count && result == GZ_OK; method++) {
		job->rows[index * job->method_count + method].reference = kind;
		result = compare_method(comparing, index, method);
	}
	return result == GZ_OK ? write_series_picture(job, series, &comparing->standard) : result;
}

enum gz_result gz_comparison_compare(const struct gz_comparison_job *job)
{
	struct comparing *comparing = calloc(1, sizeof *comparing);
	if (!comparing)
		return GZ_ERR_NO_MEM;
	comparing->job = job;
	enum gz_result result =
		gz_error_weights_make(&comparing->weights, job->stage->display, middle,
				      job->request->width, job->request->height, job->workers);
	for (size_t i = 0; i < job->list->count && result == GZ_OK; i++)
		result = compare_series(comparing, i);
	for (int i = 0; i < GZ_REFERENCE_COUNT; i++)
		gz_picture_maker_destroy(&comparing->makers[i]);
	gz_image_free(&comparing->test);
	gz_image_free(&comparing->standard);
	gz_image_free(&comparing->converged);
	gz_image_free(&comparing->half_step);
	gz_error_weights_free(&comparing->weights);
	gz_error_maps_free(&comparing->maps);
	free(comparing);
	return result;
}
