#include "view/frame.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "render/picture_plan.h"
#include "render/scene_open.h"
#include "view/caster.h"

#define GZ_LOG_MODULE "gazeview"

/* Half the cross's arms and half its thickness, px (chosen: seen at arm's length, hides little). */
enum { CROSS_ARM_PX = 12, CROSS_HALF_PX = 1 };

struct gz_frame_maker {
	const struct gz_log *log;
	struct gz_scene scene;
	struct gz_caster caster;
	struct gz_attention attention;
	struct gz_gaze_reading reading; /* that the attention took last */
	struct gz_focus focus;          /* that it made of it */
	struct gz_focus made;           /* of the last frame made */
	struct {
		int method, width, height;
	} spent; /* what the budget's times are of */
	bool any_made;
	bool standard_told; /* that it keeps no time */
	struct gz_plan plan;
	struct gz_temporal temporal;
	struct gz_temporal_content content; /* of the frame in the making; its padding stays 0 */
	struct gz_image cast;  /* at the rays' resolution, only where that is not the picture's */
	struct gz_image image; /* the finished picture */
};

/* Pixels of the rays' grid along a side; 0 where that is no picture. */
static int cast_side(int side, double rate)
{
	double scaled = round(side * rate);
	return scaled >= 1 && scaled <= GZ_IMAGE_SIDE_MAX ? (int)scaled : 0;
}

static enum gz_result find_cast_size(int width, int height, double rate, const struct gz_log *log,
				     int out_size[2])
{
	out_size[0] = cast_side(width, rate);
	out_size[1] = cast_side(height, rate);
	if (out_size[0] > 0 && out_size[1] > 0)
		return GZ_OK;
	gz_err(log,
	       "%dx%d at image_sampling_rate %g is not 1 to %d rays a side; change the rate or the "
	       "size",
	       width, height, rate, GZ_IMAGE_SIDE_MAX);
	return GZ_ERR_INVAL;
}

/* What is asked for over the scene's own, and what contradicts it, before anything large is read.
 */
struct change {
	const struct gz_view_options *options;
	const struct gz_frame_scene *scene;
	const struct gz_log *log;
};

/* A table of spacings is found beside the scene that names it. */
static void keep(const struct gz_scene_settings *kept, struct gz_scene_settings *settings)
{
	const struct gz_foveation own = settings->foveation;
	const struct gz_clip_box clip = settings->rays.clip;
	settings->rays = kept->rays;
	settings->rays.clip = clip;
	settings->image_sampling_rate = kept->image_sampling_rate;
	settings->foveation = kept->foveation;
	settings->foveation.table = own.table;
	memcpy(settings->foveation.table_file, own.table_file, sizeof own.table_file);
	if (kept->foveation.method == GZ_METHOD_TABLE)
		settings->foveation.method = own.method;
	settings->attention = kept->attention;
	settings->temporal = kept->temporal;
	settings->view = kept->view;
}

static enum gz_result change_settings(void *user, struct gz_scene_settings *settings)
{
	const struct change *change = user;
	const struct gz_view_options *options = change->options;
	const struct gz_renderer_params params = { .threads = options->threads,
						   .simd = options->simd };
	int size[2];
	enum gz_result r = gz_renderer_check(options->backend, &params, change->log);
	if (r == GZ_OK && change->scene->by_options)
		r = gz_view_options_apply(options, settings);
	if (r == GZ_OK && change->scene->kept)
		keep(change->scene->kept, settings);
	if (r == GZ_OK && options->headless)
		r = find_cast_size(options->size_px[0], options->size_px[1],
				   settings->image_sampling_rate, change->log, size);
	return r;
}

static enum gz_result load(const struct change *change, const struct gz_loading *loading,
			   struct gz_scene *out_scene)
{
	const struct gz_frame_scene *scene = change->scene;
	struct change user = *change;
	struct gz_raw_layout told;
	const bool is_told = scene->by_options && gz_view_options_raw(change->options, &told);
	const struct gz_scene_request request = {
		.path = scene->path,
		.raw = scene->raw ? scene->raw
		       : is_told  ? &told
				  : NULL,
		.change = change_settings,
		.user = &user,
		.loading = loading,
	};
	return gz_scene_open(&request, change->log, out_scene);
}

struct gz_frame_scene gz_frame_scene_of_options(const struct gz_view_options *options)
{
	return (struct gz_frame_scene) { .path = options->scene, .by_options = true };
}

enum gz_result gz_frame_maker_create(const struct gz_view_options *options,
				     const struct gz_frame_scene *scene,
				     const struct gz_loading *loading, const struct gz_log *log,
				     struct gz_frame_maker **out_maker)
{
	struct gz_frame_maker *maker = calloc(1, sizeof *maker);
	if (!maker)
		return GZ_ERR_NO_MEM;
	maker->log = log;
	const struct gz_attention_params attention = gz_attention_default();
	gz_attention_init(&maker->attention, &attention);
	maker->focus = maker->attention.focus;
	const struct change change = { options, scene, log };
	enum gz_result r = load(&change, loading, &maker->scene);
	if (r != GZ_OK) {
		gz_frame_maker_destroy(&maker);
		return r;
	}
	*out_maker = maker;
	return GZ_OK;
}

enum gz_result gz_frame_maker_start(struct gz_frame_maker *maker,
				    const struct gz_view_options *options,
				    struct gz_gl_context *gl_context)
{
	return gz_caster_start(&maker->caster, options, gl_context, &maker->scene, maker->log);
}

enum gz_result gz_frame_maker_start_cpu(struct gz_frame_maker *maker,
					const struct gz_view_options *options)
{
	return gz_caster_start_cpu(&maker->caster, options, &maker->scene, maker->log);
}

void gz_frame_maker_stop(struct gz_frame_maker *maker)
{
	gz_caster_free(&maker->caster);
	gz_temporal_forget(&maker->temporal);
}

bool gz_frame_maker_started(const struct gz_frame_maker *maker)
{
	return maker->caster.renderer != NULL;
}

const struct gz_scene *gz_frame_maker_scene(const struct gz_frame_maker *maker)
{
	return &maker->scene;
}

enum gz_result gz_frame_set_transfer(struct gz_frame_maker *maker,
				     const struct gz_transfer *transfer)
{
	maker->scene.transfer = *transfer; /* also for the renderer that may replace this one */
	gz_temporal_forget(&maker->temporal);
	maker->any_made = false;
	const enum gz_result r =
		gz_renderer_set_transfer(maker->caster.renderer, &maker->scene.transfer);
	if (r != GZ_OK)
		gz_err(maker->log, "cannot take the transfer function: %s", gz_result_text(r));
	return r;
}

bool gz_frame_attend(struct gz_frame_maker *maker, const struct gz_attention_params *params,
		     const struct gz_gaze_reading *reading, const struct gz_display *display,
		     int64_t time_ns)
{
	const struct gz_attention_gaze gaze = {
		.known = reading->known,
		.point = reading->point,
		.has_age = reading->has_age,
		.age_ns = reading->age_ns,
		.has_event = reading->has_event,
		.event = reading->event,
		.noise_deg = reading->noise_deg,
	};
	gz_attention_set_params(&maker->attention, params);
	maker->reading = *reading;
	maker->focus = gz_attention_step(&maker->attention, &gaze, display, time_ns);
	return !maker->any_made || !gz_focus_same(&maker->focus, &maker->made);
}

void gz_frame_set_focus(struct gz_frame_maker *maker, const struct gz_gaze_reading *reading,
			const struct gz_focus *focus)
{
	maker->reading = *reading;
	maker->focus = *focus;
}

const struct gz_gaze_reading *gz_frame_reading(const struct gz_frame_maker *maker)
{
	return &maker->reading;
}

const char *gz_frame_backend(const struct gz_frame_maker *maker)
{
	return maker->caster.renderer->ops->name;
}

void gz_frame_forget(struct gz_frame_maker *maker)
{
	gz_temporal_forget(&maker->temporal);
}

bool gz_frame_settled(const struct gz_frame_maker *maker)
{
	return gz_attention_settled(&maker->attention);
}

bool gz_frame_refinable(const struct gz_frame_maker *maker)
{
	return !gz_budget_at_rest(&maker->attention.budget);
}

/* Whether and how earlier frames are kept: the request becomes that of a shifted plan. */
static enum gz_result begin_keeping(struct gz_frame_maker *maker,
				    const struct gz_scene_settings *settings,
				    struct gz_plan_request *plan, struct gz_display *display)
{
	if (!settings->temporal.accumulate) {
		gz_temporal_forget(&maker->temporal);
		return GZ_OK;
	}
	if (maker->scene.volume.bricks) {
		gz_err(maker->log, "temporal.accumulate: not with a file of bricks, which changes "
				   "while it is looked at; set it to no");
		return GZ_ERR_UNSUPPORTED;
	}
	memcpy(&maker->content.camera, &settings->camera, sizeof settings->camera);
	memcpy(&maker->content.rays, &settings->rays, sizeof settings->rays);
	memcpy(&maker->content.foveation, &settings->foveation, sizeof settings->foveation);
	return gz_temporal_begin(&maker->temporal, &maker->content, plan, display);
}

static enum gz_result cast_and_keep(struct gz_frame_maker *maker,
				    const struct gz_frame_request *request, struct gz_image *target,
				    struct gz_frame_stats *out_stats)
{
	enum gz_result r = gz_caster_render(&maker->caster, request->settings, &maker->plan, false,
					    &maker->temporal.frame_image, out_stats);
	int64_t start_ns = gz_clock_now_ns();
	if (r == GZ_OK)
		r = gz_temporal_end(&maker->temporal, &request->settings->temporal, &maker->content,
				    &maker->plan, target);
	/* The next one is sharper: this is not to be kept. */
	if (r == GZ_OK && out_stats->bricks_coming > 0)
		gz_temporal_forget(&maker->temporal);
	out_stats->reconstruct_ms += gz_ns_to_ms(gz_clock_now_ns() - start_ns);
	return r;
}

bool gz_frame_settling(const struct gz_frame_maker *maker)
{
	return gz_temporal_settling(&maker->temporal);
}

/* Rays first, then, where the scene asks for more or fewer rays than pixels, the picture. */
static enum gz_result cast_picture(struct gz_frame_maker *maker,
				   const struct gz_frame_request *request,
				   struct gz_frame_stats *out_stats)
{
	const struct gz_plan_view *view = &maker->plan.view;
	bool direct = view->width == request->width && view->height == request->height;
	struct gz_image *target = direct ? &maker->image : &maker->cast;
	maker->caster.loss_is_callers = request->loss_is_callers;
	enum gz_result r =
		request->settings->temporal.accumulate
			? cast_and_keep(maker, request, target, out_stats)
			: gz_caster_render(&maker->caster, request->settings, &maker->plan,
					   direct && request->on_device, target, out_stats);
	if (r != GZ_OK || direct)
		return r;
	int64_t start_ns = gz_clock_now_ns();
	r = gz_image_resize(&maker->image, request->width, request->height);
	if (r == GZ_OK)
		gz_image_resample(&maker->cast, &maker->image);
	out_stats->reconstruct_ms += gz_ns_to_ms(gz_clock_now_ns() - start_ns);
	return r;
}

static enum gz_result make(struct gz_frame_maker *maker, const struct gz_frame_request *request,
			   struct gz_frame_record *record)
{
	double rate = request->settings->image_sampling_rate;
	int size[2];
	enum gz_result r = find_cast_size(request->width, request->height, rate, maker->log, size);
	if (r != GZ_OK)
		return r;
	struct gz_frame_stats stats;
	int64_t start_ns = gz_clock_now_ns();
	const struct gz_picture_subject subject = {
		&maker->scene.volume,
		&request->settings->camera,
		&request->settings->rays,
	};
	struct gz_plan_request plan =
		gz_picture_plan_request(&subject, &request->settings->foveation, request->display,
					maker->focus.point, size[0], size[1]);
	plan.rays_per_px = rate;
	plan.scale = maker->focus.scale;
	plan.widen = maker->focus.widen;
	struct gz_display display = *request->display;
	r = begin_keeping(maker, request->settings, &plan, &display);
	if (r == GZ_OK)
		r = gz_plan_update(&plan, &maker->plan);
	if (r == GZ_OK && request->settings->temporal.accumulate)
		gz_temporal_place(&maker->temporal, &maker->plan);
	record->kept = r == GZ_OK && request->settings->temporal.accumulate && maker->temporal.any;
	int64_t planned_ns = gz_clock_now_ns();
	if (r == GZ_OK)
		r = cast_picture(maker, request, &stats);
	/* Whoever does not support it has said what, and what to do; so has who has lost its
	 * device.
	 */
	if (r != GZ_OK && r != GZ_ERR_UNSUPPORTED && r != GZ_ERR_NO_DEVICE)
		gz_err(maker->log, "cannot render %dx%d: %s; see the scene's camera and size",
		       request->width, request->height, gz_result_text(r));
	if (r != GZ_OK)
		return r;
	record->total_ms = gz_ns_to_ms(gz_clock_now_ns() - start_ns);
	record->plan_ms = gz_ns_to_ms(planned_ns - start_ns);
	record->cast_ms = stats.cast_ms;
	record->reconstruct_ms = stats.reconstruct_ms;
	record->rays = stats.rays;
	record->bricks_coming = stats.bricks_coming;
	record->samples = stats.samples;
	return GZ_OK;
}

void gz_frame_tell_unoriented(const struct gz_frame_maker *maker)
{
	if (!maker->scene.volume.oriented)
		gz_warn(maker->log, "no letters: the volume does not tell where right, front and "
				    "up are; give one that does, as NIfTI and DICOM do");
}

/* A time to keep makes plans coarser, and this method's is never coarse. */
static void tell_standard(struct gz_frame_maker *maker)
{
	if (maker->attention.params.budget_ms <= 0 || maker->standard_told)
		return;
	maker->standard_told = true;
	gz_warn(maker->log,
		"attention.budget_ms %g: standard casts every ray, whatever time that takes; "
		"take a method that can keep it, such as acuity",
		maker->attention.params.budget_ms);
}

static const char *budget_state(const struct gz_frame_maker *maker,
				const struct gz_frame_record *record)
{
	const struct gz_budget *budget = &maker->attention.budget;
	if (record->budget_ms > 0 && maker->spent.method == GZ_METHOD_STANDARD)
		return gz_budget_state_name(
			record->total_ms > record->budget_ms ? GZ_BUDGET_OVER : GZ_BUDGET_WITHIN);
	return gz_budget_state_name(budget->state);
}

/* The time to keep is of rays and pixels alone, not of what is drawn or written afterwards. What
 * another method or size took tells nothing. */
static void tell_spent(struct gz_frame_maker *maker, const struct gz_frame_request *request,
		       double total_ms)
{
	int method = request->settings->foveation.method;
	bool same = maker->spent.method == method && maker->spent.width == maker->plan.width &&
		    maker->spent.height == maker->plan.height;
	if (!same)
		gz_attention_forget_spent(&maker->attention);
	maker->spent.method = method;
	maker->spent.width = maker->plan.width;
	maker->spent.height = maker->plan.height;
	if (method == GZ_METHOD_STANDARD) {
		tell_standard(maker);
		return;
	}
	if (gz_attention_spent(&maker->attention, total_ms))
		gz_warn(maker->log,
			"attention.budget_ms %g is out of reach: %s took %.1f ms with its coarsest "
			"plan; allow more time, lower the size or render.ray_sampling_rate, or try "
			"another method",
			maker->attention.params.budget_ms, gz_method_names[method], total_ms);
}

static struct gz_frame_record begin_record(const struct gz_frame_maker *maker,
					   const struct gz_frame_request *request)
{
	const struct gz_gaze_reading *reading = &maker->reading;
	return (struct gz_frame_record) {
		.method = gz_method_names[request->settings->foveation.method],
		.width = request->width,
		.height = request->height,
		.gaze_known = reading->known,
		.gaze = reading->point,
		.age_known = reading->known && reading->has_age,
		.gaze_age_ms = gz_ns_to_ms(reading->age_ns),
		.attention = gz_attention_state_name(maker->attention.state),
		.focus = maker->focus,
		.budget_ms = maker->attention.params.budget_ms,
	};
}

enum gz_result gz_frame_make(struct gz_frame_maker *maker, const struct gz_frame_request *request,
			     struct gz_image **out_image, struct gz_frame_record *out_record)
{
	struct gz_frame_record record = begin_record(maker, request);
	enum gz_result r = make(maker, request, &record);
	if (r != GZ_OK)
		return r;
	maker->made = maker->focus;
	maker->any_made = true;
	tell_spent(maker, request, record.total_ms);
	record.budget = budget_state(maker, &record);
	record.backend = gz_frame_backend(maker); /* cpu may have taken over */
	*out_image = maker->caster.on_device ? NULL : &maker->image;
	*out_record = record;
	return GZ_OK;
}

unsigned gz_frame_texture(const struct gz_frame_maker *maker)
{
	return gz_renderer_picture_texture(maker->caster.renderer);
}

const struct gz_plan *gz_frame_plan(const struct gz_frame_maker *maker)
{
	return &maker->plan;
}

static void fill(struct gz_image *image, int left, int top, int right, int bottom)
{
	static const uint8_t colour[4] = { 255, 64, 64, 255 };
	for (int y = top < 0 ? 0 : top; y <= bottom && y < image->height; y++) {
		for (int x = left < 0 ? 0 : left; x <= right && x < image->width; x++)
			memcpy(image->pixels + 4 * ((size_t)y * (size_t)image->width + (size_t)x),
			       colour, sizeof colour);
	}
}

void gz_frame_draw_cross(struct gz_image *image, struct gz_point at)
{
	double x = floor((double)at.x * image->width), y = floor((double)at.y * image->height);
	if (!(x >= -CROSS_ARM_PX && x < image->width + CROSS_ARM_PX) ||
	    !(y >= -CROSS_ARM_PX && y < image->height + CROSS_ARM_PX))
		return;
	int column = (int)x, row = (int)y;
	fill(image, column - CROSS_ARM_PX, row - CROSS_HALF_PX, column + CROSS_ARM_PX,
	     row + CROSS_HALF_PX);
	fill(image, column - CROSS_HALF_PX, row - CROSS_ARM_PX, column + CROSS_HALF_PX,
	     row + CROSS_ARM_PX);
}

void gz_frame_maker_destroy(struct gz_frame_maker **maker)
{
	if (!maker || !*maker)
		return;
	gz_caster_free(&(*maker)->caster);
	gz_plan_free(&(*maker)->plan);
	gz_temporal_free(&(*maker)->temporal);
	gz_image_free(&(*maker)->cast);
	gz_image_free(&(*maker)->image);
	gz_scene_free(&(*maker)->scene);
	free(*maker);
	*maker = NULL;
}
