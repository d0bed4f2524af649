#include "render/scene/scene_files.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/text.h"

#define GZ_LOG_MODULE "scene"

#define BLANKS " \t"

enum gz_result gz_scene_find_file(const char *scene, const char *name, char out_path[GZ_PATH_SIZE])
{
	const char *data = getenv("GAZECAST_DATA");
	if (gz_path_beside(scene, name, out_path, GZ_PATH_SIZE) == GZ_OK &&
	    access(out_path, F_OK) == 0)
		return GZ_OK;
	if (name[0] == '/' || !data || !*data)
		return GZ_ERR_NOT_FOUND;
	const int length = snprintf(out_path, GZ_PATH_SIZE, "%s/%s", data, name);
	return length > 0 && length < GZ_PATH_SIZE && access(out_path, F_OK) == 0
		       ? GZ_OK
		       : GZ_ERR_NOT_FOUND;
}

static bool is_same_file(const char *a, const char *b)
{
	struct stat one, other;
	return stat(a, &one) == 0 && stat(b, &other) == 0 && one.st_dev == other.st_dev &&
	       one.st_ino == other.st_ino;
}

static enum gz_result take_name(const char *name, char out_name[GZ_PATH_SIZE])
{
	if (strlen(name) >= GZ_PATH_SIZE)
		return GZ_ERR_FULL;
	memmove(out_name, name, strlen(name) + 1);
	return GZ_OK;
}

/* The part of an absolute path below the folder of a file; NULL if it is not below it. */
static const char *below_folder_of(const char *path, const char *file)
{
	char folder[GZ_PATH_SIZE];
	if (gz_path_beside(file, ".", folder, sizeof folder) != GZ_OK)
		return NULL;
	char *real = realpath(folder, NULL);
	const size_t length = real ? strlen(real) : 0;
	const bool below = real && strncmp(path, real, length) == 0 && path[length] == '/';
	free(real);
	return below ? path + length + 1 : NULL;
}

enum gz_result gz_scene_rename_file(const char *scene, const char *name, const char *new_scene,
				    char out_name[GZ_PATH_SIZE])
{
	char before[GZ_PATH_SIZE], after[GZ_PATH_SIZE];
	if (!name[0] || gz_scene_find_file(scene, name, before) != GZ_OK)
		return take_name(name, out_name);
	if (gz_scene_find_file(new_scene, name, after) == GZ_OK && is_same_file(before, after))
		return take_name(name, out_name);
	char *real = realpath(before, NULL);
	if (!real)
		return take_name(name, out_name);
	const char *below = below_folder_of(real, new_scene);
	const enum gz_result result = take_name(below ? below : real, out_name);
	free(real);
	return result;
}

/* Where the scene that has the names is, and where the one that will have them is; to = NULL makes
 * paths absolute. */
struct scene_move {
	const char *from, *to;
	const struct gz_log *log;
};

/* The absolute path of a file; a name that is not found stays. */
static enum gz_result anchor_name(const struct scene_move *move, const char *name,
				  char out_name[GZ_PATH_SIZE])
{
	char path[GZ_PATH_SIZE];
	if (!name[0] || gz_scene_find_file(move->from, name, path) != GZ_OK) {
		memmove(out_name, name, strlen(name) + 1);
		return GZ_OK;
	}
	char *real = realpath(path, NULL);
	const bool fits = real && strlen(real) < GZ_PATH_SIZE;
	if (fits)
		memcpy(out_name, real, strlen(real) + 1);
	free(real);
	return fits ? GZ_OK : GZ_ERR_FULL;
}

static enum gz_result move_name(const struct scene_move *move, const char *key, const char *name,
				char out_name[GZ_PATH_SIZE])
{
	const enum gz_result result =
		move->to ? gz_scene_rename_file(move->from, name, move->to, out_name)
			 : anchor_name(move, name, out_name);
	if (result != GZ_OK)
		gz_err(move->log, "%s: the path of %s is too long for a scene; move the file", key,
		       name);
	return result;
}

static enum gz_result move_field(const struct scene_move *move, const char *key,
				 char name[GZ_PATH_SIZE])
{
	char moved[GZ_PATH_SIZE];
	const enum gz_result result = move_name(move, key, name, moved);
	if (result == GZ_OK)
		memcpy(name, moved, strlen(moved) + 1);
	return result;
}

/* Append one of several names to @p all. */
static enum gz_result move_listed(const struct scene_move *move, const char *name,
				  struct gz_text *all)
{
	static const char key[] = "transfer.also";
	char moved[GZ_PATH_SIZE];
	const enum gz_result result = move_name(move, key, name, moved);
	if (result != GZ_OK)
		return result;
	if (strcmp(moved, name) != 0 && strpbrk(moved, BLANKS)) {
		gz_err(move->log,
		       "%s: the path of %s has a blank, which separates names there; save the "
		       "scene beside it",
		       key, name);
		return GZ_ERR_INVAL;
	}
	gz_text_add(all, "%s%s", all->length ? " " : "", moved);
	return all->failed ? GZ_ERR_NO_MEM : GZ_OK;
}

/* Each of several names that are separated by blanks. */
static enum gz_result move_list(const struct scene_move *move, char names[GZ_PATH_SIZE])
{
	char copy[GZ_PATH_SIZE];
	struct gz_text all = { 0 };
	enum gz_result result = GZ_OK;
	memcpy(copy, names, sizeof copy);
	char *rest = copy;
	for (char *name = strsep(&rest, BLANKS); name && result == GZ_OK;
	     name = strsep(&rest, BLANKS))
		if (name[0])
			result = move_listed(move, name, &all);
	if (result == GZ_OK && all.length >= GZ_PATH_SIZE) {
		gz_err(move->log,
		       "transfer.also: the paths are too long for a scene; move the files");
		result = GZ_ERR_FULL;
	}
	if (result == GZ_ERR_NO_MEM)
		gz_err(move->log, "transfer.also: no memory for the paths");
	if (result == GZ_OK)
		memcpy(names, all.bytes ? all.bytes : "", all.length + 1);
	gz_text_free(&all);
	return result;
}

/* A gaze log, which is searched beside the scene and in the current folder. */
static enum gz_result move_log(const struct scene_move *move, char gaze[GZ_PATH_SIZE])
{
	char path[GZ_PATH_SIZE];
	if (!gz_path_ends(gaze, ".gzl"))
		return GZ_OK;
	if (gz_scene_find_file(move->from, gaze, path) == GZ_OK)
		return move_field(move, "view.gaze", gaze);
	const struct scene_move from_here = { .from = "", .to = move->to, .log = move->log };
	return move_field(&from_here, "view.gaze", gaze);
}

/* A file of an object, whose buffers are shorter. */
static enum gz_result move_object_file(const struct scene_move *move, const char *section,
				       char name[GZ_SCENE_FILE_SIZE])
{
	char moved[GZ_PATH_SIZE];
	snprintf(moved, sizeof moved, "%s", name);
	enum gz_result result = move_field(move, section, moved);
	if (result == GZ_OK && strlen(moved) >= GZ_SCENE_FILE_SIZE) {
		gz_err(move->log, "%s: the path of %s is too long for a scene; move the file",
		       section, name);
		result = GZ_ERR_FULL;
	}
	if (result == GZ_OK)
		memcpy(name, moved, strlen(moved) + 1);
	return result;
}

static enum gz_result move_object_files(const struct scene_move *move,
					struct gz_scene_object *object)
{
	char *const files[] = { object->volume, object->transfer, object->labels, object->mesh,
				object->particles };
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < sizeof files / sizeof files[0] && result == GZ_OK; i++)
		result = move_object_file(move, object->section, files[i]);
	return result;
}

static enum gz_result move_files(struct gz_scene_settings *settings, const struct scene_move *move)
{
	enum gz_result result = move_field(move, "volume.file", settings->volume_file);
	if (result == GZ_OK)
		result = move_field(move, "labels.names", settings->labels.names);
	if (result == GZ_OK)
		result = move_field(move, "transfer.file", settings->transfer_file);
	if (result == GZ_OK)
		result = move_list(move, settings->transfer_also);
	if (result == GZ_OK)
		result = move_field(move, "foveation.table", settings->foveation.table_file);
	if (result == GZ_OK)
		result = move_field(move, "environment.cube", settings->rays.environment.cube);
	if (result == GZ_OK)
		result = move_log(move, settings->view.gaze);
	for (size_t i = 0; i < settings->objects.count && result == GZ_OK; i++)
		result = move_object_files(move, &settings->objects.items[i]);
	return result;
}

enum gz_result gz_scene_move_files(struct gz_scene_settings *settings, const char *from,
				   const char *to, const struct gz_log *log)
{
	const struct scene_move move = { .from = from, .to = to, .log = log };
	return move_files(settings, &move);
}

enum gz_result gz_scene_anchor_files(struct gz_scene_settings *settings, const char *from,
				     const struct gz_log *log)
{
	const struct scene_move move = { .from = from, .log = log };
	return move_files(settings, &move);
}
