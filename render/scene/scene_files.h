/**
 * @file
 * The files that a scene names: where they are, and how a scene in another place names them.
 */
#ifndef GZ_RENDER_SCENE_SCENE_FILES_H
#define GZ_RENDER_SCENE_SCENE_FILES_H

#include "base/log.h"
#include "base/result.h"
#include "base/sizes.h"
#include "base/text.h"
#include "render/scene/scene_settings.h"

/**
 * Find a file that a scene names: beside the scene, then under $GAZECAST_DATA.
 *
 * @param scene  path of the scene
 * @param name   the file's name in the scene
 * @param[out] out_path  of an existing file
 * @retval GZ_ERR_NOT_FOUND  in neither place; not logged
 */
enum gz_result gz_scene_find_file(const char *scene, const char *name, char out_path[GZ_PATH_SIZE]);

/**
 * Find the name by which a scene in another place finds the same file with gz_scene_find_file().
 * The name stays if it works there. Otherwise it becomes relative if the file is in the new scene's
 * folder or below it, else absolute. An empty name, and one that is not found now, stays.
 *
 * @param scene     path of the scene that has @p name
 * @param name      the file's name in that scene
 * @param new_scene path of the new scene; its folder must exist
 * @param[out] out_name  may be @p name itself
 * @retval GZ_ERR_FULL  the path is too long; not logged
 */
enum gz_result gz_scene_rename_file(const char *scene, const char *name, const char *new_scene,
				    char out_name[GZ_PATH_SIZE]);

/**
 * Apply gz_scene_rename_file() to every file name in the settings.
 *
 * @param from      path of the scene that the names belong to
 * @param to        path of the new scene; its folder must exist
 * @retval GZ_ERR_FULL   a path is too long; logged
 * @retval GZ_ERR_INVAL  a name in transfer.also would get a path with a blank; logged
 * @retval GZ_ERR_NO_MEM logged
 */
enum gz_result gz_scene_move_files(struct gz_scene_settings *settings, const char *from,
				   const char *to, const struct gz_log *log);

/** Like gz_scene_move_files(), but with absolute paths, which every scene finds. */
enum gz_result gz_scene_anchor_files(struct gz_scene_settings *settings, const char *from,
				     const struct gz_log *log);

/**
 * Apply gz_scene_rename_file() to every file name in the text of a scene. Lines whose names stay,
 * and all others, stay byte for byte.
 *
 * @param text      of the scene at @p from; its failed is set if memory runs out
 * @param settings  what it says
 * @retval GZ_ERR_FULL, GZ_ERR_INVAL, GZ_ERR_NO_MEM  as gz_scene_move_files(); the text is unchanged
 */
enum gz_result gz_scene_text_move_files(struct gz_text *text,
					const struct gz_scene_settings *settings, const char *from,
					const char *to, const struct gz_log *log);

#endif
