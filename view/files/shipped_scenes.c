#include "view/files/shipped_scenes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/scene/scene.h"
#include "view/files/folder.h"
#include "view/files/programs.h"

static bool has_data(const char *path, struct gz_scene_settings *room)
{
	const struct gz_scene_source source = { .path = path };
	return gz_scene_try(&source, NULL, room) == GZ_OK;
}

static void add_scene(struct gz_shipped_scenes *scenes, const struct gz_folder *folder,
		      const struct gz_folder_entry *entry, struct gz_scene_settings *room)
{
	struct gz_shipped_scene *scene = &scenes->items[scenes->count];
	const char *end = strrchr(entry->name, '.');
	const int length = end ? (int)(end - entry->name) : 0;
	char picture[GZ_FOLDER_NAME_SIZE + 16];
	if (length < 1 || (size_t)length >= sizeof scene->name ||
	    gz_folder_path_of(folder, entry->name, scene->path) != GZ_OK)
		return;
	if (!has_data(scene->path, room)) {
		scenes->without_data++;
		return;
	}
	snprintf(scene->name, sizeof scene->name, "%.*s", length, entry->name);
	snprintf(picture, sizeof picture, "pictures/%s.png", scene->name);
	(void)gz_folder_path_of(folder, picture, scene->picture); /* too long: "" */
	scenes->count++;
}

static enum gz_result add_folder(struct gz_shipped_scenes *scenes, const char *name,
				 struct gz_scene_settings *room)
{
	const struct gz_folder_filter filter = { 0 };
	struct gz_folder folder = { 0 };
	char path[GZ_PATH_SIZE], message[128];
	enum gz_result r = gz_shipped_path(name, path);
	if (r == GZ_OK)
		r = gz_folder_read(path, &filter, &folder, message, sizeof message);
	for (size_t i = 0; r == GZ_OK && i < folder.count; i++)
		if (!folder.entries[i].is_folder && folder.entries[i].kind == GZ_FILE_SCENE &&
		    scenes->count < GZ_SHIPPED_SCENES_MAX)
			add_scene(scenes, &folder, &folder.entries[i], room);
	gz_folder_free(&folder);
	return r == GZ_ERR_IO ? GZ_ERR_NOT_FOUND : r;
}

enum gz_result gz_shipped_scenes_read(struct gz_shipped_scenes *out_scenes)
{
	struct gz_scene_settings *room = malloc(sizeof *room);
	memset(out_scenes, 0, sizeof *out_scenes);
	if (!room)
		return GZ_ERR_NO_MEM;
	const enum gz_result r = add_folder(out_scenes, "scenes", room);
	if (r == GZ_OK)
		(void)add_folder(out_scenes, "scenes/fetched", room); /* may be absent */
	free(room);
	return r;
}

const struct gz_shipped_scene *gz_shipped_scenes_find(const struct gz_shipped_scenes *scenes,
						      const char *name)
{
	for (size_t i = 0; i < scenes->count; i++)
		if (strcmp(scenes->items[i].name, name) == 0)
			return &scenes->items[i];
	return NULL;
}
