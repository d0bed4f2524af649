#include "render/scene/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/workers.h"
#include "render/light/cube.h"
#include "render/mesh/mesh_read.h"
#include "render/particles/particles.h"
#include "render/plan/method.h"
#include "render/scene/scene_files.h"
#include "render/scene/scene_open.h"
#include "render/scene/techniques.h"
#include "render/transfer/histogram.h"
#include "render/transfer/transfer_presets.h"

#define GZ_LOG_MODULE "scene"

/* Edge of a procedural volume without volume.dims, voxels. Chosen: it is made in a blink. */
#define PROCEDURAL_EDGE 128

/* What loading a scene needs throughout. */
struct scene_loader {
	const char *name;
	const struct gz_loading *loading;
	const struct gz_log *log;
	const struct gz_scene_settings *settings;
	struct gz_particle_frame *particle_frame; /* NULL: not kept */
};

static enum gz_result find_named_file(const struct scene_loader *loader, const char *key,
				      const char *name, char out_path[GZ_PATH_SIZE])
{
	const char *data = getenv("GAZECAST_DATA");
	if (gz_scene_find_file(loader->name, name, out_path) == GZ_OK)
		return GZ_OK;
	if (name[0] == '/')
		gz_err(loader->log, "%s: %s: no file %s; install it or correct the name",
		       loader->name, key, name);
	else
		gz_err(loader->log,
		       "%s: %s: %s is neither beside the scene nor under GAZECAST_DATA (%s); put "
		       "it there or set the variable",
		       loader->name, key, name, data && *data ? data : "not set");
	return GZ_ERR_NOT_FOUND;
}

/* The path of a file of data, which the scene may say where to get. */
static enum gz_result find_data_file(const struct scene_loader *loader, const char *key,
				     const char *name, char out_path[GZ_PATH_SIZE])
{
	const enum gz_result result = find_named_file(loader, key, name, out_path);
	if (result == GZ_ERR_NOT_FOUND && loader->settings->volume_source[0])
		gz_err(loader->log, "%s: get its data here: %s", loader->name,
		       loader->settings->volume_source);
	return result;
}

/* The path of the volume's file. */
static enum gz_result find_volume(const struct scene_loader *loader, char out_path[GZ_PATH_SIZE])
{
	const struct gz_scene_settings *settings = loader->settings;
	const struct gz_scene_object *object = gz_scene_volume_object(settings);
	return object ? find_data_file(loader, object->section,
				       object->volume[0] ? object->volume : object->particles,
				       out_path)
		      : find_data_file(loader, "volume.file", settings->volume_file, out_path);
}

static enum gz_result make_procedural(const struct scene_loader *loader,
				      struct gz_volume *out_volume)
{
	static const int preset[3] = { PROCEDURAL_EDGE, PROCEDURAL_EDGE, PROCEDURAL_EDGE };
	const struct gz_scene_settings *settings = loader->settings;
	const int *dims = settings->dims[0] > 0 ? settings->dims : preset;
	const enum gz_procedural which = (enum gz_procedural)(settings->volume_procedural - 1);
	enum gz_voxel_type type;
	double spacing[3];
	if (!gz_scene_made_type(settings, &type))
		return GZ_ERR_INVAL; /* cannot happen: refused when the settings were read */
	for (int axis = 0; axis < 3; axis++)
		spacing[axis] = settings->spacing[axis] > 0 ? settings->spacing[axis] : 1;
	return gz_volume_generate(&(struct gz_procedural_request) { which, dims, spacing, type },
				  loader->loading, loader->log, out_volume);
}

static enum gz_result load_volume_file(const struct scene_loader *loader,
				       struct gz_volume *out_volume)
{
	const struct gz_scene_settings *settings = loader->settings;
	char path[GZ_PATH_SIZE];
	const enum gz_result result = find_volume(loader, path);
	if (result != GZ_OK)
		return result;
	struct gz_loading loading = loader->loading ? *loader->loading : (struct gz_loading) { 0 };
	loading.brick_bytes = (size_t)settings->memory_mib << 20;
	loading.series_uid = settings->volume_series;
	loading.resampling = (enum gz_resampling)settings->resample;
	loading.time_point = settings->time_point - 1;
	loading.opacity = (enum gz_opacity_source)settings->opacity;
	struct gz_raw_layout raw = { .type = (enum gz_raw_type)settings->type,
				     .big_endian = settings->endian == 1,
				     .channels = settings->channels };
	memcpy(raw.dims, settings->dims, sizeof raw.dims);
	memcpy(raw.spacing, settings->spacing, sizeof raw.spacing);
	const struct gz_scene_object *object = gz_scene_volume_object(settings);
	if ((object && object->particles[0]) ||
	    (settings->dims[0] == 0 && gz_particle_format_of(path)))
		return gz_particle_volume_load(path, &settings->particles, loader->particle_frame,
					       &loading, loader->log, out_volume);
	const enum gz_result loaded = gz_volume_load(path, settings->dims[0] > 0 ? &raw : NULL,
						     &loading, loader->log, out_volume);
	if (loaded == GZ_OK && out_volume->spacing_assumed)
		gz_info(loader->log, "%s: the spacing of its voxels is not stated; 1 mm is assumed",
			path);
	return loaded;
}

void gz_scene_free_labels(const struct gz_scene *scene, struct gz_label_surfaces *labels)
{
	for (size_t i = 0; labels && i < scene->settings.objects.count; i++)
		gz_label_surfaces_free(&labels[i]);
	free(labels);
}

static void free_meshes(struct gz_scene *scene)
{
	free(scene->inputs);
	scene->inputs = NULL;
	for (size_t i = 0; scene->meshes && i < scene->settings.objects.count; i++)
		gz_mesh_free(&scene->meshes[i]);
	free(scene->meshes);
	gz_scene_free_labels(scene, scene->labels);
	scene->meshes = NULL;
	scene->labels = NULL;
}

static enum gz_result load_mesh(const struct scene_loader *loader,
				const struct gz_scene_object *object, struct gz_mesh *out_mesh)
{
	char path[GZ_PATH_SIZE];
	const enum gz_result result = find_data_file(loader, object->section, object->mesh, path);
	return result == GZ_OK ? gz_mesh_read(path, loader->log, out_mesh) : result;
}

/* Note the files of meshes and labels, which are there. */
static enum gz_result note_inputs(const struct scene_loader *loader, struct gz_scene *scene)
{
	const struct gz_scene_objects *objects = &loader->settings->objects;
	if (!scene->meshes && !scene->labels)
		return GZ_OK;
	scene->inputs = calloc(objects->count, sizeof *scene->inputs);
	if (!scene->inputs)
		return GZ_ERR_NO_MEM;
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < objects->count && result == GZ_OK; i++) {
		const struct gz_scene_object *item = &objects->items[i];
		const char *file = item->mesh[0] ? item->mesh : item->labels;
		if (file[0])
			result = find_data_file(loader, item->section, file, scene->inputs[i]);
	}
	return result;
}

static enum gz_result load_meshes(const struct scene_loader *loader, struct gz_scene *scene)
{
	const struct gz_scene_objects *objects = &loader->settings->objects;
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < objects->count && result == GZ_OK; i++) {
		if (!objects->items[i].mesh[0])
			continue;
		if (!scene->meshes)
			scene->meshes = calloc(objects->count, sizeof *scene->meshes);
		if (!scene->meshes) {
			gz_err(loader->log, "%s: no memory for its meshes", loader->name);
			return GZ_ERR_NO_MEM;
		}
		result = load_mesh(loader, &objects->items[i], &scene->meshes[i]);
	}
	return result;
}

/* The volume of an object's labels. A raw file has the layout of section [volume]. */
static enum gz_result load_label_volume(const struct scene_loader *loader,
					const struct gz_scene_object *object,
					struct gz_volume *out_volume)
{
	const struct gz_scene_settings *settings = loader->settings;
	char path[GZ_PATH_SIZE];
	const enum gz_result result = find_data_file(loader, object->section, object->labels, path);
	if (result != GZ_OK)
		return result;
	struct gz_loading loading = loader->loading ? *loader->loading : (struct gz_loading) { 0 };
	loading.resampling = (enum gz_resampling)settings->resample;
	struct gz_raw_layout raw = { .type = (enum gz_raw_type)settings->type,
				     .big_endian = settings->endian == 1,
				     .channels = settings->channels };
	memcpy(raw.dims, settings->dims, sizeof raw.dims);
	memcpy(raw.spacing, settings->spacing, sizeof raw.spacing);
	const bool is_raw = gz_file_kind_by_name(path) == GZ_FILE_RAW;
	return gz_volume_load(path, is_raw && settings->dims[0] > 0 ? &raw : NULL, &loading,
			      loader->log, out_volume);
}

/* The names and colours of an object's labels: those of labels.names, or of a file beside the
 * volume, which may be of another kind. */
static enum gz_result load_label_names(const struct scene_loader *loader,
				       const struct gz_scene_object *object,
				       struct gz_label_names *out_names)
{
	const char *named = loader->settings->labels.names;
	char path[GZ_PATH_SIZE], beside[GZ_PATH_SIZE];
	enum gz_result result =
		named[0] ? find_named_file(loader, "labels.names", named, path)
			 : find_data_file(loader, object->section, object->labels, path);
	if (result != GZ_OK)
		return result;
	if (named[0])
		return gz_label_names_read(path, loader->log, out_names);
	if (!gz_label_names_beside(path, beside))
		return GZ_OK;
	result = gz_label_names_read(beside, NULL, out_names);
	gz_debug(loader->log, "%s: %zu names of labels%s", beside, out_names->count,
		 result == GZ_OK ? "" : ": it is not a file of names");
	return result == GZ_ERR_NO_MEM ? result : GZ_OK;
}

/* Free the surfaces of labels that an object does not show. */
static void drop_other_regions(const struct gz_scene_object *object,
			       struct gz_label_surfaces *surfaces)
{
	size_t kept = 0;
	for (size_t i = 0; i < surfaces->count; i++) {
		struct gz_label_surface *surface = &surfaces->items[i];
		if (gz_scene_object_has_region(object, surface->number, surface->name))
			surfaces->items[kept++] = *surface;
		else
			gz_mesh_free(&surface->mesh);
	}
	surfaces->count = kept;
}

static enum gz_result load_labels_of(const struct scene_loader *loader,
				     const struct gz_scene_object *object,
				     struct gz_label_surfaces *out_surfaces)
{
	struct gz_volume volume;
	struct gz_workers *workers = NULL;
	struct gz_label_names names = { 0 };
	enum gz_result result = load_label_names(loader, object, &names);
	if (result == GZ_OK)
		result = load_label_volume(loader, object, &volume);
	if (result != GZ_OK) {
		gz_label_names_free(&names);
		return result;
	}
	/* Without further threads the calling one does all. */
	(void)gz_workers_create(0, &workers);
	const struct gz_label_request request = {
		.volume = &volume,
		.name = object->labels,
		.look = &loader->settings->labels,
		.names = &names,
	};
	const int64_t start_ns = gz_clock_now_ns();
	result = gz_label_surfaces_make(&request, workers, loader->log, out_surfaces);
	const size_t all = result == GZ_OK ? out_surfaces->count : 0;
	if (result == GZ_OK)
		drop_other_regions(object, out_surfaces);
	gz_debug(loader->log, "%s: surfaces of %zu labels: %.0f ms", object->labels,
		 result == GZ_OK ? out_surfaces->count : 0,
		 gz_ns_to_ms(gz_clock_now_ns() - start_ns));
	gz_workers_destroy(&workers);
	gz_volume_free(&volume);
	gz_label_names_free(&names);
	if (result == GZ_OK && all == 0)
		gz_warn(loader->log, "%s: %s: %s holds no label: every voxel is 0", loader->name,
			object->section, object->labels);
	else if (result == GZ_OK && out_surfaces->count == 0)
		gz_warn(loader->log,
			"%s: %s: no label has a name or number of regions = %s; gazeview "
			"--list-objects prints them without that key",
			loader->name, object->section, object->regions);
	return result;
}

static enum gz_result load_labels(const struct scene_loader *loader, struct gz_scene *scene)
{
	const struct gz_scene_objects *objects = &loader->settings->objects;
	enum gz_result result = GZ_OK;
	size_t count = 0;
	for (size_t i = 0; i < objects->count && result == GZ_OK; i++) {
		if (!objects->items[i].labels[0])
			continue;
		if (!scene->labels)
			scene->labels = calloc(objects->count, sizeof *scene->labels);
		if (!scene->labels) {
			gz_err(loader->log, "%s: no memory for its labels", loader->name);
			return GZ_ERR_NO_MEM;
		}
		result = load_labels_of(loader, &objects->items[i], &scene->labels[i]);
		count += scene->labels[i].count;
	}
	if (result == GZ_OK && count > GZ_LABELS_MAX) {
		gz_err(loader->log, "%s: its objects have %zu labels together; %d can be shown",
		       loader->name, count, GZ_LABELS_MAX);
		result = GZ_ERR_FULL;
	}
	return result;
}

/* What is done to each mesh of a scene. */
typedef void mesh_step(struct gz_mesh *mesh, void *user);

static void each_mesh(struct gz_scene *scene, mesh_step *step, void *user)
{
	for (size_t i = 0; i < scene->settings.objects.count; i++) {
		if (scene->meshes)
			step(&scene->meshes[i], user);
		for (size_t k = 0; scene->labels && k < scene->labels[i].count; k++)
			step(&scene->labels[i].items[k].mesh, user);
	}
}

/* The box of all meshes. */
struct mesh_box {
	double least[3], greatest[3];
};

static void add_to_box(struct gz_mesh *mesh, void *user)
{
	struct mesh_box *box = user;
	gz_mesh_bound(mesh, box->least, box->greatest);
}

static void move_to_centre(struct gz_mesh *mesh, void *user)
{
	gz_mesh_move(mesh, user);
}

/* Voxels along each edge of the empty space of a scene without a volume, and its shortest edge as a
 * share of the longest, so that flat meshes have a box. Chosen: the least that has corners. */
enum { EMPTY_EDGE = 2 };
#define EMPTY_SHARE 0.01

/* Lay out the empty space around all meshes, which have some extent. */
static void lay_out_empty_space(const double least[3], const double greatest[3],
				struct gz_volume *volume)
{
	double longest = 0;
	for (int axis = 0; axis < 3; axis++)
		longest = fmax(longest, greatest[axis] - least[axis]);
	*volume = (struct gz_volume) { .type = GZ_VOXEL_U8 };
	for (int axis = 0; axis < 3; axis++) {
		const double edge = fmax(greatest[axis] - least[axis], EMPTY_SHARE * longest);
		volume->dims[axis] = EMPTY_EDGE;
		volume->spacing[axis] = edge / EMPTY_EDGE;
	}
}

/* Make the empty space around all meshes, and move them so that its centre is the origin. */
static enum gz_result make_empty_space(const struct scene_loader *loader, struct gz_scene *scene)
{
	struct mesh_box box = { { INFINITY, INFINITY, INFINITY },
				{ -INFINITY, -INFINITY, -INFINITY } };
	const double *least = box.least, *greatest = box.greatest;
	struct gz_volume *volume = &scene->volume;
	each_mesh(scene, add_to_box, &box);
	if (!(greatest[0] > least[0] || greatest[1] > least[1] || greatest[2] > least[2])) {
		gz_err(loader->log,
		       "%s: its meshes have no extent, so nothing can be seen; name one with "
		       "triangles",
		       loader->name);
		return GZ_ERR_FORMAT;
	}
	lay_out_empty_space(least, greatest, volume);
	const enum gz_result result = gz_volume_allocate(volume);
	if (result != GZ_OK) {
		gz_err(loader->log, "%s: no box for its meshes: %s", loader->name,
		       gz_result_text(result));
		return result;
	}
	memset(volume->voxels, 0, gz_volume_voxel_count(volume));
	gz_volume_find_range(volume);
	for (int axis = 0; axis < 3; axis++)
		scene->centre[axis] = 0.5 * (least[axis] + greatest[axis]);
	each_mesh(scene, move_to_centre, scene->centre);
	return GZ_OK;
}

enum gz_result gz_scene_make_labels(const struct gz_scene_label_request *request,
				    const struct gz_log *log, struct gz_label_surfaces **out_labels)
{
	struct gz_scene made = { .settings = *request->settings };
	const struct scene_loader loader = { .name = request->name,
					     .log = log,
					     .settings = &made.settings };
	double centre[3];
	const enum gz_result result = load_labels(&loader, &made);
	if (result != GZ_OK) {
		gz_scene_free_labels(&made, made.labels);
		return result;
	}
	memcpy(centre, request->centre, sizeof centre);
	each_mesh(&made, move_to_centre, centre);
	*out_labels = made.labels;
	return GZ_OK;
}

static enum gz_result load_volume(const struct scene_loader *loader, struct gz_volume *out_volume)
{
	const struct gz_scene_settings *settings = loader->settings;
	const enum gz_result result = settings->volume_procedural
					      ? make_procedural(loader, out_volume)
					      : load_volume_file(loader, out_volume);
	if (result != GZ_OK || settings->time_point == 1 || out_volume->time_points > 1)
		return result;
	gz_err(loader->log,
	       "%s: volume.time_point is %d, but the volume is not a series; leave it "
	       "out",
	       loader->name, settings->time_point);
	gz_volume_free(out_volume);
	return GZ_ERR_INVAL;
}

enum gz_result gz_scene_load_time_point(const struct gz_scene_time_point *which,
					const struct gz_loading *loading, const struct gz_log *log,
					struct gz_volume *out_volume)
{
	struct gz_scene_settings settings = *which->settings;
	struct gz_loading of_series = loading ? *loading : (struct gz_loading) { 0 };
	const struct scene_loader loader = {
		.name = which->name,
		.loading = &of_series,
		.log = log,
		.settings = &settings,
		.particle_frame = &settings.particle_frame,
	};
	settings.time_point = which->time_point + 1;
	of_series.number_range = which->number_range;
	return load_volume(&loader, out_volume);
}

static enum gz_result load_transfer(const struct scene_loader *loader, const char *key,
				    const char *name, struct gz_transfer *out_transfer)
{
	char path[GZ_PATH_SIZE];
	const enum gz_result result = find_named_file(loader, key, name, path);
	return result == GZ_OK ? gz_transfer_load(path, loader->log, out_transfer) : result;
}

/* The transfer function that the settings name, if they name one. */
static enum gz_result load_named_transfer(const struct scene_loader *loader,
					  struct gz_transfer *out_transfer)
{
	const char *name = gz_scene_transfer_name(loader->settings);
	if (!name[0])
		return GZ_OK;
	const bool own_key = name == loader->settings->transfer_file;
	return load_transfer(loader,
			     own_key ? "transfer.file"
				     : gz_scene_transfer_object(loader->settings)->section,
			     name, out_transfer);
}

enum gz_result gz_scene_load_transfer(const char *scene, const char *file, const struct gz_log *log,
				      struct gz_transfer *out_transfer)
{
	const struct scene_loader loader = { .name = scene, .log = log };
	return load_transfer(&loader, "transfer.also", file, out_transfer);
}

enum gz_result gz_scene_load_table(const char *scene, const struct gz_log *log,
				   struct gz_foveation *foveation)
{
	static const char key[] = "foveation.table";
	const struct scene_loader loader = { .name = scene, .log = log };
	char path[GZ_PATH_SIZE];
	if (!foveation->table_file[0]) {
		if (!gz_method_of(foveation)->needs_table)
			return GZ_OK;
		gz_err(log,
		       "%s: %s: not given, and the method is %s; name a table of spacings "
		       "(docs/scenes.md describes the file)",
		       scene, key, gz_method_name(foveation));
		return GZ_ERR_FORMAT;
	}
	const enum gz_result result = find_named_file(&loader, key, foveation->table_file, path);
	return result == GZ_OK ? gz_spacing_table_load(path, log, &foveation->table) : result;
}

enum gz_result gz_scene_find_cube(const char *scene, const struct gz_log *log,
				  struct gz_environment *environment)
{
	static const char key[] = "environment.cube";
	const struct scene_loader loader = { .name = scene, .log = log };
	char path[GZ_PATH_SIZE];
	if (!environment->cube[0]) {
		environment->cube_path[0] = '\0';
		if (environment->kind != GZ_SURROUNDINGS_CUBE)
			return GZ_OK;
		gz_err(log,
		       "%s: %s: not given, and environment.kind is cube; name a folder of six "
		       "pictures (docs/surfaces.md lists them)",
		       scene, key);
		return GZ_ERR_FORMAT;
	}
	enum gz_result result = find_named_file(&loader, key, environment->cube, path);
	if (result == GZ_OK)
		result = gz_cube_check(path, log);
	if (result == GZ_OK)
		memcpy(environment->cube_path, path, strlen(path) + 1);
	return result;
}

/* Find one template by its name. */
static enum gz_result find_template(const struct scene_loader *loader, const char *key,
				    const char *name, struct gz_shading_template *out_template)
{
	char path[GZ_PATH_SIZE];
	if (!name[0]) {
		*out_template = gz_shading_template_empty();
		return GZ_OK;
	}
	if (gz_shading_template_named(name, out_template) == GZ_OK)
		return GZ_OK;
	if (gz_scene_find_file(loader->name, name, path) == GZ_OK)
		return gz_shading_template_read(path, loader->log, out_template);
	gz_err(loader->log,
	       "%s: %s: %s is neither a template (%s) nor a file beside the scene or under "
	       "GAZECAST_DATA",
	       loader->name, key, name, gz_shading_template_names);
	return GZ_ERR_NOT_FOUND;
}

enum gz_result gz_scene_find_templates(const char *scene, const struct gz_log *log,
				       struct gz_scene_settings *settings)
{
	const struct scene_loader loader = { .name = scene, .log = log, .settings = settings };
	struct gz_illustration_look *look = &settings->rays.illustration;
	enum gz_result result = find_template(&loader, "illustration.template", look->template_name,
					      &look->shading_template);
	for (size_t i = 0; i < settings->objects.count && result == GZ_OK; i++) {
		struct gz_scene_object *item = &settings->objects.items[i];
		char key[GZ_SCENE_SECTION_SIZE + 16];
		snprintf(key, sizeof key, "%s.template", item->section);
		result = find_template(&loader, key, item->template_name, &item->shading_template);
	}
	for (size_t i = 0; i < GZ_SCENE_REGIONS_MAX && result == GZ_OK; i++) {
		struct gz_scene_region *item = &settings->regions.items[i];
		char key[32];
		snprintf(key, sizeof key, "region %u.template", (unsigned)i + 1);
		result = find_template(&loader, key, item->template_name, &item->shading_template);
	}
	return result;
}

/* Whether the file exists and is a volume, a picture or the like. */
static bool is_other_than_scene(const char *path)
{
	const enum gz_file_kind kind = gz_file_kind_of(path);
	return kind != GZ_FILE_SCENE && kind != GZ_FILE_OTHER && access(path, F_OK) == 0;
}

enum gz_result gz_scene_load(const char *path, const struct gz_loading *loading,
			     const struct gz_log *log, struct gz_scene *out_scene)
{
	const struct gz_scene_source source = { .path = path };
	if (is_other_than_scene(path)) {
		gz_err(log,
		       "%s: not a scene; open it in gazeview, save a scene of it (Ctrl+S) and name "
		       "that",
		       path);
		return GZ_ERR_FORMAT;
	}
	return gz_scene_load_changed(&source, loading, log, out_scene);
}

enum gz_result gz_scene_load_changed(const struct gz_scene_source *source,
				     const struct gz_loading *loading, const struct gz_log *log,
				     struct gz_scene *out_scene)
{
	struct gz_scene_settings settings;
	struct gz_scene_parts parts = { .name = source->path, .settings = &settings };
	const enum gz_result result = gz_scene_read(source, log, &settings, &parts.has_display);
	return result == GZ_OK ? gz_scene_load_parts(&parts, loading, log, out_scene) : result;
}

enum gz_result gz_transfer_of_volume(const struct gz_volume *volume, int choice,
				     const struct gz_log *log, struct gz_transfer *out_transfer)
{
	struct gz_histogram histogram;
	const enum gz_result result =
		gz_histogram_count(volume, GZ_HISTOGRAM_BINS_LEAST, 0, NULL, log, &histogram);
	if (result != GZ_OK)
		return result;
	const enum gz_transfer_preset preset =
		choice > 0 ? (enum gz_transfer_preset)(choice - 1)
			   : gz_transfer_preset_for(&histogram, volume->modality);
	gz_transfer_preset_make(preset, &histogram, volume, out_transfer);
	return GZ_OK;
}

/* Warn of a transfer function for other data, with which nothing is seen. */
static void check_transfer(const struct scene_loader *loader, const struct gz_scene *scene)
{
	const struct gz_volume *volume = &scene->volume;
	const double ends[2] = { volume->slope * volume->stored_min + volume->intercept,
				 volume->slope * volume->stored_max + volume->intercept };
	const double least = fmin(ends[0], ends[1]), greatest = fmax(ends[0], ends[1]);
	if (!scene->transfer.has_range || volume->colour != GZ_COLOUR_NONE ||
	    gz_transfer_shows(&scene->transfer, least, greatest))
		return;
	gz_warn(loader->log,
		"%s: the transfer function shows nothing of this volume: it is for values from %g "
		"to %g, and the data are %g to %g; edit it (E in gazeview), or leave it out",
		loader->name, scene->transfer.range[0], scene->transfer.range[1], least, greatest);
}

enum gz_result gz_scene_load_parts(const struct gz_scene_parts *parts,
				   const struct gz_loading *loading, const struct gz_log *log,
				   struct gz_scene *out_scene)
{
	struct gz_scene scene = { .settings = *parts->settings, .has_display = parts->has_display };
	const struct scene_loader loader = {
		.name = parts->name,
		.loading = loading,
		.log = log,
		.settings = &scene.settings,
		.particle_frame = &scene.settings.particle_frame,
	};
	const bool given = parts->transfer || gz_scene_transfer_name(&scene.settings)[0];
	enum gz_result result = gz_scene_load_table(parts->name, log, &scene.settings.foveation);
	if (result == GZ_OK)
		result = gz_scene_find_cube(parts->name, log, &scene.settings.rays.environment);
	if (result == GZ_OK)
		result = gz_scene_find_templates(parts->name, log, &scene.settings);
	if (parts->transfer)
		scene.transfer = *parts->transfer;
	else if (result == GZ_OK)
		result = load_named_transfer(&loader, &scene.transfer);
	if (result == GZ_OK)
		result = load_meshes(&loader, &scene);
	if (result == GZ_OK)
		result = load_labels(&loader, &scene);
	if (result == GZ_OK)
		result = note_inputs(&loader, &scene);
	if (result == GZ_OK)
		result = gz_scene_has_volume(&scene.settings) ? load_volume(&loader, &scene.volume)
							      : make_empty_space(&loader, &scene);
	if (result == GZ_OK && !given && !parts->volume_alone)
		result = gz_transfer_of_volume(&scene.volume, scene.settings.transfer_preset, log,
					       &scene.transfer);
	if (result == GZ_OK && given && gz_scene_has_volume(&scene.settings))
		check_transfer(&loader, &scene);
	if (result != GZ_OK) {
		gz_scene_free(&scene);
		return result;
	}
	*out_scene = scene;
	return GZ_OK;
}

enum gz_result gz_scene_try(const struct gz_scene_source *source, const struct gz_log *log,
			    struct gz_scene_settings *out_settings)
{
	struct gz_scene_settings settings;
	struct gz_transfer transfer;
	const struct scene_loader loader = { .name = source->path,
					     .log = log,
					     .settings = &settings };
	char path[GZ_PATH_SIZE];
	bool has_display;
	enum gz_result result = gz_scene_read(source, log, &settings, &has_display);
	if (result == GZ_OK)
		result = gz_scene_load_table(source->path, log, &settings.foveation);
	if (result == GZ_OK)
		result = gz_scene_find_cube(source->path, log, &settings.rays.environment);
	if (result == GZ_OK)
		result = gz_scene_find_templates(source->path, log, &settings);
	if (result == GZ_OK)
		result = load_named_transfer(&loader, &transfer);
	if (result == GZ_OK && !settings.volume_procedural && gz_scene_has_volume(&settings))
		result = find_volume(&loader, path);
	for (size_t i = 0; i < settings.objects.count && result == GZ_OK; i++) {
		const struct gz_scene_object *item = &settings.objects.items[i];
		const char *file = item->mesh[0] ? item->mesh : item->labels;
		if (file[0])
			result = find_data_file(&loader, item->section, file, path);
	}
	if (result == GZ_OK && settings.labels.names[0])
		result = find_named_file(&loader, "labels.names", settings.labels.names, path);
	if (result == GZ_OK)
		*out_settings = settings;
	return result;
}

/* Append an object to a list of at most @p room. */
static void list_object(const struct gz_object *object, struct gz_object *out_objects, size_t room,
			size_t *count)
{
	if (*count < room)
		out_objects[*count] = *object;
	++*count;
}

/* What the settings say of how an object is shown. */
static void style_object(const struct gz_scene_object *item, struct gz_object *object)
{
	object->style = &item->style;
	object->shading_template = item->template_name[0] ? &item->shading_template : NULL;
}

/* The same of a region with a way of its own. */
static void style_region(const struct gz_scene_region *region, struct gz_object *object)
{
	object->style = &region->style;
	object->shading_template = region->template_name[0] ? &region->shading_template : NULL;
}

/* Append the volume once for each technique that shows it. The first has the id 1. */
static void list_volumes(const struct gz_scene *scene, struct gz_object *out_objects, size_t room,
			 size_t *count)
{
	const struct gz_scene_settings *settings = &scene->settings;
	const struct gz_scene_object *shown = gz_scene_volume_object(settings);
	struct gz_object object = {
		.technique = gz_scene_technique(settings, shown),
		.id = 1,
		.volume = &scene->volume,
		.transfer = &scene->transfer,
	};
	if (!shown && gz_scene_has_volume(settings))
		list_object(&object, out_objects, room, count);
	for (size_t i = 0; i < settings->objects.count; i++) {
		const struct gz_scene_object *item = &settings->objects.items[i];
		if (!gz_scene_shows_volume(item) || !item->visible)
			continue;
		/* render.technique may draw all of them by one. */
		if (*count > 0 && settings->technique > 0)
			continue;
		object.technique = gz_scene_technique(settings, item);
		object.id = item == shown ? 1 : (uint32_t)i + 2;
		object.name = gz_scene_object_name(item);
		style_object(item, &object);
		list_object(&object, out_objects, room, count);
	}
}

uint32_t gz_scene_label_id(size_t object, size_t label)
{
	return (uint32_t)(label + 1) << 8 | (uint32_t)(object + 2);
}

const struct gz_label_surface *gz_scene_label_of(const struct gz_scene *scene, uint32_t id)
{
	const size_t place = id >> 8, object = id & 255;
	if (!scene->labels || place < 1 || object < 2 ||
	    object - 2 >= scene->settings.objects.count)
		return NULL;
	const struct gz_label_surfaces *labels = &scene->labels[object - 2];
	return place <= labels->count ? &labels->items[place - 1] : NULL;
}

/* Append each label of an object. */
static void list_labels(const struct gz_scene *scene, size_t index, struct gz_object *out_objects,
			size_t room, size_t *count)
{
	const struct gz_scene_object *item = &scene->settings.objects.items[index];
	const struct gz_label_surfaces *labels = &scene->labels[index];
	for (size_t i = 0; item->visible && i < labels->count; i++) {
		const struct gz_scene_region *region =
			gz_scene_region_of(&scene->settings.regions, item, labels->items[i].number);
		if (region && !region->visible)
			continue;
		struct gz_object object = {
			.technique = gz_scene_technique(&scene->settings, item),
			.id = gz_scene_label_id(index, i),
			.volume = &scene->volume,
			.transfer = &scene->transfer,
			.mesh = &labels->items[i].mesh,
			.colour = labels->items[i].colour,
			.name = labels->items[i].name[0] ? labels->items[i].name : NULL,
			.input = scene->inputs ? scene->inputs[index] : NULL,
		};
		style_object(item, &object);
		if (region)
			style_region(region, &object);
		list_object(&object, out_objects, room, count);
	}
}

size_t gz_scene_list_objects(const struct gz_scene *scene, struct gz_object *out_objects,
			     size_t room)
{
	const struct gz_scene_settings *settings = &scene->settings;
	size_t count = 0;
	list_volumes(scene, out_objects, room, &count);
	for (size_t i = 0; scene->meshes && i < settings->objects.count; i++) {
		const struct gz_scene_object *item = &settings->objects.items[i];
		struct gz_object object = {
			.technique = gz_scene_technique(settings, item),
			.id = (uint32_t)i + 2,
			.volume = &scene->volume,
			.transfer = &scene->transfer,
			.mesh = &scene->meshes[i],
			.name = gz_scene_object_name(item),
			.input = scene->inputs ? scene->inputs[i] : NULL,
		};
		style_object(item, &object);
		if (item->mesh[0] && item->visible)
			list_object(&object, out_objects, room, &count);
	}
	for (size_t i = 0; scene->labels && i < settings->objects.count; i++)
		list_labels(scene, i, out_objects, room, &count);
	return count;
}

void gz_scene_free(struct gz_scene *scene)
{
	free_meshes(scene);
	gz_volume_free(&scene->volume);
	*scene = (struct gz_scene) { 0 };
}
