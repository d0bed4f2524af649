#include "render/scene/scene_files.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"

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
