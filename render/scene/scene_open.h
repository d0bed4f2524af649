/**
 * @file
 * Opening anything that can be shown: a scene, a volume or a mesh without a scene, or a picture
 * that holds its scene.
 */
#ifndef GZ_RENDER_SCENE_SCENE_OPEN_H
#define GZ_RENDER_SCENE_SCENE_OPEN_H

#include "base/log.h"
#include "base/result.h"
#include "render/data/clip_region.h"
#include "render/scene/scene.h"

/** The kinds of files that gazeview opens. */
enum gz_file_kind {
	GZ_FILE_SCENE,    /**< .scene */
	GZ_FILE_VOLUME,   /**< with a header; also a folder of DICOM, particles and meshes */
	GZ_FILE_RAW,      /**< a volume without a header */
	GZ_FILE_PICTURE,  /**< .png */
	GZ_FILE_TRANSFER, /**< .tf */
	GZ_FILE_GAZE_LOG, /**< .gzl */
	GZ_FILE_OTHER,    /**< none of these; opened as a scene */
};

/** The kind by the name alone. Folders are GZ_FILE_OTHER. */
enum gz_file_kind gz_file_kind_by_name(const char *path);

/** The kind by the name and, if that does not decide, by looking at the file. It need not exist. A
 *  binary file that nothing recognises is GZ_FILE_VOLUME: the loader then lists what is read. */
enum gz_file_kind gz_file_kind_of(const char *path);

/** What to open, and how. All pointers are borrowed until the call returns. */
struct gz_scene_request {
	const char *path;
	/** Layout of a raw file; NULL: found by name and size, if that is certain. */
	const struct gz_raw_layout *raw;
	/** As in struct gz_scene_source, called once; NULL: none. Of a volume, render.shading is no
	 *  value yet, and chosen afterwards if it is left so. */
	gz_scene_change *change;
	void *user;
	const struct gz_loading *loading; /**< as for gz_scene_load() */
	bool volume_alone;                /**< as for gz_scene_load_parts() */
};

/**
 * Open a scene, or make one from a volume, a mesh or a picture. A volume gets the preset of every
 * key, the transfer function of gz_transfer_of_volume() and, unless @p request changes the camera,
 * a camera that sees all of it; so does a mesh, unless volume_alone asks for the points of a PLY.
 * A picture gives the scene and the transfer function that it holds; if the
 * volume has changed since, a warning is logged.
 *
 * @param[out] out_scene  owned by the caller: gz_scene_free(). Unless the file is a scene, the file
 *                        names in its settings are absolute
 * @retval GZ_ERR_INVAL  a raw file whose layout is not certain, a layout for a file that is not
 * raw, or a file of another kind; logged with the remedy
 * @return otherwise what gz_scene_load_changed() and gz_scene_picture_read() return
 */
enum gz_result gz_scene_open(const struct gz_scene_request *request, const struct gz_log *log,
			     struct gz_scene *out_scene);

/**
 * Make the settings that show a volume file: every key's preset, and the file by its absolute path.
 *
 * @param raw  of a raw file; NULL for others
 * @retval GZ_ERR_NOT_FOUND  no such file; logged
 * @retval GZ_ERR_FULL       its path is too long; logged
 */
enum gz_result gz_scene_settings_for_volume(const char *path, const struct gz_raw_layout *raw,
					    const struct gz_log *log,
					    struct gz_scene_settings *out_settings);

/**
 * Move a camera along its direction until it sees a part of a volume with a margin of a tenth, in a
 * picture that is at least as wide as high. It then looks at that box's centre. Sets the eye and
 * the height of the view, so the box fits in both projections.
 *
 * @param box  the part, such as what gz_content_find() finds; NULL: the whole volume
 */
void gz_camera_fit(struct gz_camera *camera, const struct gz_volume *volume,
		   const struct gz_clip_region *box);

#endif
