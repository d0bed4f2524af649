#include "bench/study/study_json.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/text.h"

#define GZ_LOG_MODULE "study"

/* ---- writing ---- */

static json_t *numbers(const double *values, size_t count)
{
	json_t *array = json_array();
	for (size_t i = 0; i < count; i++)
		json_array_append_new(array, json_real(values[i]));
	return array;
}

static json_t *camera_to_json(const struct gz_camera *camera)
{
	return json_pack("{so so so sf sf ss}", "eye", numbers(camera->eye, 3), "look_at",
			 numbers(camera->look_at, 3), "up", numbers(camera->up, 3), "fov_deg",
			 camera->fov_deg, "height", camera->height, "projection",
			 camera->projection == GZ_PROJECTION_ORTHOGRAPHIC ? "orthographic"
									  : "perspective");
}

static json_t *scene_to_json(const struct gz_study_scene *scene)
{
	const struct gz_display *display = &scene->display;
	return json_pack("{ss ss ss ss ss s[iii] so s{sb s[ii] s[ff] sf}}", "name", scene->name,
			 "path", scene->path, "transfer", scene->transfer, "hash", scene->hash,
			 "data_hash", scene->data_hash, "dims", scene->dims[0], scene->dims[1],
			 scene->dims[2], "camera", camera_to_json(&scene->camera), "display",
			 "known", scene->display_known, "px", display->px[0], display->px[1], "mm",
			 display->mm[0], display->mm[1], "distance_mm", display->distance_mm);
}

static json_t *lists_to_json(const struct gz_study *study)
{
	json_t *scenes = json_array(), *variants = json_array(), *sizes = json_array();
	json_t *backends = json_array(), *points = json_array();
	for (size_t i = 0; i < study->scene_count; i++)
		json_array_append_new(scenes, scene_to_json(&study->scenes[i]));
	for (size_t i = 0; i < study->variant_count; i++)
		json_array_append_new(variants,
				      json_pack("{ss ss}", "text", study->variants[i].text,
						"method", study->variants[i].method));
	for (size_t i = 0; i < study->size_count; i++)
		json_array_append_new(sizes,
				      json_pack("[ii]", study->sizes[i][0], study->sizes[i][1]));
	for (size_t i = 0; i < study->backend_count; i++)
		json_array_append_new(backends, json_string(study->backends[i]));
	for (size_t i = 0; i < study->point_count; i++) {
		const struct gz_study_point *point = &study->points[i];
		json_array_append_new(points, json_pack("[ffI]", gz_number_of_float(point->gaze.x),
							gz_number_of_float(point->gaze.y),
							(json_int_t)point->camera));
	}
	return json_pack("{so so so so so}", "scenes", scenes, "variants", variants, "sizes", sizes,
			 "backends", backends, "points", points);
}

/* [scene][size][point] */
static json_t *bound_to_json(const struct gz_study *study)
{
	const double *row = study->bound_rays;
	json_t *scenes = json_array();
	for (size_t i = 0; i < study->scene_count && row; i++) {
		json_t *sizes = json_array();
		for (size_t k = 0; k < study->size_count; k++, row += study->point_count)
			json_array_append_new(sizes, numbers(row, study->point_count));
		json_array_append_new(scenes, sizes);
	}
	return scenes;
}

static json_t *machine_to_json(const struct gz_study *study)
{
	const struct gz_study_machine *machine = &study->machine;
	json_t *backends = json_array(), *copies = json_array();
	for (size_t i = 0; i < study->backend_count; i++)
		json_array_append_new(backends, json_string(machine->backends[i]));
	for (size_t i = 0; i < study->size_count; i++)
		json_array_append_new(copies, isnan(machine->copy_ms[i])
						      ? json_null()
						      : json_real(machine->copy_ms[i]));
	return json_pack("{ss ss ss ss ss ss so so}", "program", machine->program, "commit",
			 machine->commit, "compiler", machine->compiler, "host_cpu",
			 machine->host_cpu, "memory", machine->memory, "system", machine->system,
			 "backends", backends, "copy_ms", copies);
}

json_t *gz_study_to_json(const struct gz_study *study)
{
	json_t *json = json_pack(
		"{ss si sb si si sI si si si ss sf sb ss ss ss ss}", "format", GZ_STUDY_FORMAT,
		"version", GZ_STUDY_VERSION, "complete", study->complete, "shard", study->shard + 1,
		"shards", study->shard_count, "seed", (json_int_t)study->seed, "cameras",
		(int)study->camera_count, "frames", study->frames_per_point, "warm_up",
		study->warm_up_frames, "path", study->path, "min_move_px", study->min_move_px,
		"per_cell", study->per_cell, "path_hash", study->path_hash, "camera_path",
		study->camera_path, "camera_path_hash", study->camera_path_hash, "errors",
		gz_study_accuracy_names[study->accuracy]);
	json_t *machine = machine_to_json(study), *lists = lists_to_json(study);
	if (!json || !machine || !lists || json_object_set(json, "machine", machine) != 0 ||
	    json_object_update(json, lists) != 0 ||
	    json_object_set_new(json, "bound_rays", bound_to_json(study)) != 0) {
		json_decref(json);
		json = NULL;
	}
	json_decref(machine);
	json_decref(lists);
	return json;
}

/* One number of JSON, at @p from, in its shortest form; where the text goes on. */
static char *shorten(const char *from, size_t length, char *to)
{
	char number[GZ_NUMBER_SIZE], shortest[GZ_NUMBER_SIZE + 2] = "";
	double value;
	snprintf(number, sizeof number, "%.*s", (int)length, from);
	/* Whole numbers stay as they are, reals stay reals. */
	if (length < sizeof number && strpbrk(number, ".e") && gz_number_parse(number, &value)) {
		gz_number_print(value, shortest);
		if (!strpbrk(shortest, ".e"))
			strcat(shortest, ".0");
	}
	const size_t shorter = strlen(shortest);
	if (shorter > 0 && shorter < length) {
		memcpy(to, shortest, shorter);
		return to + shorter;
	}
	memmove(to, from, length);
	return to + length;
}

/* Jansson prints 17 digits, of which most numbers need few: 0.80000000000000004. */
static void shorten_numbers(char *json)
{
	bool quoted = false;
	char *to = json;
	for (const char *from = json; *from;) {
		const size_t digits = quoted ? 0 : strspn(from, "+-.eE0123456789");
		if (digits > 0 && *from != 'e') { /* the one of true and false */
			to = shorten(from, digits, to);
			from += digits;
			continue;
		}
		if (quoted && *from == '\\')
			*to++ = *from++;
		else if (*from == '"')
			quoted = !quoted;
		*to++ = *from++;
	}
	*to = '\0';
}

static void add_paths_from(const char *folder, json_t *scenes)
{
	char path[GZ_PATH_SIZE];
	json_t *scene;
	size_t i;
	json_array_foreach(scenes, i, scene)
	{
		const char *given = json_string_value(json_object_get(scene, "path"));
		if (given && gz_path_from(folder, given, path, sizeof path) == GZ_OK)
			json_object_set_new(scene, "from_study", json_string(path));
	}
}

char *gz_study_to_text(const struct gz_study *study, const char *folder)
{
	json_t *json = gz_study_to_json(study);
	add_paths_from(folder, json_object_get(json, "scenes"));
	char *text = json ? json_dumps(json, JSON_INDENT(1)) : NULL;
	json_decref(json);
	if (text)
		shorten_numbers(text);
	return text;
}

/* ---- reading ---- */

struct reader {
	const char *name;
	const struct gz_log *log;
	enum gz_result result; /* of the first thing that is wrong */
};

__attribute__((format(printf, 2, 3))) static void refuse(struct reader *reader, const char *format,
							 ...)
{
	char what[256];
	va_list arguments;
	if (reader->result != GZ_OK)
		return;
	va_start(arguments, format);
	vsnprintf(what, sizeof what, format, arguments);
	va_end(arguments);
	gz_err(reader->log, "%s: %s: the study is damaged; measure it again", reader->name, what);
	reader->result = GZ_ERR_FORMAT;
}

static void read_text(struct reader *reader, const json_t *object, const char *key, char *text,
		      size_t size)
{
	const json_t *value = json_object_get(object, key);
	if (!json_is_string(value) || json_string_length(value) >= size ||
	    strlen(json_string_value(value)) != json_string_length(value)) {
		refuse(reader, "%s is not a text of less than %zu bytes", key, size);
		return;
	}
	memcpy(text, json_string_value(value), json_string_length(value) + 1);
}

static long long whole(struct reader *reader, const json_t *value, const char *key, long long least,
		       long long most)
{
	if (json_is_integer(value) && json_integer_value(value) >= least &&
	    json_integer_value(value) <= most)
		return json_integer_value(value);
	refuse(reader, "%s is not a whole number from %lld to %lld", key, least, most);
	return least;
}

static long long read_whole(struct reader *reader, const json_t *object, const char *key,
			    long long least, long long most)
{
	return whole(reader, json_object_get(object, key), key, least, most);
}

static double real(struct reader *reader, const json_t *value, const char *key)
{
	if (json_is_number(value))
		return json_number_value(value);
	refuse(reader, "%s is not a number", key);
	return 0;
}

static void read_reals(struct reader *reader, const json_t *object, const char *key, double *values,
		       size_t count)
{
	const json_t *array = json_object_get(object, key);
	if (json_array_size(array) != count)
		refuse(reader, "%s is not a list of %zu numbers", key, count);
	for (size_t i = 0; i < count; i++)
		values[i] = real(reader, json_array_get(array, i), key);
}

static void read_wholes(struct reader *reader, const json_t *object, const char *key, int *values,
			size_t count, int most)
{
	const json_t *array = json_object_get(object, key);
	if (json_array_size(array) != count)
		refuse(reader, "%s is not a list of %zu numbers", key, count);
	for (size_t i = 0; i < count; i++)
		values[i] = (int)whole(reader, json_array_get(array, i), key, 1, most);
}

/* An array of 1 to most things, and room for as many structs. */
static void *read_list(struct reader *reader, const json_t *object, const char *key, size_t most,
		       size_t element_size, const json_t **out_array, size_t *out_count)
{
	*out_array = json_object_get(object, key);
	*out_count = 0;
	const size_t count = json_array_size(*out_array);
	if (count < 1 || count > most) {
		refuse(reader, "%s is not a list of 1 to %zu", key, most);
		return NULL;
	}
	void *room = calloc(count, element_size);
	if (!room) {
		gz_err(reader->log, "%s: no memory for %zu %s", reader->name, count, key);
		reader->result = GZ_ERR_NO_MEM;
		return NULL;
	}
	*out_count = count;
	return room;
}

static void read_camera(struct reader *reader, const json_t *json, struct gz_camera *camera)
{
	char projection[GZ_NAME_SIZE] = "";
	read_reals(reader, json, "eye", camera->eye, 3);
	read_reals(reader, json, "look_at", camera->look_at, 3);
	read_reals(reader, json, "up", camera->up, 3);
	camera->fov_deg = real(reader, json_object_get(json, "fov_deg"), "fov_deg");
	camera->height = real(reader, json_object_get(json, "height"), "height");
	read_text(reader, json, "projection", projection, sizeof projection);
	const bool orthographic = strcmp(projection, "orthographic") == 0;
	camera->projection = orthographic ? GZ_PROJECTION_ORTHOGRAPHIC : GZ_PROJECTION_PERSPECTIVE;
	if (!orthographic && strcmp(projection, "perspective") != 0)
		refuse(reader, "projection is neither perspective nor orthographic");
}

/* Studies of earlier versions do not say where their scenes are as seen from them. */
static void find_scene(const struct reader *reader, const json_t *json,
		       struct gz_study_scene *scene)
{
	char path[GZ_PATH_SIZE];
	const char *from_study = json_string_value(json_object_get(json, "from_study"));
	if (from_study && access(scene->path, F_OK) != 0 &&
	    gz_path_beside(reader->name, from_study, path, sizeof path) == GZ_OK &&
	    access(path, F_OK) == 0)
		memcpy(scene->path, path, sizeof path);
}

static void read_scene(struct reader *reader, const json_t *json, struct gz_study_scene *scene)
{
	const json_t *display = json_object_get(json, "display");
	read_text(reader, json, "name", scene->name, sizeof scene->name);
	read_text(reader, json, "path", scene->path, sizeof scene->path);
	find_scene(reader, json, scene);
	read_text(reader, json, "transfer", scene->transfer, sizeof scene->transfer);
	read_text(reader, json, "hash", scene->hash, sizeof scene->hash);
	read_text(reader, json, "data_hash", scene->data_hash, sizeof scene->data_hash);
	scene->display_known = json_is_true(json_object_get(display, "known"));
	read_wholes(reader, json, "dims", scene->dims, 3, INT32_MAX);
	read_camera(reader, json_object_get(json, "camera"), &scene->camera);
	read_wholes(reader, display, "px", scene->display.px, 2, GZ_DISPLAY_SIDE_MAX_PX);
	read_reals(reader, display, "mm", scene->display.mm, 2);
	scene->display.distance_mm =
		real(reader, json_object_get(display, "distance_mm"), "distance_mm");
	if (reader->result == GZ_OK && !gz_display_valid(&scene->display))
		refuse(reader, "the display of %s is impossible", scene->name);
}

static void read_point(struct reader *reader, const json_t *json, struct gz_study_point *point)
{
	if (json_array_size(json) != 3)
		refuse(reader, "a point is not a list of x, y and camera");
	point->gaze.x = (float)real(reader, json_array_get(json, 0), "a point's x");
	point->gaze.y = (float)real(reader, json_array_get(json, 1), "a point's y");
	point->camera =
		(uint32_t)whole(reader, json_array_get(json, 2), "a point's camera", 0, UINT32_MAX);
}

static void read_lists(struct reader *reader, const json_t *json, struct gz_study *study)
{
	const json_t *array;
	study->scenes = read_list(reader, json, "scenes", GZ_STUDY_SCENES_MAX,
				  sizeof *study->scenes, &array, &study->scene_count);
	for (size_t i = 0; i < study->scene_count; i++)
		read_scene(reader, json_array_get(array, i), &study->scenes[i]);
	study->variants = read_list(reader, json, "variants", GZ_STUDY_LIST_MAX,
				    sizeof *study->variants, &array, &study->variant_count);
	for (size_t i = 0; i < study->variant_count; i++) {
		struct gz_study_variant *variant = &study->variants[i];
		const json_t *item = json_array_get(array, i);
		read_text(reader, item, "text", variant->text, sizeof variant->text);
		read_text(reader, item, "method", variant->method, sizeof variant->method);
	}
	study->points = read_list(reader, json, "points", GZ_STUDY_POINTS_MAX,
				  sizeof *study->points, &array, &study->point_count);
	for (size_t i = 0; i < study->point_count; i++)
		read_point(reader, json_array_get(array, i), &study->points[i]);
}

static void read_sizes_and_backends(struct reader *reader, const json_t *json,
				    struct gz_study *study)
{
	const json_t *array;
	study->sizes = read_list(reader, json, "sizes", GZ_STUDY_LIST_MAX, sizeof *study->sizes,
				 &array, &study->size_count);
	for (size_t i = 0; i < study->size_count; i++) {
		const json_t *size = json_array_get(array, i);
		if (json_array_size(size) != 2)
			refuse(reader, "a size is not a list of width and height");
		for (size_t k = 0; k < 2; k++)
			study->sizes[i][k] = (int)whole(reader, json_array_get(size, k), "a size",
							1, GZ_IMAGE_SIDE_MAX);
	}
	study->backends = read_list(reader, json, "backends", GZ_STUDY_LIST_MAX,
				    sizeof *study->backends, &array, &study->backend_count);
	for (size_t i = 0; i < study->backend_count; i++) {
		const json_t *item = json_array_get(array, i);
		if (!json_is_string(item) || json_string_length(item) >= GZ_NAME_SIZE)
			refuse(reader, "a backend is not a name");
		else
			snprintf(study->backends[i], GZ_NAME_SIZE, "%s", json_string_value(item));
	}
}

/* Whether bound_rays has as many numbers as the lists ask for. */
static bool has_bound(const json_t *scenes, const struct gz_study *study)
{
	for (size_t i = 0; i < study->scene_count; i++)
		for (size_t k = 0; k < study->size_count; k++)
			if (json_array_size(json_array_get(json_array_get(scenes, i), k)) !=
			    study->point_count)
				return false;
	return true;
}

static void read_bound(struct reader *reader, const json_t *json, struct gz_study *study)
{
	const json_t *scenes = json_object_get(json, "bound_rays");
	const size_t points = study->point_count;
	if (reader->result == GZ_OK && !has_bound(scenes, study))
		refuse(reader, "bound_rays has not a number for each scene, size and point");
	if (reader->result != GZ_OK)
		return;
	study->bound_rays =
		calloc(study->scene_count * study->size_count * points, sizeof *study->bound_rays);
	if (!study->bound_rays) {
		gz_err(reader->log, "%s: no memory for bound_rays", reader->name);
		reader->result = GZ_ERR_NO_MEM;
		return;
	}
	double *value = study->bound_rays;
	for (size_t i = 0; i < study->scene_count; i++)
		for (size_t k = 0; k < study->size_count; k++) {
			const json_t *row = json_array_get(json_array_get(scenes, i), k);
			for (size_t n = 0; n < points; n++)
				*value++ = real(reader, json_array_get(row, n), "bound_rays");
		}
}

static void read_machine(struct reader *reader, const json_t *json, struct gz_study *study)
{
	struct gz_study_machine *machine = &study->machine;
	const json_t *backends = json_object_get(json, "backends");
	read_text(reader, json, "program", machine->program, sizeof machine->program);
	read_text(reader, json, "commit", machine->commit, sizeof machine->commit);
	read_text(reader, json, "compiler", machine->compiler, sizeof machine->compiler);
	read_text(reader, json, "host_cpu", machine->host_cpu, sizeof machine->host_cpu);
	read_text(reader, json, "memory", machine->memory, sizeof machine->memory);
	read_text(reader, json, "system", machine->system, sizeof machine->system);
	if (json_array_size(backends) != study->backend_count)
		refuse(reader, "machine does not describe each backend");
	for (size_t i = 0; i < study->backend_count; i++) {
		const json_t *item = json_array_get(backends, i);
		snprintf(machine->backends[i], sizeof machine->backends[i], "%s",
			 json_is_string(item) ? json_string_value(item) : "");
	}
	for (size_t i = 0; i < study->size_count; i++) {
		const json_t *item = json_array_get(json_object_get(json, "copy_ms"), i);
		machine->copy_ms[i] = json_is_number(item) ? json_number_value(item) : NAN;
	}
}

static void read_accuracy(struct reader *reader, const json_t *json,
			  enum gz_study_accuracy *accuracy)
{
	char text[GZ_NAME_SIZE] = "";
	int i = 0;
	read_text(reader, json, "errors", text, sizeof text);
	while (i < GZ_STUDY_ACCURACY_COUNT && strcmp(gz_study_accuracy_names[i], text) != 0)
		i++;
	if (i == GZ_STUDY_ACCURACY_COUNT)
		refuse(reader, "errors is '%s', not none, standard or all", text);
	else
		*accuracy = (enum gz_study_accuracy)i;
}

static void read_head(struct reader *reader, const json_t *json, struct gz_study *study)
{
	study->complete = json_is_true(json_object_get(json, "complete"));
	study->shard_count = (int)read_whole(reader, json, "shards", 1, INT32_MAX);
	study->shard = (int)read_whole(reader, json, "shard", 1, study->shard_count) - 1;
	study->seed = (uint64_t)read_whole(reader, json, "seed", 0, INT64_MAX);
	study->camera_count = (uint32_t)read_whole(reader, json, "cameras", 0, INT32_MAX);
	study->frames_per_point = (int)read_whole(reader, json, "frames", 1, GZ_STUDY_FRAMES_MAX);
	study->warm_up_frames = (int)read_whole(reader, json, "warm_up", 0, GZ_STUDY_FRAMES_MAX);
	read_accuracy(reader, json, &study->accuracy);
	read_text(reader, json, "path", study->path, sizeof study->path);
	/* Studies that were made before these were kept have neither. */
	if (json_object_get(json, "min_move_px"))
		study->min_move_px =
			real(reader, json_object_get(json, "min_move_px"), "min_move_px");
	study->per_cell = json_is_true(json_object_get(json, "per_cell"));
	read_text(reader, json, "path_hash", study->path_hash, sizeof study->path_hash);
	if (json_object_get(json, "camera_path")) { /* likewise */
		read_text(reader, json, "camera_path", study->camera_path,
			  sizeof study->camera_path);
		read_text(reader, json, "camera_path_hash", study->camera_path_hash,
			  sizeof study->camera_path_hash);
	}
}

static bool is_this_version(const json_t *json, const char *name, const struct gz_log *log)
{
	const char *format = json_string_value(json_object_get(json, "format"));
	const long long version = json_integer_value(json_object_get(json, "version"));
	if (!format || strcmp(format, GZ_STUDY_FORMAT) != 0) {
		gz_err(log, "%s: is not a study of gazebench", name);
		return false;
	}
	if (version != GZ_STUDY_VERSION)
		gz_err(log,
		       "%s: is of version %lld and this program reads version %d; measure it "
		       "again, or use the program that made it",
		       name, version, GZ_STUDY_VERSION);
	return version == GZ_STUDY_VERSION;
}

enum gz_result gz_study_from_json(const json_t *json, const char *name, const struct gz_log *log,
				  struct gz_study *out_study)
{
	struct gz_study *study = calloc(1, sizeof *study); /* of some size */
	struct reader reader = { .name = name, .log = log };
	if (!study)
		return GZ_ERR_NO_MEM;
	if (!is_this_version(json, name, log)) {
		free(study);
		return GZ_ERR_FORMAT;
	}
	read_head(&reader, json, study);
	read_lists(&reader, json, study);
	read_sizes_and_backends(&reader, json, study);
	read_machine(&reader, json_object_get(json, "machine"), study);
	read_bound(&reader, json, study);
	if (reader.result == GZ_OK)
		*out_study = *study;
	else
		gz_study_free(study);
	free(study);
	return reader.result;
}
