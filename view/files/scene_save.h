/**
 * @file
 * Saves the scene that is shown and, if no file holds it yet, the transfer function beside it.
 */
#ifndef GZ_VIEW_FILES_SCENE_SAVE_H
#define GZ_VIEW_FILES_SCENE_SAVE_H

#include <stdbool.h>

#include "base/log.h"
#include "base/result.h"
#include "protocol/gaze.h"
#include "render/scene/scene_write.h"
#include "render/transfer/transfer.h"

/** What to save. Everything is borrowed. */
struct gz_scene_save {
	struct gz_scene_saved scene;
	const struct gz_transfer *transfer; /**< as shown; NULL: the one scene.settings names */
	const struct gz_transfer *made;     /**< the volume's default, gz_transfer_of_volume();
					       NULL: unknown */
};

/** The path a scene is saved to: @p typed, with ".scene" added if it is missing. GZ_ERR_FULL: the
 * path is too long. */
enum gz_result gz_scene_save_path(const char *typed, char out_path[GZ_PATH_SIZE]);

/**
 * The path to suggest for saving a scene: its own path, or a scene file beside the volume or
 * picture that was opened.
 *
 * @param path  of what was opened; "" suggests a name in the current folder
 */
void gz_scene_save_suggest(const char *path, char out_path[GZ_PATH_SIZE]);

/**
 * The path of the transfer function that gz_scene_save() would write: @p path with ".tf" in place
 * of ".scene".
 *
 * @return whether it would write one: neither a file nor the volume's default holds the transfer
 *         function
 */
bool gz_scene_save_writes_transfer(const struct gz_scene_save *save, const char *path,
				   char out_path[GZ_PATH_SIZE]);

/**
 * Save the scene. Existing files are replaced; comments in an existing scene file are kept.
 *
 * @param path  from gz_scene_save_path()
 * @param[out] settings  as saved, with file names relative to @p path; may be the struct that
 *                       save->scene.settings points to
 * @return the results of gz_transfer_write() and gz_scene_write(); logged
 */
enum gz_result gz_scene_save(const struct gz_scene_save *save, const char *path,
			     const struct gz_log *log, struct gz_scene_settings *settings);

#endif
