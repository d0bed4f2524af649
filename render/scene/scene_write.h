/**
 * @file
 * Scenes to text and files, which gz_scene_parse() reads back to equal settings.
 */
#ifndef GZ_RENDER_SCENE_SCENE_WRITE_H
#define GZ_RENDER_SCENE_SCENE_WRITE_H

#include "base/log.h"
#include "base/result.h"
#include "base/text.h"
#include "render/scene/scene.h"

/** What is written of a scene. */
struct gz_scene_saved {
	const struct gz_scene_settings *settings;
	bool has_display; /**< settings->display is part of it */
	const char *path; /**< beside which the names in the settings are found now: the scene that
			     they were read from; "" for the current folder */
};

/**
 * Append the text of a scene: the keys whose values are not their presets, section by section.
 * Names stay as they are: gz_scene_move_files() comes before.
 *
 * @retval GZ_ERR_INVAL   a value that its table does not allow; logged with its key
 * @retval GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_scene_print(const struct gz_scene_saved *saved, const struct gz_log *log,
			      struct gz_text *text);

/**
 * Change the text of a scene into one that says what @p saved does. Lines that say so already, what
 * is not a key, and comments stay as they are; keys that have become their presets are set to them,
 * but those of volume, transfer and display are removed, where being given has a meaning.
 *
 * @param name   stands for the text in messages
 * @param text   a scene that gz_scene_parse() takes
 * @retval GZ_ERR_FORMAT  @p text is no scene; logged
 * @retval GZ_ERR_INVAL, GZ_ERR_NO_MEM  as gz_scene_print()
 */
enum gz_result gz_scene_edit(const struct gz_scene_saved *saved, const char *name,
			     const struct gz_log *log, struct gz_text *text);

/**
 * Make the names of files in the settings ones that are found from another scene's place, see
 * gz_scene_rename_file().
 *
 * @param from      path of the scene that has the settings now
 * @param to        path of the scene to be; its folder must be there
 * @retval GZ_ERR_FULL  a path is too long; logged
 * @retval GZ_ERR_INVAL one of several transfer functions would get a path with a blank; logged
 */
enum gz_result gz_scene_move_files(struct gz_scene_settings *settings, const char *from,
				   const char *to, const struct gz_log *log);

/** As gz_scene_move_files(), with absolute paths, found from everywhere. */
enum gz_result gz_scene_anchor_files(struct gz_scene_settings *settings, const char *from,
				     const struct gz_log *log);

/**
 * Write a scene to a file, whole or not at all. A scene that is there keeps its comments and the
 * lines that are true already, see gz_scene_edit(); anything else that is there is replaced. Names
 * of files become ones that are found from the new place.
 *
 * @param path  the file to be
 * @retval GZ_ERR_INVAL  a value or a path that a scene cannot say (a line holds 199 bytes; no " ;"
 *                       and no line break in it); logged with the key and the remedy
 * @retval GZ_ERR_FULL, GZ_ERR_IO, GZ_ERR_NO_MEM  logged; what was there stays
 */
enum gz_result gz_scene_write(const struct gz_scene_saved *saved, const char *path,
			      const struct gz_log *log);

#endif
