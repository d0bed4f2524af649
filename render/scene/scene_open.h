/**
 * @file
 * Whatever can be shown: a scene, a volume without one, a picture that holds its scene.
 */
#ifndef GZ_RENDER_SCENE_SCENE_OPEN_H
#define GZ_RENDER_SCENE_SCENE_OPEN_H

#include "base/log.h"
#include "base/result.h"
#include "render/scene/scene.h"

/** What a file is to gazeview, by its name; folders and files without a telling name are looked
 *  into. */
enum gz_file_kind {
	GZ_FILE_SCENE,    /**< .scene */
	GZ_FILE_VOLUME,   /**< tells its layout itself; also a folder, of DICOM */
	GZ_FILE_RAW,      /**< does not */
	GZ_FILE_PICTURE,  /**< .png */
	GZ_FILE_TRANSFER, /**< .tf */
	GZ_FILE_GAZE_LOG, /**< .gzl */
	GZ_FILE_OTHER,    /**< none of these: opened as a scene, which it may be */
};

/** The kind that a name tells: a file is not looked at, so that folders are GZ_FILE_OTHER. */
enum gz_file_kind gz_file_kind_by_name(const char *path);

/** The kind of a file, which need not be there. */
enum gz_file_kind gz_file_kind_of(const char *path);

/** What is to be opened, and how. Texts and structs are borrowed until the call returns. */
struct gz_scene_request {
	const char *path;
	/** Of a raw file; NULL: what its name and its size tell, where that is certain. */
	const struct gz_raw_layout *raw;
	/** As for gz_scene_load_changed(); NULL: nothing. */
	gz_scene_change *change;
	void *user;
	const struct gz_loading *loading; /**< as for gz_scene_load() */
	bool volume_alone;                /**< as for gz_scene_load_parts() */
};

/**
 * Open a scene, or make one of what is there. A volume gets the presets of every key, a camera that
 * sees all of it, unless @p request changes the camera, and the transfer function of
 * gz_transfer_of_volume(). A picture gets the scene and the transfer function that it holds, with a
 * warning where the data are others.
 *
 * @param[out] out_scene  the caller frees it with gz_scene_free(). Unless the file was a scene, the
 *                        names of files in its settings are absolute
 * @retval GZ_ERR_INVAL  a raw file whose layout is not certain, a layout for what is no raw file,
 * or a file of another kind; logged with the remedy
 * @return else as gz_scene_load_changed() and gz_scene_picture_read()
 */
enum gz_result gz_scene_open(const struct gz_scene_request *request, const struct gz_log *log,
			     struct gz_scene *out_scene);

/**
 * Settings that show a volume file: every key's preset, and the file by its absolute path.
 *
 * @param raw  of a raw file; NULL for others
 * @retval GZ_ERR_NOT_FOUND  no such file; logged
 * @retval GZ_ERR_FULL       its path is too long; logged
 */
enum gz_result gz_scene_settings_for_volume(const char *path, const struct gz_raw_layout *raw,
					    const struct gz_log *log,
					    struct gz_scene_settings *out_settings);

/**
 * Move a camera along its view until the whole box of a volume is seen, a tenth of the picture
 * around it, in a picture that is not higher than wide: the eye in perspective, the height of the
 * view in either projection. It looks at the box's centre.
 */
void gz_camera_fit(struct gz_camera *camera, const struct gz_volume *volume);

#endif
