/**
 * @file
 * Scenes as text and files that gz_scene_parse() reads back to equal settings.
 */
#ifndef GZ_RENDER_SCENE_SCENE_WRITE_H
#define GZ_RENDER_SCENE_SCENE_WRITE_H

#include "base/log.h"
#include "base/result.h"
#include "base/text.h"
#include "render/scene/scene_settings.h"

/** A scene to write. All pointers are borrowed until the call returns. */
struct gz_scene_saved {
	const struct gz_scene_settings *settings;
	bool has_display; /**< write settings->display, too */
	const char *path; /**< of the scene that the settings were read from, beside which the files
			     that they name are searched; "" = the current folder */
};

/**
 * Append the text of a scene: the keys whose values differ from their presets, section by section.
 * File names are written as they are; call gz_scene_move_files() before.
 *
 * @retval GZ_ERR_INVAL   a value that its option does not allow; logged with its key
 * @retval GZ_ERR_NO_MEM  logged
 */
enum gz_result gz_scene_print(const struct gz_scene_saved *saved, const struct gz_log *log,
			      struct gz_text *text);

/**
 * Edit the text of a scene so that it gives the settings of @p saved. Comments, and lines whose
 * value is right already, stay as they are. A key whose value became its preset is set to it; in
 * sections volume, transfer and display, where giving a key has a meaning of its own, it is
 * removed. A text with objects that @p saved does not have is printed anew, without its comments.
 *
 * @param name   the text's name in messages
 * @param text   a scene that gz_scene_parse() accepts
 * @retval GZ_ERR_FORMAT  @p text is not a scene; logged
 * @retval GZ_ERR_INVAL, GZ_ERR_NO_MEM  as gz_scene_print()
 */
enum gz_result gz_scene_edit(const struct gz_scene_saved *saved, const char *name,
			     const struct gz_log *log, struct gz_text *text);

/**
 * Write a scene to a file, completely or not at all. If the file is a scene already, it is edited
 * by gz_scene_edit(); any other file is replaced. File names are changed to ones that are found
 * from the new place.
 *
 * @param path  the file to write
 * @retval GZ_ERR_INVAL  a value or a path that a scene cannot hold (a line holds 199 bytes, no " ;"
 *                       and no line break); logged with the key and the remedy
 * @retval GZ_ERR_FULL, GZ_ERR_IO, GZ_ERR_NO_MEM  logged; the file is unchanged
 */
enum gz_result gz_scene_write(const struct gz_scene_saved *saved, const char *path,
			      const struct gz_log *log);

#endif
