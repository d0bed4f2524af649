#include "render/scene/scene_files.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/ini.h"
#include "base/text.h"
#include "render/particles/particle_series.h"

#define GZ_LOG_MODULE "scene"

#define BLANKS " \t"

/* Whether a file is there. A pattern of numbered files becomes the path of the first. */
static bool is_there(char path[GZ_PATH_SIZE])
{
	return access(path, F_OK) == 0 || gz_particle_series_first(path, path);
}

enum gz_result gz_scene_find_file(const char *scene, const char *name, char out_path[GZ_PATH_SIZE])
{
	const char *data = getenv("GAZECAST_DATA");
	if (gz_path_beside(scene, name, out_path, GZ_PATH_SIZE) == GZ_OK && is_there(out_path))
		return GZ_OK;
	if (name[0] == '/' || !data || !*data)
		return GZ_ERR_NOT_FOUND;
	const int length = snprintf(out_path, GZ_PATH_SIZE, "%s/%s", data, name);
	return length > 0 && length < GZ_PATH_SIZE && is_there(out_path) ? GZ_OK : GZ_ERR_NOT_FOUND;
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

/* How a key names files. */
enum file_kind {
	ONE_FILE,
	LISTED_FILES, /* separated by blanks */
	GAZE_LOG,     /* searched beside the scene and in the current folder */
};

/* A key that names files. */
struct file_key {
	const char *section, *key;
	enum file_kind kind;
	char *name; /* its value, in the settings */
	size_t size;
};

#define FILES_OF_SCENE  7
#define FILES_OF_OBJECT 5
#define FILE_KEYS_MAX   (FILES_OF_SCENE + FILES_OF_OBJECT * GZ_SCENE_OBJECTS_MAX)

static size_t list_object_keys(struct gz_scene_object *object,
			       struct file_key out_keys[static FILES_OF_OBJECT])
{
	const struct file_key keys[FILES_OF_OBJECT] = {
		{ object->section, "volume", ONE_FILE, object->volume, sizeof object->volume },
		{ object->section, "transfer", ONE_FILE, object->transfer,
		  sizeof object->transfer },
		{ object->section, "labels", ONE_FILE, object->labels, sizeof object->labels },
		{ object->section, "mesh", ONE_FILE, object->mesh, sizeof object->mesh },
		{ object->section, "particles", ONE_FILE, object->particles,
		  sizeof object->particles },
	};
	memcpy(out_keys, keys, sizeof keys);
	return FILES_OF_OBJECT;
}

/* All keys that name files. */
static size_t list_file_keys(struct gz_scene_settings *settings,
			     struct file_key out_keys[static FILE_KEYS_MAX])
{
	char *cube = settings->rays.environment.cube;
	const struct file_key keys[FILES_OF_SCENE] = {
		{ "volume", "file", ONE_FILE, settings->volume_file, GZ_PATH_SIZE },
		{ "labels", "names", ONE_FILE, settings->labels.names, GZ_PATH_SIZE },
		{ "transfer", "file", ONE_FILE, settings->transfer_file, GZ_PATH_SIZE },
		{ "transfer", "also", LISTED_FILES, settings->transfer_also, GZ_PATH_SIZE },
		{ "foveation", "table", ONE_FILE, settings->foveation.table_file, GZ_PATH_SIZE },
		{ "environment", "cube", ONE_FILE, cube, GZ_PATH_SIZE },
		{ "view", "gaze", GAZE_LOG, settings->view.gaze, GZ_PATH_SIZE },
	};
	size_t count = FILES_OF_SCENE;
	memcpy(out_keys, keys, sizeof keys);
	for (size_t i = 0; i < settings->objects.count; i++)
		count += list_object_keys(&settings->objects.items[i], out_keys + count);
	return count;
}

static enum gz_result refuse_long_path(const struct scene_move *move, const struct file_key *key,
				       const char *name)
{
	gz_err(move->log, "%s.%s: the path of %s is too long for a scene; move the file",
	       key->section, key->key, name);
	return GZ_ERR_FULL;
}

/* One name of a key. */
static enum gz_result move_name(const struct scene_move *move, const struct file_key *key,
				const char *name, char out_name[GZ_PATH_SIZE])
{
	const enum gz_result result =
		move->to ? gz_scene_rename_file(move->from, name, move->to, out_name)
			 : anchor_name(move, name, out_name);
	return result == GZ_OK ? GZ_OK : refuse_long_path(move, key, name);
}

static enum gz_result set_key(const struct scene_move *move, const struct file_key *key,
			      const char *moved)
{
	if (strlen(moved) >= key->size)
		return refuse_long_path(move, key, key->name);
	memmove(key->name, moved, strlen(moved) + 1);
	return GZ_OK;
}

static enum gz_result move_one_file(const struct scene_move *move, const struct file_key *key)
{
	char moved[GZ_PATH_SIZE];
	const enum gz_result result = move_name(move, key, key->name, moved);
	return result == GZ_OK ? set_key(move, key, moved) : result;
}

/* Append one of several names to @p all. */
static enum gz_result move_listed(const struct scene_move *move, const struct file_key *key,
				  const char *name, struct gz_text *all)
{
	char moved[GZ_PATH_SIZE];
	const enum gz_result result = move_name(move, key, name, moved);
	if (result != GZ_OK)
		return result;
	if (strcmp(moved, name) != 0 && strpbrk(moved, BLANKS)) {
		gz_err(move->log,
		       "%s.%s: the path of %s has a blank, which separates names there; save the "
		       "scene beside it",
		       key->section, key->key, name);
		return GZ_ERR_INVAL;
	}
	gz_text_add(all, "%s%s", all->length ? " " : "", moved);
	return all->failed ? GZ_ERR_NO_MEM : GZ_OK;
}

static enum gz_result move_listed_files(const struct scene_move *move, const struct file_key *key)
{
	char copy[GZ_PATH_SIZE];
	struct gz_text all = { 0 };
	enum gz_result result = GZ_OK;
	snprintf(copy, sizeof copy, "%s", key->name);
	char *rest = copy;
	for (char *name = strsep(&rest, BLANKS); name && result == GZ_OK;
	     name = strsep(&rest, BLANKS))
		if (name[0])
			result = move_listed(move, key, name, &all);
	if (result == GZ_ERR_NO_MEM)
		gz_err(move->log, "%s.%s: no memory for the paths", key->section, key->key);
	if (result == GZ_OK)
		result = set_key(move, key, all.bytes ? all.bytes : "");
	gz_text_free(&all);
	return result;
}

static enum gz_result move_gaze_log(const struct scene_move *move, const struct file_key *key)
{
	char path[GZ_PATH_SIZE];
	if (!gz_path_ends(key->name, ".gzl"))
		return GZ_OK;
	if (gz_scene_find_file(move->from, key->name, path) == GZ_OK)
		return move_one_file(move, key);
	const struct scene_move from_here = { .from = "", .to = move->to, .log = move->log };
	return move_one_file(&from_here, key);
}

static enum gz_result move_files(struct gz_scene_settings *settings, const struct scene_move *move)
{
	struct file_key keys[FILE_KEYS_MAX];
	const size_t count = list_file_keys(settings, keys);
	enum gz_result result = GZ_OK;
	for (size_t i = 0; i < count && result == GZ_OK; i++)
		switch (keys[i].kind) {
		case ONE_FILE:
			result = move_one_file(move, &keys[i]);
			break;
		case LISTED_FILES:
			result = move_listed_files(move, &keys[i]);
			break;
		case GAZE_LOG:
			result = move_gaze_log(move, &keys[i]);
			break;
		}
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

enum gz_result gz_scene_text_move_files(struct gz_text *text,
					const struct gz_scene_settings *settings, const char *from,
					const char *to, const struct gz_log *log)
{
	struct gz_scene_settings *copies = malloc(2 * sizeof copies[0]);
	struct file_key before[FILE_KEYS_MAX], after[FILE_KEYS_MAX];
	if (!copies) {
		gz_err(log, "%s: no memory for the paths of its files", to);
		return GZ_ERR_NO_MEM;
	}
	copies[0] = copies[1] = *settings;
	const enum gz_result result = gz_scene_move_files(&copies[1], from, to, log);
	const size_t count = list_file_keys(&copies[0], before);
	list_file_keys(&copies[1], after);
	for (size_t i = 0; i < count && result == GZ_OK; i++)
		if (strcmp(before[i].name, after[i].name) != 0)
			gz_ini_text_set(text, after[i].section, after[i].key, after[i].name);
	free(copies);
	return result;
}
