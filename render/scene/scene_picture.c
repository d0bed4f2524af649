#include "render/scene/scene_picture.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "render/data/volume.h"
#include "render/scene/scene_files.h"

#define GZ_LOG_MODULE "scene"

static const char scene_keyword[] = "gazecast.scene";
static const char transfer_keyword[] = "gazecast.transfer";
static const char volume_keyword[] = "gazecast.volume";

void gz_volume_mark(const struct gz_volume *volume, char out_mark[GZ_VOLUME_MARK_SIZE])
{
	static const char *const types[GZ_VOXEL_TYPE_COUNT] = {
		[GZ_VOXEL_U8] = "uint8",
		[GZ_VOXEL_U16] = "uint16",
		[GZ_VOXEL_F32] = "float32",
	};
	const struct gz_volume_identity identity = gz_volume_identify(volume);
	const int used = snprintf(out_mark, GZ_VOLUME_MARK_SIZE, "%d x %d x %d %s, %.9g to %.9g",
				  identity.dims[0], identity.dims[1], identity.dims[2],
				  types[identity.type], identity.least, identity.greatest);
	if (identity.has_crc && used > 0 && used < GZ_VOLUME_MARK_SIZE)
		snprintf(out_mark + used, GZ_VOLUME_MARK_SIZE - (size_t)used, ", crc %08" PRIx32,
			 identity.crc);
}

/* The scene as text, with absolute file names. */
static enum gz_result print_anchored_scene(const struct gz_scene_saved *saved,
					   const struct gz_log *log, struct gz_text *text)
{
	struct gz_scene_settings settings = *saved->settings, read;
	const struct gz_scene_saved anchored = { &settings, saved->has_display, "" };
	bool has_display;
	enum gz_result result = gz_scene_anchor_files(&settings, saved->path, log);
	if (result == GZ_OK)
		result = gz_scene_print(&anchored, log, text);
	if (result == GZ_OK)
		result = gz_scene_parse("scene of the picture", text->bytes, text->length, log,
					&read, &has_display);
	return result;
}

enum gz_result gz_scene_picture_write(const struct gz_image *image,
				      const struct gz_scene_saved *saved,
				      const struct gz_transfer *transfer,
				      const struct gz_volume *volume, const char *path,
				      const struct gz_log *log)
{
	struct gz_text scene = { 0 }, function = { 0 };
	char mark[GZ_VOLUME_MARK_SIZE];
	struct gz_image_text texts[4] = { { "Software", "gazeview" } };
	size_t count = 1;
	if (print_anchored_scene(saved, log, &scene) == GZ_OK)
		texts[count++] = (struct gz_image_text) { scene_keyword, scene.bytes };
	else
		gz_warn(log, "%s: the picture is saved without its scene", path);
	if (count > 1 && transfer)
		gz_transfer_print(transfer, &function);
	if (function.bytes && !function.failed)
		texts[count++] = (struct gz_image_text) { transfer_keyword, function.bytes };
	if (count > 1 && volume) {
		gz_volume_mark(volume, mark);
		texts[count++] = (struct gz_image_text) { volume_keyword, mark };
	}
	const enum gz_result result = gz_image_write_png_with(image, texts, count, path, log);
	gz_text_free(&scene);
	gz_text_free(&function);
	return result;
}

static enum gz_result find_text(FILE *file, const char *keyword, struct gz_text *out_text)
{
	rewind(file);
	return gz_image_find_text(file, keyword, out_text);
}

static enum gz_result read_scene_text(FILE *file, const char *path, const struct gz_log *log,
				      struct gz_scene_picture *picture)
{
	struct gz_text text = { 0 };
	enum gz_result result = find_text(file, scene_keyword, &text);
	if (result == GZ_ERR_NOT_FOUND)
		gz_err(log, "%s: this picture holds no scene; open one that gazeview saved", path);
	else if (result != GZ_OK)
		gz_err(log, "%s: no scene can be read (%s); the file is damaged, or not a PNG",
		       path, gz_result_text(result));
	else
		result = gz_scene_parse(path, text.bytes ? text.bytes : "", text.length, log,
					&picture->settings, &picture->has_display);
	gz_text_free(&text);
	return result;
}

static enum gz_result read_transfer_text(FILE *file, const char *path, const struct gz_log *log,
					 struct gz_scene_picture *picture)
{
	struct gz_text text = { 0 };
	enum gz_result result = find_text(file, transfer_keyword, &text);
	if (result == GZ_OK)
		result = gz_transfer_parse(path, text.bytes ? text.bytes : "", text.length, log,
					   &picture->transfer);
	picture->has_transfer = result == GZ_OK;
	gz_text_free(&text);
	return result == GZ_ERR_NOT_FOUND ? GZ_OK : result;
}

static void read_mark(FILE *file, struct gz_scene_picture *picture)
{
	struct gz_text text = { 0 };
	if (find_text(file, volume_keyword, &text) == GZ_OK)
		snprintf(picture->mark, sizeof picture->mark, "%s", text.bytes ? text.bytes : "");
	gz_text_free(&text);
}

enum gz_result gz_scene_picture_read(const char *path, const struct gz_log *log,
				     struct gz_scene_picture *out_picture)
{
	struct gz_scene_picture picture = { 0 };
	FILE *file = fopen(path, "rbe");
	if (!file) {
		const int saved = errno;
		gz_err(log, "%s: cannot be opened: %s; check the path", path, strerror(saved));
		return saved == ENOENT ? GZ_ERR_NOT_FOUND : GZ_ERR_IO;
	}
	enum gz_result result = read_scene_text(file, path, log, &picture);
	if (result == GZ_OK)
		result = read_transfer_text(file, path, log, &picture);
	if (result == GZ_OK)
		read_mark(file, &picture);
	fclose(file);
	if (result == GZ_OK)
		*out_picture = picture;
	return result;
}

bool gz_scene_picture_check(const struct gz_scene_picture *picture, const struct gz_volume *volume,
			    const char *path, const struct gz_log *log)
{
	char mark[GZ_VOLUME_MARK_SIZE];
	gz_volume_mark(volume, mark);
	if (!picture->mark[0] || strcmp(mark, picture->mark) == 0)
		return true;
	gz_warn(log, "%s was made from other data (%s); %s now holds %s", path, picture->mark,
		picture->settings.volume_file[0] ? picture->settings.volume_file : "the formula",
		mark);
	return false;
}
