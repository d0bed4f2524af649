/**
 * @file
 * Saving what is shown: the scene, and beside it the transfer function where that is no file yet.
 */
#ifndef GZ_VIEW_FILES_SCENE_SAVE_H
#define GZ_VIEW_FILES_SCENE_SAVE_H

#include <stdbool.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/gaze.h"
#include "render/scene/scene_write.h"
#include "render/transfer/transfer.h"

/** What is to be saved, all borrowed. */
struct gz_scene_save {
	struct gz_scene_saved scene;
	const struct gz_transfer *transfer; /**< as shown; NULL: as scene.settings name it */
	const struct gz_transfer *made;     /**< what the volume gets that has none, see
					       gz_transfer_of_volume(); NULL: not known */
};

/** The path that a scene is saved to: with ".scene" at its end. GZ_ERR_FULL: it is too long */
enum gz_result gz_scene_save_path(const char *typed, char out_path[GZ_PATH_SIZE]);

/** The path that is offered for a scene: its own, or one beside the volume or picture that stands
 *  for it. @param path  of the scene; "": in the current folder */
void gz_scene_save_suggest(const char *path, char out_path[GZ_PATH_SIZE]);

/**
 * Where the transfer function would be written if the scene were saved to @p path: beside it, named
 * as it is, with ".tf" for ".scene".
 *
 * @return false: nowhere, since a file, or the volume itself, has it already
 */
bool gz_scene_save_writes_transfer(const struct gz_scene_save *save, const char *path,
				   char out_path[GZ_PATH_SIZE]);

/**
 * Save it. What is at those paths already is replaced; a scene there keeps its comments.
 *
 * @param path  as gz_scene_save_path() makes it
 * @param[out] settings  as saved: names of files are found from @p path; may be what
 *                       save->scene.settings points to
 * @return what gz_transfer_write() and gz_scene_write() return; logged
 */
enum gz_result gz_scene_save(const struct gz_scene_save *save, const char *path,
			     const struct gz_log *log, struct gz_scene_settings *settings);

#endif
