#include "bench/study/ask.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "base/workers.h"
#include "bench/metrics/temporal.h"
#include "bench/study/hash.h"
#include "bench/study/study.h"
#include "render/plan/method.h"
#include "render/plan/plan.h"

#define GZ_LOG_MODULE "study"

/* A study in the making. */
struct asking {
	const struct gz_study_request *request;
	const struct gz_log *log;
	struct gz_stage *stage;
	struct gz_study *study;
	struct gz_gaze_path path;
};

static enum gz_result out_of_memory(const struct asking *asking)
{
	gz_err(asking->log, "no memory for the lists of a study");
	return GZ_ERR_NO_MEM;
}

/* ---- acuity bound ---- */

/* Places along an edge that the mean is taken over, at most. Chosen: at 1024 px they lie 4 px
 * apart, over which the spacing changes by a few hundredths. */
enum { PLACES = 256 };

/* The share of a picture's pixels that need a ray: the mean of 1 / s^2, where s is the spacing that
 * the eye resolves, gz_acuity_spacing_px() with the default acuity, at least 1 px. */
static double bound_rays(const struct gz_display *display, struct gz_point gaze, int width,
			 int height)
{
	const struct gz_foveation foveation = gz_foveation_default();
	const int columns = width < PLACES ? width : PLACES;
	const int rows = height < PLACES ? height : PLACES;
	double sum = 0;
	for (int y = 0; y < rows; y++)
		for (int x = 0; x < columns; x++) {
			const struct gz_point place = { ((float)x + 0.5F) / (float)columns,
							((float)y + 0.5F) / (float)rows };
			const double spacing = fmax(gz_acuity_spacing_px(&foveation, display, gaze,
									 place, width, height),
						    1);
			sum += 1 / (spacing * spacing);
		}
	return sum / (columns * rows);
}

/* Shared by the threads: one part a value. */
struct job {
	struct gz_study *study;
	size_t scene, size;
	double *values;
};

static void make_value(void *user, size_t point, int worker)
{
	const struct job *job = user;
	const struct gz_study *study = job->study;
	const struct gz_display display = gz_study_display(study, job->scene, job->size);
	(void)worker;
	job->values[point] = bound_rays(&display, study->points[point].gaze,
					study->sizes[job->size][0], study->sizes[job->size][1]);
}

static bool same_geometry(const struct gz_study *study, size_t a, size_t b)
{
	const struct gz_study_scene *x = &study->scenes[a], *y = &study->scenes[b];
	return x->display_known == y->display_known && x->display.mm[0] == y->display.mm[0] &&
	       x->display.mm[1] == y->display.mm[1] &&
	       x->display.distance_mm == y->display.distance_mm;
}

static enum gz_result make_bound_rays(struct gz_study *study, const struct gz_log *log)
{
	const size_t points = study->point_count, per_scene = study->size_count * points;
	struct gz_workers *workers = NULL;
	double *values = calloc(study->scene_count * per_scene, sizeof *values);
	if (!values || gz_workers_create(0, &workers) != GZ_OK) {
		gz_err(log, "no memory for the acuity bound");
		free(values);
		return GZ_ERR_NO_MEM;
	}
	for (size_t scene = 0; scene < study->scene_count; scene++) {
		double *row = values + scene * per_scene;
		if (scene > 0 && same_geometry(study, scene, scene - 1)) {
			memcpy(row, row - per_scene, per_scene * sizeof *row);
			continue;
		}
		for (size_t size = 0; size < study->size_count; size++) {
			struct job job = { study, scene, size, row + size * points };
			gz_workers_run(workers, make_value, &job, points);
		}
	}
	gz_workers_destroy(&workers);
	free(study->bound_rays);
	study->bound_rays = values;
	return GZ_OK;
}

/* ---- lists ---- */

static enum gz_result ask_variant(struct asking *asking, const char *text)
{
	struct gz_study *study = asking->study;
	/* The scene's own settings come later; the request must be valid over any. */
	const struct gz_variant_settings defaults = { gz_foveation_default(),
						      gz_ray_params_default() };
	struct gz_variant_settings settings;
	const enum gz_result result = gz_variant_parse(text, &defaults, asking->log, &settings);
	if (result != GZ_OK)
		return result;
	for (size_t i = 0; i < study->variant_count; i++)
		if (strcmp(study->variants[i].text, text) == 0) {
			if (i == 0) /* is always there */
				return GZ_OK;
			gz_err(asking->log, "%s: given twice among the methods; keep one", text);
			return GZ_ERR_INVAL;
		}
	if (study->variant_count == GZ_STUDY_LIST_MAX) {
		gz_err(asking->log, "%s: more than %d methods; measure them in several studies",
		       text, GZ_STUDY_LIST_MAX);
		return GZ_ERR_INVAL;
	}
	struct gz_study_variant *variant = &study->variants[study->variant_count++];
	snprintf(variant->text, sizeof variant->text, "%s", text);
	snprintf(variant->method, sizeof variant->method, "%s",
		 gz_method_name(&settings.foveation));
	return GZ_OK;
}

static enum gz_result list_variants(struct asking *asking)
{
	struct gz_study *study = asking->study;
	char item[2 * GZ_STUDY_TEXT_SIZE];
	study->variants = calloc(GZ_STUDY_LIST_MAX, sizeof *study->variants);
	if (!study->variants)
		return out_of_memory(asking);
	enum gz_result result = ask_variant(asking, "standard");
	for (const char *list = asking->request->methods;
	     result == GZ_OK && gz_list_next(&list, item, sizeof item);)
		result = ask_variant(asking, item);
	return result;
}

static bool parse_size(const char *text, int out_size[2])
{
	char item[GZ_NAME_SIZE];
	long long sides[2];
	if (snprintf(item, sizeof item, "%s", text) >= (int)sizeof item)
		return false;
	char *height = strchr(item, 'x');
	if (!height)
		return false;
	*height++ = '\0';
	if (!gz_number_parse_whole(item, &sides[0]) || !gz_number_parse_whole(height, &sides[1]))
		return false;
	for (int i = 0; i < 2; i++) {
		if (sides[i] < 1 || sides[i] > GZ_IMAGE_SIDE_MAX)
			return false;
		out_size[i] = (int)sides[i];
	}
	return true;
}

static enum gz_result list_sizes(struct asking *asking)
{
	struct gz_study *study = asking->study;
	char item[GZ_STUDY_TEXT_SIZE];
	study->sizes = calloc(GZ_STUDY_LIST_MAX, sizeof *study->sizes);
	if (!study->sizes)
		return out_of_memory(asking);
	for (const char *list = asking->request->sizes; gz_list_next(&list, item, sizeof item);) {
		int size[2];
		bool good = study->size_count < GZ_STUDY_LIST_MAX && parse_size(item, size);
		for (size_t i = 0; i < study->size_count && good; i++)
			good = memcmp(study->sizes[i], size, sizeof size) != 0;
		if (!good) {
			gz_err(asking->log,
			       "'%s': sizes are WIDTHxHEIGHT of 1 to %d pixels a side, separated "
			       "by "
			       "commas, each once",
			       item, GZ_IMAGE_SIDE_MAX);
			return GZ_ERR_INVAL;
		}
		memcpy(study->sizes[study->size_count++], size, sizeof size);
	}
	return GZ_OK;
}

static enum gz_result list_backends(struct asking *asking)
{
	struct gz_study *study = asking->study;
	char item[GZ_STUDY_TEXT_SIZE];
	study->backends = calloc(GZ_STUDY_LIST_MAX, sizeof *study->backends);
	if (!study->backends)
		return out_of_memory(asking);
	for (const char *list = asking->request->backends;
	     gz_list_next(&list, item, sizeof item);) {
		struct gz_study_backend backend;
		const enum gz_result result = gz_study_backend_parse(item, asking->log, &backend);
		if (result != GZ_OK)
			return result;
		bool good = study->backend_count < GZ_STUDY_LIST_MAX;
		for (size_t i = 0; i < study->backend_count && good; i++)
			good = strcmp(study->backends[i], item) != 0;
		if (!good) {
			gz_err(asking->log,
			       "%s: given twice among the backends, or too many backends", item);
			return GZ_ERR_INVAL;
		}
		snprintf(study->backends[study->backend_count++], GZ_NAME_SIZE, "%.*s",
			 GZ_NAME_SIZE - 1, item);
	}
	return GZ_OK;
}

/* ---- scenes ---- */

/* The display: from the command line, the scene, the recording, or the default. */
static enum gz_result find_display(const struct asking *asking, struct gz_study_scene *scene)
{
	const struct gz_study_request *request = asking->request;
	const struct gz_scene *loaded = &asking->stage->scene;
	const int *size = asking->study->sizes[0];
	struct gz_display display = gz_display_default(size[0], size[1]);
	scene->display_known = loaded->has_display || asking->path.has_display;
	if (loaded->has_display)
		display = loaded->settings.display;
	else if (asking->path.has_display)
		display = asking->path.display;
	if (request->display_mm[0] > 0) {
		memcpy(display.mm, request->display_mm, sizeof display.mm);
		scene->display_known = true;
	}
	if (request->display_distance_mm > 0) {
		display.distance_mm = request->display_distance_mm;
		scene->display_known = true;
	}
	memcpy(display.px, size, sizeof display.px);
	scene->display = display;
	if (!asking->path.has_display || gz_gaze_path_same_display(&display, &asking->path.display))
		return GZ_OK;
	gz_err(asking->log,
	       "%s was recorded on another display, %g x %g mm at %g mm, than %s is shown on, %g x "
	       "%g mm at %g mm: remove the display from the scene and the command line, or use a "
	       "recording of that display",
	       request->path, asking->path.display.mm[0], asking->path.display.mm[1],
	       asking->path.display.distance_mm, scene->name, display.mm[0], display.mm[1],
	       display.distance_mm);
	return GZ_ERR_INVAL;
}

static void hash_table(struct gz_hash *hash, const struct gz_spacing_table *table)
{
	gz_hash_add_number(hash, table->in_deg);
	for (int i = 0; i < table->count; i++) {
		gz_hash_add_number(hash, table->rows[i].eccentricity_deg);
		gz_hash_add_number(hash, table->rows[i].spacing);
		gz_hash_add_number(hash, table->rows[i].step);
	}
}

/* The tables that variants name: what is in them counts, and that they are there is known before
 * anything is measured. */
static enum gz_result hash_variants(const struct asking *asking, struct gz_hash *hash)
{
	const struct gz_study *study = asking->study;
	const struct gz_scene_settings *settings = &asking->stage->scene.settings;
	const struct gz_variant_settings scene = { settings->foveation, settings->rays };
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < study->variant_count && result == GZ_OK; i++) {
		struct gz_variant_settings variant;
		result = gz_variant_parse(study->variants[i].text, &scene, asking->log, &variant);
		if (result != GZ_OK || !gz_method_of(&variant.foveation)->needs_table)
			continue;
		result = gz_scene_load_table(asking->stage->path, asking->log, &variant.foveation);
		if (result == GZ_OK)
			hash_table(hash, &variant.foveation.table);
	}
	return result;
}

/* Of a mesh's places and triangles. */
static void hash_mesh(struct gz_hash *hash, const struct gz_mesh *mesh)
{
	if (mesh->triangle_count == 0)
		return;
	gz_hash_add(hash, mesh->positions, mesh->vertex_count * sizeof mesh->positions[0]);
	gz_hash_add(hash, mesh->triangles, mesh->triangle_count * sizeof mesh->triangles[0]);
}

static void hash_meshes(struct gz_hash *hash, const struct gz_scene *scene)
{
	for (size_t i = 0; i < scene->settings.objects.count; i++) {
		if (!scene->settings.objects.items[i].visible)
			continue;
		if (scene->meshes)
			hash_mesh(hash, &scene->meshes[i]);
		for (size_t k = 0; scene->labels && k < scene->labels[i].count; k++)
			hash_mesh(hash, &scene->labels[i].items[k].mesh);
	}
}

/* The technique of the volume, and others beside it. */
static void hash_techniques(struct gz_hash *hash, const struct gz_scene *scene)
{
	const struct gz_technique *first = gz_scene_main_technique(&scene->settings);
	struct gz_object objects[GZ_SCENE_LISTED_MAX];
	const size_t count =
		gz_scene_list_objects(scene, objects, sizeof objects / sizeof objects[0]);
	gz_hash_add_text(hash, first->name);
	for (size_t i = 0; i < count; i++)
		if (objects[i].technique != first)
			gz_hash_add_text(hash, objects[i].technique->name);
}

/* Of the data and of what the scene says of how they are shown; names of files do not count, what
 * is in them does. The camera stands in the study itself. */
static enum gz_result hash_scene(const struct asking *asking, struct gz_study_scene *scene)
{
	const struct gz_scene_settings *settings = &asking->stage->scene.settings;
	struct gz_foveation foveation = settings->foveation;
	struct gz_hash *hash = NULL;
	enum gz_result result = gz_hash_begin(&hash);
	if (result != GZ_OK)
		return result;
	foveation.table_file[0] = '\0';
	gz_hash_add_text(hash, scene->data_hash);
	hash_techniques(hash, &asking->stage->scene);
	hash_meshes(hash, &asking->stage->scene);
	gz_hash_add_rays(hash, &settings->rays);
	gz_hash_add_options(hash, gz_foveation_options, gz_foveation_option_count, &foveation);
	hash_table(hash, &foveation.table);
	result = hash_variants(asking, hash);
	const enum gz_result ended = gz_hash_end(&hash, result == GZ_OK ? scene->hash : NULL);
	return result == GZ_OK ? ended : result;
}

static enum gz_result check_name(const struct asking *asking, const struct gz_study_scene *scene)
{
	const struct gz_study *study = asking->study;
	for (size_t i = 0; i < study->scene_count; i++)
		if (strcmp(study->scenes[i].name, scene->name) == 0 &&
		    strcmp(study->scenes[i].transfer, scene->transfer) == 0) {
			gz_err(asking->log,
			       "%s: a scene %s with a transfer function %s is in the study "
			       "already; give the files different names",
			       scene->path, scene->name, scene->transfer);
			return GZ_ERR_INVAL;
		}
	for (const char *at = scene->path; *at; at++)
		if (iscntrl((unsigned char)*at)) {
			gz_err(asking->log,
			       "%s: names with control characters are not allowed; rename it",
			       scene->path);
			return GZ_ERR_INVAL;
		}
	return GZ_OK;
}

static enum gz_result ask_scene(struct asking *asking, const char *path, size_t transfer)
{
	struct gz_study *study = asking->study;
	struct gz_transfer function;
	if (study->scene_count == GZ_STUDY_SCENES_MAX) {
		gz_err(asking->log, "%s: more than %d scenes; measure them in several studies",
		       path, GZ_STUDY_SCENES_MAX);
		return GZ_ERR_INVAL;
	}
	struct gz_study_scene *scene = &study->scenes[study->scene_count];
	const struct gz_scene *loaded = &asking->stage->scene;
	snprintf(scene->path, sizeof scene->path, "%s", path);
	gz_study_file_name(path, ".scene", scene->name);
	memcpy(scene->dims, loaded->volume.dims, sizeof scene->dims);
	scene->camera = loaded->settings.camera;
	enum gz_result result =
		gz_stage_transfer(asking->stage, transfer, scene->transfer, &function);
	if (result == GZ_OK)
		result = check_name(asking, scene);
	if (result == GZ_OK)
		result = gz_stage_data_hash(asking->stage, &function, scene->data_hash);
	if (result == GZ_OK)
		result = hash_scene(asking, scene);
	if (result == GZ_OK)
		result = find_display(asking, scene);
	study->scene_count += result == GZ_OK;
	return result;
}

/* The camera path as each scene sees it: what its lines do not name is the scene's. */
static enum gz_result read_camera_paths(struct asking *asking)
{
	struct gz_study *study = asking->study;
	const char *file = asking->request->camera_path;
	struct gz_hash *hash = NULL;
	if (!file)
		return GZ_OK;
	if (strlen(file) >= sizeof study->camera_path) {
		gz_err(asking->log, "%.40s…: a name this long cannot be opened", file);
		return GZ_ERR_INVAL;
	}
	study->camera_paths = calloc(study->scene_count, sizeof *study->camera_paths);
	if (!study->camera_paths)
		return out_of_memory(asking);
	enum gz_result result = gz_hash_begin(&hash);
	if (result != GZ_OK)
		return result;
	for (size_t i = 0; i < study->scene_count && result == GZ_OK; i++) {
		result = gz_camera_path_read(file, &study->scenes[i].camera, asking->log,
					     &study->camera_paths[i]);
		gz_camera_path_hash(&study->camera_paths[i], hash);
	}
	if (result == GZ_OK && study->camera_paths[0].count < GZ_TEMPORAL_FRAMES) {
		gz_err(asking->log, "%s: has %zu cameras; the camera path error needs %d or more",
		       file, study->camera_paths[0].count, GZ_TEMPORAL_FRAMES);
		result = GZ_ERR_INVAL;
	}
	snprintf(study->camera_path, sizeof study->camera_path, "%s", file);
	const enum gz_result ended =
		gz_hash_end(&hash, result == GZ_OK ? study->camera_path_hash : NULL);
	return result == GZ_OK ? ended : result;
}

static enum gz_result list_scenes(struct asking *asking)
{
	const struct gz_study_request *request = asking->request;
	struct gz_study *study = asking->study;
	enum gz_result result = GZ_OK;
	study->scenes = calloc(GZ_STUDY_SCENES_MAX, sizeof *study->scenes);
	if (!study->scenes)
		return out_of_memory(asking);
	for (size_t i = 0; i < request->scene_count && result == GZ_OK; i++) {
		const char *path = request->scenes[i];
		if (strlen(path) >= GZ_PATH_SIZE) {
			gz_err(asking->log, "%.40s…: a name this long cannot be opened", path);
			return GZ_ERR_INVAL;
		}
		result = gz_stage_load(asking->stage, path);
		const size_t transfers =
			result == GZ_OK ? gz_stage_transfer_count(asking->stage) : 0;
		for (size_t k = 0; k < transfers && result == GZ_OK; k++)
			result = ask_scene(asking, path, k);
	}
	return result;
}

/* ---- the path ---- */

static enum gz_result make_path(struct asking *asking)
{
	const struct gz_study_request *request = asking->request;
	struct gz_study *study = asking->study;
	const struct gz_gaze_path_settings settings = {
		.text = request->path,
		.seed = request->seed,
		.cameras = request->cameras,
		.min_move_px = request->min_move_px,
		.size = { study->sizes[0][0], study->sizes[0][1] },
		.per_cell = request->per_cell,
	};
	struct gz_hash *hash = NULL;
	if (strlen(request->path) >= sizeof study->path) {
		gz_err(asking->log, "%.40s…: a name this long cannot be opened", request->path);
		return GZ_ERR_INVAL;
	}
	enum gz_result result = gz_gaze_path_make(&settings, asking->log, &asking->path);
	if (result == GZ_OK)
		result = gz_hash_begin(&hash);
	if (result != GZ_OK)
		return result;
	for (size_t i = 0; i < asking->path.count; i++) {
		gz_hash_add_number(hash, (double)asking->path.points[i].gaze.x);
		gz_hash_add_number(hash, (double)asking->path.points[i].gaze.y);
		gz_hash_add_number(hash, asking->path.points[i].camera);
	}
	snprintf(study->path, sizeof study->path, "%s", request->path);
	study->points = asking->path.points;
	study->point_count = asking->path.count;
	asking->path.points = NULL;
	return gz_hash_end(&hash, study->path_hash);
}

static void take_size_list(const struct gz_study_request *request, struct gz_study *study)
{
	study->seed = request->seed;
	study->camera_count = request->cameras;
	study->min_move_px = request->min_move_px;
	study->per_cell = request->per_cell;
	study->frames_per_point = request->frames;
	study->warm_up_frames = request->warm_up;
	study->shard = request->shard;
	study->shard_count = request->shard_count;
	study->accuracy = request->accuracy;
	gz_study_machine_describe(&study->machine);
	snprintf(study->machine.program, GZ_STUDY_TEXT_SIZE, "%s", request->program);
	snprintf(study->machine.commit, GZ_STUDY_TEXT_SIZE, "%s", request->commit);
}

/* Only errors are measured along a camera path. */
static enum gz_result check_camera_path(const struct asking *asking)
{
	const struct gz_study_request *request = asking->request;
	if (!request->camera_path || request->accuracy != GZ_STUDY_ACCURACY_NONE)
		return GZ_OK;
	gz_err(asking->log, "%s: a camera path measures an error, but --errors none measures none",
	       request->camera_path);
	return GZ_ERR_INVAL;
}

static enum gz_result list_all(struct asking *asking)
{
	enum gz_result result = check_camera_path(asking);
	if (result == GZ_OK)
		result = list_variants(asking);
	if (result == GZ_OK)
		result = list_sizes(asking);
	return result == GZ_OK ? list_backends(asking) : result;
}

enum gz_result gz_study_check(const struct gz_study_request *request, const struct gz_log *log)
{
	struct gz_study study = { 0 };
	struct asking asking = { .request = request, .log = log, .study = &study };
	enum gz_result result = list_all(&asking);
	if (result == GZ_OK)
		result = gz_gaze_path_check(request->path, log);
	gz_study_free(&study);
	return result;
}

enum gz_result gz_study_ask(const struct gz_study_request *request, struct gz_stage *stage,
			    const struct gz_log *log, struct gz_study *out_study)
{
	struct gz_study *study = calloc(1, sizeof *study);
	if (!study)
		return GZ_ERR_NO_MEM;
	struct asking asking = { .request = request, .log = log, .stage = stage, .study = study };
	take_size_list(request, study);
	enum gz_result result = list_all(&asking);
	if (result == GZ_OK)
		result = make_path(&asking);
	if (result == GZ_OK)
		result = list_scenes(&asking);
	if (result == GZ_OK)
		result = read_camera_paths(&asking);
	if (result == GZ_OK)
		result = make_bound_rays(study, log);
	for (size_t i = 0; i < study->size_count && result == GZ_OK; i++)
		study->machine.copy_ms[i] =
			gz_study_copy_ms(study->sizes[i][0], study->sizes[i][1]);
	if (result == GZ_OK)
		*out_study = *study;
	else
		gz_study_free(study);
	gz_gaze_path_free(&asking.path);
	free(study);
	return result;
}
