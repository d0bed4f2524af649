#include "render/frame/picture_maker.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "render/frame/drawers.h"
#include "render/frame/growth.h"

#define GZ_LOG_MODULE "picture"

struct gz_picture_maker {
	const struct gz_log *log;
	struct gz_picture_maker_params params;
	struct gz_drawers drawers;
	struct gz_plan plan;
	struct gz_temporal temporal;
	struct gz_temporal_content content; /* of the current picture */
	struct gz_growth growth;
	bool grows; /* the plan of the last picture did, or may with the next */
	struct {
		void *settings; /* a copy; NULL before the first */
		struct gz_foveation foveation;
	} kept_by;            /* what the last picture was made with that accumulated or grew */
	struct gz_image cast; /* at the rays' resolution, if that is not the picture's */
	struct gz_image image;
};

/* What the steps of one picture share. */
struct making {
	struct gz_picture_maker *maker;
	const struct gz_picture_request *request;
	struct gz_plan *plan;
	struct gz_image *image;
	bool accumulates, keeps_rays, grows, on_device;
	double bound_ms; /* that limiting the plan took for what later plans reuse */
	struct gz_picture_cost cost;
};

struct gz_focus gz_focus_at(struct gz_point point)
{
	return (struct gz_focus) { .point = point, .scale = 1, .widen = 0 };
}

enum gz_result gz_picture_maker_create(const struct gz_picture_maker_params *params,
				       const struct gz_log *log,
				       struct gz_picture_maker **out_maker)
{
	struct gz_picture_maker *maker = calloc(1, sizeof *maker);
	if (!maker)
		return GZ_ERR_NO_MEM;
	maker->log = log;
	maker->params = *params;
	maker->drawers = (struct gz_drawers) {
		.log = log,
		.backend = maker->params.backend,
		.backend_params = &maker->params.backend_params,
	};
	*out_maker = maker;
	return GZ_OK;
}

static bool chooses_backend(const struct gz_picture_maker *maker)
{
	const char *backend = maker->params.backend;
	return !backend || strcmp(backend, "auto") == 0;
}

static bool draws_by_cpu(const struct gz_picture_maker *maker)
{
	return strcmp(gz_picture_maker_backend(maker), "cpu") == 0;
}

/* Whether cpu may draw in place of a backend that has failed. */
static bool cpu_may_take_over(const struct gz_picture_maker *maker, enum gz_result failure)
{
	const struct gz_drawers *drawers = &maker->drawers;
	if (!maker->params.cpu_takes_over || !gz_drawers_last(drawers) || draws_by_cpu(maker) ||
	    !gz_technique_has_backend(drawers->items[drawers->count - 1].technique, "cpu"))
		return false;
	return failure == GZ_ERR_NO_DEVICE || failure == GZ_ERR_NO_MEM ||
	       (failure == GZ_ERR_UNSUPPORTED && chooses_backend(maker));
}

static enum gz_result let_cpu_take_over(struct gz_picture_maker *maker)
{
	gz_warn(maker->log, "the cpu backend draws from now on");
	return gz_drawers_take_cpu(&maker->drawers);
}

enum gz_result gz_picture_maker_show(struct gz_picture_maker *maker,
				     const struct gz_object *objects, size_t count)
{
	gz_picture_maker_forget(maker);
	free(maker->kept_by.settings);
	maker->kept_by.settings = NULL;
	enum gz_result result = gz_drawers_show(&maker->drawers, objects, count);
	if (chooses_backend(maker) && cpu_may_take_over(maker, result))
		result = let_cpu_take_over(maker);
	if (result == GZ_ERR_NO_MEM)
		gz_err(maker->log, "no memory to draw with; close other programs, or show less");
	if (result != GZ_OK)
		gz_drawers_close(&maker->drawers);
	return result;
}

void gz_picture_maker_adopt(struct gz_picture_maker *maker, struct gz_picture_maker **from)
{
	struct gz_drawers *own = &maker->drawers, *others = &(*from)->drawers;
	gz_picture_maker_forget(maker);
	free(maker->kept_by.settings);
	maker->kept_by.settings = NULL;
	gz_drawers_free(own);
	others->log = own->log;
	others->backend = own->backend;
	others->backend_params = own->backend_params;
	*own = *others;
	*others = (struct gz_drawers) { .log = own->log };
	gz_picture_maker_destroy(from);
}

bool gz_picture_maker_can_take_prepared(const struct gz_picture_maker *maker)
{
	const struct gz_technique_drawer *item = &maker->drawers.items[0];
	return maker->drawers.count == 1 && item->drawer->ops->take_prepared &&
	       item->technique->check("cpu", maker->drawers.backend_params, NULL) == GZ_OK;
}

void gz_picture_maker_take_prepared(struct gz_picture_maker *maker, struct gz_picture_maker **from)
{
	struct gz_drawer *drawer = maker->drawers.items[0].drawer;
	if ((*from)->drawers.count == 1 &&
	    (*from)->drawers.items[0].technique == maker->drawers.items[0].technique)
		drawer->ops->take_prepared(drawer, (*from)->drawers.items[0].drawer);
	gz_picture_maker_destroy(from);
}

/* Rays along a side of the picture; 0 if there would be none or too many. */
static int rays_along(int side, double rate)
{
	const double rays = round(side * rate);
	return rays >= 1 && rays <= GZ_IMAGE_SIDE_MAX ? (int)rays : 0;
}

enum gz_result gz_picture_count_rays(const int size_px[2], double rate, const struct gz_log *log,
				     int out_rays[2])
{
	const int rays[2] = { rays_along(size_px[0], rate), rays_along(size_px[1], rate) };
	if (rays[0] == 0 || rays[1] == 0) {
		gz_err(log,
		       "%dx%d at image_sampling_rate %g is not 1 to %d rays a side; change the "
		       "rate "
		       "or the size",
		       size_px[0], size_px[1], rate, GZ_IMAGE_SIDE_MAX);
		return GZ_ERR_INVAL;
	}
	memcpy(out_rays, rays, sizeof rays);
	return GZ_OK;
}

static double sampling_rate(const struct gz_picture_request *request)
{
	return request->image_sampling_rate > 0 ? request->image_sampling_rate : 1;
}

/* Whether the technique that makes the picture tells how far away is what its rays show. */
static bool tells_depths(const struct gz_picture_maker *maker)
{
	return maker->drawers.items[maker->drawers.count - 1].technique->tells_depths;
}

/* Accumulated and grown pictures begin again when anything but the camera has changed. */
static enum gz_result note_content(struct making *making)
{
	struct gz_picture_maker *maker = making->maker;
	const struct gz_picture_request *request = making->request;
	const size_t size = maker->drawers.items[0].technique->settings_size;
	const bool same = maker->kept_by.settings &&
			  gz_drawers_settings_same(&maker->drawers, maker->kept_by.settings,
						   request->settings) &&
			  gz_foveation_same(&maker->kept_by.foveation, request->foveation);
	if (!maker->kept_by.settings)
		maker->kept_by.settings = malloc(size);
	if (!maker->kept_by.settings)
		return GZ_ERR_NO_MEM;
	if (!same)
		maker->content.serial++;
	memcpy(maker->kept_by.settings, request->settings, size);
	maker->kept_by.foveation = *request->foveation;
	maker->content.camera = *request->camera;
	maker->content.deep = tells_depths(maker);
	return GZ_OK;
}

static bool shows_bricks(const struct gz_picture_maker *maker)
{
	const struct gz_drawers *drawers = &maker->drawers;
	for (size_t i = 0; i < drawers->count; i++)
		for (size_t k = 0; k < drawers->items[i].object_count; k++) {
			const struct gz_volume *volume = drawers->items[i].objects[k].volume;
			if (volume && volume->bricks)
				return true;
		}
	return false;
}

/* Whether the plan may grow. Strips have a plan each, and a replay says how its plans have grown.
 */
static bool plan_grows(const struct making *making)
{
	const struct gz_picture_request *request = making->request;
	return making->keeps_rays && request->focus.finer <= 0 &&
	       request->foveation->still_growth > 0 && request->strip.rows == 0 &&
	       gz_plan_can_grow(request->foveation);
}

/* While nothing but the gaze changes, plans become finer (growth.h). Those of a lost gaze do not:
 * they change as a whole when they widen. */
static enum gz_result grow_plan(struct making *making, struct gz_plan_request *plan)
{
	struct gz_picture_maker *maker = making->maker;
	if (!plan_grows(making)) {
		maker->growth = (struct gz_growth) { 0 };
		return GZ_OK;
	}
	const enum gz_result result = note_content(making);
	if (result != GZ_OK)
		return result;
	const struct gz_growth_view view = {
		.camera = *making->request->camera,
		.display = *making->request->display,
		.width = plan->width,
		.height = plan->height,
		.serial = maker->content.serial,
	};
	const double finer = gz_growth_begin(&maker->growth, &view);
	making->grows = plan->widen <= 0;
	plan->finer = making->grows || maker->growth.whole ? finer : 1;
	return GZ_OK;
}

static void end_growth(const struct making *making)
{
	struct gz_picture_maker *maker = making->maker;
	const struct gz_growth_picture picture = {
		.plan = making->plan,
		.keeps = making->cost.stats.keeps_rays,
		.refines = making->plan->refines,
		.share = making->request->foveation->still_growth,
	};
	if (making->grows)
		gz_growth_end(&maker->growth, &picture);
	maker->grows = making->grows;
}

/* With accumulation, turn the request into one for a shifted plan. */
static enum gz_result begin_accumulation(struct making *making, struct gz_plan_request *plan,
					 struct gz_display *display)
{
	struct gz_picture_maker *maker = making->maker;
	if (!making->accumulates) {
		gz_temporal_forget(&maker->temporal);
		return GZ_OK;
	}
	if (shows_bricks(maker)) {
		gz_err(maker->log,
		       "temporal.accumulate: volumes of bricks change while they are shown; "
		       "set it to no, or show a volume that fits into memory");
		return GZ_ERR_UNSUPPORTED;
	}
	const enum gz_result result = note_content(making);
	return result == GZ_OK ? gz_temporal_begin(&maker->temporal, &maker->content, plan, display)
			       : result;
}

static struct gz_shot shot_of(const struct making *making)
{
	return (struct gz_shot) {
		.camera = making->request->camera,
		.settings = making->request->settings,
		.plan = making->plan,
		.refined = making->plan,
		.keeps_rays = making->keeps_rays,
	};
}

/* The request for the plan, in rays, of the whole picture or of one strip. */
static enum gz_result plan_request_of(struct making *making, struct gz_plan_request *out_request)
{
	const struct gz_picture_request *request = making->request;
	const double rate = sampling_rate(request);
	const int rows = request->strip.rows > 0 ? request->strip.rows : request->height;
	const int size_px[2] = { request->width, rows };
	int rays[2];
	const enum gz_result result =
		gz_picture_count_rays(size_px, rate, making->maker->log, rays);
	if (result != GZ_OK)
		return result;
	struct gz_plan_request plan = gz_plan_request_make(request->foveation, request->display,
							   request->focus.point, rays[0], rays[1]);
	plan.rays_per_px = rate;
	plan.scale = request->focus.scale;
	plan.widen = request->focus.widen;
	plan.finer = fmax(request->focus.finer, 1);
	struct gz_drawer *drawer = gz_drawers_last(&making->maker->drawers);
	const struct gz_shot shot = shot_of(making);
	if (drawer->ops->bound_plan)
		making->bound_ms = drawer->ops->bound_plan(drawer, &shot, &plan);
	/* Rays of several techniques meet on one plan. */
	plan.refines = plan.refines && making->maker->drawers.count == 1;
	*out_request = plan;
	return GZ_OK;
}

static enum gz_result make_plan(struct making *making)
{
	const struct gz_picture_request *request = making->request;
	struct gz_picture_maker *maker = making->maker;
	struct gz_display display = *request->display;
	struct gz_plan_request plan;
	enum gz_result result = plan_request_of(making, &plan);
	if (result == GZ_OK)
		result = grow_plan(making, &plan);
	if (result == GZ_OK)
		result = begin_accumulation(making, &plan, &display);
	if (request->fresh_plan)
		making->plan->made_for.valid = false;
	if (result == GZ_OK)
		result = gz_plan_update(&plan, making->plan);
	if (result == GZ_OK && making->accumulates)
		gz_temporal_place(&maker->temporal, making->plan);
	if (result == GZ_OK && request->strip.rows > 0)
		making->plan->view = (struct gz_plan_view) {
			.width = rays_along(request->width, sampling_rate(request)),
			.height = rays_along(request->height, sampling_rate(request)),
			.shift = { 0, -rays_along(request->strip.top, sampling_rate(request)) },
		};
	making->cost.finer = result == GZ_OK ? plan.finer : 1;
	making->cost.kept = result == GZ_OK && making->accumulates && maker->temporal.any;
	return result;
}

/* Draw. If the backend fails for good, cpu takes over. */
static enum gz_result draw_or_take_over(struct making *making, struct gz_image *image)
{
	struct gz_picture_maker *maker = making->maker;
	const struct gz_ray_depths depths = gz_camera_ray_depths(making->request->camera);
	struct gz_shot shot = shot_of(making);
	const struct gz_drawer *drawer = gz_drawers_last(&maker->drawers);
	if (making->accumulates && maker->content.deep)
		shot.depths = &depths;
	making->on_device = making->on_device && drawer->ops->keeps_on_device(drawer, &shot);
	enum gz_result result = gz_drawers_draw(
		&maker->drawers, &shot, making->on_device ? NULL : image, &making->cost.stats);
	if (!cpu_may_take_over(maker, result) ||
	    (result == GZ_ERR_NO_DEVICE && making->request->loss_returned))
		return result;
	making->on_device = false;
	result = let_cpu_take_over(maker);
	if (result == GZ_OK)
		result = gz_drawers_draw(&maker->drawers, &shot, image, &making->cost.stats);
	return result;
}

static enum gz_result draw_and_accumulate(struct making *making, struct gz_image *target)
{
	struct gz_picture_maker *maker = making->maker;
	making->on_device = false;
	enum gz_result result = draw_or_take_over(making, &maker->temporal.frame_image);
	const int64_t start_ns = gz_clock_now_ns();
	if (result == GZ_OK)
		result = gz_temporal_end(&maker->temporal, making->request->temporal,
					 &maker->content, making->plan, target);
	making->cost.stats.reconstruct_ms += gz_ns_to_ms(gz_clock_now_ns() - start_ns);
	return result;
}

/* Cast the rays and, if there are more or fewer rays than pixels, resample them to the picture. */
static enum gz_result draw_picture(struct making *making)
{
	const struct gz_picture_request *request = making->request;
	struct gz_picture_maker *maker = making->maker;
	const int rows = request->strip.rows > 0 ? request->strip.rows : request->height;
	const bool direct = sampling_rate(request) == 1;
	struct gz_image *target = direct ? making->image : &maker->cast;
	making->on_device = direct && request->on_device;
	enum gz_result result = making->accumulates ? draw_and_accumulate(making, target)
						    : draw_or_take_over(making, target);
	if (result != GZ_OK || direct)
		return result;
	const int64_t start_ns = gz_clock_now_ns();
	result = gz_image_resize(making->image, request->width, rows);
	if (result == GZ_OK)
		gz_image_resample(&maker->cast, making->image);
	making->cost.stats.reconstruct_ms += gz_ns_to_ms(gz_clock_now_ns() - start_ns);
	return result;
}

/* The code that found something unsupported, or lost the device, has logged it already. */
static void log_failure(const struct making *making, enum gz_result failure)
{
	if (failure != GZ_ERR_UNSUPPORTED && failure != GZ_ERR_NO_DEVICE)
		gz_err(making->maker->log,
		       "cannot draw a picture of %dx%d: %s; check the camera and the size",
		       making->request->width, making->request->height, gz_result_text(failure));
}

enum gz_result gz_picture_make(struct gz_picture_maker *maker,
			       const struct gz_picture_request *request,
			       struct gz_image **out_image, struct gz_picture_cost *out_cost)
{
	if (!gz_drawers_last(&maker->drawers))
		return GZ_ERR_INVAL;
	struct making making = {
		.maker = maker,
		.request = request,
		.plan = request->plan ? request->plan : &maker->plan,
		.image = request->image ? request->image : &maker->image,
		.accumulates = request->temporal && request->temporal->accumulate,
		.keeps_rays = request->temporal && request->temporal->keep_rays &&
			      !request->temporal->accumulate,
	};
	const int64_t start_ns = gz_clock_now_ns();
	enum gz_result result = make_plan(&making);
	const int64_t planned_ns = gz_clock_now_ns();
	if (result == GZ_OK)
		result = draw_picture(&making);
	if (result != GZ_OK) {
		log_failure(&making, result);
		return result;
	}
	end_growth(&making);
	making.cost.plan_ms = gz_ns_to_ms(planned_ns - start_ns) - making.bound_ms;
	making.cost.stats.prepare_ms += making.bound_ms;
	making.cost.stats.prepare_within_ms += making.bound_ms;
	making.cost.total_ms = gz_ns_to_ms(gz_clock_now_ns() - start_ns);
	*out_image = making.on_device ? NULL : making.image;
	if (out_cost)
		*out_cost = making.cost;
	return GZ_OK;
}

enum gz_result gz_picture_maker_pick(struct gz_picture_maker *maker,
				     const struct gz_pick_request *request,
				     struct gz_pick *out_pick)
{
	return gz_drawers_last(&maker->drawers)
		       ? gz_drawers_pick(&maker->drawers, request, out_pick)
		       : GZ_ERR_INVAL;
}

/* Make a picture again until nothing that it lacks is being made any more, or nothing of it has
 * arrived for some time. */
static enum gz_result make_whole(struct gz_picture_maker *maker,
				 const struct gz_picture_request *request, double wait_s)
{
	static const struct timespec pause = { .tv_nsec = 10 * 1000 * 1000 };
	struct gz_image *image;
	struct gz_picture_cost cost = { 0 };
	enum gz_result result = gz_picture_make(maker, request, &image, &cost);
	int64_t arrived_ns = gz_clock_now_ns();
	while (result == GZ_OK && cost.stats.bricks_coming > 0) {
		const uint64_t before = cost.stats.bricks_coming;
		(void)nanosleep(&pause, NULL);
		result = gz_picture_make(maker, request, &image, &cost);
		const int64_t now_ns = gz_clock_now_ns();
		if (cost.stats.bricks_coming != before)
			arrived_ns = now_ns;
		if (result == GZ_OK && gz_ns_to_s(now_ns - arrived_ns) > wait_s) {
			gz_err(maker->log,
			       "not printed: parts of the picture are missing, and none has "
			       "arrived for "
			       "%g s; check that its files can be read, or print again when it is "
			       "complete",
			       wait_s);
			return GZ_ERR_TIMEOUT;
		}
	}
	return result;
}

enum gz_result gz_picture_print(struct gz_picture_maker *maker,
				const struct gz_picture_request *request,
				const struct gz_print *print)
{
	const struct gz_foveation full = gz_foveation_full();
	struct gz_picture_request whole = *request;
	struct gz_drawer *drawer = gz_drawers_last(&maker->drawers);
	if (!drawer)
		return GZ_ERR_INVAL;
	if (!drawer->ops->print) {
		gz_err(maker->log,
		       "%s: nothing in the picture is drawn by marks; use --technique "
		       "illustrate",
		       print->path);
		return GZ_ERR_UNSUPPORTED;
	}
	whole.foveation = &full;
	whole.focus = gz_focus_at((struct gz_point) { 0.5F, 0.5F });
	whole.temporal = NULL;
	whole.on_device = false;
	whole.strip.rows = 0;
	const enum gz_result result =
		make_whole(maker, &whole, print->wait_s > 0 ? print->wait_s : GZ_PRINT_WAIT_S);
	return result == GZ_OK ? drawer->ops->print(drawer, print) : result;
}

unsigned gz_picture_maker_texture(const struct gz_picture_maker *maker)
{
	const struct gz_drawer *drawer = gz_drawers_last(&maker->drawers);
	return drawer ? drawer->ops->picture_texture(drawer) : 0;
}

const struct gz_plan *gz_picture_maker_plan(const struct gz_picture_maker *maker)
{
	return &maker->plan;
}

const char *gz_picture_maker_backend(const struct gz_picture_maker *maker)
{
	const struct gz_drawer *drawer = gz_drawers_last(&maker->drawers);
	return drawer ? drawer->ops->backend(drawer) : "";
}

const char *gz_picture_maker_describe(const struct gz_picture_maker *maker)
{
	const struct gz_drawer *drawer = gz_drawers_last(&maker->drawers);
	return drawer ? drawer->ops->describe(drawer) : "";
}

bool gz_picture_maker_settling(const struct gz_picture_maker *maker)
{
	return gz_temporal_settling(&maker->temporal) ||
	       (maker->grows && gz_growth_settling(&maker->growth));
}

void gz_picture_maker_forget(struct gz_picture_maker *maker)
{
	gz_temporal_forget(&maker->temporal);
	maker->growth = (struct gz_growth) { 0 };
}

void gz_picture_maker_destroy(struct gz_picture_maker **maker)
{
	struct gz_picture_maker *self = *maker;
	if (!self)
		return;
	gz_drawers_free(&self->drawers);
	gz_plan_free(&self->plan);
	gz_temporal_free(&self->temporal);
	gz_image_free(&self->cast);
	gz_image_free(&self->image);
	free(self->kept_by.settings);
	free(self);
	*maker = NULL;
}
