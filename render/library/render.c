#include "render/library/render.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "protocol/display.h"
#include "render/data/slice_import.h"
#include "render/frame/picture_maker.h"
#include "render/scene/scene_open.h"
#include "render/scene/techniques.h"

#define GZ_LOG_MODULE "renderer"

/* Chosen: more than processors of one machine that share a picture. */
enum { THREADS_MAX = 256 };

/* Costs by number. */
enum cost {
	COST_TOTAL,
	COST_PLAN,
	COST_PREPARE,
	COST_CAST,
	COST_RECONSTRUCT,
	COST_RAYS,
	COST_SAMPLES,
	COST_KEPT_RAYS,
	COST_COUNT,
};

static const char *const cost_names[COST_COUNT] = {
	[COST_TOTAL] = "total_ms",     [COST_PLAN] = "plan_ms",
	[COST_PREPARE] = "prepare_ms", [COST_CAST] = "cast_ms",
	[COST_RAYS] = "rays",          [COST_RECONSTRUCT] = "reconstruct_ms",
	[COST_SAMPLES] = "samples",    [COST_KEPT_RAYS] = "kept_rays",
};

/* What calls have logged since the last one began: errors if there are any, else the last warning.
 */
struct message {
	pthread_mutex_t mutex;
	enum gz_log_level level;
	char text[2048];
};

struct gz_renderer {
	struct message message;
	struct gz_log log;
	char backend[8];
	int threads;
	struct gz_scene scene;   /* its settings are valid from the start */
	bool has_data;           /* the scene has something to show */
	bool from_memory;        /* voxels of the caller */
	bool transfer_is_set;    /* by gz_renderer_set_transfer() */
	bool camera_is_placed;   /* by a key or a file */
	bool is_shown;           /* the maker has the present objects */
	char path[GZ_PATH_SIZE]; /* beside which files are searched */
	uint64_t transfer_revision;
	struct gz_picture_maker *maker;
	double costs[COST_COUNT];
	char description[256];
};

static void keep_message(void *user, enum gz_log_level level, const char *module, const char *text)
{
	struct message *message = user;
	(void)module;
	pthread_mutex_lock(&message->mutex);
	const size_t length = message->level == GZ_LOG_ERROR ? strlen(message->text) : 0;
	if (level == GZ_LOG_ERROR && length > 0)
		snprintf(message->text + length, sizeof message->text - length, "\n%s", text);
	else if (level == GZ_LOG_ERROR || message->level != GZ_LOG_ERROR)
		snprintf(message->text, sizeof message->text, "%s", text);
	if (level > message->level)
		message->level = level;
	pthread_mutex_unlock(&message->mutex);
}

static void forget_message(struct gz_renderer *renderer)
{
	renderer->message.level = GZ_LOG_DEBUG;
	renderer->message.text[0] = '\0';
}

static bool is_backend(const char *name)
{
	return strcmp(name, "auto") == 0 || strcmp(name, "cpu") == 0 || strcmp(name, "gl") == 0;
}

enum gz_result gz_renderer_open(const char *backend, int threads, struct gz_renderer **out_renderer)
{
	const char *name = backend ? backend : "auto";
	if (!is_backend(name) || threads < 0 || threads > THREADS_MAX)
		return GZ_ERR_INVAL;
	struct gz_renderer *renderer = calloc(1, sizeof *renderer);
	if (!renderer)
		return GZ_ERR_NO_MEM;
	pthread_mutex_init(&renderer->message.mutex, NULL);
	gz_log_init(&renderer->log, keep_message, &renderer->message, "*:warn");
	snprintf(renderer->backend, sizeof renderer->backend, "%s", name);
	renderer->threads = threads;
	for (int i = 0; i < COST_COUNT; i++)
		renderer->costs[i] = NAN;
	const enum gz_result result = gz_scene_settings_preset(&renderer->scene.settings);
	if (result != GZ_OK) {
		gz_renderer_close(&renderer);
		return result;
	}
	*out_renderer = renderer;
	return GZ_OK;
}

/* The maker borrows from the scene, so it goes first. */
static void replace_scene(struct gz_renderer *renderer, const struct gz_scene *scene)
{
	gz_picture_maker_destroy(&renderer->maker);
	gz_scene_free(&renderer->scene);
	renderer->scene = *scene;
	renderer->has_data = true;
	renderer->is_shown = false;
}

enum gz_result gz_renderer_load(struct gz_renderer *renderer, const char *path)
{
	const struct gz_scene_request request = { .path = path };
	struct gz_scene scene;
	forget_message(renderer);
	if (strlen(path) >= sizeof renderer->path) {
		gz_err(&renderer->log, "the path is longer than %zu bytes; move the file",
		       sizeof renderer->path - 1);
		return GZ_ERR_INVAL;
	}
	const enum gz_result result = gz_scene_open(&request, &renderer->log, &scene);
	if (result != GZ_OK)
		return result;
	replace_scene(renderer, &scene);
	memcpy(renderer->path, path, strlen(path) + 1);
	renderer->from_memory = false;
	renderer->transfer_is_set = false;
	renderer->camera_is_placed = true;
	return GZ_OK;
}

/* The caller's voxels as slices of a file. */
struct voxels {
	const unsigned char *bytes;
	size_t slice_size;
};

static enum gz_result read_voxels(void *user, uint64_t index, void *numbers)
{
	const struct voxels *voxels = user;
	memcpy(numbers, voxels->bytes + index * voxels->slice_size, voxels->slice_size);
	return GZ_OK;
}

static bool find_raw_type(const char *name, enum gz_raw_type *out_type)
{
	for (int i = 0; i < GZ_RAW_TYPE_COUNT; i++) {
		if (strcmp(gz_raw_type_names[i], name) == 0) {
			*out_type = (enum gz_raw_type)i;
			return true;
		}
	}
	return false;
}

/* @param[out] out_slice_size  bytes of a slice */
static enum gz_result check_voxels(const struct gz_renderer *renderer,
				   const struct gz_import_layout *layout, size_t size,
				   size_t *out_slice_size)
{
	for (int i = 0; i < 3; i++) {
		if (layout->dims[i] < 1 || layout->dims[i] > GZ_VOLUME_DIM_MAX) {
			gz_err(&renderer->log, "%d voxels along axis %d; 1 to %d are possible",
			       layout->dims[i], i, GZ_VOLUME_DIM_MAX);
			return GZ_ERR_INVAL;
		}
	}
	*out_slice_size =
		(size_t)layout->dims[0] * (size_t)layout->dims[1] * gz_import_voxel_size(layout);
	if (size == *out_slice_size * (size_t)layout->dims[2])
		return GZ_OK;
	gz_err(&renderer->log, "%zu bytes of voxels, but dims and type make %zu", size,
	       *out_slice_size * (size_t)layout->dims[2]);
	return GZ_ERR_INVAL;
}

/* Take over a volume: settings stay, and what else the scene had goes. */
static enum gz_result show_volume(struct gz_renderer *renderer, struct gz_volume *volume)
{
	struct gz_scene scene = { .settings = renderer->scene.settings, .volume = *volume };
	enum gz_result result = GZ_OK;
	if (renderer->transfer_is_set)
		scene.transfer = renderer->scene.transfer;
	else
		result = gz_transfer_of_volume(volume, scene.settings.transfer_preset,
					       &renderer->log, &scene.transfer);
	if (result != GZ_OK) {
		gz_volume_free(volume);
		return result;
	}
	/* Objects of a file and their data are gone. */
	scene.settings.objects = (struct gz_scene_objects) { 0 };
	scene.settings.volume_file[0] = scene.settings.transfer_file[0] = '\0';
	scene.settings.volume_procedural = 0;
	if (!renderer->camera_is_placed)
		gz_camera_fit(&scene.settings.camera, volume, NULL);
	replace_scene(renderer, &scene);
	renderer->from_memory = true;
	return GZ_OK;
}

enum gz_result gz_renderer_set_volume(struct gz_renderer *renderer, const char *type,
				      const int dims[3], const double spacing[3],
				      const void *voxels, size_t size)
{
	struct gz_import_layout layout = gz_import_layout_default();
	const struct gz_volume_file file = { .path = "voxels", .log = &renderer->log };
	struct voxels given = { .bytes = voxels };
	struct gz_volume volume;
	forget_message(renderer);
	if (!find_raw_type(type, &layout.type)) {
		gz_err(&renderer->log, "voxels cannot be of type %s; uint8 to float64 are read",
		       type);
		return GZ_ERR_INVAL;
	}
	layout.big_endian = gz_host_big_endian();
	memcpy(layout.dims, dims, sizeof layout.dims);
	if (spacing)
		memcpy(layout.spacing, spacing, sizeof layout.spacing);
	enum gz_result result = check_voxels(renderer, &layout, size, &given.slice_size);
	const struct gz_slice_source source = { read_voxels, &given, size };
	if (result == GZ_OK)
		result = gz_volume_import_slices(&source, &layout, &file, &volume);
	return result == GZ_OK ? show_volume(renderer, &volume) : result;
}

enum gz_result gz_renderer_set_transfer(struct gz_renderer *renderer, const char *text)
{
	struct gz_transfer transfer = { 0 };
	enum gz_result result = GZ_OK;
	forget_message(renderer);
	if (text)
		result = gz_transfer_parse("transfer function", text, strlen(text), &renderer->log,
					   &transfer);
	else if (renderer->has_data)
		result = gz_transfer_of_volume(&renderer->scene.volume,
					       renderer->scene.settings.transfer_preset,
					       &renderer->log, &transfer);
	if (result != GZ_OK)
		return result;
	renderer->transfer_is_set = text != NULL;
	renderer->scene.transfer = transfer;
	renderer->transfer_revision++;
	renderer->is_shown = false;
	return GZ_OK;
}

/* The tables of a scene whose keys do not decide what is loaded. */
static const enum gz_scene_table key_tables[] = {
	GZ_SCENE_CAMERA, GZ_SCENE_IMAGE,     GZ_SCENE_DISPLAY,     GZ_SCENE_RAYS,
	GZ_SCENE_LIGHT,  GZ_SCENE_CLIP,      GZ_SCENE_ENVIRONMENT, GZ_SCENE_ISOSURFACE,
	GZ_SCENE_SLICES, GZ_SCENE_FOVEATION,
};

enum { KEY_TABLES = sizeof key_tables / sizeof key_tables[0] };

/* Find a key. @param[out] out_target  the struct that its option refers to */
static const struct gz_option *find_key(struct gz_renderer *renderer, const char *key,
					void **out_target)
{
	struct gz_option_binding all[GZ_SCENE_TABLE_COUNT], some[KEY_TABLES];
	size_t which = 0;
	gz_scene_bind(&renderer->scene.settings, all);
	for (size_t i = 0; i < KEY_TABLES; i++)
		some[i] = all[key_tables[i]];
	const struct gz_option *option = gz_options_find(some, KEY_TABLES, key, &which);
	if (option) {
		*out_target = some[which].target;
		return option;
	}
	const char *nearest = gz_options_nearest(some, KEY_TABLES, key);
	gz_err(&renderer->log, "no key %s%s%s", key, nearest ? "; did you mean " : "",
	       nearest ? nearest : "");
	return NULL;
}

enum gz_result gz_renderer_set(struct gz_renderer *renderer, const char *key, const char *value)
{
	char message[GZ_OPTION_MESSAGE_SIZE];
	void *target;
	forget_message(renderer);
	const struct gz_option *option = find_key(renderer, key, &target);
	if (!option)
		return GZ_ERR_NOT_FOUND;
	const enum gz_result result =
		gz_option_parse(option, value, target, message, sizeof message);
	if (result != GZ_OK) {
		gz_err(&renderer->log, "%s: %s", key, message);
		return result;
	}
	if (strncmp(key, "camera.", strlen("camera.")) == 0)
		renderer->camera_is_placed = true;
	renderer->is_shown = false; /* another technique may draw it */
	return GZ_OK;
}

enum gz_result gz_renderer_get(struct gz_renderer *renderer, const char *key, char *text,
			       size_t size)
{
	void *target;
	forget_message(renderer);
	const struct gz_option *option = find_key(renderer, key, &target);
	return option ? gz_option_format(option, target, text, size) : GZ_ERR_NOT_FOUND;
}

/* What the keys name is there, and they do not contradict each other. */
static enum gz_result check_keys(struct gz_renderer *renderer)
{
	struct gz_scene_settings *settings = &renderer->scene.settings;
	const char *beside = renderer->path[0] ? renderer->path : "./keys";
	enum gz_result result = gz_scene_settings_check(settings, "keys", &renderer->log);
	if (result == GZ_OK)
		result = gz_scene_load_table(beside, &renderer->log, &settings->foveation);
	if (result == GZ_OK)
		result = gz_scene_find_cube(beside, &renderer->log, &settings->rays.environment);
	return result;
}

static enum gz_result open_maker(struct gz_renderer *renderer)
{
	const struct gz_picture_maker_params params = {
		.backend = renderer->backend,
		.backend_params = { .threads = renderer->threads,
				    .wait_for_bricks = true,
				    .gl_hardware_only = strcmp(renderer->backend, "auto") == 0 },
		.cpu_takes_over = true,
	};
	return renderer->maker ? GZ_OK
			       : gz_picture_maker_create(&params, &renderer->log, &renderer->maker);
}

/* The objects to show, in a list that the caller frees. @return their number; 0: no memory */
static size_t list_objects(const struct gz_renderer *renderer, struct gz_object **out_objects)
{
	const struct gz_scene *scene = &renderer->scene;
	const size_t count = renderer->from_memory ? 1 : gz_scene_list_objects(scene, NULL, 0);
	struct gz_object *objects = calloc(count > 0 ? count : 1, sizeof *objects);
	*out_objects = objects;
	if (!objects)
		return 0;
	if (renderer->from_memory)
		objects[0] = (struct gz_object) {
			.technique = gz_scene_technique(&scene->settings, NULL),
			.id = 1,
			.volume = &scene->volume,
			.transfer = &scene->transfer,
		};
	else
		gz_scene_list_objects(scene, objects, count);
	for (size_t i = 0; i < count; i++)
		objects[i].transfer_revision = renderer->transfer_revision;
	return count;
}

static enum gz_result show_objects(struct gz_renderer *renderer)
{
	struct gz_object *objects;
	enum gz_result result = check_keys(renderer);
	if (result == GZ_OK)
		result = open_maker(renderer);
	if (result != GZ_OK)
		return result;
	const size_t count = list_objects(renderer, &objects);
	result = objects ? gz_picture_maker_show(renderer->maker, objects, count) : GZ_ERR_NO_MEM;
	free(objects);
	renderer->is_shown = result == GZ_OK;
	return result;
}

static void note_costs(struct gz_renderer *renderer, const struct gz_picture_cost *cost)
{
	double *costs = renderer->costs;
	costs[COST_TOTAL] = cost->total_ms;
	costs[COST_PLAN] = cost->plan_ms;
	costs[COST_PREPARE] = cost->stats.prepare_ms;
	costs[COST_CAST] = cost->stats.cast_ms;
	costs[COST_RECONSTRUCT] = cost->stats.reconstruct_ms;
	costs[COST_RAYS] = (double)cost->stats.rays;
	costs[COST_KEPT_RAYS] = (double)cost->stats.kept_rays;
	costs[COST_SAMPLES] = (double)cost->stats.samples;
}

/* The picture fills the display, of which the keys may give size and distance. */
static struct gz_display display_of(const struct gz_renderer *renderer, int width, int height)
{
	const struct gz_display *given = &renderer->scene.settings.display;
	struct gz_display display = gz_display_default(width, height);
	if (given->mm[0] > 0 && given->mm[1] > 0)
		memcpy(display.mm, given->mm, sizeof display.mm);
	if (given->distance_mm > 0)
		display.distance_mm = given->distance_mm;
	return display;
}

static enum gz_result check_request(const struct gz_renderer *renderer, int width, int height,
				    const double *gaze, size_t size)
{
	const char *wrong = NULL;
	if (!renderer->has_data)
		wrong = "nothing is shown: load a file or set a volume first";
	else if (width < 1 || height < 1 || width > GZ_IMAGE_SIDE_MAX || height > GZ_IMAGE_SIDE_MAX)
		wrong = "a side of the picture is not 1 to 16384 pixels";
	else if (size != (size_t)width * (size_t)height * 4)
		wrong = "the memory for the picture is not width * height * 4 bytes";
	else if (gaze && (!isfinite((float)gaze[0]) || !isfinite((float)gaze[1])))
		wrong = "the gaze is not finite; without a gaze, pass none";
	if (!wrong)
		return GZ_OK;
	gz_err(&renderer->log, "%s", wrong);
	return GZ_ERR_INVAL;
}

enum gz_result gz_renderer_draw(struct gz_renderer *renderer, int width, int height,
				const double gaze[2], uint8_t *rgba, size_t size)
{
	forget_message(renderer);
	enum gz_result result = check_request(renderer, width, height, gaze, size);
	if (result == GZ_OK && !renderer->is_shown)
		result = show_objects(renderer);
	if (result != GZ_OK)
		return result;
	const struct gz_scene_settings *settings = &renderer->scene.settings;
	const struct gz_display display = display_of(renderer, width, height);
	const struct gz_point centre = { 0.5f, 0.5f };
	const struct gz_temporal_params temporal = { .keep_rays = settings->temporal.keep_rays };
	const struct gz_picture_request request = {
		.camera = &settings->camera,
		.settings = &settings->rays,
		.foveation = &settings->foveation,
		.display = &display,
		.focus = gz_focus_at(gaze ? (struct gz_point) { (float)gaze[0], (float)gaze[1] }
					  : centre),
		.width = width,
		.height = height,
		.image_sampling_rate = settings->image_sampling_rate,
		.temporal = &temporal,
	};
	struct gz_image *image = NULL;
	struct gz_picture_cost cost;
	result = gz_picture_make(renderer->maker, &request, &image, &cost);
	if (result != GZ_OK)
		return result;
	memcpy(rgba, image->pixels, size);
	note_costs(renderer, &cost);
	return GZ_OK;
}

const char *gz_renderer_cost_name(size_t number)
{
	return number < COST_COUNT ? cost_names[number] : NULL;
}

double gz_renderer_cost(const struct gz_renderer *renderer, size_t number)
{
	return number < COST_COUNT ? renderer->costs[number] : NAN;
}

const char *gz_renderer_describe(struct gz_renderer *renderer)
{
	renderer->description[0] = '\0';
	if (renderer->maker && renderer->is_shown)
		snprintf(renderer->description, sizeof renderer->description, "%s: %s",
			 gz_picture_maker_backend(renderer->maker),
			 gz_picture_maker_describe(renderer->maker));
	return renderer->description;
}

const char *gz_renderer_message(const struct gz_renderer *renderer)
{
	return renderer->message.text;
}

void gz_renderer_close(struct gz_renderer **renderer)
{
	if (!renderer || !*renderer)
		return;
	struct gz_renderer *r = *renderer;
	gz_picture_maker_destroy(&r->maker);
	gz_scene_free(&r->scene);
	pthread_mutex_destroy(&r->message.mutex);
	free(r);
	*renderer = NULL;
}
