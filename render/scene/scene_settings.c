#include "render/scene/scene_settings.h"

#include <string.h>

#include "render/data/voxel_colour.h"
#include "render/scene/techniques.h"
#include "render/transfer/transfer_presets.h"

#define GZ_LOG_MODULE "scene"

_Static_assert(GZ_SCENE_LIGHT == GZ_SCENE_RAYS + 1 && GZ_SCENE_CLIP == GZ_SCENE_RAYS + 2 &&
		       GZ_SCENE_ENVIRONMENT == GZ_SCENE_RAYS + 3 &&
		       GZ_SCENE_ISOSURFACE == GZ_SCENE_RAYS + 4 &&
		       GZ_SCENE_SLICES == GZ_SCENE_RAYS + 5 &&
		       GZ_SCENE_ILLUSTRATION == GZ_SCENE_RAYS + 6 &&
		       GZ_SCENE_SHADING_MAP == GZ_SCENE_RAYS + 8 && GZ_RAY_BINDINGS == 9,
	       "gz_ray_params_bind() fills nine tables");
_Static_assert(sizeof(enum gz_projection) == sizeof(int), "a CHOICE option writes an int");

static const char *const procedural_names[] = { "none",      "shells", "supernova",
						"chameleon", "splash", NULL };
static const char *const endian_names[] = { "little", "big", NULL };
static const char *const projection_names[] = { "perspective", "orthographic", NULL };

#define AT(field) offsetof(struct gz_scene_settings, field)

static const struct gz_option volume_options[] = {
	{ "volume.file", GZ_OPTION_STRING, AT(volume_file), .max = GZ_PATH_SIZE, .preset = "",
	  .help = "volume: .nii, .nii.gz, .nrrd, .nhdr, .mhd, .mha, DICOM (.dcm or a folder), "
		  ".gzb, raw data, or particles (.particles, .bgeo, .vtk, .ply, .xyz); searched "
		  "beside the scene, then under $GAZECAST_DATA" },
	{ "volume.source", GZ_OPTION_STRING, AT(volume_source), .max = GZ_SCENE_SOURCE_SIZE,
	  .preset = "",
	  .help = "where to get the scene's data: a sentence that is shown if they are missing" },
	{ "volume.series", GZ_OPTION_STRING, AT(volume_series), .max = GZ_SERIES_SIZE, .preset = "",
	  .help = "UID of the series of a DICOM folder; without it there must be only one" },
	{ "volume.procedural", GZ_OPTION_CHOICE, AT(volume_procedural), .choices = procedural_names,
	  .preset = "none", .help = "volume computed by a formula; needs no file" },
	{ "volume.dims", GZ_OPTION_INT, AT(dims), 1, GZ_VOLUME_DIM_MAX, .count = 3,
	  .help = "voxels along x y z; raw files and procedural volumes" },
	{ "volume.type", GZ_OPTION_CHOICE, AT(type), .choices = gz_raw_type_names,
	  .help = "voxel type; raw files, and uint8, uint16 or float32 for procedural volumes" },
	{ "volume.endian", GZ_OPTION_CHOICE, AT(endian), .choices = endian_names,
	  .preset = "little", .help = "byte order; raw files" },
	{ "volume.spacing", GZ_OPTION_DOUBLE, AT(spacing), 0, 1e9, .count = 3, .preset = "0 0 0",
	  .help = "voxel spacing x y z, mm; raw files and procedural volumes; 0: not known, and 1 "
		  "is assumed" },
	{ "volume.channels", GZ_OPTION_INT, AT(channels), 1, 4, .preset = "1",
	  .help = "numbers of a voxel: 1 is its value, 3 red, green and blue, 4 alpha too; raw "
		  "files" },
	{ "volume.opacity", GZ_OPTION_CHOICE, AT(opacity), .choices = gz_opacity_source_names,
	  .preset = "auto",
	  .help = "what the transfer function takes as the value of a coloured voxel; auto is "
		  "alpha "
		  "if there is one that varies, else luminance" },
	{ "volume.resample", GZ_OPTION_CHOICE, AT(resample), .choices = gz_resampling_names,
	  .preset = "off",
	  .help = "DICOM slices that are missing, lie unevenly or are shifted by a tilted gantry: "
		  "interpolate linearly, or take the nearest (labels)" },
	{ "volume.time_point", GZ_OPTION_INT, AT(time_point), 1, GZ_TIME_POINTS_MAX, .preset = "1",
	  .help = "which volume of a series is shown, from 1; NIfTI's fourth dimension, NRRD's "
		  "fourth axis" },
	{ "volume.memory_mib", GZ_OPTION_INT, AT(memory_mib), 0, 1 << 20, .preset = "0",
	  .help = "memory for the bricks that are shown, MiB; 0 = a quarter of the machine's" },
};

static const struct gz_option transfer_options[] = {
	{ "transfer.file", GZ_OPTION_STRING, AT(transfer_file), .max = GZ_PATH_SIZE, .preset = "",
	  .help = "transfer function, .tf; searched as volume.file is; without it one is made for "
		  "the volume" },
	{ "transfer.preset", GZ_OPTION_CHOICE, AT(transfer_preset),
	  .choices = gz_transfer_preset_choices, .preset = "auto",
	  .help = "the transfer function that is made where there is no file; auto: ct_tissue for "
		  "Hounsfield units, else tissue" },
	{ "transfer.also", GZ_OPTION_STRING, AT(transfer_also), .max = GZ_PATH_SIZE, .preset = "",
	  .help = "further transfer functions for gazebench, separated by blanks" },
};

static const struct gz_option camera_options[] = {
	{ "camera.eye", GZ_OPTION_DOUBLE, AT(camera.eye), -1e6, 1e6, .count = 3, .preset = "0 -2 0",
	  .help = "position of the eye; the volume's longest edge is 1, its centre 0 0 0" },
	{ "camera.look_at", GZ_OPTION_DOUBLE, AT(camera.look_at), -1e6, 1e6, .count = 3,
	  .preset = "0 0 0", .help = "point in the picture's centre" },
	{ "camera.up", GZ_OPTION_DOUBLE, AT(camera.up), -1e6, 1e6, .count = 3, .preset = "0 0 1",
	  .help = "direction that points up in the picture" },
	{ "camera.fov_deg", GZ_OPTION_DOUBLE, AT(camera.fov_deg), 0.01, 179, .preset = "40",
	  .help = "vertical field of view, degrees; perspective" },
	{ "camera.height", GZ_OPTION_DOUBLE, AT(camera.height), 1e-6, 1e6, .preset = "1.5",
	  .help = "height of the view, world units; orthographic" },
	{ "camera.projection", GZ_OPTION_CHOICE, AT(camera.projection), .choices = projection_names,
	  .preset = "perspective", .help = "projection of the camera" },
};

static const struct gz_option image_options[] = {
	{ "render.technique", GZ_OPTION_CHOICE, AT(technique), .choices = gz_technique_choices,
	  .preset = "auto",
	  .help = "how everything is drawn; auto: each object by its own technique, a [volume] by "
		  "raycast" },
	{ "render.image_sampling_rate", GZ_OPTION_DOUBLE, AT(image_sampling_rate), 0.1, 4,
	  .preset = "1", .help = "rays per pixel edge" },
};

static const struct gz_option display_options[] = {
	{ "display.px", GZ_OPTION_INT, AT(display.px), 1, 32768, .count = 2,
	  .help = "width and height of the display, px" },
	{ "display.mm", GZ_OPTION_DOUBLE, AT(display.mm), 1, 100000, .count = 2,
	  .help = "width and height of the display, mm" },
	{ "display.distance_mm", GZ_OPTION_DOUBLE, AT(display.distance_mm), 1, 100000,
	  .help = "distance from the eye to the display's centre, mm" },
};

#define BIND(table)                                                     \
	{                                                               \
		table, sizeof(table) / sizeof(table)[0], settings, NULL \
	}

void gz_scene_bind(struct gz_scene_settings *settings,
		   struct gz_option_binding out_bindings[GZ_SCENE_TABLE_COUNT])
{
	const struct gz_option_binding bindings[GZ_SCENE_TABLE_COUNT] = {
		[GZ_SCENE_VOLUME] = BIND(volume_options),
		[GZ_SCENE_PARTICLES] = { gz_particle_grid_options, GZ_PARTICLE_GRID_OPTIONS,
					 &settings->particles, NULL },
		[GZ_SCENE_LABELS] = { gz_label_options, gz_label_option_count, &settings->labels,
				      NULL },
		[GZ_SCENE_TRANSFER] = BIND(transfer_options),
		[GZ_SCENE_CAMERA] = BIND(camera_options),
		[GZ_SCENE_IMAGE] = BIND(image_options),
		[GZ_SCENE_DISPLAY] = BIND(display_options),
		[GZ_SCENE_FOVEATION] = { gz_foveation_options, gz_foveation_option_count,
					 &settings->foveation, NULL },
		[GZ_SCENE_ATTENTION] = { gz_attention_options, gz_attention_option_count,
					 &settings->attention, NULL },
		[GZ_SCENE_TEMPORAL] = { gz_temporal_options, gz_temporal_option_count,
					&settings->temporal, NULL },
		[GZ_SCENE_VIEW] = { gz_view_setting_options, gz_view_setting_option_count,
				    &settings->view, NULL },
	};
	memcpy(out_bindings, bindings, sizeof bindings);
	gz_ray_params_bind(&settings->rays, &out_bindings[GZ_SCENE_RAYS]);
}

static enum gz_result preset_tables(const struct gz_option_binding bindings[GZ_SCENE_TABLE_COUNT])
{
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < GZ_SCENE_TABLE_COUNT && result == GZ_OK; i++)
		result = gz_options_preset(&bindings[i]);
	return result;
}

enum gz_result gz_scene_settings_preset(struct gz_scene_settings *out_settings)
{
	struct gz_option_binding bindings[GZ_SCENE_TABLE_COUNT];
	*out_settings = (struct gz_scene_settings) { 0 };
	gz_scene_bind(out_settings, bindings);
	gz_scene_regions_preset(&out_settings->regions);
	return preset_tables(bindings);
}

bool gz_scene_settings_same(const struct gz_scene_settings *a, const struct gz_scene_settings *b)
{
	struct gz_option_binding of_a[GZ_SCENE_TABLE_COUNT], of_b[GZ_SCENE_TABLE_COUNT];
	/* Bindings can set what they are bound to; here they only read. */
	gz_scene_bind((struct gz_scene_settings *)a, of_a);
	gz_scene_bind((struct gz_scene_settings *)b, of_b);
	for (size_t i = 0; i < GZ_SCENE_TABLE_COUNT; i++)
		if (!gz_options_same(of_a[i].options, of_a[i].count, of_a[i].target,
				     of_b[i].target))
			return false;
	return gz_scene_objects_same(&a->objects, &b->objects) &&
	       gz_scene_regions_same(&a->regions, &b->regions) &&
	       gz_spacing_table_same(&a->foveation.table, &b->foveation.table);
}

bool gz_scene_show_as(const struct gz_scene_settings *wanted, struct gz_scene_settings *settings)
{
	const struct gz_option *shown =
		gz_scene_object_options + GZ_SCENE_OBJECT_OPTIONS - GZ_SCENE_OBJECT_SHOWN_OPTIONS;
	bool changed = !gz_scene_regions_same(&wanted->regions, &settings->regions);
	if (changed)
		settings->regions = wanted->regions;
	for (size_t i = 0; i < settings->objects.count && i < wanted->objects.count; i++) {
		const struct gz_scene_object *from = &wanted->objects.items[i];
		struct gz_scene_object *to = &settings->objects.items[i];
		if (gz_options_same(shown, GZ_SCENE_OBJECT_SHOWN_OPTIONS, from, to))
			continue;
		to->visible = from->visible;
		to->style = from->style;
		memcpy(to->template_name, from->template_name, sizeof to->template_name);
		to->shading_template = from->shading_template;
		changed = true;
	}
	return changed;
}

bool gz_scene_templates_same(const struct gz_scene_settings *a, const struct gz_scene_settings *b)
{
	bool same =
		a->objects.count == b->objects.count &&
		strcmp(a->rays.illustration.template_name, b->rays.illustration.template_name) == 0;
	for (size_t i = 0; i < a->objects.count && same; i++)
		same = strcmp(a->objects.items[i].template_name,
			      b->objects.items[i].template_name) == 0;
	for (size_t i = 0; i < GZ_SCENE_REGIONS_MAX && same; i++)
		same = strcmp(a->regions.items[i].template_name,
			      b->regions.items[i].template_name) == 0;
	return same;
}

int gz_scene_procedural_type(int volume_procedural)
{
	static const int raw[GZ_VOXEL_TYPE_COUNT] = {
		[GZ_VOXEL_U8] = GZ_RAW_UINT8,
		[GZ_VOXEL_U16] = GZ_RAW_UINT16,
		[GZ_VOXEL_F32] = GZ_RAW_FLOAT32,
	};
	return raw[gz_procedural_type((enum gz_procedural)(volume_procedural - 1))];
}

bool gz_scene_made_type(const struct gz_scene_settings *settings, enum gz_voxel_type *out_type)
{
	*out_type = settings->type == GZ_RAW_UINT8    ? GZ_VOXEL_U8
		    : settings->type == GZ_RAW_UINT16 ? GZ_VOXEL_U16
						      : GZ_VOXEL_F32;
	return *out_type != GZ_VOXEL_F32 || settings->type == GZ_RAW_FLOAT32;
}

bool gz_scene_shows_volume(const struct gz_scene_object *object)
{
	return object->volume[0] || object->particles[0];
}

const struct gz_scene_object *gz_scene_volume_object(const struct gz_scene_settings *settings)
{
	for (size_t i = 0; i < settings->objects.count; i++)
		if (gz_scene_shows_volume(&settings->objects.items[i]))
			return &settings->objects.items[i];
	return NULL;
}

const struct gz_scene_object *gz_scene_transfer_object(const struct gz_scene_settings *settings)
{
	for (size_t i = 0; i < settings->objects.count; i++)
		if (settings->objects.items[i].transfer[0])
			return &settings->objects.items[i];
	return NULL;
}

const struct gz_technique *gz_scene_technique(const struct gz_scene_settings *settings,
					      const struct gz_scene_object *object)
{
	if (settings->technique > 0)
		return gz_techniques[settings->technique - 1];
	return gz_techniques[object ? object->technique : 0];
}

bool gz_scene_has_volume(const struct gz_scene_settings *settings)
{
	return settings->volume_procedural || settings->volume_file[0] ||
	       gz_scene_volume_object(settings);
}

const struct gz_technique *gz_scene_main_technique(const struct gz_scene_settings *settings)
{
	const struct gz_scene_object *object = gz_scene_volume_object(settings);
	if (!gz_scene_has_volume(settings) && settings->objects.count > 0)
		object = &settings->objects.items[0];
	return gz_scene_technique(settings, object);
}

bool gz_scene_draws_by(const struct gz_scene_settings *settings,
		       const struct gz_technique *technique)
{
	bool draws = gz_scene_main_technique(settings) == technique;
	for (size_t i = 0; i < settings->objects.count; i++) {
		const struct gz_scene_object *object = &settings->objects.items[i];
		draws = draws ||
			(object->visible && gz_scene_technique(settings, object) == technique);
	}
	return draws;
}

const char *gz_scene_transfer_name(const struct gz_scene_settings *settings)
{
	const struct gz_scene_object *object = gz_scene_transfer_object(settings);
	return settings->transfer_file[0] || !object ? settings->transfer_file : object->transfer;
}

/* render.technique must show what every object has. */
static enum gz_result check_technique(const struct gz_scene_settings *settings, const char *name,
				      const struct gz_log *log)
{
	for (size_t i = 0; settings->technique > 0 && i < settings->objects.count; i++) {
		const struct gz_scene_object *object = &settings->objects.items[i];
		const struct gz_technique *technique = gz_scene_technique(settings, object);
		if (technique->shows & gz_scene_object_kinds(object))
			continue;
		gz_err(log, "%s: render.technique: %s does not show what [%s] has; set it to auto",
		       name, technique->name, object->section);
		return GZ_ERR_FORMAT;
	}
	return GZ_OK;
}

static bool distances_valid(const struct gz_scene_settings *settings, const char *name,
			    const struct gz_log *log)
{
	struct gz_distances distances;
	if (gz_distances_parse(settings->view.distances, &distances))
		return true;
	gz_err(log,
	       "%s: view.distances: write six numbers from 0 to 1 a line, x y z of either end; up "
	       "to %d lines",
	       name, GZ_DISTANCES_MAX);
	return false;
}

static const char *what_is_invalid(const struct gz_ray_params *rays)
{
	const struct gz_clip_region *clip = &rays->clip;
	for (int axis = 0; axis < 3; axis++)
		if (!(clip->least[axis] < clip->greatest[axis]))
			return "clip.least must be below clip.greatest along each axis";
	return gz_clip_region_valid(clip) ? "light.direction must not be 0 0 0"
					  : "clip.normal must not be 0 0 0";
}

enum gz_result gz_scene_settings_check(const struct gz_scene_settings *settings, const char *name,
				       const struct gz_log *log)
{
	struct gz_ray_frame rays;
	if (gz_camera_rays(&settings->camera, 1, 1, &rays) != GZ_OK) {
		gz_err(log, "%s: camera.eye: is where camera.look_at is; move one of them", name);
		return GZ_ERR_FORMAT;
	}
	if (gz_saved_views_check(settings->view.saved, name, log) != GZ_OK ||
	    !distances_valid(settings, name, log) || check_technique(settings, name, log) != GZ_OK)
		return GZ_ERR_FORMAT;
	if (gz_ray_params_valid(&settings->rays)) {
		if (!gz_camera_up_counts(&settings->camera))
			gz_warn(log,
				"%s: camera.up: 0 0 0 or along the view, so nothing is up; the "
				"axis "
				"farthest from the view is used instead",
				name);
		return GZ_OK;
	}
	gz_err(log, "%s: %s", name, what_is_invalid(&settings->rays));
	return GZ_ERR_FORMAT;
}

/* Most options of a table of which the reader must know whether they are given. */
enum { GIVEN_MAX = 13 };

_Static_assert(sizeof volume_options / sizeof volume_options[0] <= GIVEN_MAX &&
		       sizeof camera_options / sizeof camera_options[0] <= GIVEN_MAX,
	       "a flag for each option");

/* A scene while it is read. */
struct scene_reader {
	const char *name;
	const struct gz_log *log;
	struct gz_scene_settings *settings;
	struct gz_option_binding
		bindings[GZ_SCENE_TABLE_COUNT + GZ_SCENE_OBJECTS_MAX + GZ_SCENE_REGIONS_MAX];
	size_t binding_count;
	struct gz_scene_object_table object_tables[GZ_SCENE_OBJECTS_MAX];
	struct gz_scene_region_table region_tables[GZ_SCENE_REGIONS_MAX];
	bool given[GZ_SCENE_DISPLAY + 1][GIVEN_MAX];
};

static enum gz_result refuse_key(const struct scene_reader *reader, const char *key,
				 const char *what)
{
	gz_err(reader->log, "%s: %s: %s", reader->name, key, what);
	return GZ_ERR_FORMAT;
}

/* Preset the settings and bind them, with a table for each object of the text; without a text, of
 * the file of the reader's name. */
static enum gz_result bind_reader(struct scene_reader *reader, const char *text, size_t size)
{
	struct gz_scene_settings *settings = reader->settings;
	*settings = (struct gz_scene_settings) { 0 };
	gz_scene_regions_preset(&settings->regions);
	gz_scene_bind(settings, reader->bindings);
	for (size_t i = GZ_SCENE_VOLUME; i <= GZ_SCENE_DISPLAY; i++)
		reader->bindings[i].given = reader->given[i];
	enum gz_result result = preset_tables(reader->bindings);
	if (result == GZ_OK)
		result = gz_scene_objects_scan(reader->name, text, size, reader->log,
					       &settings->objects);
	reader->binding_count = GZ_SCENE_TABLE_COUNT;
	for (size_t i = 0; i < settings->objects.count && result == GZ_OK; i++)
		reader->bindings[reader->binding_count++] = gz_scene_object_bind(
			&settings->objects.items[i], &reader->object_tables[i]);
	for (size_t i = 0; i < GZ_SCENE_REGIONS_MAX; i++)
		reader->bindings[reader->binding_count++] = gz_scene_region_bind(
			&settings->regions.items[i], i, &reader->region_tables[i]);
	return result;
}

/* Whether the text gives a key of the tables up to GZ_SCENE_DISPLAY. */
static bool key_given(const struct scene_reader *reader, const char *key)
{
	size_t table = 0;
	const struct gz_option *option =
		gz_options_find(reader->bindings, GZ_SCENE_DISPLAY + 1, key, &table);
	return option && reader->given[table][option - reader->bindings[table].options];
}

static enum gz_result check_procedural(const struct scene_reader *reader)
{
	struct gz_scene_settings *settings = reader->settings;
	enum gz_voxel_type type;
	if (!key_given(reader, "volume.type"))
		settings->type = gz_scene_procedural_type(settings->volume_procedural);
	if (key_given(reader, "volume.endian") || key_given(reader, "volume.channels"))
		return refuse_key(
			reader, "volume.procedural",
			"takes dims, type and spacing only; leave out endian and channels");
	if (!gz_scene_made_type(settings, &type))
		return refuse_key(reader, "volume.type",
				  "a procedural volume has uint8, uint16 or float32");
	return GZ_OK;
}

/* The layout of a raw file is given as a whole or not at all. */
static enum gz_result check_raw_layout(const struct scene_reader *reader)
{
	const bool dims = key_given(reader, "volume.dims"), type = key_given(reader, "volume.type");
	const bool any = dims || type || key_given(reader, "volume.endian") ||
			 key_given(reader, "volume.spacing") ||
			 key_given(reader, "volume.channels");
	if (!any || (dims && type))
		return GZ_OK;
	return refuse_key(reader, "volume.dims",
			  "a raw file needs both dims and type; other files none of them");
}

static enum gz_result check_volume_keys(const struct scene_reader *reader)
{
	const struct gz_scene_settings *settings = reader->settings;
	const bool file = settings->volume_file[0] != '\0';
	if (file && settings->volume_procedural)
		return refuse_key(reader, "volume.file", "given with volume.procedural; keep one");
	if (settings->volume_procedural)
		return check_procedural(reader);
	if (!file && settings->objects.count == 0)
		return refuse_key(reader, "volume.file",
				  "not given; name a volume, or set volume.procedural");
	return check_raw_layout(reader);
}

/* Whether two objects show the same data. */
static bool is_same_volume(const struct gz_scene_object *a, const struct gz_scene_object *b)
{
	return strcmp(a->volume, b->volume) == 0 && strcmp(a->particles, b->particles) == 0;
}

/* Refuse an object that shows the volume of an earlier one, unless by another technique. */
static enum gz_result check_volume_again(const struct scene_reader *reader,
					 const struct gz_scene_object *object)
{
	const struct gz_scene_objects *objects = &reader->settings->objects;
	for (const struct gz_scene_object *other = objects->items; other < object; other++) {
		if (!gz_scene_shows_volume(other))
			continue;
		if (other->technique == object->technique) {
			gz_err(reader->log,
			       "%s: [%s] and [%s] show one volume by one technique; remove one, or "
			       "give it another technique",
			       reader->name, other->section, object->section);
			return GZ_ERR_FORMAT;
		}
		if (other->transfer[0] && object->transfer[0] &&
		    strcmp(other->transfer, object->transfer) != 0) {
			gz_err(reader->log,
			       "%s: %s: transfer: not that of [%s], and a scene has one transfer "
			       "function; keep one",
			       reader->name, object->section, other->section);
			return GZ_ERR_FORMAT;
		}
	}
	return GZ_OK;
}

/* A scene has one volume, which several techniques may show. */
static enum gz_result check_one_volume(const struct scene_reader *reader)
{
	const struct gz_scene_settings *settings = reader->settings;
	const struct gz_scene_object *first = gz_scene_volume_object(settings);
	size_t volumes =
		(settings->volume_file[0] || settings->volume_procedural) + (first != NULL);
	for (size_t i = 0; i < settings->objects.count; i++) {
		const struct gz_scene_object *object = &settings->objects.items[i];
		volumes += gz_scene_shows_volume(object) && first && !is_same_volume(first, object);
	}
	if (volumes > 1) {
		gz_err(reader->log, "%s: %zu volumes are given, and a scene shows one; keep one",
		       reader->name, volumes);
		return GZ_ERR_FORMAT;
	}
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < settings->objects.count && result == GZ_OK; i++)
		if (gz_scene_shows_volume(&settings->objects.items[i]))
			result = check_volume_again(reader, &settings->objects.items[i]);
	return result;
}

static enum gz_result check_display_keys(const struct scene_reader *reader, bool *out_has_display)
{
	static const char *const keys[] = { "display.px", "display.mm", "display.distance_mm" };
	const char *missing = NULL;
	int given = 0;
	for (int i = 0; i < 3; i++) {
		const bool here = key_given(reader, keys[i]);
		given += here;
		missing = here || missing ? missing : keys[i];
	}
	*out_has_display = given == 3;
	if (given == 0 || given == 3)
		return GZ_OK;
	return refuse_key(reader, missing, "not given; px, mm and distance_mm go together");
}

/* Check the keys that depend on each other and on whether they are given. */
static enum gz_result check_given(const struct scene_reader *reader, bool *out_has_display)
{
	enum gz_result result = check_volume_keys(reader);
	if (result == GZ_OK)
		result = gz_scene_objects_check(&reader->settings->objects, reader->name,
						reader->log);
	if (result == GZ_OK)
		result = check_one_volume(reader);
	if (result == GZ_OK)
		result = check_display_keys(reader, out_has_display);
	return result;
}

enum gz_result gz_scene_parse(const char *name, const char *text, size_t size,
			      const struct gz_log *log, struct gz_scene_settings *out_settings,
			      bool *out_has_display)
{
	struct gz_scene_settings settings;
	struct scene_reader reader = { .name = name, .log = log, .settings = &settings };
	bool has_display = false;
	enum gz_result result = bind_reader(&reader, text, size);
	if (result == GZ_OK)
		result = gz_options_read_text(reader.bindings, reader.binding_count, name, text,
					      size, log);
	if (result == GZ_OK)
		result = check_given(&reader, &has_display);
	if (result == GZ_OK)
		result = gz_scene_settings_check(&settings, name, log);
	if (result != GZ_OK)
		return result;
	*out_settings = settings;
	*out_has_display = has_display;
	return GZ_OK;
}

enum gz_result gz_scene_read(const struct gz_scene_source *source, const struct gz_log *log,
			     struct gz_scene_settings *out_settings, bool *out_has_display)
{
	struct gz_scene_settings settings;
	struct scene_reader reader = { .name = source->path, .log = log, .settings = &settings };
	bool has_display = false;
	enum gz_result result = bind_reader(&reader, NULL, 0);
	if (result == GZ_OK)
		result = gz_options_read_file(reader.bindings, reader.binding_count, source->path,
					      log);
	if (result == GZ_OK)
		result = check_given(&reader, &has_display);
	if (result == GZ_OK && source->change)
		result = source->change(source->user, &settings);
	if (result == GZ_OK)
		result = gz_scene_settings_check(&settings, source->path, log);
	if (result != GZ_OK)
		return result;
	*out_settings = settings;
	*out_has_display = has_display;
	return GZ_OK;
}
