#include "view/files/scene_save.h"

#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"
#include "render/scene/scene_files.h"

#define GZ_LOG_MODULE "scene"

static const char scene_ending[] = ".scene", transfer_ending[] = ".tf";

enum gz_result gz_scene_save_path(const char *typed, char out_path[GZ_PATH_SIZE])
{
	const char *ending = gz_path_ends(typed, scene_ending) ? "" : scene_ending;
	return gz_text_print(out_path, GZ_PATH_SIZE, "%s%s", typed, ending);
}

/* Length of a path without all endings of its last name: 1 for "a.nii.gz". A leading dot begins no
 * ending. */
static size_t stem_length(const char *path)
{
	const char *slash = strrchr(path, '/');
	const char *name = slash ? slash + 1 : path;
	const char *dot = name[0] ? strchr(name + 1, '.') : NULL;
	return dot ? (size_t)(dot - path) : strlen(path);
}

void gz_scene_save_suggest(const char *path, char out_path[GZ_PATH_SIZE])
{
	const size_t length = stem_length(path);
	if (gz_path_ends(path, scene_ending))
		snprintf(out_path, GZ_PATH_SIZE, "%s", path);
	else if (length > 0 && length + sizeof scene_ending <= GZ_PATH_SIZE)
		snprintf(out_path, GZ_PATH_SIZE, "%.*s%s", (int)length, path, scene_ending);
	else
		snprintf(out_path, GZ_PATH_SIZE, "untitled%s", scene_ending);
}

/* Whether the file that the settings name, or the volume's default, is the transfer function shown.
 */
static bool is_kept(const struct gz_scene_save *save)
{
	const char *name = gz_scene_transfer_name(save->scene.settings);
	char path[GZ_PATH_SIZE];
	struct gz_transfer read;
	if (!save->transfer)
		return true;
	if (!name[0])
		return save->made && gz_transfer_same(save->transfer, save->made);
	return gz_scene_find_file(save->scene.path, name, path) == GZ_OK &&
	       gz_transfer_load(path, NULL, &read) == GZ_OK &&
	       gz_transfer_same(save->transfer, &read);
}

bool gz_scene_save_writes_transfer(const struct gz_scene_save *save, const char *path,
				   char out_path[GZ_PATH_SIZE])
{
	const size_t length = strlen(path) - (sizeof scene_ending - 1);
	if (is_kept(save))
		return false;
	snprintf(out_path, GZ_PATH_SIZE, "%.*s%s", (int)length, path, transfer_ending);
	return true;
}

enum gz_result gz_scene_save(const struct gz_scene_save *save, const char *path,
			     const struct gz_log *log, struct gz_scene_settings *settings)
{
	struct gz_scene_settings saved = *save->scene.settings;
	const struct gz_scene_saved moved = { &saved, save->scene.has_display, path };
	char file[GZ_PATH_SIZE];
	const bool writes = gz_scene_save_writes_transfer(save, path, file);
	enum gz_result result = writes ? gz_transfer_write(save->transfer, file, log) : GZ_OK;
	if (result == GZ_OK)
		result = gz_scene_move_files(&saved, save->scene.path, path, log);
	if (result == GZ_OK && writes) {
		const char *slash = strrchr(file, '/');
		const char *name = slash ? slash + 1 : file;
		memset(saved.transfer_file, 0, sizeof saved.transfer_file);
		memcpy(saved.transfer_file, name, strlen(name));
	}
	if (result == GZ_OK)
		result = gz_scene_write(&moved, path, log);
	if (result == GZ_OK)
		*settings = saved;
	return result;
}
