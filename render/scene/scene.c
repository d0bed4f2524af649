#include "render/scene/scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/plan/method.h"
#include "render/scene/scene_files.h"
#include "render/scene/techniques.h"
#include "render/transfer/histogram.h"
#include "render/transfer/transfer_presets.h"

#define GZ_LOG_MODULE "scene"

/* Edge of a procedural volume whose dims are not given, voxels. Chosen: made in a blink. */
#define PROCEDURAL_EDGE 128

_Static_assert(GZ_SCENE_LIGHT == GZ_SCENE_RAYS + 1 && GZ_SCENE_CLIP == GZ_SCENE_RAYS + 2 &&
		       GZ_RAY_BINDINGS == 3,
	       "gz_ray_params_bind() fills three tables");
_Static_assert(sizeof(enum gz_projection) == sizeof(int), "a CHOICE option writes an int");

static const char *const procedural_names[] = { "none", "shells", "supernova", "chameleon", NULL };
static const char *const endian_names[] = { "little", "big", NULL };
static const char *const projection_names[] = { "perspective", "orthographic", NULL };

#define AT(field) offsetof(struct gz_scene_settings, field)

/* In the order of scene_options. */
enum {
	VOLUME_FILE,
	VOLUME_PROCEDURAL,
	VOLUME_DIMS,
	VOLUME_TYPE,
	VOLUME_ENDIAN,
	VOLUME_SPACING,
	VOLUME_MEMORY,
	TRANSFER_FILE,
	TRANSFER_ALSO,
	CAMERA_EYE,
	CAMERA_LOOK_AT,
	CAMERA_UP,
	CAMERA_FOV,
	CAMERA_HEIGHT,
	CAMERA_PROJECTION,
	RENDER_IMAGE_SAMPLING,
	DISPLAY_PX,
	DISPLAY_MM,
	DISPLAY_DISTANCE,
	SCENE_OPTION_COUNT,
};

static const struct gz_option scene_options[SCENE_OPTION_COUNT] = {
	[VOLUME_FILE] = { .key = "volume.file",
			  .type = GZ_OPTION_STRING,
			  .offset = AT(volume_file),
			  .max = GZ_PATH_SIZE,
			  .preset = "",
			  .help = "volume: .nii, .nii.gz, .nrrd, .nhdr, .mhd, .mha, DICOM (.dcm or "
				  "a "
				  "folder), .gzb, or raw data; "
				  "beside the scene, else under $GAZECAST_DATA" },
	[VOLUME_PROCEDURAL] = { .key = "volume.procedural",
				.type = GZ_OPTION_CHOICE,
				.offset = AT(volume_procedural),
				.choices = procedural_names,
				.preset = "none",
				.help = "a volume made by a formula, no file" },
	[VOLUME_DIMS] = { .key = "volume.dims",
			  .type = GZ_OPTION_INT,
			  .offset = AT(dims),
			  .min = 1,
			  .max = GZ_VOLUME_DIM_MAX,
			  .count = 3,
			  .help = "voxels along x, y, z; for raw files and procedural volumes" },
	[VOLUME_TYPE] = { .key = "volume.type",
			  .type = GZ_OPTION_CHOICE,
			  .offset = AT(type),
			  .choices = gz_raw_type_names,
			  .help = "type of voxel; for raw files, and uint8, uint16 or float32 "
				  "for procedural volumes" },
	[VOLUME_ENDIAN] = { .key = "volume.endian",
			    .type = GZ_OPTION_CHOICE,
			    .offset = AT(endian),
			    .choices = endian_names,
			    .preset = "little",
			    .help = "byte order; for raw files" },
	[VOLUME_SPACING] = { .key = "volume.spacing",
			     .type = GZ_OPTION_DOUBLE,
			     .offset = AT(spacing),
			     .min = 1e-9,
			     .max = 1e9,
			     .count = 3,
			     .preset = "1 1 1",
			     .help = "between voxels along x, y, z, mm; for raw files and "
				     "procedural volumes" },
	[VOLUME_MEMORY] = { .key = "volume.memory_mib",
			    .type = GZ_OPTION_INT,
			    .offset = AT(memory_mib),
			    .min = 0,
			    .max = 1 << 20,
			    .preset = "0",
			    .help = "memory for what is looked at of a file of bricks, MiB; 0 "
				    "takes "
				    "a quarter of the machine's" },
	[TRANSFER_FILE] = { .key = "transfer.file",
			    .type = GZ_OPTION_STRING,
			    .offset = AT(transfer_file),
			    .max = GZ_PATH_SIZE,
			    .preset = "",
			    .help = "transfer function, .tf; looked up as volume.file; without it "
				    "one is made for the volume" },
	[TRANSFER_ALSO] = { .key = "transfer.also",
			    .type = GZ_OPTION_STRING,
			    .offset = AT(transfer_also),
			    .max = GZ_PATH_SIZE,
			    .preset = "",
			    .help = "further transfer functions that gazebench measures too, "
				    "parted "
				    "by blanks" },
	[CAMERA_EYE] = { .key = "camera.eye",
			 .type = GZ_OPTION_DOUBLE,
			 .offset = AT(camera.eye),
			 .min = -1e6,
			 .max = 1e6,
			 .count = 3,
			 .preset = "0 -2 0",
			 .help = "where it stands; the volume's longest edge is 1, centred at 0" },
	[CAMERA_LOOK_AT] = { .key = "camera.look_at",
			     .type = GZ_OPTION_DOUBLE,
			     .offset = AT(camera.look_at),
			     .min = -1e6,
			     .max = 1e6,
			     .count = 3,
			     .preset = "0 0 0",
			     .help = "what is in the picture's centre" },
	[CAMERA_UP] = { .key = "camera.up",
			.type = GZ_OPTION_DOUBLE,
			.offset = AT(camera.up),
			.min = -1e6,
			.max = 1e6,
			.count = 3,
			.preset = "0 0 1",
			.help = "what points upwards in the picture" },
	[CAMERA_FOV] = { .key = "camera.fov_deg",
			 .type = GZ_OPTION_DOUBLE,
			 .offset = AT(camera.fov_deg),
			 .min = 0.01,
			 .max = 179,
			 .preset = "40",
			 .help = "vertical field of view, degrees; perspective" },
	[CAMERA_HEIGHT] = { .key = "camera.height",
			    .type = GZ_OPTION_DOUBLE,
			    .offset = AT(camera.height),
			    .min = 1e-6,
			    .max = 1e6,
			    .preset = "1.5",
			    .help = "of the view, world units; orthographic" },
	[CAMERA_PROJECTION] = { .key = "camera.projection",
				.type = GZ_OPTION_CHOICE,
				.offset = AT(camera.projection),
				.choices = projection_names,
				.preset = "perspective",
				.help = "how far things look smaller" },
	[RENDER_IMAGE_SAMPLING] = { .key = "render.image_sampling_rate",
				    .type = GZ_OPTION_DOUBLE,
				    .offset = AT(image_sampling_rate),
				    .min = 0.1,
				    .max = 4,
				    .preset = "1",
				    .help = "rays per pixel edge" },
	[DISPLAY_PX] = { .key = "display.px",
			 .type = GZ_OPTION_INT,
			 .offset = AT(display.px),
			 .min = 1,
			 .max = 32768,
			 .count = 2,
			 .help = "width and height of the display, pixels" },
	[DISPLAY_MM] = { .key = "display.mm",
			 .type = GZ_OPTION_DOUBLE,
			 .offset = AT(display.mm),
			 .min = 1,
			 .max = 100000,
			 .count = 2,
			 .help = "width and height of the display, mm" },
	[DISPLAY_DISTANCE] = { .key = "display.distance_mm",
			       .type = GZ_OPTION_DOUBLE,
			       .offset = AT(display.distance_mm),
			       .min = 1,
			       .max = 100000,
			       .help = "from the eye to the display's centre, mm" },
};

/* The rows of scene_options from @p first up to @p end. */
static struct gz_option_binding bind_rows(struct gz_scene_settings *settings, size_t first,
					  size_t end)
{
	return (struct gz_option_binding) { &scene_options[first], end - first, settings, NULL };
}

void gz_scene_bind(struct gz_scene_settings *settings,
		   struct gz_option_binding out_bindings[GZ_SCENE_TABLE_COUNT])
{
	const struct gz_option_binding bindings[GZ_SCENE_TABLE_COUNT] = {
		[GZ_SCENE_VOLUME] = bind_rows(settings, VOLUME_FILE, TRANSFER_FILE),
		[GZ_SCENE_TRANSFER] = bind_rows(settings, TRANSFER_FILE, CAMERA_EYE),
		[GZ_SCENE_CAMERA] = bind_rows(settings, CAMERA_EYE, RENDER_IMAGE_SAMPLING),
		[GZ_SCENE_IMAGE] = bind_rows(settings, RENDER_IMAGE_SAMPLING, DISPLAY_PX),
		[GZ_SCENE_DISPLAY] = bind_rows(settings, DISPLAY_PX, SCENE_OPTION_COUNT),
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

/* A scene in reading. */
struct reader {
	const char *name;
	const struct gz_loading *loading;
	const struct gz_log *log;
	struct gz_scene_settings *settings;
	struct gz_option_binding bindings[GZ_SCENE_TABLE_COUNT + GZ_SCENE_OBJECTS_MAX];
	size_t binding_count;
	struct gz_scene_object_table object_tables[GZ_SCENE_OBJECTS_MAX];
	bool given[SCENE_OPTION_COUNT];
};

static enum gz_result refuse(const struct reader *reader, int option, const char *what)
{
	gz_err(reader->log, "%s: %s: %s", reader->name, scene_options[option].key, what);
	return GZ_ERR_FORMAT;
}

static enum gz_result preset(const struct gz_option_binding bindings[GZ_SCENE_TABLE_COUNT])
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
	return preset(bindings);
}

bool gz_scene_settings_same(const struct gz_scene_settings *a, const struct gz_scene_settings *b)
{
	return gz_options_same(scene_options, SCENE_OPTION_COUNT, a, b) &&
	       gz_scene_objects_same(&a->objects, &b->objects) &&
	       gz_ray_params_same(&a->rays, &b->rays) &&
	       gz_foveation_same(&a->foveation, &b->foveation) &&
	       gz_options_same(gz_attention_options, gz_attention_option_count, &a->attention,
			       &b->attention) &&
	       gz_options_same(gz_temporal_options, gz_temporal_option_count, &a->temporal,
			       &b->temporal) &&
	       gz_options_same(gz_view_setting_options, gz_view_setting_option_count, &a->view,
			       &b->view);
}

/* Ready to read a text, or the file of that name: every section that there is has its table. */
static enum gz_result begin_reading(struct reader *reader, const char *text, size_t size)
{
	struct gz_scene_settings *settings = reader->settings;
	*settings = (struct gz_scene_settings) { 0 };
	gz_scene_bind(settings, reader->bindings);
	for (size_t i = GZ_SCENE_VOLUME; i <= GZ_SCENE_DISPLAY; i++)
		reader->bindings[i].given =
			reader->given + (reader->bindings[i].options - scene_options);
	enum gz_result result = preset(reader->bindings);
	if (result == GZ_OK)
		result = gz_scene_objects_scan(reader->name, text, size, reader->log,
					       &settings->objects);
	reader->binding_count = GZ_SCENE_TABLE_COUNT;
	for (size_t i = 0; i < settings->objects.count && result == GZ_OK; i++)
		reader->bindings[reader->binding_count++] = gz_scene_object_bind(
			&settings->objects.items[i], &reader->object_tables[i]);
	return result;
}

static bool given_raw(const struct reader *reader)
{
	return reader->given[VOLUME_TYPE] || reader->given[VOLUME_ENDIAN] ||
	       reader->given[VOLUME_SPACING];
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

/* The type of voxel of a procedural volume; false if there is none of that type. */
static bool made_type(const struct gz_scene_settings *settings, enum gz_voxel_type *out_type)
{
	*out_type = settings->type == GZ_RAW_UINT8    ? GZ_VOXEL_U8
		    : settings->type == GZ_RAW_UINT16 ? GZ_VOXEL_U16
						      : GZ_VOXEL_F32;
	return *out_type != GZ_VOXEL_F32 || settings->type == GZ_RAW_FLOAT32;
}

static enum gz_result check_volume(const struct reader *reader)
{
	struct gz_scene_settings *settings = reader->settings;
	bool file = settings->volume_file[0] != '\0', made = settings->volume_procedural != 0;
	enum gz_voxel_type type;
	if (settings->objects.count > 0 && !file && !made)
		return GZ_OK;
	if (made && !reader->given[VOLUME_TYPE])
		settings->type = gz_scene_procedural_type(settings->volume_procedural);
	if (file && made)
		return refuse(reader, VOLUME_FILE, "given with volume.procedural; keep one");
	if (!file && !made)
		return refuse(reader, VOLUME_FILE,
			      "not given; name a volume, or set volume.procedural");
	if (made && reader->given[VOLUME_ENDIAN])
		return refuse(reader, VOLUME_PROCEDURAL,
			      "takes dims, type and spacing only; leave out endian");
	if (made && !made_type(settings, &type))
		return refuse(reader, VOLUME_TYPE,
			      "a procedural volume has uint8, uint16 or float32");
	if (file && (given_raw(reader) || reader->given[VOLUME_DIMS]) &&
	    !(reader->given[VOLUME_DIMS] && reader->given[VOLUME_TYPE]))
		return refuse(reader, VOLUME_DIMS,
			      "a raw file needs both dims and type; other files none of them");
	return GZ_OK;
}

enum gz_result gz_scene_settings_check(const struct gz_scene_settings *settings, const char *name,
				       const struct gz_log *log)
{
	struct gz_ray_frame rays;
	if (gz_camera_rays(&settings->camera, 1, 1, &rays) != GZ_OK) {
		gz_err(log, "%s: camera.eye: is where camera.look_at is; move one of them", name);
		return GZ_ERR_FORMAT;
	}
	if (gz_saved_views_check(settings->view.saved, name, log) != GZ_OK)
		return GZ_ERR_FORMAT;
	if (gz_ray_params_valid(&settings->rays)) {
		if (!gz_camera_up_counts(&settings->camera))
			gz_warn(log,
				"%s: camera.up: 0 0 0 or along the view, so that nothing is up; "
				"the "
				"axis farthest from the view stands in",
				name);
		return GZ_OK;
	}
	const struct gz_clip_box *clip = &settings->rays.clip;
	bool below = true;
	for (int axis = 0; axis < 3; axis++)
		below = below && clip->least[axis] < clip->greatest[axis];
	gz_err(log, "%s: %s", name,
	       below ? "light.direction must not be 0 0 0"
		     : "clip.least must be below clip.greatest along each axis");
	return GZ_ERR_FORMAT;
}

static enum gz_result check_display(const struct reader *reader, bool *out_has_display)
{
	bool px = reader->given[DISPLAY_PX], mm = reader->given[DISPLAY_MM];
	bool distance = reader->given[DISPLAY_DISTANCE];
	*out_has_display = px && mm && distance;
	if (px == mm && mm == distance)
		return GZ_OK;
	return refuse(reader, px ? mm ? DISPLAY_DISTANCE : DISPLAY_MM : DISPLAY_PX,
		      "not given; px, mm and distance_mm go together");
}

/* The object with a volume that the scene shows; NULL: section [volume] names it. */
static const struct gz_scene_object *volume_object(const struct gz_scene_settings *settings)
{
	for (size_t i = 0; i < settings->objects.count; i++)
		if (settings->objects.items[i].volume[0])
			return &settings->objects.items[i];
	return NULL;
}

/* No technique draws two volumes into one picture. */
static enum gz_result check_one_volume(const struct reader *reader)
{
	const struct gz_scene_settings *settings = reader->settings;
	size_t volumes = settings->volume_file[0] || settings->volume_procedural;
	for (size_t i = 0; i < settings->objects.count; i++)
		volumes += settings->objects.items[i].volume[0] != '\0';
	if (volumes <= 1)
		return GZ_OK;
	gz_err(reader->log, "%s: %zu volumes are given, and a scene shows one; keep one",
	       reader->name, volumes);
	return GZ_ERR_FORMAT;
}

static enum gz_result check(const struct reader *reader, bool *out_has_display)
{
	enum gz_result result = check_volume(reader);
	if (result == GZ_OK)
		result = gz_scene_objects_check(&reader->settings->objects, reader->name,
						reader->log);
	if (result == GZ_OK)
		result = check_one_volume(reader);
	if (result == GZ_OK)
		result = check_display(reader, out_has_display);
	return result;
}

enum gz_result gz_scene_parse(const char *name, const char *text, size_t size,
			      const struct gz_log *log, struct gz_scene_settings *out_settings,
			      bool *out_has_display)
{
	struct gz_scene_settings settings;
	struct reader reader = { .name = name, .log = log, .settings = &settings };
	bool has_display = false;
	enum gz_result result = begin_reading(&reader, text, size);
	if (result == GZ_OK)
		result = gz_options_read_text(reader.bindings, reader.binding_count, name, text,
					      size, log);
	if (result == GZ_OK)
		result = check(&reader, &has_display);
	if (result == GZ_OK)
		result = gz_scene_settings_check(&settings, name, log);
	if (result != GZ_OK)
		return result;
	*out_settings = settings;
	*out_has_display = has_display;
	return GZ_OK;
}

static enum gz_result find_file(const struct reader *reader, const char *key, const char *name,
				char out_path[GZ_PATH_SIZE])
{
	const char *data = getenv("GAZECAST_DATA");
	if (gz_scene_find_file(reader->name, name, out_path) == GZ_OK)
		return GZ_OK;
	if (name[0] == '/')
		gz_err(reader->log, "%s: %s: no file %s; install it or correct the name",
		       reader->name, key, name);
	else
		gz_err(reader->log,
		       "%s: %s: %s is neither beside the scene nor under GAZECAST_DATA (%s); put "
		       "it there or set the variable",
		       reader->name, key, name, data && *data ? data : "not set");
	return GZ_ERR_NOT_FOUND;
}

static enum gz_result make_procedural(const struct reader *reader, struct gz_volume *out_volume)
{
	static const int preset[3] = { PROCEDURAL_EDGE, PROCEDURAL_EDGE, PROCEDURAL_EDGE };
	const int *dims = reader->settings->dims[0] > 0 ? reader->settings->dims : preset;
	enum gz_procedural which = (enum gz_procedural)(reader->settings->volume_procedural - 1);
	enum gz_voxel_type type;
	if (!made_type(reader->settings, &type))
		return GZ_ERR_INVAL; /* refused before */
	return gz_volume_generate(which, dims, reader->settings->spacing, type, reader->loading,
				  reader->log, out_volume);
}

static const char *volume_key(const struct gz_scene_object *object)
{
	return object ? object->section : scene_options[VOLUME_FILE].key;
}

static enum gz_result load_volume(const struct reader *reader, struct gz_volume *out_volume)
{
	const struct gz_scene_settings *settings = reader->settings;
	char path[GZ_PATH_SIZE];
	const struct gz_scene_object *object = volume_object(settings);
	if (settings->volume_procedural)
		return make_procedural(reader, out_volume);
	enum gz_result result = find_file(reader, volume_key(object),
					  object ? object->volume : settings->volume_file, path);
	if (result != GZ_OK)
		return result;
	struct gz_loading loading = reader->loading ? *reader->loading : (struct gz_loading) { 0 };
	loading.brick_bytes = (size_t)settings->memory_mib << 20;
	struct gz_raw_layout raw = { .type = (enum gz_raw_type)settings->type,
				     .big_endian = settings->endian == 1 };
	memcpy(raw.dims, settings->dims, sizeof raw.dims);
	memcpy(raw.spacing, settings->spacing, sizeof raw.spacing);
	return gz_volume_load(path, settings->dims[0] > 0 ? &raw : NULL, &loading, reader->log,
			      out_volume);
}

static const char *transfer_name(const struct gz_scene_settings *settings)
{
	const struct gz_scene_object *object = volume_object(settings);
	return object ? object->transfer : settings->transfer_file;
}

static enum gz_result load_transfer(const struct reader *reader, struct gz_transfer *out_transfer)
{
	char path[GZ_PATH_SIZE];
	const struct gz_scene_object *object = volume_object(reader->settings);
	enum gz_result result =
		find_file(reader, object ? object->section : scene_options[TRANSFER_FILE].key,
			  transfer_name(reader->settings), path);
	return result == GZ_OK ? gz_transfer_load(path, reader->log, out_transfer) : result;
}

enum gz_result gz_scene_load_transfer(const char *scene, const char *file, const struct gz_log *log,
				      struct gz_transfer *out_transfer)
{
	const struct reader reader = { .name = scene, .log = log };
	char path[GZ_PATH_SIZE];
	enum gz_result result = find_file(&reader, "transfer.also", file, path);
	return result == GZ_OK ? gz_transfer_load(path, log, out_transfer) : result;
}

enum gz_result gz_scene_load_table(const char *scene, const struct gz_log *log,
				   struct gz_foveation *foveation)
{
	static const char key[] = "foveation.table";
	const struct reader reader = { .name = scene, .log = log };
	char path[GZ_PATH_SIZE];
	if (!foveation->table_file[0]) {
		if (!gz_method_of(foveation)->needs_table)
			return GZ_OK;
		gz_err(log,
		       "%s: %s: not given, and the method is table; name a table of spacings "
		       "(docs/scenes.md says what is in it)",
		       scene, key);
		return GZ_ERR_FORMAT;
	}
	enum gz_result result = find_file(&reader, key, foveation->table_file, path);
	return result == GZ_OK ? gz_spacing_table_load(path, log, &foveation->table) : result;
}

enum gz_result gz_scene_load(const char *path, const struct gz_loading *loading,
			     const struct gz_log *log, struct gz_scene *out_scene)
{
	return gz_scene_load_changed(path, NULL, NULL, loading, log, out_scene);
}

/* What the file says, and @p change of it; none of the files that it names. */
static enum gz_result read_settings(struct reader *reader, gz_scene_change *change, void *user,
				    struct gz_scene *scene)
{
	const char *path = reader->name;
	enum gz_result result =
		gz_options_read_file(reader->bindings, reader->binding_count, path, reader->log);
	if (result == GZ_OK)
		result = check(reader, &scene->has_display);
	if (result == GZ_OK && change)
		result = change(user, &scene->settings);
	if (result == GZ_OK)
		result = gz_scene_settings_check(&scene->settings, path, reader->log);
	return result;
}

enum gz_result gz_scene_load_changed(const char *path, gz_scene_change *change, void *user,
				     const struct gz_loading *loading, const struct gz_log *log,
				     struct gz_scene *out_scene)
{
	struct gz_scene scene = { 0 };
	struct reader reader = { .name = path, .log = log, .settings = &scene.settings };
	enum gz_result result = begin_reading(&reader, NULL, 0);
	if (result == GZ_OK)
		result = read_settings(&reader, change, user, &scene);
	const struct gz_scene_parts parts = {
		.name = path,
		.settings = &scene.settings,
		.has_display = scene.has_display,
	};
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
	const struct reader reader = {
		.name = parts->name, .loading = loading, .log = log, .settings = &scene.settings
	};
	const bool named = !parts->transfer && transfer_name(&scene.settings)[0];
	enum gz_result result = gz_scene_load_table(parts->name, log, &scene.settings.foveation);
	if (result == GZ_OK && named)
		result = load_transfer(&reader, &scene.transfer);
	if (result == GZ_OK && parts->transfer)
		scene.transfer = *parts->transfer;
	if (result == GZ_OK)
		result = load_volume(&reader, &scene.volume);
	if (result == GZ_OK && !named && !parts->transfer && !parts->volume_alone)
		result = gz_transfer_of_volume(&scene.volume, log, &scene.transfer);
	if (result != GZ_OK) {
		gz_scene_free(&scene);
		return result;
	}
	*out_scene = scene;
	return GZ_OK;
}

enum gz_result gz_scene_try(const char *path, gz_scene_change *change, void *user,
			    const struct gz_log *log, struct gz_scene_settings *out_settings)
{
	struct gz_scene scene = { 0 };
	struct reader reader = { .name = path, .log = log, .settings = &scene.settings };
	char volume[GZ_PATH_SIZE];
	enum gz_result result = begin_reading(&reader, NULL, 0);
	if (result == GZ_OK)
		result = read_settings(&reader, change, user, &scene);
	if (result == GZ_OK)
		result = gz_scene_load_table(path, log, &scene.settings.foveation);
	if (result == GZ_OK && transfer_name(&scene.settings)[0])
		result = load_transfer(&reader, &scene.transfer);
	const struct gz_scene_object *object = volume_object(&scene.settings);
	if (result == GZ_OK && !scene.settings.volume_procedural)
		result = find_file(&reader, volume_key(object),
				   object ? object->volume : scene.settings.volume_file, volume);
	if (result == GZ_OK)
		*out_settings = scene.settings;
	return result;
}

size_t gz_scene_list_objects(const struct gz_scene *scene, struct gz_object *out_objects,
			     size_t room)
{
	const struct gz_scene_object *object = volume_object(&scene->settings);
	const bool visible = !object || object->visible;
	if (visible && room > 0)
		out_objects[0] = (struct gz_object) {
			.technique = gz_techniques[object ? object->technique : 0],
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
