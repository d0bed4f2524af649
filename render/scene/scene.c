#include "render/scene/scene.h"

#include <stdlib.h>
#include <string.h>

#include "render/plan/method.h"
#include "render/scene/scene_files.h"
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

/* The path of the volume's file. */
static enum gz_result find_volume(const struct scene_loader *loader, char out_path[GZ_PATH_SIZE])
{
	const struct gz_scene_object *object = gz_scene_volume_object(loader->settings);
	return object ? find_named_file(loader, object->section, object->volume, out_path)
		      : find_named_file(loader, "volume.file", loader->settings->volume_file,
					out_path);
}

static enum gz_result make_procedural(const struct scene_loader *loader,
				      struct gz_volume *out_volume)
{
	static const int preset[3] = { PROCEDURAL_EDGE, PROCEDURAL_EDGE, PROCEDURAL_EDGE };
	const struct gz_scene_settings *settings = loader->settings;
	const int *dims = settings->dims[0] > 0 ? settings->dims : preset;
	const enum gz_procedural which = (enum gz_procedural)(settings->volume_procedural - 1);
	enum gz_voxel_type type;
	if (!gz_scene_made_type(settings, &type))
		return GZ_ERR_INVAL; /* cannot happen: refused when the settings were read */
	return gz_volume_generate(
		&(struct gz_procedural_request) { which, dims, settings->spacing, type },
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
	return gz_volume_load(path, settings->dims[0] > 0 ? &raw : NULL, &loading, loader->log,
			      out_volume);
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
		.name = which->name, .loading = &of_series, .log = log, .settings = &settings
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
				     : gz_scene_volume_object(loader->settings)->section,
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

enum gz_result gz_scene_load(const char *path, const struct gz_loading *loading,
			     const struct gz_log *log, struct gz_scene *out_scene)
{
	const struct gz_scene_source source = { .path = path };
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

enum gz_result gz_transfer_of_volume(const struct gz_volume *volume, const struct gz_log *log,
				     struct gz_transfer *out_transfer)
{
	struct gz_histogram histogram;
	const enum gz_result result =
		gz_histogram_count(volume, GZ_HISTOGRAM_BINS_LEAST, 0, NULL, log, &histogram);
	if (result == GZ_OK)
		gz_transfer_preset_make(GZ_PRESET_DEFAULT, &histogram, volume, out_transfer);
	return result;
}

enum gz_result gz_scene_load_parts(const struct gz_scene_parts *parts,
				   const struct gz_loading *loading, const struct gz_log *log,
				   struct gz_scene *out_scene)
{
	struct gz_scene scene = { .settings = *parts->settings, .has_display = parts->has_display };
	const struct scene_loader loader = {
		.name = parts->name, .loading = loading, .log = log, .settings = &scene.settings
	};
	const bool given = parts->transfer || gz_scene_transfer_name(&scene.settings)[0];
	enum gz_result result = gz_scene_load_table(parts->name, log, &scene.settings.foveation);
	if (parts->transfer)
		scene.transfer = *parts->transfer;
	else if (result == GZ_OK)
		result = load_named_transfer(&loader, &scene.transfer);
	if (result == GZ_OK)
		result = load_volume(&loader, &scene.volume);
	if (result == GZ_OK && !given && !parts->volume_alone)
		result = gz_transfer_of_volume(&scene.volume, log, &scene.transfer);
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
	char volume[GZ_PATH_SIZE];
	bool has_display;
	enum gz_result result = gz_scene_read(source, log, &settings, &has_display);
	if (result == GZ_OK)
		result = gz_scene_load_table(source->path, log, &settings.foveation);
	if (result == GZ_OK)
		result = load_named_transfer(&loader, &transfer);
	if (result == GZ_OK && !settings.volume_procedural)
		result = find_volume(&loader, volume);
	if (result == GZ_OK)
		*out_settings = settings;
	return result;
}

size_t gz_scene_list_objects(const struct gz_scene *scene, struct gz_object *out_objects,
			     size_t room)
{
	const struct gz_scene_object *object = gz_scene_volume_object(&scene->settings);
	const bool visible = !object || object->visible;
	if (visible && room > 0)
		out_objects[0] = (struct gz_object) {
			.technique = gz_scene_technique(&scene->settings, object),
			.id = 1,
			.volume = &scene->volume,
			.transfer = &scene->transfer,
		};
	return visible;
}

void gz_scene_free(struct gz_scene *scene)
{
	gz_volume_free(&scene->volume);
	*scene = (struct gz_scene) { 0 };
}
