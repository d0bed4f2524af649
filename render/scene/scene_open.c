#include "render/scene/scene_open.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "render/data/format.h"
#include "render/data/raw_guess.h"
#include "render/mesh/mesh_file.h"
#include "render/mesh/mesh_read.h"
#include "render/particles/particle_series.h"
#include "render/particles/particles.h"
#include "render/scene/scene_picture.h"
#include "render/transfer/content.h"
#include "render/transfer/transfer_presets.h"

#define GZ_LOG_MODULE "scene"

#define RADIANS_PER_DEGREE 0.017453292519943295

/* Share of the picture that a fitted box takes. Chosen: it does not touch the edges. */
#define FIT_SHARE 0.9

enum gz_file_kind gz_file_kind_by_name(const char *path)
{
	static const struct {
		const char *ending;
		enum gz_file_kind kind;
	} kinds[] = {
		{ ".scene", GZ_FILE_SCENE },
		{ ".png", GZ_FILE_PICTURE },
		{ ".tf", GZ_FILE_TRANSFER },
		{ ".gzl", GZ_FILE_GAZE_LOG },
	};
	for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
		if (gz_path_ends(path, kinds[i].ending))
			return kinds[i].kind;
	/* Before the volumes, of which raw ones may end in ".gz" whatever stands before that. */
	if (gz_particle_format_by_name(path) || gz_mesh_file_named(path))
		return GZ_FILE_VOLUME;
	const struct gz_volume_format *format = gz_volume_format_by_name(path);
	if (!format)
		return GZ_FILE_OTHER;
	return format->layout == GZ_LAYOUT_IN_FILE ? GZ_FILE_VOLUME : GZ_FILE_RAW;
}

/* A text has no zero byte. */
static bool is_binary_file(const char *path)
{
	struct gz_file_start start;
	return gz_file_start_read(path, &start) && memchr(start.bytes, 0, start.size);
}

/* A file that is there and whose first line that says something begins no section. */
static bool is_other_text(const char *path)
{
	struct gz_file_start start;
	if (!gz_file_start_read(path, &start))
		return false;
	bool comment = false;
	for (size_t i = 0; i < start.size; i++) {
		const char c = (char)start.bytes[i];
		if (c == '\n')
			comment = false;
		else if (c == ';' || c == '#')
			comment = true;
		else if (!comment && !strchr(" \t\r\xef\xbb\xbf", c))
			return c != '[';
	}
	return start.size < GZ_FILE_START_SIZE;
}

enum gz_file_kind gz_file_kind_of(const char *path)
{
	const enum gz_file_kind kind = gz_file_kind_by_name(path);
	const bool looked_into = kind == GZ_FILE_OTHER || kind == GZ_FILE_RAW;
	if (looked_into &&
	    (gz_volume_format_by_content(path) || gz_particle_format_by_content(path)))
		return GZ_FILE_VOLUME;
	return kind == GZ_FILE_OTHER && is_binary_file(path) ? GZ_FILE_VOLUME : kind;
}

enum gz_result gz_scene_settings_for_volume(const char *path, const struct gz_raw_layout *raw,
					    const struct gz_log *log,
					    struct gz_scene_settings *out_settings)
{
	struct gz_scene_settings settings;
	char *real = realpath(path, NULL);
	if (!real) {
		gz_err(log, "%s: cannot be opened: %s; check the path", path, strerror(errno));
		return GZ_ERR_NOT_FOUND;
	}
	enum gz_result result = gz_scene_settings_preset(&settings);
	if (strlen(real) >= sizeof settings.volume_file) {
		gz_err(log, "%s: the path is too long; move the file", path);
		result = GZ_ERR_FULL;
	}
	if (result == GZ_OK) {
		memcpy(settings.volume_file, real, strlen(real) + 1);
		if (raw) {
			memcpy(settings.dims, raw->dims, sizeof settings.dims);
			memcpy(settings.spacing, raw->spacing, sizeof settings.spacing);
			settings.type = (int)raw->type;
			settings.endian = raw->big_endian ? 1 : 0;
			settings.channels = raw->channels > 1 ? raw->channels : 1;
		}
		*out_settings = settings;
	}
	free(real);
	return result;
}

/* Make the settings that show a mesh: every key's preset, and the file by its absolute path. */
static enum gz_result settings_for_mesh(const char *path, const struct gz_log *log,
					struct gz_scene_settings *out_settings)
{
	char *real = realpath(path, NULL);
	enum gz_result result = real ? gz_scene_settings_preset(out_settings) : GZ_ERR_NOT_FOUND;
	if (result == GZ_OK)
		result = gz_scene_objects_of_mesh(real, &out_settings->objects);
	if (result == GZ_ERR_FULL)
		gz_err(log, "%s: the path of a mesh has at most %d bytes; move the file", path,
		       GZ_SCENE_FILE_SIZE - 1);
	else if (result != GZ_OK)
		gz_err(log, "%s: cannot be opened: %s", path, gz_result_text(result));
	free(real);
	return result;
}

/* Unit vectors to the right, upwards and along the view. */
static void view_axes(const struct gz_camera *camera, double axes[3][3])
{
	struct gz_ray_frame rays;
	double *right = axes[0], *up = axes[1], *along = axes[2];
	struct gz_camera parallel = *camera;
	parallel.projection = GZ_PROJECTION_ORTHOGRAPHIC;
	gz_camera_rays(&parallel, 2, 2, &rays);
	for (int i = 0; i < 3; i++) {
		right[i] = rays.origin_dx[i];
		up[i] = -rays.origin_dy[i];
		along[i] = rays.direction00[i];
	}
	for (int a = 0; a < 3; a++) {
		const double length = sqrt(axes[a][0] * axes[a][0] + axes[a][1] * axes[a][1] +
					   axes[a][2] * axes[a][2]);
		for (int i = 0; i < 3; i++)
			axes[a][i] /= length;
	}
}

void gz_camera_fit(struct gz_camera *camera, const struct gz_volume *volume,
		   const struct gz_clip_region *box)
{
	double half[3], middle[3], axes[3][3], distance = 0, greatest = 0;
	const struct gz_clip_region *seen = box ? box : &gz_clip_whole;
	const double slope = FIT_SHARE * tan(camera->fov_deg * RADIANS_PER_DEGREE / 2);
	gz_volume_half_extent(volume, half);
	for (int i = 0; i < 3; i++) {
		middle[i] = (seen->least[i] + seen->greatest[i] - 1) * half[i];
		half[i] *= seen->greatest[i] - seen->least[i];
	}
	view_axes(camera, axes);
	for (int corner = 0; corner < 8; corner++) {
		double at[3] = { 0, 0, 0 };
		for (int a = 0; a < 3; a++)
			for (int i = 0; i < 3; i++)
				at[a] += axes[a][i] * (corner >> i & 1 ? half[i] : -half[i]);
		const double aside = fmax(fabs(at[0]), fabs(at[1]));
		distance = fmax(distance, aside / slope - at[2]);
		greatest = fmax(greatest, aside);
	}
	camera->height = 2 * greatest / FIT_SHARE;
	for (int i = 0; i < 3; i++) {
		camera->look_at[i] = middle[i];
		camera->eye[i] = middle[i] - axes[2][i] * distance;
	}
}

/* Whether two cameras stand in one place. The field of view may differ: the view is fitted to it.
 */
static bool same_camera_place(const struct gz_camera *a, const struct gz_camera *b)
{
	bool same = a->height == b->height;
	for (int i = 0; i < 3; i++)
		same = same && a->eye[i] == b->eye[i] && a->look_at[i] == b->look_at[i] &&
		       a->up[i] == b->up[i];
	return same;
}

/* Look at what is seen of the scene, from the front, the right and above. In an oriented volume and
 * a mesh y points to the front. */
static void choose_first_view(struct gz_scene *scene)
{
	const bool has_volume = gz_scene_has_volume(&scene->settings);
	const bool to_front = scene->volume.oriented || !has_volume;
	const double eye[3] = { 0.8, to_front ? 1.3 : -1.3, 0.5 };
	struct gz_camera *camera = &scene->settings.camera;
	struct gz_clip_region content = scene->settings.rays.clip;
	memcpy(camera->eye, eye, sizeof eye);
	if (has_volume)
		gz_content_find(&scene->volume, &scene->transfer, &content, &content);
	gz_camera_fit(camera, &scene->volume, &content);
}

static enum gz_result change_and_check(const struct gz_scene_request *request,
				       struct gz_scene_settings *settings, const struct gz_log *log)
{
	const enum gz_result result =
		request->change ? request->change(request->user, settings) : GZ_OK;
	return result == GZ_OK ? gz_scene_settings_check(settings, request->path, log) : result;
}

/* In place of a shading: the request has not chosen one. */
enum { SHADING_OPEN = -1 };

/* Most volumes show surfaces, and those need light; a transfer function that is asked for may not.
 */
static void choose_first_shading(struct gz_scene_settings *settings)
{
	const int preset = settings->transfer_preset;
	const bool lit =
		preset == 0 || gz_transfer_preset_text((enum gz_transfer_preset)(preset - 1))->lit;
	if (settings->rays.shading == SHADING_OPEN)
		settings->rays.shading = lit ? GZ_SHADING_GRADIENT : GZ_SHADING_NONE;
}

static enum gz_result open_volume(const struct gz_scene_request *request,
				  const struct gz_raw_layout *raw, const struct gz_log *log,
				  struct gz_scene *out_scene)
{
	struct gz_scene_settings settings;
	const bool mesh = !request->volume_alone && gz_mesh_has_faces(request->path);
	enum gz_result result =
		mesh ? settings_for_mesh(request->path, log, &settings)
		     : gz_scene_settings_for_volume(request->path, raw, log, &settings);
	if (result != GZ_OK)
		return result;
	const struct gz_camera preset = settings.camera;
	settings.rays.shading = SHADING_OPEN;
	if (request->change)
		result = request->change(request->user, &settings);
	choose_first_shading(&settings);
	if (result == GZ_OK)
		result = gz_scene_settings_check(&settings, request->path, log);
	const struct gz_scene_parts parts = {
		.name = request->path,
		.settings = &settings,
		.volume_alone = request->volume_alone,
	};
	if (result == GZ_OK)
		result = gz_scene_load_parts(&parts, request->loading, log, out_scene);
	if (result == GZ_OK && same_camera_place(&settings.camera, &preset))
		choose_first_view(out_scene);
	return result;
}

/* Whether the name tells a layout of another size than the file has; logged. */
static bool has_other_size_than_named(const char *path, uint64_t bytes, const struct gz_log *log)
{
	struct gz_raw_layout layout;
	if (!gz_raw_name_contradicts(path, bytes, &layout))
		return false;
	gz_err(log,
	       "%s: the file name says %d x %d x %d %s, which is %llu bytes, but the file has "
	       "%llu; copy it again, or give its layout, as in --volume.dims "
	       "\"256 256 128\" --volume.type uint8",
	       path, layout.dims[0], layout.dims[1], layout.dims[2], gz_raw_type_names[layout.type],
	       (unsigned long long)gz_raw_layout_bytes(&layout), (unsigned long long)bytes);
	return true;
}

static enum gz_result open_raw(const struct gz_scene_request *request, const struct gz_log *log,
			       struct gz_scene *out_scene)
{
	struct gz_raw_guess guess = { 0 };
	if (request->raw)
		return open_volume(request, request->raw, log, out_scene);
	const uint64_t bytes = gz_raw_file_bytes(request->path);
	const size_t count = gz_raw_guess(request->path, bytes, &guess, 1);
	const struct gz_raw_layout *layout = &guess.layout;
	if (count > 0 && guess.certain) {
		gz_info(log, "%s: taken as %d x %d x %d %s, since %s", request->path,
			layout->dims[0], layout->dims[1], layout->dims[2],
			gz_raw_type_names[layout->type], guess.reason);
		return open_volume(request, layout, log, out_scene);
	}
	if (has_other_size_than_named(request->path, bytes, log))
		return GZ_ERR_INVAL;
	if (count > 0)
		gz_err(log,
		       "%s: raw data without a header; give its layout: --volume.dims \"%d %d %d\" "
		       "--volume.type %s would fit (%s)",
		       request->path, layout->dims[0], layout->dims[1], layout->dims[2],
		       gz_raw_type_names[layout->type], guess.reason);
	else
		gz_err(log,
		       "%s: raw data without a header; give its layout, as in "
		       "--volume.dims \"256 256 128\" "
		       "--volume.type uint8",
		       request->path);
	return GZ_ERR_INVAL;
}

static enum gz_result open_picture(const struct gz_scene_request *request, const struct gz_log *log,
				   struct gz_scene *out_scene)
{
	struct gz_scene_picture picture;
	enum gz_result result = gz_scene_picture_read(request->path, log, &picture);
	if (result != GZ_OK)
		return result;
	char named[GZ_PATH_SIZE];
	memcpy(named, picture.settings.transfer_file, sizeof named);
	result = change_and_check(request, &picture.settings, log);
	if (strcmp(named, picture.settings.transfer_file) != 0)
		picture.has_transfer = false;
	const struct gz_scene_parts parts = {
		.name = request->path,
		.settings = &picture.settings,
		.has_display = picture.has_display,
		.transfer = picture.has_transfer ? &picture.transfer : NULL,
	};
	if (result == GZ_OK)
		result = gz_scene_load_parts(&parts, request->loading, log, out_scene);
	if (result == GZ_OK)
		gz_scene_picture_check(&picture, &out_scene->volume, request->path, log);
	return result;
}

static enum gz_result open_path(const struct gz_scene_request *request, const struct gz_log *log,
				struct gz_scene *out_scene)
{
	/* Whoever gives a layout says what the content is. */
	const enum gz_file_kind kind =
		request->raw ? gz_file_kind_by_name(request->path) : gz_file_kind_of(request->path);
	const struct gz_scene_source source = {
		.path = request->path,
		.change = request->change,
		.user = request->user,
	};
	if (request->raw && kind != GZ_FILE_RAW) {
		gz_err(log, "%s: not a raw file, so it takes no layout; leave out --volume.dims",
		       request->path);
		return GZ_ERR_INVAL;
	}
	switch (kind) {
	case GZ_FILE_OTHER:
		if (is_other_text(request->path)) {
			gz_err(log,
			       "%s: neither a scene nor a volume, a mesh or particles; gazeview "
			       "--formats lists what can be opened",
			       request->path);
			return GZ_ERR_FORMAT;
		}
		return gz_scene_load_changed(&source, request->loading, log, out_scene);
	case GZ_FILE_SCENE:
		return gz_scene_load_changed(&source, request->loading, log, out_scene);
	case GZ_FILE_VOLUME:
		return open_volume(request, NULL, log, out_scene);
	case GZ_FILE_RAW:
		return open_raw(request, log, out_scene);
	case GZ_FILE_PICTURE:
		return open_picture(request, log, out_scene);
	case GZ_FILE_TRANSFER:
	case GZ_FILE_GAZE_LOG:
		break;
	}
	gz_err(log, "%s: a %s shows nothing by itself; open a scene or a volume, then this",
	       request->path, kind == GZ_FILE_TRANSFER ? "transfer function" : "gaze log");
	return GZ_ERR_INVAL;
}

enum gz_result gz_scene_open(const struct gz_scene_request *request, const struct gz_log *log,
			     struct gz_scene *out_scene)
{
	char first[GZ_PATH_SIZE];
	struct gz_scene_request of_first = *request;
	if (gz_particle_series_first(request->path, first))
		of_first.path = first;
	return open_path(&of_first, log, out_scene);
}
