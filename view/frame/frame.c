#include "view/frame/frame.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "render/data/time_steps.h"
#include "render/frame/picture_maker.h"
#include "render/illustration/illustration_automatic.h"
#include "render/plan/method.h"
#include "render/scene/scene_open.h"
#include "render/scene/techniques.h"
#include "view/frame/label_change.h"
#include "view/frame/looked_at.h"
#include "view/frame/spare.h"

#define GZ_LOG_MODULE "gazeview"

/* Half the length and half the thickness of the cross's arms, px. Chosen: visible at arm's length,
 * and hides little. */
enum { CROSS_ARM_PX = 12, CROSS_HALF_PX = 1 };

static const char cpu_name[] = "cpu";

/* The time points of a series. The thread that loads them reads the first members. */
struct time_points {
	char path[GZ_PATH_SIZE]; /* of the scene */
	struct gz_scene_settings settings;
	double number_range[2];
	const struct gz_log *log;
	void (*finished)(void *user);
	struct gz_time_steps *steps;
	struct gz_volume *taken; /* ready to be shown; NULL: none */
};

/* Surfaces of labels with another look, which are made beside the frames: first the surfaces, then
 * what draws them. */
struct next_labels {
	struct gz_label_change *change; /* NULL: the surfaces are not in the making */
	struct gz_label_surfaces *made; /* NULL: there are none */
	struct gz_label_look look;      /* of those */
	struct gz_spare *spare;         /* NULL: it does not draw them */
};

struct gz_frame_maker {
	const struct gz_log *log;
	struct gz_scene scene;
	char path[GZ_PATH_SIZE];           /* of the scene */
	struct gz_view_settings own_view;  /* the scene's, without overrides */
	bool has_own_view;                 /* there are overrides */
	struct time_points *time_points;   /* NULL until another one is asked for */
	uint64_t data_revision;            /* of the scene's volume */
	struct gz_picture_maker *pictures; /* NULL: not started */
	struct gz_backend_params params;   /* of pictures */
	struct {
		const struct gz_view_options *options; /* NULL: the renderer stays */
		struct gz_gl_context *gl_context;
	} choice;               /* gz_frame_maker_let_choose() */
	struct gz_spare *spare; /* NULL: none is made */
	struct next_labels labels;
	uint64_t transfer_revision; /* of the scene's transfer function */
	struct gz_attention attention;
	struct gz_gaze_reading reading; /* the last one passed to the attention */
	struct gz_focus focus;          /* the attention's answer */
	struct gz_focus made;           /* focus of the last frame made */
	struct gz_interest interest;    /* which object is looked at */
	struct gz_raised raised;        /* for the next frame */
	struct gz_raised raised_shown;  /* by the renderer */
	struct gz_object_style raised_style;
	struct gz_transfer raised_transfer;         /* with what is raised of its values */
	struct gz_illustration_automatic automatic; /* which its settings follow */
	bool change_given;                   /* by gz_frame_set_change(), for the next frame */
	struct gz_shading_measures measures; /* of the last frame */
	bool measured;
	int64_t time_ns;           /* of the newest gz_frame_attend() */
	struct gz_ray_params rays; /* of the frame in the making */
	struct {
		struct gz_camera camera;
		struct gz_ray_params rays;
		int width, height;
	} last; /* what the last frame showed; valid with any_shown */
	bool any_shown;
	struct gz_plan preview; /* of gz_frame_preview() */
	struct {
		int method, width, height;
	} spent; /* method and size the budget's times belong to */
	bool any_made;
	int refused_technique; /* render.technique that failed; 0: none */
	bool standard_told;    /* the warning that standard ignores the budget was logged */
};

/* Overrides of the scene's settings; contradictions are found before large files are read. */
struct change {
	const struct gz_view_options *options;
	const struct gz_frame_scene *scene;
	const struct gz_log *log;
	struct gz_view_settings *own_view; /* gets the scene's, without overrides */
};

/* The spacing table and the pictures of the surroundings stay the scene's own, as their files are
 * found beside the scene. */
static void keep_settings(const struct gz_scene_settings *kept, struct gz_scene_settings *settings)
{
	const struct gz_foveation own = settings->foveation;
	const struct gz_clip_region clip = settings->rays.clip;
	struct gz_environment *environment = &settings->rays.environment;
	const struct gz_environment around = *environment;
	settings->rays = kept->rays;
	settings->rays.clip = clip;
	memcpy(environment->cube, around.cube, sizeof around.cube);
	memcpy(environment->cube_path, around.cube_path, sizeof around.cube_path);
	if (environment->kind == GZ_SURROUNDINGS_CUBE)
		environment->kind = around.kind;
	settings->technique = kept->technique;
	settings->image_sampling_rate = kept->image_sampling_rate;
	settings->foveation = kept->foveation;
	settings->foveation.table = own.table;
	memcpy(settings->foveation.table_file, own.table_file, sizeof own.table_file);
	if (gz_method_of(&kept->foveation)->needs_table)
		settings->foveation.method = own.method;
	settings->attention = kept->attention;
	settings->temporal = kept->temporal;
	settings->view = kept->view;
}

static enum gz_result override_settings(void *user, struct gz_scene_settings *settings)
{
	const struct change *change = user;
	const struct gz_view_options *options = change->options;
	const struct gz_backend_params params = { .threads = options->threads,
						  .simd = options->simd };
	int rays[2];
	*change->own_view = settings->view;
	enum gz_result r = gz_techniques[0]->check(options->backend, &params, change->log);
	if (r == GZ_OK && change->scene->by_options)
		r = gz_view_options_apply(options, settings);
	if (r == GZ_OK && change->scene->kept)
		keep_settings(change->scene->kept, settings);
	if (r == GZ_OK && change->scene->series_uid)
		snprintf(settings->volume_series, sizeof settings->volume_series, "%s",
			 change->scene->series_uid);
	if (r == GZ_OK && change->scene->resample && settings->resample == GZ_RESAMPLING_OFF)
		settings->resample = GZ_RESAMPLING_LINEAR;
	if (r == GZ_OK && options->headless)
		r = gz_picture_count_rays(options->size_px, settings->image_sampling_rate,
					  change->log, rays);
	return r;
}

static enum gz_result open_frame_scene(const struct change *change,
				       const struct gz_loading *loading, struct gz_scene *out_scene)
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
		.change = override_settings,
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
	snprintf(maker->path, sizeof maker->path, "%s", scene->path);
	const struct gz_attention_params attention = gz_attention_default();
	gz_attention_init(&maker->attention, &attention);
	maker->focus = maker->attention.focus;
	const struct change change = { options, scene, log, &maker->own_view };
	maker->has_own_view = scene->by_options || scene->kept;
	enum gz_result r = open_frame_scene(&change, loading, &maker->scene);
	if (r != GZ_OK) {
		gz_frame_maker_destroy(&maker);
		return r;
	}
	*out_maker = maker;
	return GZ_OK;
}

/* Whether some values of a volume are raised, not an object. */
static bool raises_values(const struct gz_raised *raised)
{
	return raised->id != 0 && raised->least != raised->greatest;
}

/* Note how the object is shown that is raised in importance. Its importance without the gaze is
 * that of the scene, and so is its transfer function. */
static void style_raised(struct gz_frame_maker *maker)
{
	const struct gz_raised *raised = &maker->raised_shown;
	struct gz_object objects[GZ_SCENE_LISTED_MAX];
	if (raised->id == 0)
		return;
	/* A recorded number may be that of no volume: then nothing stands out. */
	maker->raised_transfer = maker->scene.transfer;
	const size_t count = gz_scene_list_objects(&maker->scene, objects, GZ_SCENE_LISTED_MAX);
	for (size_t i = 0; i < count; i++) {
		if (objects[i].id != raised->id)
			continue;
		maker->raised_style = objects[i].style ? *objects[i].style : gz_object_style_plain;
		maker->raised_style.importance =
			gz_raised_importance(maker->raised_style.importance, raised->share);
		if (!raises_values(raised) || !objects[i].transfer)
			continue;
		maker->raised_transfer = *objects[i].transfer;
		maker->raised_transfer.emphasis =
			(struct gz_transfer_emphasis) { raised->share, raised->least,
							raised->greatest };
	}
}

/* What the scene shows, with the revisions of now. */
static size_t list_scene_objects(const struct gz_frame_maker *maker,
				 struct gz_object out_objects[GZ_SCENE_LISTED_MAX])
{
	const size_t count = gz_scene_list_objects(&maker->scene, out_objects, GZ_SCENE_LISTED_MAX);
	for (size_t i = 0; i < count; i++) {
		out_objects[i].transfer_revision = maker->transfer_revision;
		out_objects[i].data_revision = maker->data_revision;
		if (maker->raised_shown.id == 0 || out_objects[i].id != maker->raised_shown.id)
			continue;
		out_objects[i].style = &maker->raised_style;
		if (out_objects[i].transfer && raises_values(&maker->raised_shown))
			out_objects[i].transfer = &maker->raised_transfer;
	}
	return count;
}

/* Stop making anything ready for what is shown: it is about to change. */
static void drop_spares(struct gz_frame_maker *maker)
{
	gz_spare_drop(&maker->spare);
	gz_spare_drop(&maker->labels.spare);
}

size_t gz_frame_list_objects(const struct gz_frame_maker *maker,
			     struct gz_object out_objects[GZ_SCENE_LISTED_MAX])
{
	return list_scene_objects(maker, out_objects);
}

static enum gz_result show_scene_objects(struct gz_frame_maker *maker)
{
	struct gz_object objects[GZ_SCENE_LISTED_MAX];
	const size_t count = list_scene_objects(maker, objects);
	return gz_picture_maker_show(maker->pictures, objects, count);
}

static struct gz_backend_params backend_params(const struct gz_view_options *options,
					       struct gz_gl_context *gl_context)
{
	return (struct gz_backend_params) {
		.threads = options->threads,
		.simd = options->simd,
		.wait_for_bricks = options->bricks == GZ_BRICKS_AUTO
					   ? options->headless
					   : options->bricks == GZ_BRICKS_WAIT,
		.gl_context = gl_context,
		.gl_memory_bytes = (size_t)options->gl_memory_mib << 20,
	};
}

static enum gz_result start_pictures(struct gz_frame_maker *maker,
				     const struct gz_picture_maker_params *params)
{
	maker->choice.options = NULL;
	maker->params = params->backend_params;
	enum gz_result r = gz_picture_maker_create(params, maker->log, &maker->pictures);
	if (r == GZ_OK)
		r = show_scene_objects(maker);
	if (r != GZ_OK) {
		gz_picture_maker_destroy(&maker->pictures);
		return r;
	}
	gz_debug(maker->log, "%s", gz_picture_maker_describe(maker->pictures));
	return r;
}

static struct gz_picture_maker_params chosen_by_options(const struct gz_view_options *options,
							struct gz_gl_context *gl_context)
{
	return (struct gz_picture_maker_params) {
		.backend = options->backend,
		.backend_params = backend_params(options, gl_context),
		.cpu_takes_over = true,
	};
}

enum gz_result gz_frame_maker_start(struct gz_frame_maker *maker,
				    const struct gz_view_options *options,
				    struct gz_gl_context *gl_context)
{
	const struct gz_picture_maker_params params = chosen_by_options(options, gl_context);
	return start_pictures(maker, &params);
}

enum gz_result gz_frame_maker_start_cpu(struct gz_frame_maker *maker,
					const struct gz_view_options *options)
{
	const struct gz_picture_maker_params params = {
		.backend = cpu_name,
		.backend_params = backend_params(options, NULL),
	};
	return start_pictures(maker, &params);
}

void gz_frame_maker_let_choose(struct gz_frame_maker *maker, const struct gz_view_options *options,
			       struct gz_gl_context *gl_context)
{
	maker->choice.options = options;
	maker->choice.gl_context = gl_context;
}

bool gz_frame_takes_cpu(const struct gz_view_options *options, struct gz_gl_context *gl_context,
			const struct gz_log *log)
{
	const struct gz_backend_params params = backend_params(options, gl_context);
	struct gz_drawer *drawer = NULL;
	if (strcmp(options->backend, cpu_name) == 0)
		return true;
	if (strcmp(options->backend, "auto") != 0 ||
	    gz_techniques[0]->create("auto", &params, log, &drawer) != GZ_OK)
		return false;
	const bool cpu = strcmp(drawer->ops->backend(drawer), cpu_name) == 0;
	gz_drawer_destroy(&drawer);
	return cpu;
}

bool gz_frame_cpu_suffices(const struct gz_frame_maker *maker)
{
	struct gz_object objects[GZ_SCENE_LISTED_MAX];
	const size_t count =
		gz_scene_list_objects(&maker->scene, objects, sizeof objects / sizeof objects[0]);
	for (size_t i = 0; i < count; i++)
		if (!gz_technique_has_backend(objects[i].technique, cpu_name))
			return false;
	return true;
}

void gz_frame_maker_stop(struct gz_frame_maker *maker)
{
	drop_spares(maker);
	gz_picture_maker_destroy(&maker->pictures);
}

bool gz_frame_maker_started(const struct gz_frame_maker *maker)
{
	return maker->pictures != NULL;
}

const struct gz_scene *gz_frame_maker_scene(const struct gz_frame_maker *maker)
{
	return &maker->scene;
}

const struct gz_view_settings *gz_frame_maker_own_view(const struct gz_frame_maker *maker)
{
	return maker->has_own_view ? &maker->own_view : NULL;
}

static bool is_of_values(const struct gz_looked_at *thing)
{
	return thing->id != 0 && thing->least != thing->greatest;
}

/* Forget which values are looked at and raised: by another function, others look alike. */
static void forget_values(struct gz_frame_maker *maker)
{
	const struct gz_interest *interest = &maker->interest;
	if (is_of_values(&interest->looked_at) || is_of_values(&interest->raised))
		maker->interest = (struct gz_interest) { 0 };
	if (raises_values(&maker->raised))
		maker->raised = (struct gz_raised) { 0 };
	if (raises_values(&maker->raised_shown))
		maker->raised_shown = (struct gz_raised) { 0 };
}

enum gz_result gz_frame_set_transfer(struct gz_frame_maker *maker,
				     const struct gz_transfer *transfer)
{
	drop_spares(maker);
	maker->scene.transfer = *transfer;
	maker->transfer_revision++;
	forget_values(maker);
	style_raised(maker);
	maker->any_made = false;
	const enum gz_result r = show_scene_objects(maker);
	if (r != GZ_OK)
		gz_err(maker->log, "cannot use the transfer function: %s", gz_result_text(r));
	return r;
}

int gz_frame_time_points(const struct gz_frame_maker *maker)
{
	const int points = maker->scene.volume.time_points;
	return points > 1 ? points : 1;
}

int gz_frame_time_point(const struct gz_frame_maker *maker)
{
	return maker->scene.volume.time_point;
}

static enum gz_result load_time_point(void *user, int step, const struct gz_loading *loading,
				      void **out_data)
{
	const struct time_points *points = user;
	const struct gz_scene_time_point which = {
		.name = points->path,
		.settings = &points->settings,
		.time_point = step,
		.number_range = points->number_range,
	};
	struct gz_volume *volume = calloc(1, sizeof *volume);
	if (!volume) {
		gz_err(points->log, "no memory for time point %d", step + 1);
		return GZ_ERR_NO_MEM;
	}
	const enum gz_result r = gz_scene_load_time_point(&which, loading, points->log, volume);
	if (r != GZ_OK) {
		free(volume);
		return r;
	}
	*out_data = volume;
	return GZ_OK;
}

static void release_time_point(void *user, void *data)
{
	struct gz_volume *volume = data;
	(void)user;
	if (!volume)
		return;
	gz_volume_free(volume);
	free(volume);
}

static void tell_time_point_finished(void *user)
{
	const struct time_points *points = user;
	if (points->finished)
		points->finished(NULL);
}

static void free_time_points(struct time_points *points)
{
	if (!points)
		return;
	gz_time_steps_destroy(&points->steps);
	release_time_point(NULL, points->taken);
	free(points);
}

/* Start the thread that loads time points, if it does not run. NULL: it cannot; logged. */
static struct gz_time_steps *time_steps_of(struct gz_frame_maker *maker,
					   void (*finished)(void *user))
{
	if (maker->time_points)
		return maker->time_points->steps;
	struct time_points *points = calloc(1, sizeof *points);
	enum gz_result r = points ? GZ_OK : GZ_ERR_NO_MEM;
	if (r == GZ_OK) {
		memcpy(points->path, maker->path, sizeof points->path);
		points->settings = maker->scene.settings;
		memcpy(points->number_range, maker->scene.volume.number_range,
		       sizeof points->number_range);
		points->log = maker->log;
		points->finished = finished;
		const struct gz_time_step_source source = {
			.count = gz_frame_time_points(maker),
			.user = points,
			.load = load_time_point,
			.release = release_time_point,
			.finished = tell_time_point_finished,
		};
		r = gz_time_steps_create(&source, &points->steps);
	}
	if (r != GZ_OK) {
		gz_err(maker->log, "cannot load further time points: %s", gz_result_text(r));
		free(points);
		return NULL;
	}
	maker->time_points = points;
	return points->steps;
}

void gz_frame_expect_time_point(struct gz_frame_maker *maker, int time_point,
				void (*finished)(void *user))
{
	struct gz_time_steps *steps = time_steps_of(maker, finished);
	if (steps && time_point != gz_frame_time_point(maker))
		gz_time_steps_expect(steps, time_point);
}

enum gz_result gz_frame_take_time_point(struct gz_frame_maker *maker, int time_point, bool wait)
{
	struct gz_time_steps *steps = time_steps_of(maker, NULL);
	void *data = NULL;
	if (!steps)
		return GZ_ERR_NO_MEM;
	const enum gz_result r = gz_time_steps_take(steps, time_point, wait, &data);
	if (r != GZ_OK)
		return r;
	release_time_point(NULL, maker->time_points->taken);
	maker->time_points->taken = data;
	return GZ_OK;
}

/* Exchange the volume shown and the one taken. */
static void exchange_time_points(struct gz_frame_maker *maker)
{
	struct gz_volume *taken = maker->time_points->taken;
	const struct gz_volume shown = maker->scene.volume;
	maker->scene.volume = *taken;
	*taken = shown;
	maker->scene.settings.time_point = maker->scene.volume.time_point + 1;
	maker->data_revision++;
}

enum gz_result gz_frame_show_taken(struct gz_frame_maker *maker)
{
	if (!maker->time_points || !maker->time_points->taken)
		return GZ_ERR_INVAL;
	drop_spares(maker);
	exchange_time_points(maker);
	maker->any_made = false;
	enum gz_result r = maker->pictures ? show_scene_objects(maker) : GZ_OK;
	if (r != GZ_OK) {
		gz_err(maker->log, "cannot show time point %d: %s",
		       maker->scene.volume.time_point + 1, gz_result_text(r));
		exchange_time_points(maker);
		(void)show_scene_objects(maker);
	}
	/* The renderer has let go of it. */
	release_time_point(NULL, maker->time_points->taken);
	maker->time_points->taken = NULL;
	return r;
}

/* A place of a picture. @return false: it is not in the picture, or nothing is shown */
static bool request_pick(const struct gz_frame_maker *maker, const struct gz_camera *camera,
			 const struct gz_ray_params *rays, const int size_px[2],
			 struct gz_point point, struct gz_pick_request *out_request)
{
	*out_request = (struct gz_pick_request) {
		.camera = camera,
		.settings = rays,
		.width = size_px[0],
		.height = size_px[1],
		.x = (double)point.x * size_px[0],
		.y = (double)point.y * size_px[1],
	};
	return maker->pictures && point.x >= 0 && point.x <= 1 && point.y >= 0 && point.y <= 1;
}

/* What is seen at the focus, as the last frame showed it; a lost gaze looks at nothing. */
static struct gz_looked_at attended_thing(struct gz_frame_maker *maker)
{
	const int size_px[2] = { maker->last.width, maker->last.height };
	struct gz_object objects[GZ_SCENE_LISTED_MAX];
	struct gz_pick_request request;
	if (!maker->any_shown || maker->attention.state == GZ_ATTENTION_WIDEN ||
	    !request_pick(maker, &maker->last.camera, &maker->last.rays, size_px,
			  maker->focus.point, &request))
		return (struct gz_looked_at) { 0 };
	return gz_looked_at_find(maker->pictures, objects, list_scene_objects(maker, objects),
				 &request);
}

/* Follow what is looked at. */
static void attend_object(struct gz_frame_maker *maker, const struct gz_attention_params *params,
			  int64_t time_ns)
{
	if (params->importance <= 0) {
		maker->interest = (struct gz_interest) { 0 };
	} else {
		const struct gz_looked_at thing = attended_thing(maker);
		maker->interest = gz_interest_step(maker->interest, params, &thing, time_ns);
	}
	maker->raised = gz_interest_raised(&maker->interest, params);
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
		.landing = reading->landing,
		.noise_deg = reading->noise_deg,
	};
	gz_attention_set_params(&maker->attention, params);
	maker->reading = *reading;
	maker->focus = gz_attention_step(&maker->attention, &gaze, display, time_ns);
	attend_object(maker, params, time_ns);
	maker->time_ns = time_ns;
	return !maker->any_made || !gz_focus_same(&maker->focus, &maker->made) ||
	       !gz_raised_same(&maker->raised, &maker->raised_shown) || maker->automatic.moving;
}

void gz_frame_set_change(struct gz_frame_maker *maker, const struct gz_illustration_change *change)
{
	maker->automatic = (struct gz_illustration_automatic) { .change = *change };
	maker->change_given = true;
}

struct gz_illustration_change gz_frame_change(const struct gz_frame_maker *maker)
{
	return maker->automatic.change;
}

const struct gz_ray_params *gz_frame_rays(const struct gz_frame_maker *maker)
{
	return &maker->last.rays;
}

void gz_frame_set_raised(struct gz_frame_maker *maker, const struct gz_raised *raised)
{
	maker->raised = *raised;
}

struct gz_raised gz_frame_raised(const struct gz_frame_maker *maker)
{
	return maker->raised;
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
	return gz_picture_maker_backend(maker->pictures);
}

const char *gz_frame_standard_backend(const struct gz_frame_maker *maker)
{
	struct gz_object objects[GZ_SCENE_LISTED_MAX];
	const size_t count =
		gz_scene_list_objects(&maker->scene, objects, sizeof objects / sizeof objects[0]);
	for (size_t i = 0; i < count; i++)
		if (objects[i].technique->backends_agree)
			return cpu_name;
	return gz_frame_backend(maker);
}

void gz_frame_forget(struct gz_frame_maker *maker)
{
	gz_picture_maker_forget(maker->pictures);
}

bool gz_frame_settled(const struct gz_frame_maker *maker)
{
	return gz_attention_settled(&maker->attention) && gz_interest_at_rest(&maker->interest) &&
	       !maker->automatic.moving;
}

bool gz_frame_refinable(const struct gz_frame_maker *maker)
{
	return !gz_budget_at_rest(&maker->attention.budget);
}

bool gz_frame_settling(const struct gz_frame_maker *maker)
{
	return gz_picture_maker_settling(maker->pictures);
}

/* Make pictures of what the scene shows ready on a thread. */
static enum gz_result start_spare(const struct gz_frame_maker *maker,
				  const struct gz_scene_settings *settings,
				  void (*finished)(void *user), struct gz_spare **out_spare)
{
	struct gz_object objects[GZ_SCENE_LISTED_MAX];
	const size_t count = list_scene_objects(maker, objects);
	const struct gz_spare_request request = {
		.objects = objects,
		.object_count = count,
		.settings = settings,
		.params = maker->params,
		.finished = finished,
		.log = maker->log,
	};
	return gz_spare_start(&request, out_spare);
}

static bool draws_by_cpu(const struct gz_frame_maker *maker)
{
	return strcmp(gz_frame_backend(maker), cpu_name) == 0;
}

enum gz_frame_ready gz_frame_prepare(struct gz_frame_maker *maker,
				     const struct gz_scene_settings *settings,
				     void (*finished)(void *user))
{
	if (!maker->pictures || settings->technique != maker->scene.settings.technique)
		return GZ_FRAME_CANNOT_WAIT;
	const bool by_cpu = draws_by_cpu(maker);
	if (!by_cpu && !gz_picture_maker_can_take_prepared(maker->pictures))
		return GZ_FRAME_CANNOT_WAIT;
	if (maker->spare && !gz_spare_finished(maker->spare))
		return GZ_FRAME_PREPARING;
	const bool suits = maker->spare && gz_spare_suits(maker->spare, settings);
	if (maker->spare && !suits)
		gz_spare_drop(&maker->spare);
	if (!suits)
		return start_spare(maker, settings, finished, &maker->spare) == GZ_OK
			       ? GZ_FRAME_PREPARING
			       : GZ_FRAME_CANNOT_WAIT;
	struct gz_picture_maker *made = NULL;
	if (gz_spare_take(&maker->spare, &made) != GZ_OK)
		return GZ_FRAME_CANNOT_WAIT;
	if (by_cpu)
		gz_picture_maker_adopt(maker->pictures, &made);
	else
		gz_picture_maker_take_prepared(maker->pictures, &made);
	return GZ_FRAME_READY;
}

/* ---- labels with another look ---- */

/* Drop surfaces that were made and not shown. */
static void drop_made_labels(struct gz_frame_maker *maker)
{
	gz_spare_drop(&maker->labels.spare);
	gz_scene_free_labels(&maker->scene, maker->labels.made);
	maker->labels.made = NULL;
}

void gz_frame_drop_labels(struct gz_frame_maker *maker)
{
	struct next_labels *next = &maker->labels;
	drop_made_labels(maker);
	if (next->change && gz_label_change_take(&next->change, &next->made) == GZ_OK)
		drop_made_labels(maker);
}

bool gz_frame_making_labels(const struct gz_frame_maker *maker)
{
	const struct next_labels *next = &maker->labels;
	return (next->change && !gz_label_change_finished(next->change)) ||
	       (next->spare && !gz_spare_finished(next->spare));
}

/* Make the surfaces. */
static enum gz_frame_ready make_labels(struct gz_frame_maker *maker,
				       const struct gz_scene_settings *settings,
				       void (*finished)(void *user))
{
	struct next_labels *next = &maker->labels;
	if (next->made && gz_label_look_same(&next->look, &settings->labels))
		return GZ_FRAME_READY;
	drop_made_labels(maker);
	if (next->change && !gz_label_change_finished(next->change))
		return GZ_FRAME_PREPARING;
	if (next->change) {
		next->look = *gz_label_change_look(next->change);
		const bool asked_for = gz_label_look_same(&next->look, &settings->labels);
		const enum gz_result r = gz_label_change_take(&next->change, &next->made);
		if (asked_for)
			return r == GZ_OK ? GZ_FRAME_READY : GZ_FRAME_CANNOT_WAIT;
		drop_made_labels(maker);
	}
	const struct gz_scene_label_request request = {
		.name = maker->path,
		.settings = settings,
		.centre = maker->scene.centre,
	};
	const enum gz_result r =
		gz_label_change_start(&request, finished, maker->log, &next->change);
	if (r == GZ_OK)
		return GZ_FRAME_PREPARING;
	gz_err(maker->log, "cannot show the labels: %s", gz_result_text(r));
	return GZ_FRAME_CANNOT_WAIT;
}

/* Exchange the surfaces shown and those made. */
static void exchange_labels(struct gz_frame_maker *maker)
{
	struct gz_scene *scene = &maker->scene;
	struct gz_label_surfaces *const shown = scene->labels;
	const struct gz_label_look look = scene->settings.labels;
	scene->labels = maker->labels.made;
	scene->settings.labels = maker->labels.look;
	maker->labels.made = shown;
	maker->labels.look = look;
}

/* Make ready what draws the surfaces. gl does not prepare them: it uploads them. */
static enum gz_frame_ready make_label_drawer(struct gz_frame_maker *maker,
					     const struct gz_scene_settings *settings,
					     void (*finished)(void *user))
{
	struct gz_spare **spare = &maker->labels.spare;
	if (!maker->pictures || !draws_by_cpu(maker))
		return GZ_FRAME_READY;
	if (*spare && !gz_spare_finished(*spare))
		return GZ_FRAME_PREPARING;
	if (*spare && gz_spare_suits(*spare, settings))
		return GZ_FRAME_READY;
	gz_spare_drop(spare);
	exchange_labels(maker);
	const enum gz_result r = start_spare(maker, settings, finished, spare);
	exchange_labels(maker);
	/* Without one, the next frame prepares what it needs. */
	return r == GZ_OK ? GZ_FRAME_PREPARING : GZ_FRAME_READY;
}

enum gz_frame_ready gz_frame_prepare_labels(struct gz_frame_maker *maker,
					    const struct gz_scene_settings *settings,
					    void (*finished)(void *user))
{
	const enum gz_frame_ready made = make_labels(maker, settings, finished);
	return made == GZ_FRAME_READY ? make_label_drawer(maker, settings, finished) : made;
}

/* Draw what the scene has now, by the spare if there is one. */
static enum gz_result show_made_labels(struct gz_frame_maker *maker)
{
	struct gz_picture_maker *ready = NULL;
	if (!maker->pictures)
		return GZ_OK;
	if (maker->labels.spare && gz_spare_take(&maker->labels.spare, &ready) == GZ_OK) {
		gz_picture_maker_adopt(maker->pictures, &ready);
		return GZ_OK;
	}
	return show_scene_objects(maker);
}

enum gz_result gz_frame_show_labels(struct gz_frame_maker *maker)
{
	if (!maker->labels.made)
		return GZ_ERR_INVAL;
	gz_spare_drop(&maker->spare);
	exchange_labels(maker);
	maker->any_made = false;
	const enum gz_result r = show_made_labels(maker);
	if (r != GZ_OK) {
		gz_err(maker->log, "cannot show the labels: %s", gz_result_text(r));
		exchange_labels(maker);
		(void)show_scene_objects(maker);
	}
	/* The renderer has let go of them. */
	drop_made_labels(maker);
	return r;
}

/* Show objects and regions as the settings say, if that has changed. */
static enum gz_result follow_objects(struct gz_frame_maker *maker,
				     const struct gz_scene_settings *settings)
{
	struct gz_object objects[GZ_SCENE_LISTED_MAX];
	const bool changed = gz_scene_show_as(settings, &maker->scene.settings);
	if (!changed && gz_raised_same(&maker->raised, &maker->raised_shown))
		return GZ_OK;
	drop_spares(maker);
	if (raises_values(&maker->raised_shown) || raises_values(&maker->raised))
		maker->transfer_revision++;
	maker->raised_shown = maker->raised;
	style_raised(maker);
	maker->any_made = maker->any_made && !changed;
	const size_t count = list_scene_objects(maker, objects);
	if (count > 0)
		return gz_picture_maker_show(maker->pictures, objects, count);
	gz_err(maker->log, "no object is visible any more; at least one must stay");
	return GZ_ERR_INVAL;
}

/* Replace a renderer of cpu by one whose backend the options choose, and which shows the objects.
 * If that fails, the present one stays; logged. */
static enum gz_result choose_pictures(struct gz_frame_maker *maker)
{
	const struct gz_view_options *options = maker->choice.options;
	const struct gz_backend_params before = maker->params;
	struct gz_picture_maker *cpu = maker->pictures;
	const struct gz_picture_maker_params params =
		chosen_by_options(options, maker->choice.gl_context);
	drop_spares(maker);
	maker->pictures = NULL;
	const enum gz_result r = start_pictures(maker, &params);
	if (r == GZ_OK) {
		gz_picture_maker_destroy(&cpu);
		return r;
	}
	maker->choice.options = options;
	maker->pictures = cpu;
	maker->params = before;
	return r;
}

static enum gz_result show_by_technique(struct gz_frame_maker *maker)
{
	const bool may_choose =
		maker->choice.options && strcmp(gz_frame_backend(maker), cpu_name) == 0;
	return may_choose && !gz_frame_cpu_suffices(maker) ? choose_pictures(maker)
							   : show_scene_objects(maker);
}

/* Draw by another technique if the settings ask for it. If that fails, the present one
 * stays. */
static enum gz_result follow_technique(struct gz_frame_maker *maker, int technique)
{
	int *shown = &maker->scene.settings.technique;
	const int before = *shown;
	if (technique == before)
		maker->refused_technique = 0;
	if (technique == before || technique == maker->refused_technique)
		return GZ_OK;
	maker->refused_technique = 0;
	*shown = technique;
	if (show_by_technique(maker) == GZ_OK)
		return GZ_OK;
	maker->refused_technique = technique;
	*shown = before;
	gz_warn(maker->log, "render.technique = %s: refused; %s goes on",
		gz_technique_choices[technique], gz_technique_choices[before]);
	return show_scene_objects(maker);
}

/* Let the settings of an illustration follow the last frame, if they do that. */
static void follow_measures(struct gz_frame_maker *maker, const struct gz_frame_request *request)
{
	const struct gz_ray_params *rays = &request->settings->rays;
	if (!maker->change_given)
		maker->automatic = gz_illustration_automatic_step(
			maker->automatic, &rays->illustration,
			maker->measured ? &maker->measures : NULL, maker->time_ns);
	maker->change_given = false;
	maker->rays = *rays;
	gz_illustration_adapt(&maker->automatic.change, &maker->rays.illustration);
}

/* Note what a frame shows, and whether settings go on by it: frames then follow, even if nothing
 * else moves. No time has passed, so nothing changes yet. Recorded changes are not followed. */
static void take_measures(struct gz_frame_maker *maker, const struct gz_frame_request *request,
			  const struct gz_shading_measures *measures)
{
	maker->measured = measures != NULL;
	if (measures)
		maker->measures = *measures;
	if (measures && maker->automatic.started)
		maker->automatic = gz_illustration_automatic_step(
			maker->automatic, &request->settings->rays.illustration, measures,
			maker->automatic.now_ns);
}

/* A request for the picture of a frame; after follow_measures(). */
static struct gz_picture_request picture_of_frame(const struct gz_frame_maker *maker,
						  const struct gz_frame_request *request)
{
	const struct gz_scene_settings *settings = request->settings;
	return (struct gz_picture_request) {
		.camera = &settings->camera,
		.settings = &maker->rays,
		.foveation = &settings->foveation,
		.display = request->display,
		.focus = maker->focus,
		.width = request->width,
		.height = request->height,
		.image_sampling_rate = settings->image_sampling_rate,
		.temporal = &settings->temporal,
		.on_device = request->on_device,
		.loss_returned = request->loss_is_callers,
	};
}

static enum gz_result make_frame_picture(struct gz_frame_maker *maker,
					 const struct gz_frame_request *request,
					 struct gz_image **out_image,
					 struct gz_frame_record *record)
{
	follow_measures(maker, request);
	const struct gz_picture_request picture = picture_of_frame(maker, request);
	struct gz_picture_cost cost;
	enum gz_result r = follow_objects(maker, request->settings);
	if (r == GZ_OK)
		r = follow_technique(maker, request->settings->technique);
	if (r == GZ_OK)
		r = gz_picture_make(maker->pictures, &picture, out_image, &cost);
	if (r != GZ_OK)
		return r;
	take_measures(maker, request, cost.stats.measures);
	record->total_ms = cost.total_ms;
	record->prepare_ms = cost.stats.prepare_within_ms;
	record->plan_ms = cost.plan_ms;
	record->cast_ms = cost.stats.cast_ms;
	record->reconstruct_ms = cost.stats.reconstruct_ms;
	record->rays = cost.stats.rays;
	record->kept_rays = cost.stats.kept_rays;
	record->bricks_coming = cost.stats.bricks_coming;
	record->samples = cost.stats.samples;
	record->kept = cost.kept;
	record->focus.finer = cost.finer;
	return GZ_OK;
}

void gz_frame_tell_unoriented(const struct gz_frame_maker *maker)
{
	if (!maker->scene.volume.oriented)
		gz_warn(maker->log, "no letters: the volume does not store its orientation; use a "
				    "format that does, such as NIfTI or DICOM");
}

/* A budget makes plans coarser, and standard never is. */
static void warn_standard_ignores_budget(struct gz_frame_maker *maker)
{
	if (maker->attention.params.budget_ms <= 0 || maker->standard_told)
		return;
	maker->standard_told = true;
	gz_warn(maker->log,
		"attention.budget_ms %g: standard casts all rays and ignores the budget; "
		"choose a "
		"method that can keep it, such as acuity",
		maker->attention.params.budget_ms);
}

static const char *budget_state(const struct gz_frame_maker *maker,
				const struct gz_frame_record *record)
{
	const struct gz_budget *budget = &maker->attention.budget;
	if (record->budget_ms > 0 && !gz_methods[maker->spent.method].can_be_coarser)
		return gz_budget_state_name(
			record->total_ms > record->budget_ms ? GZ_BUDGET_OVER : GZ_BUDGET_WITHIN);
	return gz_budget_state_name(budget->state);
}

/* A frame gives no reason for a finer plan if more than 1/MUCH_KEPT of its rays were kept. Chosen:
 * the others, cast as a whole, would take up to a third longer. */
enum { MUCH_KEPT = 4 };

/* The budget covers rays and pixels only, not what later frames reuse, and not what is
 * drawn or written afterwards. Times of another method or size do not count. */
static void tell_spent(struct gz_frame_maker *maker, const struct gz_frame_request *request,
		       const struct gz_frame_record *record)
{
	const double spent_ms = record->total_ms - record->prepare_ms;
	const bool much_kept = record->kept_rays > record->rays / MUCH_KEPT;
	int method = request->settings->foveation.method;
	const struct gz_plan *plan = gz_picture_maker_plan(maker->pictures);
	bool same = maker->spent.method == method && maker->spent.width == plan->width &&
		    maker->spent.height == plan->height;
	if (!same)
		gz_attention_forget_spent(&maker->attention);
	maker->spent.method = method;
	maker->spent.width = plan->width;
	maker->spent.height = plan->height;
	if (!gz_methods[method].can_be_coarser) {
		warn_standard_ignores_budget(maker);
		return;
	}
	/* One whose plan has grown gives no reason for a coarser one: what moves makes it fall
	 * back. */
	if (record->focus.finer > 1)
		return;
	if (gz_attention_spent(&maker->attention, spent_ms, much_kept))
		gz_warn(maker->log,
			"attention.budget_ms %g cannot be kept: %s took %.1f ms with its "
			"coarsest "
			"plan; raise it, lower the size or render.ray_sampling_rate, or "
			"try "
			"another method",
			maker->attention.params.budget_ms, gz_method_names[method], spent_ms);
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
	enum gz_result r = make_frame_picture(maker, request, out_image, &record);
	if (r != GZ_OK)
		return r;
	maker->made = maker->focus;
	maker->any_made = maker->any_shown = true;
	maker->last.camera = request->settings->camera;
	maker->last.rays = maker->rays;
	maker->last.width = request->width;
	maker->last.height = request->height;
	tell_spent(maker, request, &record);
	record.budget = budget_state(maker, &record);
	record.backend = gz_frame_backend(maker); /* cpu may have taken over */
	*out_record = record;
	return GZ_OK;
}

enum gz_result gz_frame_preview(struct gz_frame_maker *maker,
				const struct gz_scene_settings *settings, int width, int height,
				struct gz_image *image)
{
	const struct gz_foveation full = gz_foveation_full();
	const struct gz_display display = gz_display_default(width, height);
	const struct gz_picture_request request = {
		.camera = &settings->camera,
		.settings = &settings->rays,
		.foveation = &full,
		.display = &display,
		.focus = gz_focus_at((struct gz_point) { 0.5F, 0.5F }),
		.width = width,
		.height = height,
		.loss_returned = true,
		.plan = &maker->preview,
		.image = image,
	};
	struct gz_image *made;
	return maker->pictures ? gz_picture_make(maker->pictures, &request, &made, NULL)
			       : GZ_ERR_INVAL;
}

uint32_t gz_frame_object_at(struct gz_frame_maker *maker, const struct gz_scene_settings *settings,
			    int width, int height, struct gz_point point)
{
	const int size_px[2] = { width, height };
	struct gz_pick_request request;
	struct gz_pick pick;
	if (!request_pick(maker, &settings->camera, &settings->rays, size_px, point, &request) ||
	    gz_picture_maker_pick(maker->pictures, &request, &pick) != GZ_OK)
		return 0;
	return gz_pick_most_seen(&pick);
}

const struct gz_transfer *gz_frame_transfer(const struct gz_frame_maker *maker)
{
	return raises_values(&maker->raised_shown) ? &maker->raised_transfer
						   : &maker->scene.transfer;
}

enum gz_result gz_frame_print(struct gz_frame_maker *maker, const struct gz_frame_request *request,
			      const struct gz_print *print)
{
	maker->rays = request->settings->rays;
	gz_illustration_adapt(&maker->automatic.change, &maker->rays.illustration);
	const struct gz_picture_request picture = picture_of_frame(maker, request);
	enum gz_result r = follow_objects(maker, request->settings);
	if (r == GZ_OK)
		r = follow_technique(maker, request->settings->technique);
	return r == GZ_OK ? gz_picture_print(maker->pictures, &picture, print) : r;
}

unsigned gz_frame_texture(const struct gz_frame_maker *maker)
{
	return gz_picture_maker_texture(maker->pictures);
}

const struct gz_plan *gz_frame_plan(const struct gz_frame_maker *maker)
{
	return gz_picture_maker_plan(maker->pictures);
}

static void fill_rectangle(struct gz_image *image, int left, int top, int right, int bottom)
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
	fill_rectangle(image, column - CROSS_ARM_PX, row - CROSS_HALF_PX, column + CROSS_ARM_PX,
		       row + CROSS_HALF_PX);
	fill_rectangle(image, column - CROSS_HALF_PX, row - CROSS_ARM_PX, column + CROSS_HALF_PX,
		       row + CROSS_ARM_PX);
}

void gz_frame_maker_destroy(struct gz_frame_maker **maker)
{
	if (!maker || !*maker)
		return;
	gz_frame_drop_labels(*maker);
	gz_frame_maker_stop(*maker);
	gz_plan_free(&(*maker)->preview);
	free_time_points((*maker)->time_points);
	gz_scene_free(&(*maker)->scene);
	free(*maker);
	*maker = NULL;
}
