/**
 * @file
 * The files that a scene names: where they are, and how a scene elsewhere names them.
 */
#ifndef GZ_RENDER_SCENE_SCENE_FILES_H
#define GZ_RENDER_SCENE_SCENE_FILES_H

#include "base/result.h"
#include "protocol/gaze.h"

/**
 * Find a file that a scene names: beside the scene, then under $GAZECAST_DATA.
 *
 * @param scene  path of the scene
 * @param name   as the scene has it
 * @param[out] out_path  of a file that is there
 * @retval GZ_ERR_NOT_FOUND  in neither; not logged
 */
enum gz_result gz_scene_find_file(const char *scene, const char *name, char out_path[GZ_PATH_SIZE]);

/**
 * What a scene in another place must call a file so that gz_scene_find_file() finds the same one:
 * its name as it is where that does, else relative where it lies in the folder of the new scene or
 * below it, else its absolute path. A name that is not found now, or empty, stays as it is.
 *
 * @param scene     path of the scene that has @p name
 * @param name      as that scene has it
 * @param new_scene path of the scene to be; its folder must be there
 * @param[out] out_name  may be @p name itself
 * @retval GZ_ERR_FULL  the path is too long; not logged
 */
enum gz_result gz_scene_rename_file(const char *scene, const char *name, const char *new_scene,
				    char out_name[GZ_PATH_SIZE]);

#endif
