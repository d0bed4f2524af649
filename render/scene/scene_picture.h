/**
 * @file
 * Pictures that hold the scene they show: PNG files with the scene, the transfer function and a
 * description of the data as texts, keywords "gazecast.scene", "gazecast.transfer" and
 * "gazecast.volume".
 */
#ifndef GZ_RENDER_SCENE_SCENE_PICTURE_H
#define GZ_RENDER_SCENE_SCENE_PICTURE_H

#include "base/log.h"
#include "base/result.h"
#include "render/picture/image.h"
#include "render/scene/scene.h"
#include "render/scene/scene_write.h"

/** Bytes of a mark with its NUL. */
#define GZ_VOLUME_MARK_SIZE 192

/** What a picture holds about the scene that it shows. */
struct gz_scene_picture {
	struct gz_scene_settings settings; /**< file names are absolute */
	bool has_display;
	bool has_transfer;
	struct gz_transfer transfer;    /**< as it was when the picture was saved */
	char mark[GZ_VOLUME_MARK_SIZE]; /**< description of the data; empty: none */
};

/**
 * Describe a volume's data in one line by which other data can be told apart: dims, type, range and
 * checksum of gz_volume_identify(). Volumes of bricks have no checksum.
 */
void gz_volume_mark(const struct gz_volume *volume, char out_mark[GZ_VOLUME_MARK_SIZE]);

/**
 * Write a picture as PNG together with its scene. If the scene cannot be printed, the picture is
 * written without it and a warning is logged.
 *
 * @param saved     the scene
 * @param transfer  in use; NULL: not written
 * @param volume    in use; NULL: not described
 * @return what gz_image_write_png() returns
 */
enum gz_result gz_scene_picture_write(const struct gz_image *image,
				      const struct gz_scene_saved *saved,
				      const struct gz_transfer *transfer,
				      const struct gz_volume *volume, const char *path,
				      const struct gz_log *log);

/**
 * Read the scene that a picture holds.
 *
 * @retval GZ_ERR_NOT_FOUND  no such file, or a PNG without a scene; logged, as the others
 * @retval GZ_ERR_FORMAT     not a PNG, damaged, or its scene is refused
 * @retval GZ_ERR_IO, GZ_ERR_NO_MEM
 */
enum gz_result gz_scene_picture_read(const char *path, const struct gz_log *log,
				     struct gz_scene_picture *out_picture);

/** Warn if a volume is not the one that a picture was made from. @return false if it is known to be
 *  another */
bool gz_scene_picture_check(const struct gz_scene_picture *picture, const struct gz_volume *volume,
			    const char *path, const struct gz_log *log);

#endif
