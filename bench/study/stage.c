#include "bench/study/stage.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/command.h"
#include "base/text.h"
#include "bench/study/hash.h"
#include "bench/study/study.h"
#include "render/data/brick_pool.h"
#include "render/plan/method.h"
#include "render/scene/techniques.h"

#define GZ_LOG_MODULE "study"

/* ---- backends ---- */

static bool is_backend(const char *name)
{
	for (const char *const *known = gz_techniques[0]->backends; *known; known++)
		if (strcmp(*known, name) == 0)
			return true;
	return false;
}

static bool set_backend_option(struct gz_study_backend *backend, const char *option)
{
	long long threads;
	if (strncmp(option, "threads=", 8) == 0 && gz_number_parse_whole(option + 8, &threads) &&
	    threads >= 1 && threads <= GZ_WORKERS_MAX) {
		backend->threads = (int)threads;
		return true;
	}
	if (strncmp(option, "simd=", 5) != 0)
		return false;
	snprintf(backend->simd, sizeof backend->simd, "%.*s", GZ_NAME_SIZE - 1, option + 5);
	return true;
}

enum gz_result gz_study_backend_parse(const char *text, const struct gz_log *log,
				      struct gz_study_backend *out_backend)
{
	struct gz_study_backend backend = { .simd = "auto" };
	char copy[GZ_NAME_SIZE];
	bool good = snprintf(copy, sizeof copy, "%s", text) < (int)sizeof copy;
	char *rest = copy;
	snprintf(backend.name, sizeof backend.name, "%s", strsep(&rest, ":"));
	good = good && is_backend(backend.name) && (!rest || strcmp(backend.name, "cpu") == 0);
	for (char *option = strsep(&rest, ":"); option && good; option = strsep(&rest, ":"))
		good = set_backend_option(&backend, option);
	if (!good) {
		gz_err(log,
		       "'%s': no such backend or option: cpu, gl, or cpu with its options, "
		       "threads=1 "
		       "to threads=%d and simd=, as cpu:threads=2:simd=avx2",
		       text, GZ_WORKERS_MAX);
		return GZ_ERR_INVAL;
	}
	*out_backend = backend;
	return GZ_OK;
}

/* ---- the scene ---- */

static void drop_scene(struct gz_stage *stage)
{
	gz_picture_maker_destroy(&stage->cpu);
	for (size_t i = 0; i < GZ_STUDY_LIST_MAX; i++)
		gz_picture_maker_destroy(&stage->backends[i]);
	free(stage->variants);
	stage->variants = NULL;
	if (stage->path[0])
		gz_scene_free(&stage->scene);
	stage->path[0] = '\0';
	stage->entered = 0;
}

void gz_stage_free(struct gz_stage *stage)
{
	drop_scene(stage);
	*stage = (struct gz_stage) { 0 };
}

static void hash_voxels(struct gz_hash *hash, const struct gz_volume *volume)
{
	if (!volume->bricks) {
		gz_hash_add(hash, volume->voxels,
			    gz_volume_voxel_count(volume) * gz_voxel_size(volume->type));
		if (volume->colours)
			gz_hash_add(hash, volume->colours,
				    gz_volume_voxel_count(volume) * sizeof *volume->colours);
		return;
	}
	/* The index holds a checksum of every brick. */
	const struct gz_brick_file *file = gz_brick_pool_file(volume->bricks);
	for (size_t i = 0; i < file->layout.brick_count; i++) {
		gz_hash_add_number(hash, file->entries[i].crc);
		gz_hash_add_number(hash, (double)file->entries[i].least);
		gz_hash_add_number(hash, (double)file->entries[i].greatest);
	}
}

static enum gz_result hash_volume(const struct gz_volume *volume, char out_hex[GZ_STUDY_HASH_SIZE])
{
	struct gz_hash *hash = NULL;
	const enum gz_result result = gz_hash_begin(&hash);
	if (result != GZ_OK)
		return result;
	for (int axis = 0; axis < 3; axis++) {
		gz_hash_add_number(hash, volume->dims[axis]);
		gz_hash_add_number(hash, volume->spacing[axis]);
	}
	gz_hash_add_number(hash, volume->type);
	gz_hash_add_number(hash, volume->slope);
	gz_hash_add_number(hash, volume->intercept);
	gz_hash_add_number(hash, volume->stored_min);
	gz_hash_add_number(hash, volume->stored_max);
	hash_voxels(hash, volume);
	return gz_hash_end(&hash, out_hex);
}

enum gz_result gz_stage_data_hash(const struct gz_stage *stage, const struct gz_transfer *transfer,
				  char out_hex[GZ_STUDY_HASH_SIZE])
{
	struct gz_hash *hash = NULL;
	const enum gz_result result = gz_hash_begin(&hash);
	if (result != GZ_OK)
		return result;
	gz_hash_add_text(hash, stage->volume_hash);
	for (size_t i = 0; i < transfer->count; i++) {
		const struct gz_transfer_point *point = &transfer->points[i];
		gz_hash_add_number(hash, point->value);
		for (int channel = 0; channel < 3; channel++)
			gz_hash_add_number(hash, point->rgb[channel]);
		gz_hash_add_number(hash, point->opacity);
	}
	gz_hash_add_number(hash, transfer->interpolation);
	gz_hash_add_number(hash, transfer->has_range);
	for (int end = 0; end < 2 && transfer->has_range; end++)
		gz_hash_add_number(hash, transfer->range[end]);
	return gz_hash_end(&hash, out_hex);
}

static bool goes_on(void *user, double share, const char *what)
{
	(void)user;
	(void)share;
	(void)what;
	return !gz_command_interrupted();
}

enum gz_result gz_stage_load(struct gz_stage *stage, const char *path)
{
	const struct gz_loading loading = { .report = goes_on };
	if (strcmp(stage->path, path) == 0)
		return GZ_OK;
	drop_scene(stage);
	enum gz_result result = gz_scene_load(path, &loading, stage->log, &stage->scene);
	if (result != GZ_OK)
		return result;
	snprintf(stage->path, sizeof stage->path, "%s", path);
	result = hash_volume(&stage->scene.volume, stage->volume_hash);
	if (result == GZ_OK && stage->scene.settings.image_sampling_rate != 1) {
		gz_err(stage->log,
		       "%s: render.image_sampling_rate: must be 1 for measuring; use a scene "
		       "without it, and --size for other sizes",
		       path);
		result = GZ_ERR_INVAL;
	}
	if (result != GZ_OK)
		drop_scene(stage);
	return result;
}

/* ---- its transfer functions ---- */

#define BLANKS " \t"

/* The n-th of the names in transfer.also. */
static bool find_name(const char *names, size_t n, char out_name[GZ_PATH_SIZE])
{
	for (;; n--) {
		names += strspn(names, BLANKS);
		const size_t length = strcspn(names, BLANKS);
		if (length == 0)
			return false;
		if (n == 0) {
			snprintf(out_name, GZ_PATH_SIZE, "%.*s", (int)length, names);
			return true;
		}
		names += length;
	}
}

size_t gz_stage_transfer_count(const struct gz_stage *stage)
{
	char name[GZ_PATH_SIZE];
	size_t count = 0;
	while (find_name(stage->scene.settings.transfer_also, count, name))
		count++;
	return 1 + count;
}

enum gz_result gz_stage_transfer(const struct gz_stage *stage, size_t which,
				 char out_name[GZ_STUDY_TEXT_SIZE],
				 struct gz_transfer *out_transfer)
{
	const char *name = gz_scene_transfer_name(&stage->scene.settings);
	char file[GZ_PATH_SIZE];
	if (which == 0)
		snprintf(file, sizeof file, "%s", name[0] ? name : "made-for-the-volume.tf");
	else if (!find_name(stage->scene.settings.transfer_also, which - 1, file))
		return GZ_ERR_INVAL;
	gz_study_file_name(file, ".tf", out_name);
	if (which > 0)
		return gz_scene_load_transfer(stage->path, file, stage->log, out_transfer);
	*out_transfer = stage->scene.transfer;
	return GZ_OK;
}

/* ---- entering ---- */

/* Show the scene by the stage's transfer function on a backend, opened when first asked for. The
 * maker borrows the texts of @p backend. */
static enum gz_result show_scene(struct gz_stage *stage, const struct gz_study_backend *backend,
				 struct gz_picture_maker **maker)
{
	struct gz_object objects[GZ_SCENE_LISTED_MAX];
	const struct gz_picture_maker_params params = {
		.backend = backend->name,
		.backend_params = { .threads = backend->threads,
				    .simd = backend->simd,
				    .wait_for_bricks = true },
	};
	enum gz_result result = GZ_OK;
	if (!*maker)
		result = gz_picture_maker_create(&params, stage->log, maker);
	const size_t count =
		gz_scene_list_objects(&stage->scene, objects, sizeof objects / sizeof objects[0]);
	for (size_t i = 0; i < count; i++) {
		objects[i].transfer = &stage->transfer;
		objects[i].transfer_revision = stage->transfer_revision;
	}
	if (result == GZ_OK)
		result = gz_picture_maker_show(*maker, objects, count);
	if (result != GZ_OK)
		gz_err(stage->log, "%s: %s cannot show the scene: %s", stage->path, backend->name,
		       gz_result_text(result));
	return result;
}

enum gz_result gz_stage_open_maker(struct gz_stage *stage, size_t backend,
				   struct gz_picture_maker **out_maker)
{
	*out_maker = NULL;
	const enum gz_result result = show_scene(stage, &stage->backend_params[backend], out_maker);
	if (result != GZ_OK)
		gz_picture_maker_destroy(out_maker);
	return result;
}

static enum gz_result show_on_backends(struct gz_stage *stage, const struct gz_study *study,
				       char (*out_descriptions)[GZ_STUDY_TEXT_SIZE])
{
	static const struct gz_study_backend cpu = { .name = "cpu", .simd = "auto" };
	enum gz_result result = GZ_OK;
	if (study->accuracy == GZ_STUDY_ACCURACY_ALL)
		result = show_scene(stage, &cpu, &stage->cpu);
	for (size_t i = 0; i < study->backend_count && result == GZ_OK; i++) {
		struct gz_study_backend *backend = &stage->backend_params[i];
		result = gz_study_backend_parse(study->backends[i], stage->log, backend);
		if (result == GZ_OK)
			result = show_scene(stage, backend, &stage->backends[i]);
		if (result == GZ_OK && out_descriptions)
			snprintf(out_descriptions[i], GZ_STUDY_TEXT_SIZE, "%s",
				 gz_picture_maker_describe(stage->backends[i]));
	}
	return result;
}

static enum gz_result make_variants(struct gz_stage *stage, const struct gz_study *study)
{
	const struct gz_variant_settings scene = { stage->scene.settings.foveation,
						   stage->scene.settings.rays };
	enum gz_result result = GZ_OK;
	free(stage->variants);
	stage->variants = calloc(study->variant_count, sizeof *stage->variants);
	if (!stage->variants)
		return GZ_ERR_NO_MEM;
	for (size_t i = 0; i < study->variant_count && result == GZ_OK; i++) {
		struct gz_variant_settings *settings = &stage->variants[i];
		result = gz_variant_parse(study->variants[i].text, &scene, stage->log, settings);
		if (result == GZ_OK && gz_method_of(&settings->foveation)->needs_table)
			result = gz_scene_load_table(stage->path, stage->log, &settings->foveation);
	}
	return result;
}

/* Which of its scene's transfer functions an entry of the list stands for. */
static size_t transfer_of(const struct gz_study *study, size_t scene)
{
	size_t which = 0;
	while (which < scene &&
	       strcmp(study->scenes[scene - which - 1].path, study->scenes[scene].path) == 0)
		which++;
	return which;
}

enum gz_result gz_stage_enter(struct gz_stage *stage, const struct gz_study *study, size_t scene,
			      char (*out_descriptions)[GZ_STUDY_TEXT_SIZE])
{
	char name[GZ_STUDY_TEXT_SIZE];
	if (stage->entered == scene + 1)
		return GZ_OK;
	enum gz_result result = gz_stage_load(stage, study->scenes[scene].path);
	if (result == GZ_OK)
		result =
			gz_stage_transfer(stage, transfer_of(study, scene), name, &stage->transfer);
	stage->transfer_revision++;
	if (result == GZ_OK)
		result = show_on_backends(stage, study, out_descriptions);
	if (result == GZ_OK)
		result = make_variants(stage, study);
	stage->entered = result == GZ_OK ? scene + 1 : 0;
	return result;
}

/* ---- variants ---- */

bool gz_list_next(const char **list, char *item, size_t size)
{
	if (!*list)
		return false;
	const size_t length = strcspn(*list, ",");
	snprintf(item, size, "%.*s", (int)length, *list);
	*list = (*list)[length] == ',' ? *list + length + 1 : NULL;
	return true;
}

/* The option of a section and what it sets. */
static const struct gz_option *find_option(const struct gz_option_binding bindings[2],
					   const char *key, void **out_target)
{
	static const char *const sections[2] = { "foveation", "render" };
	char full[GZ_STUDY_TEXT_SIZE + 16];
	for (size_t i = 0; i < 2; i++) {
		snprintf(full, sizeof full, "%s.%s", sections[i], key);
		const struct gz_option *option = gz_options_find(&bindings[i], 1, full, NULL);
		*out_target = bindings[i].target;
		if (option)
			return option;
	}
	return NULL;
}

static enum gz_result set_option(struct gz_variant_settings *settings, const char *text,
				 const char *key, const char *value, const struct gz_log *log)
{
	const struct gz_option_binding bindings[2] = {
		{ gz_foveation_options, gz_foveation_option_count, &settings->foveation, NULL },
		{ gz_ray_options, gz_ray_option_count, &settings->rays, NULL },
	};
	char message[256];
	void *target;
	const struct gz_option *option = find_option(bindings, key, &target);
	if (!option) {
		gz_err(log, "%s: no option %s in a scene's sections [foveation] and [render]", text,
		       key);
		return GZ_ERR_INVAL;
	}
	if (gz_option_parse(option, value, target, message, sizeof message) == GZ_OK)
		return GZ_OK;
	gz_err(log, "%s: %s: %s", text, key, message);
	return GZ_ERR_INVAL;
}

enum gz_result gz_variant_parse(const char *text, const struct gz_variant_settings *scene,
				const struct gz_log *log, struct gz_variant_settings *out_settings)
{
	struct gz_variant_settings settings = *scene;
	char copy[GZ_STUDY_TEXT_SIZE];
	if (snprintf(copy, sizeof copy, "%s", text) >= (int)sizeof copy) {
		gz_err(log, "%.40s…: a method and its options have less than %zu bytes", text,
		       sizeof copy);
		return GZ_ERR_INVAL;
	}
	if (!copy[0]) {
		gz_err(log, "a method's name is missing: separate methods by one comma; gazebench "
			    "--list names them");
		return GZ_ERR_INVAL;
	}
	char *rest = copy;
	for (char *part = strsep(&rest, ":"); part; part = strsep(&rest, ":")) {
		char *value = strchr(part, '=');
		const char *key = "method";
		if (value) {
			*value++ = '\0';
			key = part;
		} else if (part != copy) {
			gz_err(log, "%s: %s: write OPTION=VALUE after the method", text, part);
			return GZ_ERR_INVAL;
		}
		const enum gz_result result =
			set_option(&settings, text, key, value ? value : part, log);
		if (result != GZ_OK)
			return result;
	}
	*out_settings = settings;
	return GZ_OK;
}
